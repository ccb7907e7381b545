// The saddle-point formulation in the smooth domain against the condensed one: the same discrete solution.
#include "solver/extended.hpp"

#include "geometry/mesher.hpp"
#include "solver/stopwatch.hpp"
#include "tests/exact.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf {
namespace {

Scene scene_of(const exact::ExactField& f, std::initializer_list<Index> held, std::size_t cracks) {
  Scene s;
  s.material = f.material;
  s.body = f.body;
  for (Index label = 0; label < 4; ++label) {
    if (std::find(held.begin(), held.end(), label) != held.end())
      s.supports.push_back({label, false, true, true,
                            [f](const Vec2& x, const Vec2&) { return f.displacement(x, exact::side_of(f, x)); }});
    else
      s.tractions.push_back(
          {label, [f](const Vec2& x, const Vec2& n) { return Vec2(f.stress(x, exact::side_of(f, x)) * n); }});
  }
  s.laws.resize(cracks);
  return s;
}

// Relative to the condensed solution: stress and displacement in L2, traces, jumps and forces in the maximum norm.
struct Difference {
  double stress = 0, displacement = 0, rotation = 0, traces = 0, jumps = 0, forces = 0;
};

Difference difference(const Model& m, const State& a, const State& b) {
  double stress = 0, stresses = 0, u = 0, us = 0, r = 0, rs = 0;
  for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t) {
    const Points x = rule_points(m.kernel.rule, triangle(m, t));
    const Fields f = evaluate(m, a, t, x), g = evaluate(m, b, t, x);
    for (Eigen::Index q = 0; q < x.cols(); ++q) {
      const double w = area(m.mesh, t) * m.kernel.rule.w[q];
      stress += w * (f.stress.col(q) - g.stress.col(q)).squaredNorm();
      stresses += w * f.stress.col(q).squaredNorm();
      u += w * (f.displacement.col(q) - g.displacement.col(q)).squaredNorm();
      us += w * f.displacement.col(q).squaredNorm();
      r += w * std::pow(f.rotation[q] - g.rotation[q], 2);
      rs += w * std::pow(f.rotation[q], 2);
    }
  }
  const auto largest = [](const auto& v) { return v.size() > 0 ? v.cwiseAbs().maxCoeff() : 0; };
  const auto relative = [](double error, double size) { return size > 0 ? error / size : error; };
  const Index base = m.skeleton.base, jumps = m.skeleton.total - base;
  return {std::sqrt(relative(stress, stresses)),
          std::sqrt(relative(u, us)),
          std::sqrt(relative(r, rs)),
          relative(largest((a.skeleton - b.skeleton).head(base)), largest(a.skeleton.head(base))),
          relative(largest((a.skeleton - b.skeleton).tail(jumps)), largest(a.skeleton)),
          relative(largest(a.force - b.force), largest(a.force))};
}

Difference compare(const Model& m, const std::string& which) {
  Stopwatch watch;
  const State condensed = solve(m);
  const double one = watch.lap();
  const State extended = solve_extended(m);
  const double two = watch.lap();
  const Difference d = difference(m, condensed, extended);
  printf("%-40s s %.1e u %.1e r %.1e m %.1e j %.1e f %.1e kkt %.1e/%.1e round %.1e it %d/%d sec %.3f/%.3f\n", which.c_str(), d.stress,
         d.displacement, d.rotation, d.traces, d.jumps, d.forces, condensed.certificate.kkt, extended.certificate.kkt,
         extended.certificate.rounding, condensed.contact_iterations, extended.contact_iterations, one, two);
  return d;
}

const std::vector<std::pair<std::string, int>> names = {{"bdms", 1}, {"bdms", 2}, {"bdms", 3},   {"bdms-c", 1}, {"peers", 1},
                                                        {"afw", 1},  {"afw", 2},  {"afw", 3},  {"arnold-winther-nc", 1}};

TEST(Extended, Smooth) {
  for (const auto& [name, degree] : names)
    for (const int n : {4, 8})
      compare(prepare(exact::unit_square_mesh(n), element(name, degree), scene_of(exact::wave_field(0.3), {0, 3}, 0), 1),
              name + std::to_string(degree));
}
TEST(Extended, Cracks) {
  for (const auto& [name, degree] : names)
    for (const char* which : {"I", "II", "III", "IV"})
      for (const int n : {8, 16})
        if (n == 8 || degree == 1)
          compare(prepare(exact::crack_mesh(n), element(name, degree), scene_of(exact::crack_case(which), {0, 1, 2, 3}, 1), 1),
                name + std::to_string(degree) + " " + which + " " + std::to_string(n));
}
TEST(Extended, Incompressible) {
  for (const auto& [name, degree] : names)
    for (const double rest : {1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 0.0})
      for (const bool enclosed : {false, true})
        compare(prepare(exact::unit_square_mesh(8), element(name, degree), enclosed ? scene_of(exact::wave_field(0.5 - rest), {0,1,2, 3}, 0): scene_of(exact::wave_field(0.5 - rest), {0, 3}, 0), 1),
              name + std::to_string(degree) + " " + std::to_string(rest) + (enclosed ? " enclosed" : ""));
}

}  // namespace
}  // namespace kerf
