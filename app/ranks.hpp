#pragma once
// The processes that mpiexec started. The first one runs the program; the others condense and solve their parts when it
// asks them to, and hold nothing else.

#include "solver/ranks.hpp"

namespace kerf {

/// How many mpiexec started, as the environment says; 1 without it.
int started_processes();

/// The program that runs, with the same arguments, as `count` processes by mpiexec; waits for their end. Returns their
/// exit code. One that is killed ends all of them: then throws Error(Files), as when mpiexec cannot be started.
int run_by_mpiexec(int count, char** argv);

/// From the first process to the last of its calls: starts what backend = "petsc" needs when it is first asked for.
class Processes {
 public:
  Processes() = default;
  Processes(const Processes&) = delete;
  Processes& operator=(const Processes&) = delete;
  ~Processes();  // tells the others that there is no more to do

  /// Loads the module and starts MPI. Throws Error(Usage) when there is none. Returns the number of this process.
  int start();
  /// Of all but the first: works until there is no more to do.
  void serve();
  /// Of the first: with further options of PETSc, as on a command line. Throws Error(Usage) for what is none.
  std::shared_ptr<Ranks> ranks(const std::string& options);

 private:
  int rank_ = -1, count_ = 1;
};

}  // namespace kerf
