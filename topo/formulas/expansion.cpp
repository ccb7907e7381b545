#include "kerf/perturbation.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace kerf {

namespace {

constexpr double pi = std::numbers::pi;

Mat2 symmetric(const Mat2& s) {
  return 0.5 * (s + s.transpose());
}

// s = mean I + [[x, y], [y, -x]].
struct Parts {
  double mean, x, y;
};
Parts split(const Mat2& s) {
  return {0.5 * s.trace(), 0.5 * (s(0, 0) - s(1, 1)), 0.5 * (s(0, 1) + s(1, 0))};
}

// kappa/(kappa + 1) with kappa = 1 + 8 mu c.
double eshelby(const Material& m) {
  return (1 + 8 * m.mu * m.c) / (2 + 8 * m.mu * m.c);
}

// The tractions on a cut at the angle: normal and tangential components of s n, n = (-sin, cos).
Vec2 on_cut(const Parts& s, double angle) {
  const double c = std::cos(2 * angle), d = std::sin(2 * angle);
  return {s.mean - s.x * c - s.y * d, s.y * c - s.x * d};
}

double crack_part(const Material& m, double angle, const Mat2& s, const Mat2& t, bool open) {
  const Vec2 a = on_cut(split(s), angle), b = on_cut(split(t), angle);
  return 2 / plane_modulus(m) * (a.y() * b.y() + (open ? a.x() * b.x() : 0));
}

double in_half_turn(double angle) {
  const double a = angle - pi * std::floor(angle / pi);
  return a < pi ? a : 0;
}

// sum factor (s e).(t e) = e.M e for every unit vector e.
Parts squares(std::span<const Product> products) {
  Mat2 sum = Mat2::Zero();
  for (const Product& q : products) sum += q.factor * symmetric(q.s) * symmetric(q.t);
  return split(sum);
}

// e.M e is largest at the axis, least across it.
double axis(const Parts& m) {
  return in_half_turn(0.5 * std::atan2(m.y, m.x));
}

Oriented best_ellipse(const Perturbation& p, const Material& m, std::span<const Product> products) {
  Oriented best;
  if (p.aspect > 1) best.angle = axis(squares(products));
  for (const Product& q : products) best.value += q.factor * ellipse_form(m, p.aspect, best.angle, q.s, q.t);
  return best;
}

// Bodies whose stresses open the crack in different directions: searched.
Oriented searched_crack(const Material& m, std::span<const Product> products) {
  const auto value = [&](double angle) {
    double sum = 0;
    for (const Product& q : products) sum += q.factor * crack_form(m, angle, q.s, q.t);
    return sum;
  };
  constexpr int steps = 720;
  double best = 0;
  for (int i = 1; i < steps; ++i)
    if (std::abs(value(i * pi / steps)) > std::abs(value(best))) best = i * pi / steps;
  double low = best - pi / steps, high = best + pi / steps;
  constexpr double golden = 0.6180339887498949;
  for (int i = 0; i < 50; ++i) {
    const double a = high - golden * (high - low), b = low + golden * (high - low);
    (std::abs(value(a)) > std::abs(value(b)) ? high : low) = std::abs(value(a)) > std::abs(value(b)) ? b : a;
  }
  const double refined = 0.5 * (low + high);
  if (std::abs(value(refined)) > std::abs(value(best))) best = refined;
  return {value(best), in_half_turn(best)};
}

Oriented worst_crack(const Material& m, std::span<const Product> products) {
  Oriented worst;
  if (products.empty()) return worst;
  for (const Product& q : products)
    if (q.s != products[0].s) return searched_crack(m, products);
  const auto take = [&](double angle, bool open) {
    double value = 0;
    for (const Product& q : products) value += q.factor * crack_part(m, angle, q.s, q.t, open);
    if (std::abs(value) > std::abs(worst.value)) worst = {value, in_half_turn(angle)};
  };
  const Parts first = split(products[0].s);
  const auto opens = [&](double angle) { return on_cut(first, angle).x() > 0; };
  // Open: n.M n, extreme along the axes of M. Closed: sum factor s_nt t_nt, a wave in 4 angle.
  const double open_at = axis(squares(products));
  for (const double angle : {open_at, open_at + pi / 2})
    if (opens(angle)) take(angle, true);
  double even = 0, odd = 0;
  for (const Product& q : products) {
    const Parts a = split(q.s), b = split(q.t);
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
  return worst;
}

}  // namespace

double scale(const Perturbation& p, double eps) {
  if (p.kind == Perturbation::Kind::ClampedHole) return std::numeric_limits<double>::quiet_NaN();
  return pi * eps * eps;
}

double hole_form(const Material& m, const Mat2& s, const Mat2& t) {
  const Mat2 a = symmetric(s), b = symmetric(t);
  return (4 * a.cwiseProduct(b).sum() - a.trace() * b.trace()) / plane_modulus(m);
}

double hole_energy(const Material& m, const Mat2& s, const Vec2& body, const Vec2& u) {
  return -0.5 * hole_form(m, s, s) + body.dot(u);
}

// Ph = (c - c*) (1 + 4 mu c)/(1 + 4 mu c*), Pd = (r - 1)/(2 mu (1 + beta (r - 1))), r = mu*/mu; each divided by the
// larger of the pair, which may be infinite.
double inclusion_form(const Material& matrix, const Material& inside, const Mat2& s, const Mat2& t) {
  const double mu = matrix.mu, c = matrix.c, beta = eshelby(matrix), r = inside.mu / mu;
  const double contrast =
      inside.c > c ? (c / inside.c - 1) / (1 / inside.c + 4 * mu) : (c - inside.c) / (1 + 4 * mu * inside.c);
  const double hydrostatic = contrast * (1 + 4 * mu * c);
  const double deviatoric = (r > 1 ? (1 - 1 / r) / ((1 - beta) / r + beta) : (r - 1) / (1 + beta * (r - 1))) / (2 * mu);
  const Parts a = split(s), b = split(t);
  return -4 * hydrostatic * a.mean * b.mean - 2 * deviatoric * (a.x * b.x + a.y * b.y);
}

double ellipse_form(const Material& m, double aspect, double angle, const Mat2& s, const Mat2& t) {
  if (!(aspect >= 1))
    throw Error(Fault::Usage, "elliptic hole: the aspect is " + std::to_string(aspect) + ", it must be at least 1");
  const Mat2 a = symmetric(s), b = symmetric(t);
  const Vec2 longer(std::cos(angle), std::sin(angle)), shorter(-longer.y(), longer.x());
  return (2 * a.cwiseProduct(b).sum() - a.trace() * b.trace() + 2 * aspect * (a * shorter).dot(b * shorter) +
          2 / aspect * (a * longer).dot(b * longer)) /
         plane_modulus(m);
}

double crack_form(const Material& m, double angle, const Mat2& s, const Mat2& t) {
  return crack_part(m, angle, s, t, on_cut(split(s), angle).x() > 0);
}

double form(const Perturbation& p, const Material& m, double angle, const Mat2& s, const Mat2& t) {
  switch (p.kind) {
    case Perturbation::Kind::Hole:
      return hole_form(m, s, t);
    case Perturbation::Kind::Inclusion:
      return inclusion_form(m, p.inclusion, s, t);
    case Perturbation::Kind::Ellipse:
      return ellipse_form(m, p.aspect, angle, s, t);
    case Perturbation::Kind::Crack:
      return crack_form(m, angle, s, t);
    case Perturbation::Kind::ClampedHole:
      break;
  }
  throw Error(Fault::Usage, "a clamped hole has no expansion in powers of its radius: use clamped_force");
}

Transmission inside(const Perturbation& p, const Material& m) {
  if (p.kind == Perturbation::Kind::Hole) return {};
  if (p.kind != Perturbation::Kind::Inclusion)
    throw Error(Fault::Usage,
                "the stress around an ellipse, a crack or a clamped hole is not that of a circle: "
                "only a hole or an inclusion has multipliers");
  const double beta = eshelby(m);
  return {(1 + 4 * m.mu * m.c) / (1 + 4 * m.mu * p.inclusion.c), 1 / ((1 - beta) * (m.mu / p.inclusion.mu) + beta)};
}

Oriented oriented(const Perturbation& p, const Material& m, std::span<const Product> products) {
  const bool turned = p.kind == Perturbation::Kind::Ellipse || p.kind == Perturbation::Kind::Crack;
  if (turned && !p.angle)
    return p.kind == Perturbation::Kind::Ellipse ? best_ellipse(p, m, products) : worst_crack(m, products);
  Oriented result{0, turned ? *p.angle : 0};
  for (const Product& q : products) result.value += q.factor * form(p, m, result.angle, q.s, q.t);
  return result;
}

}  // namespace kerf
