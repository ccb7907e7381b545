// Wedges. With the Airy function r^(s+1) f(theta), f = A cos (s+1)theta + B sin (s+1)theta + C cos (s-1)theta +
// D sin (s-1)theta, f = f' = 0 at theta = alpha,
//   s_tt = s (s+1) r^(s-1) f,  s_rt = -s r^(s-1) f',  s_rr = r^(s-1) (f'' + (s+1) f),
//   2 mu u_r = r^s (-(s+1) f + (k+1) (C cos (s-1)theta + D sin (s-1)theta)),
//   2 mu u_t = r^s (-f' + (k+1) (C sin (s-1)theta - D cos (s-1)theta)),   k + 1 = 8 mu/E'.
// Half the wedge, 0 < theta < alpha, without shear on the bisector answers a displacement u_t there by s_tt, and
// without pressure u_r by s_rt: transforms of stress and slope have the ratios -E'/4 G(s) [theory: M.10],
//   G_0 = (s+1) (A + C)/D where f'(0) = 0,   G_1 = ((s+1) B + (s-1) D)/C where f(0) = 0.
// On s = i y they are -i h(y), h odd, 2 at infinity; with tanh(pi y) <-> 1/(2 sinh(x/2)) the kernel is
//   k(x) = 1/(pi sinh(x/2)) + 1/pi int_0^inf (h - 2 tanh pi y) sin(x y) dy,   s(r) = E'/4 int v'(rho) k(ln r/rho)/r
//   drho.
// r = ((1 + y)/2)^4, the density g(y)/sqrt(1 - y^2), g(-1) = 0, by Gauss and Chebyshev's rule, as in mouth.cpp.

#include "inspect/wedge.hpp"

#include <fmt/format.h>
#include <Eigen/LU>

#include <cmath>
#include <vector>

namespace kerf::inspect {

namespace {

using Number = std::complex<double>;

/// h(y) of a mode.
double transform(int mode, double alpha, double y) {
  const Number i(0, 1), s = i * y, p = s + 1., m = s - 1.;
  const Number cp = std::cos(p * alpha), sp = std::sin(p * alpha), cm = std::cos(m * alpha), sm = std::sin(m * alpha);
  if (mode == 0) {  // D = 1, B = -m/p: two equations for A and C
    const Number f = m / p * sp - sm, slope = m * (cp - cm);
    const Number det = -cp * m * sm + cm * p * sp;
    const Number A = (-f * m * sm - cm * slope) / det, C = (cp * slope + p * sp * f) / det;
    return (i * p * (A + C)).real();
  }
  // C = 1, A = -1: B and D.
  const Number f = cp - cm, slope = m * sm - p * sp;
  const Number det = sp * m * cm - sm * p * cp;
  const Number B = (f * m * cm - sm * slope) / det, D = (sp * slope - p * cp * f) / det;
  return (i * (p * B + m * D)).real();
}

/// The kernel at many places: h by a rule of midpoints, up to where it is 2.
class WedgeKernel {
 public:
  WedgeKernel(int mode, double alpha) {
    constexpr double end = 12;
    constexpr int count = 3000;
    step_ = end / count;
    const double sign = transform(mode, alpha, end / 2) > 0 ? 1 : -1;
    for (int n = 0; n < count; ++n) {
      const double y = (n + 0.5) * step_;
      rest_.push_back(sign * transform(mode, alpha, y) - 2 * std::tanh(pi * y));
    }
  }
  double operator()(double x) const {
    // sin((n + 1/2) d) by its recurrence.
    const double d = step_ * x, twice = 2 * std::cos(d);
    double before = -std::sin(d / 2), now = std::sin(d / 2), sum = 0;
    for (const double rest : rest_) {
      sum += rest * now;
      const double next = twice * now - before;
      before = now;
      now = next;
    }
    return 1 / (pi * std::sinh(x / 2)) + sum * step_ / pi;
  }

