// One design of a level set on its way down. A step is 1. the rates of J and of the bounds along the boundary, prices
// and speed from them (speed.cpp) [theory: L.1, L.2], or for the fixed point a turn of phi towards lambda - T
// (fixed_point.cpp) [theory: L.5]; 2. the motion phi - v on the canvas, holes where T pays (nucleate.cpp) [theory:
// L.6], what must stay solid or mirrored, idle pieces dropped, the area shifted to the one allowed; 3. the design
// drawn, meshed and solved; it is taken unless the merit J + p |Omega| + sum nu_k max(c_k, 0) [theory: L.7] rises by
// more than redrawing changes. The radius follows the actual change over the predicted one [theory: L.12]. The allowed
// area falls by 3 % of the frame per step to the one wanted; until then rises of J are followed. At the end holes are
// tried once more: eight steps later the merit has to be lower, or the design before comes back. All that a step leaves
// to the next is in DescentState (progress.hpp), so that a checkpoint goes on bit for bit. docs/theory/level_set.md.

#include "optimize/level_set/descent.hpp"

#include "kerf/map.hpp"
#include "optimize/ersatz.hpp"
#include "optimize/level_set/dangling.hpp"
#include "optimize/level_set/fixed_point.hpp"
#include "optimize/level_set/nucleate.hpp"
#include "optimize/level_set/parts.hpp"
#include "optimize/level_set/try_holes.hpp"
#include "optimize/loop/finish.hpp"
#include "optimize/loop/history_text.hpp"
#include "solver/stress.hpp"
#include "topo/map_at_centroids.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace kerf {

namespace {

// Lengths relative to the mesh size, areas to that of the frame.
constexpr double largest_step_radius = 1, least_step_radius = 0.05;
constexpr double first_step_radius = 0.25;                   // where the start has its holes
constexpr double largest_turn = 0.5, smallest_turn = 0.015;  // of the fixed point
constexpr double drop = 0.03;                                // of the area that is taken away in one step
constexpr double redrawing = 2e-3;                           // what drawing and meshing anew changes of J
constexpr double followed = 0.02;                            // rises of the fixed point
constexpr double restoration = 0.05;                         // of a bound that one step makes up for
constexpr double harder = 1.5;                               // violations of bounds weigh more than their multipliers
constexpr double least_weight = 0.5;                         // of a violation, in units of J
constexpr double jump = 10;                                  // of J in one step while the area falls
constexpr int patience = 4;                                  // steps without a better design
constexpr std::size_t window = 8;  // steps over which a small change means that no more is to be had
constexpr int exploring = 12;      // steps at the final area in which holes still appear by themselves
constexpr double stride = 0.01;    // of the merit in one step, without which that time runs
constexpr double pays = 0.7;       // T against the price where a hole is tried

Eigen::VectorXd vector_of(const std::vector<double>& v) {
  return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

/// Below it lies a third of the values: the price of area where no boundary tells one.
double lower_third(const Eigen::VectorXd& values) {
  std::vector<double> sorted(values.begin(), values.end());
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 3);
  std::nth_element(sorted.begin(), at, sorted.end());
  return *at;
}

// A function of any scale becomes a signed distance with what must stay solid, void or mirrored in it.
Eigen::VectorXd from_nothing(const Ground& g, Eigen::VectorXd phi) {
  return signed_distance(g.background, constrained(g.background, std::move(phi)));
}

/// Share of every bound that a descent may use: a polygon that is drawn anew in each step has peaks of stress at its
/// vertices which no step can foretell. Bounds of stresses are for the curves, whose derivatives are exact.
/// A share of infinity leaves a bound out of the descent.
std::vector<double> left_to_curves(const Ground& g) {
  std::vector<double> share(g.r.bounds.size(), 1);
  if (g.weak() || g.turns()) return share;
  for (std::size_t k = 0; k < share.size(); ++k)
    if (counts_stress(g.r.bounds[k].functional)) share[k] = infinity;
  return share;
}

}  // namespace

// What a checkpoint of this ground must fit.
StateSizes sizes_of_state(const Ground& g) {
  return {g.background.lumped.size(), static_cast<Eigen::Index>(g.r.bounds.size()), largest_step_radius * g.size,
          largest_turn};
}

