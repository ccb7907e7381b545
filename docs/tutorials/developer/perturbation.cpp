// The new perturbation at one stress: its direction, its T, and that no other direction of an ellipse is worse.
#include <kerf/kerf.hpp>

#include <algorithm>
#include <array>
#include <cstdio>

using namespace kerf;

int main() try {
  const Material steel = plane_stress(210000, 0.3);
  const Mat2 s = (Mat2() << 80, 20, 20, -10).finished();
  const std::array products{Product{1, s, s}};  // of the compliance
  const Perturbation gouge{.kind = perturbation_kind("gouge"), .aspect = 3};
  const Oriented found = oriented(gouge, steel, products);
  double worst = 0;
  for (int degree = 0; degree < 180; ++degree)
    worst = std::max(worst, ellipse_form(steel, gouge.aspect, degree * pi / 180, s, s));
  std::printf("%s: T = %.5g at %.1f degrees; worst of all degrees %.5g\n", description(gouge).c_str(), found.value,
              found.angle * 180 / pi, worst);
  return found.value >= worst && found.value < 1.001 * worst ? 0 : 1;
} catch (const kerf::Error& e) {
  return std::fprintf(stderr, "%s\n", e.what()), 1;
}
