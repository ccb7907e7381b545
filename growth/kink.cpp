// Kinks by the series of Amestoy and Leblond, searched for angles by bisection of what changes sign.

#include "growth/kink.hpp"

#include "growth/numeric/around.hpp"
#include "growth/numeric/root.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace kerf::growth {

namespace {

constexpr double pi2 = pi * pi, pi3 = pi2 * pi, pi4 = pi2 * pi2, pi5 = pi4 * pi, pi6 = pi4 * pi2;
constexpr double root_of_2pi = 2.5066282746310005024;

// Coefficients of m^0, m^2, ... (even) or m^1, m^3, ... (odd), m = angle/pi [Amestoy, Leblond 1992; theory: G.2].
using Coefficients = std::array<double, 11>;
constexpr Coefficients f11 = {1,
                              -3 * pi2 / 8,
                              pi2 - 5 * pi4 / 128,
                              pi2 / 9 - 11 * pi4 / 72 + 119 * pi6 / 15360,
                              5.07790,
                              -2.88312,
                              -0.0925,
                              2.996,
                              -4.059,
                              1.63,
                              4.1};
constexpr Coefficients f12 = {-3 * pi / 2,
                              10 * pi / 3 + pi3 / 16,
                              -2 * pi - 133 * pi3 / 180 + 59 * pi5 / 1280,
                              12.313906,
                              -7.32433,
                              1.5793,
                              4.0216,
                              -6.915,
                              4.21,
                              4.56,
                              0};
constexpr Coefficients f21 = {pi / 2,
                              -(4 * pi / 3 + pi3 / 48),
                              -2 * pi / 3 + 13 * pi3 / 30 - 59 * pi5 / 3840,
                              -6.176023,
                              4.44112,
                              -1.5340,
                              -2.0700,
                              4.684,
                              -3.95,
                              -1.32,
                              0};
constexpr Coefficients f22 = {1,
                              -(4 + 3 * pi2 / 8),
                              8. / 3 + 29 * pi2 / 18 - 5 * pi4 / 128,
                              -32. / 15 - 4 * pi2 / 9 - 1159 * pi4 / 7200 + 119 * pi6 / 15360,
                              10.58254,
                              -4.78511,
                              -1.8804,
                              7.280,
                              -7.591,
                              0.25,
                              12.5};
constexpr Coefficients g1 = {
    0, 2 * pi* root_of_2pi, -47.933390, 63.665987, -50.70880, 26.66807, -6.0205, -7.314, 10.947, -2.85, -13.7};
constexpr Coefficients g2 = {-2 * root_of_2pi, 12 * root_of_2pi, -59.565733, 61.174444, -39.90249, 15.6222,
                             3.0343,           -12.781,          9.69,       6.62,      0};

struct Value {
  double f, df;  // and its derivative in m
};
Value even(const Coefficients& c, double m) {
  double p = 0, dp = 0;
  const double square = m * m;
  for (int i = 10; i >= 0; --i) dp = dp * square + p, p = p * square + c[i];
  return {p, 2 * m * dp};
}
Value odd(const Coefficients& c, double m) {
  const Value e = even(c, m);
  return {m * e.f, e.f + m * e.df};
}

// k_1, k_2 and their derivatives in the angle.
struct Kinked {
  double k_1, k_2, dk_1, dk_2;
};
Kinked kinked(const TipLoad& tip, double angle, double length) {
  const double m = angle / pi, t = tip.T * std::sqrt(length);
  const auto sum = [&](Value a, Value b, Value c) {
    return Value{a.f * tip.K_I + b.f * tip.K_II + c.f * t, (a.df * tip.K_I + b.df * tip.K_II + c.df * t) / pi};
  };
  const Value first = sum(even(f11, m), odd(f12, m), even(g1, m)), second = sum(odd(f21, m), even(f22, m), odd(g2, m));
  return {first.f, second.f, first.df, second.df};
}

void check(const TipLoad& tip, double length) {
  if (!std::isfinite(tip.K_I) || !std::isfinite(tip.K_II) || !std::isfinite(tip.T))
    throw Error(Fault::Usage,
                fmt::format("K_I = {}, K_II = {}, T = {} of a tip are not numbers; finite ones are wanted", tip.K_I,
                            tip.K_II, tip.T));
  if (!(length >= 0) || !std::isfinite(length))
    throw Error(Fault::Usage, fmt::format("the length of a kink is {}; 0 or more is wanted", length));
}

// The same tip with numbers of about 1, K_I >= 0, and K_II <= 0, so that it turns to positive angles.
struct Turned {
  TipLoad tip;
  double side = 1, length = 0;  // angle = side * angle of `tip`
  bool loaded = false;
};
Turned turned(const TipLoad& tip, double length) {
  check(tip, length);
  const double opening = std::max(tip.K_I, 0.), t = tip.T * std::sqrt(length);
  const double scale = std::max({opening, std::abs(tip.K_II), std::abs(t)});
  if (scale == 0) return {};
  return {{opening / scale, -std::abs(tip.K_II) / scale, t / scale}, tip.K_II > 0 ? -1. : 1., 1, true};
}

Direction at(const TipLoad& tip, double length, double side, double angle) {
  Direction d;
  d.angle = angle == 0 ? 0 : side * angle;
  d.k = kink(tip, d.angle, length);
  d.at_limit = angle >= largest_kink;
  return d;
}

// Where f is largest in [0, largest_kink] by its derivative df.
template <class Function, class Derivative>
double largest_on_a_side(const Function& f, const Derivative& df) {
  static constexpr int steps = 90;
  const auto angle = [](int i) { return largest_kink * std::min(std::max(i, 0), steps) / steps; };
  int best = 0;
  for (int i = 1; i <= steps; ++i)
    if (f(angle(i)) > f(angle(best))) best = i;
  const double low = angle(best - 1), high = angle(best + 1);
  if (df(low) <= 0) return low;
  return df(high) >= 0 ? high : root(df, low, high);
}

template <class Function, class Derivative>
Direction largest_value(const TipLoad& tip, double length, const Function& f, const Derivative& df) {
  const Turned t = turned(tip, length);
  if (!t.loaded) return {};
  const double angle = largest_on_a_side([&](double a) { return f(kinked(t.tip, a, t.length)); },
                                         [&](double a) { return df(kinked(t.tip, a, t.length)); });
  Direction d = at(tip, length, t.side, angle);
  if (tip.K_II == 0 && angle > 0) d.rival = -d.angle;
  return d;
}

}  // namespace