Descent::Descent(const Ground& g, DescentRules rules, const Eigen::VectorXd& start) : g_(g), rules_(std::move(rules)) {
  s_.explore = rules_.explore;
  s_.radius = (s_.explore ? largest_step_radius : first_step_radius) * g.size;
  s_.turn = largest_turn;
  s_.weight = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(g.r.bounds.size()));
  s_.faith = Eigen::VectorXd::Ones(s_.weight.size());
  if (rules_.tight.empty()) rules_.tight = left_to_curves(g);
  begin(start);
  s_.ended = rules_.ended;
}

Descent::Descent(const Ground& g, DescentRules rules, DescentState progress)
    : g_(g), rules_(std::move(rules)), s_(std::move(progress)) {
  if (rules_.tight.empty()) rules_.tight = left_to_curves(g);
  if (s_.spent && s_.iteration < rules_.iterations) s_.ended.clear(), s_.spent = false;
  const auto drawn = [&](const Eigen::VectorXd& phi) {
    return phi.size() == 0 ? nullptr : draw(g_, phi, {}, rules_.coarse).design;
  };
  // What was one design is one again: the end asks whether the present one is the best.
  design_ = drawn(s_.phi);
  const auto same = [](const Eigen::VectorXd& a, const Eigen::VectorXd& b) { return std::ranges::equal(a, b); };
  best_ = same(s_.best.phi, s_.phi) ? design_ : drawn(s_.best.phi);
  anchored_ = same(s_.anchor.phi, s_.best.phi) ? best_ : drawn(s_.anchor.phi);
}

// The start is drawn and solved as it is. The fixed point leaves its start whatever that costs; the others count it as
// a design to beat.
void Descent::begin(const Eigen::VectorXd& start) {
  Eigen::VectorXd phi = from_nothing(g_, start);
  if (!g_.turns()) drop_idle(phi);
  const double area = negative_area(g_.background.mesh, phi);
  s_.allowed = g_.limited ? std::max(g_.target, area) : infinity;
  // A start that has about the area wanted is shifted to it.
  std::optional<double> wanted;
  if (g_.limited && area > (1 - drop) * g_.target && area < (1 + 2 * drop) * g_.target) {
    s_.allowed = g_.target;
    wanted = g_.target;
    phi = with_area(g_.background, phi, g_.target);
  }
  s_.solves = 1 + rules_.solves;
  DrawnLevelSet drawing = draw(g_, phi, g_.weak() ? std::nullopt : wanted, rules_.coarse);
  s_.phi = std::move(drawing.phi);
  s_.drawn = std::move(drawing.notes);
  show(std::move(drawing.design),
       rules_.from.empty() ? std::vector<std::string>{} : std::vector{"from " + rules_.from});
  if (!g_.turns()) keep_if_best();  // the fixed point leaves its start, whatever that costs
}

// The area is the one wanted: from then on designs are compared and kept.
bool Descent::settled() const {
  return !g_.limited || s_.allowed <= g_.target;
}

Iterate Descent::iterate() const {
  const SolvedCase& c = design_->cases.front();
  return {last_taken(s_.rows), design_->shape, c.model, c.state};
}

/// (value - what this mesh may use of the bound) / |bound|.
Eigen::VectorXd Descent::relative(const Eigen::VectorXd& bounds) const {
  Eigen::VectorXd c(bounds.size());
  for (Eigen::Index i = 0; i < c.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double most = g_.r.bounds[k].at_most;
    c[i] = (bounds[i] - most * rules_.tight[k]) / std::max(std::abs(most), 1e-300);
  }
  return c;
}

/// J + price of area + weighted violations of the bounds [theory: L.7].
double Descent::value(double J, double area, const Eigen::VectorXd& bounds) const {
  double sum = J + g_.r.volume_penalty * area;
  if (bounds.size() > 0) sum += s_.weight.dot(relative(bounds).cwiseMax(0));
  return sum;
}
double Descent::value(const Evaluated& e) const {
  return value(e.J, e.area, vector_of(e.bounds));
}
double Descent::value(const KeptDesign& k) const {
  return k.phi.size() == 0 ? infinity : value(k.J, k.area, k.bounds);
}

