#include "optimize/level_set/end.hpp"

#include "geometry/plane.hpp"
#include "kerf/map.hpp"
#include "optimize/loop/history_text.hpp"
#include "optimize/parametric/minimize.hpp"
#include "solver/stress.hpp"
#include "topo/map_at_centroids.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr double of_curves = 2e-2, of_level_set = 0.1;  // largest shape residual of what is called optimal
constexpr double binding = 1e-2;                        // of a bound, relative: nearer than this it has a price

/// Prices of area and of the bounds that bind: those that balance the rates along the boundary best.
struct Prices {
  double area = 0;
  std::vector<double> bound;  // 0: does not bind
};
Prices prices_of(const Ground& g, const Evaluated& e) {
  Prices prices{g.price, std::vector<double>(e.bounds.size(), 0)};
  const BoundaryRate objective = boundary_rate(e, analyze_objective(e));
  std::vector<std::size_t> binds;
  for (std::size_t k = 0; k < e.bounds.size(); ++k)
    if (e.bounds[k] > g.r.bounds[k].at_most - binding * std::abs(g.r.bounds[k].at_most)) binds.push_back(k);
  const bool full = g.limited && e.area > (1 - binding) * g.target;
  // sum mu_k g_k + lambda = -g along the free boundary, in the mean of squares.
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < objective.density.size(); ++i)
    if (objective.label[static_cast<std::size_t>(i)] >= g.free_label()) rows.push_back(i);
  const auto count = static_cast<Eigen::Index>(binds.size() + (full ? 1 : 0));
  if (rows.empty() || count == 0) return prices;
  const Eigen::VectorXd weight = objective.length(rows).cwiseSqrt();
  Eigen::MatrixXd A(static_cast<Eigen::Index>(rows.size()), count);
  for (std::size_t k = 0; k < binds.size(); ++k)
    A.col(static_cast<Eigen::Index>(k)) =
        weight.cwiseProduct(boundary_rate(e, analyze_bound(e, binds[k])).density(rows));
  if (full) A.col(count - 1) = weight;
  const double volume = g.r.volume_penalty;  // J has the rest
  const Eigen::VectorXd right = -weight.cwiseProduct((objective.density(rows).array() + volume).matrix());
  Eigen::VectorXd unit = A.colwise().norm().transpose().cwiseMax(1e-300);
  const Eigen::VectorXd x = nonnegative_least_squares(A * unit.cwiseInverse().asDiagonal(), right).cwiseQuotient(unit);
  for (std::size_t k = 0; k < binds.size(); ++k) prices.bound[binds[k]] = x[static_cast<Eigen::Index>(k)];
  if (full) prices.area += x[count - 1];
  return prices;
}

/// Distance of points to the boundary of a mesh, no more than `most`.
std::vector<double> to_boundary(const Mesh& mesh, double most) {
  std::vector<double> distance(mesh.triangles.size(), most);
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    if (mesh.sides[e][0] != none && mesh.sides[e][1] != none) continue;
    const Vec2 &a = mesh.points[std::size_t(mesh.edges[e][0])], &b = mesh.points[std::size_t(mesh.edges[e][1])];
    for (std::size_t t = 0; t < distance.size(); ++t)
      distance[t] = std::min(distance[t], kerf::distance(centroid(mesh, static_cast<Index>(t)), a, b));
  }
  return distance;
}

