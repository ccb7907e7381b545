// Growth of cracks, step by step:
//   state at the loads of a cycle -> K, T at the tips -> which tips grow, and how far (rates, or the tip that needs the
//   least load) -> the direction: predicted by the kink series [theory: G.1], then found on the grown body itself:
//   k_2 = 0 at the new tip [theory: G.21] -> the next state.
// The first piece from a tip that is loaded in shear is straight, at the kink angle; later ones are arcs that leave the
// crack without a kink, drawn by chords as long as the edges at the tip: the path is C1 and its error of second order
// in the step. K is linear in the load where faces do not change what they do, so that states at other loads are solved
// only with gaps, with strains of their own, or where loads change their sign. A tip crosses the border of a region
// within a step, whose length is such that it ends clear of the border, with rings for K in one material, and goes on
// by the law of that region. docs/theory/growth.md.

#include "kerf/growth.hpp"

#include "geometry/plane.hpp"
#include "growth/kink.hpp"
#include "growth/life.hpp"
#include "growth/obstacles.hpp"
#include "growth/path_bounds.hpp"
#include "growth/piece.hpp"
#include "growth/rates.hpp"
#include "growth/spectrum.hpp"
#include "growth/step.hpp"
#include "growth/symmetry_search.hpp"
#include "kerf/fracture.hpp"
#include "kerf/mesher.hpp"
#include "kerf/stop.hpp"
#include "solver/stress.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>

namespace kerf::growth {

namespace {

// A piece that turns is drawn by so many chords, as long as the edges at the tip, so that K is taken on rings as wide
// as the piece (solver/post/crack_tip.cpp sees a smooth curve); behind the next piece every fourth vertex stays.
constexpr int piece_chords = 12, kept = 4;  // of a piece that turns
constexpr double largest_turn = 0.26;       // radians: a piece turns by no more, else it begins with a kink
constexpr double behind_kink = 0.125;       // of a step: the first piece there
constexpr double symmetric = 1e-3;          // |k_2| / k_1 at a tip that has grown
constexpr double tie = 1e-2;                // tips that need the same load, relative
constexpr double clear = 0.5;               // of a step: room of a tip beside a border, for rings in one material
constexpr double shortest = 0.1;  // of the fastest tip's piece: a slower tip waits until it has so much to grow
constexpr double facing = 0.35;   // radians: tips that look at each other, off the line between them

constexpr const char* on_border = "on a border between materials, where there is no K";

double angle_of(const Vec2& v) {
  return std::atan2(v.y(), v.x());
}
double within_half_turn(double angle) {
  return std::remainder(angle, 2 * pi);
}

const Vec2& tip_of(const Shape& shape, const CrackEnd& end) {
  const auto& points = shape.cracks[static_cast<std::size_t>(end.crack)].points;
  return end.at_start ? points.front() : points.back();
}
/// In which the crack would go on.
double direction_of(const Shape& shape, const CrackEnd& end) {
  const auto& p = shape.cracks[static_cast<std::size_t>(end.crack)].points;
  return end.at_start ? angle_of(p[0] - p[1]) : angle_of(p[p.size() - 1] - p[p.size() - 2]);
}
std::string name_of(const Shape& shape, const CrackEnd& end) {
  return fmt::format("{}:{}", shape.cracks[static_cast<std::size_t>(end.crack)].name, end.at_start ? "start" : "end");
}

void append(Crack& crack, bool at_start, const std::vector<Vec2>& points) {
  if (!at_start)
    crack.points.insert(crack.points.end(), points.begin(), points.end());
  else
    crack.points.insert(crack.points.begin(), points.rbegin(), points.rend());
}

/// Of the `n` points in front of the last `m` at that end every fourth stays.
void coarsen(Crack& crack, bool at_start, std::size_t m, std::size_t n) {
  std::vector<Vec2>& p = crack.points;
  if (at_start) std::ranges::reverse(p);
  std::vector<Vec2> left(p.begin(), p.end() - static_cast<std::ptrdiff_t>(m + n));
  for (std::size_t k = 1; k <= n; ++k)
    if (n < piece_chords || k % kept == 0) left.push_back(p[p.size() - m - n + k - 1]);
  left.insert(left.end(), p.end() - static_cast<std::ptrdiff_t>(m), p.end());
  p = std::move(left);
  if (at_start) std::ranges::reverse(p);
}

BoundaryField times(double factor, const BoundaryField& field) {
  if (!field) return {};
  return BoundaryField([factor, field](const Vec2& x, const Vec2& n) -> Vec2 { return factor * field(x, n); });
}
/// Loads, prescribed displacements and pressures in cracks times a factor; gaps and strains stay.
Scene with_loads(Scene scene, double factor) {
  if (factor == 1) return scene;
  if (scene.body) scene.body = scaled(factor, scene.body);
  for (Support& s : scene.supports) s.value = times(factor, s.value);
  for (Traction& t : scene.tractions) t.value = times(factor, t.value);
  for (CrackLaw& law : scene.laws) law.pressure = times(factor, law.pressure);
  return scene;
}
/// Whether all answers are proportional to the loads, as long as these keep their sign.
bool is_proportional(const Scene& scene) {
  return !has_eigenstrain(scene) && std::ranges::none_of(scene.laws, [](const CrackLaw& law) {
    return has_gap(law) || (is_unilateral(law) && law.slip_bound > 0);
  });
}

/// A state, with what it was solved on: its body is null where it is known from a record, and is solved again if asked.
struct Solved {
  Shape shape;
  Sizing sizing;
  double load = 1;
  std::shared_ptr<const Adapted> body;
  std::size_t number = 0;  // in the record
  double potential = 0, strain = 0, resting = 0;
  std::map<CrackEnd, TipIntensity> tips;
};

/// The states of growth in the order in which they are asked for: those of a run before first, then new ones.
class Record {
 public:
  explicit Record(GrowthRecord before) : all_(std::move(before)), told_(all_.told) {
    all_.told = 0;
  }
  const SolvedState& next(const std::function<SolvedState()>& solve) {
    if (place_ == all_.states.size()) all_.states.push_back(solve());
    return all_.states[place_++];
  }
  std::size_t place() const {
    return place_;
  }
  const StateBounds& bounds(std::size_t state, const std::function<StateBounds()>& find) {
    std::optional<StateBounds>& of = all_.states[state].bounds;
    if (!of) of = find();
    return *of;
  }
  /// Whether the next step was told by the run before; counts it.
  bool told_before() {
    return ++all_.told <= told_;
  }
  const GrowthRecord& all() const {
    return all_;
  }

