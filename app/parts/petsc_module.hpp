#pragma once
// What passes between processes.cpp and the module with PETSc and MPI: plain C data, so that the module may be loaded
// late.

#include <cstddef>
#include <cstdint>

extern "C" {

/// What this process has of the matrix, in its own rows, and of what all of them own. The matrix itself is not copied:
/// its arrays must outlive the solver.
struct KerfPetscPart {
  int rows;
  int *start, *columns;  // both triangles
  double* values;
  const double* shift;  // of the diagonal, for the preconditioner alone
  const int* number;    // of its rows among all
  int owned, total;
  const int *near_start, *near_rows;
};

/// What parts share, as an operator and its preconditioner: `rows` here, each of which another process has, too, with
/// the same values on both. Both functions are called by all processes together and return 0, or nonzero where they
/// fail.
struct KerfPetscShared {
  int rows;
  void* context;
  int (*multiply)(void* context, const double* x, double* y);
  int (*precondition)(void* context, const double* r, double* z);
  int parts, primal;  // for -ksp_view
};

struct KerfPetscMade {
  int interface_rows, primal;  // of the unknowns that parts share, of the small problem; 0: PETSc does not say
  int mistaken;                // whether the options are what is wrong
};

struct KerfPetscSolved {
  int iterations, diverged;   // whether KSPConvergedReason is negative
  int indefinite;             // whether it says that the preconditioner or the matrix is indefinite, or made no number
  const char* reason;         // in words of PETSc; constant
  double condition;           // 0: not known
  double left;                // of the residual at first
  double sent;                // bytes that a process sends per iteration, the most of all
  double seconds;             // until the last process is done
  double first_mb, other_mb;  // peaks so far: of the first process, and the largest of the others
};

/// All functions but `wait` and those that say otherwise are called by all processes together. Those that return text
/// return null, or what is wrong; it stays until the next call.
struct KerfPetsc {
  /// Starts MPI and PETSc, with the words of a user. Not together.
  const char* (*start)(int argc, const char* const* argv, int* rank, int* count);
  void (*finish)();
  void (*abort)(int code);  // ends all processes; not together
  /// A message from the first process to another; how long the next one is, waiting without work. Not together.
  void (*send)(int to, const void* bytes, std::size_t count);
  std::size_t (*wait)();
  void (*receive)(void* bytes, std::size_t count);
  /// Of the first process alone: a part per node of a graph.
  const char* (*partition)(int nodes, const int* start, const int* neighbors, int parts, int* part);
  /// Further options, as on a command line; those that are there already stay.
  const char* (*options)(const char* text);
  /// Of the first process alone: names of options of `text` that nothing has used yet, one a line; null: none.
  const char* (*unused)(const char* text);
  /// Whether the options leave it to kerf's BDDC to precondition (-pc_type kerf, the default).
  int (*by_kerf)();
  /// K by what PETSc has for it: BDDC and Neumann-Neumann of its parts, all else of the sum.
  const char* (*make)(const KerfPetscPart* part, double tolerance, void** solver, KerfPetscMade* made);
  /// The system that parts share, preconditioned by -pc_type kerf. `shared` is copied.
  const char* (*make_shared)(const KerfPetscShared* shared, double tolerance, double enough, int most, void** solver,
                             KerfPetscMade* made);
  /// `right` and `x`: of what the process owns, or of the rows here.
  const char* (*solve)(void* solver, const double* right, double* x, KerfPetscSolved* how);
  void (*drop)(void* solver);
  /// Events of -log_view begin and end (Communicator::Work). Not together.
  void (*log)(int event, int begins);
  /// Over processes, the same bits on all.
  void (*sum)(double* values, std::size_t count);
  void (*largest)(double* values, std::size_t count);
  /// Bytes from each process to each: how many come, then the bytes.
  void (*sizes)(const std::size_t* to, std::size_t* from);
  void (*swap)(const void* const* to, const std::size_t* to_count, void* const* from, const std::size_t* from_count);
};
using KerfPetscModule = const KerfPetsc* (*)();
}
