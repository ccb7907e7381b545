// One run of `kerf bench map`, measured: the state, J, the map of the energy everywhere, and the same of displacement
// tracking with its adjoint. The exact map of the energy is T = T(stress) + f . u [Garreau, Guillaume, Masmoudi 2001].
// Times are medians over repeats, phase by phase. level_of() finds the level of a mesh with a given number of
// triangles: from 0.433 h^2 = area of an equilateral triangle, then by at most six meshes until it is within 2 %.
// Validations are measured with plain states between them, so that what disturbs the machine disturbs both.

#include "bench/measure/map_measure.hpp"

#include "kerf/validate.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

/// tdmap.edp: 2 x 1, plane stress, the left end held, a unit load on the middle tenth of the right one.
BenchProblem cantilever(double poisson) {
  BenchProblem p{.shape = {.outline = polygon("outline", {{0, 0}, {2, 0}, {2, 0.45}, {2, 0.55}, {2, 1}, {0, 1}}, 0),
                           .labels = {"free", "load", "held"}},
                 .coarsest = 0.2};
  p.shape.outline.sides[2].label = 1;
  p.shape.outline.sides[5].label = 2;
  p.scene.material = plane_stress(1, poisson);
  p.scene.supports = {{.label = 2, .value = [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }}};
  p.scene.tractions = {{1, [](const Vec2&, const Vec2&) { return Vec2(0, -10); }}};
  return p;
}

/// T of the energy from the exact stress, body force and displacement [Garreau, Guillaume, Masmoudi 2001].
double exact_map(const exact::ExactField& f, const Vec2& x) {
  const int side = exact::side_of(f, x);
  const double loads = f.body ? f.body(x).dot(f.displacement(x, side)) : 0;
  return exact::hole_derivative(f.material, f.stress(x, side)) + loads;
}

double map_error(const exact::ExactField& f, const Mesh& mesh, const Eigen::VectorXd& at_centroids) {
  double difference = 0, sum = 0;
  for (Index t = 0; t < static_cast<Index>(mesh.triangles.size()); ++t) {
    const Vec2 x = centroid(mesh, t);
    if (std::any_of(f.tips.begin(), f.tips.end(),
                    [&](const exact::ExactTip& tip) { return (x - tip.at).norm() < tip_margin; }))
      continue;
    const double exact = exact_map(f, x);
    difference += area(mesh, t) * std::abs(at_centroids[t] - exact);
    sum += area(mesh, t) * std::abs(exact);
  }
  return difference / sum;
}

Functional functional_of(const BenchProblem& problem) {
  if (problem.exact) return {"energy", {energy()}};
  return {"compliance", {compliance()}};
}

const Functional& tracking() {
  static const Functional j{"displacement_tracking", {displacement_tracking({}, {})}};
  return j;
}

MapMeasurement measured_map(const BenchProblem& problem, const Element& e, Grading grading, double level,
                            bool with_error) {
  forget_peak_memory();
  MapMeasurement m{.problem = problem.name,
                   .poisson = problem.poisson,
                   .element = std::string(e.name),
                   .degree = e.degree,
                   .mesh = std::string(name_of(grading)),
                   .level = level};
  const TimedState timed = timed_state(bench_plan(problem, grading, e.degree, level), e, problem.scene);
  const Model& model = timed.model;
  m.state = timed.seconds;
  m.triangles = static_cast<Index>(model.mesh.triangles.size());
  m.certified = certified(timed.state);
  const Functional j = functional_of(problem);
  ProcessorWatch watch;
  const Analysis a = analyze(j, model, timed.state);
  m.value = a.value;
  m.value_s = watch.lap();
  const Corners corners = split_at_cracks(model.mesh);
  const FullMap map = map_everywhere(a, j, {}, corners);
  m.evaluate_s = watch.lap();
  const Analysis dual = analyze(tracking(), model, timed.state);
  m.adjoint_s = watch.lap();
  map_everywhere(dual, tracking(), {}, corners);
  m.evaluate_dual_s = watch.lap();
  m.memory_mb = peak_memory_mb();
  m.error = nan;
  if (with_error && problem.exact) m.error = map_error(*problem.exact, model.mesh, map.at_centroids);
  return m;
}