 private:
  GrowthRecord all_;
  std::size_t place_ = 0;
  int told_ = 0;
};

class Growing {
 public:
  /// `record` must outlive it.
  Growing(Shape shape, const Sizing& sizing, const Element& e, const Scene& scene, const GrowRequest& request,
          const Adaptation& how, const WatchGrowth& watch, Record& record)
      : shape_(std::move(shape)),
        sizing_(sizing),
        element_(e),
        scene_(scene),
        of_(request),
        how_(how),
        watch_(watch),
        record_(record),
        proportional_(is_proportional(scene)) {
    how_.estimate = false;
    sizing_.size = target_size(sizing_, shape_);
    of_tips_ = sizing_.crack_tip_size;
  }

  Grown run() {
    if (!of_.spectrum.empty() && !proportional_)
      throw Error(
          Fault::Usage,
          "[grow]: K at the levels of a spectrum is found where all is proportional to the loads; gaps, strains of "
          "the material (heat, swelling) and a slip bound are not: take one cycle, or leave them out");
    if (!of_.spectrum.empty()) block_ = merged(rainflow_of_block(of_.spectrum));
    if (!of_.law && !proportional_)
      throw Error(
          Fault::Usage,
          "[grow]: the load at which a crack grows is found where all is proportional to the loads; gaps, strains "
          "of the material (heat, swelling) and a slip bound are not: take a law of fatigue, or leave them out");
    Solved now = solve(shape_, load_of_state());
    choose_tips(now);
    while (grown_.ended.empty()) now = step(std::move(now));
    grown_.shape = shape_;
    grown_.step = step_;
    find_instability();
    grown_.energy_balance = energy_balance();
    grown_.bounds = path_bounds();
    return std::move(grown_);
  }

 private:
  /// Where all is proportional to the loads, the state is that of the loads as they are.
  double load_of_state() const {
    return proportional_ ? 1 : of_.max;
  }

  /// The loads at which K of a tip is told, over those of the state.
  double over_state() const {
    return proportional_ && of_.law ? of_.max : 1;
  }

  Solved solve(const Shape& shape, double load) {
    check_stop();
    ++grown_.solves;
    Solved s{.shape = shape, .sizing = sizing_, .load = load};
    const SolvedState& told = record_.next([&] {
      s.body = solved_body(s);
      const Model& m = s.body->model;
      return SolvedState{.potential = potential_energy(m, s.body->state),
                         .strain = strain_energy(m, s.body->state),
                         .resting = nothing(*s.body),
                         .tips = crack_tips(m, s.body->state)};
    });
    s.number = record_.place() - 1;
    s.potential = told.potential;
    s.strain = told.strain;
    s.resting = told.resting;
    for (const TipIntensity& t : told.tips) s.tips[{t.crack, t.at_start}] = t;
    return s;
  }
  std::shared_ptr<const Adapted> solved_body(const Solved& s) const {
    Adapted body = solve_graded(s.shape, s.sizing, element_, with_loads(scene_, s.load), how_);
    if (!certified(body.state))
      throw Error(Fault::Numerics,
                  fmt::format("a state of growth could not be solved: the equations hold to {:.2g} only",
                              body.state.certificate.kkt));
    return std::make_shared<const Adapted>(std::move(body));
  }
  const Adapted& body_of(Solved& s) const {
    if (!s.body) s.body = solved_body(s);
    return *s.body;
  }

  void choose_tips(const Solved& now) {
    for (const auto& [end, tip] : now.tips) {
      const bool asked = std::ranges::find(of_.tips, end) != of_.tips.end();
      if (!of_.tips.empty() && !asked) continue;
      const Crack& crack = shape_.cracks[static_cast<std::size_t>(end.crack)];
      const bool straight = !crack.arc && crack.points.size() > 1;
      if (straight && std::isfinite(tip.K_I)) {
        active_[end] = {.direction = direction_of(shape_, end)};
        continue;
      }
      if (!asked) {
        if (tip.on_border)
          grown_.notes.push_back(fmt::format("{} stays as it is: it lies {}", name_of(shape_, end), on_border));
        continue;
      }
      throw Error(
          Fault::Usage,
          fmt::format("grow.tips: {} cannot grow: {}", name_of(shape_, end),
                      tip.on_border ? fmt::format("it lies {}; let it end before the border or behind it", on_border)
                      : straight    ? "there is no K at this tip, beside which the mesh is too coarse or "
                                      "something else is too near"
                                    : "its crack is an arc; draw it as a path of short straight pieces"));
    }
    for (const CrackEnd& end : of_.tips)
      if (!now.tips.contains(end))
        throw Error(Fault::Usage, fmt::format("grow.tips: {} is no tip: it ends on a boundary or on another crack",
                                              name_of(shape_, end)));
    if (active_.empty())
      throw Error(Fault::Usage,
                  "[grow]: the body has no tip that can grow; a crack that is given by a path ends inside");
  }

