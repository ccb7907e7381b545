// Designs ranked by first order: J(design) - J(body) ~ sum_i a_i T(x_i), a_i = pi size_i^2 [theory: L.20]. Places are
// the middles of what is drawn; a crack counts by half its length and its angle, an inclusion by its stiffness. The
// mean over the areas is what counts, so that large things are not better for being large: the sizes are what the
// constraints and the second order leave. docs/theory/level_set.md, section "Drawn designs".

#include "optimize/parametric/promise.hpp"

#include "kerf/analysis.hpp"
#include "kerf/map.hpp"
#include "optimize/loop/evaluate.hpp"
#include "optimize/parametric/followers.hpp"
#include "optimize/parametric/shapes/shape.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace kerf {

namespace {

using Eigen::VectorXd;

/// A drawn thing as the expansion sees it.
struct SmallThing {
  Vec2 at;
  double square;  // of its size
  std::size_t variant = 0;
};

SmallThing as_small(const Drawn& d, const VectorXd& v, const std::vector<Variant>& variants) {
  const auto nearest = [&](auto&& distance) {
    const auto best = std::ranges::min_element(variants, {}, distance);
    return static_cast<std::size_t>(best - variants.begin());
  };
  switch (d.kind) {
    case Drawn::Kind::Crack: {
      const Vec2 first = v.head<2>(), last = v.tail<2>(), along = 0.5 * (last - first);
      const double angle = std::atan2(along.y(), along.x());
      return {0.5 * (first + last), along.squaredNorm(),
              nearest([&](const Variant& one) { return std::abs(std::remainder(one.angle - angle, pi)); })};
    }
    case Drawn::Kind::Spline: {
      const Eigen::Index points = v.size() / 2;
      const Vec2 middle = v.reshaped(2, points).rowwise().mean();
      return {middle, area_of_holes({{d}}, v, nullptr) / pi};
    }
    case Drawn::Kind::Ellipse:
      return {v.head<2>(), v[2] * v[3]};
    case Drawn::Kind::Inclusion:
      return {v.head<2>(), v[2] * v[2],
              nearest([&](const Variant& one) { return std::abs(std::log(one.young / v[3])); })};
    case Drawn::Kind::Circle:
      break;
  }
  return {v.head<2>(), v[2] * v[2]};
}

}  // namespace

std::vector<double> promises(const Problem& p, const OptimizeRequest& r, const std::vector<VectorXd>& designs) {
  std::vector<double> sum(designs.size(), 0), area(designs.size(), 0);
  try {
    const Mesh mesh = triangulate(p.frame, p.sizing);
    const std::vector<Scene> scenes = scenes_of(p, r);
    for (std::size_t l = 0; l < scenes.size(); ++l) {
      const double weight = r.load_cases.empty() ? 1 : r.load_cases[l].weight;
      const Model m = prepare(mesh, p.element, scenes[l], p.threads);
      const State s = solve(m, p.contact);
      if (!certified(s)) return {};
      const Analysis a = analyze(p.objective, m, s);
      Eigen::Index first = 0;
      for (const Drawn& d : r.design.drawn) {
        const std::vector<Variant> variants = shape_of(d).seek(d, p).variants;
        std::vector<SmallThing> things;
        std::map<std::size_t, std::vector<std::size_t>> of_variant;  // designs
        for (std::size_t k = 0; k < designs.size(); ++k) {
          things.push_back(as_small(d, designs[k].segment(first, d.lower.size()), variants));
          of_variant[things.back().variant].push_back(k);
        }
        for (const auto& [variant, numbers] : of_variant) {
          MapRequest request{.perturbation = variants[variant].what};
          if (d.kind == Drawn::Kind::Crack) request.perturbation.angle = variants[variant].angle;
          std::vector<Vec2> places;
          for (const std::size_t k : numbers) places.push_back(things[k].at);
          const std::vector<MapPoint> found = map_at(a, p.objective, request, places);
          for (std::size_t i = 0; i < numbers.size(); ++i) {
            const double square = things[numbers[i]].square;
            sum[numbers[i]] += weight * square * (std::isfinite(found[i].value) ? found[i].value : infinity);
            if (l == 0) area[numbers[i]] += square;
          }
        }
        first += d.lower.size();
      }
    }
  } catch (const Error& error) {
    if (error.fault != Fault::Usage && !of_one_body(error)) throw;
    return {};
  }
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] /= area[k];
  return sum;
}

}  // namespace kerf
