#pragma once
// `kerf bench hard`: numerical stability. Families of cases with a knob, and how many digits are lost as it is turned.

#include "bench/command/bench.hpp"
#include "kerf/types.hpp"

namespace kerf {

/// Held: the error is below the limit. Told: it is not, and the status or a note of the run says that digits are lost.
/// Refused: exit code 2, 3 or 4 with a sentence, as on record. Silent: a wrong answer that nobody is told of.
/// Regressed: refused or told where the record has an answer.
enum class HardVerdict { Held, Told, Refused, Silent, Regressed };
const char* name_of(HardVerdict verdict);
constexpr bool is_failure(HardVerdict verdict) {
  return verdict == HardVerdict::Silent || verdict == HardVerdict::Regressed;
}

struct HardRow {
  std::string family, label;          // what the value of the knob is called
  double value = 0;                   // of the knob
  int exit = 0;                       // as of kerf solve
  std::string said;                   // why it was refused, or which digits are left
  double error = nan, digits = nan;   // relative, against the truth of the family; lost against the benign row
  double allowed = nan;               // of the error
  double estimated = nan;             // what the run itself thinks of its stress
  double residual = nan, work = nan;  // of equilibrium and contact, of the work: as the run certifies them
  double seconds = 0, slower = 1;     // and against the benign row
  Index triangles = 0;
  HardVerdict verdict = HardVerdict::Held;
};

struct HardBench {
  std::vector<HardRow> rows;
  bool quick = false, stopped = false;
};

/// Runs every row in this process through the case reader as kerf solve would, writes the cases under cases/, hard.csv,
/// hard.json, hard.md, hard.png, and returns what they hold. Quick: a few values of each knob. Throws Error(Files).
HardBench run_hard_bench(const BenchOptions& options);

/// How many rows are failures.
std::size_t failures(const HardBench& bench);

/// The table that a terminal shows.
std::string summary(const HardBench& bench);

/// Names that --case takes.
std::vector<std::string> hard_case_names();

}  // namespace kerf