  /// The load factor along the growth, and the displacement at which the loads do their work. Where loads alone act the
  /// potential energy is minus that of the strains, and the displacement twice that energy times the factor; where
  /// displacements alone are prescribed it is that of the strains, and the two change their parts. Else it is not
  /// known.
  void find_instability() {
    constexpr double equal = 1e-6;
    const auto is = [&](double sign) {
      return std::ranges::all_of(grown_.steps, [&](const GrowthStep& s) {
        return std::abs(s.potential - sign * s.strain) <= equal * s.strain;
      });
    };
    const bool pushed = is(-1);
    if (of_.law || (!pushed && !is(1))) return;
    for (std::size_t i = 0; i + 2 < grown_.steps.size(); ++i) {
      const auto point = [&](const GrowthStep& s) {
        const double other = 2 * s.strain * s.load;
        return pushed ? LoadPoint{s.load, other} : LoadPoint{other, s.load};
      };
      const Course c = course(point(grown_.steps[i]), point(grown_.steps[i + 1]));
      if (c != Course::Stable && !grown_.unstable_from) grown_.unstable_from = grown_.steps[i].number;
      if (c == Course::SnapBack && !grown_.snaps_back_from) grown_.snaps_back_from = grown_.steps[i].number;
    }
  }

  /// Whether what growth releases is all that the body loses.
  bool balance_known() const {
    return grown_.notes.empty() && grown_.steps.size() > 2 &&
           std::ranges::none_of(scene_.laws, [](const CrackLaw& law) { return has_friction(law); });
  }

  double energy_balance() const {
    if (!balance_known()) return nan;
    double released = 0;
    for (const auto& [end, track] : tracks_) {
      std::vector<double> x, G;
      for (const std::size_t i : advances_of(track)) {
        x.push_back(track.x[i]);
        G.push_back(track.G[i]);
      }
      if (x.size() > 1) released += released_energy(x, G).energy;
    }
    const double lost = grown_.steps.front().potential - grown_.steps.back().potential;
    return lost != 0 ? released / lost - 1 : nan;
  }

  // What a step begins with: K of the cycle, rates, who grows and how far.

  GrownTip measured(const CrackEnd& end, const Solved& top, const Solved* bottom) const {
    const TipIntensity& t = top.tips.at(end);
    const double high = over_state();
    GrownTip tip{.end = end,
                 .name = name_of(shape_, end),
                 .at = t.at,
                 .a = path_length(shape_.cracks[static_cast<std::size_t>(end.crack)]),
                 .region = t.region};
    tip.K_I = high * t.K_I, tip.K_II = high * t.K_II, tip.T = high * t.T, tip.G = high * high * t.G;
    if (!of_.law) return tip;
    const double low = !proportional_ ? 1 : bottom ? -of_.min : of_.min;
    const TipIntensity& least = bottom ? bottom->tips.at(end) : t;
    tip.K_I_min = low * least.K_I, tip.K_II_min = low * least.K_II;
    return tip;
  }

  /// The state at the least load of a cycle, where it is not a multiple of the other.
  std::optional<Solved> least(const Shape& shape) {
    if (!of_.law) return std::nullopt;
    if (!proportional_) return solve(shape, of_.min);
    if (of_.min < 0 && has_contact(scene_)) return solve(shape, -1);
    return std::nullopt;
  }

  /// K over the root of a crack's length, below which its tips are as good as free of load: of the mean stress of the
  /// body, a millionth.
  static double nothing(const Adapted& body) {
    const Model& m = body.model;
    const double energy = std::abs(strain_energy(m, body.state));
    return 1e-6 * std::sqrt(2 * m.scene.material.mu * energy / area(m) * pi);
  }

  double tough_towards(const GrownTip& tip, double angle) const {
    const double phi = within_half_turn(active_.at(tip.end).direction + angle), tough = of_.anisotropy(phi);
    if (!(tough > 0) || !std::isfinite(tough))
      throw Error(Fault::Usage,
                  fmt::format("grow.law.anisotropy is {} at phi = {:.6g}; a positive number is wanted", tough, phi));
    return tough;
  }
  /// As the tip before says it, by the series.
  Direction direction_of_growth(const GrownTip& tip) const {
    const TipLoad load{tip.K_I, tip.K_II, tip.T};
    if (of_.criterion != Criterion::Energy || !of_.anisotropy) return direction(of_.criterion, load);
    return energetic_direction(load, 0, [&](double angle) { return tough_towards(tip, angle); });
  }
  /// In its own plane: the shear reaches K_IIc at a load at which no kink opens.
  bool shears(const GrownTip& tip) const {
    return !of_.law && std::isfinite(of_.toughness_shear) &&
           grows_by_shear({tip.K_I, tip.K_II, tip.T}, tip.dK,
                          std::nextafter(tip.dK * of_.toughness_shear / toughness(tip), 0.));
  }

  const RegionLaw* of_region(Index region) const {
    const auto found = std::ranges::find(of_.regions, region, &RegionLaw::region);
    return found == of_.regions.end() ? nullptr : &*found;
  }
  const GrowthLaw& law(const GrownTip& tip) const {
    const RegionLaw* own = of_region(tip.region);
    return own && own->law ? *own->law : *of_.law;
  }
  double toughness(const GrownTip& tip) const {
    const RegionLaw* own = of_region(tip.region);
    return own && own->toughness ? *own->toughness : *of_.toughness;
  }

  void load(GrownTip& tip, double nothing) const {
    const TipLoad top{tip.K_I, tip.K_II, tip.T};
    tip.K_max = opening_direction(top).k.k_1;
    if (!of_.law) {
      const Direction towards = direction_of_growth(tip);
      const double opens =
          of_.anisotropy ? std::sqrt(release_rate(towards.k, 1) / tough_towards(tip, towards.angle)) : tip.K_max;
      tip.dK = std::max(opens, std::abs(tip.K_II) * toughness(tip) / of_.toughness_shear);
      if (tip.dK <= nothing) tip.dK = 0;
      return;
    }
    if (!block_.empty()) {
      const double level = std::max(std::abs(of_.max), std::abs(of_.min)), up = level / of_.max,
                   down = of_.min < 0 ? level / of_.min : 0;
      const TipLoad pushed{up * tip.K_I, up * tip.K_II, up * tip.T};
      const TipLoad pulled =
          down == 0 ? TipLoad{-pushed.K_I, -pushed.K_II, 0} : TipLoad{-down * tip.K_I_min, -down * tip.K_II_min, 0};
      const LoadCurve curve = LoadCurve::homogeneous(level, pushed, pulled);
      tip.rate = block_growth(law(tip), block_, curve, Equivalence::Opening, tip.a);
    }
    const EquivalentCycle cycle = equivalent(Equivalence::Opening, top, {tip.K_I_min, tip.K_II_min, 0});
    tip.dK = cycle.K_max - cycle.K_min;
    if (tip.dK <= nothing) tip.dK = 0;
    if (tip.dK == 0)
      tip.rate = 0;
    else if (block_.empty())
      tip.rate = growth::rate(law(tip), cycle.K_max, cycle.K_min, tip.a);
  }

