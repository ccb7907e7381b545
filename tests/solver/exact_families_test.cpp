// The fields of exact_families.hpp against their tables, against the equations, and against closed forms.

#include "tests/support/exact_families.hpp"
#include "base/quadrature.hpp"
#include "tests/solver/equations.hpp"
#include "tests/support/exact.hpp"

#include <gtest/gtest.h>
#include <cmath>

namespace kerf::exact::exact_families_test {
namespace {

const std::filesystem::path data = KERF_TEST_DATA;

/// Work of the tractions on straight sides, counter-clockwise, composite Gauss.
std::vector<double> work_on(const ExactField& field, const std::vector<Vec2>& corners) {
  const EdgeRule rule = gauss(16);
  constexpr int pieces = 8;
  std::vector<double> work(corners.size() - 1, 0);
  for (std::size_t k = 0; k < work.size(); ++k) {
    const Vec2 along = corners[k + 1] - corners[k], normal = Vec2(along.y(), -along.x()).normalized();
    for (int piece = 0; piece < pieces; ++piece)
      for (Index i = 0; i < rule.s.size(); ++i) {
        const Vec2 x = corners[k] + (piece + rule.s[i]) / pieces * along;
        const int side = side_of(field, x);
        work[k] +=
            rule.w[i] * along.norm() / pieces * (field.stress(x, side) * normal).dot(field.displacement(x, side));
      }
  }
  return work;
}

struct FamilyTables : testing::TestWithParam<const char*> {
  /// The interface has rows for both sides.
  static bool in_inclusion(const Row& row) {
    const double r = row.x.norm(), a = 0.5;
    return GetParam() == std::string("c09c_inclusion") && (r < a - 1e-12 || (r < a + 1e-12 && row.side < 0));
  }
};

TEST_P(FamilyTables, EveryRowIsReproduced) {
  const Table table = read_table(data / "exact", GetParam());
  const ExactField outside = family_field(GetParam());
  ASSERT_GE(table.rows.size(), 24u);
  double u_max = 0, s_max = 0, rot_max = 0, hole_max = 0;
  for (const Row& row : table.rows) {
    u_max = std::max(u_max, row.u.norm());
    s_max = std::max(s_max, row.stress.norm());
    rot_max = std::max(rot_max, std::abs(row.rot));
    hole_max = std::max(hole_max, std::abs(row.hole));
  }
  for (const Row& row : table.rows) {
    SCOPED_TRACE(row.kind + " " + std::to_string(row.x.x()) + " " + std::to_string(row.x.y()));
    const ExactField field = in_inclusion(row) ? family_field("c09c_inclusion, inside") : outside;
    const Mat2 stress = field.stress(row.x, row.side);
    EXPECT_LT((field.displacement(row.x, row.side) - row.u).norm(), 1e-12 * u_max);
    EXPECT_LT((stress - row.stress).norm(), 1e-12 * s_max);
    EXPECT_NEAR(-field.rotation(row.x, row.side), row.rot, 1e-12 * rot_max);
    EXPECT_NEAR(hole_derivative(field.material, stress), row.hole, 1e-12 * hole_max);
  }
}

TEST_P(FamilyTables, EquationsHoldByDifferences) {
  const ExactField field = family_field(GetParam());
  for (const Row& row : read_table(data / "exact", GetParam()).rows)
    if (row.kind == "bulk" && !in_inclusion(row)) {
      SCOPED_TRACE(std::to_string(row.x.x()) + " " + std::to_string(row.x.y()));
      expect_equations(field, row.x, 5e-4);
    }
}

TEST_P(FamilyTables, WorkOnTheBoundaryIsTheTabulatedEnergy) {
  const std::string id = GetParam();
  const Table table = read_table(data / "exact", id);
  if (table.energy == 0) return;  // not tabulated by sides
  const std::vector<Vec2> box = {{-2, -2}, {2, -2}, {2, 2}, {-2, 2}, {-2, -2}};
  const std::vector<Vec2> corner = {{0, -1}, {1, -1}, {1, 1}, {-1, 1}, {-1, 0}};
  const std::vector<double> work = work_on(family_field(id), id.starts_with("c13") ? corner : box);
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(work[k], table.work[k], 1e-12 * table.energy);
}

INSTANTIATE_TEST_SUITE_P(All, FamilyTables,
                         testing::Values("c06_two_cracks", "c07_coulomb", "c07_tresca", "c07_stick", "c08b_inglis",
                                         "c09_lame", "c09b_annulus_deviator", "c09c_inclusion", "c11_arc",
                                         "c11b_arc_shear", "c13_L_modeI", "c13_L_modeII", "c13_slit"),
                         [](const auto& info) { return std::string(info.param); });

/// Half the work of the tractions on the rim of the disc; the rule is exact for trigonometric polynomials.
TEST(Families, WorkOnTheRimIsTheTabulatedEnergy) {
  constexpr int points = 32;
  const auto work = [](const ExactField& field, double radius) {
    double sum = 0;
    for (int i = 0; i < points; ++i) {
      const Vec2 n(std::cos(2 * pi * i / points), std::sin(2 * pi * i / points));
      sum += (field.stress(radius * n, 0) * n).dot(field.displacement(radius * n, 0));
    }
    return sum * 2 * pi * radius / points;
  };
  for (const char* id : {"c09_lame", "c09b_annulus_deviator", "c09c_inclusion"}) {
    const ExactField field = family_field(id);
    const double inner = id == std::string("c09_lame") ? work(field, 0.5) : 0;
    const double energy = read_table(data / "exact", id).scalars.at("energy");
    EXPECT_NEAR((work(field, 1.5) - inner) / 2, energy, 1e-13 * energy) << id;
  }
}

TEST(Families, IntensitiesAreThoseOfTheTables) {
  const auto expect = [](const char* id, std::size_t tip, const std::string& end) {
    const Table table = read_table(data / "exact", id);
    const ExactField field = family_field(id);
    EXPECT_NEAR(field.tips.at(tip).k1, table.scalars.at("KI_" + end), 1e-13) << id << " " << end;
    EXPECT_NEAR(field.tips.at(tip).k2, table.scalars.at("KII_" + end), 1e-13) << id << " " << end;
  };
  expect("c06_two_cracks", 0, "outer");
  expect("c06_two_cracks", 1, "inner");
  expect("c06_two_cracks", 2, "inner");
  expect("c06_two_cracks", 3, "outer");
  for (const char* id : {"c07_coulomb", "c07_tresca", "c07_stick"}) {
    expect(id, 0, "left");
    expect(id, 1, "right");
  }
  for (const char* id : {"c11_arc", "c11b_arc_shear"}) {
    expect(id, 0, "upper");
    expect(id, 1, "lower");
  }
  EXPECT_NEAR(corner_exponent(1.5 * pi, 1), 0.544483736782463929, 1e-15);
  EXPECT_NEAR(corner_exponent(1.5 * pi, 2), 0.908529189846098819, 1e-15);
}

TEST(Families, JumpsOfCollinearCracksMatchTheTable) {
  const ExactField field = family_field("c06_two_cracks");
  for (const Face& face : read_table(data / "exact", "c06_two_cracks").faces) {
    const Vec2 jump = field.displacement(face.x, 1) - field.displacement(face.x, -1);
    EXPECT_NEAR(jump.y(), face.jump_n, 1e-15);
    EXPECT_NEAR(jump.x(), face.jump_t, 1e-15);
    EXPECT_NEAR(field.opening(face.s), face.jump_n, 1e-15);
  }
}

TEST(Families, FacesWithFrictionCarryTheLimit) {
  for (const char* id : {"c07_coulomb", "c07_tresca", "c07_stick"}) {
    const FrictionField friction = friction_table(id);
    const ExactField& field = friction.field;
    const Vec2 t = (field.tips[1].at - field.tips[0].at).normalized(), n(-t.y(), t.x());
    for (const Face& face : read_table(data / "exact", id).faces) {
      EXPECT_NEAR(field.slip(face.s), face.jump_t, 1e-16);
      EXPECT_NEAR(friction.shear, face.sigma_t, 1e-15);
      for (const int side : {1, -1}) {
        const Vec2 traction = field.stress(crack_point(field, face.s), side) * n;
        EXPECT_NEAR(traction.dot(n), face.sigma_n, 1e-14);
        EXPECT_NEAR(traction.dot(t), face.sigma_t, 1e-14);
      }
    }
  }
}

TEST(Families, FacesOfTheArcAreFree) {
  for (const char* id : {"c11_arc", "c11b_arc_shear"}) {
    const ExactField field = family_field(id);
    for (const Face& face : read_table(data / "exact", id).faces) {
      const Vec2 n = face.x.normalized(), t(n.y(), -n.x());
      const Vec2 jump = field.displacement(face.x, 1) - field.displacement(face.x, -1);
      EXPECT_NEAR(jump.dot(n), face.jump_n, 1e-15);
      for (const int side : {1, -1}) EXPECT_LT((field.stress(face.x, side) * n).norm(), 1e-13);
    }
  }
}

}  // namespace
}  // namespace kerf::exact::exact_families_test