double Descent::merit() const {
  return value(*design_);
}

bool Descent::keeps_bounds(const Evaluated& e) const {
  const Eigen::VectorXd c = relative(vector_of(e.bounds));
  return violation_of(g_.r, {}, e.area / g_.whole) < feasible_violation &&
         (c.size() == 0 || c.maxCoeff() < feasible_violation);
}

bool Descent::appearing() const {
  return s_.explore && !g_.turns() && s_.settled < exploring;
}

/// The fixed point follows rises for a while.
double Descent::noise() const {
  return (g_.turns() ? followed : redrawing) * std::abs(merit());
}

/// Those that weigh in the merit near their limits, with what they weigh.
/// `harder` is taken off again: weights are 1.5 times the multipliers.
std::vector<WeightedAnalysis> Descent::binding_bounds() const {
  std::vector<WeightedAnalysis> all;
  const Eigen::VectorXd c = relative(vector_of(design_->bounds));
  for (Eigen::Index k = 0; k < c.size(); ++k) {
    if (!(s_.weight[k] > 0 && c[k] > -0.05)) continue;
    const double unit = std::max(std::abs(g_.r.bounds[static_cast<std::size_t>(k)].at_most), 1e-300);
    for (WeightedAnalysis& w : analyze_bound(*design_, static_cast<std::size_t>(k))) {
      w.weight *= s_.weight[k] / harder / unit;
      all.push_back(std::move(w));
    }
  }
  return all;
}

// T of what would happen to each triangle: a hole in the material or, in a weak phase, an inclusion of the weak
// material; in the weak phase itself the strong material, whose sign is turned so that both say what taking material
// away does.
Eigen::VectorXd Descent::derivative() const {
  const Evaluated& e = *design_;
  const Mesh& mesh = e.cases.front().model.mesh;
  const Perturbation hole = g_.weak()
                                ? Perturbation{.kind = Perturbation::Kind::Inclusion,
                                               .inclusion = weak_material(g_.p.scene.material, g_.r.level_set.ersatz)}
                                : Perturbation{};
  const Perturbation filled{.kind = Perturbation::Kind::Inclusion, .inclusion = g_.p.scene.material};
  const auto change = [&](Index t) -> const Perturbation& {
    return g_.weak() && strong_share(region_of(mesh, t)) < 0.5 ? filled : hole;
  };
  Eigen::VectorXd T = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(mesh.triangles.size()));
  const auto add = [&](const std::vector<WeightedAnalysis>& all) {
    for (const WeightedAnalysis& w : all) T += w.weight * map_at_centroids(w.analysis, *w.functional, change);
  };
  add(analyze_objective(e));
  add(binding_bounds());
  if (g_.weak())
    for (Index t = 0; t < T.size(); ++t)
      if (strong_share(region_of(mesh, t)) < 0.5) T[t] = -T[t];
  return T;
}

// Every load case within a tenth of the worst of a bound has a rate of its own: the step may make another one the
// worst.
const Descent::Rates& Descent::rates() const {
  constexpr double far = 0.1;  // below the worst load case: does not count
  if (rates_) return *rates_;
  const Evaluated& e = *design_;
  Rates r{.objective = boundary_rate(e, analyze_objective(e)), .bounded = {}, .of = {}};
  r.objective.density.array() -= g_.price - g_.r.volume_penalty;
  for (std::size_t k = 0; k < e.bounds.size(); ++k)
    for (std::size_t i = 0; i < e.by_case[k].size(); ++i) {
      const bool worst = static_cast<Index>(i) == e.worst[k];
      if (!worst && e.by_case[k][i] < e.bounds[k] - far * std::abs(e.bounds[k])) continue;
      r.bounded.push_back(boundary_rate(e, analyze_bound(e, k, static_cast<Index>(i))));
      r.of.emplace_back(k, static_cast<Index>(i));
    }
  rates_ = std::move(r);
  return *rates_;
}

