// [verdict] Random scenes: what the program says of its own errors, against solutions of one degree more on half the
// size. KERF_SCENES=10000 for many, KERF_FIRST=n to begin elsewhere.

#include "kerf/adaptive.hpp"
#include "kerf/bounds.hpp"
#include "tests/truth/random_scene.hpp"
#include "tests/truth/scene.hpp"

#include "base/quadrature.hpp"
#include "solver/system.hpp"

#include <cmath>
#include <cstdlib>

namespace kerf::verdict_test {
namespace {

class Verdict : public Truth {
 protected:
  Case scene(unsigned seed) {
    text = random_scene(seed);
    const std::filesystem::path file = folder / "scene.toml";
    std::ofstream(file) << text;
    return read_case(file);
  }
  std::string text;
};

/// |s - s'|/|s'| in L2, s' on a mesh that refines that of s.
double distance(const Model& coarse, const State& a, const Model& fine, const State& b) {
  const Locator locator = make_locator(coarse.mesh);
  const TriangleRule rule = triangle_rule(2 * (fine.element.stress + 1));
  double difference = 0, size = 0;
  for (Index t = 0; t < static_cast<Index>(fine.mesh.triangles.size()); ++t) {
    const Triangle shape = triangle(fine, t);
    const Points x = rule_points(rule, shape);
    const Eigen::Matrix4Xd s = evaluate(fine, b, t, x).stress,
                           r = evaluate(coarse, a, locate(coarse.mesh, locator, centroid(fine.mesh, t)), x).stress;
    difference += area(shape) * rule.w.dot((s - r).colwise().squaredNorm());
    size += area(shape) * rule.w.dot(s.colwise().squaredNorm());
  }
  return std::sqrt(difference / size);
}

/// Of one degree more on half the size.
double true_error(const Model& model, const State& state, const Scene& scene) {
  const Model better = prepare(refine(model.mesh), bdms(model.element.degree + 1), scene, 2);
  return distance(model, state, better, solve(better));
}

// The energy lies between all lower and all upper bounds: those of any two meshes intersect.
TEST_F(Verdict, EnergyBoundsOfMeshesIntersect) {
  const unsigned first = number("KERF_FIRST", 1), count = number("KERF_SCENES", 300);
  unsigned bounded = 0;
  for (unsigned seed = first; seed < first + count; ++seed) {
    const Case c = scene(seed);
    double lower = -infinity, upper = infinity, rounding = 0;
    std::string all;
    for (const double size : {0.5, 0.35, 0.25, 0.18}) {
      const Model model = prepare(triangulate(c.shape, {.size = size, .crack_tip_size = 0.1 * size}),
                                  bdms(size == 0.35 ? 2 : 1), c.scene, 2);
      const State state = solve(model);
      if (!certified(state)) continue;
      const EnergyBounds b = energy_bounds(model, state);
      if (!std::isfinite(b.lower) || !b.guaranteed) continue;
      all += fmt::format("\n  size {}: [{:.12g}, {:.12g}]", size, b.lower, b.upper);
      lower = std::max(lower, b.lower);
      upper = std::min(upper, b.upper);
      rounding = std::max({rounding, 1e-9 * std::abs(b.lower), 1e-9 * std::abs(b.upper)});
      ++bounded;
    }
    EXPECT_LE(lower, upper + rounding) << "seed " << seed << all << "\n" << text;
  }
  EXPECT_GT(bounded, count);
  RecordProperty("bounds", static_cast<int>(bounded));
}

// The estimate is the true error but for a factor.
TEST_F(Verdict, EstimatesBracketTheError) {
  const unsigned first = number("KERF_FIRST", 1), count = number("KERF_SCENES", 300) / 3;
  double least = infinity, most = 0;
  for (unsigned seed = first; seed < first + count; ++seed) {
    const Case c = scene(seed);
    const int degree = 1 + static_cast<int>(seed % 2);
    const Model model =
        prepare(triangulate(c.shape, {.size = 0.25, .crack_tip_size = 0.025}), bdms(degree), c.scene, 2);
    const State state = solve(model);
    if (!certified(state)) continue;
    const double ratio = error_indicator(model, state).relative / true_error(model, state, c.scene);
    least = std::min(least, ratio);
    most = std::max(most, ratio);
    EXPECT_GT(ratio, 0.6) << "seed " << seed << "\n" << text;
    EXPECT_LT(ratio, 3) << "seed " << seed << "\n" << text;
    if (std::getenv("KERF_PRINT")) fmt::print("{} {} {:.3f}\n", seed, degree, ratio);
  }
  RecordProperty("least", fmt::format("{:.3f}", least));
  RecordProperty("most", fmt::format("{:.3f}", most));
}

// "reached" is a claim about the error.
TEST_F(Verdict, ReachedIsTrue) {
  const unsigned first = number("KERF_FIRST", 1), count = number("KERF_SCENES", 300) / 10;
  unsigned reached = 0;
  for (unsigned seed = first; seed < first + count; ++seed) {
    const Case c = scene(seed);
    const double wanted = 0.03;
    const Adapted a = solve_adaptively(c.shape, {.size = 0.3}, bdms(1), c.scene,
                                       {.error = wanted, .max_triangles = 20000, .threads = 2});
    if (!a.stopped.starts_with("reached")) continue;
    ++reached;
    const double error = true_error(a.model, a.state, c.scene);
    EXPECT_LE(error, wanted) << "seed " << seed << "\n" << text;
    if (std::getenv("KERF_PRINT")) fmt::print("{} {:.4f} {:.4f}\n", seed, a.indicator.relative, error);
  }
  EXPECT_GT(reached, count / 2);
}

}  // namespace
}  // namespace kerf::verdict_test
