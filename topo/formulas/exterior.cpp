// What a small free ellipse or crack does to a power of the von Mises stress in the plane around it [theory: T.34]:
//   Psi(s) = 1/pi int over the outside of Phi(s + w) - Phi(s) - Phi'(s):w,   Phi = V^(p/2),
// w the stress that the cut adds to the uniform stress s, in closed form by the conformal map z = R (xi + m/xi) and the
// potentials of [Muskhelishvili 1953; theory: T.35]. `Exterior` integrates: beyond |xi| = 2 with Gauss points in
// 1/|xi|^2, nearer by in triangles around the tip xi = 1, in the distance from it by the double exponential rule
// [Takahasi, Mori 1974], since Phi ~ |xi - 1|^(-p) there; symmetry gives the other half of the plane. `tabulate`
// samples Psi on a grid of two angles, that between mean and deviator of s and that of its principal axes, in which Psi
// is periodic, and doubles the grid until interpolation with eight points each way meets values in between. Derived in
// docs/theory/topological_derivatives.md, section "Functionals of the stress".

#include "topo/formulas/exterior.hpp"

#include "base/quadrature.hpp"
#include "topo/formulas/parts.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

namespace kerf {

namespace {

using Complex = std::complex<double>;

// z = R (xi + m/xi) maps |xi| > 1 to the plane around the cut.
struct Map {
  // Of an ellipse with a b = 1 (area pi), or of a cut with a = 1, b = 0. rest is kept by itself: 1 - m cancels for flat
  // ellipses.
  double radius, m, rest;  // rest = 1 - m
  explicit Map(const CutShape& cut) {
    const double a = cut.kind == CutShape::Kind::Ellipse ? std::sqrt(cut.aspect) : 1,
                 b = cut.kind == CutShape::Kind::Ellipse ? 1 / a : 0;
    radius = 0.5 * (a + b);
    m = (a - b) / (a + b);
    rest = 2 * b / (a + b);
  }
};

// A point xi = exp(x + i y).
struct Place {
  // Everything that vanishes at a tip is formed without a difference: |xi|^2 - 1 by expm1, q = xi^2 - m from it and
  // from sin^2, since both are of the size of the distance from the tip.
  Complex xi;
  double square, outside;  // |xi|^2, and |xi|^2 - 1
  Complex q;               // xi^2 - m
  Complex lifted;          // conj(xi) - m xi
  //  x = ln |xi|, y = arg xi
  Place(const Map& map, double x, double y) : xi(std::polar(std::exp(x), y)) {
    outside = std::expm1(2 * x);
    square = 1 + outside;
    const double s = std::sin(y);
    q = Complex(outside - 2 * square * s * s + map.rest, square * std::sin(2 * y));
    lifted = Complex(map.rest * xi.real(), -(1 + map.m) * xi.imag());
  }
};

// Mean, x, y of the stress that the cut adds to a uniform stress. With gamma = mean/2, gamma' = -x + i y of that and
// B = 2 m gamma + conj(gamma'), without the parts that cancel [theory: T.35].
std::array<double, 3> added(const Map& map, const Place& at, double mean, Complex gamma) {
  // The argument gamma is gamma' of (T.35), the argument mean its 2 gamma.
  const Complex B = map.m * mean + std::conj(gamma), turned = mean + map.m * gamma;
  const Complex xi3 = at.xi * at.xi * at.xi;
  const double gap = map.rest * (1 + map.m);  // 1 - m^2
  const Complex first = B / at.q,
                second = -2.0 * (xi3 / (at.q * at.q)) * (B / at.q) * (at.outside / at.square) * at.lifted -
                         (map.m * at.q - gap) / at.q * first + turned / at.q;
  return {2 * first.real(), -second.real(), second.imag()};
}

constexpr double near = 0.6931471805599453;  // ln 2: |xi| < 2 around the tips, the rest in 1/|xi|^2

// Points on (0, 1) for integrands like u^(power - 1) at 0, whatever the power [Takahasi, Mori 1974]; the last one
// stands for all below.
struct Radial {
  std::vector<double> u, weight;
  Radial(double power, int fine) {
    // u = 1/(1 + exp(-pi sinh(k step))). The rule goes down to where u^power is 1e-12, or u = 1e-70, and up to where 1
    // - u is rounding.
    const double digits = std::min(70., 12 / power), step = 0.11 / fine;
    const int first = -static_cast<int>(std::asinh(digits * std::log(10.) / pi) / step),
              last = static_cast<int>(3.1 / step);
    const auto beyond = [&](double k) { return std::exp(-pi * std::sinh(k * step)); };
    for (int k = first; k <= last; ++k) {
      const double e = beyond(k), at = 1 / (1 + e);
      u.push_back(at);
      weight.push_back(step * pi * std::cosh(k * step) * at * e / (1 + e));
    }
    // The integral of u^(power - 1) from 0 to u is u^power/power.
    u.push_back(1 / (1 + beyond(first - 0.5)));
    weight.push_back(u.back() / power);
  }
};

}  // namespace

Exterior::Exterior(const VonMises& law, double p, const CutShape& cut, int more) : law_(law), p_(p) {
  // Large powers concentrate around the tips: twice the points.
  const int fine = p > 5 ? 2 * more : more;
  const Map map(cut);
  // A closed crack lets normal stress along and across pass: of the three parts of s the shear alone is disturbed.
  const bool all = cut.kind != CutShape::Kind::Closed;
  const auto add = [&](double x, double y, double weight) {
    const Place at(map, x, y);
    // Half of the plane, twice; the area element is R^2 |1 - m/xi^2|^2.
    Node node{2 / pi * map.radius * map.radius * std::norm(at.q) / (at.square * at.square) * weight, {}};
    if (all) {
      node.added[0] = added(map, at, 1, 0);
      node.added[1] = added(map, at, 0, -1);
    }
    node.added[2] = added(map, at, 0, Complex(0, 1));
    nodes_.push_back(node);
  };
  // Far away: t = 1/|xi|^2.
  const int around = 24 * fine;
  const EdgeRule far = gauss(10 * fine);
  for (Eigen::Index i = 0; i < far.s.size(); ++i)
    for (int k = 0; k < around; ++k) {
      const double t = 0.25 * far.s[i];
      // t runs to 1/4 at |xi| = 2; |xi| d|xi| = dt/(2 t^2).
      add(-0.5 * std::log(t), pi * ((k + 0.5) / around - 0.5), 0.25 * far.w[i] * pi / around / (2 * t * t));
    }
  // The four triangles around the tip xi = 1.
  const EdgeRule across = gauss(10 * fine);
  // Duffy's coordinates u, u v on two triangles either side of the axis: with the Jacobian u and the area element the
  // integrand is like u^(3 - p) at the tip of a crack; the field at the end of an ellipse is bounded.
  const Radial radial(cut.kind == CutShape::Kind::Ellipse ? 2 : 4 - p, fine);
  for (std::size_t i = 0; i < radial.u.size(); ++i)
    for (Eigen::Index k = 0; k < across.s.size(); ++k)
      for (const double side : {-1., 1.}) {
        const double u = radial.u[i], v = across.s[k];
        const double weight = radial.weight[i] * across.w[k] * u * near * 0.5 * pi;
        for (const auto& [x, y] : {std::pair(u, u * v), std::pair(u * v, u)})
          add(near * x, side * 0.5 * pi * y, weight * std::exp(2 * near * x));
      }
}

double Exterior::operator()(double mean, double x, double y) const {
  const double share = law_.share, h = 0.5 * p_, v = share * mean * mean + 3 * (x * x + y * y);
  const double whole = v > 0 ? std::pow(v, h) : 0, lower = v > 0 ? std::pow(v, h - 1) : 0;
  double sum = 0;
  // Where V changes by less than a tenth, the difference is expanded in slope/V: far from the cut it would cancel.
  for (const Node& n : nodes_) {
    Parts w;
    for (std::size_t k = 0; k < 3; ++k) w[k] = n.added[0][k] * mean + n.added[1][k] * x + n.added[2][k] * y;
    const double first = 2 * (share * mean * w[0] + 3 * (x * w[1] + y * w[2])),
                 second = share * w[0] * w[0] + 3 * (w[1] * w[1] + w[2] * w[2]), slope = first + second;
    sum +=
        n.weight * (std::abs(slope) < 0.1 * v ? lower * (slope * slope / v * power_remainder(h, slope / v) + h * second)
                                              : std::pow(std::max(v + slope, 0.), h) - whole - h * lower * first);
  }
  return sum;
}

namespace {

constexpr int points = 8;  // of an interpolation

// Where a periodic angle lies among n nodes, and the weights of those around it.
// Lagrange's interpolation of degree 7; the place lies between the middle two of its nodes.
struct Stencil {
  std::array<Eigen::Index, points> at;
  std::array<double, points> weight;
  Stencil(double angle, double period, Eigen::Index n) {
    const double place = angle / period * static_cast<double>(n), below = std::floor(place), f = place - below;
    for (int i = 0; i < points; ++i) {
      const auto k = (static_cast<Eigen::Index>(below) + i - points / 2 + 1) % n;
      at[static_cast<std::size_t>(i)] = k < 0 ? k + n : k;
      double w = 1;
      for (int j = 0; j < points; ++j)
        if (j != i) w *= (f - (j - points / 2 + 1)) / (i - j);
      weight[static_cast<std::size_t>(i)] = w;
    }
  }
};

// Rows are the first angle, of period pi, columns the second, of period 2 pi.
double interpolated(const CutTable& table, double first, double second) {
  const Stencil a(first, pi, table.values.rows()), b(second, 2 * pi, table.values.cols());
  double sum = 0;
  for (std::size_t j = 0; j < points; ++j) {
    double column = 0;
    for (std::size_t i = 0; i < points; ++i) column += a.weight[i] * table.values(a.at[i], b.at[j]);
    sum += b.weight[j] * column;
  }
  return table.root == 1 ? sum : std::pow(std::max(sum, 0.), 1 / table.root);
}

double at_angles(const Exterior& integral, double first, double second) {
  return integral(std::cos(first), std::sin(first) * std::cos(second), std::sin(first) * std::sin(second));
}

// A quarter of the angles is enough: s and -s, and mirror images, have one value.
void fill(CutTable& table, const Exterior& integral, Eigen::Index n) {
  table.values.resize(n, 2 * n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j <= n / 2; ++j) {
      const double step = pi / static_cast<double>(n);
      const double value = std::pow(
          std::max(at_angles(integral, static_cast<double>(i) * step, static_cast<double>(j) * step), 0.), table.root);
      // s -> -s maps the first angle to pi minus it after a turn of the second by pi; a mirror changes the sign of the
      // second.
      const Eigen::Index opposite = (n - i) % n;
      table.values(i, j) = table.values(i, (2 * n - j) % (2 * n)) = value;
      table.values(opposite, n - j) = table.values(opposite, n + j) = value;
    }
}

// The largest error between the nodes, at places all over.
// The middle of intervals of the first angle, where interpolation is worst, with the second one spread by the golden
// ratio. Cracks are measured against the largest value: Psi of a closed crack vanishes where there is no shear.
double error_between(const CutTable& table, const Exterior& integral, bool of_largest) {
  constexpr int places = 24;
  constexpr double golden = 0.6180339887498949;
  const double largest = of_largest ? std::pow(table.values.maxCoeff(), 1 / table.root) : 0;
  const double half = 0.5 * pi / static_cast<double>(table.values.rows());
  double worst = 0;
  for (int k = 0; k < places; ++k) {
    const double first = pi * std::floor((k + 0.5) / places * static_cast<double>(table.values.rows())) /
                             static_cast<double>(table.values.rows()) +
                         half,
                 second = 2 * pi * std::fmod(k * golden, 1.);
    const double exact = at_angles(integral, first, second);
    worst = std::max(worst, std::abs(interpolated(table, first, second) - exact) / std::max(exact, largest));
  }
  return worst;
}

}  // namespace

CutTable tabulate(const VonMises& law, double p, const CutShape& cut) {
  require_power(law, p);
  const bool crack = cut.kind != CutShape::Kind::Ellipse;
  if (crack && !(p < 4))
    throw Error(Fault::Usage, "the stress to the power " + std::to_string(p) +
                                  " is not integrable at the tips of a crack, however short: a power below 4 has an "
                                  "expansion for small cracks; or use a hole or an ellipse");
  const Exterior integral(law, p, cut);
  // Large powers around sharp ellipses span many orders of magnitude.
  // Psi^(4/p) is homogeneous of degree 4 in s.
  CutTable table{law, p, std::min(1., 4 / p), {}};
  const double enough = p > 5 ? 1e-4 : 1e-5;
  constexpr Eigen::Index most = 128;
  for (Eigen::Index n = 16; n <= most; n *= 2) {
    fill(table, integral, n);
    if (error_between(table, integral, crack) < enough) break;
  }
  return table;
}

// The angle of the deviator is twice that of its axes, so that a turned cut turns it by twice its angle.
double exterior(const CutTable& table, const Mat2& s, double angle) {
  const PlaneParts parts = split(s);
  const double deviator = std::hypot(parts.x, parts.y), size = std::hypot(parts.mean, deviator);
  if (!(size > 0)) return 0;
  return std::pow(size, table.p) *
         interpolated(table, std::atan2(deviator, parts.mean), std::atan2(parts.y, parts.x) - 2 * angle);
}

}  // namespace kerf
