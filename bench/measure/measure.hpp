#pragma once
// One solution of a problem, measured: what it costs and how far it is from the truth.

#include "bench/measure/problem.hpp"

namespace kerf {

/// Processor seconds of this process: what other processes do to the machine does not count.
double processor_seconds();

class ProcessorWatch {
 public:
  double lap() {
    const double now = processor_seconds(), lap = now - start_;
    start_ = now;
    return lap;
  }

 private:
  double start_ = processor_seconds();
};

/// Peak of the resident memory since `forget_peak_memory`, which also hands freed memory back.
double peak_memory_mb();
void forget_peak_memory();

struct PhaseSeconds {
  double mesh = 0, assemble = 0, factor = 0;  // assemble: numbering, ordering, condensation and assembly
  double solve = 0;                           // both substitutions, contact, and the stress in every triangle
  double contact = 0;                         // of solve, wall clock
  double recover = 0;                         // u*, which the stress does not need
  double work() const {                       // until the stress is known everywhere
    return mesh + assemble + factor + solve;
  }
};

struct StateMeasurement {
  std::string problem;
  double poisson = 0;
  std::string element;
  int degree = 1;
  std::string mesh;  // "uniform", "graded", "adaptive"
  double level = 0;
  double h = 0;  // longest edge
  Index triangles = 0, unknowns = 0, condensed_unknowns = 0;
  PhaseSeconds seconds;
  double memory_mb = 0;  // peak of the process in the run, the program itself included
  Errors error;
  int contact_iterations = 0;
  bool certified = true;
};

/// On one thread, as far as the stress.
struct TimedState {
  Model model;
  State state;
  PhaseSeconds seconds;
};
TimedState timed_state(const MeshPlan& plan, const Element& e, const Scene& scene);

/// On one thread. Runs below a second are made `repeat` times and the one of median work is returned. Throws what the
/// solver throws.
StateMeasurement measure(const BenchProblem& problem, const Element& e, Grading grading, double level, int repeat = 3);

std::string_view name_of(Grading grading);

}  // namespace kerf
