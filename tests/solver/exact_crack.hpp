#pragma once
// A straight crack from (-1, 0) to (1, 0), turned with an exact field, in [-2, 2]^2 under its tractions.

#include "kerf/state.hpp"
#include "tests/support/exact.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace kerf {

struct CrackProblem {
  exact::ExactField exact;
  Model model;
  State state;
};

/// `held` labels have the exact displacements, the others of 0..3 the exact tractions.
inline CrackProblem crack_problem(const exact::ExactField& f, int n, int degree, const std::vector<Index>& held,
                                  CrackLaw::Kind kind = CrackLaw::Kind::Open, const char* name = "bdms") {
  const Vec2 along = f.tips[1].at - f.tips[0].at;
  const Mesh mesh = exact::crack_mesh(n, std::atan2(along.y(), along.x()), 0.2);
  Scene s;
  s.material = f.material;
  for (Index label = 0; label < 4; ++label) {
    if (std::ranges::count(held, label) > 0)
      s.supports.push_back({label, false, true, true, [f](const Vec2& x, const Vec2&) -> Vec2 {
                              return f.displacement(x, exact::side_of(f, x));
                            }});
    else
      s.tractions.push_back(
          {label, [f](const Vec2& x, const Vec2& n) -> Vec2 { return f.stress(x, exact::side_of(f, x)) * n; }});
  }
  s.laws.push_back({.kind = kind});
  CrackProblem p{f, prepare(mesh, element(name, degree), s, 1), {}};
  p.state = solve(p.model);
  return p;
}

}  // namespace kerf
