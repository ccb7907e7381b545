// Processor time, memory and error of one solution. Time is that of the process (CLOCK_PROCESS_CPUTIME_ID) on one
// thread; phases inside a call get its processor time by their shares of the wall clock. Memory is the peak of what is
// resident since it was last forgotten (/proc/self/clear_refs), read before errors are computed, since those need more.
// Runs that take less than a second are repeated, and the median by work is the one that is kept; estimating counts as
// meshing where meshes are adapted.

#include "bench/measure/measure.hpp"
#include "solver/system.hpp"

#include "kerf/recover.hpp"

#include <malloc.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <optional>
#include <string>

namespace kerf {

namespace {

/// u* at the vertices of every triangle.
void recover_displacement(const Model& model, const State& state) {
  for (Index t = 0; t < static_cast<Index>(model.mesh.triangles.size()); ++t) {
    const Triangle shape = triangle(model, t);
    Points corners(2, 3);
    corners << shape.x[0], shape.x[1], shape.x[2];
    recovered_displacement(model, state, t, corners);
  }
}

StateMeasurement measured_state(const BenchProblem& problem, const Element& e, Grading grading, double level,
                                bool with_errors) {
  forget_peak_memory();
  StateMeasurement m{.problem = problem.name,
                     .poisson = problem.poisson,
                     .element = std::string(e.name),
                     .degree = e.degree,
                     .mesh = std::string(name_of(grading)),
                     .level = level};
  ProcessorWatch watch;
  std::optional<Adapted> adapted;
  if (grading == Grading::Adaptive) {
    adapted.emplace(adapt(problem, e, level));
    const double whole = watch.lap();
    // Wall clocks of all rounds: their shares of the processor time. Estimating is a part of meshing here.
    PhaseSeconds wall;
    for (const Round& r : adapted->rounds) {
      wall.mesh += r.mesh + r.estimate;
      wall.assemble += r.assemble;
      wall.factor += r.factor;
      wall.solve += r.solve;
    }
    const double share = wall.work() > 0 ? whole / wall.work() : 0;
    m.seconds = {wall.mesh * share, wall.assemble * share, wall.factor * share, wall.solve * share};
    m.seconds.contact = adapted->state.seconds.contact;
  } else {
    TimedState timed = timed_state(bench_plan(problem, grading, e.degree, level), e, problem.scene);
    m.seconds = timed.seconds;
    adapted = Adapted{std::move(timed.model), std::move(timed.state), {}, {}, {}};
  }
  const Model& model = adapted->model;
  const State& state = adapted->state;
  m.memory_mb = peak_memory_mb();
  watch.lap();
  recover_displacement(model, state);
  m.seconds.recover = watch.lap();
  m.h = quality(model.mesh).h_max;
  m.triangles = static_cast<Index>(model.mesh.triangles.size());
  m.condensed_unknowns = model.inner->ordering.size;
  m.unknowns = model.inner->ordering.size + interior_count(e) * m.triangles;
  m.contact_iterations = state.contact_iterations;
  m.certified = certified(state);
  if (with_errors) m.error = errors(problem, model, state);
  return m;
}

}  // namespace

double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Linux keeps the peak of the resident memory and forgets it on request.
void forget_peak_memory() {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
}

double peak_memory_mb() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (double kilobytes = 0; word == "VmHWM:" && status >> kilobytes) return kilobytes / 1024;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

TimedState timed_state(const MeshPlan& plan, const Element& e, const Scene& scene) {
  PhaseSeconds seconds;
  ProcessorWatch watch;
  Mesh mesh = triangulate(plan.shape, plan.sizing);
  seconds.mesh = watch.lap();
  Model model = prepare(std::move(mesh), e, scene, 1);
  const double prepared = watch.lap();
  State state = solve(model);
  seconds.solve = watch.lap();
  seconds.contact = state.seconds.contact;
  // Wall clocks: their shares of the processor time.
  const double wall = model.seconds.assemble + model.seconds.factor;
  seconds.factor = wall > 0 ? prepared * model.seconds.factor / wall : 0;
  seconds.assemble = prepared - seconds.factor;
  return {std::move(model), std::move(state), seconds};
}

std::string_view name_of(Grading grading) {
  return grading == Grading::Uniform ? "uniform" : grading == Grading::Graded ? "graded" : "adaptive";
}

StateMeasurement measure(const BenchProblem& problem, const Element& e, Grading grading, double level, int repeat) {
  std::vector<StateMeasurement> runs{measured_state(problem, e, grading, level, true)};
  const StateMeasurement first = runs.front();
  if (first.seconds.work() < 1)
    while (static_cast<int>(runs.size()) < repeat) runs.push_back(measured_state(problem, e, grading, level, false));
  const auto middle = runs.begin() + static_cast<std::ptrdiff_t>(runs.size() / 2);
  std::nth_element(runs.begin(), middle, runs.end(), [](const StateMeasurement& a, const StateMeasurement& b) {
    return a.seconds.work() < b.seconds.work();
  });
  middle->error = first.error;
  middle->memory_mb = first.memory_mb;  // before the errors were computed
  return *middle;
}

}  // namespace kerf
