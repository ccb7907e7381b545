// Powers of the von Mises stress, Phi = V^(p/2), V = A s^2 + 3 d^2 with s, d half the sum and half the difference of
// the principal stresses, and what a small circle does to int w Phi by its own stress field [Amstutz, Novotny 2010]:
//   Psi(s) = int_0^1 1/(2 pi) int_0^2pi (Phi(s + w) - Phi(s) - Phi'(s):w)/t^2 dtheta dt,   t = 1/r^2,
// with Kirsch's field w [theory: T.2, T.20]. Psi is homogeneous of degree p and isotropic, so that Psi = (s^2 +
// d^2)^(p/2) psi(y), y = d^2/(s^2 + d^2), and psi is tabulated by Chebyshev sums on pieces of [0, 1] [theory: T.22].
// For even p the integrand is a polynomial in t, cos 2 theta, sin 2 theta and the rule is exact. For others Phi has a
// corner where the stress vanishes: cells of (theta, t) are quartered there, pieces of y halved. Derived in
// docs/theory/topological_derivatives.md, section "Functionals of the stress".

#include "topo/formulas/von_mises.hpp"

#include "base/quadrature.hpp"
#include "topo/formulas/parts.hpp"
#include "topo/mutation.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr int terms = 17;  // Chebyshev coefficients of a piece: exact up to p = 32

struct Invariants {
  double mean, shear;  // shear = d^2
};
Invariants invariants(const Mat2& s) {
  const PlaneParts p = split(s);
  return {p.mean, p.x * p.x + p.y * p.y};
}

// [Phi(s + w) - Phi(s) - Phi'(s):w]/t^2 at t = 1/r^2, in the principal frame of s = (mean, d).
struct Integrand {
  // added_*: q_h s and q_d d of (T.2); whole = V^h, lower = V^(h - 1) of the undisturbed stress, h = p/2.
  double share, h, mean, d, added_mean, added_d, whole = 0, lower = 0;

  Integrand(const PowerTable& table, double mean, double d)
      : share(table.outer.share),
        h(0.5 * table.p),
        mean(mean),
        d(d),
        added_mean(mean * (1 - table.inside.hydrostatic)),
        added_d(d * (1 - table.inside.deviatoric)) {
    if (square() > 0) {
      whole = std::pow(square(), h);
      lower = std::pow(square(), h - 1);
    }
  }
  double square() const {
    return share * mean * mean + 3 * d * d;
  }

  // w = t (m I + [[x, y], [y, -x]]) in the frame of the circle; c, s = cos, sin 2 theta.
  double operator()(double c, double s, double t) const {
    const double m = -2 * added_d * c, x = -added_mean + added_d * (3 * t - 2) * c, y = added_d * (3 * t - 2) * s;
    const double first = 2 * (share * mean * m + 3 * d * (c * x - s * y)), second = share * m * m + 3 * (x * x + y * y);
    // V(s + w) = V + t slope. A change below a tenth of V is expanded: the difference, divided by t^2, would cancel.
    const double slope = first + t * second, v = square();
    if (std::abs(t * slope) < 0.1 * v)
      return lower * (slope * slope / v * power_remainder(h, t * slope / v) + h * second);
    return (std::pow(std::max(v + t * slope, 0.), h) - whole - h * lower * t * first) / (t * t);
  }
};

struct Cell {
  double a, b, from, to;  // theta, t
};

// Gauss points in both variables.
double over(const Integrand& f, const EdgeRule& rule, const Cell& q) {
  double sum = 0;
  for (Eigen::Index i = 0; i < rule.s.size(); ++i) {
    const double angle = q.a + rule.s[i] * (q.b - q.a), c = std::cos(2 * angle), s = std::sin(2 * angle);
    double line = 0;
    for (Eigen::Index j = 0; j < rule.s.size(); ++j) line += rule.w[j] * f(c, s, q.from + rule.s[j] * (q.to - q.from));
    sum += rule.w[i] * line;
  }
  return sum * (q.b - q.a) * (q.to - q.from);
}