// A violated bound is to fall by at most 5 % per step. More is asked for where predicted falls came true in part only
// (faith).
StepLimits Descent::limits(double radius, double allowed) const {
  const LevelSetRequest& how = g_.r.level_set;
  StepLimits l{.radius = radius,
               .share = std::min(radius / (largest_step_radius * g_.size), 1.0),
               .smoothing = how.smoothing > 0 ? how.smoothing : g_.size,
               .min_feature = how.min_feature,
               .price = g_.price,
               .growth = g_.limited ? allowed - design_->area : infinity,
               .room = {}};
  for (const auto& [k, load_case] : rates_->of) {
    const double most = g_.r.bounds[k].at_most * rules_.tight[k],
                 at = design_->by_case[k][static_cast<std::size_t>(load_case)];
    const double room = std::max(most - at, -restoration * std::max(std::abs(g_.r.bounds[k].at_most), std::abs(at)));
    l.room.push_back(room < 0 ? room / s_.faith[static_cast<Eigen::Index>(k)] : room);
  }
  return l;
}

const Eigen::VectorXd& Descent::distance() const {
  if (!distance_) distance_ = signed_distance(g_.background, s_.phi);
  return *distance_;
}

// The objective's rate is without what volume costs in J: that belongs to the price.
MovingDesign Descent::moving() const {
  const Rates& r = rates();
  return {g_.background, distance(), r.objective, r.bounded, g_.free_label()};
}

double Descent::residual() const {
  const MovingDesign of = moving();
  return shape_residual(of, limits(g_.size, g_.limited ? std::max(g_.target, design_->area) : infinity));
}

// Without any boundary to move no price is known, and the lower third of T stands in for it.
void Descent::nucleate(Tried& t, const Eigen::VectorXd& distance) {
  const LevelSetRequest& how = g_.r.level_set;
  const bool enclosed = rates_->objective.curve.edges.empty();
  t.holes = std::make_unique<HoleExpansion>(analyze_objective(*design_), binding_bounds());
  const Eigen::VectorXd& T = t.holes->derivative();
  t.discs = places_to_nucleate(
      g_.background, distance, {design_->cases.front().model.mesh, T, [&](const Vec2& x) { return t.holes->merit(x); }},
      {.multiplier = enclosed && g_.limited ? lower_third(T) : t.step.price - (g_.price - g_.r.volume_penalty),
       .area = how.nucleate_fraction * g_.whole,
       .least = std::max(1.5 * g_.background.size, 0.5 * how.min_feature),
       .most = std::max(1.5 * g_.size, 0.5 * how.min_feature),
       .resolved = rules_.coarse <= 1});  // a ranking on a coarse mesh would be left with few
  if (t.discs.empty()) return;
  cut_discs(g_.background, t.discs, t.phi);
  t.nucleated = true;
}

/// What the nucleated holes do to J, each made alone in the design before: one more solve for all of them.
void Descent::log_nucleated(Tried& t, const std::string& how) {
  std::vector<NucleatedHole> holes = drawn_holes(t.discs, t.drawing.design->shape);
  for (NucleatedHole& hole : holes) hole.iteration = s_.iteration;
  if (rules_.try_holes) s_.solves += try_holes({g_, *design_, rules_.coarse}, *t.holes, holes);
  t.notes.insert(t.notes.begin(), in_words(holes) + how);
  if (rules_.try_holes) std::ranges::move(holes, std::back_inserter(s_.nucleated));
}

void Descent::drop_idle(Eigen::VectorXd& phi) const {
  std::vector<Index> bearing = g_.loaded;
  bearing.insert(bearing.end(), g_.holding.begin(), g_.holding.end());
  drop_dangling(g_.background, bearing, 0.5 * g_.size, phi);
}

// Along the normal: the signed distance less the speed is the distance to the moved boundary, as far as the speed is
// constant along normals.
void Descent::move_boundary(Tried& t) {
  const LevelSetRequest& how = g_.r.level_set;
  const Rates& r = rates();
  if (r.objective.curve.edges.empty() && how.nucleate_every == 0)
    throw Error(Fault::Geometry, "no boundary is free to move; ask for optimize.nucleate or optimize.start");
  t.step = constrained_step(moving(), limits(s_.radius, t.allowed), g_.elastic.get());
  s_.residual = t.step.residual;
  t.phi = distance() - t.step.on_background;
  if (appearing() && how.nucleate_every > 0 && s_.iteration % how.nucleate_every == 0) nucleate(t, distance());
  t.phi = constrained(g_.background, t.phi);
  drop_islands(g_.background, g_.loaded, t.phi);
  drop_idle(t.phi);
}

