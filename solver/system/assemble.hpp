#pragma once
// The global condensed system: values of its matrix and right-hand side.

#include "solver/factor.hpp"
#include "solver/system/congruent.hpp"
#include "solver/system/ordering.hpp"

namespace kerf {

/// K x = F over the free unknowns: K = sum_T K_T on the traces that each triangle sees, F from tractions, body force
/// and prescribed values. Symmetric positive definite when the supports hold the body (quasi-definite with stresses at
/// vertices); on the jumps in contact the solution satisfies their law instead of K x = F.
struct System {
  double penalty = 0;  // Penalty::a in K times the mu of each triangle; not 0 when c mu would lose digits
  std::shared_ptr<LowerTriangle> K = std::make_shared<LowerTriangle>();  // shared where loads alone differ
  Eigen::MatrixXd force;  // ForceMoments, a column per triangle; no columns without body force and eigenstrain
  Eigen::VectorXd F;
  Eigen::VectorXd tractions;  // their loads, per skeleton unknown
  Eigen::MatrixXd traces;     // with a penalty, per triangle Condensed::trace, own, by_theta
  std::shared_ptr<const CongruentTriangles> alike =
      std::make_shared<const CongruentTriangles>();  // shared where loads alone differ
};

/// What a system is assembled from.
struct Assembly {
  const Mesh& mesh;
  const Kernel& kernel;
  const Skeleton& skeleton;
  const Scene& scene;
  const SceneData& data;
  const Ordering& ordering;
  int threads = 1;
  bool plain = false;  // no penalty, whatever the compliances
};
/// Bits do not depend on the number of threads.
System assemble(const Assembly& from);
/// The same where all but the loads is that of a system which is there: triangles without loads are left out.
System assemble_loads(const Assembly& from, const System& like, bool with_matrix = true);

/// Without matrix and without F, for those who solve otherwise: forces, tractions and traces alone.
System assemble_without_matrix(const Assembly& from);

ForceMoments force_of(const System& a, Index t);

}  // namespace kerf