KinkLoad kink(const TipLoad& tip, double angle, double length) {
  check(tip, length);
  if (!(std::abs(angle) <= largest_kink))
    throw Error(Fault::Usage, fmt::format("a kink turns by {} degrees; at most {} are wanted", angle * 180 / pi,
                                          largest_kink * 180 / pi));
  const Kinked k = kinked({std::max(tip.K_I, 0.), tip.K_II, tip.T}, angle, length);
  return {k.k_1, k.k_2};
}

double effective_modulus(double young, double poisson, bool plane_strain) {
  return plane_strain ? young / (1 - poisson * poisson) : young;
}

double release_rate(const KinkLoad& k, double effective_modulus) {
  const double opening = std::max(k.k_1, 0.);
  return (opening * opening + k.k_2 * k.k_2) / effective_modulus;
}

Direction symmetric_direction(const TipLoad& tip, double length) {
  const Turned t = turned(tip, length);
  if (!t.loaded) return {};
  const auto k_2 = [&](double angle) { return kinked(t.tip, angle, t.length).k_2; };
  constexpr int steps = 90;
  double low = 0;
  const bool straight = t.tip.K_II == 0;
  if (straight && kinked(t.tip, 0, t.length).dk_2 >= 0) return at(tip, length, t.side, 0);
  for (int i = 1; i <= steps; ++i) {
    const double high = largest_kink * i / steps;
    if (k_2(high) >= 0) {
      // K_II = 0, and straight on is unstable: the first step has no other root than 0.
      const double angle = straight && i == 1 ? high : root(k_2, low, high);
      Direction d = at(tip, length, t.side, straight ? 0 : angle);
      if (straight) d.rival = angle;
      return d;
    }
    low = high;
  }
  return at(tip, length, t.side, largest_kink);
}

