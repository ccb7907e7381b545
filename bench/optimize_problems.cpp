#include "bench/optimize_problems.hpp"

#include <stdexcept>

namespace kerf {

namespace {

/// Sides of a polygon, each with the name of its label.
struct NamedSide {
  Vec2 start;
  const char* label;
};

OptimizeProblem body(const std::string& name, const std::string& title, const std::vector<NamedSide>& sides) {
  OptimizeProblem p{.name = name, .title = title};
  Shape& shape = p.problem.frame;
  shape.outline.name = "outline";
  for (const NamedSide& s : sides) {
    Index label = 0;
    while (label < static_cast<Index>(shape.labels.size()) && shape.labels[label] != s.label) ++label;
    if (label == static_cast<Index>(shape.labels.size())) shape.labels.emplace_back(s.label);
    shape.outline.sides.push_back({s.start, label});
  }
  p.problem.scene.material = plane_stress(1, 0.3);
  p.problem.plane_strain = false;
  p.problem.objective = {"compliance", {compliance()}};
  p.problem.sizing.size = 0.03;
  return p;
}

Index label(const OptimizeProblem& p, const std::string& name) {
  const auto& labels = p.problem.frame.labels;
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (labels[i] == name) return static_cast<Index>(i);
  throw std::invalid_argument("no label " + name);
}

void hold(OptimizeProblem& p, const std::string& name, bool x, bool y) {
  p.problem.scene.supports.push_back(
      {label(p, name), false, x, y, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }});
}

/// 1 in all, downwards, over a length.
void load(OptimizeProblem& p, const std::string& name, double length) {
  const Vec2 traction(0, -1 / length);
  p.problem.scene.tractions.push_back({label(p, name), [traction](const Vec2&, const Vec2&) { return traction; }});
}

OptimizeProblem cantilever(double pad) {
  OptimizeProblem p = body("cantilever", "Cantilever 2 × 1",
                           {{{0, 0}, "bottom"},
                            {{2, 0}, "right"},
                            {{2, 0.5 - pad / 2}, "load"},
                            {{2, 0.5 + pad / 2}, "right"},
                            {{2, 1}, "top"},
                            {{0, 1}, "left"}});
  hold(p, "left", true, true);
  load(p, "load", pad);
  p.holes = {.columns = 10, .rows = 5, .radius = 0.04};
  p.random = {.random = 40, .seed = 1, .radius = 0.06};
  p.mirror = Mirror{{0, 0.5}, {1, 0}};
  return p;
}

OptimizeProblem mbb() {
  OptimizeProblem p = body("mbb", "Half of an MBB beam, 3 × 1",
                           {{{0, 0}, "bottom"},
                            {{2.9, 0}, "roller"},
                            {{3, 0}, "right"},
                            {{3, 1}, "top"},
                            {{0.1, 1}, "load"},
                            {{0, 1}, "symmetry"}});
  hold(p, "symmetry", true, false);
  hold(p, "roller", false, true);
  load(p, "load", 0.1);
  p.holes = {.columns = 13, .rows = 4, .radius = 0.06};
  p.random = {.random = 60, .seed = 2, .radius = 0.06};
  return p;
}

OptimizeProblem lbracket() {
  OptimizeProblem p = body("lbracket", "L-bracket",
                           {{{0, 0}, "bottom"},
                            {{1, 0}, "right"},
                            {{1, 0.15}, "load"},
                            {{1, 0.25}, "right"},
                            {{1, 0.4}, "inner"},
                            {{0.4, 0.4}, "inner"},
                            {{0.4, 1}, "top"},
                            {{0, 1}, "left"}});
  hold(p, "top", true, true);
  load(p, "load", 0.1);
  p.length = 0.5;
  p.problem.sizing.size *= p.length;
  p.holes = {.columns = 7, .rows = 7, .radius = 0.04};
  p.random = {.random = 40, .seed = 1, .radius = 0.04};
  return p;
}

OptimizeProblem bridge() {
  OptimizeProblem p = body("bridge", "Bridge 2 × 1 with a deck",
                           {{{0, 0}, "left foot"},
                            {{0.1, 0}, "deck"},
                            {{1.9, 0}, "right foot"},
                            {{2, 0}, "right"},
                            {{2, 1}, "top"},
                            {{0, 1}, "left"}});
  hold(p, "left foot", true, true);
  hold(p, "right foot", true, true);
  load(p, "deck", 1.8);
  p.holes = {.columns = 10, .rows = 5, .radius = 0.04};
  p.random = {.random = 40, .seed = 1, .radius = 0.06};
  p.mirror = Mirror{{1, 0}, {0, 1}};
  p.frozen = {polygon("deck", {{0, 0}, {2, 0}, {2, 0.05}, {0, 0.05}}, none)};
  return p;
}

}  // namespace

const std::vector<OptimizeProblem>& optimize_problems() {
  static const std::vector<OptimizeProblem> all{cantilever(0.1), mbb(), lbracket(), bridge()};
  return all;
}

const OptimizeProblem& published_problem() {
  static const OptimizeProblem p = [] {
    OptimizeProblem made = cantilever(0.05);
    made.name = "published";
    made.title = "Cantilever 2 × 1, compliance + 100 |Ω|, weak phase 10⁻³";
    made.volume = 1;
    made.volume_penalty = 100;
    made.ersatz = 1e-3;
    return made;
  }();
  return p;
}

const std::vector<std::string>& optimize_starts() {
  static const std::vector<std::string> all{"full", "holes", "random"};
  return all;
}

OptimizeRequest level_set_request(const OptimizeProblem& p, const std::string& start) {
  OptimizeRequest r;
  r.method = OptimizeMethod::LevelSet;
  if (p.volume_penalty > 0)
    r.volume_penalty = p.volume_penalty;
  else
    r.volume_at_most = p.volume;
  r.max_iterations = 80;
  r.tolerance = 5e-4;
  r.level_set.nucleate_every = 2;
  r.level_set.nucleate_fraction = 0.02;
  r.level_set.frozen = p.frozen;
  r.level_set.ersatz = p.ersatz;
  r.level_set.mirror = p.mirror;
  if (p.ersatz > 0) r.level_set.move = LevelSetRequest::Move::FixedPoint;
  if (start == "holes")
    r.level_set.start = p.holes;
  else if (start == "random")
    r.level_set.start = p.random;
  else if (start != "full")
    throw std::invalid_argument("unknown start " + start);
  return r;
}

}  // namespace kerf
