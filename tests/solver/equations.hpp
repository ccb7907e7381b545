#pragma once
// Whether an exact field obeys the equations, by differences.

#include "tests/support/exact_field.hpp"

#include <gtest/gtest.h>

namespace kerf::exact {

/// Fourth-order central differences of f along axis k.
template <class F>
auto slope(const F& f, const Vec2& x, int k, double h) {
  const Vec2 d = h * Vec2::Unit(k);
  return ((8 * (f(x + d) - f(x - d)) - (f(x + 2 * d) - f(x - 2 * d))) / (12 * h)).eval();
}

/// -div sigma = body and grad u = A sigma + Gamma(omega), relative to the size of stress and strain at x.
inline void expect_equations(const ExactField& field, const Vec2& x, double h) {
  const int side = side_of(field, x);
  const auto u = [&](const Vec2& y) { return field.displacement(y, side); };
  const auto s = [&](const Vec2& y) { return field.stress(y, side); };
  const Mat2 sx = slope(s, x, 0, h), sy = slope(s, x, 1, h), stress = s(x);
  const Vec2 body = field.body ? field.body(x) : Vec2::Zero();
  EXPECT_LT((sx.col(0) + sy.col(1) + body).norm(), 1e-8 * (sx.norm() + sy.norm() + stress.norm())) << field.name;
  Mat2 gradient, turn;
  gradient << slope(u, x, 0, h), slope(u, x, 1, h);
  const double omega = field.rotation(x, side);
  turn << 0, omega, -omega, 0;
  const Mat2 hooke = strain(field.material, stress) + turn;
  EXPECT_LT((gradient - hooke).norm(), 1e-8 * (hooke.norm() + stress.norm() / field.material.mu)) << field.name;
}

}  // namespace kerf::exact
