#pragma once
// What the tests of the elements share: scenes of exact fields on the unit square and on [-2, 2]^2, norms, names.

#include "kerf/recover.hpp"
#include "solver/system.hpp"
#include "tests/support/exact.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace kerf {

/// The exact displacement on the labels in `held`, the exact traction on the others of 0..3.
inline Scene scene_of(const exact::ExactField& f, const std::vector<Index>& held, std::vector<CrackLaw> laws = {}) {
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
  s.laws = std::move(laws);
  return s;
}

/// L2 norm over the body of what `at` says about the stress at a point.
template <class F>
double stress_norm(const Model& m, const State& s, const F& at) {
  const TriangleRule rule = triangle_rule(8);
  double sum = 0;
  for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t) {
    const Fields f = evaluate(m, s, t, rule_points(rule, triangle(m, t)));
    for (Eigen::Index q = 0; q < rule.w.size(); ++q)
      sum += area(m.mesh, t) * rule.w[q] * std::pow(at(Eigen::Vector4d(f.stress.col(q))), 2);
  }
  return std::sqrt(sum);
}
inline double stress_norm(const Model& m, const State& s) {
  return stress_norm(m, s, [](const Eigen::Vector4d& v) { return v.norm(); });
}

/// L2 norm over the body of the field's displacement less `displacement(triangle, x)`.
template <class F>
double displacement_error(const Model& m, const exact::ExactField& f, const F& displacement) {
  double sum = 0;
  for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t)
    sum += exact::integrate(triangle(m, t).x, -1, [&](const Vec2& x) {
      return (Vec2(displacement(t, x)) - f.displacement(x, exact::side_of(f, centroid(m.mesh, t)))).squaredNorm();
    });
  return std::sqrt(sum);
}
inline double recovered_error(const Model& m, const State& s, const exact::ExactField& f) {
  const TriangleRule rule = triangle_rule(14);
  double sum = 0;
  for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t) {
    const Points x = rule_points(rule, triangle(m, t)), u = recovered_displacement(m, s, t, x);
    for (Eigen::Index q = 0; q < x.cols(); ++q)
      sum += area(m.mesh, t) * rule.w[q] * (u.col(q) - f.displacement(x.col(q), 0)).squaredNorm();
  }
  return std::sqrt(sum);
}

/// For messages and names of tests.
inline std::string title(const Element& e) {
  std::string name(e.name);
  std::replace(name.begin(), name.end(), '-', '_');
  return name + "_" + std::to_string(e.degree);
}

}  // namespace kerf
