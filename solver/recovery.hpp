#pragma once
// Recovery beyond kerf/recover.hpp: from coefficients, transposed, scales.

#include "kerf/recover.hpp"

namespace kerf {

/// recovered_displacement from the interior coefficients of t; `eigenstrain` as Field::eigenstrain.
Points recovered_displacement(const Model& model, const Eigen::Ref<const Eigen::VectorXd>& interior, Index t,
                              const Points& x, double eigenstrain = 0);

/// The same of fields side by side in a straight triangle of an isotropic material without eigenstrain: from their
/// evaluate_lanes at the points of the kernel's rule to u* at points x, 2 rows each.
void recovered_lanes(const Model& model, Index t, const double* fields, const Points& x, double* u);

/// Its transpose: the derivative by the interior coefficients of t of sum_q weights_q . u*(x_q).
Eigen::VectorXd weigh_recovered(const Model& model, Index t, const Points& x, const Points& weights);

/// What the body is made of at corners that are split between materials, too: of the last triangle at each corner.
std::vector<Material> corner_materials(const Model& model, const Corners& corners);

/// The eigenstrain at corners (rows 11, 12, 21, 22, 33), of the same triangles.
Eigen::MatrixXd corner_eigenstrains(const Model& model, const Corners& corners);

/// Root mean square of the stress over the body: the scale of "no pressure".
double mean_stress(const Model& model, const Field& state);
/// The plane modulus beside a crack, which lies in one material: a stress s could open it by about s length/modulus.
double modulus_beside(const Model& model, Index crack);

/// Of an edge, along its curve.
double length_along(const Model& model, Index edge);

/// A s + Gamma(omega) of the mixed solution, which is grad u less the eigenstrain: d1 u1, d2 u1, d1 u2, d2 u2.
Eigen::Vector4d displacement_gradient(const Material& m, const Eigen::Vector4d& stress, double rotation);

}  // namespace kerf