  /// Sets da of those that grow. False: none does, and why is in `ended`.
  bool share_out(GrowthStep& s) {
    std::vector<double> rates;
    for (const GrownTip& tip : s.tips) rates.push_back(of_.law ? tip.rate : tip.dK / toughness(tip));
    const Advances fastest = growth::advance(rates, scale_ * step_);
    if (fastest.all_rest || fastest.runs) {
      grown_.ended = fastest.runs ? "unstable: K reaches the toughness of the law at the largest load"
                     : of_.law    ? "arrested: the range of K is below the threshold at every tip"
                                  : "no tip is loaded: K is 0 at all of them";
      return false;
    }
    const double most = *std::ranges::max_element(rates);
    if (!of_.law) s.load = 1 / most;
    for (std::size_t i = 0; i < s.tips.size(); ++i) {
      s.tips[i].da = of_.law ? fastest.lengths[i] : rates[i] >= (1 - tie) * most ? scale_ * step_ : 0;
      if (!of_.law) continue;
      double& owed = active_.at(s.tips[i].end).owed;
      owed += s.tips[i].da;
      s.tips[i].da = owed >= std::max(shortest * scale_ * step_, shortest_piece()) ? owed : 0;
      if (s.tips[i].da > 0) owed = 0;
    }
    keep_off_borders(s);
    return true;
  }

  /// A tip that would end too near to the border of a region goes less far, or further, as little as is enough; all
  /// tips alike, since their lengths belong together. Along a border none is enough: then the largest room is taken.
  void keep_off_borders(GrowthStep& s) {
    if (shape_.regions.empty()) return;
    std::vector<PathObstacle> borders;
    for (const Loop& region : shape_.regions) add_sides(region, region.name, borders);
    const auto room = [&](double factor) {
      double least = infinity;
      for (GrownTip tip : s.tips) {
        if (!(tip.da > 0)) continue;
        const double wanted = clear * tip.da;
        tip.da *= factor;
        const Vec2 end = piece_of(begin(tip)).back();
        for (const PathObstacle& o : borders) least = std::min(least, distance(end, o.a, o.b) / wanted);
      }
      return least;
    };
    double best = 1, widest = room(1);
    constexpr int most = 12;  // twentieths
    for (int k = 1; k <= most && widest < 1; ++k)
      for (const double factor : {1 - k / 20.0, 1 + k / 20.0})
        if (const double there = room(factor); there > widest && widest < 1) widest = there, best = factor;
    for (GrownTip& tip : s.tips) tip.da *= best;
    sizing_.crack_tip_size = std::min(of_tips_ > 0 ? of_tips_ : infinity, best * sizing_.crack_tip_size);
  }

  Solved step(Solved now) {
    GrowthStep s{.number = static_cast<int>(grown_.steps.size())};
    const int before = grown_.solves;
    const std::optional<Solved> bottom = least(shape_);
    for (const auto& [end, unused] : active_) {
      if (!now.tips.contains(end)) continue;  // it has met something
      if (!std::isfinite(now.tips.at(end).K_I)) {
        grown_.ended = fmt::format("there is no K at {}: {}", name_of(shape_, end),
                                   now.tips.at(end).on_border ? fmt::format("it lies {}", on_border)
                                                              : "something is too near, or the mesh too coarse");
        continue;
      }
      s.tips.push_back(measured(end, now, bottom ? &*bottom : nullptr));
      load(s.tips.back(), now.resting * std::sqrt(s.tips.back().a));
    }
    s.potential = now.potential;
    s.strain = now.strain;
    if (of_.bounds) bound(s, now);
    count_cycles(s);
    if (step_ == 0) choose_step(s);
    scale_step(s);
    if (grown_.ended.empty() && s.tips.empty()) grown_.ended = "no tip is left inside the body";
    if (grown_.ended.empty() && share_out(s)) end_where_asked(s);
    std::optional<Solved> next;
    if (grown_.ended.empty()) next = advance(s, now);
    s.solves = grown_.solves - before;
    grown_.steps.push_back(s);
    tell(s, now);
    return next ? std::move(*next) : std::move(now);
  }

  /// Intervals at this step, at the loads of the state; of the tips at the largest load.
  void bound(GrowthStep& s, Solved& now) {
    const StateBounds& found = record_.bounds(now.number, [&] {
      std::vector<TipIntensity> tips;
      for (const GrownTip& tip : s.tips) tips.push_back(now.tips.at(tip.end));
      const Adapted& body = body_of(now);
      return bound_state(body.model, body.state, tips, how_.threads);
    });
    bounds_.push_back(found);
    const double high = over_state();
    const auto times = [](double factor, const Interval& i) { return Interval{factor * i.low, factor * i.high}; };
    for (std::size_t i = 0; i < s.tips.size(); ++i) {
      const TipIntervals& in = found.tips[i];
      s.tips[i].in = TipIntervals{.end = in.end,
                                  .K_I = times(high, in.K_I),
                                  .K_II = times(high, in.K_II),
                                  .G = times(high * high, in.G),
                                  .guaranteed = in.guaranteed,
                                  .note = in.note};
    }
  }

