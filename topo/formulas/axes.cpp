// Angles of what has a direction: the axis of a symmetric form in closed form, and a search by samples and golden
// sections where there is none [theory: T.14].

#include "topo/formulas/axes.hpp"

#include <cmath>

namespace kerf {

double in_half_turn(double angle) {
  const double a = angle - pi * std::floor(angle / pi);
  return a < pi ? a : 0;
}

PlaneParts squares(std::span<const Product> products) {
  Mat2 sum = Mat2::Zero();
  for (const Product& q : products) sum += q.factor * symmetric_part(q.s) * symmetric_part(q.t);
  return split(sum);
}

double axis(const PlaneParts& m) {
  return in_half_turn(0.5 * std::atan2(m.y, m.x));
}

// Golden sections assume one maximum within a sample's width on either side of the best sample. The best sample itself
// stays in the race, so that the result is never below it.
double largest_over_angles(const std::function<double(double)>& f, int samples) {
  double best = 0, value = f(0);
  const auto take = [&](double angle) {
    if (const double other = f(angle); other > value) {
      best = angle;
      value = other;
    }
  };
  for (int i = 1; i < samples; ++i) take(i * pi / samples);
  constexpr double golden = 0.6180339887498949;
  double low = best - pi / samples, high = best + pi / samples, a = high - golden * (high - low),
         b = low + golden * (high - low), fa = f(a), fb = f(b);
  for (const double narrow = 1e-9; high - low > narrow;) {
    if (fa > fb) {
      high = b;
      b = a;
      fb = fa;
      fa = f(a = high - golden * (high - low));
    } else {
      low = a;
      a = b;
      fa = fb;
      fb = f(b = low + golden * (high - low));
    }
  }
  take(0.5 * (low + high));
  return in_half_turn(best);
}

}  // namespace kerf
