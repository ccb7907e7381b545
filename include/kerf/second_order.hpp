#pragma once
// The second term: J(Omega_eps) - J(Omega) = pi eps^2 (T + c2 eps^2 + c3 eps^2 ln eps + ...) for free holes and
// circular inclusions [theory: Q.5, Q.8].

#include "kerf/analysis.hpp"
#include "kerf/perturbation.hpp"

#include <memory>
#include <string>
#include <string_view>

namespace kerf {

/// What is known of the term eps^2 ln eps. Absent: there is none, the series has even powers alone.
enum class Logarithm { Absent, Known, Unknown };
/// As in result.json: "absent", "known", "fitted".
std::string_view word(Logarithm logarithm);

struct SecondOrder {
  Vec2 at = Vec2::Zero();
  double T = nan, c2 = nan;
  double c3 = nan;  // 0 where there is no logarithm
  Logarithm logarithm = Logarithm::Unknown;
  bool available = false;  // T and c2 are known
  std::string note;        // why not
  // What c2 is the sum of: gradients of the mean stress and of the deviator at the point, curvature of the mean stress,
  // and the reply of the body to what the change sends out.
  double mean_gradient = nan, deviator_gradient = nan, curvature = nan, reply = nan;

  /// Up to this radius the second term is at most `share` of the first; 0 where T vanishes.
  double valid_radius(double share = 0.05) const;
};

/// c2 at points of one analysis: of energies and compliances, and of functionals linear in the state by their adjoint,
/// in one isotropic material without body force and eigenstrain; contact as it is, as its ends move J by O(eps^6)
/// only. One back-substitution per point and body.
class SecondOrders {
 public:
  /// Analysis and functional must outlive it.
  SecondOrders(const Analysis& a, const Functional& j, const Perturbation& p);
  ~SecondOrders();

  /// Not available outside the body, and where the mesh is too coarse for the distance to the next feature.
  SecondOrder at(const Vec2& x);

  /// The radius at which the body answers a change at x by as much stress as lies there before, mean stress or deviator
  /// (what is below 5 % of the other aside): only far below it does J follow its series. As large as the distance to
  /// what holds or bounds the body, but small where it is held all around and nearly incompressible. Of a hole, where
  /// the change is no circle. NaN where no reply can be solved for: outside the body, next to features, in several
  /// materials, orthotropic ones, elements without an adjoint.
  double answer_radius(const Vec2& x);
  /// The vertex farthest from all features, of a few hundred: where the answer is best known.
  Vec2 roomiest() const;

  /// Why c2 is known nowhere in the body; empty where it is known away from features.
  const std::string& unknown() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// One of these.
SecondOrder second_order(const Analysis& a, const Functional& j, const Perturbation& p, const Vec2& x);

}  // namespace kerf
