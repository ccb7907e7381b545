// Curves moved to an optimum of first order: J + p |Omega| over the knots of the chains under bounds, an area and
// clearances. Each step minimizes a quadratic model of the Lagrangian under linear constraints (quadratic.cpp), within
// a radius of normal moves that follows the actual change over the predicted one. The second derivative begins with
// what is known of elastic bodies [theory: K.4] and learns by damped BFGS [Powell 1978]. Violated constraints are asked
// for as far as the radius reaches [theory: K.5]. The area of arcs is known exactly, and what it bends by is taken from
// its room. A run ends where the shape residual [theory: K.3] on a mesh of its own is small, or where J stands still. A
// point is evaluated on the mesh of the point before, moved; where that suffers on one made where the step begins, so
// that both ends of a step share a mesh and its error. Rows of all evaluations are kept, from which an interrupted run
// replays to the bit. At the end the curves are judged on a finer mesh. Where a bound is violated there, it is
// tightened and steps go on, twice at most. docs/theory/curves.md.

#include "optimize/curves.hpp"

#include "base/dense.hpp"
#include "kerf/folded.hpp"
#include "kerf/shape_gradient.hpp"
#include "optimize/constraints.hpp"
#include "optimize/constraints/thickness.hpp"
#include "optimize/curves/boundary.hpp"
#include "optimize/curves/curve_mesh.hpp"
#include "optimize/curves/fit.hpp"
#include "optimize/curves/gain.hpp"
#include "optimize/curves/quadratic.hpp"
#include "optimize/curves/step_limits.hpp"
#include "optimize/curves/stress_rows.hpp"
#include "optimize/loop/evaluate.hpp"
#include "optimize/loop/finish.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <random>
#include <utility>

namespace kerf {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Lengths relative to the mesh size.
constexpr double first_step = 0.5, largest_step = 1.5, least_step = 1e-3;  // of a step
constexpr double shortest_strained = 0.1;  // steps beyond which a mesh that does not follow is no reason for a new one
constexpr double least_radius = 0.4;       // of arcs, so that meshes can tell
constexpr double largest_angle = 0.35;     // a knot may turn by in a step
constexpr double sharpest = 0.9;           // turn of an arc, in half turns
constexpr double area_error = 1e-7;        // of the area wanted
constexpr double mesh_noise = 1e-3;        // of J between meshes of like size
constexpr double too_little = 1e-9;        // of J, predicted: nothing is to be gained
constexpr double no_price = 0.05;          // of J per area: below, that is what residuals are relative to
constexpr double stress_noise = 5e-3;      // of J
constexpr double of_a_box = 0.03;  // of J, price of a violation in a box at least: some forty are at their bound
constexpr double far_above = 0.1, least_pull = 0.05;
constexpr double least_stress_step = 0.03;  // of a step where largest stresses count: finer meshes say how to go on
constexpr const char* own_mesh = "a mesh of its own";
constexpr std::size_t window = 10;  // steps over which less than `slow` of J means that no more is to be had
constexpr double slow = 2e-4;
constexpr double gain_safety = 2.5;                 // of the model's gain: restarts gained up to 1.9 times as much
constexpr double near_best = 2e-4;                  // of J: what the design returned may be above the best one
constexpr double settled = 0.03;                    // residual from which on knots stay where they are
constexpr double overshoot = 0.05, outside = 1e-3;  // of the frame, by a step and at the end
constexpr double of_width = 1 - kept_thickness;     // that may be missing
constexpr double roomy = 1.01;                      // of the widths asked for
constexpr int most_meshes_at_end = 4;
constexpr int most_rooms = 2;         // times that bounds are made to leave more room for what a finer mesh says
constexpr int most_stress_rooms = 8;  // times that largest stresses follow it
constexpr int most_rounds = 12;       // of quadratic programs for a step

/// A mesh and the curves it was made for; built when first needed.
struct Base {
  DesignCurves curves;
  std::unique_ptr<CurveMesh> built = {};
};

/// Values at some curves, and their derivatives by the variables.
struct Point {
  DesignCurves curves;
  std::shared_ptr<Base> base;
  bool fresh = false, rebased = false;
  double J = 0, area = 0;
  VectorXd by_J, by_area;
  VectorXd bound;     // per load case and bound, of largest stresses per box, relative to what it may be
  MatrixXd by_bound;  // a column each
  std::vector<double> bounds;
  Index triangles = 0;
  double residual = nan, price = nan;
  std::shared_ptr<const Evaluated> solved;
};

/// The constraints of a step, linear: A step <= room. Area first where it is bounded, then bounds, then the geometry.
struct Linearized {
  MatrixXd A;
  VectorXd room;
};

/// What violations of a bound are relative to.
double unit_of(double at_most) {
  return at_most != 0 ? std::abs(at_most) : 1;
}

// An arc that turns by nearly half a circle has no place between its knots.
bool is_shape(const DesignCurves& d) {
  return std::all_of(d.chains.begin(), d.chains.end(), [](const ArcChain& c) { return largest_turn(c) < sharpest; }) &&
         !find_problem(shape_of(d));
}

class CurvesRun {
 public:
  CurvesRun(const Problem& p, const OptimizeRequest& r, const Carved& carved, const CurvesRequest& how,
            const CurvesObserver& see, const std::vector<CurvesRow>& known)
      : p_(p), asked_(r), r_(r), carved_(carved), how_(how), see_(see), known_(known), size_(curve_size(p, how)) {
    // asked_ has the bounds that the user set, r_ those in force, which may leave room.
    whole_ = area(p.frame);
    volume_price_ = price_of_volume(p, r) + r.volume_penalty;
    // An area of the whole frame bounds nothing.
    bounded_ = r.volume_at_most && *r.volume_at_most < 1;
    most_ = bounded_ ? *r.volume_at_most * whole_ : infinity;
    radius_ = first_step * size_;
    limit_ = how.evaluations;
    solid_ = solid_loops(p, r);
    for (std::size_t k = 0; k < how.at_most.size(); ++k) asked_.bounds[k].at_most = how.at_most[k];
    for (std::size_t c = 0; c < std::max<std::size_t>(1, r.load_cases.size()); ++c)
      for (std::size_t b = 0; b < r.bounds.size(); ++b) {
        const bool stress = largest_of(r.bounds[b].functional) != nullptr;
        rows_of_.push_back({b, bound_rows_, stress ? Eigen::Index(boxes_.count()) : 1});
        bound_rows_ += rows_of_.back().count;
        stressed_ = stressed_ || stress;
      }
    factor_ = VectorXd::Ones(bound_rows_);
  }

  /// From the curves given, or from a fit of the carved design.
  FinishedCurves run(const DesignCurves* from);

