#include "tests/support/sample.hpp"

#include <fmt/core.h>
#include <sstream>

namespace kerf {
namespace {

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

void expect_narrow(const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    int letters = 0;
    for (const char c : line) letters += (static_cast<unsigned char>(c) & 0xC0) != 0x80;
    EXPECT_LE(letters, 100) << line;
    EXPECT_TRUE(line.empty() || line.back() != ' ') << line;
  }
  EXPECT_TRUE(!text.empty() && text.back() == '\n');
}

TEST(Summary, FullRun) {
  const std::string text = summary(test::full_result());
  expect_narrow(text);
  for (const char* part : {"cracked_plate: Plate with a partly closing crack",
                           "1200 triangles",
                           "min angle 26.3 deg",
                           "bdms",
                           "30000 unknowns",
                           "7000 condensed",
                           "residual 3.33333e-16",
                           "energy -0.1",
                           "energy in [-0.11, -0.09]",
                           "estimated error 0.001",
                           "rigid motion fixed: translation in x",
                           "dual-qp",
                           "4 iterations",
                           "3 linear solves",
                           "kkt 1e-14",
                           "open 1.3",
                           "closed 0.7",
                           "max opening 0.25",
                           "max pressure 0.375 at (-0.5, 0)  singular 0.5 at (-1, 0)",
                           "closed -> open at (-0.333333, 0)",
                           "tip at (1, 0)  K_I 1.25  K_II -0.5  G 1.8  T -0.75",
                           "min -3 at (0.5, 0.25)",
                           "max 4 at (-0.5, 0.75)",
                           "leave out 0.05",
                           "at (0.5, 0.5)  0.125  in [0.1, 0.15]  masked",
                           "at radius 0.0125 on 25 % of the area",
                           "a length 0.01 of the cracks",
                           "holds at 1 of 3 points",
                           "At (0.5, 0.8) the expansion holds: J(eps) - J(0) = pi eps^2 (-1.234",
                           "At (-0.4, 0.6) the expansion fails: the remainder falls with order 2, not 4",
                           "At (3, 0) out of range: the point lies outside the body.",
                           "at (9, 9)  no value",
                           "total 0.280 s",
                           "contact 0.050",
                           "peak 123.5 MB"}) {
    EXPECT_TRUE(has(text, part)) << part << "\n" << text;
  }
  EXPECT_FALSE(has(text, "tip at (-1, 0)")) << "nothing was computed there";
  EXPECT_FALSE(has(text, "nan"));
  EXPECT_FALSE(has(text, "status"));
}

TEST(Summary, ValuesStartInOneColumn) {
  std::istringstream lines(summary(test::full_result()));
  for (std::string line; std::getline(lines, line);) {
    EXPECT_EQ(line[11], ' ') << line;
    EXPECT_NE(line[12], ' ') << line;
  }
}

TEST(Summary, NothingOfWhatDidNotRunAndNoLongLines) {
  Result r;
  r.case_name = "bare";
  const std::string bare = summary(r);
  for (const char* part : {"mesh", "state", "contact", "crack", "map", "functional", "validate", "memory"}) {
    EXPECT_FALSE(has(bare, part)) << part;
  }
  r = test::full_result();
  r.title = fmt::format("{:x>300} many words {:y>150}", "", "");
  r.cracks[0].name = std::string(250, 'n');
  r.status = "not converged";
  r.reason =
      "the contact iteration reached its limit; a finer mesh near the crack or contact = \"dual-qp\" would be right, "
      "see the notes about σ and the path of the crack in the manual of this program";
  expect_narrow(summary(r));
  EXPECT_TRUE(has(summary(r), "not converged: the contact iteration"));
}

TEST(Summary, AnglesAndTerms) {
  Result r = test::full_result();
  r.map->oriented = true;
  r.functional = {"sum", 3, {{"compliance", 0.5, 4}, {"volume", -100, 1}}};
  const std::string text = summary(r);
  EXPECT_TRUE(has(text, "in [0.1, 0.15]  angle 45.0 deg  masked")) << text;
  EXPECT_TRUE(has(text, "functional  sum 3\n            0.5 times  compliance 4\n            -100 times  volume 1\n"))
      << text;
}

}  // namespace
}  // namespace kerf