// The step of the fixed point starts from psi of the step before, not from what was drawn of it: drawing loses what is
// thinner than the mesh.
void Descent::turn(Tried& t) const {
  const Eigen::VectorXd T = derivative();
  const FixedPoint f = fixed_point(
      g_.background, *g_.filter, {design_->cases.front().model.mesh, T}, s_.psi.size() > 0 ? s_.psi : s_.phi,
      {s_.turn, g_.limited ? std::nullopt : std::optional(g_.r.volume_penalty), t.allowed});
  t.step.price = f.multiplier;
  t.step.residual = f.angle;
  t.step.objective = nan;
  t.psi = f.psi;
  t.phi = f.psi;
  drop_islands(g_.background, g_.loaded, t.phi);
  if (g_.limited) t.phi = with_area(g_.background, t.phi, t.allowed);
}

// The allowed area falls by less where the step is smaller.
Descent::Tried Descent::attempt() {
  Tried t;
  const double less = g_.turns() ? s_.turn / largest_turn : s_.radius / (largest_step_radius * g_.size);
  t.allowed = g_.limited ? std::max(g_.target, s_.allowed - std::min(less, 1.0) * drop * g_.whole) : infinity;
  try {
    if (g_.turns()) {
      turn(t);
      s_.residual = t.step.residual;
      // The angle is known with the step: it belongs to the row of the design that the step leaves.
      std::find_if(s_.rows.rbegin(), s_.rows.rend(), [](const Iteration& r) { return r.accepted; })->optimality =
          s_.residual;
    } else {
      move_boundary(t);
    }
    std::optional<double> wanted;
    const double area = negative_area(g_.background.mesh, t.phi);
    // The area is held where material is worth more than it costs; otherwise less of it is better.
    if (g_.limited && (g_.turns() || t.step.price > g_.price || area > t.allowed)) wanted = t.allowed;
    if (wanted && !g_.turns()) t.phi = with_area(g_.background, t.phi, *wanted);
    ++s_.solves;
    t.drawing = draw(g_, t.phi, g_.weak() ? std::nullopt : wanted, rules_.coarse);
  } catch (const Error& error) {
    if (!of_one_body(error)) throw;
    t.failure = error.what();
  }
  return t;
}

/// Weights of violations follow the multipliers.
/// A weight follows its multiplier up at once and down by a tenth per step, so that the merit does not change its mind.
void Descent::judge(Tried& t) {
  if (!rates_) return;
  Eigen::VectorXd now = Eigen::VectorXd::Zero(s_.weight.size());
  for (std::size_t i = 0; i < t.step.multiplier.size(); ++i) {
    const std::size_t k = rates_->of[i].first;
    now[static_cast<Eigen::Index>(k)] += harder * t.step.multiplier[i] * std::abs(g_.r.bounds[k].at_most);
  }
  // What is violated weighs something even where no price is known.
  const Eigen::VectorXd c = relative(vector_of(design_->bounds));
  for (Eigen::Index k = 0; k < c.size(); ++k)
    if (c[k] > 0) now[k] = std::max(now[k], least_weight * std::abs(design_->J));
  s_.weight = now.cwiseMax(0.9 * s_.weight);
  s_.price = t.step.price;
}

/// Of the present design. The angle of a fixed point is known with the step from it.
double Descent::own_residual() const {
  if (g_.turns()) return nan;
  try {
    return residual();
  } catch (const Error& error) {  // the step from here will say so
    if (!of_one_body(error)) throw;
    return nan;
  }
}

