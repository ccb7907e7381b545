// Checkpoints of designs that hold something else than this program writes: refused in words, never used.

#include "optimize/checkpoint.hpp"

#include "kerf/optimize.hpp"
#include "tests/optimize/designs.hpp"
#include "tests/support/folder.hpp"

#include <gtest/gtest.h>

namespace kerf::resume_test {
namespace {

using namespace scenes;
using Eigen::VectorXd;

/// A plate with a hole that may move a little.
Problem plate() {
  Problem p;
  p.frame = rectangle({-1, -1}, {1, 1});
  p.scene = pulled(plane_strain(1, 0.3), [](const Vec2& x) { return Vec2(0, 1 + 0.3 * x.x()); });
  p.scene.laws.clear();
  p.sizing.size = 0.4;
  p.objective = {"compliance", {compliance()}};
  return p;
}
OptimizeRequest hole(int starts) {
  OptimizeRequest r{.method = OptimizeMethod::Mma, .max_iterations = 4, .starts = starts};
  r.volume_at_most = 0.97;
  r.design.drawn = {drawn(Drawn::Kind::Circle, "h", Eigen::Vector3d(0.1, 0.1, 0.3), 0.2)};
  return r;
}

class Resume : public testing::Test {
 protected:
  const Problem p = plate();
  const test::Folder folder;
  const CheckpointPlace place{folder.path / "checkpoint", "case", true};

  Checkpoint written(const OptimizeRequest& r) const {
    optimize_parameters(p, r, {}, place);
    return *read_checkpoint(place.path);
  }
  /// What going on from it says.
  std::string complaint(const OptimizeRequest& r, const Checkpoint& c, Fault fault = Fault::Files) const {
    write_checkpoint(place.path, c);
    try {
      optimize_parameters(p, r, {}, place);
    } catch (const Error& error) {
      EXPECT_EQ(error.fault, fault) << error.what();
      return error.what();
    }
    return {};
  }
};
const std::string broken = "the checkpoint does not hold what this program writes; start without --resume";

TEST_F(Resume, NumbersThatDoNotFitAreRefused) {
  const OptimizeRequest r = hole(0);
  const Checkpoint good = written(r);
  const std::string key = "trial 000000";
  const VectorXd trial = good.numbers.at(key);
  EXPECT_EQ(complaint(r, good), "");
  const auto with = [&](Eigen::Index i, double x) {
    Checkpoint c = good;
    c.numbers[key][i] = x;
    return complaint(r, c);
  };
  // Which mesh it was, how many numbers there are.
  for (const Eigen::Index i : {0, 1, 7, 8, 9, 10})
    for (const double x : {nan, infinity}) EXPECT_EQ(with(i, x), broken) << i << ' ' << x;
  for (const Eigen::Index i : {8, 9, 10})
    for (const double x : {-1.0, 1e9, 1e300, 4611686018427387904.0}) EXPECT_EQ(with(i, x), broken) << i << ' ' << x;
  EXPECT_EQ(with(10, trial[10] + 1), broken);  // a column of slopes too many
  Checkpoint cut = good;
  cut.numbers[key] = trial.head(10);
  EXPECT_EQ(complaint(r, cut), broken);
  cut.numbers[key] = VectorXd();
  EXPECT_EQ(complaint(r, cut), broken);
}

TEST_F(Resume, ARunThatIsNotTheSameIsNamed) {
  const OptimizeRequest r = hole(0);
  const Checkpoint good = written(r);
  Checkpoint moved = good;
  VectorXd& trial = moved.numbers.at("trial 000000");
  trial[11] += 1e-3;  // the first variable
  const std::string text = complaint(r, moved);
  EXPECT_EQ(text.rfind("evaluation 1 of the checkpoint ", 0), 0u) << text;
  EXPECT_NE(text.find("is not the one that this run makes"), std::string::npos) << text;
  // With a value for a bound that the case has not.
  Checkpoint more = good;
  VectorXd longer(good.numbers.at("trial 000000").size() + 1);
  const VectorXd& was = good.numbers.at("trial 000000");
  longer << was.head(11), 1.0, was.tail(was.size() - 11);
  longer[8] = 1;
  more.numbers["trial 000000"] = longer;
  EXPECT_NE(complaint(r, more).find("is not the one that this run makes"), std::string::npos);
  Checkpoint other = good;
  other.texts.erase("method");
  EXPECT_EQ(complaint(r, other), broken);
  other.texts["method"] = "slsqp";
  EXPECT_NE(complaint(r, other, Fault::Usage).find("belongs to another case or method"), std::string::npos);
  // The note of the check may be missing: it is made again.
  Checkpoint unchecked = good;
  unchecked.texts.erase("checked");
  unchecked.numbers.erase("checked");
  EXPECT_EQ(complaint(r, unchecked), "");
}

TEST_F(Resume, StartsThatDoNotFitAreRefused) {
  const OptimizeRequest r = hole(2);
  const Checkpoint good = written(r);
  ASSERT_TRUE(good.numbers.contains("start 000001"));
  const auto with = [&](const std::function<void(VectorXd&)>& change) {
    Checkpoint c = good;
    for (const char* key : {"start 000000", "start 000001"}) change(c.numbers.at(key));
    return complaint(r, c);
  };
  EXPECT_EQ(with([](VectorXd&) {}), "");
  EXPECT_EQ(with([](VectorXd& v) { v.conservativeResize(4); }), broken);
  EXPECT_EQ(with([](VectorXd& v) { v.resize(0); }), broken);
  EXPECT_EQ(with([](VectorXd& v) { v[5] = -1; }), broken);
  EXPECT_EQ(with([](VectorXd& v) { v[5] = 100; }), broken);
  EXPECT_EQ(with([](VectorXd& v) { v[5] = nan; }), broken);
  EXPECT_EQ(with([](VectorXd& v) { v[3] = nan; }), broken);
  EXPECT_EQ(with([](VectorXd& v) { v[2] = 0; }), broken);                            // none went on
  EXPECT_EQ(with([](VectorXd& v) { v.conservativeResize(v.size() - 1); }), broken);  // a variable too few
}

}  // namespace
}  // namespace kerf::resume_test
