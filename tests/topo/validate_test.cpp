#include "topo/validate.hpp"

#include "solver/stopwatch.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>

namespace kerf {
namespace {

using Kind = Perturbation::Kind;

[[maybe_unused]] nlohmann::json reference(const std::string& name) {
  static const nlohmann::json all =
      nlohmann::json::parse(std::ifstream(std::string(KERF_TEST_DATA) + "/topological_derivatives.json"));
  for (const auto& entry : all.at("fe"))
    if (entry.at("name") == name) return entry;
  throw std::invalid_argument(name);
}

Shape rectangle(const Vec2& low, const Vec2& high) {
  Shape s;
  s.labels = {"bottom", "right", "top", "left"};
  s.outline = polygon("outline", {low, {high.x(), low.y()}, high, {low.x(), high.y()}}, 0);
  for (Index i = 0; i < 4; ++i) s.outline.sides[i].label = i;
  return s;
}

// The cantilever of the reference: u = 0 on x = 0, traction (0.3, -1) on x = 2.
Scene cantilever(const Material& m, bool body) {
  Scene s;
  s.material = m;
  s.supports.push_back({3, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }});
  s.tractions.push_back({1, [](const Vec2&, const Vec2&) { return Vec2(0.3, -1); }});
  if (body) s.body = [](const Vec2&) { return Vec2(0.2, -0.5); };
  return s;
}
double smooth(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}
double weight(const Vec2& x) {
  return smooth((x.x() - 0.2) / 0.3) * smooth((1.9 - x.x()) / 0.3);
}

struct Result {
  Validation v;
  double seconds;
};
Result check(const Shape& shape, const Scene& scene, const Term& term, const Vec2& at, const Perturbation& p,
             double size, int degree = 1, const std::vector<double>& radii = {0.08, 0.04, 0.02, 0.01}) {
  Stopwatch watch;
  const Functional j{"", {term}};
  const std::vector<Validation> all =
      validate(shape, {.size = size}, element("bdms", degree), scene, j, {{at}, radii, p, 2});
  return {all[0], watch.lap()};
}
void print(const std::string& name, const Result& r) {
  fmt::print("{}: T {:.8g} order {:.3f} intercept {:.8g} verdict {} ({}) {:.2f}s\n", name, r.v.coefficient, r.v.order,
             r.v.intercept, static_cast<int>(r.v.verdict), r.v.reason, r.seconds);
  for (const ValidationRow& row : r.v.rows)
    fmt::print("   {:.4g}  D {:.8g}  rel {:.3e} order {:.3f} same {}\n", row.radius,
               row.difference / row.predicted * r.v.coefficient, row.remainder / row.predicted, row.order,
               row.same_contact);
}

TEST(Print, Cantilever) {
  const Shape shape = rectangle({0, 0}, {2, 1});
  const Material m = plane_stress(1, 0.3);
  for (const double size : {0.05}) {
    print("comp", check(shape, cantilever(m, true), compliance(), {0.8, 0.35}, {}, size));
    print("energy", check(shape, cantilever(m, true), energy(), {0.8, 0.35}, {}, size));
    print("track", check(shape, cantilever(m, true), displacement_tracking({}, {}), {0.8, 0.35}, {}, size));
    print("vm2", check(shape, cantilever(m, true), stress_power(2, weight, false), {0.8, 0.35}, {}, size));
    print("vm4", check(shape, cantilever(m, true), stress_power(4, weight, false), {0.8, 0.35}, {}, size));
    print("vm6", check(shape, cantilever(m, true), stress_power(6, weight, false), {0.8, 0.35}, {}, size));
    Perturbation stiff{.kind = Kind::Inclusion, .inclusion = plane_stress(20, 0.3)};
    print("stiff comp", check(shape, cantilever(m, false), compliance(), {0.8, 0.35}, stiff, size));
    print("stiff track", check(shape, cantilever(m, false), displacement_tracking({}, {}), {0.8, 0.35}, stiff, size));
    const Material n = plane_strain(1, 0.4999999);
    print("strain comp", check(shape, cantilever(n, true), compliance(), {0.8, 0.35}, {}, size));
    print("strain track", check(shape, cantilever(n, true), displacement_tracking({}, {}), {0.8, 0.35}, {}, size));
  }
}

}  // namespace
}  // namespace kerf