// A row of the history, with its residual: what the step from here asks for is kept for it.
void Descent::show(Design design, std::vector<std::string> notes) {
  design_ = std::move(design);
  rates_.reset();
  distance_.reset();
  s_.rows.push_back({.number = s_.iteration,
                     .objective = design_->J,
                     .merit = merit(),
                     .volume_fraction = design_->area / g_.whole,
                     .bounds = design_->bounds,
                     .violation = violation_of(g_.r, design_->bounds, design_->area / g_.whole),
                     .step = g_.turns() ? s_.turn : s_.radius,
                     .optimality = own_residual(),
                     .holes = static_cast<int>(design_->shape.holes.size()),
                     .triangles = static_cast<Index>(design_->cases.front().model.mesh.triangles.size()),
                     .state_solves = s_.solves,
                     .note = join(notes)});
}

/// What rows before have said of carving already, and more than a few, says nothing new.
std::vector<std::string> new_of(const std::vector<std::string>& notes, const std::vector<std::string>& before) {
  constexpr std::size_t most = 3;
  std::vector<std::string> fresh;
  for (const std::string& note : notes)
    if (std::find(before.begin(), before.end(), note) == before.end()) fresh.push_back(note);
  const std::size_t all = fresh.size();
  if (all > most) {
    fresh.resize(most);
    fresh.push_back(fmt::format("{} more of the kind", all - most));
  }
  return fresh;
}

// A step was made: its notes, the radius for the next one, and whether it is the best so far.
void Descent::take(Tried& t) {
  const double before = merit();
  if (t.nucleated) log_nucleated(t, {});
  std::vector<std::string> notes = t.notes;
  for (std::string& note : new_of(t.drawing.notes, s_.drawn)) notes.push_back(std::move(note));
  const double after = value(*t.drawing.design);
  if (t.drawing.design->J > design_->J)
    notes.push_back(!settled()       ? "J rises while the area falls"
                    : after > before ? fmt::format("merit up by {:.2g} %, within what drawing anew may change",
                                                   100 * (after - before) / std::abs(before))
                                     : "J rises for the bounds");
  adapt_radius(t, before, after);
  s_.phi = std::move(t.drawing.phi);
  if (g_.turns()) s_.psi = t.psi;
  s_.drawn = std::move(t.drawing.notes);
  s_.allowed = t.allowed;
  // Steps that still gain 1 % do not use up the time in which holes appear.
  if (settled() && !(s_.explore && after < before - stride * std::abs(before))) ++s_.settled;
  show(std::move(t.drawing.design), std::move(notes));
  keep_if_best();
}

/// By what came of what was predicted, where that is more than noise.
/// While the area falls, or with new holes, the prediction is of another design.
void Descent::adapt_radius(const Tried& t, double before, double after) {
  constexpr double more = 1.4, less = 0.6, good = 0.6, bad = 0.1;
  double factor = 1;
  if (!settled() || t.nucleated || g_.turns()) {
    factor = g_.turns() && after < std::min(before, value(s_.best)) ? 1.2 : 1;
  } else {
    std::vector<double> bounds = design_->bounds;
    for (std::size_t i = 0; i < t.step.bounded.size(); ++i)
      if (const auto& [k, load_case] = rates_->of[i]; load_case == design_->worst[k]) {
        bounds[k] += t.step.bounded[i];
        if (!(t.step.bounded[i] < -redrawing * std::abs(design_->bounds[k]))) continue;
        double& faith = s_.faith[static_cast<Eigen::Index>(k)];
        const double came = (t.drawing.design->bounds[k] - design_->bounds[k]) / t.step.bounded[i];
        // Half of what was believed, half of what came true.
        faith = std::clamp(0.5 * (faith + came), 0.1, 1.0);
      }
    const double predicted = value(design_->J + t.step.objective + (g_.price - g_.r.volume_penalty) * t.step.area,
                                   design_->area + t.step.area, vector_of(bounds)) -
                             before;
    if (std::abs(predicted) > noise()) {
      const double ratio = (after - before) / predicted;
      factor = ratio > good ? more : ratio < bad ? less : 1;
    }
  }
  s_.radius = std::min(factor * s_.radius, largest_step_radius * g_.size);
  s_.turn = std::min(factor * s_.turn, largest_turn);
}

