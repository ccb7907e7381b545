#pragma once
// The unit square with something in it that only its boundary tells about.

#include "kerf/design.hpp"
#include "kerf/inverse.hpp"
#include "kerf/optimize.hpp"

#include <utility>
#include <vector>

namespace kerf::inverse {

/// Clamped at the bottom (label 0), pulled and measured at the sides and the top (label 1).
struct Plate {
  std::vector<std::pair<Vec2, double>> holes, inclusions;
  std::vector<std::pair<Vec2, Vec2>> cracks;
  double inclusion_young = 5;
  double noise = 0;
  unsigned seed = 1;
  double size = 0.05;        // of the search's mesh
  double true_size = 0.025;  // of the true body's
  Element element = bdms(1), true_element = kerf::element("p2");

  Problem frame() const {
    Problem p;
    p.frame.labels = {"bottom", "rest"};
    p.frame.outline = polygon("outline", {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 1);
    p.frame.outline.sides[0].label = 0;
    p.scene.material = plane_strain(1, 0.3);
    p.scene.supports = {{0, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }}};
    p.scene.tractions = {{1, [](const Vec2&, const Vec2& n) { return Vec2(0.5 * n.x(), n.y()); }}};
    p.sizing.size = size;
    p.element = element;
    p.objective = {"misfit", {misfit(1, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); })}};
    return p;
  }
  Synthetic truth() const {
    const Problem p = frame();
    Synthetic s{.true_shape = p.frame, .true_scene = p.scene, .element = cracks.empty() ? true_element : afw(1)};
    s.sizing.size = true_size;
    s.spacing = size;
    s.noise = noise;
    s.seed = seed;
    s.label = 1;
    s.true_shape.labels.push_back("hole");
    for (const auto& [x, r] : holes) s.true_shape.holes.push_back(kerf::circle("true", x, r, 2));
    for (const auto& [x, r] : inclusions) {
      s.true_shape.regions.push_back(kerf::circle("true", x, r, none));
      s.true_scene.regions.push_back(plane_strain(inclusion_young, 0.3));
    }
    for (const auto& [a, b] : cracks) {
      s.true_shape.cracks.push_back({"true", {a, b}, {}});
      s.true_scene.laws.emplace_back();
    }
    return s;
  }
  /// With the measurements, if there is something to be found.
  Problem problem() const {
    Problem p = frame();
    if (!holes.empty() || !inclusions.empty() || !cracks.empty())
      p.objective = with_measured(std::move(p.objective), 1, measure(truth()).field);
    return p;
  }

  Drawn circle(std::string name) const {
    Drawn d{.name = std::move(name)};
    d.lower = Eigen::Vector3d(0.1, 0.1, 0.03);
    d.upper = Eigen::Vector3d(0.9, 0.9, 0.16);
    d.start = Eigen::Vector3d(0.5, 0.5, 0.08);
    d.from_map = true;
    return d;
  }
  Drawn region(std::string name, double softest, double stiffest) const {
    Drawn d = circle(std::move(name));
    d.kind = Drawn::Kind::Inclusion;
    for (auto* v : {&d.lower, &d.upper, &d.start}) v->conservativeResize(4);
    d.lower[3] = softest, d.upper[3] = stiffest, d.start[3] = stiffest;
    return d;
  }
  Drawn crack(std::string name) const {
    Drawn d{.kind = Drawn::Kind::Crack, .name = std::move(name)};
    d.lower = Eigen::Vector4d::Constant(0.1);
    d.upper = Eigen::Vector4d::Constant(0.9);
    d.start = Eigen::Vector4d(0.3, 0.5, 0.7, 0.5);
    d.from_map = true;
    return d;
  }
};

}  // namespace kerf::inverse