  /// Of the life: where one tip, whose K at both loads of a cycle are in proportion, is the fastest at every step, as
  /// fast as any other but for a tie, and stays in one region. A cycle whose least load is the larger one in size may
  /// open the kink to the other side, and has none.
  void bound_life_of(PathBounds& out) const {
    if (!of_.law || !proportional_ || !block_.empty() || grown_.steps.size() < 3 || of_.min < -of_.max) return;
    const GrownTip& first = *std::ranges::max_element(grown_.steps.front().tips, {}, &GrownTip::rate);
    const Track& track = tracks_.at(first.end);
    if (!track.borders.empty()) return;
    std::vector<BoundedCycles> path;
    for (const GrowthStep& s : grown_.steps) {
      const auto tip = std::ranges::find(s.tips, first.end, &GrownTip::end);
      if (tip == s.tips.end() || !tip->in || !std::isfinite(tip->in->K_I.low + tip->in->K_II.high)) return;
      if (std::ranges::any_of(s.tips, [&](const GrownTip& t) { return (1 - tie) * t.da > tip->da; })) return;
      path.push_back({.a = track.x[path.size()], .top = *tip->in, .least = of_.min / of_.max});
    }
    const auto interval = [](const LifeBounds& b) { return Interval{b.lower, b.upper}; };
    out.cycles = interval(bound_cycles(law(first), path, BetweenPoints::Monotone));
    out.cycles_smooth = interval(bound_cycles(law(first), path, BetweenPoints::Smooth));
  }

  std::optional<PathBounds> path_bounds() const {
    if (!of_.bounds || bounds_.empty()) return std::nullopt;
    PathBounds out{.guaranteed = true};
    for (const StateBounds& b : bounds_) {
      const auto bad = std::ranges::find_if(b.tips, [](const TipIntervals& t) { return !t.guaranteed; });
      if (b.guaranteed && bad == b.tips.end()) continue;
      out.guaranteed = false;
      out.note = bad != b.tips.end() ? bad->note : b.note;
      break;
    }
    bound_life_of(out);
    if (grown_.steps.size() > 1 && balance_known()) {
      out.lost = {bounds_.front().energy.low - bounds_.back().energy.high,
                  bounds_.front().energy.high - bounds_.back().energy.low};
      out.released = {0, 0};
      for (const auto& [end, track] : tracks_) {
        std::vector<double> x, low, high;
        for (const std::size_t i : advances_of(track)) {
          const StateBounds& there = bounds_[static_cast<std::size_t>(track.first) + i];
          const Interval G = std::ranges::find(there.tips, end, &TipIntervals::end)->G;
          x.push_back(track.x[i]);
          low.push_back(G.low);
          high.push_back(G.high);
        }
        if (x.size() < 2) continue;
        if (!std::ranges::all_of(low, [](double G) { return std::isfinite(G); })) {
          out.released = {nan, nan};
          break;
        }
        const ReleasedBounds part = bound_released_energy(x, low, high);
        out.released.low += part.lower;
        out.released.high += part.upper;
      }
    }
    return out;
  }

  void tell(const GrowthStep& s, Solved& now) {
    if (!watch_) return;
    const bool again = record_.told_before();
    if (!watch_(s, now.shape, again ? nullptr : &body_of(now), record_.all()) && grown_.ended.empty())
      grown_.ended = "stopped as asked";
  }

  /// Behind a kink the path bends like the root of its length: steps of 1/8, 1/8, 1/4 and 1/2 follow it. The pieces are
  /// what the rings around the next tip lie in, and have `chords` edges each.
  void scale_step(const GrowthStep& s) {
    constexpr double kinked = 0.02;
    for (const GrownTip& tip : s.tips) {
      const Active& there = active_.at(tip.end);
      if (of_.criterion != Criterion::LocalSymmetry || (of_.law && !(tip.rate > 0))) continue;
      const double turn = std::abs(direction(of_.criterion, {tip.K_I, tip.K_II, tip.T}).angle);
      if (turn > (there.grown ? largest_turn / 2 : kinked)) since_kink_ = 0;
    }
    scale_ = since_kink_ == 0 ? behind_kink : std::min(1.0, behind_kink * std::exp2(since_kink_ - 1));
    ++since_kink_;
    const double tips = of_tips_ > 0 ? of_tips_ : infinity;
    sizing_.crack_tip_size = std::min(tips, scale_ * step_ / piece_chords);
  }

  /// Ends of cracks join what lies within a millionth of the body; the chords of a piece are to be longer.
  double shortest_piece() const {
    return 4e-6 * piece_chords * extent(shape_);
  }

  void choose_step(const GrowthStep& s) {
    constexpr double of_crack = 0.1, of_body = 0.02;
    step_ = of_.step > 0 ? of_.step : of_body * extent(shape_);
    for (const GrownTip& tip : s.tips)
      if (!(of_.step > 0)) step_ = std::min(step_, of_crack * tip.a);
    const double least = shortest_piece() / behind_kink;
    if (step_ < least)
      throw Error(Fault::Usage,
                  fmt::format("grow.step: steps of {:.3g} are too short for a body of {:.4g}: chords of the pieces "
                              "behind kinks would be as short as what counts as one point; take {:.2g} or more",
                              step_, extent(shape_), least));
  }

