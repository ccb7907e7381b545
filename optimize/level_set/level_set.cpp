#include "kerf/optimize.hpp"

#include "kerf/map.hpp"
#include "kerf/mesher.hpp"
#include "optimize/checkpoint.hpp"
#include "optimize/ersatz.hpp"
#include "optimize/level_set/background.hpp"
#include "optimize/level_set/fixed_point.hpp"
#include "optimize/level_set/nucleate.hpp"
#include "optimize/level_set/speed.hpp"
#include "optimize/loop/finish.hpp"
#include "optimize/loop/history_text.hpp"
#include "optimize/refuse.hpp"
#include "solver/stress.hpp"
#include "topo/map_at_centroids.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <tuple>

namespace kerf {

namespace {

// Lengths relative to the mesh size, shares of the area of the frame.
constexpr double fine = 0.5;          // the background mesh against the mesh of the body
constexpr double strip = 1.5;         // of background edges beside loads that stay solid
constexpr double drop = 0.02;         // of the area that is taken away in one step
constexpr double early = 1.4;         // the mesh of the body while its area still falls
constexpr double largest_step = 1.0;  // of the boundary
constexpr double largest_turn = 0.5;  // of the fixed point: share of the angle
constexpr double smallest_step = 0.03;
constexpr double area_error = 2e-5;  // of the shape that is drawn against the area wanted
constexpr double jump = 10;          // of J in one step while the area falls
constexpr double rise = 0.02;        // of the merit over the best one that is followed for a while
constexpr int patience = 4;          // iterations without a better design before the step is halved
constexpr const char* out_of_iterations = "the iterations asked for are done";
constexpr double largest_residual = 0.1;  // of the shape of what is called optimal [theory: L.10]
constexpr std::size_t window = 8;         // iterations over which a small change means convergence

/// All that an iteration leaves to the next one.
struct Progress {
  int iteration = 0, solves = 0;
  double wanted = 0;    // area
  double step = 0;      // largest move of the boundary, a length
  Eigen::VectorXd phi;  // of the present design, as it was carved
  Eigen::VectorXd psi;  // of the fixed point: on the unit sphere of L2
  double turn = largest_turn;
  Eigen::VectorXd lambda;  // multipliers of the bounds
  Eigen::VectorXd tight;   // share of every bound that the loop's mesh may use, so that a finer one keeps it
  int tightened = 0;
  double multiplier = 0;  // of the area
  Eigen::VectorXd best;   // phi of the best design at the final area; empty before
  double best_J = infinity, best_area = 0;
  Eigen::VectorXd best_bounds;
  int best_iteration = 0, since = 0;  // iterations since the best
  Eigen::VectorXd kept;               // phi of the design of least J that keeps the bounds; empty without bounds
  double kept_J = infinity;
  int kept_iteration = 0;
  std::vector<double> track;       // merit of the best after every iteration at the final area
  std::string ended;               // why the loop is over; empty while it is not
  std::vector<std::string> drawn;  // what carving the present design said
  std::vector<Iteration> rows;
};

// What a checkpoint holds of it, by name: vectors, "track", the texts "ended" and "drawn", the rows, and "scalars" in
// this order.
constexpr std::array<std::pair<const char*, Eigen::VectorXd Progress::*>, 7> kept_vectors{
    {{"phi", &Progress::phi},
     {"psi", &Progress::psi},
     {"lambda", &Progress::lambda},
     {"tight", &Progress::tight},
     {"best", &Progress::best},
     {"kept", &Progress::kept},
     {"best_bounds", &Progress::best_bounds}}};
template <typename State, typename Number>
auto kept_scalars(State& s, Number& mesh_size) {
  return std::tie(s.iteration, s.solves, s.wanted, s.step, s.turn, s.multiplier, s.best_J, s.best_area,
                  s.best_iteration, s.since, mesh_size, s.kept_J, s.kept_iteration, s.tightened);
}

Eigen::VectorXd vector_of(const std::vector<double>& v) {
  return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

Checkpoint packed(const Progress& s, double mesh_size) {
  Checkpoint c;
  for (const auto& [name, member] : kept_vectors) c.numbers[name] = s.*member;
  c.numbers["track"] = vector_of(s.track);
  c.numbers["scalars"] =
      std::apply([](const auto&... x) { return vector_of({static_cast<double>(x)...}); }, kept_scalars(s, mesh_size));
  c.texts["ended"] = s.ended;
  c.texts["drawn"] = join(s.drawn, "\n");
  write_rows(c, s.rows);
  return c;
}

Progress unpacked(const Checkpoint& c, double& mesh_size) {
  Progress s;
  for (const auto& [name, member] : kept_vectors) s.*member = c.numbers.at(name);
  const Eigen::VectorXd &track = c.numbers.at("track"), &scalars = c.numbers.at("scalars");
  s.track.assign(track.begin(), track.end());
  Eigen::Index i = 0;
  std::apply([&](auto&... x) { ((x = static_cast<std::remove_reference_t<decltype(x)>>(scalars[i++])), ...); },
             kept_scalars(s, mesh_size));
  s.ended = c.texts.at("ended");
  s.drawn = split_lines(c.texts.at("drawn"));
  s.rows = read_rows(c);
  return s;
}

class LevelSetRun {
 public:
  LevelSetRun(const Problem& p, const OptimizeRequest& r, const Observer& see, const CheckpointPlace& place);
  OptimizeResult run();

 private:
  using Design = std::shared_ptr<const Evaluated>;

  Design evaluate(const Eigen::VectorXd& phi) const;
  Design trial(Eigen::VectorXd& phi, std::vector<std::string>& notes, std::vector<std::string>& drawn);
  double merit(double J, double area, const Eigen::VectorXd& bounds) const;
  double merit(const Evaluated& e) const;
  double violation(const Evaluated& e) const;
  bool keeps_bounds(const Evaluated& e) const;
  bool tighten();
  FinerDesign finer(const Evaluated& e) const;
  FinerDesign finer_strong(const OptimizeResult& result) const;
  BoundaryRate total_rate(const Evaluated& e) const;
  HoleMargin hole_margin(const Evaluated& e, double price) const;
  LoopEnd loop_end(const std::string& why, bool go_on, HoleMargin& holes) const;
  void finish(OptimizeResult& result, const std::string& why, bool go_on) const;
  Eigen::VectorXd relative(const Eigen::VectorXd& bounds) const;
  std::vector<double> weights(const Evaluated& e) const;
  Eigen::VectorXd shape_step(const Evaluated& e, std::vector<std::string>& notes);
  Eigen::VectorXd fixed_point_step(const Evaluated& e);
  Eigen::VectorXd derivative(const Evaluated& e) const;
  bool accept(Design e, std::vector<std::string> notes);
  bool settled() const {
    return penalized_ || s_.wanted <= target_;
  }
  Index free_label() const {
    return static_cast<Index>(p_.frame.labels.size());
  }
  void save() const;
  bool restore();

  const Problem& p_;
  const OptimizeRequest& r_;
  const Observer& see_;
  const CheckpointPlace& place_;
  Problem fitted_;  // the problem, meshes with one edge across thin members
  BackgroundMesh background_;
  Carving carving_;
  std::vector<Index> loaded_;  // labels of loads and of what functionals look at
  std::unique_ptr<Helmholtz> filter_;
  std::unique_ptr<ElasticProduct> elastic_;
  double whole_ = 0, target_ = 0, size_ = 0;
  double price_ = 0;  // per area, of volume terms in J
  bool penalized_ = false;
  double optimality_ = nan;    // of the design that the last step started from
  std::vector<Index> strong_;  // of the strong phase alone: crack of the frame per crack
  bool worthless_ = false;     // less material is better everywhere: the area is not held
  Progress s_;
  Design design_, best_, kept_;
};

Solid solid_parts(const Problem& p, const OptimizeRequest& r, double width, std::vector<std::string>& notes) {
  // Masks that end on the outline hold its vertices, too; what is of another material may not be touched.
  Solid solid{.width = width};
  for (const Loop& loop : r.level_set.frozen) solid.loops.emplace_back(loop, width / 3);
  for (const Loop& loop : p.frame.regions) solid.loops.emplace_back(loop, width);
  const auto stays = [&solid](Index label) {
    if (label != none && std::find(solid.labels.begin(), solid.labels.end(), label) == solid.labels.end())
      solid.labels.push_back(label);
  };
  for (const Scene& scene : scenes_of(p, r))
    for (const Traction& t : scene.tractions) stays(t.label);
  for (const Support& support : p.scene.supports) solid.held.push_back(support.label);
  std::vector<const Functional*> all{&p.objective};
  for (const FunctionalBound& b : r.bounds) all.push_back(&b.functional);
  for (const Functional* j : all)
    for (const Term& term : j->terms) {
      stays(term.label);
      if (term.measured) stays(term.measured->label);
      if (term.feature_radius > 0) {
        solid.discs.emplace_back(term.feature, term.feature_radius);
        notes.push_back(fmt::format("the ring of {} around ({:.4g}, {:.4g}) stays solid", term.kind, term.feature.x(),
                                    term.feature.y()));
      }
    }
  return solid;
}

LevelSetRun::LevelSetRun(const Problem& p, const OptimizeRequest& r, const Observer& see, const CheckpointPlace& place)
    : p_(p), r_(r), see_(see), place_(place), fitted_(p) {
  const LevelSetRequest& how = r.level_set;
  for (const Term& term : p.objective.terms)
    if (term.volume) price_ += term.factor;
  double cases = r.load_cases.empty() ? 1 : 0;
  for (const LoadCase& load : r.load_cases) cases += load.weight;
  price_ *= cases;
  if (p.sizing.size <= 0) fitted_.sizing.size = extent(p.frame) / 40;
  size_ = fitted_.sizing.size;
  fitted_.sizing.across = 1;
  Sizing even = fitted_.sizing;
  even.size = how.ersatz > 0 ? size_ : fine * size_;
  even.crack_tip_size = even.size;
  std::vector<std::string> notes;
  const Solid solid = solid_parts(p, r, strip * even.size, notes);
  background_ = background_mesh(triangulate(p.frame, even), solid, how.mirror);
  whole_ = background_.lumped.sum();
  target_ = r.volume_at_most.value_or(1) * whole_;
  penalized_ = !r.volume_at_most || *r.volume_at_most >= 1;
  carving_ = {.spacing = size_, .least_area = even.size * even.size, .keep = solid.labels};
  loaded_ = solid.labels;
  for (const Index label : solid.held) carving_.keep.push_back(label), carving_.holding.push_back(label);
  const double smoothing = how.smoothing > 0 ? how.smoothing : size_;
  if (how.move == LevelSetRequest::Move::ShapeGradient && how.product == LevelSetRequest::Product::Elasticity)
    elastic_ = std::make_unique<ElasticProduct>(background_, smoothing);
  if (how.move == LevelSetRequest::Move::FixedPoint)
    filter_ = std::make_unique<Helmholtz>(background_, how.smoothing > 0 ? how.smoothing : 1.5 * background_.size);
}

LevelSetRun::Design LevelSetRun::evaluate(const Eigen::VectorXd& phi) const {
  if (r_.level_set.ersatz > 0) return std::make_shared<Evaluated>(evaluate_ersatz(fitted_, r_, background_, phi));
  Carved carved = carve(p_.frame, background_.mesh, phi, carving_);
  return std::make_shared<Evaluated>(evaluate_design(fitted_, r_, std::move(carved.shape), carved.crack_of));
}

/// Shifts phi until the shape drawn has the wanted area, meshes and solves.
LevelSetRun::Design LevelSetRun::trial(Eigen::VectorXd& phi, std::vector<std::string>& notes,
                                       std::vector<std::string>& drawn) {
  if (r_.level_set.ersatz > 0) {
    ++s_.solves;
    return evaluate(phi);
  }
  // What is far from its area needs no fine mesh.
  fitted_.sizing.size = settled() ? size_ : early * size_;
  carving_.spacing = fitted_.sizing.size;
  Carved carved = carve(p_.frame, background_.mesh, phi, carving_);
  if (!penalized_)
    for (int i = 0; i < 3 && std::abs(carved.area - s_.wanted) > area_error * whole_; ++i) {
      const std::vector<ZeroPiece> line = zero_line(background_.mesh, phi);
      const double length = std::accumulate(line.begin(), line.end(), 0.0,
                                            [](double sum, const ZeroPiece& z) { return sum + (z.a - z.b).norm(); });
      if (!(length > 0)) break;
      const double most = 0.2 * background_.size;
      phi.array() += std::clamp((carved.area - s_.wanted) / length, -most, most);
      if (background_.frozen.size() > 0) phi = phi.cwiseMin(background_.frozen);
      carved = carve(p_.frame, background_.mesh, phi, carving_);
    }
  ++s_.solves;
  auto e = std::make_shared<Evaluated>(evaluate_design(fitted_, r_, std::move(carved.shape), carved.crack_of));
  // What the rows before have said already, and more than a few, says nothing new.
  constexpr std::size_t most = 3;
  std::size_t left_out = 0, told = 0;
  for (const std::string& note : carved.notes) {
    if (std::find(s_.drawn.begin(), s_.drawn.end(), note) != s_.drawn.end()) continue;
    if (told++ < most)
      notes.push_back(note);
    else
      ++left_out;
  }
  if (left_out > 0) notes.push_back(fmt::format("{} more of the kind", left_out));
  drawn = std::move(carved.notes);
  return e;
}

/// (value - what the loop's mesh may use of the bound) / |bound|.
Eigen::VectorXd LevelSetRun::relative(const Eigen::VectorXd& bounds) const {
  Eigen::VectorXd c(bounds.size());
  for (Eigen::Index i = 0; i < c.size(); ++i) {
    const double most = r_.bounds[static_cast<std::size_t>(i)].at_most;
    c[i] = (bounds[i] - most * s_.tight[i]) / std::max(std::abs(most), 1e-300);
  }
  return c;
}

constexpr double patient_multipliers = 0.2;  // of the step that the augmented Lagrangian's multipliers take
constexpr double stiffness_of_bounds = 5;    // of the augmented Lagrangian, in units of J

/// J + price of area + augmented Lagrangian of the bounds [Rockafellar 1973; theory: L.7], in units of J of the start.
double LevelSetRun::merit(double J, double area, const Eigen::VectorXd& bounds) const {
  const double unit = s_.rows.empty() ? std::abs(J) : std::abs(s_.rows.front().objective);
  const double price = penalized_ ? r_.volume_penalty : s_.multiplier;
  double value = J + r_.volume_penalty * area + (penalized_ ? 0 : price * (area - s_.wanted));
  const Eigen::VectorXd c = relative(bounds);
  for (Eigen::Index i = 0; i < c.size(); ++i) {
    const double force = std::max(s_.lambda[i] + stiffness_of_bounds * c[i], 0.0);
    value += unit * (force * force - s_.lambda[i] * s_.lambda[i]) / (2 * stiffness_of_bounds);
  }
  return value;
}

/// What a value has over another, in words.
std::string excess(double value, double best) {
  return best != 0 ? fmt::format("{:.2g} %", 100 * (value - best) / std::abs(best))
                   : fmt::format("{:.3g}", value - best);
}

double LevelSetRun::merit(const Evaluated& e) const {
  return merit(e.J, e.area, vector_of(e.bounds));
}

/// Those that the loop holds itself to.
bool LevelSetRun::keeps_bounds(const Evaluated& e) const {
  const Eigen::VectorXd c = relative(vector_of(e.bounds));
  return violation(e) < feasible_violation && (c.size() == 0 || c.maxCoeff() < feasible_violation);
}

double LevelSetRun::violation(const Evaluated& e) const {
  return violation_of(r_, e.bounds, e.area / whole_);
}

/// d merit / d bound, per bound.
std::vector<double> LevelSetRun::weights(const Evaluated& e) const {
  const double unit = std::abs(s_.rows.front().objective);
  const Eigen::VectorXd c = relative(vector_of(e.bounds));
  std::vector<double> w;
  for (Eigen::Index i = 0; i < c.size(); ++i)
    w.push_back(unit * std::max(s_.lambda[i] + stiffness_of_bounds * c[i], 0.0) /
                std::max(std::abs(r_.bounds[static_cast<std::size_t>(i)].at_most), 1e-300));
  return w;
}

/// T of the merit without its area at the centroids of the first load case's mesh; a weak phase: minus that of becoming
/// solid.
Eigen::VectorXd LevelSetRun::derivative(const Evaluated& e) const {
  const Mesh& mesh = e.cases.front().model.mesh;
  const Perturbation hole = r_.level_set.ersatz > 0
                                ? Perturbation{.kind = Perturbation::Kind::Inclusion,
                                               .inclusion = weak_material(p_.scene.material, r_.level_set.ersatz)}
                                : Perturbation{};
  const Perturbation filled{.kind = Perturbation::Kind::Inclusion, .inclusion = p_.scene.material};
  const auto change = [&](Index t) -> const Perturbation& {
    return r_.level_set.ersatz > 0 && strong_share(region_of(mesh, t)) < 0.5 ? filled : hole;
  };
  Eigen::VectorXd T = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(mesh.triangles.size()));
  const auto add = [&](const std::vector<WeightedAnalysis>& all, double factor) {
    for (const WeightedAnalysis& w : all) T += factor * w.weight * map_at_centroids(w.analysis, *w.functional, change);
  };
  add(analyze_objective(e), 1);
  const std::vector<double> weight = weights(e);
  for (std::size_t k = 0; k < weight.size(); ++k)
    if (weight[k] > 0) add(analyze_bound(e, k), weight[k]);
  if (r_.level_set.ersatz > 0)
    for (Index t = 0; t < T.size(); ++t)
      if (strong_share(region_of(mesh, t)) < 0.5) T[t] = -T[t];
  return T;
}

/// Below it lies a third of the values: the price of area where no boundary tells one.
double lower_third(const Eigen::VectorXd& values) {
  std::vector<double> sorted(values.begin(), values.end());
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 3);
  std::nth_element(sorted.begin(), at, sorted.end());
  return *at;
}

/// Of the merit without the price of its area.
BoundaryRate LevelSetRun::total_rate(const Evaluated& e) const {
  BoundaryRate rate = boundary_rate(e, analyze_objective(e));
  const std::vector<double> weight = weights(e);
  for (std::size_t k = 0; k < weight.size(); ++k)
    if (weight[k] > 0) add(rate, weight[k], boundary_rate(e, analyze_bound(e, k)));
  rate.density.array() -= price_;
  return rate;
}

Eigen::VectorXd LevelSetRun::shape_step(const Evaluated& e, std::vector<std::string>& notes) {
  const LevelSetRequest& how = r_.level_set;
  const BoundaryRate rate = total_rate(e);
  const bool enclosed = rate.curve.edges.empty();
  if (enclosed && how.nucleate_every == 0)
    throw Error(Fault::Geometry, "no boundary is free to move; ask for optimize.nucleate or optimize.start");
  const Eigen::VectorXd distance = signed_distance(background_, s_.phi);
  const SpeedLimits limits{.most = s_.step,
                           .share = std::min(1 * s_.step / size_, 1.0),
                           .smoothing = how.smoothing > 0 ? how.smoothing : size_,
                           .min_feature = how.min_feature};
  const Speed speed = boundary_speed({background_, distance, rate, free_label()}, limits, elastic_.get(),
                                     penalized_ ? std::optional(r_.volume_penalty + price_) : std::nullopt);
  s_.multiplier = speed.multiplier - price_;
  optimality_ = speed.optimality;
  worthless_ = !penalized_ && !enclosed && !(speed.multiplier > 0);
  Eigen::VectorXd next = distance - speed.on_background;
  if (how.nucleate_every > 0 && s_.iteration % how.nucleate_every == 0 && s_.iteration < r_.max_iterations / 2) {
    const Eigen::VectorXd T = derivative(e);
    const std::vector<Disc> discs =
        places_to_nucleate(background_, distance, e.cases.front().model.mesh, T,
                           {.multiplier = enclosed && !penalized_ ? lower_third(T) : s_.multiplier,
                            .area = how.nucleate_fraction * whole_,
                            .least = std::max(1.5 * background_.size, 0.5 * how.min_feature),
                            .most = std::max(1.5 * size_, 0.5 * how.min_feature)});
    if (!discs.empty()) notes.push_back(fmt::format("{} hole{} nucleated", discs.size(), discs.size() == 1 ? "" : "s"));
    cut_discs(background_, discs, next);
  }
  return next;
}

Eigen::VectorXd LevelSetRun::fixed_point_step(const Evaluated& e) {
  const Eigen::VectorXd T = derivative(e);
  const FixedPoint f = fixed_point(background_, *filter_, {e.cases.front().model.mesh, T}, s_.psi,
                                   {s_.turn, penalized_ ? std::optional(r_.volume_penalty) : std::nullopt, s_.wanted});
  s_.multiplier = f.multiplier;
  optimality_ = f.angle;
  s_.psi = f.psi;
  Eigen::VectorXd next = s_.psi;
  drop_islands(background_, loaded_, next);
  return penalized_ ? next : with_area(background_, next, s_.wanted);
}

bool LevelSetRun::accept(Design e, std::vector<std::string> notes) {
  design_ = std::move(e);
  Iteration row{.number = s_.iteration,
                .objective = design_->J,
                .merit = merit(*design_),
                .volume_fraction = design_->area / whole_,
                .bounds = design_->bounds,
                .violation = violation(*design_),
                .step = s_.step,
                .optimality = optimality_,
                .holes = static_cast<int>(design_->shape.holes.size()),
                .triangles = static_cast<Index>(design_->cases.front().model.mesh.triangles.size()),
                .state_solves = s_.solves,
                .note = join(notes)};
  s_.rows.push_back(std::move(row));
  return !see_ || see_({s_.rows.back(), design_->shape, design_->cases.front().model, design_->cases.front().state});
}

OptimizeResult LevelSetRun::run() {
  OptimizeResult result{.method = OptimizeMethod::LevelSet};
  bool go_on = true;
  if (!restore()) {
    const Eigen::Index n = static_cast<Eigen::Index>(background_.mesh.points.size());
    s_.lambda = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(r_.bounds.size()));
    s_.tight = Eigen::VectorXd::Ones(s_.lambda.size());
    s_.step = largest_step * size_;
    Eigen::VectorXd phi = Eigen::VectorXd::Constant(n, -1e3 * size_);
    if (r_.level_set.start) {
      Vec2 low = background_.mesh.points[0], high = low;
      for (const Vec2& x : background_.mesh.points) low = low.cwiseMin(x), high = high.cwiseMax(x);
      const std::vector<Disc> discs = start_discs(*r_.level_set.start, low, high);
      cut_discs(background_, discs, phi);
    }
    s_.phi = signed_distance(background_, constrained(background_, phi));
    s_.wanted = std::max(target_, negative_area(background_.mesh, s_.phi));
    if (!settled()) fitted_.sizing.size = carving_.spacing = early * size_;
    ++s_.solves;
    Design start;
    try {
      start = evaluate(s_.phi);
    } catch (const Error& error) {
      if (!r_.level_set.start || error.fault != Fault::Geometry) throw;
      throw Error(Fault::Geometry, fmt::format("the holes of optimize.start leave no body to begin with: {}; use fewer "
                                               "or smaller ones",
                                               error.what()));
    }
    if (start->J == 0 && r_.bounds.empty())
      throw Error(Fault::Usage, fmt::format("functional \"{}\" is 0 for the body to begin with: there is nothing to "
                                            "minimize; are there loads, and does it see them?",
                                            p_.objective.kind));
    go_on = accept(start, {});
    save();
  }
  std::string stopped = s_.ended;
  while (go_on && stopped.empty()) {
    if (s_.iteration >= r_.max_iterations) {
      stopped = fmt::format("{} ({})", out_of_iterations, r_.max_iterations);
      break;
    }
    ++s_.iteration;
    const bool was_settled = settled();
    const double less = std::min(1.0, s_.step / (largest_step * size_)) * drop * whole_;
    if (!penalized_) s_.wanted = std::max(target_, s_.wanted - less);
    std::vector<std::string> notes;
    const bool fixed = r_.level_set.move == LevelSetRequest::Move::FixedPoint;
    if (s_.psi.size() == 0) s_.psi = s_.phi;
    const Eigen::VectorXd psi = s_.psi;
    Design tried;
    Eigen::VectorXd next;
    std::string failure;
    std::vector<std::string> drawn = s_.drawn;
    try {
      next = fixed ? fixed_point_step(*design_) : shape_step(*design_, notes);
      if (!fixed) {
        next = constrained(background_, next);
        drop_islands(background_, loaded_, next);
        if (worthless_) s_.wanted = std::min(s_.wanted, negative_area(background_.mesh, next));
        if (!penalized_) next = with_area(background_, next, s_.wanted);
      }
      tried = trial(next, notes, drawn);
    } catch (const Error& error) {
      if (error.fault != Fault::Geometry && error.fault != Fault::Numerics) throw;
      failure = error.what();
    }
    if (tried && !was_settled && s_.best.size() == 0 &&
        tried->J > jump * std::abs(design_->J) + design_->J - std::abs(design_->J) &&
        s_.step > 4 * smallest_step * size_) {
      failure = fmt::format("J would rise from {:.4g} to {:.4g} at once", design_->J, tried->J);
      tried = nullptr;
    }
    // Before the area is the wanted one J may rise: nothing is best yet.
    const double value = tried ? merit(*tried) : infinity;
    const double best = s_.best.size() > 0 ? merit(s_.best_J, s_.best_area, s_.best_bounds) : infinity;
    const bool better = settled() && value < best;
    const bool lost =
        settled() && s_.best.size() > 0 && !better && (value > best + rise * std::abs(best) || s_.since + 1 > patience);
    if (!tried && s_.best.size() == 0) {
      // There is nothing to go back to but the present design: smaller steps from it.
      s_.psi = psi;
      s_.step *= 0.5;
      s_.turn *= 0.5;
      if (!penalized_) s_.wanted = std::min(s_.wanted + less, std::max(design_->area, target_));
      s_.rows.back().note = join({s_.rows.back().note, "step halved: " + failure});
      if (s_.step < smallest_step * size_) stopped = "no step can be made: " + failure;
      save();
      continue;
    }
    if (!tried || lost) {
      s_.step *= 0.5;
      s_.turn *= 0.5;
      s_.since = 0;
      const std::string why =
          !tried ? failure : fmt::format("J would be {:.6g}, {} above the best", tried->J, excess(value, best));
      s_.phi = s_.best;
      design_ = best_;
      go_on = accept(design_, {fmt::format("back to iteration {}, half the step: {}", s_.best_iteration, why)});
      if (fixed) s_.psi = s_.best;
    } else {
      if (better) {
        s_.since = 0;
        s_.step = std::min(1.2 * s_.step, largest_step * size_);
        s_.turn = std::min(1.2 * s_.turn, largest_turn);
      } else if (settled()) {
        ++s_.since;
        notes.push_back(fmt::format("merit above the best by {}, followed for at most {} iterations",
                                    excess(value, best), patience));
      } else {
        s_.step = std::min(1.2 * s_.step, largest_step * size_);
        s_.turn = std::min(1.2 * s_.turn, largest_turn);
        if (tried->J > design_->J) notes.push_back("J rises while the area falls");
      }
      s_.phi = next;
      s_.drawn = std::move(drawn);
      go_on = accept(tried, notes);
      if (better || (settled() && s_.best.size() == 0)) {
        s_.best = next;
        best_ = design_;
        s_.best_J = design_->J;
        s_.best_area = design_->area;
        s_.best_bounds = vector_of(design_->bounds);
        s_.best_iteration = s_.iteration;
      }
      if (settled() && !r_.bounds.empty() && keeps_bounds(*design_) && design_->J < s_.kept_J) {
        s_.kept = next;
        s_.kept_J = design_->J;
        s_.kept_iteration = s_.iteration;
        kept_ = design_;
      }
      // Multipliers of the bounds, once the area is there.
      if (settled() && was_settled)
        s_.lambda =
            (s_.lambda + patient_multipliers * stiffness_of_bounds * relative(vector_of(design_->bounds))).cwiseMax(0);
    }
    const bool moved = tried && !lost;
    if (moved && settled() && s_.best.size() > 0) {
      s_.track.push_back(merit(s_.best_J, s_.best_area, s_.best_bounds));
      const std::size_t n = s_.track.size();
      if (n > window && s_.track[n - 1 - window] - s_.track.back() < r_.tolerance * std::abs(s_.track.back()) &&
          keeps_bounds(*best_))
        stopped = fmt::format("the best merit fell by less than {:.1g} of it in {} steps", r_.tolerance, window);
    }
    if (stopped.empty() && s_.step < smallest_step * size_)
      stopped = fmt::format("no better design within a step of {:.2g}", 2 * s_.step);
    if (!stopped.empty() && s_.iteration < r_.max_iterations && tighten()) stopped.clear();
    save();
  }
  if (go_on && s_.ended.empty()) {
    if (kept_ && best_ && !keeps_bounds(*best_)) {
      best_ = kept_;
      s_.best = s_.kept;
      s_.best_iteration = s_.kept_iteration;
    }
    if (s_.best.size() > 0 && best_ != design_) {
      s_.phi = s_.best;
      // What the step from the best design said of it.
      for (const Iteration& row : s_.rows)
        if (row.number == s_.best_iteration + 1) optimality_ = row.optimality;
      ++s_.iteration;
      accept(best_, {fmt::format("the best design, of iteration {}", s_.best_iteration)});
      --s_.iteration;
    }
    s_.ended = stopped;
    save();
  }
  for (const Term& term : p_.objective.terms)
    if (term.energy && term.factor > 0)
      result.notes.push_back(
          "the potential energy of a loaded body falls when material goes: for a stiff one minimize kind = "
          "\"compliance\"");
  result.iterations = s_.iteration;
  result.state_solves = s_.solves;
  result.objective = design_->J;
  result.volume_fraction = design_->area / whole_;
  result.history = s_.rows;
  result.shape = design_->shape;
  result.scene = design_->cases.front().model.scene;
  if (r_.level_set.ersatz > 0) {
    // What the phases stand for, as a body.
    result.scene.regions.clear();
    try {
      Carved carved = carve(p_.frame, background_.mesh, s_.phi, carving_);
      strong_ = carved.crack_of;
      result.scene = with_cracks(scenes_of(p_, r_).front(), strong_);
      result.shape = std::move(carved.shape);
      result.notes.push_back(
          "objective and volume are those with the weak phase; the state is that of the design without it");
    } catch (const Error& error) {
      if (error.fault != Fault::Geometry) throw;
      result.finer.failure = fmt::format("the strong phase alone is no body: {}", error.what());
      result.notes.push_back(result.finer.failure);
    }
  }
  finish(result, stopped, go_on);
  return result;
}

