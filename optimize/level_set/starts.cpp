#include "optimize/level_set/starts.hpp"

#include "geometry/plane.hpp"
#include "optimize/density/density.hpp"
#include "optimize/level_set/descent.hpp"
#include "optimize/level_set/start.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace kerf {

LevelSetStart given_start(const Ground& g) {
  const BackgroundMesh& b = g.background;
  LevelSetStart start{"the full body",
                      Eigen::VectorXd::Constant(static_cast<Eigen::Index>(b.mesh.points.size()), -1e3 * g.size), true};
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
  LevelSetStart start{d.name, Eigen::VectorXd(g.background.lumped.size()), false};
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
  std::string failure;
};
Ranked rank(const Ground& g, const LevelSetStart& start) {
  Ranked ranked;
  try {
    Descent d(g,
              {.coarse = coarse,
               .iterations = start.explore ? exploring_steps : ranking_steps,
               .radius = start.explore ? 1 : 0.25,
               .explore = start.explore,
               .trials = 0},
              start.phi);
    while (d.advance()) {
    }
    ranked = {true, d.keeps_bounds(d.design()), d.merit(), d.progress().solves, {}};
  } catch (const Error& error) {
    if (error.fault != Fault::Geometry && error.fault != Fault::Numerics) throw;
    ranked.failure = error.what();
  }
  return ranked;
}

}  // namespace

LevelSetStart best_start(const Ground& g) {
  std::vector<LevelSetStart> all;
  if (!no_density_stage(g.p, g.r) && !g.weak() && !g.turns())
    all.push_back(of_density(g, density_designs(g.p, g.r).front()));
  if (all.empty() || g.r.level_set.start) all.push_back(given_start(g));
  if (all.size() == 1) return all.front();
  std::vector<Ranked> ranked;
  for (const LevelSetStart& start : all) ranked.push_back(rank(g, start));
  std::size_t best = 0;
  for (std::size_t i = 1; i < all.size(); ++i) {
    const auto key = [&](std::size_t k) { return std::tuple(!ranked[k].good, !ranked[k].feasible, ranked[k].merit); };
    if (key(i) < key(best)) best = i;
  }
  return all[best];
}

}  // namespace kerf
