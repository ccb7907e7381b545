// A bar of 2 by 1 pulled along its length: its work is that of the closed form, whatever the mesh.
#include <kerf/kerf.hpp>

#include <cmath>
#include <cstdio>

int main() {
  using namespace kerf;
  Shape bar;
  bar.labels = {"bottom", "right", "top", "left"};
  bar.outline.sides = {{{0, 0}, 0}, {{2, 0}, 1}, {{2, 1}, 2}, {{0, 1}, 3}};

  Scene scene;
  scene.material = plane_stress(50, 0.3);
  const auto constant = [](double x, double y) { return [=](const Vec2&, const Vec2&) -> Vec2 { return {x, y}; }; };
  Support rollers{.label = 3, .value = constant(0, 0)};
  rollers.second = false;
  Support floor{.label = 0, .value = constant(0, 0)};
  floor.first = false;
  scene.supports = {rollers, floor};
  scene.tractions = {{.label = 1, .value = constant(3, 0)}};

  const Model model = prepare(triangulate(bar, {.size = 0.2}), element("afw"), scene, 1);
  const double work = analyze({.kind = "compliance", .terms = {compliance()}}, model, solve(model), true).value;
  const double exact = 3 * 3 * 2 * 1 / 50.0;
  std::printf("work of the loads %.12g, exact %.12g\n", work, exact);
  return std::abs(work - exact) < 1e-9 ? 0 : 1;
}
