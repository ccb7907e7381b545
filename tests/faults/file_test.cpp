// Files that fail: each call that makes, writes, flushes, closes or renames a file of the run fails once, as on a full
// or broken disk.

#include "tests/faults/traced.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <functional>

namespace kerf::fuzz {
namespace {

/// Which of the calls to let fail: of each kind on each file the first and the last.
std::vector<std::size_t> chosen(const std::vector<FileCall>& calls) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < calls.size(); ++i) {
    const auto same = [&](std::size_t j) { return calls[j] == calls[i]; };
    bool before = false, after = false;
    for (std::size_t j = 0; j < i; ++j) before = before || same(j);
    for (std::size_t j = i + 1; j < calls.size(); ++j) after = after || same(j);
    if (!before || !after) out.push_back(i);
  }
  return out;
}

class File : public Faults {
 protected:
  /// What is wrong after one call failed; and the message must say which file.
  std::string after(const Input& input, std::size_t failing, int error, const Outcome& whole) {
    const auto traced = run_traced(folder / "run", input, failing, error);
    if (!traced) return "nobody may trace\n";
    const Outcome& o = traced->outcome;
    refused += o.code == 5;
    const FileCall call = failing < traced->calls.size() ? traced->calls[failing] : FileCall{"none", ""};
    std::string why = unclean(input, o, whole);
    // result.json is written before the page, which may fail: it is then there, whole, and says what it says.
    if (why.starts_with("status and exit code") && o.code == 5 && !numbers_of(o).is_null()) why.clear();
    if (why.empty() && o.code != 0 && o.code != 5) why = fmt::format("exit {}: {}", o.code, o.error);
    if (why.empty() && o.code == 5 && o.error.find("out") == std::string::npos &&
        o.error.find("case.toml") == std::string::npos)
      why = "no file is named: " + o.error;
    return why.empty() ? "" : fmt::format("{} {} (call {}), errno {}: {}\n", call.name, call.path, failing, error, why);
  }
  /// Every `stride`-th of the chosen calls that `wanted` has.
  std::string all_of(const Input& input, std::size_t stride, const std::function<bool(const FileCall&)>& wanted) {
    const auto whole = run_traced(folder / "run", input, {}, 0);
    if (!whole) return "nobody may trace\n";
    if (whole->outcome.code != 0) return whole->outcome.error;
    std::string all;
    std::size_t k = 0;
    for (const std::size_t i : chosen(whole->calls)) {
      if (!wanted(whole->calls[i]) || k++ % stride != 0) continue;
      all += after(input, i, k % 2 == 0 ? ENOSPC : EIO, whole->outcome);
      ++tried;
    }
    return all;
  }
  std::size_t tried = 0, refused = 0;
};

TEST_F(File, EachCallOfARunFailsOnce) {
#if !defined(__x86_64__)
  GTEST_SKIP() << "the tracer knows the registers of x86-64 alone";
#endif
  EXPECT_EQ(all_of(input("map", small_case_with_files()), 1, [](const FileCall&) { return true; }), "");
  EXPECT_GT(tried, 40U);
  EXPECT_GT(refused, tried / 2);  // what is closed after reading, or made again, does no harm
}

TEST_F(File, CallsOfAnOptimizationFailOnce) {
#if !defined(__x86_64__)
  GTEST_SKIP() << "the tracer knows the registers of x86-64 alone";
#endif
  const Input small =
      input("optimize", small_case(),
            {"--set", "output.png=true", "--set", "optimize.max_iterations=1", "--set", "mesh.size=0.4"});
  EXPECT_EQ(all_of(small, 2,
                   [](const FileCall& call) {
                     return call.path.find("checkpoint") != std::string::npos ||
                            call.path.find("design.") != std::string::npos ||
                            call.path.find("history") != std::string::npos;
                   }),
            "");
  EXPECT_GT(tried, 6U);
  EXPECT_GT(refused, tried / 3);
}

}  // namespace
}  // namespace kerf::fuzz
