// A small straight crack of length 2 eps with normal n: form(s, t) = 2/E' (s n).(t n) where n.s n > 0, else the product
// of the shears alone, as closed faces without friction carry pressure [Kachanov 1993; theory: T.13].

#include "topo/formulas/axes.hpp"
#include "topo/formulas/kind.hpp"
#include "topo/mutation.hpp"

#include <cmath>

namespace kerf {

namespace {

// The tractions on a cut at the angle: normal and tangential components of s n, n = (-sin, cos).
// By double angles: tractions turn with the cut, tensors with twice its angle.
Vec2 on_cut(const PlaneParts& s, double angle) {
  const double c = std::cos(2 * angle), d = std::sin(2 * angle);
  return {s.mean - s.x * c - s.y * d, s.y * c - s.x * d};
}

double crack_part(const Material& m, double angle, const Mat2& s, const Mat2& t, bool open) {
  const Vec2 a = on_cut(split(s), angle), b = on_cut(split(t), angle);
  return 2 / plane_modulus(m) *
         (mutant(FormulaPart::CrackTangential) * a.y() * b.y() +
          (open ? mutant(FormulaPart::CrackNormal) * a.x() * b.x() : 0));
}

}  // namespace

//  Open or closed is a matter of s, the stress of the state, and not of t.
double crack_form(const Material& m, double angle, const Mat2& s, const Mat2& t) {
  return crack_part(m, angle, s, t, on_cut(split(s), angle).x() > 0);
}

namespace {

std::string crack_in_words(const Perturbation&) {
  return "a crack of length 2 \u03b5 in its worst direction";
}
double of_crack(const Perturbation&, const Material& m, double angle, const Mat2& s, const Mat2& t) {
  return crack_form(m, angle, s, t);
}

// Bodies whose stresses open the crack in different directions: searched.
Oriented searched_crack(const Material& m, std::span<const Product> products) {
  const auto value = [&](double angle) {
    double sum = 0;
    for (const Product& q : products) sum += q.factor * crack_form(m, angle, q.s, q.t);
    return sum;
  };
  const double angle = largest_over_angles([&](double at) { return std::abs(value(at)); }, 720);
  return {value(angle), angle};
}

// The largest |T| over the angle, for products with one stress s of the state. T is continuous in the angle and a wave
// in twice or four times the angle on either side of where the crack closes, so that the largest value is at an extreme
// of a branch (where that branch holds) or at an angle of closing, mean = x cos 2a + y sin 2a [theory: T.14].
Oriented worst(const Perturbation&, const Material& m, std::span<const Product> products) {
  Oriented largest;
  if (products.empty()) return largest;
  for (const Product& q : products)
    if (q.s != products[0].s) return searched_crack(m, products);
  const auto take = [&](double angle, bool open) {
    double value = 0;
    for (const Product& q : products) value += q.factor * crack_part(m, angle, q.s, q.t, open);
    if (std::abs(value) > std::abs(largest.value)) largest = {value, in_half_turn(angle)};
  };
  const PlaneParts first = split(products[0].s);
  const auto opens = [&](double angle) { return on_cut(first, angle).x() > 0; };
  // Open: n.M n, extreme along the axes of M. Closed: sum factor s_nt t_nt, a wave in 4 angle.
  const double open_at = axis(squares(products));
  for (const double angle : {open_at, open_at + pi / 2})
    if (opens(angle)) take(angle, true);
  double even = 0, odd = 0;
  for (const Product& q : products) {
    const PlaneParts a = split(q.s), b = split(q.t);
    even += q.factor * (a.y * b.y - a.x * b.x);
    odd -= q.factor * (a.x * b.y + a.y * b.x);
  }
  const double closed_at = 0.25 * std::atan2(odd, even);
  for (int i = 0; i < 4; ++i)
    if (const double angle = closed_at + i * pi / 4; !opens(angle)) take(angle, false);
  const double radius = std::hypot(first.x, first.y);
  if (std::abs(first.mean) < radius)
    for (const double side : {-1., 1.})
      for (const bool open : {false, true})
        take(0.5 * (std::atan2(first.y, first.x) + side * std::acos(first.mean / radius)), open);
  return largest;
}

}  // namespace

constinit const PerturbationKind kinds::crack{
    .word = "crack", .description = crack_in_words, .becomes = Becomes::Slit, .form = of_crack, .orient = worst};

}  // namespace kerf