// A design that keeps its bounds beats every one that does not.
void Descent::keep_if_best() {
  if (!settled()) return;
  const double now = merit(), before = value(s_.best);
  const bool good = keeps_bounds(*design_), good_before = best_ && keeps_bounds(*best_);
  const bool better = s_.best.phi.size() == 0 || (good == good_before ? now < before : good);
  if (better) {
    s_.best = {s_.phi, design_->J, design_->area, vector_of(design_->bounds), s_.iteration};
    best_ = design_;
  }
  s_.since = better ? 0 : s_.since + 1;
  s_.track.push_back(value(s_.best));
}

// The radius and the turn are halved; the row has the step that was tried, and no design.
void Descent::refuse(const Tried& t, double rise) {
  const std::string why = t.drawing.design
                              ? fmt::format("refused: merit would rise by {:.2g} %", 100 * rise / std::abs(merit()))
                              : fmt::format("refused: {}", t.failure);
  s_.radius *= 0.5;
  s_.turn *= 0.5;
  Iteration row = s_.rows.back();
  row.number = s_.iteration;
  row.accepted = false;
  row.state_solves = s_.solves;
  row.note = why;
  row.step = 2 * (g_.turns() ? s_.turn : s_.radius);
  row.objective = row.merit = row.optimality = nan;
  if (t.drawing.design) {
    const Evaluated& e = *t.drawing.design;
    row.objective = e.J;
    row.merit = value(e);
    row.volume_fraction = e.area / g_.whole;
    row.bounds = e.bounds;
    row.violation = violation_of(g_.r, e.bounds, e.area / g_.whole);
    row.holes = static_cast<int>(e.shape.holes.size());
    row.triangles = static_cast<Index>(e.cases.front().model.mesh.triangles.size());
  }
  s_.rows.push_back(std::move(row));
}

// Back to a design that was drawn before: nothing is solved.
void Descent::go_back(const KeptDesign& to, const std::string& why) {
  s_.phi = to.phi;
  if (g_.turns()) s_.psi = to.phi;
  s_.since = 0;
  ++s_.iteration;
  show(&to == &s_.anchor ? anchored_ : best_, {fmt::format("back to iteration {}: {}", to.iteration, why)});
}

// Three reasons: the shape residual is small, the best merit stands still over a window of steps, the radius is too
// small.
std::string Descent::reason_to_end() const {
  if (!settled() || s_.best.phi.size() == 0 || appearing()) return {};
  const std::size_t n = s_.track.size();
  if (!g_.turns() && s_.settled > 2 && s_.residual <= rules_.residual && keeps_bounds(*best_))
    return fmt::format("shape residual {:.2g}", s_.residual);
  const double little = g_.turns() ? g_.r.tolerance : redrawing;
  if (n > window && s_.track[n - 1 - window] - s_.track.back() < little * std::abs(s_.track.back()))
    return fmt::format("the best merit fell by less than {:.1g} of it in {} steps", little, window);
  if (s_.radius < least_step_radius * g_.size || s_.turn < smallest_turn)
    return fmt::format("no better design within a step of {:.2g}", 2 * (g_.turns() ? s_.turn : s_.radius));
  return {};
}

/// Holes where T says that they pay, if there are such places: steps from there have to beat the design of now.
bool Descent::try_nucleation() {
  if (g_.turns() || g_.r.level_set.nucleate_every == 0 || s_.trials >= rules_.trials ||
      s_.iteration >= rules_.iterations)
    return false;
  ++s_.trials;
  rates();
  Tried t;
  // Only places well below the price are tried.
  t.step.price = pays * s_.price;
  t.phi = distance();
  nucleate(t, distance());
  if (!t.nucleated) return false;
  try {
    t.phi = constrained(g_.background, t.phi);
    std::optional<double> wanted;
    if (g_.limited && s_.price > g_.price) t.phi = with_area(g_.background, t.phi, *(wanted = s_.allowed));
    ++s_.iteration;
    ++s_.solves;
    t.drawing = draw(g_, t.phi, wanted, rules_.coarse);
    log_nucleated(t, " on trial");
    // The anchor is what the trial has to beat.
    s_.anchor = s_.best;
    anchored_ = best_;
    s_.since = 0;
    s_.radius = std::max(s_.radius, 0.5 * largest_step_radius * g_.size);
    s_.phi = std::move(t.drawing.phi);
    show(std::move(t.drawing.design), t.notes);
  } catch (const Error& error) {
    if (!of_one_body(error)) throw;
    return false;
  }
  s_.track.clear();
  return true;
}