 private:
  std::optional<Point> evaluate(const DesignCurves& d, const std::shared_ptr<Base>& base, std::string& failure);
  /// Whether a row of bounds has a gradient: not that of an idle box.
  bool has_gradient(const VectorXd& values, Eigen::Index k) const {
    return !stressed_ || values[k] != idle_box;
  }
  Eigen::Index told(const VectorXd& values) const {
    Eigen::Index count = 0;
    for (Eigen::Index k = 0; k < values.size(); ++k) count += has_gradient(values, k) ? 1 : 0;
    return count;
  }
  std::optional<Mesh> carried(const std::shared_ptr<Base>& base, const DesignCurves& d) const;
  Mesh mesh_for(Point& x);
  void solve(Point& x);
  void solve_on(Point& x, const Problem& p, const CurveMesh& follows, Mesh mesh);
  void look_closer();
  bool leave_room();
  void settle();
  bool try_again();
  void go_further();
  double gain_left() const;
  double fall_of_ten() const;
  DesignCurves shaken() const;
  void recall(const CurvesRow& row, Point& x) const;
  bool replays(const CurvesRow& row, const DesignCurves& d, bool meshed) const;
  CurvesRow row_of(const Point& x) const;
  Linearized linearized(const Point& x, double reach) const;
  double gain(const Point& x) const;
  MatrixXd guess(const Point& x) const;
  void weigh(Point& x) const;
  double merit(const Point& x) const;
  double predicted(const Point& x, const VectorXd& step) const;
  double violation(const Point& x) const;
  VectorXd gradient(const Point& x) const {
    return x.by_J + r_.volume_penalty * x.by_area;
  }
  void begin_curvature(const Point& x);
  void learn(const Point& from, const Point& to, const VectorXd& step);
  void keep_calmest();
  VectorXd step_within(const Point& x, double radius);
  VectorXd step_to_shape();
  bool is_design(const DesignCurves& d) const;
  bool iterate();
  void descend(int& meshes);
  void end_inside();
  Clearances clearances(double reach) const;
  void come_back(Point& x) const;
  void widen(Point& x) const;
  double narrowness(const DesignCurves& d) const;
  bool remesh(const DesignCurves& d, const std::string& note);
  bool space_anew();
  bool show();
  void end_with(CurvesEnding how, std::string why) {
    out_.ended = how;
    out_.why = std::move(why);
  }
  Eigen::Index first_bound() const {
    return bounded_ ? 1 : 0;
  }
  /// The share of the gradient of J that steps follow: little where stresses are far above their bounds, for which
  /// steps first make up.
  double pull(const Point& x) const {
    if (!stressed_) return 1;
    return std::clamp(1 - x.bound.maxCoeff() / far_above, least_pull, 1.0);
  }
  VectorXd make_room(Linearized& all, const Eigen::LLT<MatrixXd>& H,
                     const std::function<double(const VectorXd& step)>& reach) const;
  VectorXd soften(Linearized& all, const Eigen::LLT<MatrixXd>& H,
                  const std::function<double(const VectorXd& step)>& reach) const;
  void look_at_stresses();
  double follow_finer();
  bool follow_stresses();
  void tighten(const std::vector<double>& limits);

  /// The rows of a bound in a load case, counted as Point::bound counts them; load case by load case.
  struct RowsOfBound {
    std::size_t bound;
    Eigen::Index first, count;
  };

