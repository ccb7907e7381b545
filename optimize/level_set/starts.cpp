// What a level set begins with: the best of coarse densities and of the start that the case gives. Each candidate
// descends a few steps (60 from a full body, in which holes have to appear first) on a mesh 1.5 times as coarse,
// without trials; the one that can be drawn, keeps its bounds and has the least merit is gone on from. A density
// becomes phi = 0.5 - rho on the canvas, shifted to its own area or, where that is about the one wanted, to that.
// Candidates are ranked in parallel, and chosen in their order: the result does not depend on the number of threads.
// docs/theory/density.md, section "Black and white".

#include "optimize/level_set/starts.hpp"

#include "base/parallel.hpp"
#include "optimize/constraints/sides.hpp"
#include "optimize/density/density.hpp"
#include "optimize/density/stress_design.hpp"
#include "optimize/level_set/descent.hpp"
#include "optimize/level_set/start.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace kerf {

namespace {

/// Signed distance to a body inside the frame, negative in it.
/// What lies on its boundary, as vertices on the frame's do, is in it where the triangles beside it are.
Eigen::VectorXd distance_to(const Ground& g, const Shape& given) {
  const Region body(given);
  const BackgroundMesh& b = g.background;
  const double least = 1e-3 * b.size;
  std::vector<double> beside(b.mesh.points.size(), -infinity);  // the largest depth of a triangle's middle
  for (const auto& t : b.mesh.triangles) {
    const auto point = [&](Index v) { return b.mesh.points[std::size_t(v)]; };
    const double depth = body.depth((point(t[0]) + point(t[1]) + point(t[2])) / 3);
    for (const Index v : t) beside[std::size_t(v)] = std::max(beside[std::size_t(v)], depth);
  }
  Eigen::VectorXd phi(b.lumped.size());
  for (Eigen::Index v = 0; v < phi.size(); ++v) {
    const double depth = body.depth(b.mesh.points[std::size_t(v)]);
    const bool in = std::abs(depth) > least ? depth > 0 : beside[std::size_t(v)] > least;
    phi[v] = in ? -std::max(std::abs(depth), least) : std::abs(depth);
  }
  return phi;
}

}  // namespace

// A full body has no zero line: its value is far below 0.
LevelSetStart given_start(const Ground& g) {
  const BackgroundMesh& b = g.background;
  if (g.r.level_set.start_design) return {"the design given", distance_to(g, *g.r.level_set.start_design), 0, false};
  LevelSetStart start{"the full body",
                      Eigen::VectorXd::Constant(static_cast<Eigen::Index>(b.mesh.points.size()), -1e3 * g.size), 0,
                      true};
  if (!g.r.level_set.start) return start;
  start.name = "the holes given";
  Vec2 low = b.mesh.points[0], high = low;
  for (const Vec2& x : b.mesh.points) low = low.cwiseMin(x), high = high.cwiseMax(x);
  cut_discs(b, start_discs(*g.r.level_set.start, low, high), start.phi);
  return start;
}

namespace {

constexpr double coarse = 1.5;  // mesh of the ranking
constexpr int ranking_steps = 6, exploring_steps = 60;

/// A density's own area, or the one wanted.
LevelSetStart of_density(const Ground& g, const DensityDesign& d) {
  LevelSetStart start{d.name, Eigen::VectorXd(g.background.lumped.size()), 0, false};
  for (Eigen::Index v = 0; v < start.phi.size(); ++v)
    start.phi[v] = 0.5 - density_at(d, g.background.mesh.points[static_cast<std::size_t>(v)]);
  start.phi =
      with_area(g.background, constrained(g.background, start.phi),
                g.limited && d.volume_fraction > 0.97 * g.target / g.whole ? g.target : d.volume_fraction * g.whole);
  return start;
}

/// A few steps on a coarse mesh.
struct Ranked {
  bool good = false, feasible = false;
  double merit = infinity;
  int solves = 0;
};
// What cannot be drawn or solved comes last.
Ranked rank(const Ground& g, const LevelSetStart& start) {
  Ranked ranked;
  try {
    Descent d(g,
              {.coarse = coarse,
               .iterations = start.explore ? exploring_steps : ranking_steps,
               .explore = start.explore,
               .trials = 0,
               .try_holes = false},
              start.phi);
    while (d.advance()) {
    }
    ranked = {true, d.keeps_bounds(d.design()), d.merit(), d.progress().solves};
  } catch (const Error& error) {
    if (!of_one_body(error)) throw;
  }
  return ranked;
}

}  // namespace

namespace {

/// What bounds on largest stresses begin with: the design given, or the density that keeps them.
LevelSetStart stressed_start(const Ground& g) {
  const bool given = g.r.level_set.start_design || g.r.level_set.start || no_density_stage(g.p, g.r);
  LevelSetStart start = given ? given_start(g) : of_density(g, density_designs(g.p, g.r).front());
  start.explore = false;
  start.ended = "largest stresses are left to the curves";
  return start;
}

}  // namespace

// Solves of all candidates count as those of the one that is chosen.
LevelSetStart best_start(const Ground& g) {
  if (bounds_largest_stress(g.r) && !g.weak() && !g.turns()) return stressed_start(g);
  const bool design = g.r.level_set.start_design.has_value(), given = g.r.level_set.start || design;
  // A design is begun with, unless others are asked for beside it.
  const auto most = static_cast<std::size_t>(std::max(1, g.r.starts)), densities = design ? most - 1 : most;
  std::vector<LevelSetStart> all;
  if (densities > 0 && !no_density_stage(g.p, g.r) && !g.weak() && !g.turns())
    for (const DensityDesign& d : density_designs(g.p, g.r))
      if (all.size() < densities) all.push_back(of_density(g, d));
  if (all.empty() || given || all.size() < most) all.push_back(given_start(g));
  if (all.size() == 1) return all.front();
  const auto n = static_cast<Index>(all.size());
  std::vector<Ranked> ranked(all.size());
  parallel_tasks(n, g.p.threads,
                 [&](Index i) { ranked[static_cast<std::size_t>(i)] = rank(g, all[static_cast<std::size_t>(i)]); });
  const auto key = [&](std::size_t k) { return std::tuple(!ranked[k].good, !ranked[k].feasible, ranked[k].merit); };
  std::size_t best = 0;
  int solves = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (key(i) < key(best)) best = i;
    solves += ranked[i].solves;
  }
  all[best].solves = solves;
  all[best].name += fmt::format(", the best of {} starts", all.size());
  if (given && best + 1 < all.size()) all[best].name += fmt::format(": better than {}", all.back().name);
  return all[best];
}

}  // namespace kerf
