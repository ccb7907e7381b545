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

  /// Fields that are singular at a point, and the triangle where it lies.
  struct Singularity {
    Vec2 at;
    Index in;
    std::vector<Nucleus> fields;
  };
  /// Of many the recovered displacement of each reply at its singular point alone, a column per field, at a small share
  /// of the price. Nothing where ConeSolver::read says nothing.
  std::optional<std::vector<Points>> displacements(std::span<const Singularity> many) const;

 private:
  std::vector<Index> loaded_unknowns() const;
  /// Of the loaded unknowns, a column per field.
  void load(const Vec2& singular, std::span<const Nucleus> fields, Eigen::Ref<Eigen::MatrixXd> load,
            Eigen::Ref<Eigen::MatrixXd> prescribed) const;

  const Model& model_;
  ConeSolver solver_;
  std::vector<Index> edges_;  // on the boundary, and of cracks whose faces move
};

/// What a circle sends out: phi = -conj(b1)/z, psi = -2 a1/z.
Nucleus dipole_field(const Material& m, const Vec2& x, const Dipoles& sent);

}  // namespace kerf