  const Problem& p_;
  OptimizeRequest asked_, r_;  // r_: bounds leave room for what a finer mesh says
  const Carved& carved_;
  const CurvesRequest& how_;
  const CurvesObserver& see_;
  const std::vector<CurvesRow>& known_;
  std::size_t replayed_ = known_.size();
  double size_, whole_ = 0, most_ = infinity, volume_price_ = 0, radius_ = 0;
  bool bounded_ = false, forgotten_ = false;
  bool lenient_ = false;  // steps do not make up for what the geometry violates, and only make it no worse
  bool wide_ = true;      // widths asked for can be had; otherwise the end says what is too narrow
  double outside_ = 0;    // of the frame
  double least_residual_ = infinity;
  const StressBoxes boxes_ = StressBoxes(p_.frame);
  std::vector<RowsOfBound> rows_of_;
  Eigen::Index bound_rows_ = 0;
  VectorXd factor_;  // per row: of largest stresses, what a finer mesh says of them over what that of the steps does
  VectorXd finer_stress_;      // the largest stresses there
  bool stressed_ = false;      // some bound is one on a largest stress
  std::optional<Point> kept_;  // the best of those whose stresses a finer mesh has found kept
  FinerDesign kept_finer_;
  std::optional<Point> lowest_;          // of least merit since the factors were told
  double full_ = nan, kept_full_ = nan;  // shares of the boundary that are fully stressed
  std::vector<double> track_;            // merits since the last new mesh
  std::vector<Loop> solid_;
  int evaluations_ = 0, solves_ = 0, rooms_ = 0;
  int limit_ = 0;              // of evaluations, until the present stage ends
  double finer_gain_ = nan;    // by the derivatives on the finer mesh
  double gained_ = 0;          // by the last restart
  double tail_ = 0;            // fall in ten steps, as it was when the steps ended before they stood still
  int tries_ = 0;              // restarts
  Point x_;                    // the present one
  std::optional<Point> best_;  // of those that keep all bounds
  std::vector<Point> near_;    // those on the present mesh that keep all bounds and come near the best of them
  MatrixXd B_;
  VectorXd multiplier_;               // of area and bounds
  VectorXd dearest_;                  // the largest that each has been
  std::vector<double> share_;         // per chain, of the radius: less where it gets into its own way
  double last_step_ = 0, reach_ = 0;  // of the last step: its length; how much of the radius it uses
  bool stopped_ = false;
  std::shared_ptr<Evaluated> spare_;  // the last one solved; unless it is still shown its memory serves the next one
  FinishedCurves out_;
};

/// The mesh of `base` moved to the curves, or nothing where that strains it too much.
std::optional<Mesh> CurvesRun::carried(const std::shared_ptr<Base>& base, const DesignCurves& d) const {
  if (!base) return std::nullopt;
  if (!base->built) base->built = std::make_unique<CurveMesh>(curve_mesh(base->curves, p_.sizing));
  return moved(*base->built, d);
}

/// A mesh for a point: that of its base, or one made where the step begins; one of its own for short steps and where
/// nothing else is known.
Mesh CurvesRun::mesh_for(Point& x) {
  if (auto there = carried(x.base, x.curves)) return std::move(*there);
  if (x.base) {
    x.base = std::make_shared<Base>(Base{x_.curves});
    x.rebased = !x_.fresh;  // that is a mesh of its own already
    if (auto there = x.rebased ? carried(x.base, x.curves) : std::nullopt) return std::move(*there);
    x.rebased = false;
    if (last_step_ > shortest_strained * size_)
      throw Error(Fault::Geometry, fmt::format("no mesh follows a step of {:.2g}", last_step_));
  }
  x.fresh = true;
  x.base = std::make_shared<Base>(Base{x.curves, std::make_unique<CurveMesh>(curve_mesh(x.curves, p_.sizing))});
  return x.base->built->mesh;
}

void CurvesRun::solve(Point& x) {
  Mesh mesh = mesh_for(x);
  solve_on(x, p_, *x.base->built, std::move(mesh));
}

/// Values and derivatives on a mesh that follows the curves.
void CurvesRun::solve_on(Point& x, const Problem& p, const CurveMesh& follows, Mesh mesh) {
  solves_ += int(std::max<std::size_t>(1, r_.load_cases.size()));
  auto e = std::make_shared<Evaluated>(evaluate_mesh(p, r_, shape_of(x.curves), std::move(mesh), carved_.crack_of,
                                                     model_to_reuse(spare_), follows.extension.sequence));
  x.J = e->J;
  x.bounds = e->bounds;
  x.triangles = Index(e->cases.front().model.mesh.triangles.size());
  x.by_J = VectorXd::Zero(x.curves.variables);
  for (const SolvedCase& c : e->cases) {
    const Analysis a = analyze(e->objective, c.model, c.state);
    x.by_J += c.weight * pull_back(follows, x.curves, shape_gradient(a, e->objective));
  }
  // Each bound holds in every load case by itself; J is the weighted sum over the cases.
  x.bound.resize(bound_rows_);
  x.by_bound.resize(x.curves.variables, bound_rows_);
  for (std::size_t i = 0; i < rows_of_.size(); ++i) {
    const SolvedCase& c = e->cases[i / r_.bounds.size()];
    const auto& [b, first, count] = rows_of_[i];
    const double most = r_.bounds[b].at_most, unit = unit_of(most);
    if (const LargestStress* stress = largest_of(e->bounded[b])) {
      const StressRows rows = stress_rows(*stress, most, boxes_, factor_.segment(first, count), c, follows, x.curves);
      x.bound.segment(first, count) = rows.value;
      x.by_bound.middleCols(first, count) = rows.by;
      const double largest = most * (1 + rows.value.maxCoeff());
      x.bounds[b] = i < r_.bounds.size() ? largest : std::max(x.bounds[b], largest);
      continue;
    }
    const Analysis of_bound = analyze(e->bounded[b], c.model, c.state);
    x.bound[first] = (of_bound.value - most) / unit;
    x.by_bound.col(first) = pull_back(follows, x.curves, shape_gradient(of_bound, e->bounded[b])) / unit;
  }
  spare_ = e;
  x.solved = std::move(e);
}

// `gradients` are the columns by_J, by_bound without those of idle boxes.
void CurvesRun::recall(const CurvesRow& row, Point& x) const {
  // No mesh is built: only where one would be made is noted.
  x.fresh = row.fresh;
  x.rebased = row.rebased;
  if (row.fresh) x.base = std::make_shared<Base>(Base{x.curves});
  if (row.rebased) x.base = std::make_shared<Base>(Base{x_.curves});
  x.J = row.J;
  x.bounds = row.bounds;
  x.triangles = row.triangles;
  x.bound = row.values;
  const Eigen::Index n = x.curves.variables;
  const Eigen::Map<const MatrixXd> all(row.gradients.data(), n, 1 + told(row.values));
  x.by_J = all.col(0);
  x.by_bound = MatrixXd::Zero(n, row.values.size());
  for (Eigen::Index k = 0, column = 1; k < row.values.size(); ++k)
    if (has_gradient(row.values, k)) x.by_bound.col(k) = all.col(column++);
}

/// Whether the row is one of these curves, with all that an evaluation says. `meshed`: there is a mesh to move.
bool CurvesRun::replays(const CurvesRow& row, const DesignCurves& d, bool meshed) const {
  const VectorXd knots = pack(d);
  if (!std::ranges::equal(row.knots, knots)) return false;
  if (!row.failure.empty()) return true;
  if (row.fresh ? row.rebased : !meshed) return false;
  const auto bounds = Eigen::Index(r_.bounds.size());
  return Eigen::Index(row.bounds.size()) == bounds && row.values.size() == bound_rows_ &&
         row.gradients.size() == d.variables * (1 + told(row.values)) && std::isfinite(row.J) &&
         row.values.allFinite() && row.gradients.allFinite() &&
         std::ranges::all_of(row.bounds, [](double b) { return std::isfinite(b); });
}

/// On the mesh of `base` moved there, or on a fresh one where that suffers or there is none.
std::optional<Point> CurvesRun::evaluate(const DesignCurves& d, const std::shared_ptr<Base>& base,
                                         std::string& failure) {
  Point x{.curves = d, .base = base};
  // Evaluation k of a run replays row k of the one before, up to where that went another way: to its end, with fewer
  // iterations than now.
  const auto number = std::size_t(evaluations_++);
  if (number < replayed_ && !replays(known_[number], d, base != nullptr)) {
    out_.notes.push_back(
        fmt::format("from evaluation {} of the curves on the run before went another way, to its end "
                    "or in another version; they are made anew",
                    number + 1));
    replayed_ = number;
  }
  if (number < replayed_) {
    solves_ = known_[number].state_solves;
    failure = known_[number].failure;
    if (failure.empty()) recall(known_[number], x);
  } else {
    try {
      solve(x);
    } catch (const Error& error) {
      if (!of_one_body(error)) throw;
      failure = error.what();
    }
  }
  if (!failure.empty()) {
    CurvesRow row{.state_solves = solves_, .failure = failure, .knots = pack(d)};
    row.note = "not evaluated: " + failure;
    out_.rows.push_back(std::move(row));
    return std::nullopt;
  }
  x.area = area_of(x.curves, &x.by_area);
  weigh(x);
  out_.rows.push_back(row_of(x));
  return x;
}

// With the values and gradients that a replay takes instead of a solve.
CurvesRow CurvesRun::row_of(const Point& x) const {
  CurvesRow row{.J = x.J,
                .area = x.area,
                .area_fraction = x.area / whole_,
                .bounds = x.bounds,
                .violation = violation(x),
                .residual = x.residual,
                .price = x.price,
                .step = last_step_,
                .triangles = x.triangles,
                .holes = int(x.curves.loops.size()) - 1,
                .state_solves = solves_,
                .fresh = x.fresh,
                .rebased = x.rebased,
                .knots = pack(x.curves),
                .values = x.bound};
  MatrixXd all(x.curves.variables, 1 + told(x.bound));
  all.col(0) = x.by_J;
  for (Eigen::Index k = 0, column = 1; k < x.bound.size(); ++k)
    if (has_gradient(x.bound, k)) all.col(column++) = x.by_bound.col(k);
  row.gradients = all.reshaped();
  return row;
}

double CurvesRun::violation(const Point& x) const {
  return violation_of(r_, x.bounds, x.area / whole_);
}

// Members and gaps that are asked for get a hundredth more: they are seen at samples.
Clearances CurvesRun::clearances(double reach) const {
  constexpr double fine = 0.1;  // step of samples
  const double member = how_.min_feature, gap = how_.min_gap > 0 ? how_.min_gap : member;
  const double thin = std::min(member > 0 ? member : infinity, gap > 0 ? gap : infinity);
  return {.members = member > 0 ? roomy * member : size_,
          .gaps = gap > 0 ? roomy * gap : size_,
          .reach = reach,
          .min_radius = std::max(how_.min_radius, least_radius * size_),
          .size = size_,
          .fine = wide_ && thin < infinity ? std::min(0.5 * size_, fine * thin) : 0};
}

// c(x) + c'(x) step <= 0 for area and bounds. Distances that could come within their limits where both sides of them
// move, by `reach` together, are among the geometry.
Linearized CurvesRun::linearized(const Point& x, double reach) const {
  const LinearRows geometry = clearance_rows(x.curves, p_.frame, solid_, clearances(reach));
  const Eigen::Index front = first_bound() + x.bound.size(), n = x.curves.variables;
  Linearized l{MatrixXd(front + Eigen::Index(geometry.row.size()), n),
               VectorXd(front + Eigen::Index(geometry.row.size()))};
  if (bounded_) {
    l.A.row(0) = x.by_area;
    l.room[0] = most_ - x.area;
  }
  for (Eigen::Index k = 0; k < x.bound.size(); ++k) {
    l.A.row(first_bound() + k) = x.by_bound.col(k);
    l.room[first_bound() + k] = -x.bound[k];
  }
  for (std::size_t k = 0; k < geometry.row.size(); ++k) {
    l.A.row(front + Eigen::Index(k)) = geometry.row[k];
    l.room[front + Eigen::Index(k)] = geometry.room[k];
  }
  return l;
}

/// The shape residual and the price of area: the best multipliers of what is active [theory: K.3].
/// min over mu >= 0 of |grad J + sum mu grad c| in M^-1 is the quadratic program with room 0 on the active rows: its
/// step is minus the projected gradient. Active is what lies within small slacks of its limit. Below 5 % of J per area
/// a price is no scale.
void CurvesRun::weigh(Point& x) const {
  const NormalMoves moves = normal_moves(x.curves);
  const Eigen::LLT<MatrixXd> M = cholesky(mass(moves, x.curves));
  const Linearized all = linearized(x, 2 * radius_);
  const Eigen::Index front = first_bound() + x.bound.size();
  std::vector<Eigen::Index> active;
  for (Eigen::Index k = 0; k < all.room.size(); ++k) {
    const double slack = k >= front ? 0.05 * size_ : k < first_bound() ? 2e-3 * most_ : 2e-3;
    if (all.room[k] <= slack) active.push_back(k);
  }
  const QuadraticStep s =
      quadratic_step(M, gradient(x), all.A(active, Eigen::all), VectorXd::Zero(Eigen::Index(active.size())));
  x.price = volume_price_;
  if (bounded_ && !active.empty() && active.front() == 0) x.price += s.multiplier[0];
  // Root mean square over the chains: the norm in M over the root of their length.
  const double of_all = std::abs(x.J) / x.area, unit = x.price > no_price * of_all ? x.price : of_all;
  x.residual = VectorXd(M.matrixL().transpose() * s.step).norm() / std::sqrt(moves.length) / unit;
}

// An exact penalty with 1.5 times the largest multiplier that each constraint has had [theory: L.7].
double CurvesRun::merit(const Point& x) const {
  double value = x.J + r_.volume_penalty * x.area;
  if (bounded_ && dearest_.size() > 0) value += 1.5 * dearest_[0] * std::max(0.0, x.area - most_);
  for (Eigen::Index k = 0; k < x.bound.size() && dearest_.size() > 0; ++k)
    value += 1.5 * dearest_[first_bound() + k] * std::max(0.0, x.bound[k]);
  return value;
}

/// By how much the merit should fall: by the quadratic model of the Lagrangian and the area that is known.
/// Its penalty takes the bounds as linear, as the program of the step does, and the area as it is.
double CurvesRun::predicted(const Point& x, const VectorXd& step) const {
  double fall = -gradient(x).dot(step) - 0.5 * step.dot(B_ * step);
  if (bounded_) {
    // The model has the second derivative of the Lagrangian, so that what the area bends by is taken out of it again.
    const double there = area_of(moved(x.curves, step), nullptr);
    fall += multiplier_[0] * (there - x.area - x.by_area.dot(step));
    fall += 1.5 * dearest_[0] * (std::max(0.0, x.area - most_) - std::max(0.0, there - most_));
  }
  for (Eigen::Index k = 0; k < x.bound.size(); ++k)
    fall += 1.5 * dearest_[first_bound() + k] *
            (std::max(0.0, x.bound[k]) - std::max(0.0, x.bound[k] + x.by_bound.col(k).dot(step)));
  return fall;
}

/// The second derivative of the Lagrangian as far as it is known of elastic bodies [theory: K.4].
MatrixXd CurvesRun::guess(const Point& x) const {
  const NormalMoves moves = normal_moves(x.curves);
  // Without a price, what the derivative itself is worth.
  const Eigen::LLT<MatrixXd> M = cholesky(mass(moves, x.curves));
  const VectorXd g = gradient(x);
  // The root mean square of dJ/dn over the chains.
  const double rate = std::sqrt(g.dot(kerf::solve(M, g)) / moves.length);
  MatrixXd B = std::max(x.price, 0.3 * rate) * curvature_guess(moves, x.curves, size_);
  steady(B, angles_of(x.curves), 1e-9);
  return B;
}

// Multipliers and penalties begin at 0 with it.
void CurvesRun::begin_curvature(const Point& x) {
  B_ = guess(x);
  dearest_ = VectorXd::Zero(first_bound() + x.bound.size());
  multiplier_ = dearest_;
  for (const RowsOfBound& rows : rows_of_)
    if (rows.count > 1) dearest_.segment(first_bound() + rows.first, rows.count).setConstant(of_a_box * std::abs(x.J));
}

/// By what is learned of the second derivative and by what is known of it, the larger one [theory: K.7].
double CurvesRun::gain(const Point& x) const {
  const Linearized all = linearized(x, 2 * largest_step * size_);
  double most = 0;
  for (const MatrixXd& B : {B_, guess(x)}) most = std::max(most, model_gain(cholesky(B), gradient(x), all.A, all.room));
  return most;
}

/// Damped BFGS of the Lagrangian [Powell 1978].
void CurvesRun::learn(const Point& from, const Point& to, const VectorXd& step) {
  // Derivatives of the Lagrangian at both ends with the multipliers of the step; the geometry is taken as linear.
  VectorXd y = gradient(to) - gradient(from);
  if (bounded_) y += multiplier_[0] * (to.by_area - from.by_area);
  for (Eigen::Index k = 0; k < to.bound.size(); ++k)
    y += multiplier_[first_bound() + k] * (to.by_bound.col(k) - from.by_bound.col(k));
  const VectorXd Bs = B_ * step;
  const double sBs = step.dot(Bs), sy = step.dot(y);
  // r = part y + (1 - part) B s has s.r >= 0.2 s.B s, so that B stays definite.
  const double part = sy >= 0.2 * sBs ? 1 : 0.8 * sBs / (sBs - sy);
  const VectorXd r = part * y + (1 - part) * Bs;
  B_ += r * r.transpose() / step.dot(r) - Bs * Bs.transpose() / sBs;
}

/// Boxes that are violated ask for no more than the radius can do for each of them alone, and may stay violated, at a
/// price: what contradicts the others would shorten what they all ask for. How much so per multiplier.
VectorXd CurvesRun::soften(Linearized& all, const Eigen::LLT<MatrixXd>& H,
                           const std::function<double(const VectorXd& step)>& reach) const {
  constexpr double ample = 0.8, price = 20;  // radii; of J
  VectorXd soft = VectorXd::Zero(first_bound() + bound_rows_);
  for (const RowsOfBound& rows : rows_of_) {
    if (rows.count == 1) continue;
    for (Eigen::Index k = first_bound() + rows.first; k < first_bound() + rows.first + rows.count; ++k) {
      if (all.A.row(k).isZero(0)) {  // an idle box: its room is nothing to measure others by
        all.room[k] = 0;
        continue;
      }
      soft[k] = 1 / (price * std::abs(x_.J));
      if (!(all.room[k] < 0)) continue;
      const VectorXd a = all.A.row(k), v = kerf::solve(H, a);
      const double gain = a.dot(v);
      if (gain > 0) all.room[k] *= std::min(1.0, ample / std::max(reach(VectorXd(v * (all.room[k] / gain))), 1e-300));
    }
  }
  return soft;
}

/// What is violated asks for what the radius can do. Per row of bounds what it may stay violated by per multiplier.
VectorXd CurvesRun::make_room(Linearized& all, const Eigen::LLT<MatrixXd>& H,
                              const std::function<double(const VectorXd& step)>& reach) const {
  const Eigen::Index front = dearest_.size();
  const auto reach_of_rows = [&](const VectorXd& rooms) {
    return reach(quadratic_step(H, VectorXd::Zero(all.A.cols()), all.A.bottomRows(rooms.size()), rooms).step);
  };
  if (!stressed_) {
    make_reachable(all.room, front, reach_of_rows);
    return {};
  }
  VectorXd geometry = all.room.tail(all.room.size() - front);
  make_reachable(geometry, 0, reach_of_rows);
  all.room.tail(geometry.size()) = geometry;
  return soften(all, H, reach);
}

/// The step of the quadratic model under the constraints, with no normal move beyond the radius: rows for the moves
/// enter where they are needed.
VectorXd CurvesRun::step_within(const Point& x, double radius) {
  Linearized all = linearized(x, 2 * radius_);
  const NormalMoves moves = normal_moves(x.curves);
  const VectorXd g = pull(x) * gradient(x);
  const Eigen::LLT<MatrixXd> H = cholesky(B_);
  ChainLimits most;
  for (const double part : share_) {
    most.radius.push_back(part * radius);
    // Below a third of the mesh size the radius shortens turns as it does moves.
    most.turn.push_back(largest_angle * std::min(1.0, 3 * part * radius / size_));
  }
  // Rows before `front` are area and bounds, those behind it the geometry.
  const Eigen::Index front = dearest_.size();
  if (lenient_) all.room.tail(all.room.size() - front) = all.room.tail(all.room.size() - front).cwiseMax(0.0).eval();
  const VectorXd soft = make_room(all, H, [&](const VectorXd& step) { return overreach(x.curves, moves, step, most); });
  Linearized l{all.A.topRows(front), all.room.head(front)};
  std::vector<bool> used(std::size_t(all.room.size()), false);
  QuadraticStep s = quadratic_step(H, g, l.A, l.room, soft);
  // The area is corrected three times at most.
  int bends = 0;
  for (int round = 0; round < most_rounds; ++round) {
    LinearRows beyond = too_far(x.curves, moves, s.step, most);
    const VectorXd there = multiply(all.A, s.step);
    // Rows of the geometry enter where the step violates them: few of them matter to it.
    for (Eigen::Index k = front; k < there.size(); ++k)
      if (!used[std::size_t(k)] && there[k] > all.room[k] + 1e-3 * radius) {
        beyond.add(all.A.row(k), all.room[k]);
        used[std::size_t(k)] = true;
      }
    if (!beyond.row.empty()) {
      const Eigen::Index had = l.room.size(), more = Eigen::Index(beyond.row.size());
      l.A.conservativeResize(had + more, Eigen::NoChange);
      l.room.conservativeResize(had + more);
      for (Eigen::Index k = 0; k < more; ++k) {
        l.A.row(had + k) = beyond.row[std::size_t(k)];
        l.room[had + k] = beyond.room[std::size_t(k)];
      }
    } else {
      // The area is curved: that is taken from its room. Curves with loops have no area.
      if (!bounded_ || bends++ == 3) break;
      const DesignCurves next = moved(x.curves, s.step);
      if (!is_shape(next)) break;
      const double area = area_of(next, nullptr), room = most_ - area + x.by_area.dot(s.step);
      if (std::abs(room - l.room[0]) <= area_error * most_) break;
      l.room[0] = room;
    }
    s = quadratic_step(H, g, l.A, l.room, soft);
  }
  multiplier_ = s.multiplier.head(dearest_.size());
  dearest_ = dearest_.cwiseMax(multiplier_);
  if (stressed_) shorten_chains(x.curves, moves, most, s.step);
  const double furthest = furthest_move(moves, s.step, most);
  reach_ = std::min(1.0, furthest);
  return s.step / std::max(1.0, furthest);
}

// The best is the cheapest that keeps all bounds; solutions are not kept with it, for memory.
bool CurvesRun::show() {
  out_.rows.back().accepted = true;
  const auto cost = [&](const Point& x) { return x.J + r_.volume_penalty * x.area; };
  if (violation(x_) < feasible_violation && (!best_ || cost(x_) < cost(*best_))) {
    best_ = x_;
    best_->solved = nullptr;
  }
  if (violation(x_) < feasible_violation) {
    std::erase_if(near_,
                  [&](const Point& x) { return x.base != x_.base || cost(x) > cost(x_) + near_best * std::abs(x_.J); });
    near_.push_back(x_);
    near_.back().solved = nullptr;
  }
  const std::shared_ptr<const Evaluated> solved = std::exchange(x_.solved, nullptr);
  if (!see_ || !solved) return true;
  const SolvedCase& c = solved->cases.front();
  if (see_({out_.rows, solved->shape, c.model, c.state})) return true;
  end_with(CurvesEnding::Stopped, "stopped as asked");
  stopped_ = true;
  return false;
}

/// A shape that lies in the frame, or no further outside than the present one.
bool CurvesRun::is_design(const DesignCurves& d) const {
  return is_shape(d) && overhang(d, p_.frame, solid_, size_) <= std::max(outside_, overshoot * size_);
}

/// A step within the radius that leads to a shape: chains that would have loops or cross by themselves move less.
VectorXd CurvesRun::step_to_shape() {
  constexpr int most = 5;
  outside_ = overhang(x_.curves, p_.frame, solid_, size_);
  VectorXd step = step_within(x_, radius_);
  for (int k = 0; k < most && !is_design(moved(x_.curves, step)); ++k) {
    bool found = false;
    for (std::size_t c = 0; c < share_.size(); ++c) {
      // A chain is to blame that makes no design by its own step alone.
      VectorXd alone = VectorXd::Zero(step.size());
      for (const KnotHold& hold : x_.curves.holds[c]) {
        if (hold.offset != none) alone[hold.offset] = step[hold.offset];
        if (hold.angle != none) alone[hold.angle] = step[hold.angle];
      }
      if (is_design(moved(x_.curves, alone))) continue;
      share_[c] *= 0.3;
      found = true;
    }
    if (!found)
      for (double& part : share_) part *= 0.3;
    step = step_within(x_, radius_);
  }
  for (int k = 0; k < 2 * most && !is_design(moved(x_.curves, step)); ++k, step *= 0.5) reach_ *= 0.5;
  for (double& part : share_) part = std::min(1.0, 2 * part);
  return step;
}

/// A step from x_; false: the end, `out_.why` says which.
bool CurvesRun::iterate() {
  while (true) {
    if (evaluations_ >= limit_) {
      end_with(CurvesEnding::Evaluations, fmt::format("all {} evaluations are used", limit_));
      return false;
    }
    const VectorXd step = step_to_shape();
    // The largest normal move.
    last_step_ = (normal_moves(x_.curves).by * step).cwiseAbs().maxCoeff();
    const double fall = predicted(x_, step);
    if (!(fall > too_little * std::abs(x_.J))) {
      // What was learned may be wrong, on other meshes or far from here: once more without it.
      if (!std::exchange(forgotten_, true)) {
        const VectorXd dearest = dearest_;
        begin_curvature(x_);
        dearest_ = dearest;
        continue;
      }
      // Making up for a clearance may cost J, which no merit gives back: once more without it.
      if (!std::exchange(lenient_, true)) continue;
      end_with(CurvesEnding::NoStep, fmt::format("no step promises more than {:.1g} of J", too_little));
      return false;
    }
    const DesignCurves next = moved(x_.curves, step);
    std::string failure;
    std::optional<Point> y = evaluate(next, x_.base, failure);
    // Meshes of different bases differ by up to 1e-3 of J: a smaller rise is no reason to refuse.
    const double noise = y && y->base != x_.base ? mesh_noise * std::abs(x_.J) : 0;
    const double fell = y ? merit(x_) - merit(*y) : -infinity, ratio = fell / fall;
    if (stressed_ && (!lowest_ || merit(x_) < merit(*lowest_))) lowest_ = x_;
    // The largest stresses of boxes jump from point to point: some rise above the lowest merit is allowed.
    const bool near_lowest = y && stressed_ && merit(*y) < merit(*lowest_) + stress_noise * std::abs(x_.J);
    const bool good = y && (fell > 0.05 * fall - noise || near_lowest);
    if (y && (noise == 0 || last_step_ > 0.15 * size_)) learn(x_, *y, step);
    if (!good) {
      if (y)
        out_.rows.back().note = fmt::format("refused: the merit would rise by {:.2g} of J", -fell / std::abs(x_.J));
      // Meshes may differ by more than the step: what the present design is worth on the new one.
      if (y && y->rebased && evaluations_ < limit_) return remesh(x_.curves, own_mesh);
      // Less than the refused step used, which may have been less than the radius.
      radius_ *= 0.4 * reach_;
      if (radius_ < (stressed_ ? least_stress_step : least_step) * size_) {
        end_with(CurvesEnding::NoStep, fmt::format("no better design within a step of {:.2g}", 2.5 * radius_));
        return false;
      }
      continue;
    }
    // Grows where the step was held by it.
    if (ratio > 0.7 && reach_ > 0.6) radius_ = std::min(2 * radius_, largest_step * size_);
    if (ratio < 0.25 && noise == 0) radius_ = std::max(0.5 * reach_ * radius_, least_step * size_);
    x_ = std::move(*y);
    forgotten_ = lenient_ = false;
    return show() && space_anew();
  }
}

/// What fits and steps along bent curves left outside the frame, by the shortest way back.
void CurvesRun::come_back(Point& x) const {
  constexpr int most = 8;
  constexpr double far = 0.2;  // mesh sizes
  for (int k = 0; k < most; ++k) {
    const double before = overhang(x.curves, p_.frame, solid_, size_);
    if (before <= outside * size_) return;
    const Linearized all = linearized(x, 2 * radius_);
    const NormalMoves moves = normal_moves(x.curves);
    MatrixXd stiff = curvature_guess(moves, x.curves, size_);
    steady(stiff, angles_of(x.curves), 1e-9);
    VectorXd step = quadratic_step(cholesky(stiff), VectorXd::Zero(stiff.rows()), all.A, all.room).step;
    const std::size_t chains = x.curves.chains.size();
    step /= std::max(1.0, overreach(x.curves, moves, step,
                                    {.radius = std::vector<double>(chains, far * size_),
                                     .turn = std::vector<double>(chains, largest_angle)}));
    if (!step.allFinite()) return;
    const DesignCurves next = moved(x.curves, step);
    if (!is_shape(next) || !(overhang(next, p_.frame, solid_, size_) < before)) return;
    x.curves = next;
    x.area = area_of(next, &x.by_area);
    x.fresh = false;
  }
}

/// By how much members and gaps are narrower than asked for, the worst as a share of it.
double CurvesRun::narrowness(const DesignCurves& d) const {
  const std::vector<DrawnSide> sides = sides_of(shape_of(d));
  std::vector<bool> moves;
  for (const DrawnSide& side : sides) moves.push_back(side.label == d.label);
  double worst = 0;
  for (const bool gaps : {false, true})
    if (const double asked = gaps ? how_.min_gap : how_.min_feature; asked > 0)
      worst = std::max(worst, 1 - thinnest(sides, moves, gaps, asked).width / asked);
  return worst;
}

/// Members and gaps as wide as asked for, by short steps with the area in mind, before anything is solved. Where there
/// is no way the curves stay as they are: the end says what is too narrow.
void CurvesRun::widen(Point& x) const {
  if (how_.min_feature == 0 && how_.min_gap == 0) return;
  constexpr double far = 0.3, enough = 5e-3;  // mesh sizes; of what is asked
  constexpr int patience = 4;                 // steps without gain
  const int most = 12 + int(2 * std::max(how_.min_feature, how_.min_gap) / (far * size_));
  Point best = x;
  double least = narrowness(x.curves);
  Point y = x;
  for (int k = 0, idle = 0; k < most && idle < patience && least > enough; ++k) {
    Clearances how = clearances(far * size_);
    how.widen_members = how_.min_feature > 0;
    how.widen_gaps = how_.min_gap > 0;
    LinearRows rows = clearance_rows(y.curves, p_.frame, solid_, how);
    if (bounded_) rows.add(y.by_area, most_ - y.area);
    MatrixXd A(Eigen::Index(rows.row.size()), y.curves.variables);
    VectorXd room(A.rows());
    for (Eigen::Index i = 0; i < A.rows(); ++i) {
      A.row(i) = rows.row[std::size_t(i)];
      room[i] = rows.room[std::size_t(i)];
      // No more than a step can do of what is missing in width.
      if (i + 1 < A.rows() || !bounded_) room[i] = std::max(room[i], -far * size_);
    }
    const NormalMoves moves = normal_moves(y.curves);
    MatrixXd stiff = curvature_guess(moves, y.curves, size_);
    steady(stiff, angles_of(y.curves), 1e-9);
    VectorXd step = quadratic_step(cholesky(stiff), VectorXd::Zero(stiff.rows()), A, room).step;
    const std::size_t chains = y.curves.chains.size();
    step /= std::max(1.0, overreach(y.curves, moves, step,
                                    {.radius = std::vector<double>(chains, far * size_),
                                     .turn = std::vector<double>(chains, largest_angle)}));
    if (!step.allFinite()) break;
    for (int half = 0; half < 4 && !is_design(moved(y.curves, step)); ++half) step *= 0.5;
    const DesignCurves next = moved(y.curves, step);
    if (!is_design(next)) break;
    y.curves = next;
    y.area = area_of(next, &y.by_area);
    y.fresh = false;
    const double narrow = narrowness(next);
    ++idle;
    if (narrow < least && y.area <= most_ * (1 + 10 * area_error)) least = narrow, best = y, idle = 0;
  }
  if (least <= of_width) x = best;
}

/// Curves on a mesh of their own; false: the end.
bool CurvesRun::remesh(const DesignCurves& d, const std::string& note) {
  std::string failure;
  last_step_ = 0;
  std::optional<Point> y = evaluate(d, nullptr, failure);
  if (!y) throw Error(Fault::Geometry, failure);
  out_.rows.back().note = note;
  x_ = std::move(*y);
  track_.clear();
  if (stressed_) {
    look_at_stresses();
    follow_finer();
  }
  return show();
}

/// Knots that have come too close together or too far apart get even distances, which no mesh can follow.
/// Near the end knots stay: others draw slightly other curves, on a new mesh.
bool CurvesRun::space_anew() {
  least_residual_ = std::min(least_residual_, x_.residual);
  if (least_residual_ < settled) return true;
  DesignCurves even = x_.curves;
  even_out(even);
  if (pack(even) == pack(x_.curves) || evaluations_ + 1 >= limit_) return true;
  if (!offset_to_area(even, x_.area) || !is_design(even)) return true;
  return remesh(even, "knots spaced anew");
}

/// Steps to the end, `out_.why` says which.
void CurvesRun::descend(int& meshes) {
  for (bool go_on = true; go_on;) {
    track_.push_back(merit(x_));
    const bool no_gain = track_.size() > window && *(track_.end() - 1 - window) - track_.back() < slow * std::abs(x_.J);
    // A mesh of its own says what is true of the design, and more than the one that followed it.
    const double enough = x_.fresh || no_gain ? how_.residual : 0.5 * how_.residual;
    if (x_.residual <= enough && violation(x_) < feasible_violation) {
      if (x_.fresh) {
        end_with(CurvesEnding::AtResidual, fmt::format("the shape residual is {:.2g}", x_.residual));
        return;
      }
      if (meshes++ == most_meshes_at_end)
        return end_with(CurvesEnding::StandsStill, "meshes of their own do not agree that the shape residual is small");
      go_on = remesh(x_.curves, own_mesh);
      continue;
    }
    if (no_gain) {
      end_with(CurvesEnding::StandsStill, fmt::format("J fell by less than {:.1g} of it in {} steps", slow, window));
      return;
    }
    go_on = iterate();
  }
}

/// Of the designs on this mesh that come near the best of them the one of least residual.
void CurvesRun::keep_calmest() {
  if (out_.ended == CurvesEnding::AtResidual || stressed_) return;
  const double most = merit(x_) + near_best * std::abs(x_.J);
  const Point* least = &x_;
  for (const Point& x : near_)
    if (x.base == x_.base && merit(x) <= most && x.residual < least->residual) least = &x;
  if (least != &x_) x_ = Point(*least);
}

/// The design with which the steps end, on a mesh of its own: the best that keeps the bounds, within the frame.
void CurvesRun::end_inside() {
  if (best_ && violation(x_) >= feasible_violation) {
    x_ = *best_;
    x_.fresh = false;
  } else {
    keep_calmest();
  }
  come_back(x_);
  if (wide_) widen(x_);
  if (!x_.fresh) remesh(x_.curves, own_mesh);
}

/// The residual where the mesh of the steps has no say: steps come to like what it gets wrong.
void CurvesRun::look_closer() try {
  out_.finer.reset();
  finer_gain_ = nan;
  const Problem finer = finer_problem(p_);
  const CurveMesh follows = curve_mesh(x_.curves, finer.sizing);
  Point y{.curves = x_.curves};
  const int before = solves_;  // it is the judge's solve
  spare_ = nullptr;
  solve_on(y, finer, follows, follows.mesh);
  spare_ = nullptr;
  y.area = area_of(y.curves, &y.by_area);
  solves_ = before;
  weigh(y);
  y.bound = x_.bound;  // room that another mesh sees in bounds is no gain
  finer_gain_ = gain(y);
  if (is_judged_on_curves(finer, y.solved->shape)) out_.finer = solve_finer(p_, asked_, *y.solved, whole_);
  if (!out_.finer || !out_.finer->failure.empty()) out_.finer = finer_design(finer, asked_, *y.solved, whole_);
  out_.finer->residual = y.residual;
} catch (const Error& error) {
  if (!of_one_body(error)) throw;  // whoever judges will find out why
}

/// The design on a finer mesh, and what that says of the largest stresses.
void CurvesRun::look_at_stresses() try {
  out_.finer.reset();
  Problem finer = finer_problem(p_);
  const Shape shape = shape_of(x_.curves);
  finer.sizing.curved = is_judged_on_curves(finer, shape);
  const auto solved = [&] { return evaluate_design(finer, asked_, shape, carved_.crack_of); };
  std::optional<Evaluated> e;
  try {
    e.emplace(solved());
  } catch (const FoldedTriangle&) {
    finer.sizing.curved = false;
    e.emplace(solved());
  }
  out_.finer = finer_design(finer, asked_, *e, whole_);
  finer_stress_ = VectorXd::Zero(bound_rows_);
  for (std::size_t i = 0; i < rows_of_.size(); ++i)
    if (const auto& [b, first, count] = rows_of_[i]; const LargestStress* stress = largest_of(e->bounded[b])) {
      finer_stress_.segment(first, count) = boxes_.largest(*stress, e->cases[i / r_.bounds.size()]);
      full_ = fully_stressed(*stress, asked_.bounds[b].at_most, e->cases);
    }
} catch (const Error& error) {
  if (!of_one_body(error)) throw;
}

/// The factors of largest stresses follow what the finer mesh has found; designs that keep their bounds there are
/// kept. The least share of a bound that is left.
double CurvesRun::follow_finer() {
  double least = infinity;
  if (!out_.finer) return least;
  const bool kept = out_.finer->violation < feasible_violation;
  if (kept && (!kept_ || x_.J < kept_->J)) kept_ = x_, kept_finer_ = *out_.finer, kept_full_ = full_;
  for (std::size_t i = 0; i < rows_of_.size(); ++i) {
    const auto& [b, first, count] = rows_of_[i];
    if (count == 1) continue;
    const double most = r_.bounds[b].at_most;
    // Rows know the stresses of this mesh by their values; those of idle boxes stay without a factor.
    for (Eigen::Index k = first; k < first + count; ++k) {
      least = std::min(least, 1 - finer_stress_[k] / most);
      if (x_.bound[k] == idle_box) continue;
      const double now = stress_factor(finer_stress_[k], most * (1 + x_.bound[k]) / factor_[k]);
      x_.by_bound.col(k) *= now / factor_[k];
      x_.bound[k] = (1 + x_.bound[k]) * now / factor_[k] - 1;
      factor_[k] = now;
    }
    x_.bounds[b] = most * (1 + x_.bound.segment(first, count).maxCoeff());
  }
  lowest_.reset();
  return least;
}

/// Whether there is a reason to go on.
bool CurvesRun::follow_stresses() {
  constexpr double unused = 0.004;  // of a bound
  const double least = follow_finer();
  if (!out_.finer) return false;
  const bool kept = out_.finer->violation < feasible_violation;
  std::vector<double> now;
  for (const FunctionalBound& bound : r_.bounds) now.push_back(bound.at_most);
  if (const std::vector<double> tight = with_more_room(*out_.finer, asked_, now, x_.bounds); !tight.empty())
    tighten(tight);
  if (rooms_ == most_stress_rooms || evaluations_ >= how_.evaluations || (kept && least < unused)) return false;
  ++rooms_;
  weigh(x_);
  best_.reset();
  track_.clear();
  radius_ = std::max(radius_, 0.15 * size_);
  return true;
}

/// What ten steps like the last ones would gain; 0 where the steps have come to an end by themselves.
double CurvesRun::fall_of_ten() const {
  if (out_.ended == CurvesEnding::AtResidual || out_.ended == CurvesEnding::StandsStill || track_.size() < 2) return 0;
  const std::size_t steps = std::min(window, track_.size() - 1);
  return double(window) / double(steps) * std::max(0.0, *(track_.end() - 1 - std::ptrdiff_t(steps)) - track_.back());
}

/// Steps to the end within the frame.
void CurvesRun::settle() {
  int meshes = 0;
  while (true) {
    descend(meshes);
    if (stopped_) return;
    tail_ = fall_of_ten();
    const double before = merit(x_);
    end_inside();
    // The way back into the frame may have cost something, or a mesh of its own says that a bound is violated: on.
    const bool good = violation(x_) < feasible_violation && merit(x_) < before + mesh_noise * std::abs(x_.J);
    if (good || evaluations_ >= limit_ || meshes++ == most_meshes_at_end) return;
    best_.reset();
    radius_ = std::max(radius_, 0.1 * size_);
  }
}

/// Other limits of bounds from now on, but of largest stresses.
/// Values and derivatives are rescaled to them without solving anew.
void CurvesRun::tighten(const std::vector<double>& tight) {
  for (const auto& [b, first, count] : rows_of_) {
    if (largest_of(r_.bounds[b].functional)) continue;
    const double now = r_.bounds[b].at_most, most = tight[b], was = unit_of(now), unit = unit_of(most);
    x_.bound[first] = (x_.bound[first] * was + now - most) / unit;
    x_.by_bound.col(first) *= was / unit;
  }
  for (std::size_t b = 0; b < tight.size(); ++b)
    if (!largest_of(r_.bounds[b].functional)) r_.bounds[b].at_most = tight[b];
}

/// Where the finer mesh finds that bounds are violated, by what it proves of them, they allow less from now on. Whether
/// there is a reason to go on.
bool CurvesRun::leave_room() {
  if (!out_.finer || rooms_ == most_rooms || evaluations_ >= limit_) return false;
  std::vector<double> now;
  for (const FunctionalBound& bound : r_.bounds) now.push_back(bound.at_most);
  const std::vector<double> tight = with_more_room(*out_.finer, asked_, now, x_.bounds);
  if (tight.empty()) return false;
  ++rooms_;
  solves_ += int(std::max<std::size_t>(1, r_.load_cases.size()));
  tighten(tight);
  weigh(x_);
  best_.reset();
  track_.clear();
  radius_ = std::max(radius_, 0.1 * size_);
  return true;
}

/// The curves after a step of random numbers, the same in every run, without a change of area.
DesignCurves CurvesRun::shaken() const {
  constexpr double far = 0.2, turn = 0.06;  // mesh sizes; radians
  constexpr int most = 12;
  std::mt19937 random{unsigned(tries_)};  // its bits are fixed by the standard
  const std::vector<bool> turns = angles_of(x_.curves);
  for (double part = 1, k = 0; k < most; ++k, part *= 0.7) {
    VectorXd step(x_.curves.variables);
    for (Eigen::Index i = 0; i < step.size(); ++i)
      step[i] = part * (turns[std::size_t(i)] ? turn : far * size_) * (double(random()) / double(random.max()) * 2 - 1);
    DesignCurves d = moved(x_.curves, step);
    if ((!bounded_ || offset_to_area(d, x_.area)) && is_design(d)) return d;
  }
  return x_.curves;
}

/// What could still be gained, in units of J [theory: K.8].
double CurvesRun::gain_left() const {
  const double model = std::max(finer_gain_, gain(x_));
  return std::max(gain_safety * model, gained_) + std::max(slow * std::abs(x_.J), tail_);
}

/// Steps once more from the end, shaken and without what was learned: where they stand still, meshes and what was
/// learned may have ended them. The finer mesh says which end is better, since two meshes of this size differ by more.
/// Whether that is the new one.
bool CurvesRun::try_again() {
  const auto cost = [&] { return out_.finer->objective + r_.volume_penalty * x_.area; };
  const auto kept = [&] { return out_.finer && out_.finer->violation < feasible_violation; };
  if (!kept()) return false;
  const Point end = x_;
  const FinerDesign finer = *out_.finer;
  const double before = cost(), gain = finer_gain_, tail = tail_;
  const CurvesEnding ended = out_.ended;
  const std::string why = out_.why;
  const VectorXd dearest = dearest_;
  const MatrixXd B = B_;
  ++tries_;
  best_.reset();
  least_residual_ = infinity;
  radius_ = first_step * size_;
  share_.assign(share_.size(), 1.0);
  gained_ = 0;
  try {
    if (!remesh(shaken(), "once more, shaken")) return false;
    begin_curvature(x_);
    dearest_ = dearest;
    settle();
    if (stopped_) return false;
    look_closer();
    if (kept()) gained_ = std::max(0.0, before - cost());
  } catch (const Error& error) {
    if (!of_one_body(error)) throw;
  }
  if (gained_ > 0) return true;
  x_ = end;
  B_ = B;
  out_.finer = finer;
  finer_gain_ = gain;
  tail_ = tail;
  end_with(ended, why);
  return false;
}

/// From the end on until what is left to gain is within the tolerance, a restart gains nothing, or no evaluations are
/// left: where steps stand still by a restart, which is tried once in any case, where they ran out of evaluations by
/// more of them.
void CurvesRun::go_further() {
  constexpr int enough = 15, stage = 30;  // evaluations
  constexpr double share = 0.8;           // of the tolerance: the rest is for holes and bumps
  while (!stopped_ && !stressed_ && std::isfinite(finer_gain_) && out_.ended != CurvesEnding::AtResidual) {
    const double left = gain_left();
    const bool within = left <= share * r_.tolerance * std::abs(x_.J);
    if (within && (tries_ > 0 || out_.ended == CurvesEnding::Evaluations)) return;
    const int most = within ? how_.evaluations : std::max(how_.evaluations, how_.further);
    if (evaluations_ + enough > most) {
      if (!within && out_.ended != CurvesEnding::Evaluations)
        end_with(CurvesEnding::Evaluations, fmt::format("{} of {} evaluations are used", evaluations_, most));
      return;
    }
    limit_ = std::max(limit_, std::min(most, evaluations_ + stage));
    if (out_.ended != CurvesEnding::Evaluations) {
      if (!try_again()) return;
      continue;
    }
    const int before = evaluations_;
    settle();
    if (!stopped_) look_closer();
    if (evaluations_ == before) return;
  }
}

// The fit is brought into the frame before anything is solved, and evaluated on a mesh of its own.
FinishedCurves CurvesRun::run(const DesignCurves* from) {
  std::string failure;
  DesignCurves start = from ? *from : fitted_curves(p_, r_, carved_, how_, out_.notes);
  start.follow_arcs = stressed_;
  Point inside{.curves = start};
  inside.area = area_of(start, &inside.by_area);
  inside.by_bound.resize(start.variables, 0);
  come_back(inside);
  widen(inside);
  wide_ = narrowness(inside.curves) <= of_width;
  std::optional<Point> first = evaluate(inside.curves, nullptr, failure);
  if (!first) throw Error(Fault::Geometry, failure);
  x_ = std::move(*first);
  out_.residual_before = x_.residual;
  if (stressed_) {
    look_at_stresses();
    follow_stresses();
    rooms_ = 0;
  }
  begin_curvature(x_);
  share_.assign(x_.curves.chains.size(), 1.0);
  if (show()) settle();
  while (!stopped_) {
    stressed_ ? look_at_stresses() : look_closer();
    if (!(stressed_ ? follow_stresses() : leave_room())) break;
    settle();
  }
  go_further();
  if (kept_ && !(out_.finer && out_.finer->violation < feasible_violation && x_.J <= kept_->J))
    x_ = std::move(*kept_), out_.finer = kept_finer_, full_ = kept_full_;
  if (stressed_ && std::isfinite(full_))
    out_.notes.push_back(fmt::format(
        "on {:.2g} of the free boundary the stress is within 10 % of its bound, as a finer mesh has it", full_));
  if (!stressed_ && std::isfinite(finer_gain_)) out_.gain = gain_left();
  out_.shape = shape_of(x_.curves);
  out_.curves = std::make_shared<const DesignCurves>(x_.curves);
  out_.crack_of = carved_.crack_of;
  out_.J = x_.J;
  out_.area = x_.area;
  out_.bounds = x_.bounds;
  out_.residual = x_.residual;
  out_.price = x_.price;
  out_.evaluations = evaluations_;
  out_.state_solves = solves_;
  out_.feasible = violation(x_) < feasible_violation;
  return std::move(out_);
}

}  // namespace

