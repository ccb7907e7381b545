#pragma once
// What iterative solves cost.

namespace kerf {

struct SolverEffort {
  int parts = 0, solves = 0;
  int iterations = 0;                  // the most of a solve
  double condition = 0;                // largest estimate
  int interface_rows = 0, primal = 0;  // unknowns that parts share, and those of the small problem; 0: not known
  double sent = 0;                     // bytes that a process sends per iteration, the most of all
  double seconds = 0;                  // of the solves
  double first_mb = 0, other_mb = 0;   // peaks so far: of the first process, the largest of the others
};

}  // namespace kerf
