#pragma once
// The processes that mpiexec started. The first one runs the program; the others condense and solve their parts when it
// asks them to, and hold nothing else.

#include "solver/spread.hpp"

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
  /// Of all but the first: works until there is no more to do. `with`: what `work` asks the others for.
  void serve(const std::function<void(std::string_view task, Peers&)>& with = {});
  /// Of the first: with further options of PETSc, as on a command line. Throws Error(Usage) for what is none.
  std::shared_ptr<Ranks> ranks(const std::string& options);
  /// Of the first, after `ranks`: all others begin to work at this task, and this one with them. What one process fails
  /// in ends all of them.
  void work(const std::string& task, const std::function<void(Peers&)>& own);
  int count() const {
    return count_;
  }

 private:
  int rank_ = -1, count_ = 1;
  std::string options_;  // that a user gave PETSc
};

}  // namespace kerf
