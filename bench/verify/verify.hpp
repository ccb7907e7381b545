#pragma once
// `kerf bench verify`: the validation manual, run.

#include "bench/command/bench.hpp"
#include "bench/verify/manual.hpp"
#include "kerf/types.hpp"

namespace kerf {

struct VerifyOptions {
  BenchOptions bench;           // quick: only the benchmarks that are; the second computations are left out
  std::filesystem::path pages;  // where the pages of the manual go; empty: into the folder of the bench
};

/// What was found for a value of the manual. Not a number: nothing.
struct VerifiedValue {
  double measured = nan;
  double error_bar = nan;  // how far the second computation is away
  double deviation = nan;  // relative, or of the value itself where the tolerance is
  bool within = true;      // or nothing to compare with
};

struct VerifiedEntry {
  ManualEntry entry;
  std::string verdict;                // "within", "outside", "not possible"
  std::string trouble;                // why there are no values, although there is a case
  std::vector<VerifiedValue> values;  // of the entry; none where it is not possible or failed
  Index triangles = 0;                // of the first run
  double seconds = 0;                 // of processor time, all runs
  bool has_picture = false;           // <id>.png lies beside the page
};

struct VerifyBench {
  std::vector<VerifiedEntry> entries;
  bool stopped = false;
};

/// Runs the benchmarks; writes verify.csv, verify.json, and the pages: index.md, <id>.md, <id>.png. Throws
/// Error(Files), and Error(Usage) where the data are wrong.
VerifyBench run_verify_bench(const VerifyOptions& options);

/// The table that a terminal shows.
std::string summary(const VerifyBench& bench);

/// Deviation and verdict of what was measured, where something is published.
void judge(const ManualValue& value, VerifiedValue& found);

/// How many have the verdict.
int count(const VerifyBench& bench, std::string_view verdict);

/// Deviation and tolerance as people read them: in percent, or as they are.
std::string deviation_text(const ManualValue& value, const VerifiedValue& found);
std::string tolerance_text(const ManualValue& value);

}  // namespace kerf
