// The exact cracked and cornered bodies of data/exact on adaptive meshes: optimal rate, estimate, energy between its
// bounds.
#include "kerf/adaptive.hpp"
#include "kerf/bounds.hpp"
#include "tests/support/exact.hpp"
#include "tests/support/exact_families.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::singular_cases_test {
namespace {

struct Named {
  std::string id;
  bool corner = false;    // the L-shaped body; else [-2, 2]^2 with straight cracks between the tips
  double first = 1.6e-2;  // error to ask for, more than once refined
};

exact::ExactField field_of(const Named& c) {
  return c.corner || c.id == "c06_two_cracks" ? exact::family_field(c.id) : exact::table_field(c.id);
}

class SingularCase : public testing::TestWithParam<Named> {};

TEST_P(SingularCase, AdaptsAtTheOptimalRateWithTheEnergyBetweenItsBounds) {
  const exact::ExactField f = field_of(GetParam());
  Shape shape;
  shape.labels = {"outer"};
  if (GetParam().corner) {
    shape.outline = polygon("outline", {{0, 0}, {0, -1}, {1, -1}, {1, 1}, {-1, 1}, {-1, 0}}, 0);
    shape.labels.push_back("free");
    shape.outline.sides.front().label = shape.outline.sides.back().label = 1;
  } else {
    shape.outline = polygon("outline", {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, 0);
    for (std::size_t i = 0; i + 1 < f.tips.size(); i += 2)
      shape.cracks.push_back({std::to_string(i), {f.tips[i].at, f.tips[i + 1].at}, {}});
  }
  Scene scene;
  scene.material = f.material;
  scene.body = f.body;
  scene.laws.resize(shape.cracks.size());
  scene.supports.push_back(
      {0, false, true, true, [f](const Vec2& x, const Vec2&) { return f.displacement(x, exact::side_of(f, x)); }});
  const double energy = exact::read_table(KERF_TEST_DATA "/exact", GetParam().id).energy;
  std::vector<double> size, error;
  for (const double wanted : {GetParam().first, GetParam().first / 4}) {
    const Adapted a =
        solve_adaptively(shape, {.size = 0.5, .crack_tip_size = 0.5}, element("bdms"), scene, {.error = wanted});
    ASSERT_EQ(a.stopped.rfind("reached", 0), 0u) << a.stopped;
    EXPECT_TRUE(certified(a.state));
    const double norm = exact::stress_error(a.model.mesh, f, [](Index, const Vec2&) -> Mat2 { return Mat2::Zero(); });
    error.push_back(exact::stress_error(a.model, a.state, f) / norm);
    size.push_back(static_cast<double>(a.model.mesh.triangles.size()));
    EXPECT_LT(error.back(), 2 * a.indicator.relative);
    EXPECT_GT(error.back(), 0.5 * a.indicator.relative);
    const EnergyBounds b = energy_bounds(a.model, a.state);
    EXPECT_LE(b.lower, energy);
    EXPECT_GE(b.upper, energy);
    EXPECT_LT(b.upper - b.lower, 20 * wanted * energy);
  }
  // h^2 in two dimensions: an error like 1/N.
  EXPECT_GT(std::log(error[0] / error[1]) / std::log(size[1] / size[0]), 0.8);
}

INSTANTIATE_TEST_SUITE_P(Cases, SingularCase,
                         testing::Values(Named{"c01_modeI"}, Named{"c01b_modeI_biaxial"}, Named{"c03_inclined_open"},
                                         Named{"c04_inclined_closed"}, Named{"c05_partial_linear"},
                                         Named{"c05_partial_linear_w", false, 4e-3}, Named{"c05b_partial_general"},
                                         Named{"c05c_lens"}, Named{"c06_two_cracks"}, Named{"c13_L_modeI", true},
                                         Named{"c13_L_modeII", true}),
                         [](const auto& info) { return info.param.id; });

}  // namespace
}  // namespace kerf::singular_cases_test
