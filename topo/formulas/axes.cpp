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

}  // namespace kerf
