// What an element can do: the functions of element.hpp against the table of the docs, the code behind them, and the
// wording of refusals.
#include "kerf/element.hpp"

#include "solver/element/local.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

namespace kerf::abilities_test {
namespace {

std::vector<std::string> cells(const std::string& row) {
  std::vector<std::string> all;
  std::stringstream in(row.substr(1));
  for (std::string cell; std::getline(in, cell, '|');) {
    const auto from = cell.find_first_not_of(' '), to = cell.find_last_not_of(' ');
    all.push_back(from == std::string::npos ? "" : cell.substr(from, to - from + 1));
  }
  return all;
}

// The rows of the table that begins with "| element |", by the names of its first column.
struct Table {
  std::vector<std::string> header;
  std::map<std::string, std::vector<std::string>> of;
};
Table table_of_elements() {
  std::ifstream in(std::filesystem::path(KERF_CASES).parent_path() / "docs/case-files/solver.md");
  Table table;
  for (std::string line; std::getline(in, line);) {
    if (line.rfind("| element |", 0) == 0)
      table.header = cells(line);
    else if (!table.header.empty() && line.rfind('|', 0) != 0)
      break;
    else if (!table.header.empty() && line.rfind("|---", 0) != 0) {
      const std::vector<std::string> row = cells(line);
      std::stringstream names(row[0]);
      for (std::string part; std::getline(names, part, '`');) {
        if (part.empty() || part == ", ") continue;
        EXPECT_TRUE(table.of.emplace(part, row).second) << part << " twice";
      }
    }
  }
  return table;
}

std::string yes(bool can) {
  return can ? "yes" : "no";
}
std::string cracks(const Element& e) {
  if (can_contact(e) && !can_press_cracks(e)) return "yes, without `pressure`";
  return can_contact(e) ? "yes" : can_open(e) ? "open or bonded" : "bonded only";
}
std::string incompressible(const Element& e) {
  return can_be_enclosed(e) ? "yes" : can_be_incompressible(e) ? "not with displacements all around" : "no";
}

TEST(ElementAbilities, AreThoseOfTheDocs) {
  const Table table = table_of_elements();
  ASSERT_EQ(table.header,
            (std::vector<std::string>{"element", "cracks", "regions", "`eigenstrain`", "`poisson = 0.5`",
                                      "`energy_bounds`", "`mesh.adapt`, functionals of boundaries", "`umfpack`",
                                      "functionals with an adjoint, `clamped_hole`", "`[validate]`", "`[optimize]`"}));
  std::set<std::string_view> names;
  for (const Element& e : elements) {
    names.insert(e.name);
    const auto found = table.of.find(std::string(e.name));
    ASSERT_NE(found, table.of.end()) << e.name;
    EXPECT_EQ(can_estimate_error(e), can_integrate_boundaries(e));
    EXPECT_EQ(can_adjoint(e), can_clamp_holes(e));
    EXPECT_EQ(found->second,
              (std::vector<std::string>{found->second[0], cracks(e), yes(can_have_regions(e)), yes(can_be_strained(e)),
                                        incompressible(e), yes(can_bound_energy(e)), yes(can_estimate_error(e)),
                                        yes(can_stay_uncondensed(e)), yes(can_adjoint(e)), yes(can_validate(e)),
                                        can_optimize(e) ? "yes" : "`cobyla` only"}))
        << e.name;
    // "`map.bounds` works for all elements but `bdms` of degree 4."
    EXPECT_EQ(can_be_bettered(e), e.name != "bdms" || e.degree != 4) << e.name << e.degree;
  }
  EXPECT_EQ(table.of.size(), names.size()) << "a row of an element that is none";
}

TEST(ElementAbilities, HaveTheirCode) {
  for (const Element& e : elements) {
    const Operations& run = *kernel(e).run;
    EXPECT_EQ(can_adjoint(e), run.condense_dual != nullptr && run.interior_dual != nullptr) << e.name;
    EXPECT_TRUE(!can_stay_uncondensed(e) || (run.local_system && run.interior_of)) << e.name;
  }
}

TEST(ElementAbilities, RefusalsNameTheElementsThatCan) {
  EXPECT_EQ(elements_that(can_optimize), "\"bdms\", \"bdms-c\", \"peers\" or \"afw\"");
  EXPECT_EQ(elements_that(can_bound_energy), "\"bdms\" or \"afw\"");
  EXPECT_EQ(refusal(element("afw", 3), can_optimize), std::nullopt);
  EXPECT_EQ(refusal(element("arnold-winther-nc"), can_optimize),
            "element \"arnold-winther-nc\" has no derivatives by the shape, which optimization needs; use \"bdms\", "
            "\"bdms-c\", \"peers\" or \"afw\"");
  const std::string best = refusal(element("bdms", 4), can_be_bettered).value();
  EXPECT_EQ(
      best.substr(0, best.find(", \"bdms-c\"")),
      "element \"bdms\" of degree 4 is the best: no other could give error bars; use \"bdms\" (degree 1, 2 or 3)");
  for (const Ability can :
       {can_open, can_contact, can_press_cracks, can_have_regions, can_be_strained, can_be_incompressible,
        can_be_enclosed, can_stay_uncondensed, can_adjoint, can_integrate_boundaries, can_clamp_holes, can_validate,
        can_optimize, can_bound_energy, can_estimate_error, can_be_bettered})
    for (const Element& e : elements) {
      if (can(e)) {
        EXPECT_NO_THROW(require(e, can));
        continue;
      }
      try {
        require(e, can);
        ADD_FAILURE() << e.name;
      } catch (const Error& error) {
        EXPECT_EQ(error.fault, Fault::Usage);
        EXPECT_NE(std::string(error.what()).find("; use " + elements_that(can)), std::string::npos) << error.what();
      }
    }
  EXPECT_THROW(require(element("p1"), is_symmetric), std::invalid_argument);
}

}  // namespace
}  // namespace kerf::abilities_test
