// Intervals of what a design is bound by, on the mesh by which it is judged, term by term:
//   release rate of a crack:        G of the interval of K_I, K_II at its tip     [theory: B.11, B.12]
//   integral of the squared stress: from the two-sided bounds of the energy       [theory: B.25, B.26]
//   volume: known
// and powers, factors and sums of them; under several load cases the larger one has max of the ends. Cracks that may
// touch and are open everywhere have the interval of the open crack, not guaranteed. Where the design has arcs and the
// mesh chords, the interval is that of the polygon and says so. Everything else has none, with the reason.
// docs/theory/guarantees.md, "What is guaranteed of an optimised design".

#include "optimize/loop/intervals.hpp"

#include "geometry/curved.hpp"
#include "optimize/loop/history_text.hpp"
#include "solver/open_faces.hpp"
#include "solver/stress_norm.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace kerf {

namespace {

constexpr double same_place = 1e-9;  // of the extent, and of directions

Bounded no_interval(std::string why) {
  return {nan, nan, nan, false, std::move(why)};
}

bool is_bounded(const Bounded& b) {
  return std::isfinite(b.upper);
}

/// The end of the crack by which it grows in the direction of the term; nothing where it is no such end.
/// The end at the feature of the term by which the crack grows along its direction; an arc's tangent is not compared.
std::optional<TipIntensity> tip_of(const Term& term, const Shape& shape) {
  const double near = same_place * extent(shape);
  for (std::size_t k = 0; k < shape.cracks.size(); ++k) {
    const Crack& crack = shape.cracks[k];
    const std::size_t last = crack.points.size() - 1;
    for (const bool at_start : {true, false}) {
      const Vec2 &end = crack.points[at_start ? 0 : last], &before = crack.points[at_start ? 1 : last - 1];
      const bool along = (end - before).normalized().dot(term.tip->along) > 1 - same_place;
      if ((end - term.feature).norm() <= near && (along || crack.arc))
        return TipIntensity{.crack = static_cast<Index>(k), .at_start = at_start, .at = end};
    }
  }
  return std::nullopt;
}

/// factor * b^power of what is not negative.
Bounded scaled(const Term& term, Bounded b) {
  for (double* x : {&b.value, &b.lower, &b.upper}) {
    if (term.power != 1) *x = std::pow(std::max(*x, 0.0), term.power);
    *x *= term.factor;
  }
  if (term.factor < 0) std::swap(b.lower, b.upper);
  return b;
}

// Ends of intervals add; the note is that of the first one that is not guaranteed.
void add(Bounded& sum, const Bounded& b) {
  sum.value += b.value;
  sum.lower += b.lower;
  sum.upper += b.upper;
  if (b.guaranteed) return;
  sum.guaranteed = false;
  if (sum.note.empty()) sum.note = b.note;
}

/// Of one load case. What several terms need is made once.
class CaseIntervals {
 public:
  CaseIntervals(const Evaluated& e, const SolvedCase& c, int threads) : e_(e), c_(c), threads_(threads) {}

  Bounded operator()(const Functional& j) try {
    Bounded sum{.guaranteed = true};
    for (const Term& term : j.terms) {
      // One term without an interval leaves the sum without one.
      const Bounded b = term.tip                ? at_tip(term)
                        : term.stress_power > 0 ? stress(term)
                        : term.volume           ? volume()
                                                : no_interval(fmt::format("no bound: of {} there is none", term.kind));
      if (!is_bounded(b)) return b;
      add(sum, scaled(term, b));
    }
    if (arcs_of(e_.shape).empty() || !c_.model.mesh.arc.empty()) return sum;
    if (!sum.guaranteed) sum.note = join({sum.note, of_polygon});
    qualify(sum, of_polygon);
    return sum;
  } catch (const Error& error) {
    if (!of_one_body(error)) throw;
    return no_interval(fmt::format("no bound: {}", error.what()));
  }

 private:
  Bounded volume() const {
    return {.value = e_.area, .lower = e_.area, .upper = e_.area, .guaranteed = true};
  }

  // The square of the von Mises stress is a quadratic form of the stress, whose bounds follow from energies.
  Bounded stress(const Term& term) const {
    if (term.largest) return no_interval("no bound: of the largest stress there is none");
    if (term.stress_power != 2)
      return no_interval(
          fmt::format("no bound: the von Mises stress to the power {:g} has none, its square alone "
                      "follows from energies",
                      term.stress_power));
    if (term.uses_place) return no_interval("no bound: of the von Mises stress with a weight there is none");
    return squared_stress_bounds(c_.model, c_.state, [&term](const Material& material, const Mat2& stress) {
      return term.density({.x = Vec2::Zero(), .stress = stress, .material = material}).value;
    });
  }

  Bounded at_tip(const Term& term) {
    if (term.tip->quantity == TipQuantity::Equivalent)
      return no_interval("no bound: the equivalent K has none; bound energy_release_rate, its square over E'");
    const std::optional<TipIntensity> tip = tip_of(term, e_.shape);
    if (!tip) return no_interval("no bound: it is of a tip along no crack of the design");
    if (!faces_) {
      // Contact that is open everywhere has the state of the open crack, which is linear.
      if (open_everywhere(c_.model, c_.state)) opened_.emplace(opened(c_.model, threads_));
      faces_.emplace(opened_ ? opened_->model : c_.model, opened_ ? opened_->state : c_.state);
    }
    const TipBounds bounds = faces_->tip(*tip);
    Bounded b = term.tip->quantity == TipQuantity::ReleaseRate   ? bounds.G
                : term.tip->quantity == TipQuantity::OpeningMode ? bounds.K_I
                                                                 : bounds.K_II;
    if (opened_) qualify(b, of_opened);
    return b;
  }

  const Evaluated& e_;
  const SolvedCase& c_;
  int threads_;
  std::optional<Opened> opened_;
  std::optional<QuantityBounds> faces_;  // of the cracks as they are, or opened
};

bool may_have_interval(const Functional& j) {
  return std::ranges::any_of(j.terms, [](const Term& t) { return t.tip || t.stress_power > 0; });
}

/// What the larger of two quantities lies in.
/// max is monotone in both: the ends of the larger quantity are the larger ends.
Bounded worst(const Bounded& a, const Bounded& b) {
  if (!is_bounded(a)) return a;
  if (!is_bounded(b)) return b;
  return {std::max(a.value, b.value), std::max(a.lower, b.lower), std::max(a.upper, b.upper),
          a.guaranteed && b.guaranteed, a.note.empty() ? b.note : a.note};
}

}  // namespace

// None where no bound can have one: the energies are not solved for.
std::vector<Bounded> intervals_of(const Evaluated& e, int threads) {
  std::vector<Bounded> all(e.bounded.size(), no_interval({}));
  if (std::ranges::none_of(e.bounded, may_have_interval)) return all;
  for (std::size_t i = 0; i < e.cases.size(); ++i) {
    CaseIntervals of(e, e.cases[i], threads);
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (!may_have_interval(e.bounded[k])) continue;
      const Bounded b = of(e.bounded[k]);
      all[k] = i == 0 ? b : worst(all[k], b);
    }
  }
  return all;
}

}  // namespace kerf
