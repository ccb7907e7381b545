#pragma once
// What a body answers to fields in closed form that are singular at a point of it: the regular field that makes their
// sum fulfil the body's own conditions [theory: T.28, Q.4].

#include "solver/nucleus.hpp"
#include "solver/tangent_cone.hpp"
#include "topo/formulas/second_term.hpp"

#include <span>

namespace kerf {

/// w = -G where supports hold the body (component by component), s(w) n = -s(G) n where it is free; on cracks the
/// contact linearized.
class BodyReply {
 public:
  /// The model must outlive it.
  BodyReply(const Model& model, TangentCone cone);

  /// Per field; `only` and `enough` as for TangentSolver::solve. One material.
  std::vector<TangentField> to(const Vec2& singular, std::span<const Nucleus> fields, std::span<const Index> only,
                               double enough = TangentSolver::to_rounding);

 private:
  const Model& model_;
  ConeSolver solver_;
  std::vector<Index> edges_;  // on the boundary, and of cracks whose faces move
};

/// What a circle sends out: phi = -conj(b1)/z, psi = -2 a1/z.
Nucleus dipole_field(const Material& m, const Vec2& x, const Dipoles& sent);

}  // namespace kerf
