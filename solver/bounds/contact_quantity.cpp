// Intervals of quantities of bodies whose cracks may be in contact, without friction. With J(k) the least energy under
// the loads L + k l the quantity is Q = known - J'(0) [theory: B.13], and two theorems bound J'(0) by energies at -k, 0
// and k, whatever the sets of contact are:
//   concavity: J(k) - k^2 J_tied is concave, J(k) - k^2 J_open convex      [theory: B.14, B.15];
//   crossed works: -J'(0) <= (Pi_-k(v_-) - Pi*_k(p_+) + int P_+ [v_-]_n)/(2 k), alike from below  [theory: B.16].
// All energies are replaced by their bounds on the safe side. A small k costs gap/k, a large one the change of the
// contact set; k is taken from a model of the width that is fitted to the steps before. docs/theory/bounds.md,
// "Quantities of bodies whose cracks may be in contact". The formulas themselves are in solver/bounds/load_steps.cpp.

#include "kerf/bounds.hpp"

#include "kerf/adjoint.hpp"
#include "solver/bounds/bounded.hpp"
#include "solver/bounds/dual.hpp"
#include "solver/bounds/faces.hpp"
#include "solver/bounds/load_steps.hpp"
#include "solver/system.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace kerf {

namespace {

std::string no_contact_bounds_because(const Model& m) {
  for (const CrackLaw& law : m.scene.laws)
    if (has_friction(law)) return "no bounds: with friction the solution does not minimize an energy";
  if (has_eigenstrain(m.scene)) return "no bounds: there is an eigenstrain";
  return {};
}

/// A prescribed displacement or a pressure is sampled together with that of the dual: what is proved of it alone, where
/// it is no polynomial, does not reach the sum.
std::string sampled_in_sums(const Model& m) {
  const auto rough = [](const BoundaryField& f) { return f && f.known() && f.known()->degree() < 0; };
  for (const Support& support : m.scene.supports)
    if (rough(support.value))
      return "the bounds are estimates: a prescribed displacement is sampled together with the singular field";
  for (const CrackLaw& law : m.scene.laws)
    if (rough(law.pressure))
      return "the bounds are estimates: the pressure in a crack is sampled together with the singular field";
  return {};
}

/// The solution under the loads of m with faces that slide and neither open nor overlap.
/// All rows in contact are held at [w]_n = 0, a tangent cone without one-sidedness: one linear solve.
Field sliding(const Model& m) {
  const std::vector<bool> held(m.inner->ordering.contact_rows, true);
  return TangentSolver(m, held).solve(m.inner->system.tractions, m.inner->skeleton.prescribed);
}

/// The width of an interval at the step k, as far as three numbers tell: gap/k + bend k + cross k^2. The ends of
/// contact move by O(k), there pressures are O(k^1/2) and openings O(k^3/2).
/// The product of a pressure O(k^1/2) and an opening O(k^3/2) over a length O(k) is O(k^3), divided by k. See "Order"
/// in docs/theory/bounds.md.
struct Width {
  double gap, bend, cross;
  double at(double k) const {
    return gap / k + bend * k + cross * k * k;
  }
  /// The best step within a factor of 1000 of k.
  double best(double k) const {
    double best = k;
    for (int i = -100; i <= 100; ++i)
      if (const double step = k * std::pow(10, 0.03 * i); at(step) < at(best)) best = step;
    return best;
  }
};

Enclosed enclosed(const EnergyBounds& b) {
  return {b.lower, b.upper};
}

double gap_of(const EnergyBounds& b) {
  return b.upper - b.lower;
}

bool finite(const EnergyBounds& b) {
  return std::isfinite(gap_of(b));
}

/// What is found on the way to an interval of -J'(0).
struct Search {
  Interval interval;
  bool guaranteed = true;
  std::string note, lost;  // lost: why there is no interval

  void rely_on(const EnergyBounds& b) {
    if (!finite(b)) lost = b.note;
    if (b.guaranteed) return;
    guaranteed = false;
    note = b.note;
  }
};

}  // namespace

struct ContactQuantityBounds::Impl {
  Model m;  // all of its boundary labelled
  EnergyBounds energy;
  double own_work = 0;  // of the admissible pressure on the admissible opening, a part of the gap
  std::string why;      // nothing can be bounded
  Theorem by;
  mutable std::optional<Model> free;  // the body with free faces

  /// J(-k) and J(k); `w`: the loads l.
  /// Two solves with the factor of the body, one for each sign.
  LoadSteps steps(const Scene& w, double k, Search& search) const {
    std::array<EnergyBounds, 2> of;
    std::array<FaceFields, 2> faces;
    for (const int side : {0, 1}) {
      const Model model = with_loads(m, superposed(m.scene, w, side == 0 ? -k : k));
      of[side] = energy_bounds(model, solve(model), faces[side]);
      search.rely_on(of[side]);
      if (!search.lost.empty()) return {};
    }
    return {k, enclosed(of[0]), enclosed(of[1]), crossed_work(faces[0], faces[1]), crossed_work(faces[1], faces[0])};
  }

  /// Of w with free faces.
  EnergyBounds energy_with_free_faces(Scene w) const {
    for (CrackLaw& law : w.laws)
      if (is_unilateral(law)) law.kind = CrackLaw::Kind::Open;
    if (!free) free = prepare(m.mesh, m.element, w, m.threads);
    const Model model = with_loads(*free, std::move(w));
    return energy_bounds(model, solve(model));
  }

