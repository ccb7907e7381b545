#pragma once
// The contact linearized at a state: what small changes of the loads leave as it is, with friction or without.

#include "kerf/adjoint.hpp"
#include "solver/contact/sliding.hpp"

#include <optional>
#include <utility>

namespace kerf {

/// The points of all cracks in contact, by their rows counted from the first row in contact.
std::vector<ContactPoint> contact_points(const Model& m);

/// `held` rows keep their jump, the others their force, or their share of a pressure [theory: A.8, A.14].
struct TangentCone {
  TangentCone(std::vector<bool> rows, std::vector<SlidingPoint> points = {})
      : held(std::move(rows)), sliding(std::move(points)) {}
  std::vector<bool> held;
  std::vector<SlidingPoint> sliding;
};
/// Held: closed rows and those that stick; biactive ones move.
TangentCone tangent_cone(const Model& model, const Field& state);

/// As on a cone without friction (kerf/adjoint.hpp), but for normal rows under sliding points, which have minus their
/// share of the dual slip [theory: A.15].
TangentField solve_adjoint(const Model& model, const Sensitivity& dJ, const TangentCone& cone);

/// Many linear problems whose loads lie on few unknowns of the skeleton, those of a boundary say: a column per problem.
struct FewLoads {
  std::vector<Index> unknowns;
  Eigen::MatrixXd load, prescribed;  // a row per unknown; prescribed: where supports fix it, 0 elsewhere
};
/// A number that is linear in the solution of problem `of`: weights . its interior in triangle t.
struct Reading {
  Eigen::Index of;
  Index t;
  Eigen::VectorXd weights;
};

/// TangentSolver on a cone with friction; the model must outlive it.
class ConeSolver {
 public:
  ConeSolver(const Model& model, TangentCone cone);
  ~ConeSolver();
  /// What is read, without the solutions: loads and readings meet half way, each substituted on the way from its
  /// unknowns to the root alone, all at once [theory: T.38]. Not refined. Nothing where one substitution is no
  /// solution: with a penalty, with forces that follow pressures, with large contact, without a factor of a definite
  /// matrix.
  std::optional<Eigen::VectorXd> read(const FewLoads& loads, std::span<const Reading> readings) const;
  TangentField solve(const Eigen::VectorXd& load, const std::vector<double>& prescribed,
                     double enough = TangentSolver::to_rounding, std::span<const Index> only = {});
  std::vector<TangentField> solve_all(std::size_t count, const std::function<Eigen::VectorXd(std::size_t)>& load);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The slope of the potential energy along the jumps of a solution: the forces on the faces, of which only those of
/// friction meet jumps that change [theory: A.17].
Sensitivity work_of_slips(const Field& state);

/// Where friction leaves open what faces do next: they touch without pressure, or do not slide and have no friction
/// left. Of one crack, own edges.
struct Undecided {
  double length = 0, whole = 0;
  Vec2 at = Vec2::Zero();  // the first such point
  bool touches = false;    // without pressure
};
Undecided undecided_friction(const Model& model, const Field& state, Index crack);

inline bool has_frictional_cracks(const Scene& scene) {
  for (const CrackLaw& law : scene.laws)
    if (has_friction(law)) return true;
  return false;
}

}  // namespace kerf
