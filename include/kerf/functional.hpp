#pragma once
// What is minimized: J = sum of factor * (integrals of densities)^power. A new functional is one small file under
// topo/functional/ that fills in a Term.

#include "kerf/perturbation.hpp"
#include "kerf/scene.hpp"

#include <array>
#include <memory>
#include <optional>
#include <string>

namespace kerf {

using ScalarField = std::function<double(const Vec2& x)>;
using BoundaryWeight = std::function<double(const Vec2& x, const Vec2& n)>;

/// The state at a point. Stress as the element has it (weakly symmetric).
struct FieldPoint {
  Vec2 x;
  Mat2 stress = Mat2::Zero();
  Vec2 displacement = Vec2::Zero();  // u* of recover.hpp
  double rotation = 0;
  Material material = {};
};
/// Value of a density and its derivatives by the state.
struct Density {
  double value = 0;
  Mat2 by_stress = Mat2::Zero();
  Vec2 by_displacement = Vec2::Zero();
  double by_rotation = 0;
};
/// At a point of a crack: jumps of the left face against the right, n to the left; traction components through it.
struct CrackState {
  Vec2 x;
  double jump_n = 0, pressure = 0;
};
struct CrackDensity {
  double value = 0, by_jump_n = 0, by_pressure = 0;
};

/// Cracks of one length that may begin anywhere on parts of the boundary, normal to it [theory: M.8]: the integral of
/// w max(K_I, 0)^p along it, K_I = sqrt(pi length) sum_k (weight_k + curvature length bend_k) s_t(depth_k length), with
/// the stress s_t along the boundary at these depths. w falls from 1 to 0 between 5 and 2.5 lengths from corners and
/// other places where the stress may be infinite.
struct EdgeCrackNorm {
  double length = 0, p = 0;
  std::vector<Index> labels = {};
  std::array<double, 3> depth = {}, weight = {}, bend = {};  // depths over the length
};

struct LargestStress;  // kerf/max_stress.hpp

/// A quantity of a crack tip: G, K_I, K_II, or the equivalent K = sqrt(E' G), by the direction in which the crack
/// grows.
enum class TipQuantity { ReleaseRate, OpeningMode, SlidingMode, Equivalent };
struct OfTip {
  TipQuantity quantity = TipQuantity::ReleaseRate;
  Vec2 along = Vec2::UnitX();
};

/// One term. Parts that are empty do not occur.
struct Term {
  std::string kind;  // as in a case file, for messages and results: nothing is decided by it
  double factor = 1;
  double power = 1;     // of the integral (1/p of a norm)
  bool linear = false;  // in the state
  bool volume = false;  // the integral of 1

  // The potential energy, and the Kohn-Vogelius gap between the state and one with measured displacements: their
  // topological derivatives need no adjoint (Danskin).
  bool energy = false;
  bool work = false;                     // the work of the loads
  std::optional<Support> measured = {};  // replaces the tractions on its label

  // Integral over the body.
  std::function<Density(const FieldPoint&)> density = {};
  double stress_power = 0;  // of stress_power, stress_pnorm and max_stress: not integrable at crack tips from 4 on
  std::shared_ptr<const LargestStress> largest = {};  // its value is a largest stress, not the integral to its power
  bool uses_stress = false, uses_displacement = false, uses_rotation = false;
  bool uses_place = true;  // depends on x by itself
  /// Weights and targets of the density, and of what is integrated over boundary or crack: where what is known of them
  /// says so, the integrals look at more points.
  std::vector<VectorField> varies = {};
  std::vector<BoundaryField> varies_along = {};
  std::function<bool(const Vec2& center, double radius)> somewhere = {};  // false: the density vanishes on that disc

  // Integral over a labeled part of the boundary, of the displacement there.
  Index label = none;
  std::function<Density(const Vec2& x, const Vec2& n, const Vec2& u)> on_boundary = {};

  // Integral over parts of the boundary, of the stress beneath it.
  std::optional<EdgeCrackNorm> edge_cracks = {};

  // Integral over a crack.
  Index crack = none;
  std::function<CrackDensity(const CrackState&)> on_crack = {};

  /// What the change of the density itself adds to T at a point, besides form(sigma, zeta) - b.p. Empty: minus the
  /// density in a hole, nothing otherwise (right for densities of the displacement). Throws Error(Usage) for a
  /// perturbation that it does not know.
  std::function<double(const Perturbation&, const FieldPoint&)> local = {};
  /// Points too close to a feature of the functional itself (the ring of a tip): its radius about it; 0: none.
  Vec2 feature = Vec2::Zero();
  double feature_radius = 0;
  std::optional<OfTip> tip = {};  // what it is of the tip at `feature`
};

struct Functional {
  std::string kind = "energy";  // as above
  std::vector<Term> terms;
  bool sum = false;  // of terms of their own kinds: results list them
};

// Empty weights: 1.
Term energy();
Term compliance();
Term volume();
Term displacement_tracking(VectorField target, ScalarField weight);
Term boundary_tracking(Index label, BoundaryField target, BoundaryWeight weight);
/// The displacement along `direction` on the label: a mean when weighted by one over its length.
Term boundary_displacement(Index label, BoundaryField direction, BoundaryWeight weight);
Term stress_power(double p, ScalarField weight, bool plane_strain);
Term stress_pnorm(double p, ScalarField weight, bool plane_strain);
Term misfit(Index label, BoundaryField measured);
/// G of one tip: int sigma : (grad u grad theta) - 1/2 sigma : eps div theta, theta = direction times a cut-off that
/// falls from 1 to 0 between ring[0] and ring[1] [Destuynder, Djaoua 1981].
Term energy_release_rate(const Vec2& tip, const Vec2& direction, const std::array<double, 2>& ring, VectorField body);
/// K_I, K_II of one tip by the interaction integral over the same ring, or sqrt(E' G) [Yau, Wang, Corten 1980; theory:
/// T.39]; isotropic materials, a crack that is straight within the ring, faces without friction and without a pressure
/// of their own. `crack`: of K_I where its faces may touch, whose pressure opens the tip; none otherwise.
Term stress_intensity(const OfTip& of, const Vec2& tip, const std::array<double, 2>& ring, VectorField body,
                      Index crack = none);
Term crack_opening(Index crack, ScalarField weight);
Term crack_pressure(Index crack, ScalarField target, ScalarField weight);

}  // namespace kerf
