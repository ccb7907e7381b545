#include "optimize/level_set/end.hpp"

#include "optimize/ersatz.hpp"
#include "optimize/loop/history_text.hpp"
#include "solver/stress.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr double largest_residual = 0.1;  // of the shape of what is called optimal [theory: L.10]

/// The least of (T - price)/price over the triangles in which a hole may be, away from singular points.
HoleMargin hole_margin(const Ground& g, const Descent& d, double price) {
  constexpr double clear = 2;  // of singular points, in mesh sizes
  const Model& m = d.design().cases.front().model;
  const std::vector<Vec2> singular = singular_points(m);
  const Eigen::VectorXd T = d.derivative();
  const double of_area = price - (g.price - g.r.volume_penalty);  // T has what volume costs in J
  HoleMargin holes;
  for (Index t = 0; t < T.size(); ++t) {
    const Vec2 x = centroid(m.mesh, t);
    if (g.background.frozen.size() > 0 && value_at(g.background, g.background.frozen, x) < 0) continue;
    if (std::any_of(singular.begin(), singular.end(), [&](const Vec2& y) { return (x - y).norm() < clear * g.size; }))
      continue;
    if (const double margin = (T[t] - of_area) / price; !(margin >= holes.least)) holes = {margin, x};
  }
  return holes;
}

LoopEnd loop_end(const Ground& g, const Descent& d, bool go_on, HoleMargin& holes) {
  const DescentState& s = d.progress();
  LoopEnd end{.row = s.rows.back(), .asked = largest_residual, .kind = "shape residual", .why = s.ended};
  end.budget_used = !go_on || s.ended.starts_with("the iterations asked for");
  if (!go_on) {
    end.why = end.obstacle = "stopped as asked";
    return end;
  }
  if (g.weak()) {
    end.kind = "angle";
    end.residual = s.rows.back().optimality;
    end.obstacle = "with a weak phase instead of void nothing is proved of the body alone";
    return end;
  }
  const BoundaryStep at = d.measure();
  end.residual = at.residual;
  if (!(at.price > 0)) return end;
  holes = hole_margin(g, d, at.price);
  const std::string place = fmt::format("({:.4g}, {:.4g})", holes.at.x(), holes.at.y());
  if (holes.least < 0)
    end.obstacle = fmt::format("a small hole at {} pays: T is {:.2g} of the price there", place, 1 + holes.least);
  else
    end.evidence = fmt::format("no small hole pays: T is at least {:.2g} of the price, at {}", 1 + holes.least, place);
  return end;
}

}  // namespace

OptimizeResult result_of(const Ground& g, const Descent& d, bool go_on) {
  const DescentState& s = d.progress();
  const Evaluated& e = d.design();
  OptimizeResult result{.method = OptimizeMethod::LevelSet};
  result.iterations = s.iteration;
  result.state_solves = s.solves;
  result.objective = e.J;
  result.volume_fraction = e.area / g.whole;
  result.history = s.rows;
  result.shape = e.shape;
  result.scene = e.cases.front().model.scene;
  const LoopEnd end = loop_end(g, d, go_on, result.holes);
  if (go_on && !g.weak()) {
    Problem judged = g.p;
    judged.scene.laws = e.cases.front().model.scene.laws;
    judged.objective = e.objective;
    OptimizeRequest asked = g.r;
    for (std::size_t k = 0; k < asked.bounds.size(); ++k) asked.bounds[k].functional = e.bounded[k];
    result.finer = solve_finer(std::move(judged), asked, e.shape, g.whole);
    result.state_solves += static_cast<int>(e.cases.size());
  }
  judge(result, g.r, end);
  return result;
}

}  // namespace kerf
