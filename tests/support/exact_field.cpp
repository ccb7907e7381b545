// Exact fields of plane elasticity, as displacement, stress, rotation and, for smooth ones, body force.
// Straight cracks: Westergaard's functions [Westergaard 1939]; 2 mu u has Z, its primitive P and y Z, the stress Z and
// y Z', in the closed upper half plane; Z(conj z) = conj Z(z) gives the lower one. Normal load p0 + p1 s on |s| < a:
//   open          Z = (p0 z + p1 (z^2 - a^2/2))/sqrt(z^2 - a^2)
//   closed        Z = p0 + p1 z
//   partly open   on (c, a), where the faces meet smoothly at c: K = 0 there
// The lens is open within |s| < L, Z = -p2 z sqrt(z^2 - L^2). Kirsch's hole: Goursat's functions in powers of R/z.
// Smooth fields: u = (d2 s, -d1 s) + stretch w with products of one-dimensional functions; the pressure squeeze div w
// stays finite at nu = 1/2, and the body force is -div sigma.

#include "tests/support/exact_field.hpp"

#include "tests/support/exact_families.hpp"

#include <cmath>
#include <complex>
#include <stdexcept>

namespace kerf::exact {
namespace {

using Complex = std::complex<double>;

struct Values {
  Vec2 u;
  Mat2 stress;
  double rotation;
};

Complex complex(const Vec2& x) {
  return {x.x(), x.y()};
}

Vec2 plane(const Complex& z) {
  return {z.real(), z.imag()};
}

/// From the mean s = sxx + syy and d = syy - sxx + 2i sxy.
Mat2 stress_of(double s, const Complex& d) {
  Mat2 t;
  t << (s - d.real()) / 2, d.imag() / 2, d.imag() / 2, (s + d.real()) / 2;
  return t;
}

template <class Evaluate>
void set_fields(ExactField& field, const Evaluate& evaluate) {
  field.displacement = [evaluate](const Vec2& x, int side) { return evaluate(x, side).u; };
  field.stress = [evaluate](const Vec2& x, int side) { return evaluate(x, side).stress; };
  field.rotation = [evaluate](const Vec2& x, int side) { return evaluate(x, side).rotation; };
}

// ---------------------------------------------------------------- straight cracks

/// A point in the frame of a crack, in the closed upper half plane: Z(conj z) = conj Z(z) gives the lower one.
struct LinePoint {
  Complex z, from_start, from_end;
  double y;  // true ordinate
  bool lower;
};

struct Westergaard {
  Complex P, Z, dZ;  // primitive, function, derivative
};

/// A mode I function, mode II of tau z/sqrt(z^2 - half^2), and polynomial stresses that leave y = 0 free of traction:
/// sxx = t;  sxx = k x, sxy = -k y;  sxx = q (x^2 - 2 y^2), syy = q y^2, sxy = -2 q x y; and a rigid rotation.
struct Line {
  Vec2 center, start, end;
  Complex e;  // direction of the frame's x axis
  int turn;   // -1 when that is the crack's direction reversed
  double half, kappa, mu;
  std::function<Westergaard(const LinePoint&)> mode_1;
  double tau = 0, t = 0, k = 0, q = 0, rotation = 0;
};

LinePoint in_frame(const Line& line, const Vec2& x, int side) {
  // Distances to the tips are formed before they are turned, so that they keep their digits close to a tip.
  const Complex back = std::conj(line.e);
  const Complex a = back * complex(x - line.start), b = back * complex(x - line.end);
  double y = std::norm(b) < std::norm(a) ? b.imag() : a.imag();
  if (side != 0 && std::abs(y) <= 1e-13 * line.half) y = 0;
  const double h = std::abs(y);
  return {
      {(back * complex(x - line.center)).real(), h}, {a.real(), h}, {b.real(), h}, y, y < 0 || (y == 0 && side < 0)};
}

Westergaard griffith(const LinePoint& p, double half) {
  const Complex r = std::sqrt(p.from_end) * std::sqrt(p.from_start);
  return {r, p.z / r, -half * half / (r * r * r)};
}

Westergaard below(const Westergaard& f, bool lower) {
  return lower ? Westergaard{std::conj(f.P), std::conj(f.Z), std::conj(f.dZ)} : f;
}

Values evaluate(const Line& line, const Vec2& x, int side) {
  const LinePoint p = in_frame(line, x, side * line.turn);
  const double y = p.y, kappa = line.kappa;
  const Complex w(p.z.real(), y);
  const auto times_y = [y](const Complex& f) { return y == 0 ? Complex(0) : y * f; };  // f may be infinite on y = 0

  // Everything below is 2 mu u and 2 mu omega.
  const Westergaard f = below(line.mode_1(p), p.lower);
  const Complex yZ = times_y(f.Z), yD = times_y(f.dZ);
  Complex u((kappa - 1) / 2 * f.P.real() - yZ.imag(), (kappa + 1) / 2 * f.P.imag() - yZ.real());
  double xx = f.Z.real() - yD.imag(), yy = f.Z.real() + yD.imag(), xy = -yD.real();
  double omega = -(kappa + 1) / 2 * f.Z.imag();
  if (line.tau != 0) {
    const Westergaard g = below(griffith(p, line.half), p.lower);
    const Complex yG = times_y(g.Z), yH = times_y(g.dZ);
    u += line.tau * Complex((kappa + 1) / 2 * g.P.imag() + yG.real(), -(kappa - 1) / 2 * g.P.real() - yG.imag());
    xx += line.tau * (2 * g.Z.imag() + yH.real());
    yy -= line.tau * yH.real();
    xy += line.tau * (g.Z.real() - yH.imag());
    omega += line.tau * (kappa + 1) / 2 * g.Z.real();
  }
  u += line.t * ((kappa - 1) / 4 * w + 0.5 * std::conj(w));
  u += line.k / 8 * (kappa * w * w - 2 * std::norm(w) + 3.0 * std::conj(w * w));
  u += line.q / 12 * (kappa * w * w * w - 3 * std::norm(w) * std::conj(w) + 4.0 * std::conj(w * w * w));
  xx += line.t + line.k * w.real() + line.q * (w.real() * w.real() - 2 * y * y);
  yy += line.q * y * y;
  xy -= line.k * y + 2 * line.q * w.real() * y;
  omega -= (kappa + 1) / 4 * (line.k * y + line.q * 2 * w.real() * y);
  u += 2 * line.mu * line.rotation * Complex(y, -w.real());
  omega += 2 * line.mu * line.rotation;

  const Complex back = std::conj(line.e);
  return {plane(line.e * u / (2 * line.mu)), stress_of(xx + yy, Complex(yy - xx, 2 * xy) * back * back),
          omega / (2 * line.mu)};
}

Line frame(const Material& m, const Vec2& center, double angle, double half, int turn) {
  const Vec2 direction = Vec2(std::cos(angle), std::sin(angle)) * turn;
  return {.center = center,
          .start = center - half * direction,
          .end = center + half * direction,
          .e = complex(direction),
          .turn = turn,
          .half = half,
          .kappa = kolosov(m),
          .mu = m.mu,
          .mode_1 = {}};
}

/// Mode I function, opening and pressure of one regime, p1 >= 0.
struct Regime {
  std::function<Westergaard(const LinePoint&)> Z;
  std::function<double(double)> opening, pressure;
  double k_start = 0, k_end = 0;
  std::vector<double> transitions = {};
};

Regime closed(double p0, double p1) {
  return {.Z =
              [=](const LinePoint& p) {
                return Westergaard{p.z * (p0 + p1 / 2 * p.z), p0 + p1 * p.z, p1};
              },
          .opening = [](double) { return 0.0; },
          .pressure = [=](double s) { return -(p0 + p1 * s); }};
}

Regime open(double p0, double p1, double a, double modulus) {
  return {.Z =
              [=](const LinePoint& p) {
                const Complex r = std::sqrt(p.from_end) * std::sqrt(p.from_start), z = p.z;
                return Westergaard{r * (p0 + p1 / 2 * z), (p0 * z + p1 * (z * z - a * a / 2)) / r,
                                   (-p0 * a * a + p1 * z * (z * z - 1.5 * a * a)) / (r * r * r)};
              },
          .opening = [=](double s) { return 4 / modulus * (p0 + p1 * s / 2) * std::sqrt((a - s) * (a + s)); },
          .pressure = [](double) { return 0.0; },
          .k_start = (p0 - p1 * a / 2) * std::sqrt(pi * a),
          .k_end = (p0 + p1 * a / 2) * std::sqrt(pi * a)};
}

/// Open on (c, a). With g = z - c, h = z - a, L half the open length, v = (g + h)/2.
Regime partly_open(double p0, double p1, double a, double modulus) {
  const double m = p0 / p1, L = 2 * (a + m) / 3, c = -(a + 4 * m) / 3;
  return {.Z =
              [=](const LinePoint& p) {
                const Complex g = p.z - c, h = p.from_end, v = (g + h) / 2.0, root_g = std::sqrt(g),
                              root_h = std::sqrt(h);
                return Westergaard{p1 / 2 * g * root_g * root_h, p1 * (v - L / 2) * root_g / root_h,
                                   p1 * (v * v - L * v - L * L / 2) / (root_g * root_h * h)};
              },
          .opening = [=](double s) { return s > c ? 2 * p1 / modulus * (s - c) * std::sqrt((s - c) * (a - s)) : 0; },
          .pressure = [=](double s) { return s < c ? p1 * (L / 2 - (s - c - L)) * std::sqrt((c - s) / (a - s)) : 0; },
          .k_start = 0,
          .k_end = p1 * L * std::sqrt(pi * L),
          .transitions = {c}};
}

ExactField on_line(std::string name, const Material& m, const Line& line, const Regime& r) {
  ExactField field{.name = std::move(name), .material = m};
  set_fields(field, [line](const Vec2& x, int side) { return evaluate(line, x, side); });
  const int turn = line.turn;
  const double slip = 4 * line.tau / plane_modulus(m), half = line.half, k2 = line.tau * std::sqrt(pi * half);
  field.opening = [=](double s) { return r.opening(turn * s); };
  field.pressure = [=](double s) { return r.pressure(turn * s); };
  field.slip = [=](double s) { return slip * std::sqrt((half - s) * (half + s)); };
  field.tips = {{line.start, r.k_start, k2}, {line.end, r.k_end, k2}};
  field.transitions = r.transitions;
  if (turn < 0) {
    std::swap(field.tips[0], field.tips[1]);
    for (double& s : field.transitions) s = -s;
  }
  return field;
}

}  // namespace

bool is_open(const ExactField& field, double s) {
  return field.opening && field.opening(s) > 0;
}

Vec2 crack_point(const ExactField& field, double s) {
  const Vec2 a = field.tips.at(0).at, b = field.tips.at(1).at;
  return (a + b) / 2 + s * (b - a).normalized();
}

int side_of(const ExactField& field, const Vec2& x) {
  if (field.side) return field.side(x);
  if (field.tips.empty()) return 0;
  const double left = cross(field.tips[1].at - field.tips[0].at, x - field.tips[0].at);
  return (left > 0) - (left < 0);
}

double hole_derivative(const Material& m, const Mat2& s) {
  const double sum = s.trace(), difference = s(0, 0) - s(1, 1);
  return -(sum * sum + 2 * (difference * difference + 4 * s(0, 1) * s(0, 1))) / (2 * plane_modulus(m));
}

ExactField line_crack(std::string name, const Material& m, const LineCrack& c) {
  // The formulas want p1 >= 0: otherwise the frame looks the other way.
  const int turn = c.p1 < 0 ? -1 : 1;
  const double p0 = c.p0, p1 = turn * c.p1, a = c.half, modulus = plane_modulus(m);
  Line line = frame(m, c.center, c.angle, a, turn);
  const Regime r = p0 >= p1 * a / 2 ? open(p0, p1, a, modulus)
                   : p0 <= -p1 * a  ? closed(p0, p1)
                                    : partly_open(p0, p1, a, modulus);
  line.mode_1 = r.Z;
  line.tau = c.s_tn;
  line.t = c.s_tt - (c.westergaard ? 0 : p0);
  line.k = c.westergaard ? 0 : -p1;
  line.rotation = c.rotation - (line.kappa + 1) / (4 * m.mu) * c.s_tn;
  return on_line(std::move(name), m, line, r);
}

LineCrack under(const Mat2& far_stress, double angle, double half, const Vec2& center) {
  const Vec2 t(std::cos(angle), std::sin(angle)), n(-t.y(), t.x());
  return {.center = center,
          .angle = angle,
          .half = half,
          .p0 = n.dot(far_stress * n),
          .s_tt = t.dot(far_stress * t),
          .s_tn = t.dot(far_stress * n)};
}

ExactField lens_crack(std::string name, const Material& m, const LensCrack& c) {
  const double p2 = c.p2, L = std::sqrt(2 * c.p0 / p2), modulus = plane_modulus(m);
  if (!(c.p0 > 0 && L < c.half)) throw std::invalid_argument("lens_crack needs 0 < p0 < p2 half^2/2");
  const Regime r{
      .Z =
          [=](const LinePoint& p) {
            const Complex q = std::sqrt(p.z - L) * std::sqrt(p.z + L);
            return Westergaard{-p2 / 3 * q * q * q, -p2 * p.z * q, -p2 * (q + p.z * p.z / q)};
          },
      .opening =
          [=](double s) { return std::abs(s) < L ? 4 * p2 / (3 * modulus) * std::pow((L - s) * (L + s), 1.5) : 0; },
      .pressure = [=](double s) { return std::abs(s) > L ? p2 * std::abs(s) * std::sqrt((s - L) * (s + L)) : 0; },
      .transitions = {-L, L}};
  Line line = frame(m, c.center, c.angle, c.half, 1);
  line.mode_1 = r.Z;
  line.t = c.s_tt - (c.westergaard ? 0 : c.p0);
  line.q = c.westergaard ? 0 : p2;
  return on_line(std::move(name), m, line, r);
}

ExactField kirsch(const Material& m, const Mat2& far_stress, double radius, double pressure, const Vec2& center) {
  const double mean = far_stress.trace() / 2, kappa = kolosov(m), R = radius;
  const Complex D((far_stress(1, 1) - far_stress(0, 0)) / 2, far_stress(0, 1)), C = std::conj(D);
  ExactField field{.name = "kirsch", .material = m};
  set_fields(field, [=](const Vec2& x, int) {
    // Goursat's phi and psi, powers of q = R/z.
    const Complex z = complex(x - center), q = R / z, q2 = q * q;
    const Complex phi = mean / 2 * z - C * R * q, dphi = mean / 2 + C * q2, ddphi = -2.0 * C * q2 / z;
    const Complex psi = D * z - (mean + pressure) * R * q - C * R * q * q2,
                  dpsi = D + (mean + pressure) * q2 + 3.0 * C * q2 * q2;
    return Values{plane((kappa * phi - z * std::conj(dphi) - std::conj(psi)) / (2 * m.mu)),
                  stress_of(4 * dphi.real(), 2.0 * (std::conj(z) * ddphi + dpsi)),
                  -(kappa + 1) / (2 * m.mu) * dphi.imag()};
  });
  return field;
}

// ---------------------------------------------------------------- smooth fields

namespace {

using Jet = std::array<double, 4>;  // value and three derivatives
using Curve = std::function<Jet(double)>;

/// a e^(k x)
Curve exponential(double k, double a = 1) {
  return [=](double x) {
    const double v = a * std::exp(k * x);
    return Jet{v, k * v, k * k * v, k * k * k * v};
  };
}

/// a sin(k x + phase)
Curve sine(double k, double phase = 0, double a = 1) {
  return [=](double x) {
    const double s = a * std::sin(k * x + phase), c = a * std::cos(k * x + phase);
    return Jet{s, k * c, -k * k * s, -k * k * k * c};
  };
}

/// a sin^2(k x)
Curve sine_squared(double k, double a = 1) {
  return [=](double x) {
    const double s = a * std::sin(2 * k * x), c = a * std::cos(2 * k * x), v = a * std::pow(std::sin(k * x), 2);
    return Jet{v, k * s, 2 * k * k * c, -4 * k * k * k * s};
  };
}

/// a x^n, n = 1 or 2
Curve power(int n, double a = 1) {
  return [=](double x) { return n == 1 ? Jet{a * x, a, 0, 0} : Jet{a * x * x, 2 * a * x, 2 * a, 0}; };
}

struct Product {
  Curve x, y;
};

/// u = (d2 s, -d1 s) + stretch w and p = lambda div u = squeeze div w, which stays finite at nu = 1/2.
struct Smooth {
  Product s, w1, w2;
  double stretch, squeeze;
};

ExactField smooth_field(std::string name, double poisson, const Smooth& f) {
  const double mu = 1;
  ExactField field{.name = std::move(name), .material = {mu, (1 - 2 * poisson) / (4 * mu)}};
  set_fields(field, [=](const Vec2& x, int) {
    const Jet sx = f.s.x(x.x()), sy = f.s.y(x.y()), ax = f.w1.x(x.x()), ay = f.w1.y(x.y()), bx = f.w2.x(x.x()),
              by = f.w2.y(x.y());
    const double k = f.stretch;
    Mat2 gradient;                                                                     // d_j u_i
    gradient << sx[1] * sy[1] + k * ax[1] * ay[0], sx[0] * sy[2] + k * ax[0] * ay[1],  //
        -sx[2] * sy[0] + k * bx[1] * by[0], -sx[1] * sy[1] + k * bx[0] * by[1];
    const double p = f.squeeze * (ax[1] * ay[0] + bx[0] * by[1]);
    return Values{{sx[0] * sy[1] + k * ax[0] * ay[0], -sx[1] * sy[0] + k * bx[0] * by[0]},
                  mu * (gradient + gradient.transpose()) + p * Mat2::Identity(),
                  (gradient(0, 1) - gradient(1, 0)) / 2};
  });
  // -div sigma = -mu Lap u - (mu stretch + squeeze) grad div w
  field.body = [=](const Vec2& x) -> Vec2 {
    const Jet sx = f.s.x(x.x()), sy = f.s.y(x.y()), ax = f.w1.x(x.x()), ay = f.w1.y(x.y()), bx = f.w2.x(x.x()),
              by = f.w2.y(x.y());
    const Vec2 lap_curl(sx[2] * sy[1] + sx[0] * sy[3], -sx[3] * sy[0] - sx[1] * sy[2]);
    const Vec2 lap_w(ax[2] * ay[0] + ax[0] * ay[2], bx[2] * by[0] + bx[0] * by[2]);
    const Vec2 grad_div(ax[2] * ay[0] + bx[1] * by[1], ax[1] * ay[1] + bx[0] * by[2]);
    return -mu * (lap_curl + f.stretch * lap_w) - (mu * f.stretch + f.squeeze) * grad_div;
  };
  return field;
}

}  // namespace

ExactField trig_field(double nu) {
  return smooth_field("trig", nu,
                      {.s = {sine_squared(pi, 0.3), sine_squared(pi)},
                       .w1 = {sine(pi), sine(pi)},
                       .w2 = {sine(pi), sine(pi)},
                       .stretch = (1 - 2 * nu) / (2 * nu),
                       .squeeze = 1});
}

ExactField exp_field(double nu) {
  return smooth_field("exp", nu,
                      {.s = {exponential(1, 0.5), sine(2)},
                       .w1 = {power(2), power(1)},
                       .w2 = {power(1, -0.5), power(2)},
                       .stretch = (1 - 2 * nu) / (2 * nu),
                       .squeeze = 1});
}

ExactField wave_field(double nu) {
  // w = grad(e^x cos 2y)
  return smooth_field("wave", nu,
                      {.s = {sine(2, 0.5), sine(3, pi / 2 - 0.2)},
                       .w1 = {exponential(1), sine(2, pi / 2)},
                       .w2 = {exponential(1), sine(2, 0, -2)},
                       .stretch = 1 - 2 * nu,
                       .squeeze = 2 * nu});
}

ExactField vortex_field(double nu) {
  const double whole = 1 - 2 * nu + nu / (1 + nu);  // stretch = 1/(1 + lambda) where E = 1
  return smooth_field("vortex", nu,
                      {.s = {sine_squared(pi, -2 / pi), sine_squared(pi)},
                       .w1 = {sine(pi), sine(pi)},
                       .w2 = {sine(pi), sine(pi)},
                       .stretch = (1 - 2 * nu) / whole,
                       .squeeze = 2 * nu / whole});
}

// ---------------------------------------------------------------- named fields

ExactField crack_case(std::string_view name, double angle, const Material& m) {
  if (name == "I") return line_crack("I", m, {.angle = angle, .p0 = 1});
  // elements.json leaves the rotation at infinity that comes with Z = tau z/sqrt(z^2 - 1).
  if (name == "II")
    return line_crack(
        "II", m,
        {.angle = angle, .p0 = -1, .s_tt = -0.5, .s_tn = 0.5, .rotation = 0.5 * (kolosov(m) + 1) / (4 * m.mu)});
  if (name == "III") return line_crack("III", m, {.angle = angle, .p1 = 1, .westergaard = true});
  if (name == "IV") return lens_crack("IV", m, {.angle = angle, .p0 = 0.08, .p2 = 1, .westergaard = true});
  throw std::invalid_argument("crack case " + std::string(name) + ": the cases are I, II, III, IV");
}

ExactField table_field(const std::string& id, double poisson) {
  const Material m = plane_strain(1000, 0.3);
  const auto far = [](double xx, double yy, double xy) { return (Mat2() << xx, xy, xy, yy).finished(); };
  const double degree = pi / 180;
  if (id == "c01_modeI") return line_crack(id, m, under(far(0, 1, 0), 0));
  if (id == "c01b_modeI_biaxial") return line_crack(id, m, under(far(1, 1, 0), 0));
  if (id == "c02_modeII") return line_crack(id, m, under(far(0, 0, 1), 0));
  if (id == "c03_inclined_open") return line_crack(id, m, under(far(0.5, 1, 0), 30 * degree));
  if (id == "c04_inclined_closed") return line_crack(id, m, under(far(0, -1, 0), 30 * degree));
  if (id == "c05_partial_linear") return line_crack(id, m, {.p1 = 1});
  if (id == "c05_partial_linear_w") return line_crack(id, m, {.p1 = 1, .westergaard = true});
  if (id == "c05b_partial_general")
    return line_crack(id, m, {.angle = 20 * degree, .p0 = 0.2, .p1 = 1, .s_tt = 0.3, .s_tn = 0.25});
  if (id == "c05c_lens") return lens_crack(id, m, {});
  if (id == "c08_kirsch") return kirsch(m, far(1, 0.5, 0), 0.5);
  if (id == "c10_trig") return trig_field(poisson);
  if (id == "c10_exp") return exp_field(poisson);
  throw std::invalid_argument("no exact field for table " + id);
}

}  // namespace kerf::exact
