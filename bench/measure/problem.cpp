// The bodies that the benches solve, their meshes, and the measure of the error. Level l has edges of h = coarsest
// 2^(-l/2). Graded meshes balance the errors of an element of degree k, h^(k+1) where the stress is smooth and d^e in
// an element of length d at a tip (e = 1/2) or corner:
//   d = h (2 h / L)^((k+1)/e - 1),   L the longest side.
// Errors are relative in L2 over the body, of the stress, and of u* up to a rigid motion where nothing holds the body:
// with R the rigid motions, min over r of |d - R r|^2 = |d|^2 - b' N^-1 b, N = (R, R), b = (R, d). The exact field is
// integrated by rules that know the singular vertex of a triangle. Where no closed form is known (Cook's membrane) the
// reference is degree 3 on a finer graded mesh, kept at the points of a rule; its own error is its distance from the
// one two levels coarser.

#include "bench/measure/problem.hpp"
#include "solver/system.hpp"

#include "kerf/recover.hpp"
#include "tests/support/integral.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

Loop square_loop(double low, double high) {
  return polygon("outline", {{low, low}, {high, low}, {high, high}, {low, high}}, 0);
}

BoundaryField displacement_of(const exact::ExactField& f) {
  return [f](const Vec2& x, const Vec2&) -> Vec2 { return f.displacement(x, exact::side_of(f, x)); };
}

BenchProblem smooth(double poisson) {
  BenchProblem p{.shape = {.outline = square_loop(0, 1), .labels = {"side"}}, .coarsest = 0.35};
  p.exact = exact::vortex_field(poisson);
  p.scene.material = p.exact->material;
  p.scene.body = p.exact->body;
  p.scene.supports = {{.label = 0, .value = [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }}};
  return p;
}

BenchProblem cook(const Material& material) {
  BenchProblem p{.shape = {.outline = polygon("outline", {{0, 0}, {48, 44}, {48, 60}, {0, 44}}, 0),
                           .labels = {"free", "right", "left"}},
                 .coarsest = 16};
  p.shape.outline.sides[1].label = 1;
  p.shape.outline.sides[3].label = 2;
  p.scene.material = material;
  p.scene.supports = {{.label = 2, .value = [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }}};
  p.scene.tractions = {{1, [](const Vec2&, const Vec2&) { return Vec2(0, 1.0 / 16); }}};
  // Where a held side meets a free one the stress is singular; at the right end the shear of one side is not that of
  // the other, and the stress jumps.
  p.corners = {{0, 0.9}, {1, 1.0}, {2, 1.0}, {3, 0.65}};
  return p;
}

BenchProblem crack(const exact::LineCrack& c, double poisson) {
  BenchProblem p{.shape = {.outline = square_loop(-2, 2), .cracks = {{"c", {{-1, 0}, {1, 0}}}}, .labels = {"side"}},
                 .coarsest = 0.8};
  p.exact = exact::line_crack("crack", plane_strain(1, poisson), c);
  p.scene.material = p.exact->material;
  return p;
}

BenchProblem open_crack(double poisson) {
  BenchProblem p = crack({.p0 = 1, .westergaard = true}, poisson);
  p.scene.supports = {{.label = 0, .value = displacement_of(*p.exact)}};
  p.scene.laws = {{.kind = CrackLaw::Kind::Open}};
  return p;
}

BenchProblem closing_crack(double poisson) {
  BenchProblem p = crack({.p1 = 1, .westergaard = true}, poisson);
  p.scene.tractions = {{0, [f = *p.exact](const Vec2& x, const Vec2& n) -> Vec2 { return f.stress(x, 0) * n; }}};
  p.scene.laws.resize(1);
  return p;
}

double longest_side(const Shape& shape) {
  double longest = 0;
  for (std::size_t i = 0; i < shape.outline.sides.size(); ++i) {
    const Vec2 &a = shape.outline.sides[i].start, &b = shape.outline.sides[(i + 1) % shape.outline.sides.size()].start;
    longest = std::max(longest, (b - a).norm());
  }
  return longest;
}

/// The outline with a vertex on each side of every sharp corner, `near` away from it: short sides make the mesher
/// grade.
Loop with_short_sides(const Loop& outline, const std::vector<SharpCorner>& corners,
                      const std::function<double(const SharpCorner&)>& near) {
  const std::size_t n = outline.sides.size();
  std::vector<double> distance(n, 0);
  for (const SharpCorner& c : corners) distance[c.side] = near(c);
  Loop loop{outline.name, {}};
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t next = (i + 1) % n;
    const Vec2 &a = outline.sides[i].start, &b = outline.sides[next].start, along = (b - a).normalized();
    const auto add = [&](const Vec2& x) { loop.sides.push_back({x, outline.sides[i].label, {}}); };
    add(a);
    if (distance[i] > 0) add(a + distance[i] * along);
    if (distance[next] > 0) add(b - distance[next] * along);
  }
  return loop;
}