  /// gap/k + bend k is least at k = sqrt(gap/bend). Every step costs two solves, and the intervals are intersected: all
  /// hold.
  Search by_chords(const Scene& w, const EnergyBounds& tied) const {
    Search search;
    search.rely_on(energy);
    search.rely_on(tied);
    const EnergyBounds open = energy_with_free_faces(w);
    search.rely_on(open);
    if (!search.lost.empty()) return search;
    const Curvature curvature{open.lower, tied.upper};
    const double bend = gap_of(open) + tied.upper - open.lower,
                 k = gap_of(energy) > 0 && bend > 0 ? std::sqrt(gap_of(energy) / bend) : 1;
    // The chord to 0 is the better one where most faces stay closed: longer steps.
    for (const double step : {k, 2 * k, 4 * k}) {
      const LoadSteps s = steps(w, step, search);
      if (!search.lost.empty()) return search;
      search.interval = intersection(search.interval, by_concavity(s, enclosed(energy), curvature));
    }
    return search;
  }

  /// `scale`: of the energy of w.
  /// The first step knows the energy of w alone; the next ones the width at the step before, in its three parts.
  /// `worth`: less than a tenth to be gained is not worth two solves.
  Search by_works(const Scene& w, double scale) const {
    Search search;
    const double gap = std::max(gap_of(energy), 0.0);
    double k = gap > 0 && scale > 0 ? std::sqrt(gap / scale) : 1;
    constexpr int most = 4;
    for (int i = 0; i < most; ++i) {
      const LoadSteps s = steps(w, k, search);
      if (!search.lost.empty()) return search;
      search.interval = intersection(search.interval, by_crossed_works(s));
      const double both = s.less.upper - s.less.lower + s.more.upper - s.more.lower;
      const Width width{gap + own_work, std::max(0.5 * both - gap, 0.0) / (k * k),
                        std::max(0.5 * (s.less_on_more + s.more_on_less) - own_work, 0.0) / (k * k * k)};
      const double next = width.best(k);
      constexpr double worth = 0.9;
      if (width.at(next) > worth * width.at(k)) break;
      k = next;
    }
    return search;
  }

  /// Concavity needs an upper bound of J_tied; crossed works take the energy of the tied solution for a scale alone.
  Bounded bound(const Scene& w, const Known& known, const std::string& estimate) const {
    const std::string sums = sampled_in_sums(m), &coarse = estimate.empty() ? sums : estimate;
    const Model dual = with_loads(m, w);
    const Field tied = sliding(dual);
    const Search s =
        by == Theorem::Concavity ? by_chords(w, energy_bounds(dual, tied)) : by_works(w, strain_energy(dual, tied));
    if (!s.lost.empty()) return kerf::lost(s.lost);
    if (!std::isfinite(known.error)) return kerf::lost(not_integrated);
    Bounded b;
    b.lower = known.value - known.error + s.interval.low;
    b.upper = known.value + known.error + s.interval.high;
    b.value = 0.5 * (b.lower + b.upper);
    const bool resolved = is_resolved(known, b.upper - b.lower);
    b.guaranteed = s.guaranteed && resolved && coarse.empty();
    if (!b.guaranteed) b.note = !s.guaranteed ? s.note : !resolved ? std::string(work_sampled) : coarse;
    return b;
  }

  /// What the loads push that nothing holds is no quantity.
  Bounded try_bound(const Scene& w, const Known& known, const std::string& coarse) const {
    if (!why.empty()) return lost(why);
    try {
      return bound(w, known, coarse);
    } catch (const Error& error) {
      return lost(std::string("no bounds: ") + error.what());
    }
  }

  StressBounds stress(const StressPlace& where) const {
    const StressDuals of = stress_duals(m, where, why);
    std::vector<BoundedDual> all;
    for (const DualProblem& dual : of.duals) all.push_back({try_bound(dual.loads, dual.known, dual.estimate), {}});
    return stress_of(of, all);
  }
};

ContactQuantityBounds::ContactQuantityBounds(const Model& m, const Field& u, Theorem by)
    : impl_(std::make_unique<Impl>(Impl{m, {}, 0, no_contact_bounds_because(m), by, {}})) {
  if (!impl_->why.empty()) return;
  FaceFields faces;
  impl_->energy = energy_bounds(m, u, faces);
  impl_->own_work = crossed_work(faces, faces);
  if (!finite(impl_->energy))
    impl_->why = impl_->energy.note;
  else
    impl_->m.mesh = labelled(std::move(impl_->m.mesh));
}
ContactQuantityBounds::~ContactQuantityBounds() = default;

Bounded ContactQuantityBounds::work(const std::vector<Traction>& of) const {
  Scene loads = at_rest(impl_->m);
  loads.tractions = of;
  return impl_->try_bound(loads, {}, {});
}

Bounded ContactQuantityBounds::work_of_loads() const {
  if (!impl_->why.empty()) return lost(impl_->why);
  if (works_twice_its_energy(impl_->m)) return twice_energy(impl_->energy);
  return impl_->try_bound(loads_dual(impl_->m).loads, {}, {});
}

Bounded ContactQuantityBounds::reaction(const std::vector<Index>& labels, int component) const {
  if (std::string why = no_reaction(impl_->m, labels, component); !why.empty()) return lost(std::move(why));
  return impl_->try_bound(reaction_dual(impl_->m, labels, component).loads, {}, {});
}

StressBounds ContactQuantityBounds::stress(const Vec2& x) const {
  return impl_->stress(StressPlace::point(x));
}

StressBounds ContactQuantityBounds::mean_stress(const OverDisc& d) const {
  return impl_->stress(StressPlace::of(d));
}

StressBounds ContactQuantityBounds::mean_stress(const AlongLine& line) const {
  return impl_->stress(StressPlace::of(line));
}

}  // namespace kerf
