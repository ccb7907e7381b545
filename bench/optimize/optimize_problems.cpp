// The scenarios of `kerf bench optimize`: case files that are compiled in, read as a user's would be, and what other
// programs are told of them. A density program gets JSON: outline, supports, loads with weights, solid parts, volume,
// mu and c of the material; it can be compared where the compliance is minimized at a volume under constant tractions,
// without cracks, holes, weight or bounds. Starts are the full body, regular patterns of holes of two sizes, and forty
// holes at random with two seeds, all relative to the shorter side.

#include "bench/optimize/optimize_problems.hpp"

#include "bench/measure/peer_scripts.hpp"
#include "io/files.hpp"
#include "kerf/case_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace kerf {

namespace {

// JSON.
std::string list(const std::vector<std::string>& items) {
  return fmt::format("[{}]", fmt::join(items, ", "));
}
std::string point(const Vec2& x) {
  return fmt::format("[{}, {}]", x.x(), x.y());
}

std::vector<std::array<Vec2, 2>> sides_labelled(const Loop& outline, Index label) {
  std::vector<std::array<Vec2, 2>> all;
  for (std::size_t i = 0; i < outline.sides.size(); ++i)
    if (outline.sides[i].label == label)
      all.push_back({outline.sides[i].start, outline.sides[(i + 1) % outline.sides.size()].start});
  return all;
}

std::string segments(const Loop& outline, Index label) {
  std::vector<std::string> all;
  for (const auto& [a, b] : sides_labelled(outline, label)) all.push_back(list({point(a), point(b)}));
  return list(all);
}

std::string tractions(const Loop& outline, const Scene& scene) {
  std::vector<std::string> all;
  for (const Traction& t : scene.tractions)
    for (const auto& [a, b] : sides_labelled(outline, t.label)) {
      const Vec2 along = (b - a).normalized(), normal(along.y(), -along.x());
      const Vec2 value = t.value(a, normal);
      if ((t.value(b, normal) - value).norm() > 1e-9 * value.norm())
        throw Error(Fault::Usage, "a density is compared under constant tractions only");
      all.push_back(fmt::format(R"({{"segments": [[{}, {}]], "traction": {}}})", point(a), point(b), point(value)));
    }
  return list(all);
}

std::string polygon_of(const Loop& loop) {
  std::vector<std::string> all;
  for (const Side& side : loop.sides) all.push_back(point(side.start));
  return list(all);
}

}  // namespace

const std::vector<std::string>& scenario_names() {
  static const std::vector<std::string> all = [] {
    std::vector<std::string> names;
    for (const ScenarioText& s : scenario_texts())
      if (s.name != published_name) names.push_back(s.name);
    return names;
  }();
  return all;
}

OptimizeProblem read_problem(const std::string& name, const std::filesystem::path& folder,
                             std::span<const std::string> overrides) {
  const auto found = std::ranges::find(scenario_texts(), name, &ScenarioText::name);
  if (found == scenario_texts().end()) throw std::invalid_argument("no scenario " + name);
  const std::filesystem::path path = folder / (name + ".toml");
  write_file(path, std::string(found->text));
  const Case c = read_case(path, overrides);
  return {name, c.title, problem_of(c), c.optimize.value()};
}

bool is_judged(const OptimizeProblem& p) {
  return (p.problem.objective.kind == "compliance" || is_volume(p)) && p.problem.frame.cracks.empty();
}

bool has_density(const OptimizeProblem& p) {
  return is_judged(p) && !is_volume(p) && !p.problem.scene.body && p.request.bounds.empty() &&
         p.request.volume_at_most && p.problem.frame.holes.empty();
}

std::vector<WeightedScene> loaded_scenes(const OptimizeProblem& p) {
  std::vector<WeightedScene> all;
  for (const LoadCase& load : p.request.load_cases) {
    Scene scene = p.problem.scene;
    scene.tractions.insert(scene.tractions.end(), load.tractions.begin(), load.tractions.end());
    if (scene.body && load.body)
      scene.body = [a = scene.body, b = load.body](const Vec2& x) -> Vec2 { return a(x) + b(x); };
    else if (load.body)
      scene.body = load.body;
    all.push_back({load.weight, std::move(scene)});
  }
  if (all.empty()) all.push_back({1, p.problem.scene});
  return all;
}

std::vector<Index> loaded_labels(const OptimizeProblem& p) {
  std::vector<Index> labels;
  for (const auto& [weight, scene] : loaded_scenes(p))
    for (const Traction& t : scene.tractions) labels.push_back(t.label);
  return labels;
}

std::string density_scenario(const OptimizeProblem& p, double volume) {
  const Loop& outline = p.problem.frame.outline;
  const Material& material = p.problem.scene.material;
  std::vector<std::string> supports, loads, solid;
  for (const Support& s : p.problem.scene.supports)
    supports.push_back(
        fmt::format(R"({{"segments": {}, "x": {}, "y": {}}})", segments(outline, s.label), s.first, s.second));
  for (const auto& [weight, scene] : loaded_scenes(p))
    loads.push_back(fmt::format(R"({{"weight": {}, "tractions": {}}})", weight, tractions(outline, scene)));
  for (const Loop& loop : p.request.level_set.frozen) solid.push_back(polygon_of(loop));
  return fmt::format(R"({{"outline": {}, "supports": {}, "loads": {}, "solid": {}, "volume": {}, "mu": {}, "c": {}}})",
                     polygon_of(outline), list(supports), list(loads), list(solid), volume, material.mu, material.c);
}

const std::vector<std::string>& optimize_starts() {
  static const std::vector<std::string> all{"full", "few holes", "holes", "random 1", "random 2"};
  return all;
}

OptimizeRequest request_from(const OptimizeProblem& p, const std::string& start) {
  OptimizeRequest r = p.request;
  Vec2 low = p.problem.frame.outline.sides.front().start, high = low;
  for (const Side& side : p.problem.frame.outline.sides) {
    low = low.cwiseMin(side.start);
    high = high.cwiseMax(side.start);
  }
  const double width = (high - low).x(), height = (high - low).y(), shorter = std::min(width, height);
  const auto pattern = [&](int rows, double radius) -> StartHoles {
    const double spacing = shorter / rows;
    return {.columns = static_cast<int>(std::lround(width / spacing)),
            .rows = static_cast<int>(std::lround(height / spacing)),
            .radius = radius * shorter};
  };
  if (start == "few holes")
    r.level_set.start = pattern(3, 0.1);
  else if (start == "holes")
    r.level_set.start = pattern(5, 0.04);
  else if (start == "random 1")
    r.level_set.start = StartHoles{.random = 40, .seed = 1, .radius = 0.06 * shorter};
  else if (start == "random 2")
    r.level_set.start = StartHoles{.random = 40, .seed = 2, .radius = 0.06 * shorter};
  else if (start != "full")
    throw std::invalid_argument("unknown start " + start);
  return r;
}

}  // namespace kerf
