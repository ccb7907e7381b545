// One judge for designs of all programs: the compliance of a shape with the asked area on a body-fitted mesh of its
// own. A density or level function on a grid becomes a shape by its level: phi = value - level on a fine mesh of the
// frame, with material along loads and in frozen parts whatever the field says (the smaller of two level functions),
// the level by 50 bisections so that the area below it is the wanted one. Carving drops loose pieces; the area aimed at
// is raised by what is then lacking, up to eight times, to 1e-5. The compliance is judged on triangles refined for each
// load case until the stress errs by 0.5 %, so that the energy errs by about its square, with bounds from those of the
// potential energy Pi (docs/theory/bounds.md): the compliance is -2 Pi, and lies in [-2 upper, -2 lower].

#include "bench/optimize/judge.hpp"

#include "geometry/carve.hpp"
#include "geometry/plane.hpp"
#include "kerf/adaptive.hpp"
#include "kerf/bounds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace kerf {

namespace {

struct Frame {
  Vec2 low, high;
};

Frame frame_of(const OptimizeProblem& p) {
  const auto& sides = p.problem.frame.outline.sides;
  Frame f{sides.front().start, sides.front().start};
  for (const Side& s : sides) {
    f.low = f.low.cwiseMin(s.start);
    f.high = f.high.cwiseMax(s.start);
  }
  return f;
}

double interpolate(const GridField& field, const Frame& frame, const Vec2& x) {
  const Vec2 cells(field.columns - 1, field.rows - 1);
  const Vec2 at = (x - frame.low).cwiseQuotient(frame.high - frame.low).cwiseProduct(cells);
  const Index i = std::clamp(static_cast<Index>(at.x()), 0, field.columns - 2);
  const Index j = std::clamp(static_cast<Index>(at.y()), 0, field.rows - 2);
  const double s = at.x() - i, t = at.y() - j;
  const auto value = [&](Index c, Index r) { return field.value[static_cast<std::size_t>(r) * field.columns + c]; };
  return (1 - t) * ((1 - s) * value(i, j) + s * value(i + 1, j)) +
         t * ((1 - s) * value(i, j + 1) + s * value(i + 1, j + 1));
}

double mean_edge(const Mesh& mesh) {
  double sum = 0;
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e) sum += length(mesh, e);
  return sum / static_cast<double>(mesh.edges.size());
}

// Of the last mesh: the compliance errs by about its square.
constexpr double stress_error = 5e-3;

using Segments = std::vector<std::array<Vec2, 2>>;

double distance_to_segments(const Segments& segments, const Vec2& x) {
  double nearest = infinity;
  for (const auto& [a, b] : segments) nearest = std::min(nearest, distance(x, a, b));
  return nearest;
}

/// Distance of each vertex to what is solid whatever the field says, negative inside: `thickness` along the loads, and
/// the frozen parts.
Eigen::VectorXd solid_parts(const OptimizeProblem& p, const Mesh& mesh, double thickness) {
  Segments loads;
  std::vector<Segments> frozen;
  const auto side = [](const Loop& loop, std::size_t i) -> std::array<Vec2, 2> {
    return {loop.sides[i].start, loop.sides[(i + 1) % loop.sides.size()].start};
  };
  const Loop& outline = p.problem.frame.outline;
  const std::vector<Index> loaded = loaded_labels(p);
  for (std::size_t i = 0; i < outline.sides.size(); ++i)
    if (std::ranges::find(loaded, outline.sides[i].label) != loaded.end()) loads.push_back(side(outline, i));
  for (const Loop& loop : p.request.level_set.frozen) {
    frozen.emplace_back();
    for (std::size_t i = 0; i < loop.sides.size(); ++i) frozen.back().push_back(side(loop, i));
  }
  Eigen::VectorXd out(static_cast<Eigen::Index>(mesh.points.size()));
  for (Eigen::Index v = 0; v < out.size(); ++v) {
    const Vec2& x = mesh.points[v];
    out[v] = distance_to_segments(loads, x) - thickness;
    for (const Segments& closed : frozen) {
      const double away = distance_to_segments(closed, x);
      // On the frame's own boundary, where these parts end, they are solid.
      out[v] = std::min(out[v], inside(closed, x) || away < 1e-9 ? -std::max(away, thickness) : away);
    }
  }
  return out;
}

}  // namespace

double frame_area(const OptimizeProblem& p) {
  return area(p.problem.frame);
}

double volume_fraction(const OptimizeProblem& p, const Shape& shape) {
  return area(shape) / area(p.problem.frame);
}

Shape shape_of(const OptimizeProblem& p, double volume, const GridField& field, const Mesh& background) {
  const Frame frame = frame_of(p);
  Eigen::VectorXd value(static_cast<Eigen::Index>(background.points.size()));
  for (Eigen::Index v = 0; v < value.size(); ++v) value[v] = interpolate(field, frame, background.points[v]);
  double low = value.minCoeff(), high = value.maxCoeff();
  if (!(high > low)) throw Error(Fault::Geometry, "a field that is constant makes no body");
  const double edge = mean_edge(background), spread = high - low;
  const Eigen::VectorXd solid = solid_parts(p, background, 1.5 * edge) * (spread / edge);
  const auto at = [&](double level) -> Eigen::VectorXd { return (value.array() - level).matrix().cwiseMin(solid); };

  Carving how{.tolerance = 0.1 * edge, .least_area = edge * edge, .keep = loaded_labels(p)};
  for (const Support& s : p.problem.scene.supports) {
    how.keep.push_back(s.label);
    how.holding.push_back(s.label);
  }
  // What is dropped is made up for by a larger area below the level.
  const double wanted = volume * area(p.problem.frame);
  double target = wanted;
  for (int round = 0;; ++round) {
    double below = low, above = high;
    for (int k = 0; k < 50; ++k) {
      const double level = 0.5 * (below + above);
      (negative_area(background, at(level)) > target ? above : below) = level;
    }
    Carved carved = carve(p.problem.frame, background, at(0.5 * (below + above)), how);
    const double lacking = wanted - area(carved.shape);
    if (std::abs(lacking) < 1e-5 * wanted || round == 8) return carved.shape;
    target += lacking;
  }
}

namespace {

void judge_load(const WeightedScene& load, const Shape& shape, const JudgeMesh& mesh, Judged& out) {
  const Sizing sizing{.size = mesh.size};
  const bool first = out.mesh.triangles.empty();
  if (mesh.triangles == 0) {
    const Model model = prepare(triangulate(shape, sizing), element("bdms"), load.scene, 1);
    out.compliance += load.weight * work_of_loads(model, solve(model));
    if (first) out.mesh = model.mesh;
    return;
  }
  const Adapted best = solve_adaptively(shape, sizing, element("bdms", 2), load.scene,
                                        {.error = stress_error, .max_triangles = mesh.triangles, .threads = 1});
  out.compliance += load.weight * work_of_loads(best.model, best.state);
  // The potential energy is minus half of the compliance.
  const EnergyBounds bounds = energy_bounds(best.model, best.state);
  out.least += load.weight * -2 * bounds.upper;
  out.most += load.weight * -2 * bounds.lower;
  if (first) out.mesh = best.model.mesh;
}

}  // namespace

Judged judge(const OptimizeProblem& p, const Shape& shape, const JudgeMesh& mesh) {
  const double bound = mesh.triangles == 0 ? nan : 0;
  Judged out{.least = bound, .most = bound, .volume = volume_fraction(p, shape)};
  for (const WeightedScene& load : loaded_scenes(p)) judge_load(load, shape, mesh, out);
  return out;
}

}  // namespace kerf