/// The least of (T - price)/price over the triangles in which a hole may be: away from singular points, and from the
/// boundary, where moving it does the same and the shape residual says what that brings.
HoleMargin hole_margin(const Ground& g, const Evaluated& e, const Prices& prices) {
  constexpr double clear = 2, beside = 1;  // of singular points, of the boundary, in mesh sizes
  const Model& m = e.cases.front().model;
  const std::vector<Vec2> singular = singular_points(m);
  Eigen::VectorXd T = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(m.mesh.triangles.size()));
  const auto hole = [](Index) -> const Perturbation& {
    static const Perturbation a_hole;
    return a_hole;
  };
  const auto add = [&](const std::vector<WeightedAnalysis>& all, double factor) {
    for (const WeightedAnalysis& w : all) T += factor * w.weight * map_at_centroids(w.analysis, *w.functional, hole);
  };
  add(analyze_objective(e), 1);
  for (std::size_t k = 0; k < prices.bound.size(); ++k)
    if (prices.bound[k] > 0) add(analyze_bound(e, k), prices.bound[k]);
  const double of_area = prices.area - (g.price - g.r.volume_penalty);  // T has what volume costs in J
  const std::vector<double> room = to_boundary(m.mesh, beside * g.size);
  HoleMargin holes{.mesh = std::make_shared<const Mesh>(m.mesh),
                   .margin = std::vector<double>(m.mesh.triangles.size(), nan)};
  for (Index t = 0; t < T.size(); ++t) {
    const Vec2 x = centroid(m.mesh, t);
    if (room[static_cast<std::size_t>(t)] < beside * g.size) continue;
    if (g.background.frozen.size() > 0 && value_at(g.background, g.background.frozen, x) < 0) continue;
    if (std::any_of(singular.begin(), singular.end(), [&](const Vec2& y) { return (x - y).norm() < clear * g.size; }))
      continue;
    const double margin = (T[t] - of_area) / prices.area;
    holes.margin[static_cast<std::size_t>(t)] = margin;
    if (!(margin >= holes.least)) holes.least = margin, holes.at = x;
  }
  return holes;
}

/// Holes really made where they would pay most, or cost least: whether T says what they bring.
Verdict proved(const Ground& g, const Evaluated& e, const Vec2& at) {
  constexpr double wide = 3, largest = 0.4;  // radius, of the mesh size: the boundary is a mesh size away
  Sizing sizing = g.p.sizing;
  sizing.size = wide * g.mesh_size;  // the formula is tried, not the design: it holds on any mesh
  sizing.across = 1;
  ValidationRequest request{.points = {at}, .radii = {}, .perturbation = {}, .threads = g.p.threads};
  for (int k = 0; k < 5; ++k) request.radii.push_back(largest * g.size * std::pow(2.0, -k));
  for (const SolvedCase& c : e.cases) {
    const Verdict verdict =
        validate({e.shape, sizing}, g.p.element, c.model.scene, e.objective, request).front().verdict;
    if (verdict != Verdict::Holds && verdict != Verdict::Vanishes) return verdict;
  }
  return Verdict::Holds;
}

/// What speaks for and against "optimal" besides the shape residual.
void weigh_holes(const Ground& g, const Evaluated& e, HoleMargin& holes, LoopEnd& end) {
  const Prices prices = prices_of(g, e);
  if (!(prices.area > 0)) return;
  holes = hole_margin(g, e, prices);
  if (!std::isfinite(holes.least)) return;
  const std::string place = fmt::format("({:.4g}, {:.4g})", holes.at.x(), holes.at.y());
  std::string agree;
  // Where the shape says that it is no optimum the price of a proof is saved.
  if (end.residual <= end.asked && can_validate(g.p.element)) try {
      holes.proof = proved(g, e, holes.at);
      if (*holes.proof == Verdict::Holds) agree = "; holes made there agree";
    } catch (const Error&) {  // a functional or a place that holes cannot be tried on: no proof
    }
  if (holes.least < 0)
    end.obstacle =
        fmt::format("a small hole at {} pays: T is {:.2g} of the price there{}", place, 1 + holes.least, agree);
  else
    end.evidence =
        fmt::format("no small hole pays: T is at least {:.2g} of the price, at {}{}", 1 + holes.least, place, agree);
}