  /// The cycles so far: of each step those of the tip that was the fastest, by its rates at all steps as a smooth
  /// function of its length (growth/life.hpp), or by those of the step alone where it has rested, begun later or ended.
  void count_cycles(GrowthStep& s) {
    for (const GrownTip& tip : s.tips) {
      Track& track = tracks_[tip.end];
      if (track.x.empty())
        track.x.push_back(tip.a / static_cast<double>(ends_of(tip.end.crack)));
      else
        track.x.push_back(track.x.back() + track.grows);
      track.rates.push_back(tip.rate);
      track.G.push_back(tip.G / (over_state() * over_state()));
      track.first = std::min(track.first, s.number);
    }
    if (!of_.law) return;
    std::map<CrackEnd, Counted> lives;  // of tips that have always grown
    for (const auto& [end, track] : tracks_) {
      // At the last point it may run.
      const bool whole = track.x.size() > 1 && std::isfinite(track.rates.front()) &&
                         std::ranges::all_of(track.rates, [](double r) { return r > 0; }) &&
                         std::ranges::adjacent_find(track.x, std::greater_equal<>()) == track.x.end();
      if (whole) lives.emplace(end, counted(track));
    }
    double sum = 0, error = 0, alone = 0;
    for (const GrowthStep& before : grown_.steps) {
      const GrownTip& fastest = *std::ranges::max_element(before.tips, {}, &GrownTip::da);
      const Track& track = tracks_.at(fastest.end);
      const auto at = static_cast<std::size_t>(before.number - track.first);
      const auto life = lives.find(fastest.end);
      if (at + 1 >= track.x.size() || life == lives.end()) {
        const Interval cycles = between_rates(fastest, at + 1 < track.rates.size() ? track.rates[at + 1] : nan);
        sum += 0.5 * (cycles.low + cycles.high);
        alone += 0.5 * (cycles.high - cycles.low);
        continue;
      }
      const std::vector<double>& cycles = life->second.cycles;
      sum += cycles[at + 1] - cycles[at];
      error = std::max(error, life->second.error);  // of all of its steps
    }
    s.cycles = sum;
    if (!grown_.steps.empty()) grown_.cycles_error = error + alone;
  }

  /// The cycles of a step whose rate is between those at its two ends; where the last is not known, or the crack runs
  /// there, up to those of the first.
  static Interval between_rates(const GrownTip& tip, double after) {
    const double first = tip.da / tip.rate, last = after > 0 ? tip.da / after : 0;
    return {std::min(first, last), std::max(first, last)};
  }

  struct Track;
  /// Cycles at the points of a track. The rate jumps at borders: each of the two beside one stands up to there, and
  /// half of that counts as error.
  struct Counted {
    std::vector<double> cycles;
    double error = 0;
  };
  static Counted counted(const Track& track) {
    Counted c;
    std::size_t from = 0;
    double done = 0;
    for (std::size_t k = 0; k <= track.borders.size(); ++k) {
      const std::size_t last = k < track.borders.size() ? track.borders[k].point : track.x.size() - 1;
      const std::size_t count = last - from + 1;
      if (count > 1) {
        const Life life =
            Life::of_rates(std::span(track.x).subspan(from, count), std::span(track.rates).subspan(from, count));
        for (const double cycles : life.cycles_at_points()) c.cycles.push_back(done + cycles);
        if (std::isfinite(life.error())) c.error += life.error();
      } else {
        c.cycles.push_back(done);
      }
      if (k == track.borders.size()) break;
      const double border = track.borders[k].x, across = (border - track.x[last]) / track.rates[last] +
                                                         (track.x[last + 1] - border) / track.rates[last + 1];
      done = c.cycles.back() + across;
      c.error += across / 2;
      from = last + 1;
    }
    // Within the step at whose end it runs it runs somewhere.
    if (!std::isfinite(track.rates.back())) {
      const double half = 0.5 * (c.cycles.back() - c.cycles[c.cycles.size() - 2]);
      c.cycles.back() -= half;
      c.error += half;
    }
    return c;
  }

  std::size_t ends_of(Index crack) const {
    return static_cast<std::size_t>(active_.contains({crack, false})) +
           static_cast<std::size_t>(active_.contains({crack, true}));
  }

  void end_where_asked(const GrowthStep& s) {
    const auto say = [&](std::string why) {
      if (grown_.ended.empty()) grown_.ended = std::move(why);
    };
    for (const GrownTip& tip : s.tips) {
      const std::string name = shape_.cracks[static_cast<std::size_t>(tip.end.crack)].name;
      if (tip.a >= of_.length) say(fmt::format("crack \"{}\" is {:.4g} long, as asked", name, tip.a));
      if (tip.dK * (of_.law ? 1 : s.load) >= of_.K && of_.law)
        say(fmt::format("the range of K is {:.4g} at {}, as asked", tip.dK, name_of(shape_, tip.end)));
    }
    if (s.cycles >= of_.cycles) say(fmt::format("{:.6g} cycles are done, as asked", s.cycles));
    if (s.number >= of_.steps) say(fmt::format("{} steps are done (grow.until.steps)", s.number));
  }

  // The direction.

  struct Trial {
    GrownTip* tip;
    bool is_arc = false;
    double turn = 0;                            // of the arc, or of the kink before a straight piece
    std::optional<SymmetrySearch> search = {};  // none: the turn is known
    std::optional<Hit> hit = {};
    std::optional<CrackEnd> meets = {};  // the tip that it goes on to, or that goes on to it
  };

  std::vector<Vec2> piece_of(const Trial& t) const {
    const PathTip from{tip_of(shape_, t.tip->end), active_.at(t.tip->end).direction};
    return t.is_arc ? chords(arc_piece(from, t.turn, t.tip->da), piece_chords)
                    : chords(straight_piece(from, t.turn, t.tip->da), 1);
  }

  Trial begin(GrownTip& tip) const {
    const Active& there = active_.at(tip.end);
    Trial t{.tip = &tip};
    if (shears(tip)) return t;
    t.turn = direction_of_growth(tip).angle;
    if (of_.criterion != Criterion::LocalSymmetry) return t;
    t.is_arc = there.grown && std::abs(t.turn) < largest_turn / 2;
    if (t.is_arc) t.turn = std::clamp(there.curvature * tip.da, -largest_turn, largest_turn);
    // d(k_2/k_1) per radian: what turns the tip, and T along the piece [theory: G.7].
    const double along = (t.is_arc ? 4.0 / 3 : 2) * std::sqrt(2 / pi * tip.da) * tip.T / std::max(tip.K_I, tip.dK);
    t.search.emplace(t.turn, SymmetryOptions{.tolerance = symmetric,
                                             .largest_turn = t.is_arc ? 2 * largest_turn : pi / 2,
                                             .slope = std::max(0.5 - along, 0.1)});
    return t;
  }