/// The least of (T - price)/price over the triangles in which a hole may be, away from singular points.
HoleMargin LevelSetRun::hole_margin(const Evaluated& e, double price) const {
  constexpr double clear = 2;  // of singular points, in mesh sizes
  const Model& m = e.cases.front().model;
  const std::vector<Vec2> singular = singular_points(m);
  const Eigen::VectorXd T = derivative(e);
  const double of_area = price - price_;  // T has what volume costs in J
  HoleMargin holes;
  for (Index t = 0; t < T.size(); ++t) {
    const Vec2 x = centroid(m.mesh, t);
    if (background_.frozen.size() > 0 && value_at(background_, background_.frozen, x) < 0) continue;
    if (std::any_of(singular.begin(), singular.end(), [&](const Vec2& y) { return (x - y).norm() < clear * size_; }))
      continue;
    if (const double margin = (T[t] - of_area) / price; !(margin >= holes.least)) holes = {margin, x};
  }
  return holes;
}

/// What there is to say of the design at the end; `why`: the loop ended.
LoopEnd LevelSetRun::loop_end(const std::string& why, bool go_on, HoleMargin& holes) const {
  LoopEnd end{.row = s_.rows.back(), .asked = largest_residual, .kind = "shape residual", .why = why};
  end.budget_used = !go_on || why.starts_with(out_of_iterations);
  if (!go_on) {
    end.why = end.obstacle = "stopped as asked";
    return end;
  }
  if (r_.level_set.ersatz > 0) {
    end.kind = "angle";
    end.residual = optimality_;
    end.obstacle = "with a weak phase instead of void nothing is proved of the body alone";
    return end;
  }
  const BoundaryRate rate = total_rate(*design_);
  if (rate.curve.edges.empty()) return end;
  const Eigen::VectorXd distance = signed_distance(background_, s_.phi);
  const SpeedLimits limits{.most = size_, .smoothing = size_};
  const Speed speed = boundary_speed({background_, distance, rate, free_label()}, limits, nullptr,
                                     penalized_ ? std::optional(r_.volume_penalty + price_) : std::nullopt);
  end.residual = speed.optimality;
  const double price = speed.multiplier;
  if (!(price > 0)) return end;
  holes = hole_margin(*design_, price);
  const std::string place = fmt::format("({:.4g}, {:.4g})", holes.at.x(), holes.at.y());
  if (holes.least < 0)
    end.obstacle = fmt::format("a small hole at {} pays: T is {:.2g} of the price there", place, 1 + holes.least);
  else
    end.evidence = fmt::format("no small hole pays: T is at least {:.2g} of the price, at {}", 1 + holes.least, place);
  if (!penalized_ && design_->area < (1 - feasible_violation) * target_)
    end.obstacle = join({end.obstacle, fmt::format("volume fraction {:.4g} of {:.4g} allowed, though more would pay",
                                                   design_->area / whole_, target_ / whole_)});
  return end;
}

