#pragma once
// The integral of a power of K of edge cracks along the boundary, and its derivatives.

#include "kerf/adjoint.hpp"
#include "kerf/functional.hpp"
#include "kerf/state.hpp"

#include <memory>

namespace kerf {

/// Throws Error(Geometry) where a crack of that length would leave the body through its other side.
double edge_crack_integral(const EdgeCrackNorm& norm, const Model& model, const Field& state);

/// Adds its derivative by the interior coefficients of the state.
void differentiate_edge_cracks(const EdgeCrackNorm& norm, const Model& model, const Field& state, Sensitivity& d);

/// What is left of its change after the derivative, of many changes of the state at once.
class EdgeCrackRest {
 public:
  EdgeCrackRest(const EdgeCrackNorm& norm, const Model& model, const Field& state, Eigen::Index changes);
  ~EdgeCrackRest();
  /// Interior coefficients of the changes in a triangle, a column each. Threads may add different triangles.
  void add(Index t, const Eigen::MatrixXd& changes);
  /// I(z + w) - I(z) - I'(z) w per change.
  Eigen::VectorXd rest() const;

 private:
  struct Data;
  const std::unique_ptr<Data> data_;
};

/// Adds `share` times its derivative by the vertices of a straight mesh, with which the state moves: stresses by Piola.
void add_edge_crack_motion(const EdgeCrackNorm& norm, double share, const Model& model, const Field& state,
                           Points& gradient);

/// Throws Error(Usage): other materials than isotropic ones, parts of a body, sides with a support.
void require_edge_cracks(const EdgeCrackNorm& norm, const Model& model);

}  // namespace kerf
