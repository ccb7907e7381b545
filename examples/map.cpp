// A square plate with a crack, pulled at its top: what a small hole would do to the compliance.
#include <kerf/kerf.hpp>

#include <cstdio>

int main() try {
  using namespace kerf;
  Shape shape;
  shape.labels = {"bottom", "right", "top", "left"};
  shape.outline.sides = {{{-2, -2}, 0}, {{2, -2}, 1}, {{2, 2}, 2}, {{-2, 2}, 3}};
  shape.cracks = {{.name = "c", .points = {{-1, 0}, {1, 0}}}};

  Scene scene;
  scene.material = plane_strain(1000, 0.3);
  scene.laws = {{.kind = CrackLaw::Kind::Unilateral}};
  const auto clamped = [](const Vec2&, const Vec2&) -> Vec2 { return {0, 0}; };
  scene.supports = {{.label = 0, .value = clamped}};
  const auto pull = [](const Vec2& x, const Vec2&) -> Vec2 { return {0, 0.1 + x.x()}; };
  scene.tractions = {{.label = 2, .value = pull}};

  const Sizing sizing{.size = 0.1};
  const Model model = prepare(triangulate(shape, sizing), element("bdms"), scene, 1);
  const State state = solve(model);
  if (!certified(state)) return std::fputs("the contact did not settle\n", stderr), 1;

  const Functional J{.kind = "compliance", .terms = {compliance()}};
  const Analysis analysis = analyze(J, model, state);
  const Vec2 at(1.4, -0.9);
  const MapPoint hole = map_at(analysis, J, {.perturbation = {}, .radius = 0.05}, std::array{at}).front();
  std::printf("J = %.6g; a hole of radius eps at (%g, %g) changes it by %.6g pi eps^2\n", analysis.value, at.x(),
              at.y(), hole.value);

  const auto proof = validate({shape, sizing}, model.element, scene, J, {.points = {at}, .radii = {0.08, 0.04, 0.02}});
  std::printf("finite holes give %.6g pi eps^2: it %s\n", proof[0].intercept,
              proof[0].verdict == Verdict::Holds ? "holds" : "does not hold");
  return proof[0].verdict == Verdict::Holds ? 0 : 1;
} catch (const kerf::Error& e) {
  return std::fprintf(stderr, "%s\n", e.what()), static_cast<int>(e.fault);
}
