// Units of results against the way engineers write them; moduli that cannot be meant are noted.

#include "kerf/units.hpp"

#include <gtest/gtest.h>

namespace kerf::units_test {
namespace {

TEST(Units, ReadAsEngineersWriteThem) {
  const Units mm{"mm", "MPa"}, si{"m", "Pa"}, inch{"in", "ksi"}, mixed{"cm", "GPa"};
  EXPECT_EQ(unit(mm, dimension::stress), "MPa");
  EXPECT_EQ(unit(mm, dimension::area), "mm²");
  EXPECT_EQ(unit(mm, dimension::force), "N/mm");
  EXPECT_EQ(unit(mm, dimension::energy), "N mm/mm");
  EXPECT_EQ(unit(mm, dimension::stress_intensity), "MPa √mm");
  EXPECT_EQ(unit(mm, dimension::release_rate), "N/mm");
  EXPECT_EQ(unit(si, dimension::force), "N/m");
  EXPECT_EQ(unit(inch, dimension::force), "kip/in");
  EXPECT_EQ(unit(mixed, dimension::force), "GPa cm");
  EXPECT_EQ(unit(mixed, dimension::energy), "GPa cm²");
  EXPECT_EQ(unit_of_plate(mm, dimension::force), "N");
  EXPECT_EQ(unit_of_plate(mm, dimension::energy), "N mm");
  EXPECT_EQ(unit_of_plate(mixed, dimension::force), "GPa cm²");
  EXPECT_EQ(unit(mm, {}), "");
  EXPECT_EQ(unit({}, dimension::stress), "");
}

TEST(Units, AFunctionalAndItsDerivativeHaveTheirs) {
  const Units mm{"mm", "MPa"};
  const auto of = [&](const std::string& kind, const Term& term) {
    return dimension_of({.kind = kind, .terms = {term}}).value();
  };
  const Term fourth{.stress_power = 4};
  EXPECT_EQ(unit(mm, of("energy", {})), "N mm/mm");
  EXPECT_EQ(unit(mm, per_area(of("energy", {}))), "MPa");
  EXPECT_EQ(unit(mm, of("stress_power", fourth)), "MPa^4 mm²");
  EXPECT_EQ(unit(mm, of("stress_pnorm", fourth)), "MPa √mm");
  EXPECT_EQ(unit(mm, of("volume", {})), "mm²");
  EXPECT_EQ(unit(mm, per_area(of("volume", {}))), "");
  EXPECT_FALSE(dimension_of({.kind = "sum", .terms = {Term{}}, .sum = true}));
}

TEST(Units, PowersAndWhatIsNotKnown) {
  const Units mm{"mm", "MPa"}, gpa{"m", "GPa"};
  EXPECT_EQ(unit(gpa, dimension::force), "GN/m");
  EXPECT_EQ(unit(gpa, {0, 3}), "m\u00b3");
  EXPECT_EQ(unit(gpa, {2, -1.5}), "GPa\u00b2 m^-1.5");
  EXPECT_EQ(unit_of_plate({}, dimension::force), "");
  EXPECT_EQ(unit_of_plate(mm, dimension::stress), "MPa mm");
  EXPECT_EQ(unit_of_plate(mm, dimension::area), "mm\u00b3");
  EXPECT_FALSE(dimension_of({.kind = "energy", .terms = {}}));
  EXPECT_FALSE(dimension_of({.kind = "my own", .terms = {Term{}}}));
  EXPECT_EQ(unit(mm, dimension_of({.kind = "stress_pnorm", .terms = {Term{}}}).value()), "MPa");
  EXPECT_NE(implausible({"mm", "MPa"}, 5).find("soft plastics or rubber"), std::string::npos);
}

TEST(Units, AModulusInTheWrongUnitIsNoted) {
  EXPECT_NE(implausible({"mm", "MPa"}, 210).find("steel has 2.1e+05 MPa"), std::string::npos);
  EXPECT_NE(implausible({"m", "Pa"}, 2.1e14).find("diamond"), std::string::npos);
  EXPECT_EQ(implausible({"mm", "MPa"}, 210e3), "");
  EXPECT_EQ(implausible({"in", "ksi"}, 29e3), "");
  EXPECT_EQ(implausible({}, 1), "");
}

}  // namespace
}  // namespace kerf::units_test