// Quarters cells where the stress vanishes: Phi has a corner there.
struct Refinement {
  const Integrand& f;
  const EdgeRule& rule;
  double tolerance;

  double operator()(const Cell& q, double before, int depth) const {
    const double mid = 0.5 * (q.a + q.b), half = 0.5 * (q.from + q.to);
    const Cell parts[] = {
        {q.a, mid, q.from, half}, {mid, q.b, q.from, half}, {q.a, mid, half, q.to}, {mid, q.b, half, q.to}};
    double value[4], sum = 0;
    for (int i = 0; i < 4; ++i) sum += value[i] = over(f, rule, parts[i]);
    if (depth == 0 || std::abs(sum - before) < tolerance) return sum;
    sum = 0;
    for (int i = 0; i < 4; ++i) sum += (*this)(parts[i], value[i], depth - 1);
    return sum;
  }
};

// A quarter of the circle is enough. Even p: the integrand is a polynomial in t, cos 2 theta and sin 2 theta.
double integral(const PowerTable& table, bool even, const EdgeRule& rule, double y) {
  const Integrand f(table, std::sqrt(1 - y), std::sqrt(y));
  double sum = 0;
  if (even) {
    // A polynomial of degree p in cos 2 theta: Chebyshev's p + 1 points are exact.
    const int n = static_cast<int>(table.p) + 1;
    for (int k = 0; k < n; ++k)
      for (Eigen::Index j = 0; j < rule.s.size(); ++j) {
        const double twice = (k + 0.5) * pi / n;
        sum += rule.w[j] * f(std::cos(twice), std::sin(twice), rule.s[j]) / n;
      }
    return sum;
  }
  // Bands in t down to where w is small against s.
  std::vector<Cell> bands;
  double top = 1;
  for (; top > 1e-8 && 10 * top > std::sqrt(f.square()); top /= 4) bands.push_back({0, pi / 2, top / 4, top});
  bands.push_back({0, pi / 2, 0, top});
  std::vector<double> coarse;
  for (const Cell& band : bands) sum += coarse.emplace_back(over(f, rule, band));
  const Refinement refined{f, rule, 3e-13 * std::abs(sum)};
  sum = 0;
  for (std::size_t i = 0; i < bands.size(); ++i) sum += refined(bands[i], coarse[i], 16);
  return sum * 2 / pi;
}

// Adds pieces until the sums are exact, or depth is 0.
struct Tabulation {
  PowerTable& table;
  bool even;
  EdgeRule rule;

  void add(double from, double to, int depth) {
    // Chebyshev's nodes y = from + (to - from) sin^2(angle/2), and the discrete cosine transform of the values there.
    Eigen::VectorXd value(terms), sum(terms);
    const auto node = [](int i) { return pi * (i + 0.5) / terms; };
    for (int i = 0; i < terms; ++i)
      value[i] = integral(table, even, rule, from + (to - from) * std::pow(std::sin(0.5 * node(i)), 2));
    for (int k = 0; k < terms; ++k) {
      sum[k] = 0;
      for (int i = 0; i < terms; ++i) sum[k] += value[i] * std::cos(k * node(i)) * (k ? 2. : 1.) / terms;
    }
    const double least = value.cwiseAbs().minCoeff(), most = value.cwiseAbs().maxCoeff();
    // Against the least value: psi may fall to a small share of its largest within a piece, and relative errors count.
    const bool smooth = sum.tail<3>().cwiseAbs().maxCoeff() < 1e-11 * least && most < 1e3 * least;
    if (!smooth && depth > 0) {
      const double mid = 0.5 * (from + to);
      add(from, mid, depth - 1);
      add(mid, to, depth - 1);
      return;
    }
    table.ends.push_back(to);
    table.sums.conservativeResize(terms, table.sums.cols() + 1);
    table.sums.rightCols<1>() = sum;
  }
};

}  // namespace

