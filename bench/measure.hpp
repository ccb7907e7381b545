#pragma once
// One solution of a problem, measured: what it costs and how far it is from the truth.

#include "bench/problem.hpp"

namespace kerf {

/// Processor seconds of this process: what other processes do to the machine does not count.
double processor_seconds();

struct PhaseSeconds {
  double mesh = 0, assemble = 0, factor = 0;  // assemble: numbering, ordering, condensation and assembly
  double solve = 0;                           // both substitutions, contact, and the stress in every triangle
  double contact = 0;                         // of solve, wall clock
  double recover = 0;                         // u*, which the stress does not need
  double work() const {                       // until the stress is known everywhere
    return mesh + assemble + factor + solve;
  }
};

struct Measurement {
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

/// On one thread. Runs below a second are made `repeat` times and the one of median work is returned. Throws what the
/// solver throws.
Measurement measure(const Problem& problem, const Element& e, Grading grading, double level, int repeat = 3);

std::string_view name_of(Grading grading);

}  // namespace kerf
