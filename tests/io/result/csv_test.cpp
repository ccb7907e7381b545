// Tables of results: every column, what an empty cell is for, what readers of CSV need quotes for.

#include "io/csv.hpp"

#include "io/files.hpp"
#include "io/validation.hpp"
#include "tests/support/sample.hpp"

#include <algorithm>
#include <sstream>

namespace kerf::csv_test {
namespace {

using test::Folder;

std::string written(const std::function<void(const std::filesystem::path& path)>& write) {
  const Folder folder;
  write(folder.path / "a.csv");
  return read_file(folder.path / "a.csv");
}

TEST(Csv, TableWithEmptyCellsAndFullDigits) {
  const Folder folder;
  const auto path = folder.path / "probe.csv";
  write_csv(path, {"x", "y", "a,b"}, {{0, -0.5, 1.0 / 3}, {std::nan(""), 1e-300, 1234567890123456.5}});
  EXPECT_EQ(read_file(path), "x,y,\"a,b\"\n0,-0.5,0.3333333333333333\n,1e-300,1234567890123456.5\n");
  EXPECT_THROW(write_csv(path, {"x"}, {{1, 2}}), std::invalid_argument);
}

TEST(Csv, CrackColumnsAndStatusWords) {
  const Folder folder;
  CrackResult crack;
  crack.rows = {{0, {-1, 0}, 0, 0.25, -2, 0.125, true}, {0.5, {-0.5, 0}, 0.1, 0, std::nan(""), 0, false}};
  write_crack_csv(folder.path / "crack_c.csv", crack);
  EXPECT_EQ(read_file(folder.path / "crack_c.csv"),
            "s,x,y,jump_n,jump_t,sigma_n,sigma_t,status\n0,-1,0,0,0.25,-2,0.125,closed\n0.5,-0.5,0,0.1,0,,0,open\n");
}

TEST(Csv, CracksWithFluidAndGapHaveTheirColumns) {
  CrackResult crack;
  crack.rows = {{0, {-1, 0}, 0, 0.25, -2, 0.125, true, 1.5, 0.0625}};
  const auto table = [&] { return written([&](const auto& path) { write_crack_csv(path, crack); }); };
  const std::string head = "s,x,y,jump_n,jump_t,sigma_n,sigma_t,status", row = "0,-1,0,0,0.25,-2,0.125,closed";
  crack.has_gap = true;
  EXPECT_EQ(table(), head + ",gap\n" + row + ",0.0625\n");
  crack.fluid_pressure = 1.5;
  EXPECT_EQ(table(), head + ",fluid_pressure,gap\n" + row + ",1.5,0.0625\n");
  crack.has_gap = false;
  EXPECT_EQ(table(), head + ",fluid_pressure\n" + row + ",1.5\n");
}

TEST(Csv, BoundsSayWhereAndOfWhatTheyAre) {
  const Bounded sure{2, 1.5, 2.5, true, ""}, unknown{nan, nan, nan, false, "no bound, \"yet\""};
  BoundsResult b;
  b.tips = {{"c,d", true, {1, 2}, sure, unknown, sure}, {"e", false, {3, 4}, sure, sure, sure}};
  b.points = {{{5, 6}, sure, sure, unknown, sure, sure}};
  using enum BoundedMean::Of;
  b.means = {{.of = Disc, .from = {1, 2}, .to = {1, 2}, .radius = 0.5, .quantities = {sure}},
             {.of = Line, .from = {1, 2}, .to = {3, 4}, .radius = 9, .quantities = {sure, unknown}},
             {.of = Displacement, .on = "top", .from = {7, 7}, .to = {8, 8}, .quantities = {sure}},
             {.of = Loads, .quantities = {sure}}};
  EXPECT_EQ(written([&](const auto& path) { write_bounds_csv(path, b); }),
            R"(quantity,crack,tip,x,y,value,lower,upper,guaranteed,note,on,radius,to_x,to_y
K_I,"c,d",start,1,2,2,1.5,2.5,yes,,,,,
K_II,"c,d",start,1,2,,,,no,"no bound, ""yet""",,,,
G,"c,d",start,1,2,2,1.5,2.5,yes,,,,,
K_I,e,end,3,4,2,1.5,2.5,yes,,,,,
K_II,e,end,3,4,2,1.5,2.5,yes,,,,,
G,e,end,3,4,2,1.5,2.5,yes,,,,,
s_xx,,,5,6,2,1.5,2.5,yes,,,,,
s_yy,,,5,6,2,1.5,2.5,yes,,,,,
s_xy,,,5,6,,,,no,"no bound, ""yet""",,,,
von_mises,,,5,6,2,1.5,2.5,yes,,,,,
topological_derivative,,,5,6,2,1.5,2.5,yes,,,,,
s_xx,,,1,2,2,1.5,2.5,yes,,,0.5,,
s_nn,,,1,2,2,1.5,2.5,yes,,,,3,4
s_nt,,,1,2,,,,no,"no bound, ""yet""",,,3,4
u_x,,,,,2,1.5,2.5,yes,,top,,,
compliance,,,,,2,1.5,2.5,yes,,,,,
)");
}

TEST(Csv, StepsNumberTheTipsOfACrack) {
  std::vector<StepResult> steps(2);
  steps[0] = {.values = {{"p", 0.5}, {"q", -1}}, .energy = 1, .strain_energy = 2, .work = 3, .dissipation = 4};
  steps[0].imbalance = nan;  // of the first nothing is known
  steps[0].open_length = 5, steps[0].closed_length = 6, steps[0].stick_length = 7, steps[0].slip_length = 8;
  steps[0].tips = {{"c", {0, 0}, 1.5, {}}, {"d", {1, 1}, 2.5, 0.25}, {"c", {2, 0}, {}, -0.5}};
  steps[1] = steps[0];
  steps[1].part = 1, steps[1].parts = 2;
  steps[1].tips[0] = {"c", {0, 0}, {}, 9};
  EXPECT_EQ(written([&](const auto& path) { write_steps_csv(path, steps); }),
            "step,p,q,energy,strain_energy,work,dissipation,imbalance,open_length,closed_length,stick_length,"
            "slip_length,K_I_c_1,K_II_c_1,K_I_d_1,K_II_d_1,K_I_c_2,K_II_c_2\n"
            "1,0.5,-1,1,2,3,4,,5,6,7,8,1.5,,2.5,0.25,,-0.5\n"
            "1.5,0.5,-1,1,2,3,4,,5,6,7,8,,9,2.5,0.25,,-0.5\n");
}

TEST(Csv, ValidationsHaveARowPerRadius) {
  const std::string table = written([](const auto& path) { write_validation_csv(path, test::sample_validation()); });
  std::istringstream lines(table);
  std::vector<std::string> all;
  for (std::string line; std::getline(lines, line);) all.push_back(line);
  ASSERT_EQ(all.size(), 7u) << "the third point has no rows";
  EXPECT_EQ(all[0],
            "point,x,y,radius,J,J0,difference,predicted,remainder,order,coefficient,intercept,on_mesh,bar,independent,"
            "c2,c2_predicted,predicted_second,remainder_second,order_second,verdict,reason");
  for (const std::string& line : all) EXPECT_EQ(std::ranges::count(line.substr(0, line.find('"')), ','), 21) << line;
  EXPECT_TRUE(all[1].starts_with("1,0.5,0.8,0.2,")) << all[1];
  EXPECT_TRUE(all[1].ends_with(",5.6,5.59," +
                               fmt::format("{}", test::sample_validation().points[0].rows[0].predicted_second) +
                               ",1e-05,5.9,holds,orders 4.01 and 4.03"))
      << all[1];
  EXPECT_TRUE(all[3].ends_with(",5.6,5.59,,,,holds,orders 4.01 and 4.03")) << all[3];
  EXPECT_TRUE(all[6].starts_with("2,-0.4,0.6,0.05,")) << all[6];
  EXPECT_TRUE(all[6].ends_with(",fails,\"the remainder falls with order 2, not 4\"")) << all[6];
}

TEST(ValidationInWords, EveryVerdict) {
  Validation v{.at = {1, 2}, .coefficient = 2, .order = 4, .intercept = 2.002, .c2 = 0.5, .c3 = nan};
  v.verdict = Verdict::Holds;
  EXPECT_EQ(sentence(v),
            "At (1, 2) the expansion holds: J(eps) - J(0) = pi eps^2 (2 + 0.5 eps^2), observed order 4.00, "
            "intercept within 0.1 % of T.");
  v.bar = 0.1;
  v.reason = "the bar is 0.1";
  v.coefficient = 0;
  v.c2 = 0;
  v.c3 = -3;
  v.order = nan;
  EXPECT_EQ(sentence(v),
            "At (1, 2) the expansion holds: J(eps) - J(0) = pi eps^2 (0 - 3 eps^2 ln eps), no observed "
            "order, intercept 2.002; the bar is 0.1.");
  v.intercept = nan;
  v.bar = nan;
  EXPECT_EQ(sentence(v),
            "At (1, 2) the expansion holds: J(eps) - J(0) = pi eps^2 (0 - 3 eps^2 ln eps), no observed "
            "order.");
  v.coefficient = nan;  // of a clamped hole
  v.order = 2;
  EXPECT_EQ(sentence(v), "At (1, 2) the renormalized prediction holds: observed order 2.00.");
  v.verdict = Verdict::Fails;
  EXPECT_EQ(sentence(v), "At (1, 2) the renormalized prediction fails: the bar is 0.1; observed order 2.00.");
  v.coefficient = 2;
  v.intercept = 3;
  v.reason = "";
  EXPECT_EQ(sentence(v), "At (1, 2) the expansion fails: T = 2, intercept 3, observed order 2.00.");
  v.verdict = Verdict::Vanishes;
  EXPECT_EQ(sentence(v), "At (1, 2) the expansion vanishes.");
  v.verdict = Verdict::NothingSaid;
  v.reason = "rounding";
  EXPECT_EQ(sentence(v), "At (1, 2) nothing can be said: rounding.");
}

}  // namespace
}  // namespace kerf::csv_test
