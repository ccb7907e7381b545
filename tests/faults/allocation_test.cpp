// Memory that is not there: one allocation fails, or all from one on.

#include "tests/faults/faults.hpp"

#include <fmt/format.h>

#include <cmath>
#include <set>

namespace kerf::fuzz {
namespace {

class Allocation : public Faults {
 protected:
  void SetUp() override {
#ifdef KERF_SANITIZED
    GTEST_SKIP() << "sanitizers bring an allocator of their own";
#endif
    Faults::SetUp();
  }
  /// How many allocations the run makes.
  long count(Input input) const {
    input.environment = {"LD_PRELOAD=" KERF_FAULTS_LIBRARY, "KERF_COUNT_ALLOCATIONS=count"};
    const Outcome o = run(input);
    const auto found = o.files.find("count");
    return found == o.files.end() ? 0 : std::stol(found->second);
  }
  std::string failing(Input input, const std::string& which, const Outcome& whole) const {
    input.environment = {"LD_PRELOAD=" KERF_FAULTS_LIBRARY, "KERF_FAIL_ALLOCATION=" + which};
    const std::string why = unclean(input, run(input), whole);
    return why.empty() ? "" : fmt::format("allocation {}: {}\n", which, why);
  }
  /// The first of the first 2,000, and from there one in so many, fails once, each in a run of its own.
  void expect_clean_every(long step) const {
    const Input small = input("solve", small_case());
    const Outcome whole = run(small);
    ASSERT_EQ(whole.code, 0) << whole.error;
    ASSERT_GT(count(small), 10000);
    std::string all;
    for (long n = 1; n <= 2000; n += step) all += failing(small, std::to_string(n), whole);
    EXPECT_EQ(all, "");
  }
};

/// Of all, more at the beginning than at the end.
std::set<long> spread(long first, long last, int number) {
  std::set<long> out;
  for (int k = 0; k < number; ++k)
    out.insert(std::lround(static_cast<double>(first) *
                           std::pow(static_cast<double>(last) / static_cast<double>(first), (k + 0.5) / number)));
  return out;
}

TEST_F(Allocation, EachOfTheFirstTwoThousandFailsOnce) {
  expect_clean_every(1);
}

TEST_F(Allocation, TwoHundredOfTheFirstTwoThousandFailOnce) {
  expect_clean_every(10);
}

// Without pictures and fields: VTK 9.1 and fontconfig 2.14 use what malloc gave without looking, and crash.
TEST_F(Allocation, OneLaterOnFails) {
  const Input small = input("solve", small_case());
  const Outcome whole = run(small);
  ASSERT_EQ(whole.code, 0) << whole.error;
  std::string all;
  for (const long n : spread(2000, count(small), 40)) all += failing(small, std::to_string(n), whole);
  EXPECT_EQ(all, "");
}

TEST_F(Allocation, AllFailFromOneOn) {
  const Input small = input("run", small_case());
  const Outcome whole = run(small);
  ASSERT_EQ(whole.code, 0) << whole.error;
  std::string all;
  for (const long n : spread(1, count(small), 50)) all += failing(small, std::to_string(n) + "+", whole);
  EXPECT_EQ(all, "");
}

}  // namespace
}  // namespace kerf::fuzz