MeshPlan graded_plan(const BenchProblem& problem, double size, int degree, double growth) {
  // The stress errs by h^(degree + 1) where it is smooth, by d^(1/2) at a crack tip, by d^exponent at a corner; the
  // mesher refuses sides shorter than 1e-9 of the body.
  const double share = 2 * size / longest_side(problem.shape), whole = extent(problem.shape);
  const auto balanced = [&](double exponent, double least) {
    return std::clamp(size * std::pow(share, (degree + 1) / exponent - 1), least * whole, size);
  };
  Shape shape = problem.shape;
  shape.outline = with_short_sides(shape.outline, problem.corners,
                                   [&](const SharpCorner& c) { return balanced(c.exponent, 1e-8); });
  return {shape, {.size = size, .crack_tip_size = balanced(0.5, 1e-10), .grading = growth}};
}

/// Points of a triangle with the stress and displacement that are true there.
struct Truth {
  Points x;
  Eigen::VectorXd weight;
  Eigen::Matrix4Xd stress;
  Points displacement;
};

Truth exact_truth(const exact::ExactField& f, const Model& model, Index t) {
  const Triangle shape = triangle(model, t);
  const int side = exact::side_of(f, centroid(shape));
  const exact::Cubature c = exact::cubature(shape.x, exact::singular_vertex(model.mesh, f, t), 6);
  Truth truth{c.x, c.w, Eigen::Matrix4Xd(4, c.x.cols()), Points(2, c.x.cols())};
  for (Eigen::Index q = 0; q < c.x.cols(); ++q) {
    const Mat2 s = f.stress(c.x.col(q), side);
    truth.stress.col(q) << s(0, 0), s(0, 1), s(1, 0), s(1, 1);
    truth.displacement.col(q) = f.displacement(c.x.col(q), side);
  }
  return truth;
}

/// The points of the reference by the triangle in which they lie.
std::vector<std::vector<Eigen::Index>> by_triangle(const Reference& r, const Mesh& mesh) {
  const std::vector<Index> where = locate(mesh, r.x);
  std::vector<std::vector<Eigen::Index>> points(mesh.triangles.size());
  for (std::size_t i = 0; i < where.size(); ++i)
    if (where[i] != none) points[static_cast<std::size_t>(where[i])].push_back(static_cast<Eigen::Index>(i));
  return points;
}

/// Least squares over the body: a difference of displacements, and what is left of it without rigid motions.
struct Difference {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d load = Eigen::Vector3d::Zero();
  double square = 0;
  void add(double weight, const Vec2& x, const Vec2& d) {
    Eigen::Matrix<double, 2, 3> rigid;
    rigid << 1, 0, -x.y(), 0, 1, x.x();
    normal += weight * rigid.transpose() * rigid;
    load += weight * rigid.transpose() * d;
    square += weight * d.squaredNorm();
  }
  double without_rigid() const {
    return std::max(0.0, square - load.dot(normal.ldlt().solve(load)));
  }
};

struct Sums {
  double stress = 0, norm = 0;
  Difference displacement, size;
};

void add(Sums& sums, const Model& model, const State& state, Index t, const Truth& truth) {
  const Fields f = evaluate(model, state, t, truth.x);
  const Points u = recovered_displacement(model, state, t, truth.x);
  for (Eigen::Index q = 0; q < truth.x.cols(); ++q) {
    const double w = truth.weight[q];
    sums.stress += w * (f.stress.col(q) - truth.stress.col(q)).squaredNorm();
    sums.norm += w * truth.stress.col(q).squaredNorm();
    sums.displacement.add(w, truth.x.col(q), u.col(q) - truth.displacement.col(q));
    sums.size.add(w, truth.x.col(q), truth.displacement.col(q));
  }
}

Truth reference_truth(const Reference& r, const std::vector<Eigen::Index>& points) {
  Points x(2, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i)
    x.col(static_cast<Eigen::Index>(i)) = r.x[static_cast<std::size_t>(points[i])];
  return {std::move(x), r.weight(points), r.stress(Eigen::all, points), r.displacement(Eigen::all, points)};
}

Errors errors_against(const Reference& r, const Model& model, const State& state) {
  const auto points = by_triangle(r, model.mesh);
  Sums sums;
  for (Index t = 0; t < static_cast<Index>(points.size()); ++t)
    if (!points[t].empty()) add(sums, model, state, t, reference_truth(r, points[t]));
  return {std::sqrt(sums.stress / sums.norm), std::sqrt(sums.displacement.square / sums.size.square)};
}

