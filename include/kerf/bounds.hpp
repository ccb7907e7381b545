#pragma once
// Two-sided bounds of the potential energy, and of stresses, K, G, displacements and forces [theory: B.1].

#include "kerf/field.hpp"
#include "kerf/fracture.hpp"
#include "kerf/state.hpp"

#include <memory>
#include <string>
#include <vector>

namespace kerf {

/// lower <= J(u) <= upper for the exact u [Prager, Synge 1947], J(v) = 1/2 a(v, v) - l(v). Lower: the stress of the
/// solution made exactly symmetric, in equilibrium, and without tension anywhere on unilateral cracks. Upper: a
/// displacement that takes the prescribed values, with [v].n >= 0 all along unilateral cracks. The data enter as
/// polynomials (body force of degree trace + 1 per triangle, tractions of degree 5 and displacements of degree 7 per
/// edge). What these leave out widens the bounds by at most `oscillation`: of forces by inequalities with known
/// constants, of prescribed displacements by an estimate. Not available where data are not resolved by any rule.
struct EnergyBounds {
  double lower = 0, upper = 0;  // nan: not available
  double oscillation = 0;
  bool guaranteed = false;  // up to rounding, black boxes as sampled; estimates are below 1 % of upper - lower
  std::string note;         // why not available, or not guaranteed
  // Rounding, of the equilibrated stress: the largest |s12 - s21| relative to its largest component; the work of what
  // its tractions lack in balance, of tension on cracks and of penetration, relative to the works that make up the
  // energy.
  double asymmetry = 0, imbalance = 0;
};

/// For mixed elements with a rotation that is discontinuous between triangles, and cracks without friction.
EnergyBounds energy_bounds(const Model& model, const Field& state);

/// A quantity of the exact solution: lower <= it <= upper when `guaranteed` (as EnergyBounds); `value` is the middle.
struct Bounded {
  double value = 0, lower = 0, upper = 0;  // nan: not available
  bool guaranteed = false;
  std::string note;  // why not available, or not guaranteed
};

/// Not guaranteed, and why; what is not already keeps its own note.
void qualify(Bounded& b, const std::string& why);

/// What its square lies in.
Interval squared(const Bounded& b);

/// Of the stress at a point: its components, and what follows from them by interval arithmetic.
struct StressBounds {
  Bounded trace, difference;  // s11 + s22, (s22 - s11)/2
  Bounded s11, s22, s12;
  std::vector<Eigen::VectorXd> eta = {};  // the indicators of the dual solutions of trace, difference and s12, if asked
};
/// Where stresses are averaged: over a disc, or along a straight line.
struct OverDisc {
  Vec2 center = Vec2::Zero();
  double radius = 0;
};
struct AlongLine {
  Vec2 from = Vec2::Zero(), to = Vec2::Zero();
};
/// Of the mean strain where the mean stress is that: the material is one and isotropic there.
struct StrainBounds {
  Bounded e11, e22, e12;
};
StrainBounds strain_bounds(const Material& material, const StressBounds& stress);
/// Of an end of a crack; the indicators are those of K_I and K_II.
struct TipBounds {
  Bounded K_I, K_II, G;
  std::vector<Eigen::VectorXd> eta = {};
};
/// Of the von Mises stress; in plane strain with s33 = nu (s11 + s22).
Bounded von_mises_bounds(const Material& material, bool plane_strain, const StressBounds& stress);

/// Quantities that are asked for together.
struct QuantityRequest {
  struct Reaction {
    std::vector<Index> labels;
    int component = 0;
  };
  std::vector<TipIntensity> tips = {};
  std::vector<Vec2> points = {};
  std::vector<OverDisc> discs = {};
  std::vector<AlongLine> lines = {};
  std::vector<std::vector<Traction>> works = {};
  std::vector<Reaction> reactions = {};
};
/// Their intervals, in the same order.
struct QuantityIntervals {
  std::vector<TipBounds> tips;
  std::vector<StressBounds> points, discs, lines;
  std::vector<Bounded> works, reactions;
};

/// Bounds of linear quantities Q of a state. Q = known + l(u) by a singular field that is taken out in closed form; w
/// is the solution under the loads l, and with J(u) the potential energy -2k l = J(u + k w) - J(u - k w), both bounded
/// [theory: B.11]. One solve by the factor of the model per quantity; what depends on the mesh is done once for eight
/// of them [theory: B.30], so that many together cost a fraction of as many one by one. With body force, several
/// materials, kinks and pressure in cracks the singular field is cut off about its place [theory: B.20], where the
/// material must be isotropic and without eigenstrain: otherwise `note` says why there is no interval. Where a crack
/// may be in contact, stresses are those of ContactQuantityBounds, and there is no K.
class QuantityBounds {
 public:
  /// Model and state must outlive it. `with_indicators`: the error indicator of each dual solution, which says where a
  /// finer mesh narrows the interval.
  QuantityBounds(const Model& model, const State& state, bool with_indicators = false);
  ~QuantityBounds();

  /// As the functions below, all at once.
  QuantityIntervals all(const QuantityRequest& request) const;

  /// At a point inside the body.
  StressBounds stress(const Vec2& x) const;
  /// The mean over a disc inside the body [theory: B.21]. Its edge and what surrounds it must be free of boundaries,
  /// cracks with faces and other materials.
  StressBounds mean_stress(const OverDisc& where) const;
  /// The mean along a line inside the body, in its frame: 11 along it, 22 across, 12 with the normal that is the
  /// direction of the line turned by +90 degrees [theory: B.22].
  StressBounds mean_stress(const AlongLine& where) const;
  /// Of an end of a straight crack.
  TipBounds tip(const TipIntensity& tip) const;
  /// The work of given tractions on the displacement of their edges: a mean displacement [theory: B.23].
  Bounded work(const std::vector<Traction>& of) const;
  /// That of all loads of the state, the compliance.
  Bounded work_of_loads() const;
  /// Component 0 (x) or 1 (y) of the force that the supports of these labels exert on the body, as far as they hold it
  /// [theory: B.24].
  Bounded reaction(const std::vector<Index>& labels, int component) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Bounds of linear quantities Q of a state whose cracks may be in contact without friction, wherever they are closed.
/// With J(k) the potential energy under the loads of the state and k times those of w, Q = known - J'(0). CrossedWorks:
/// Q by central differences of bounds of J, the pressure at k doing work on the opening at -k and the other way round
/// [theory: B.16]. Concavity: by chords of J and its curvature between those of the body with free and with sliding
/// faces [theory: B.15]; wider, and for comparison. Two contact problems per step, at most four steps per quantity, by
/// the factor of the model (Concavity: and one of the body with free faces). No K at tips of cracks in contact, nothing
/// with friction, an eigenstrain or curved cracks in contact: `note` says so.
class ContactQuantityBounds {
 public:
  enum class Theorem { Concavity, CrossedWorks };
  /// Model and state must outlive it.
  ContactQuantityBounds(const Model& model, const Field& state, Theorem by = Theorem::CrossedWorks);
  ~ContactQuantityBounds();

  /// The work of given tractions on the displacement of their edges: a mean displacement, a mean strain.
  Bounded work(const std::vector<Traction>& of) const;
  Bounded work_of_loads() const;
  Bounded reaction(const std::vector<Index>& labels, int component) const;
  /// At a point inside the body, without indicators.
  StressBounds stress(const Vec2& x) const;
  /// As QuantityBounds.
  StressBounds mean_stress(const OverDisc& where) const;
  StressBounds mean_stress(const AlongLine& where) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kerf
