#pragma once
// One map of the topological derivative, measured: state, adjoint, evaluation, distance from the exact map; and the
// time of a validation beside that of a state.

#include "bench/measure/measure.hpp"

namespace kerf {

/// Those of problem_kinds with an exact solution, and "cantilever": the body of the peers' tdmap.edp, of which only
/// times are measured; its functional is the compliance, that of the others the energy.
const std::vector<ProblemKind>& map_problem_kinds();
BenchProblem map_problem(const std::string& name, double poisson);  // throws std::invalid_argument for an unknown name

struct MapMeasurement {
  std::string problem;
  double poisson = 0;
  std::string element;
  int degree = 1;
  std::string mesh;  // "uniform", "graded"
  double level = 0;
  Index triangles = 0;
  PhaseSeconds state;          // recover is not measured
  double value = 0;            // J
  double value_s = 0;          // J itself
  double evaluate_s = 0;       // T of J at every centroid and every corner; needs no adjoint
  double adjoint_s = 0;        // of displacement tracking: its value, derivative and dual state
  double evaluate_dual_s = 0;  // the map of displacement tracking
  double memory_mb = 0;        // peak of the process in the run
  double error = 0;            // relative L1 of T over the body outside the tips; NaN without an exact solution
  bool certified = true;
  double work() const {  // until the map is known everywhere
    return state.work() + evaluate_s;
  }
  double evaluation_share() const {
    return evaluate_s / state.work();
  }
};

/// The error leaves out triangles with centroids closer than this to a crack tip.
inline constexpr double tip_margin = 0.1;

/// On one thread; every time is the median of `repeat` runs. Throws what the solver throws.
MapMeasurement measure_map(const BenchProblem& problem, const Element& e, Grading grading, double level,
                           int repeat = 3);

/// The level with about so many triangles, within 3 %.
double level_of(const BenchProblem& problem, Grading grading, int degree, Index triangles);

struct ValidationMeasurement {
  std::string problem, functional;
  double poisson = 0;
  Index triangles = 0;    // of the plain body
  PhaseSeconds state;     // of the plain body
  double validate_s = 0;  // all points and radii
  std::size_t points = 0, radii = 0;
  int holds = 0, fails = 0, out_of_range = 0;  // verdicts
  double memory_mb = 0;
  double ratio() const {
    return validate_s / state.work();
  }
};

/// At most five points and six radii about the partly closed crack, held by its displacements around, `bdms` of degree
/// 1: the energy, and with an adjoint the opening of the crack and displacement tracking. Medians of `repeat` runs; a
/// validation of more than ten seconds is made once.
std::vector<ValidationMeasurement> measure_validations(Index triangles, std::size_t points = 5, std::size_t radii = 6,
                                                       int repeat = 3);

}  // namespace kerf