Direction energetic_direction(const TipLoad& tip, double length, const Toughness& toughness) {
  const auto value = [](const Kinked& k) { return release_rate({k.k_1, k.k_2}, 1); };
  if (!toughness)
    return largest_value(tip, length, value,
                         [](const Kinked& k) { return std::max(k.k_1, 0.) * k.dk_1 + k.k_2 * k.dk_2; });
  const Turned t = turned(tip, length);
  if (!t.loaded) return {};
  const auto ratio = [&](double angle) {
    const double tough = toughness(t.side * angle);
    if (!(tough > 0))
      throw Error(Fault::Usage,
                  fmt::format("the toughness at {} degrees from the tip's direction is {}; a positive number is wanted",
                              t.side * angle * 180 / pi, tough));
    return value(kinked(t.tip, angle, t.length)) / tough;
  };
  const LargestAround best = largest_around(ratio, largest_kink, 360);
  Direction d = at(tip, length, t.side, best.angle);
  d.at_limit = std::abs(best.angle) >= largest_kink;
  if (best.rival) d.rival = t.side * *best.rival;
  return d;
}

Direction hoop_direction(const TipLoad& tip) {
  const Turned t = turned({tip.K_I, tip.K_II, 0}, 0);
  if (!t.loaded) return {};
  const double first = t.tip.K_I, second = -t.tip.K_II;
  return at({tip.K_I, tip.K_II, 0}, 0, t.side,
            2 * std::atan2(2 * second, first + std::sqrt(first * first + 8 * second * second)));
}

Direction opening_direction(const TipLoad& tip, double length) {
  return largest_value(
      tip, length, [](const Kinked& k) { return k.k_1; }, [](const Kinked& k) { return k.dk_1; });
}

Direction direction(Criterion criterion, const TipLoad& tip, double length) {
  switch (criterion) {
    case Criterion::LocalSymmetry:
      return symmetric_direction(tip, length);
    case Criterion::Energy:
      return energetic_direction(tip, length);
    case Criterion::HoopStress:
      return hoop_direction(tip);
  }
  return {};
}

bool grows_by_shear(const TipLoad& tip, double K_Ic, double K_IIc, double length) {
  return opening_direction(tip, length).k.k_1 < K_Ic && std::abs(tip.K_II) > K_IIc;
}

namespace {

// exp(w^2) erfc(w) for w >= 0.
double scaled_erfc(double w) {
  if (w < 20) return std::exp(w * w) * std::erfc(w);
  const double q = 1 / (2 * w * w);
  return (1 - q * (1 - 3 * q * (1 - 5 * q * (1 - 7 * q)))) / (w * std::sqrt(pi));
}

// exp(z^2) erfc(-z).
double grown(double z) {
  return z <= 0 ? scaled_erfc(-z) : std::exp(z * z) * std::erfc(-z);
}

void check_path(double x, double slope, double beta) {
  if (!(x >= 0) || !std::isfinite(x) || !std::isfinite(slope) || !std::isfinite(beta))
    throw Error(
        Fault::Usage,
        fmt::format("x = {}, slope = {}, beta = {} of a path: finite numbers and x >= 0 are wanted", x, slope, beta));
}

}  // namespace

double slightly_curved_path(double x, double slope, double beta) {
  check_path(x, slope, beta);
  const double z = beta * std::sqrt(x);
  // exp(z^2) erfc(-z) = sum z^n/Gamma(1 + n/2); the first two terms cancel.
  if (std::abs(z) < 1) {
    double sum = 0, even_term = 1, odd_term = 4 / (3 * std::sqrt(pi)), even_power = 1;
    for (int n = 2; n < 60; n += 2) {
      sum += even_power * (even_term + z * odd_term);
      even_term /= n / 2. + 1, odd_term /= n / 2. + 1.5, even_power *= z * z;
    }
    return slope * x * sum;
  }
  return slope / (beta * beta) * (grown(z) - 1 - 2 * z / std::sqrt(pi));
}

double slightly_curved_slope(double x, double slope, double beta) {
  check_path(x, slope, beta);
  return slope * grown(beta * std::sqrt(x));
}

}  // namespace kerf::growth