 private:
  double step_;
  std::vector<double> rest_;
};

/// The root of the mode's equation sin 2 s alpha -+ s sin 2 alpha = 0 nearest above 1/2 that is no rigid motion.
double exponent(int mode, double alpha) {
  const auto f = [&](double s) {
    const double value = std::sin(2 * s * alpha) + (mode == 0 ? s : -s) * std::sin(2 * alpha);
    return mode == 0 ? value : value / (s - 1);
  };
  constexpr double step = 0.0101;
  double low = 0.4999;
  for (double high = low + step; high < 2.1; low = high, high += step) {
    if (f(low) * f(high) > 0) continue;
    for (int i = 0; i < 60; ++i) {
      const double middle = (low + high) / 2;
      (f(low) * f(middle) <= 0 ? high : low) = middle;
    }
    return (low + high) / 2;
  }
  return 0.5;
}

}  // namespace

double wedge_intensity(int mode, double alpha, double power, int n) {
  constexpr int grading = 4;
  const WedgeKernel kernel(mode, alpha);
  const auto at = [](double angle) { return std::pow(std::cos(angle / 2), 2 * grading); };
  Eigen::MatrixXd all(n, n);
  Eigen::VectorXd load = Eigen::VectorXd::Zero(n), tip(n);
  for (int q = 0; q < n; ++q) {
    const double angle = (2 * q + 1) * pi / (2 * n), sign = q % 2 == 0 ? 1 : -1, rho = at(angle);
    tip[q] = sign / std::tan(angle / 2) / n;
    all(n - 1, q) = sign * std::tan(angle / 2) / n;
    for (int r = 0; r < n - 1; ++r) {
      const double x = at((r + 1) * pi / n);
      all(r, q) = pi / n * kernel(std::log(x / rho)) / x;
    }
  }
  for (int r = 0; r < n - 1; ++r) load[r] = std::pow(at((r + 1) * pi / n), power);
  const double g = tip.dot(all.partialPivLu().solve(load));
  // v' = K/(2 sqrt(2 pi (1 - r))) 4/E' = g/sqrt(grading (1 - r)).
  return std::abs(g) * 2 * std::sqrt(2. / grading);
}

Wedge wedge(double half_angle, int points) {
  if (!(half_angle > pi / 2 && half_angle <= pi * (1 + 1e-12)))
    throw Error(Fault::Usage,
                fmt::format("a corner with {:.4g} degrees of material is not reentrant", 2 * half_angle * 180 / pi));
  Wedge w{.half_angle = half_angle};
  for (int mode = 0; mode < 2; ++mode) {
    const auto m = static_cast<std::size_t>(mode);
    w.lambda[m] = exponent(mode, half_angle);
    w.factor[m] =
        std::sqrt(pi) * std::pow(2 * pi, w.lambda[m] - 1) * wedge_intensity(mode, half_angle, w.lambda[m] - 1, points);
  }
  return w;
}

PolarField wedge_field(int mode, const Wedge& of, bool dual, const Material& material, double r, double theta) {
  const double lambda = of.lambda[static_cast<std::size_t>(mode)], s = dual ? -lambda : lambda, alpha = of.half_angle;
  const double p = s + 1, m = s - 1;
  // f'(alpha) = 0 of mode 0, f(alpha) = 0 of mode 1; the other one follows.
  const bool even = mode == 0;
  double a = even ? m * std::sin(m * alpha) : std::sin(m * alpha);
  double c = even ? -p * std::sin(p * alpha) : -std::sin(p * alpha);
  const double scale = dual ? 1 : std::pow(2 * pi, s - 1) / (even ? s * p * (a + c) : -s * (p * a + m * c));
  a *= scale;
  c *= scale;
  const double cp = std::cos(p * theta), sp = std::sin(p * theta), cm = std::cos(m * theta), sm = std::sin(m * theta);
  const double f = even ? a * cp + c * cm : a * sp + c * sm;
  const double slope = even ? -a * p * sp - c * m * sm : a * p * cp + c * m * cm;
  const double second = even ? -a * p * p * cp - c * m * m * cm : -a * p * p * sp - c * m * m * sm;
  const double stress = std::pow(r, s - 1), displacement = std::pow(r, s) / (2 * material.mu),
               k = 8 * material.mu / plane_modulus(material);
  return {.rr = stress * (second + p * f),
          .tt = stress * s * p * f,
          .rt = -stress * s * slope,
          .u_r = displacement * (-p * f + k * c * (even ? cm : sm)),
          .u_t = displacement * (-slope + k * c * (even ? sm : -cm))};
}

}  // namespace kerf::inspect
