#pragma once
// `kerf bench machines`: conjugate gradients with BDDC on several processes: iterations, conditions, what is sent,
// memory, time, and whether the answer is that of a factor.

#include "bench/command/bench.hpp"
#include "kerf/types.hpp"

namespace kerf {

class Communicator;
class Processes;

/// A square held on its left side and pulled on its right, in `parts` of about H/h edges across each.
struct MachineRow {
  std::string family;
  int parts = 0;
  std::string element;
  int degree = 1;
  double poisson = 0.3, contrast = 1;
  int cracks = 0;
  double across = 0;  // H/h
  Index triangles = 0, unknowns = 0;
  int iterations = 0;  // the most of a solve
  double condition = nan;
  int interface_unknowns = 0, primal_unknowns = 0;
  double sent = 0;                                  // bytes per iteration, of the process that sends most
  double first_mb = 0, others_mb = 0;               // peaks so far
  double parts_s = 0, iterate_s = 0, factor_s = 0;  // wall: parts made; a solve; the factor of one process
  double off = nan;                                 // of the strain energy, against that of the factor
  std::string refused = {};                         // why there is no state

  /// Within 30 iterations, 30 of condition, 1e-9 of the factor's energy.
  bool met() const;
};

struct MachineBench {
  std::vector<MachineRow> rows;
  std::vector<std::string> notes;
  bool quick = false, stopped = false;
};

/// "table": parts by nu by degree of bdms, whole and cracked; "elements": afw, on up to 16; "sizes": H/h grows;
/// "contrast": inclusions across parts, stiff and soft; "scaling": one mesh on ever more parts, and ever more parts of
/// one size. Under mpiexec on the processes that it started, else on 4, 9, 16, 32 and 64 that this program starts by
/// mpiexec itself. Writes machines.csv, machines.json and machines.png. Throws Error(Files), Error(Usage) without
/// PETSc.
MachineBench run_machine_bench(const BenchOptions& options, Processes& processes);

/// Of the others: their part of a row, of which the first process tells them.
void work_on_machine_row(std::string_view task, Communicator& comm);

std::string summary(const MachineBench& bench);

/// Names that --case takes.
std::vector<std::string> machine_case_names();

}  // namespace kerf