FinerDesign LevelSetRun::finer(const Evaluated& e) const {
  Problem judged = p_;
  judged.scene.laws = e.cases.front().model.scene.laws;
  judged.objective = e.objective;
  OptimizeRequest asked = r_;
  for (std::size_t k = 0; k < asked.bounds.size(); ++k) asked.bounds[k].functional = e.bounded[k];
  return solve_finer(std::move(judged), asked, e.shape, whole_);
}

/// Where the best design keeps its bounds on this mesh, but not on a finer one, the loop goes on under bounds that are
/// tighter by as much as the meshes differ.
bool LevelSetRun::tighten() {
  constexpr int most = 3;
  const Design& found = kept_ ? kept_ : best_;
  if (r_.bounds.empty() || r_.level_set.ersatz > 0 || s_.tightened == most || !found || !keeps_bounds(*found))
    return false;
  const FinerDesign there = finer(*found);
  s_.solves += static_cast<int>(found->cases.size());
  if (!there.failure.empty() || there.violation < feasible_violation) return false;
  ++s_.tightened;
  for (Eigen::Index k = 0; k < s_.tight.size(); ++k) {
    const auto i = static_cast<std::size_t>(k);
    const double at_most = r_.bounds[i].at_most,
                 excess = (there.bounds[i] - at_most) / std::max(std::abs(at_most), 1e-300);
    if (excess > 0) s_.tight[k] -= (at_most > 0 ? 1 : -1) * (excess + 0.5 * feasible_violation);
  }
  s_.rows.back().note = join({s_.rows.back().note, fmt::format("bounds tightened: on a mesh of half the size they are "
                                                               "violated by {:.2g}",
                                                               there.violation)});
  s_.best.resize(0);
  s_.kept.resize(0);
  best_ = kept_ = nullptr;
  s_.kept_J = infinity;
  s_.since = 0;
  s_.track.clear();
  s_.step = std::max(s_.step, 0.3 * largest_step * size_);
  return true;
}