Shape fit_curves(const Problem& p, const OptimizeRequest& r, const Carved& carved, const CurvesRequest& how) {
  std::vector<std::string> notes;
  return shape_of(fitted_curves(p, r, carved, how, notes));
}

FinishedCurves finish_curves(const Problem& p, const OptimizeRequest& r, const Carved& carved, const CurvesRequest& how,
                             const CurvesObserver& see, const std::vector<CurvesRow>& known) {
  const auto has_design = [&](const Loop& loop) {
    return std::any_of(loop.sides.begin(), loop.sides.end(),
                       [&](const Side& s) { return s.label == carved.design_label; });
  };
  std::optional<std::string> why = refusal(p.element, can_optimize);
  if (!why && !has_design(carved.shape.outline) &&
      std::none_of(carved.shape.holes.begin(), carved.shape.holes.end(), has_design))
    why = "no boundary of the body is free to move";
  if (why) {
    FinishedCurves out{.shape = carved.shape, .crack_of = carved.crack_of, .area = carved.area};
    out.why = "the design stays as carved: " + *why;
    out.notes.push_back(out.why);
    return out;
  }
  return CurvesRun(p, r, carved, how, see, known).run(nullptr);
}

FinishedCurves continue_curves(const Problem& p, const OptimizeRequest& r, const Carved& carved,
                               const DesignCurves& start, const CurvesRequest& how, const CurvesObserver& see,
                               const std::vector<CurvesRow>& known) {
  return CurvesRun(p, r, carved, how, see, known).run(&start);
}

}  // namespace kerf
