// A sample of validation as sentences, table and chart, against the text to quote.

#include "io/validation.hpp"

#include "io/files.hpp"
#include "plot/charts.hpp"
#include "tests/support/sample.hpp"

#include <sstream>

namespace kerf::validation_test {
namespace {

TEST(Validation, SentencesToQuote) {
  const std::vector<Validation> v = test::sample_validation().points;
  EXPECT_EQ(sentence(v[0]),
            "At (0.5, 0.8) the expansion holds: J(eps) - J(0) = pi eps^2 (-1.234 + 5.6 eps^2 - 0.7 eps^2 ln eps), "
            "observed order 4.02, intercept within 0.03 % of T.");
  EXPECT_EQ(sentence(v[1]),
            "At (-0.4, 0.6) the expansion fails: the remainder falls with order 2, not 4; T = -1.234, intercept "
            "-1.23437, observed order 2.00.");
  EXPECT_EQ(sentence(v[2]), "At (3, 0) out of range: the point lies outside the body.");
}

TEST(Validation, SentencesWithoutWhatIsNotKnown) {
  Validation v{.at = {0, 0}, .coefficient = 0, .order = std::nan(""), .intercept = 1e-9};
  v.verdict = Verdict::Holds;
  EXPECT_EQ(sentence(v),
            "At (0, 0) the expansion holds: J(eps) - J(0) = pi eps^2 (0), no observed order, intercept "
            "1e-09.");
  v.coefficient = v.intercept = v.c2 = std::nan("");
  v.order = 1.9;
  EXPECT_EQ(sentence(v), "At (0, 0) the renormalized prediction holds: observed order 1.90.");
  v.verdict = Verdict::OutOfRange;
  EXPECT_EQ(sentence(v), "At (0, 0) out of range.");
  v.verdict = Verdict::NothingSaid;
  EXPECT_EQ(sentence(v), "At (0, 0) nothing can be said.");
  v.verdict = Verdict::Vanishes;
  EXPECT_EQ(sentence(v), "At (0, 0) the expansion vanishes.");
}

TEST(Validation, CsvHasARowPerPointAndRadius) {
  const test::Folder folder;
  write_validation_csv(folder.path / "validate.csv", test::sample_validation());
  std::istringstream lines(read_file(folder.path / "validate.csv"));
  std::vector<std::string> all;
  for (std::string line; std::getline(lines, line);) all.push_back(line);
  ASSERT_EQ(all.size(), 7u);
  EXPECT_EQ(all[0],
            "point,x,y,radius,J,J0,difference,predicted,remainder,order,coefficient,intercept,on_mesh,bar,independent,"
            "c2,c2_predicted,predicted_second,remainder_second,order_second,verdict,reason");
  EXPECT_EQ(all[1].substr(0, 14), "1,0.5,0.8,0.2,");
  std::vector<double> first;
  std::istringstream cells(all[1]);
  for (std::string cell; std::getline(cells, cell, ',') && first.size() < 9;) first.push_back(std::stod(cell));
  EXPECT_NEAR(first[5], -10, 1e-14);
  EXPECT_NEAR(first[6] - first[7] - first[8], 0, 1e-15);
  EXPECT_EQ(all[1].substr(all[1].find(",4,"), 32), ",4,-1.234,-1.2343702,,,,5.6,5.59");
  EXPECT_EQ(all[1].substr(all[1].find(",1e-05,5.9,")), ",1e-05,5.9,holds,orders 4.01 and 4.03");
  EXPECT_EQ(all[3].substr(all[3].find(",,")), ",,-1.234,-1.2343702,,,,5.6,5.59,,,,holds,orders 4.01 and 4.03");
  EXPECT_EQ(all[4].substr(0, 3), "2,-");
  EXPECT_NE(all[6].find(",fails,\"the remainder falls with order 2, not 4\""), std::string::npos);
}

TEST(Validation, ChartShowsRemaindersAndForAFewPointsDifferences) {
  ValidationResult r = test::sample_validation();
  const Chart few = validation_chart(r, "Plate");
  EXPECT_EQ(few.title, "Plate");
  ASSERT_EQ(few.series.size(), 6u);
  EXPECT_EQ(few.series[0].name, "remainder at (0.5, 0.8), order 4.02");
  EXPECT_EQ(few.series[1].name, "difference at (0.5, 0.8)");
  EXPECT_TRUE(few.series[1].dashed && !few.series[0].dashed);
  EXPECT_EQ(few.series[0].style, few.series[1].style);
  EXPECT_NE(few.series[0].style, few.series[2].style);
  ASSERT_EQ(few.series[0].points.size(), 3u);
  EXPECT_DOUBLE_EQ(few.series[0].points[0].y(), 5 * std::pow(0.2, 4));
  ASSERT_EQ(few.slopes.size(), 2u);
  EXPECT_EQ(few.slopes[0].exponent, 2);
  EXPECT_EQ(few.slopes[1].exponent, 4);
  for (int k = 0; k < 40; ++k) r.points.push_back(r.points[0]);
  const Chart many = validation_chart(r, "Plate");
  EXPECT_EQ(many.series.size(), 24u);
  EXPECT_NE(many.subtitle.find("the first 24 of 43 points"), std::string::npos);
  const test::Folder folder;
  draw(folder.path / "validate.png", many);
  EXPECT_GT(std::filesystem::file_size(folder.path / "validate.png"), 5000u);
}

TEST(Validation, Words) {
  using Kind = Perturbation::Kind;
  EXPECT_EQ(word(Kind::Hole), "hole");
  EXPECT_EQ(word(Kind::ClampedHole), "clamped_hole");
  EXPECT_EQ(word(Kind::Inclusion), "inclusion");
  EXPECT_EQ(word(Kind::Ellipse), "ellipse");
  EXPECT_EQ(word(Kind::Crack), "crack");
}

}  // namespace
}  // namespace kerf::validation_test