/// Of the strong phase alone.
FinerDesign LevelSetRun::finer_strong(const OptimizeResult& result) const {
  Problem judged = p_;
  judged.scene.laws = result.scene.laws;
  judged.objective = on_parts(p_.objective, strong_);
  OptimizeRequest asked = r_;
  for (FunctionalBound& bound : asked.bounds) bound.functional = on_parts(bound.functional, strong_);
  return solve_finer(std::move(judged), asked, result.shape, whole_);
}

void LevelSetRun::finish(OptimizeResult& result, const std::string& why, bool go_on) const {
  const LoopEnd end = loop_end(why, go_on, result.holes);
  const bool weak = r_.level_set.ersatz > 0;
  if (weak && !result.finer.failure.empty()) go_on = false;
  if (go_on) {
    result.finer = weak ? finer_strong(result) : finer(*design_);
    result.state_solves += static_cast<int>(design_->cases.size());
  }
  judge(result, r_, end);
}

void LevelSetRun::save() const {
  if (place_.path.empty()) return;
  Checkpoint c = packed(s_, fitted_.sizing.size);
  c.fingerprint = place_.fingerprint;
  write_checkpoint(place_.path, c);
}

bool LevelSetRun::restore() {
  if (!place_.resume || place_.path.empty()) return false;
  const std::optional<Checkpoint> c = read_checkpoint(place_.path);
  if (!c) return false;
  if (c->fingerprint != place_.fingerprint)
    throw Error(Fault::Usage, fmt::format("{} belongs to another case: run without --resume, or restore the case file",
                                          place_.path.string()));
  s_ = unpacked(*c, fitted_.sizing.size);
  carving_.spacing = fitted_.sizing.size;
  if (!s_.rows.empty()) optimality_ = s_.rows.back().optimality;
  if (s_.ended.starts_with(out_of_iterations) && s_.iteration < r_.max_iterations) {
    s_.ended.clear();
    if (s_.rows.back().number > s_.iteration) s_.rows.pop_back();
  }
  design_ = evaluate(s_.phi);
  if (s_.best.size() > 0) best_ = s_.best == s_.phi ? design_ : evaluate(s_.best);
  if (s_.kept.size() > 0) kept_ = s_.kept == s_.phi ? design_ : evaluate(s_.kept);
  return true;
}

}  // namespace

OptimizeResult optimize_level_set(const Problem& p, const OptimizeRequest& r, const Observer& see,
                                  const CheckpointPlace& place) {
  refuse_wrong(p, r);
  return LevelSetRun(p, r, see, place).run();
}

}  // namespace kerf
