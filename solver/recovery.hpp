#pragma once
// Recovery beyond kerf/recover.hpp: from coefficients, transposed, scales.

#include "kerf/recover.hpp"

namespace kerf {

/// recovered_displacement from the interior coefficients of t.
Points recovered_displacement(const Model& model, const Eigen::Ref<const Eigen::VectorXd>& interior, Index t,
                              const Points& x);

/// Its transpose: the derivative by the interior coefficients of t of sum_q weights_q . u*(x_q).
Eigen::VectorXd weigh_recovered(const Model& model, Index t, const Points& x, const Points& weights);

/// What the body is made of at corners that are split between materials, too: of the last triangle at each corner.
std::vector<Material> corner_materials(const Model& model, const Corners& corners);

/// Root mean square of the stress over the body: the scale of "no pressure".
double mean_stress(const Model& model, const Field& state);

/// grad u = A s + Gamma(omega) of the mixed solution: d1 u1, d2 u1, d1 u2, d2 u2.
Eigen::Vector4d displacement_gradient(const Material& m, const Eigen::Vector4d& stress, double rotation);

}  // namespace kerf