template <typename Run>
double median(const std::vector<Run>& runs, const std::function<double(const Run&)>& of) {
  std::vector<double> values;
  for (const Run& r : runs) values.push_back(of(r));
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

template <typename Run>
PhaseSeconds median_state(const std::vector<Run>& runs) {
  PhaseSeconds s;
  for (double PhaseSeconds::*phase : {&PhaseSeconds::mesh, &PhaseSeconds::assemble, &PhaseSeconds::factor,
                                      &PhaseSeconds::solve, &PhaseSeconds::contact})
    s.*phase = median<Run>(runs, [phase](const Run& r) { return r.state.*phase; });
  return s;
}

/// The partly closed crack, held by its displacements, so that displacements themselves have a meaning.
BenchProblem held_crack() {
  BenchProblem p = problem("closing-crack", 0.3);
  p.scene.tractions.clear();
  p.scene.supports = {{.label = 0, .value = [f = *p.exact](const Vec2& x, const Vec2&) -> Vec2 {
                         return f.displacement(x, exact::side_of(f, x));
                       }}};
  return p;
}

ValidationRequest request_of(std::size_t points, std::size_t radii) {
  ValidationRequest r{.points = {{0.1, 1.1}, {-1.4, 0.9}, {1.45, -0.2}, {-0.7, -0.9}, {0.9, -1.2}},
                      .radii = {0.08, 0.056, 0.04, 0.028, 0.02, 0.014}};
  r.points.resize(std::min(points, r.points.size()));
  r.radii.resize(std::min(radii, r.radii.size()));
  return r;
}

}  // namespace

const std::vector<ProblemKind>& map_problem_kinds() {
  static const std::vector<ProblemKind> kinds = {
      {"smooth", "Smooth solution on a square", {0.3, 0.499999}},
      {"open-crack", "Open crack", {0.3, 0.499999}},
      {"closing-crack", "Partly closed crack", {0.3, 0.499999}},
      {"cantilever", "Cantilever, plane stress", {0.3}},
  };
  return kinds;
}

BenchProblem map_problem(const std::string& name, double poisson) {
  if (name != "cantilever") return problem(name, poisson);
  BenchProblem p = cantilever(poisson);
  p.name = name;
  p.title = map_problem_kinds().back().title;
  p.poisson = poisson;
  return p;
}

MapMeasurement measure_map(const BenchProblem& problem, const Element& e, Grading grading, double level, int repeat) {
  std::vector<MapMeasurement> runs;
  for (int i = 0; i < std::max(1, repeat); ++i) runs.push_back(measured_map(problem, e, grading, level, i == 0));
  MapMeasurement m = runs.front();
  m.state = median_state(runs);
  for (double MapMeasurement::*time : {&MapMeasurement::value_s, &MapMeasurement::evaluate_s,
                                       &MapMeasurement::adjoint_s, &MapMeasurement::evaluate_dual_s})
    m.*time = median<MapMeasurement>(runs, [time](const MapMeasurement& r) { return r.*time; });
  return m;
}

double level_of(const BenchProblem& problem, Grading grading, int degree, Index triangles) {
  // An equilateral triangle of size h has the area 0.433 h^2; the bodies fill about their squared extent.
  double level = std::log2(0.433 * static_cast<double>(triangles) * problem.coarsest * problem.coarsest /
                           std::pow(extent(problem.shape), 2));
  for (int i = 0; i < 6; ++i) {
    const double found = static_cast<double>(bench_mesh(problem, grading, degree, level).triangles.size());
    const double off = std::log2(static_cast<double>(triangles) / found);
    if (std::abs(off) < 0.03) break;
    level += off;
  }
  return level;
}

std::vector<ValidationMeasurement> measure_validations(Index triangles, std::size_t points, std::size_t radii,
                                                       int repeat) {
  const BenchProblem problem = held_crack();
  const Element& e = element("bdms");
  const MeshPlan plan = bench_plan(problem, Grading::Graded, 1, level_of(problem, Grading::Graded, 1, triangles));
  const ValidationRequest request = request_of(points, radii);
  const auto plain = [&] {
    const TimedState timed = timed_state(plan, e, problem.scene);
    return ValidationMeasurement{.problem = problem.name,
                                 .poisson = problem.poisson,
                                 .triangles = static_cast<Index>(timed.model.mesh.triangles.size()),
                                 .state = timed.seconds,
                                 .points = request.points.size(),
                                 .radii = request.radii.size()};
  };
  std::vector<ValidationMeasurement> all, states;
  for (const Functional& j :
       {Functional{"energy", {energy()}}, Functional{"crack_opening", {crack_opening(0, {})}}, tracking()}) {
    std::vector<ValidationMeasurement> runs;
    do {
      states.push_back(plain());  // between the validations: what disturbs the machine disturbs both
      ValidationMeasurement m = states.back();
      m.functional = j.kind;
      forget_peak_memory();
      ProcessorWatch watch;
      const std::vector<Validation> found = validate({plan.shape, plan.sizing}, e, problem.scene, j, request);
      m.validate_s = watch.lap();
      m.memory_mb = peak_memory_mb();
      for (const Validation& v : found)
        ++(v.verdict == Verdict::Holds ? m.holds : v.verdict == Verdict::Fails ? m.fails : m.out_of_range);
      runs.push_back(m);
    } while (static_cast<int>(runs.size()) < repeat && runs.front().validate_s < 10);
    ValidationMeasurement m = runs.front();
    m.validate_s = median<ValidationMeasurement>(runs, [](const ValidationMeasurement& r) { return r.validate_s; });
    all.push_back(m);
  }
  for (ValidationMeasurement& m : all) m.state = median_state(states);
  return all;
}

}  // namespace kerf