Reference sampled(const Model& model, const State& state) {
  Reference r{.strain_energy = strain_energy(model, state)};
  const TriangleRule rule = triangle_rule(5);
  const Eigen::Index per = rule.w.size(), count = per * static_cast<Eigen::Index>(model.mesh.triangles.size());
  r.weight.resize(count);
  r.stress.resize(4, count);
  r.displacement.resize(2, count);
  for (Index t = 0; t < static_cast<Index>(model.mesh.triangles.size()); ++t) {
    const Points x = rule_points(rule, triangle(model, t));
    for (Eigen::Index q = 0; q < per; ++q) r.x.push_back(x.col(q));
    r.weight.segment(per * t, per) = area(model.mesh, t) * rule.w;
    r.stress.middleCols(per * t, per) = evaluate(model, state, t, x).stress;
    r.displacement.middleCols(per * t, per) = recovered_displacement(model, state, t, x);
  }
  return r;
}

}  // namespace

const std::vector<ProblemKind>& problem_kinds() {
  static const std::vector<ProblemKind> kinds = {
      {"smooth", "Smooth solution on a square", {0.3, 0.4999, 0.499999}},
      {"cook-stress", "Cook's membrane, plane stress", {1.0 / 3}},
      {"cook-strain", "Cook's membrane, plane strain", {0.3, 0.4999, 0.499999}},
      {"open-crack", "Open crack", {0.3, 0.499999}},
      {"closing-crack", "Partly closed crack", {0.3, 0.499999}},
  };
  return kinds;
}

BenchProblem problem(const std::string& name, double poisson) {
  const auto& kinds = problem_kinds();
  const auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const ProblemKind& k) { return k.name == name; });
  if (kind == kinds.end()) throw std::invalid_argument("no bench problem is called " + name);
  BenchProblem p = name == "smooth"        ? smooth(poisson)
                   : name == "cook-stress" ? cook(plane_stress(1, poisson))
                   : name == "cook-strain" ? cook(plane_strain(1, poisson))
                   : name == "open-crack"  ? open_crack(poisson)
                                           : closing_crack(poisson);
  p.name = name;
  p.title = kind->title;
  p.poisson = poisson;
  // P4 displacements on meshes graded to 1e-6 at the corners, two finest meshes in agreement to 1e-11 and 1e-8.
  if (name == "cook-stress") p.known_energy = 12.02080309;
  if (name == "cook-strain" && poisson == 0.4999) p.known_energy = 9.2836675;
  return p;
}

Adapted adapt(const BenchProblem& problem, const Element& e, double level) {
  const Sizing coarse{.size = problem.coarsest, .crack_tip_size = problem.coarsest};
  return solve_adaptively(problem.shape, coarse, e, problem.scene,
                          {.error = 0.1 * std::pow(2, -level), .max_triangles = 1000000});
}

MeshPlan bench_plan(const BenchProblem& problem, Grading grading, int degree, double level) {
  const double size = problem.coarsest * std::pow(2, -level / 2);
  if (grading == Grading::Uniform) return {problem.shape, {.size = size, .crack_tip_size = size}};
  // 0.45 took the least time to errors down to 1e-4 (0.25, 0.35, 0.6: up to twice as long); about corners no error
  // falls below what the growth leaves, so that it has to shrink with the size.
  const double share = 2 * size / longest_side(problem.shape);
  return graded_plan(problem, size, degree, 0.45 * std::min(1.0, std::sqrt(10 * share)));
}

Mesh bench_mesh(const BenchProblem& problem, Grading grading, int degree, double level) {
  const MeshPlan plan = bench_plan(problem, grading, degree, level);
  return triangulate(plan.shape, plan.sizing);
}

Reference overkill(const BenchProblem& problem, double level) {
  const Element& e = element("bdms", 3);
  const auto solved = [&](double at, const auto& use) {
    const double size = problem.coarsest * std::pow(2, -at / 2);
    const MeshPlan plan = graded_plan(problem, size, e.degree, 0.25);
    const Model model = prepare(triangulate(plan.shape, plan.sizing), e, problem.scene, 1);
    use(model, solve(model));
  };
  Reference fine;
  solved(level, [&](const Model& model, const State& state) { fine = sampled(model, state); });
  solved(level - 2,
         [&](const Model& model, const State& state) { fine.error = errors_against(fine, model, state).stress; });
  return fine;
}

Errors errors(const BenchProblem& problem, const Model& model, const State& state) {
  if (problem.reference) return errors_against(*problem.reference, model, state);
  Sums sums;
  for (Index t = 0; t < static_cast<Index>(model.mesh.triangles.size()); ++t)
    add(sums, model, state, t, exact_truth(problem.exact.value(), model, t));
  const bool floating = !model.inner->floating.empty();
  const auto part = [floating](const Difference& d) { return floating ? d.without_rigid() : d.square; };
  return {std::sqrt(sums.stress / sums.norm), std::sqrt(part(sums.displacement) / part(sums.size))};
}

}  // namespace kerf