double power_remainder(double h, double x) {
  double term = 0.5 * h * (h - 1), sum = term;
  for (int k = 3; k < 40 && std::abs(term) > 1e-18 * std::abs(sum); ++k) sum += term *= (h - k + 1) / k * x;
  return sum;
}

void require_power(const VonMises& outer, double p) {
  if (!(p >= 1 && p <= 100))
    throw Error(Fault::Usage, "von Mises stress: the power is " + std::to_string(p) + ", it must lie in [1, 100]");
  if (p < 2 && outer.share < 1e-3)
    throw Error(Fault::Usage,
                "von Mises stress: a power below 2 needs a material that is not incompressible, the power "
                "is " +
                    std::to_string(p));
}

double square(const VonMises& v, const Mat2& s) {
  const Invariants i = invariants(s);
  return v.share * i.mean * i.mean + 3 * i.shear;
}

double power(const VonMises& v, double p, const Mat2& s) {
  return std::pow(square(v, s), 0.5 * p);
}

Mat2 power_derivative(const VonMises& v, double p, const Mat2& s) {
  const double value = square(v, s);
  if (!(value > 0)) return Mat2::Zero();
  const Mat2 mean = 0.5 * s.trace() * Mat2::Identity();
  return 0.5 * p * std::pow(value, 0.5 * p - 1) * (v.share * mean + 3 * (0.5 * (s + s.transpose()) - mean));
}

// Pieces in y = d^2/(m^2 + d^2), the share of the deviator, from 0 to 1.
PowerTable tabulate(const VonMises& outer, double p, const Transmission& inside, const VonMises& inner) {
  require_power(outer, p);
  PowerTable table{outer, inner, p, inside, {0}, Eigen::MatrixXd(terms, 0)};
  const bool even = std::fmod(p, 2) == 0;
  Tabulation pieces{table, even, gauss(even ? 2 * static_cast<int>(p) + 2 : 10)};
  if (even) {
    pieces.add(0, 1, 8);
  } else {
    // From d = |sm|/2 on the stress vanishes somewhere on the rim of a hole.
    pieces.add(0, 0.2, 24);
    pieces.add(0.2, 1, 24);
  }
  return table;
}

double exterior(const PowerTable& table, const Mat2& s) {
  const Invariants i = invariants(s);
  const double size = i.mean * i.mean + i.shear;
  if (!(size > 0)) return 0;
  const double y = i.shear / size;
  const auto piece = std::upper_bound(table.ends.begin() + 1, table.ends.end() - 1, y) - table.ends.begin();
  const double from = table.ends[piece - 1], to = table.ends[piece], x = 2 * (y - from) / (to - from) - 1;
  // Clenshaw; the nodes run from x = -1 (angle 0) on, so odd terms change sign.
  const double* c = table.sums.data() + (piece - 1) * terms;
  double b = 0, before = 0;
  for (int k = terms - 1; k > 0; --k) {
    const double next = c[k] - 2 * x * b - before;
    before = b;
    b = next;
  }
  return std::pow(size, 0.5 * table.p) * (c[0] - x * b - before);
}

// w (Phi*(s_in) - Phi(s) - Phi'(s):(s_in - s) + Psi): inside, what was there, first order, outside.
double local_term(const PowerTable& table, const Mat2& s, double weight) {
  const double mean = 0.5 * s.trace();
  const Mat2 deviator = 0.5 * (s + s.transpose()) - mean * Mat2::Identity();
  const Mat2 in = table.inside.hydrostatic * mean * Mat2::Identity() + table.inside.deviatoric * deviator;
  const Mat2 change = in - mean * Mat2::Identity() - deviator;
  return weight *
         (mutant(FormulaPart::PowerInside) * power(table.inner, table.p, in) -
          mutant(FormulaPart::PowerOutside) * power(table.outer, table.p, s) -
          mutant(FormulaPart::PowerSlope) * power_derivative(table.outer, table.p, s).cwiseProduct(change).sum() +
          mutant(FormulaPart::PowerExterior) * exterior(table, s));
}

}  // namespace kerf
