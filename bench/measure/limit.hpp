#pragma once
// `kerf bench limit`: how near a run comes to what the machine can do: each phase's time, the flops of the factor
// against dgemm's speed in the same run, memory per triangle, one thread and two, and how all that grows.

#include "bench/command/bench.hpp"
#include "kerf/types.hpp"

namespace kerf {

struct LimitPhase {
  const char* name;
  double wall_s = 0, processor_s = 0;
};

/// One run of the partly closed crack, bdms of degree 1.
struct LimitRow {
  Index triangles = 0;
  int threads = 1;
  std::vector<LimitPhase> phases;
  double factor_flops = 0;  // of the numeric factorization
  double dgemm_rate = 0;    // flops per second of one thread, just before
  double memory_mb = 0;     // peak of the process in the run, the program itself included
  double before_mb = 0;     // what it had before
  bool certified = true;

  double wall() const;
  /// Of a map alone: without what [output] can leave out (estimate, bounds, tips, corners).
  double wall_of_map() const;
  double processor() const;
  /// Seconds that the flops of the factor take at dgemm's speed, on one thread.
  double limit() const {
    return factor_flops / dgemm_rate;
  }
  double bytes_per_triangle() const {
    return 1024 * 1024 * (memory_mb - before_mb) / static_cast<double>(triangles);
  }
};

struct LimitBench {
  std::vector<LimitRow> rows;
  bool stopped = false;
};

/// y ~ n^exponent, least squares of the logarithms over the rows with so many threads; NaN for fewer than two.
double growth_exponent(const LimitBench& bench, int threads, const std::function<double(const LimitRow&)>& of);

/// 10,000, 100,000 and 355,000 triangles, `large`: 1.4 million, too; quick: 1,000 and 2,000. Writes limit.csv,
/// limit.json and limit.png. Throws Error(Files).
LimitBench run_limit_bench(const BenchOptions& options, bool large);

std::string summary(const LimitBench& bench);

/// Names that --case takes.
std::vector<std::string> limit_case_names();

}  // namespace kerf
