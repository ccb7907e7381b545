// The error indicator of every element against the error.

#include "kerf/adaptive.hpp"
#include "kerf/mesher.hpp"
#include "tests/solver/scenes.hpp"

#include <gtest/gtest.h>

namespace kerf::efficiency_test {
namespace {

Mesh graded_crack_mesh(double size) {
  Shape shape;
  shape.outline.name = "outline";
  shape.labels = {"bottom", "right", "top", "left"};
  const std::array<Vec2, 4> corners{Vec2(-2, -2), Vec2(2, -2), Vec2(2, 2), Vec2(-2, 2)};
  for (Index i = 0; i < 4; ++i) shape.outline.sides.push_back({corners[i], i, {}});
  shape.cracks = {{"crack", {{-1, 0}, {1, 0}}, {}}};
  return triangulate(shape, {.size = size});
}

class Efficiency : public testing::TestWithParam<Element> {};

TEST_P(Efficiency, EstimateIsTheErrorOrMore) {
  const Element& e = GetParam();
  const auto compare = [&](const Mesh& mesh, const exact::ExactField& f, std::vector<CrackLaw> laws) {
    for (const std::vector<Index>& held : {std::vector<Index>{0, 3}, {0, 1, 2, 3}}) {
      if (!laws.empty() && held.size() < 4) continue;
      const Model m = prepare(mesh, e, scene_of(f, held, laws), 1);
      const State s = solve(m);
      const double error = exact::stress_error(m, s, f) / stress_norm(m, s);
      const double ratio = error_indicator(m, s).relative / error;
      const std::string which = title(e) + " " + f.name + " " + std::to_string(mesh.triangles.size());
      EXPECT_GT(ratio, 0.6) << which;  // too large, if anything
      EXPECT_LT(ratio, 3.5) << which;
    }
  };
  for (const double nu : {0.3, 0.4999})
    for (const int n : {8, 16}) compare(exact::unit_square_mesh(n, 0.2), exact::wave_field(nu), {});
  if (e.at_vertices == AtVertices::Stress) return;
  const auto crack = exact::crack_case("III");
  if (e.cut == Cut::LinearDivergence)  // singular vertices on the faces of the graded mesh
    for (const int n : {16, 32}) compare(exact::crack_mesh(n), crack, {{}});
  else
    for (const double size : {0.8, 0.4}) compare(graded_crack_mesh(size), crack, {{}});
}

std::vector<Element> mixed_elements() {
  std::vector<Element> mixed;
  for (const Element& e : elements)
    if (is_mixed(e)) mixed.push_back(e);
  return mixed;
}
INSTANTIATE_TEST_SUITE_P(Elements, Efficiency, testing::ValuesIn(mixed_elements()),
                         [](const auto& info) { return title(info.param); });

}  // namespace
}  // namespace kerf::efficiency_test