/// Of a trial nucleation: whether it was worth it.
void Descent::close_trial(bool worth) {
  if (worth) {
    --s_.trials;
    s_.rows.back().note = join({s_.rows.back().note, "the trial has paid"});
  } else {
    s_.best = s_.anchor;
    best_ = anchored_;
    go_back(s_.anchor, "the trial did not pay");
  }
  s_.anchor = {};
  anchored_ = nullptr;
  s_.track.assign(1, value(s_.best));
}

/// What the step before asked for. Whether that was an iteration of its own.
bool Descent::follow_up() {
  const Next next = static_cast<Next>(std::exchange(s_.next, static_cast<int>(Next::Step)));
  switch (next) {
    case Next::Step:
      return false;
    case Next::BackToBest:
      go_back(s_.best, s_.why);
      return true;
    case Next::CloseTrial:
      close_trial(value(s_.best) < value(s_.anchor) - noise());
      return true;
    case Next::End:
      s_.next = static_cast<int>(Next::Nucleate);
      if (!best_ || (best_ == design_ && s_.rows.back().accepted)) return follow_up();
      for (const Iteration& row : s_.rows)
        if (row.number == s_.best.iteration) s_.residual = row.optimality;
      go_back(s_.best, s_.why);
      return true;
    case Next::Nucleate:
      if (settled() && try_nucleation()) return true;
      s_.ended = s_.why;
      return true;
  }
  return false;
}

// While the area falls, or holes appear by themselves, rises are followed up to ten times J: the first designs of less
// area are worse in any case.
void Descent::step() {
  ++s_.iteration;
  const bool free = !settled() || appearing();  // rises are followed
  Tried t = attempt();
  judge(t);
  if (!t.drawing.design) return refuse(t, nan);
  const double before = g_.turns() && settled() ? value(s_.best) : merit(), rise = value(*t.drawing.design) - before;
  if (free || t.allowed < s_.allowed || t.nucleated ? rise > jump * std::abs(before) : !(rise <= noise()))
    refuse(t, rise);
  else
    take(t);
}

// What the next call does: a trial nucleation is closed when it has paid, after eight steps or at a tiny radius; the
// end asks for the best design and then for a trial; four steps without a better design go back to the best with half
// the radius.
void Descent::decide() {
  constexpr int trial_steps = 8;
  const auto then = [&](Next next, std::string why) {
    s_.next = static_cast<int>(next);
    s_.why = std::move(why);
  };
  const bool small = s_.radius < least_step_radius * g_.size;
  if (s_.anchor.phi.size() > 0) {
    if (value(s_.best) < value(s_.anchor) - noise() || s_.since >= trial_steps || small) then(Next::CloseTrial, {});
    return;
  }
  if (!settled()) {
    if (small) then(Next::End, fmt::format("no step can be made: {}", s_.rows.back().note));
    return;
  }
  if (const std::string why = reason_to_end(); !why.empty()) return then(Next::End, why);
  if (!appearing() && s_.since >= patience && best_ && best_ != design_) {
    s_.radius *= 0.5;
    s_.turn *= 0.5;
    then(Next::BackToBest, fmt::format("no better design in {} steps", patience));
  }
}

// Out of iterations the best design comes back, and an open trial that has not paid is dropped.
bool Descent::advance() {
  if (!s_.ended.empty()) return false;
  if (s_.iteration >= rules_.iterations) {
    if (s_.anchor.phi.size() > 0 && !(value(s_.best) < value(s_.anchor) - noise())) {
      s_.best = s_.anchor;
      best_ = anchored_;
    }
    s_.ended = fmt::format("the iterations asked for are done ({})", rules_.iterations);
    s_.spent = true;
    if (best_ && (best_ != design_ || !s_.rows.back().accepted)) go_back(s_.best, "the best design");
    return false;
  }
  if (follow_up()) return s_.ended.empty();
  step();
  decide();
  return true;
}

}  // namespace kerf
