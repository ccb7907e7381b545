#pragma once
// Guaranteed intervals of T at points, from those of the stresses there.

#include "kerf/bounds.hpp"
#include "kerf/functional.hpp"

#include <memory>

namespace kerf {

/// T = form(s, dual - energy_share/2 s) [theory: T.4] of a circular hole or inclusion lies in the range of
/// that form over the intervals of the two stresses [theory: B.27]. For sums of energies, compliances, misfits, volumes
/// and functionals that are linear in the displacement (Term::linear): these have an adjoint, which is the same body
/// under other loads, so that its stress is bounded like that of the state, with three more quantities per point. Not
/// where a crack may be in contact and J has an adjoint, nor for a hole in a body with a body force or where J weighs
/// the displacement in it; `note` says why there is none.
class DerivativeBounds {
 public:
  /// The model must outlive it. `with_indicators`: of the adjoint and its dual solutions, as QuantityBounds.
  DerivativeBounds(const Functional& j, const Perturbation& p, const Model& model, bool with_indicators = false);
  ~DerivativeBounds();

  /// From the bounds of the stress of the state at x. The indicators that are asked for are added to those of `stress`.
  Bounded at(const Vec2& x, StressBounds& stress) const;
  /// At several points, which costs less than one by one.
  std::vector<Bounded> at(const std::vector<Vec2>& x, std::vector<StressBounds>& stress) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kerf