LoopEnd loop_end(const LevelSetEnd& end, const Evaluated& design, bool go_on, OptimizeResult& result) {
  const DescentState& s = end.descent.progress();
  LoopEnd out{.row = last_taken(result.history), .kind = "shape residual"};
  out.asked = end.last ? of_curves : of_level_set;
  if (go_on && (end.last || !end.g.turns()))
    out.residual = end.last ? end.curves.residual : end.descent.measure().residual;
  out.why = join({s.ended, end.curves.why.empty() ? "" : "curves: " + end.curves.why});
  out.budget_used = !go_on || out_of_iterations(s);
  if (!go_on) {
    out.why = out.obstacle = "stopped as asked";
  } else if (end.g.weak()) {
    out.kind = "angle";
    out.residual = s.residual;
    out.obstacle = "with a weak phase instead of void nothing is proved of the body alone";
  } else {
    weigh_holes(end.g, design, result.holes, out);
  }
  return out;
}

/// What the phases stand for, as a body.
void take_strong_phase(const LevelSetEnd& end, bool go_on, OptimizeResult& result) {
  const Ground& g = end.g;
  result.scene.regions.clear();
  try {
    Carved carved = carved_again(g, end.descent.progress().phi);
    Problem judged = g.p;
    result.scene = with_cracks(scenes_of(g.p, g.r).front(), carved.crack_of);
    judged.scene.laws = result.scene.laws;
    judged.objective = on_parts(g.p.objective, carved.crack_of);
    OptimizeRequest asked = g.r;
    for (FunctionalBound& bound : asked.bounds) bound.functional = on_parts(bound.functional, carved.crack_of);
    result.shape = std::move(carved.shape);
    result.notes.push_back(
        "objective and volume are those with the weak phase; the state is that of the design without it");
    if (!go_on) return;
    result.finer = solve_finer(std::move(judged), asked, result.shape, g.whole);
    ++result.state_solves;
  } catch (const Error& error) {
    if (error.fault != Fault::Geometry) throw;
    result.finer.failure = fmt::format("the strong phase alone is no body: {}", error.what());
    result.notes.push_back(result.finer.failure);
  }
}

}  // namespace

bool curves_are_better(const LevelSetEnd& end) {
  const FinishedCurves& c = end.curves;
  if (c.shape.outline.sides.empty() || !std::isfinite(c.J)) return false;
  const Evaluated& e = end.descent.design();
  const OptimizeRequest& r = end.g.r;
  const double before = violation_of(r, e.bounds, e.area / end.g.whole),
               after = violation_of(r, c.bounds, c.area / end.g.whole);
  if (after >= feasible_violation || before >= feasible_violation) return after < before;
  // Curves leave room in bounds for what a finer mesh says, which costs J.
  const double meshes_differ = r.bounds.empty() ? 8e-4 : 2e-2, J = end.last ? end.last->J : c.J;
  return J + r.volume_penalty * c.area <= (e.J + r.volume_penalty * e.area) + meshes_differ * std::abs(e.J);
}

std::shared_ptr<const Evaluated> solve_again(const LevelSetEnd& end) {
  Problem p = end.g.p;
  p.sizing.size = end.g.mesh_size;
  return std::make_shared<const Evaluated>(evaluate_design(p, end.g.r, end.curves.shape, end.curves.crack_of));
}

OptimizeResult result_of(const LevelSetEnd& end, bool go_on) {
  const DescentState& s = end.descent.progress();
  const Evaluated& design = end.last ? *end.last : end.descent.design();
  OptimizeResult result{.method = OptimizeMethod::LevelSet};
  result.notes = end.g.notes;
  result.notes.insert(result.notes.end(), end.curves.notes.begin(), end.curves.notes.end());
  result.history = s.rows;
  result.history.insert(result.history.end(), end.finishing.begin(), end.finishing.end());
  const Iteration& row = last_taken(result.history);
  result.iterations = result.history.back().number;
  result.state_solves = result.history.back().state_solves;
  result.objective = row.objective;
  result.volume_fraction = row.volume_fraction;
  result.shape = design.shape;
  result.scene = design.cases.front().model.scene;
  const LoopEnd judged = loop_end(end, design, go_on, result);
  if (end.g.weak()) {
    take_strong_phase(end, go_on, result);
  } else if (go_on) {
    result.finer = solve_finer(end.g.p, end.g.r, design, end.g.whole);
    ++result.state_solves;
  }
  judge(result, end.g.r, judged);
  return result;
}

}  // namespace kerf
