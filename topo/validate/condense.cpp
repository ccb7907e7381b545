// A piece of a mesh condensed onto some of its edges: its Schur complement (a Steklov-Poincare operator) and its load,
// from a factor with the kept rows last [theory: C.7, V.2].

#include "topo/validate/condense.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace kerf {

// Loads on the boundary and supports belong to the body around; a ball has its own material, and its forces where asked
// for.
CondensedPiece condense(const CutOut& piece, const Kernel& k, const Scene& scene, bool body) {
  require(k.element, can_validate);
  CondensedPiece p;
  p.part = part(piece.whole, piece.use);
  Scene inside = scene;
  inside.supports.clear();
  inside.tractions.clear();
  for (CrackLaw& law : inside.laws) law.pressure = {};  // no crack reaches into a ball
  if (!body) {
    inside.body = {};
    inside.eigenstrain.clear();
  }
  const EdgeCurvatures curvatures = curvatures_of(p.part.mesh, k.element);
  p.data = scene_data(p.part.mesh, inside, k.load, 1, curvatures);
  p.skeleton = number(p.part.mesh, k, {inside, p.data}, curvatures);
  std::vector<Index> of_whole(piece.whole.edges.size(), none), edges;
  for (std::size_t e = 0; e < p.part.edge.size(); ++e) of_whole[p.part.edge[e]] = static_cast<Index>(e);
  for (const Index e : piece.kept) edges.push_back(of_whole[e]);
  p.ordering = order(p.part.mesh, p.skeleton, edges);
  p.system = assemble({p.part.mesh, k, p.skeleton, inside, p.data, p.ordering, 1, true});
  // A body that is not held has a semidefinite K: a shift of the kept rows makes it definite, and is taken off again.
  LowerTriangle& K = *p.system.K;
  const Index first = K.size - p.ordering.interface_rows;
  for (Index r = first; r < K.size; ++r) p.shift = std::max(p.shift, K.values[K.start[r]]);
  for (Index r = first; r < K.size; ++r) K.values[K.start[r]] += p.shift;
  p.factor = Factor(K, 0, true, p.ordering.interface_rows);
  p.K = p.factor.interface_complement();
  p.K.diagonal().array() -= p.shift;
  // K = L22 L22' - shift; the load is L22 times the last part of L^-1 F.
  p.load = p.factor.interface_factor().triangularView<Eigen::Lower>() *
           p.factor.forward(p.system.F).tail(p.ordering.interface_rows);
  return p;
}

// All unknowns of the piece from those that were kept.
Eigen::VectorXd complete(const CondensedPiece& p, const Eigen::VectorXd& kept, bool body) {
  // Backward substitution with the kept rows given: y of the kept rows is L22' x.
  Eigen::VectorXd y = body ? p.factor.forward(p.system.F) : Eigen::VectorXd::Zero(p.ordering.size).eval();
  y.tail(kept.size()) = p.factor.interface_factor().triangularView<Eigen::Lower>().transpose() * kept;
  const Eigen::VectorXd x = p.factor.backward(y);
  Eigen::VectorXd all = Eigen::VectorXd::Zero(p.skeleton.total);
  for (Index u = 0; u < p.skeleton.total; ++u)
    if (p.ordering.row[u] != none) all[u] = x[p.ordering.row[u]];
  return all;
}

}  // namespace kerf
