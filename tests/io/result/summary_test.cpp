// The summary of a run against the sentences it must hold, at most a hundred columns wide; sections that did not run
// are absent.

#include "tests/support/sample.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <sstream>

namespace kerf::summary_test {
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

Bounded within(double value, double by, bool guaranteed = true, std::string note = "") {
  return {value, value - by, value + by, guaranteed, std::move(note)};
}
Bounded unknown(std::string why) {
  return {std::nan(""), std::nan(""), std::nan(""), false, std::move(why)};
}

TEST(Summary, Bounds) {
  Result r = test::full_result();
  BoundsResult b;
  b.tips = {{"c", false, {1, 0}, within(1.25, 0.25), within(-0.5, 0.5, false, "an estimate"), within(1.5, 0.5)}};
  const Bounded none = unknown("no bound: a material is orthotropic");
  b.points = {{{0.5, 0.25}, within(1, 0.5), within(2, 0.5), within(3, 0.5), within(4, 0.5), none},
              {{0.5, 0.75}, none, none, none, none, none}};
  using Of = BoundedMean::Of;
  const auto mean = [](Of of, std::vector<Bounded> q) {
    BoundedMean m;
    m.of = of;
    m.on = "left";
    m.from = {1, 2};
    m.to = {3, 4};
    m.radius = 0.25;
    m.quantities = std::move(q);
    return m;
  };
  for (const Of of : {Of::Disc, Of::Line, Of::Displacement, Of::Reaction, Of::Loads})
    b.means.push_back(mean(of, std::vector<Bounded>(quantities_of(of).size(), within(8, 1))));
  r.bounds = b;
  const std::string text = summary(r);
  expect_narrow(text);
  for (const char* part :
       {"bounds      tip at (1, 0)  K_I in [1, 1.5]  K_II in [-1, 0] (estimate)  G in [1, 2]\n", "note: an estimate\n",
        "            at (0.5, 0.25)  s_xx in [0.5, 1.5]  s_yy in [1.5, 2.5]  s_xy in [2.5, 3.5]",
        "von Mises in [3.5, 4.5]", "topological derivative: none",
        "            at (0.5, 0.75)  s_xx: none  s_yy: none  s_xy: none", "mean over the disc at (1, 2), radius 0.25",
        "mean along the line from (1, 2) to (3, 4)", "mean of \"left\"", "support of \"left\"", "work of the loads",
        "in [7, 9]"})
    EXPECT_TRUE(has(text, part)) << part << "\n" << text;
  // A note that holds for several lines is said once.
  const std::string note = "note: no bound: a material is orthotropic";
  EXPECT_TRUE(has(text, note)) << text;
  EXPECT_EQ(text.find(note), text.rfind(note)) << text;
  EXPECT_FALSE(has(text, "more points in bounds.csv"));
  r.bounds->points.resize(13);
  EXPECT_TRUE(has(summary(r), "and 3 more points in bounds.csv"));
}

TEST(Summary, LongListsArePointedTo) {
  Result r = test::full_result();
  r.map->points.assign(12, {.at = {0.5, 0.5}, .value = 1});
  r.map->points[1] = {.at = {0.25, 0.5}, .value = std::nan(""), .masked = true};
  EXPECT_TRUE(has(summary(r), "at (0.25, 0.5)  no value: too near to something else for this radius")) << summary(r);
  EXPECT_TRUE(has(summary(r), "and 2 more points in map.csv"));
  OptimizeResult o;
  o.method = OptimizeMethod::Mma;
  o.iterations = 1;
  o.state_solves = 3;
  o.objective = 2;
  o.volume_fraction = 0.5;
  o.optimality = 0.01;
  o.stopped = "it is optimal";
  o.notes = {"checked"};
  o.history.resize(2);
  o.history[0].objective = 4;
  o.history[1].holes = 1;
  o.history[1].bounds = {0.75};
  o.variables = Eigen::VectorXd::LinSpaced(32, 0, 31);
  r.optimize = o;
  r.optimize_names = {.bounds = {"K"}, .at_most = {1.5}};
  for (int k = 0; k < 32; ++k) r.optimize_names.variables.push_back(fmt::format("v{}", k));
  const std::string text = summary(r);
  expect_narrow(text);
  for (const char* part : {"ended after 1 iteration and 3 state solves: it is optimal", "objective 2 from 4",
                           "volume fraction 0.5  optimality 0.01  1 hole\n", "K 0.75  at most 1.5\n", "v0 0  v1 1",
                           "v29 29", "and 2 more variables in result.json", "note: checked\n"})
    EXPECT_TRUE(has(text, part)) << part << "\n" << text;
  EXPECT_FALSE(has(text, "v30"));
}

/// The lines from the one that begins with `heading` to the next heading.
std::string section(const std::string& text, const std::string& heading) {
  const std::size_t begin = text.find(heading + " ");
  std::size_t end = text.find('\n', begin) + 1;
  while (end < text.size() && text[end] == ' ') end = text.find('\n', end) + 1;
  return text.substr(begin, end - begin);
}

TEST(Summary, AWholePlateInUnits) {
  Result r = test::full_result();
  r.units = {"mm", "MPa"};
  r.functional_dimension = dimension::energy;
  StateResult& s = *r.state;
  s.thickness = 5;
  s.energy_bounds = {-0.11, -0.09};
  s.of_polygon = true;
  s.von_mises = Peak{{{1, 2}, 30}, true, std::nullopt};
  s.displacement = Peak{{{1, 0}, 0.5}};
  s.loads = {{"top", {1, 2}, 3}, {"left\nside", {0.5, 0}, 1}};
  s.body = ResultantResult{"", {0, 1}, 2};
  s.reactions = {{"bottom", {-1, -3}, -3}};
  s.balance = ResultantResult{"", {0.5, 0}, 3};
  r.cracks[0].fluid_pressure = 2.5;
  r.adapt = AdaptResult{{{100, 0.5}, {200, 0.125}}, "reached 0.2", "K_I at the end of crack \"c\""};
  const std::string text = summary(r);
  expect_narrow(text);
  EXPECT_EQ(section(text, "units"), "units       mm and MPa; forces, moments and energies per mm of thickness\n");
  EXPECT_EQ(section(text, "adapt"), "adapt       for K_I at the end of crack \"c\": reached 0.2 after 2 rounds\n");
  EXPECT_TRUE(has(text, "max von Mises stress, singular: 30 MPa at (1, 2)\n")) << text;
  EXPECT_TRUE(has(text, "max displacement 0.5 mm at (1, 0)\n")) << text;
  EXPECT_TRUE(has(text, "energy of the polygon in [-0.11, -0.09] N mm/mm\n")) << text;
  EXPECT_TRUE(has(text, "fluid pressure 2.5 MPa\n")) << text;
  EXPECT_TRUE(has(text, "h 0.01 .. 0.1 mm")) << text;
  EXPECT_EQ(section(text, "loads"),
            "loads       top  force (1, 2) N/mm  moment 3 N mm/mm\n"
            "            left side  force (0.5, 0) N/mm  moment 1 N mm/mm\n"
            "            body  force (0, 1) N/mm  moment 2 N mm/mm\n");
  EXPECT_EQ(section(text, "reactions"), "reactions   bottom  force (-1, -3) N/mm  moment -3 N mm/mm\n");
  EXPECT_EQ(section(text, "balance"), "balance     force (0.5, 0) N/mm  moment 3 N mm/mm\n");
  // The whole plate: five times as much.
  EXPECT_EQ(section(text, "plate"),
            "plate       thickness 5 mm  energy -0.5 N mm  compliance 1 N mm\n"
            "            top  force (5, 10) N\n"
            "            left side  force (2.5, 0) N\n"
            "            body  force (0, 5) N\n"
            "            bottom  force (-5, -15) N\n");
  s.loads.clear();
  EXPECT_EQ(section(summary(r), "loads"), "loads       body  force (0, 1) N/mm  moment 2 N mm/mm\n");
}

TEST(Summary, OfAMapThatLeavesNothingOut) {
  Result r = test::full_result();
  const std::size_t lines = std::ranges::count(summary(r), '\n');
  r.map->excluded_radius = r.map->masked_share = r.map->biactive_length = 0;
  r.state->energy_bounds.reset();
  r.contact->biactive_length = 0;
  const std::string text = summary(r);
  for (const char* part : {"leave out", "masked: a change", "one-sided", "energy in", "biactive"})
    EXPECT_FALSE(has(text, part)) << part << "\n" << text;
  EXPECT_EQ(std::ranges::count(text, '\n') + 6u, lines) << "a sentence of two lines, two others, and the bounds";
}

TEST(Summary, AnInverseProblem) {
  Result r = test::full_result();
  r.optimize.emplace();
  r.optimize->method = OptimizeMethod::Mma;
  r.optimize->iterations = 2;
  r.optimize->ending = Ending::Infeasible;
  r.optimize->stopped = "infeasible: peak";
  r.optimize->optimality = nan;
  r.optimize->variables = Eigen::Vector2d(0.5, 0.25);
  r.optimize_names.variables = {"h.x", "h.y"};
  r.status = "infeasible";
  r.reason = "the design violates a constraint";
  LeastSquares fit;
  fit.variables = Eigen::Vector2d(0.5, 0.25);
  fit.covariance = Eigen::Matrix2d{{1e-4, 0}, {0, 4e-4}};
  fit.readings = 10;
  fit.start = 2, fit.end = 1, fit.noise = 0.5;
  r.fit = fit;
  r.identified = {{.name = "hole 'h'", .found = Eigen::Vector3d(1, 2, 0.5)}};
  const std::string text = summary(r);
  expect_narrow(text);
  EXPECT_FALSE(has(text, "status")) << "the line of the optimization says it:\n" << text;
  EXPECT_EQ(section(text, "optimize"),
            "optimize    mma ended after 2 iterations and 0 state solves: infeasible: peak\n"
            "            objective 0  volume fraction 0\n"
            "            h.x 0.5  h.y 0.25\n")
      << "without a history nothing is said of a start, of holes, of bounds";
  EXPECT_TRUE(has(text, "fit         least squares: 2 to 1 over 10 readings, noise 0.5")) << text;
  EXPECT_TRUE(has(text, "fit         h.x 0.5 +- 0.01\nfit         h.y 0.25 +- 0.02\n")) << text;
  EXPECT_TRUE(has(text, "found       hole 'h': ")) << text;
  r.status = "stalled";
  EXPECT_TRUE(has(summary(r), "status      stalled: the design violates a constraint\n"));
}

}  // namespace
}  // namespace kerf::summary_test
