#pragma once
// The processes that mpiexec started. The first one runs the program; the others work with it at tasks that it gives
// them, and hold nothing else.

#include "solver/divided_body.hpp"

#include <optional>

namespace kerf {

/// How many a launcher started, as the environment says; 1 without it. Some launchers do not say it: is_launched.
int started_processes();
/// Whether a launcher started this process.
bool is_launched();

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

  /// Options of PETSc that stand behind -- on the command line; before `start`.
  void take_words(std::vector<std::string> words) {
    words_ = std::move(words);
  }
  /// Throws Error(Usage) where they do not begin with one.
  void check_words() const;
  const std::vector<std::string>& words() const {
    return words_;
  }
  /// Throws Error(Usage) without PETSc.
  static void require();
  /// Loads the module and starts MPI. Throws Error(Usage) when there is none, or when MPI does not know of as many
  /// processes as the launcher has started. Returns the number of this process.
  int start();
  /// Of all but the first: works until there is no more to do. `work`: what `work` asks the others for. `why`: words
  /// for a stop that was asked for.
  void serve(const std::function<void(std::string_view task, Communicator&)>& with = {},
             const std::function<std::optional<std::string>()>& why = {});
  /// Of the first: further options of PETSc, as on a command line, for all. Throws Error(Usage) for what is none.
  void take_options(const std::string& options);
  /// Of the first: for as many parts as there are processes.
  std::vector<Index> partition(const std::vector<Index>& start, const std::vector<Index>& neighbors) const;
  /// Of the first: all others begin to work at this task, and this one with them. What one process fails
  /// in ends all of them.
  void work(const std::string& task, const std::function<void(Communicator&)>& own);
  /// As MPI knows it once it was started, before that as the launcher says.
  int count() const {
    return rank_ < 0 ? started_processes() : count_;
  }
  /// Whether kerf's BDDC preconditions, and not what options of PETSc ask for; after `take_options`.
  bool by_kerf() const;
  /// Where the first process has left work in which the others wait for it: says this, and ends all. Else it returns.
  void end_what_waits(const std::string& words) const;

 private:
  void refuse_unused_options() const;

  int rank_ = -1, count_ = 1;
  bool at_work_ = false;
  std::vector<std::string> words_;
  std::string options_;  // of the case
};

}  // namespace kerf