  Shape grown_by(const std::vector<Trial>& trials) const {
    Shape shape = shape_;
    for (const Trial& t : trials)
      append(shape.cracks[static_cast<std::size_t>(t.tip->end.crack)], t.tip->end.at_start, path_of(t));
    return shape;
  }
  std::vector<Vec2> path_of(const Trial& t) const {
    std::vector<Vec2> path = piece_of(t);
    if (!t.hit) return path;
    if (t.hit->name.empty()) return {};  // another tip comes here
    path.resize(static_cast<std::size_t>(t.hit->along));
    path.push_back(t.hit->at);
    return path;
  }

  /// A tip that would come nearer to something than it grows in a step goes on to it: to a tip that looks at it, or to
  /// what it would cross, pieces of the tips before it in `trials` among that.
  void look_ahead(Trial& t, std::span<const Trial> before) const {
    if (t.meets = facing_tip(*t.tip); t.meets) {
      const Vec2& at = tip_of(shape_, *t.meets);
      const Trial* other = nullptr;
      for (const Trial& b : before)
        if (b.tip->end == *t.meets) other = &b;
      if (other && other->meets == t.tip->end) {  // it comes here
        t.hit = Hit{tip_of(shape_, t.tip->end), {}, 0};
        return;
      }
      t.hit = Hit{at, "the tip " + name_of(shape_, *t.meets), 0};
      return;
    }
    std::vector<PathObstacle> all = obstacles(shape_, t.tip->end, piece_chords + piece_chords / kept);
    for (const Trial& b : before) {
      Vec2 from = tip_of(shape_, b.tip->end);
      for (const Vec2& to : path_of(b)) {
        if (to != from) all.push_back({from, to, fmt::format("the piece that {} grows by", b.tip->name)});
        from = to;
      }
    }
    t.hit = first_hit(all, tip_of(shape_, t.tip->end), piece_of(t), t.tip->da);
    if (t.hit && t.hit->along >= static_cast<double>(piece_of(t).size()))
      t.hit->along = static_cast<double>(piece_of(t).size());
  }

  /// The tip of another crack, no further away than both grow by, where each lies ahead of the other.
  std::optional<CrackEnd> facing_tip(const GrownTip& tip) const {
    const auto looks_at = [&](const CrackEnd& end, const Vec2& x) {
      const double off = angle_of(x - tip_of(shape_, end)) - active_.at(end).direction;
      return std::abs(within_half_turn(off)) < facing;
    };
    for (const auto& [other, there] : active_) {
      if (other.crack == tip.end.crack) continue;
      const Vec2& x = tip_of(shape_, other);
      const bool near = (x - tip.at).norm() <= tip.da + there.da;
      if (near && looks_at(tip.end, x) && looks_at(other, tip.at)) return other;
    }
    return std::nullopt;
  }

  Solved advance(GrowthStep& s, const Solved& now) {
    std::vector<Trial> trials;
    for (auto& [end, track] : tracks_) track.grows = 0;
    for (GrownTip& tip : s.tips) {
      active_.at(tip.end).da = tip.da;
      if (tip.da > 0) trials.push_back(begin(tip));
    }
    std::optional<Solved> next;
    Shape shape;
    for (bool last = false; !last;) {
      last = !ask(trials);
      for (std::size_t i = 0; i < trials.size(); ++i) look_ahead(trials[i], std::span(trials).first(i));
      shape = grown_by(trials);
      try {
        next = solve(shape, load_of_state());
      } catch (const Error& e) {
        if (!of_one_body(e) && e.fault != Fault::Usage) throw;
        const bool drawn = e.fault != Fault::Geometry;  // else the body before is what there is
        if (drawn) shape_ = std::move(shape);
        grown_.ended = fmt::format("the body that the cracks {} into cannot be {}: {}",
                                   drawn ? "have grown" : "would grow", drawn ? "solved" : "meshed", e.what());
        return Solved(now);
      }
      last = last || !answer(trials, *next);
    }
    accept(s, trials, std::move(shape));
    return std::move(*next);
  }

  /// Gives all pieces the turns that their searches ask for, or the best ones; whether any asks.
  static bool ask(std::vector<Trial>& trials) {
    bool any = false;
    for (Trial& t : trials) {
      if (!t.search) continue;
      any = any || t.search->turn();
      t.turn = t.search->turn() ? *t.search->turn() : t.search->best().turn;
    }
    return any;
  }

  /// Tells the searches K of the body. Whether it is not yet the one to go on from.
  static bool answer(std::vector<Trial>& trials, const Solved& next) {
    bool any = false;
    for (Trial& t : trials) {
      if (!t.search) continue;
      const auto found = next.tips.find(t.tip->end);
      if (t.hit || found == next.tips.end() || !std::isfinite(found->second.K_I)) {
        t.search.reset();
        continue;
      }
      if (t.search->turn()) t.search->answer({found->second.K_I, found->second.K_II});
      const SymmetrySearch::Answer& best = t.search->best();
      t.tip->symmetry = best.k.k_1 > 0 ? std::abs(best.k.k_2) / best.k.k_1 : nan;
      any = any || t.search->turn() || best.turn != t.turn;
    }
    return any;
  }

  void accept(GrowthStep& s, const std::vector<Trial>& trials, Shape shape) {
    for (const Trial& t : trials) note_borders(s, t);
    shape_ = std::move(shape);
    for (const Trial& t : trials) {
      if (!active_.contains(t.tip->end)) {  // another tip has come to it
        t.tip->da = 0;
        continue;
      }
      Active& there = active_.at(t.tip->end);
      t.tip->angle = t.turn;
      there.direction = within_half_turn(there.direction + t.turn);
      there.grown = true;
      tracks_[t.tip->end].grows = t.tip->da;
      there.curvature = t.is_arc ? t.turn / t.tip->da : 0;
      const std::size_t points = path_of(t).size();
      coarsen(shape_.cracks[static_cast<std::size_t>(t.tip->end.crack)], t.tip->end.at_start, points, there.points);
      there.points = points;
      if (!t.hit) continue;
      active_.erase(t.tip->end);
      if (t.meets) active_.erase(*t.meets);
      if (t.hit->name.empty()) continue;
      grown_.notes.push_back(fmt::format("{} reaches {} at ({:.6g}, {:.6g}) in step {}", name_of(shape_, t.tip->end),
                                         t.hit->name, t.hit->at.x(), t.hit->at.y(), s.number));
    }
  }

  /// What is said of borders that a tip crosses; its rates are counted apart on both sides.
  void note_borders(const GrowthStep& s, const Trial& t) {
    const std::vector<Vec2> path = path_of(t);
    const Vec2& from = t.tip->at;
    for (const Loop& region : shape_.regions) {
      const std::optional<BorderCrossing> c = crossing_of(region, from, path);
      if (!c) continue;
      grown_.notes.push_back(fmt::format("{} {} {} at ({:.6g}, {:.6g}) in step {}", t.tip->name,
                                         !c->odd     ? "crosses"
                                         : c->inside ? "enters"
                                                     : "leaves",
                                         c->first.name, c->first.at.x(), c->first.at.y(), s.number));
      Track& track = tracks_[t.tip->end];
      const double x = track.x.back() + t.tip->da * c->first.along / static_cast<double>(path.size());
      const std::size_t point = track.x.size() - 1;
      if (track.borders.empty() || track.borders.back().point != point) track.borders.push_back({point, x});
    }
  }

  struct Active {
    double direction = 0;  // of the tip
    double curvature = 0;
    bool grown = false;
    std::size_t points = 0;  // of its last piece
    double owed = 0;         // by its rates, and not yet grown
    double da = 0;           // grows by, in the present step
  };

  Shape shape_;
  Sizing sizing_;
  const Element& element_;
  const Scene& scene_;
  const GrowRequest& of_;
  Adaptation how_;
  const WatchGrowth& watch_;
  Record& record_;
  bool proportional_;
  std::vector<LoadCycle> block_;  // of the spectrum
  double step_ = 0, scale_ = 1;   // of this step: scale_ step_
  int since_kink_ = 10;           // steps
  double of_tips_ = 0;            // Sizing::crack_tip_size as given
  /// Lengths of a tip at the steps, its own share of the crack and what it has grown by, and rates there.
  struct Track {
    std::vector<double> x, rates, G;  // G of the state that was solved
    double grows = 0;                 // in the present step
    struct Border {
      std::size_t point;  // the last one before it
      double x;
    };
    std::vector<Border> borders = {};  // that have been crossed
    int first = std::numeric_limits<int>::max();
  };
  /// The points of a track from each of which it has grown, and the last one.
  static std::vector<std::size_t> advances_of(const Track& track) {
    std::vector<std::size_t> points;
    for (std::size_t i = 0; i < track.x.size(); ++i)
      if (i + 1 == track.x.size() || track.x[i + 1] != track.x[i]) points.push_back(i);
    return points;
  }
  std::map<CrackEnd, Track> tracks_;
  std::vector<StateBounds> bounds_;  // per step
  std::map<CrackEnd, Active> active_;
  Grown grown_;
};

/// How far the tips of one run lie from the paths of the other, up to where the shorter one ends.
double distance_of_paths(const Grown& fine, const Grown& coarse) {
  double most = 0;
  for (const GrowthStep& s : coarse.steps)
    for (const GrownTip& tip : s.tips) {
      const std::vector<Vec2>& path = fine.shape.cracks[static_cast<std::size_t>(tip.end.crack)].points;
      const bool there = std::ranges::any_of(fine.steps, [&](const GrowthStep& other) {
        return std::ranges::any_of(other.tips, [&](const GrownTip& t) { return t.end == tip.end && t.a >= tip.a; });
      });
      if (!there) continue;
      double least = infinity;
      for (std::size_t i = 0; i + 1 < path.size(); ++i) least = std::min(least, distance(tip.at, path[i], path[i + 1]));
      most = std::max(most, least);
    }
  return most;
}
double grown_length(const Grown& g) {
  double most = 0;
  for (const GrownTip& tip : g.steps.back().tips)
    for (const GrownTip& first : g.steps.front().tips)
      if (first.end == tip.end) most = std::max(most, tip.a - first.a);
  return most;
}

}  // namespace

Grown grow(Shape shape, const Sizing& sizing, const Element& e, const Scene& scene, const GrowRequest& request,
           const Adaptation& how, const WatchGrowth& watch, GrowthRecord before) {
  Record record(std::move(before));
  Grown run = Growing(shape, sizing, e, scene, request, how, watch, record).run();
  if (!(request.tolerance > 0)) return run;
  constexpr int most_runs = 3;
  GrowRequest finer = request;
  for (int k = 1; k < most_runs && run.step > 0 && run.steps.size() > 1; ++k) {
    finer.step = 0.5 * run.step;
    finer.steps = 2 * finer.steps;
    Grown next = Growing(shape, sizing, e, scene, finer, how, watch, record).run();
    next.solves += run.solves;
    next.path_error = distance_of_paths(next, run);
    const double N = next.steps.back().cycles, off = std::abs(N - run.steps.back().cycles);
    if (request.law) next.cycles_error = std::max(off, next.cycles_error);
    run = std::move(next);
    const bool path = run.path_error <= request.tolerance * grown_length(run),
               life = !request.law || off <= request.tolerance * N;
    if (path && life) return run;
    if (run.ended == "stopped as asked") return run;
  }
  run.notes.push_back(
      fmt::format("the tolerance of {:.3g} is not reached with a step of {:.3g}", request.tolerance, run.step));
  return run;
}

}  // namespace kerf::growth
