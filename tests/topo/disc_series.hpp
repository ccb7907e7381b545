#pragma once
// The unit disc under tractions with a circular hole or inclusion anywhere in it, by series of Kolosov's potentials
// whose coefficients fit all conditions on the two circles: exact to rounding. Knows nothing of expansions.

#include "kerf/material.hpp"

#include <Eigen/QR>
#include <complex>
#include <optional>
#include <vector>

namespace kerf::series {

using Complex = std::complex<double>;

/// phi = sum a_n z^n, psi = sum b_n z^n, n from 1.
struct Polynomial {
  std::vector<Complex> a, b;
};
struct Potentials {
  Complex phi, dphi, psi, dpsi, ddphi;
};
inline Potentials at(const Polynomial& p, Complex z) {
  Potentials v{};
  for (std::size_t i = 0; i < p.a.size(); ++i) {
    const double n = static_cast<double>(i + 1);
    v.phi += p.a[i] * std::pow(z, n);
    v.dphi += n * p.a[i] * std::pow(z, n - 1);
    if (i > 0) v.ddphi += n * (n - 1) * p.a[i] * std::pow(z, n - 2);
  }
  for (std::size_t i = 0; i < p.b.size(); ++i) {
    const double n = static_cast<double>(i + 1);
    v.psi += p.b[i] * std::pow(z, n);
    v.dpsi += n * p.b[i] * std::pow(z, n - 1);
  }
  return v;
}
inline Complex resultant(const Potentials& p, Complex z) {
  return p.phi + z * std::conj(p.dphi) + std::conj(p.psi);
}
inline Complex moved(const Material& m, const Potentials& p, Complex z) {
  const double kappa = 1 + 8 * m.mu * m.c;
  return (kappa * p.phi - z * std::conj(p.dphi) - std::conj(p.psi)) / (2 * m.mu);
}
inline Mat2 stress(const Polynomial& state, Complex z) {
  const Potentials p = at(state, z);
  const double sum = 4 * p.dphi.real();
  const Complex d = 2.0 * (std::conj(z) * p.ddphi + p.dpsi);
  return (Mat2() << 0.5 * (sum - d.real()), 0.5 * d.imag(), 0.5 * d.imag(), 0.5 * (sum + d.real())).finished();
}
/// The same state around another origin: psi changes with it, psi_x = psi + conj(x) phi'.
inline Polynomial around(const Polynomial& p, Complex x) {
  const auto shifted = [&](const std::vector<Complex>& c) {  // without the constant
    std::vector<Complex> s(c.size(), 0);
    for (std::size_t i = 0; i < c.size(); ++i) {
      const int n = static_cast<int>(i) + 1;
      double binomial = 1;
      for (int k = n; k >= 1; --k) {
        s[static_cast<std::size_t>(k - 1)] += c[i] * binomial * std::pow(x, n - k);
        binomial = binomial * k / (n - k + 1);
      }
    }
    return s;
  };
  Polynomial q{shifted(p.a), shifted(p.b)};
  q.b.resize(std::max(q.a.size(), q.b.size()), 0);
  for (std::size_t k = 1; k < q.a.size(); ++k)
    q.b[k - 1] += std::conj(x) * static_cast<double>(k + 1) * q.a[k];  // phi' = ... (k + 1) a_{k+1} z^k
  return q;
}

/// What is to be added to the state: sum alpha_n z^n outside, gamma_n (eps/(z - x))^n, inside an inclusion powers of
/// (z - x)/eps; phi and psi each, with complex coefficients as pairs of real unknowns.
class Disc {
 public:
  Disc(const Material& m, const std::optional<Material>& inside, Complex x, double eps)
      : m_(m), inside_(inside), x_(x), eps_(eps) {}

  /// Potential energy with the change less that without, for the tractions of `state` on r = 1.
  double energy_change(const Polynomial& state) const {
    const int points = 80, conditions = inside_ ? 6 : 4;
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(points * conditions, unknowns());
    Eigen::VectorXd b = Eigen::VectorXd::Zero(points * conditions);
    for (int k = 0; k < unknowns(); ++k) {
      const Eigen::VectorXd c = Eigen::VectorXd::Unit(unknowns(), k);
      for (int i = 0; i < points; ++i) {
        const Complex e = std::polar(1.0, 2 * pi * i / points), z = x_ + eps_ * e;
        put(A.col(k), conditions * i, resultant(outer(c, e), e) + constant(c, 0));
        const Potentials out = outer(c, z), in = inner(c, e);
        put(A.col(k), conditions * i + 2, resultant(out, z) - resultant(in, z) + constant(c, 1));
        if (inside_) put(A.col(k), conditions * i + 4, m_.mu * (moved(m_, out, z) - moved(*inside_, in, z)));
      }
    }
    for (int i = 0; i < points; ++i) {
      const Complex z = x_ + eps_ * std::polar(1.0, 2 * pi * i / points);
      const Potentials s = at(state, z);
      put(b, conditions * i + 2, -resultant(s, z));
      if (inside_) put(b, conditions * i + 4, -m_.mu * moved(m_, s, z));
    }
    const Eigen::VectorXd c = A.colPivHouseholderQr().solve(b);
    double work = 0;
    for (int i = 0; i < points; ++i) {
      const Complex e = std::polar(1.0, 2 * pi * i / points);
      const Vec2 n(e.real(), e.imag()), t = stress(state, e) * n;
      const Complex u = moved(m_, outer(c, e), e);
      work += 2 * pi / points * (t.x() * u.real() + t.y() * u.imag());
    }
    return -0.5 * work;
  }

 private:
  static constexpr int regular_ = 26, singular_ = 10;
  int unknowns() const {
    return 4 * (regular_ + singular_) + (inside_ ? 4 * (singular_ + 1) : 0) + 4;
  }
  static void put(Eigen::Ref<Eigen::VectorXd> to, Eigen::Index row, Complex v) {
    to[row] += v.real();
    to[row + 1] += v.imag();
  }
  static Complex read(const Eigen::VectorXd& c, int i) {
    return {c[2 * i], c[2 * i + 1]};
  }
  Complex constant(const Eigen::VectorXd& c, int which) const {
    return read(c, unknowns() / 2 - 2 + which);
  }
  Potentials outer(const Eigen::VectorXd& c, Complex z) const {
    Potentials p{};
    for (int n = 1; n <= regular_; ++n) {
      const Complex a = read(c, 2 * (n - 1)), b = read(c, 2 * (n - 1) + 1);
      if (a == 0.0 && b == 0.0) continue;
      const Complex power = std::pow(z, n - 1);
      p.phi += a * power * z;
      p.dphi += static_cast<double>(n) * a * power;
      p.psi += b * power * z;
    }
    const int from = 2 * regular_;
    for (int n = 1; n <= singular_; ++n) {
      const Complex a = read(c, from + 2 * (n - 1)), b = read(c, from + 2 * (n - 1) + 1);
      if (a == 0.0 && b == 0.0) continue;
      const Complex power = std::pow(eps_ / (z - x_), n);
      p.phi += a * power;
      p.dphi -= static_cast<double>(n) * a * power / (z - x_);
      p.psi += b * power;
    }
    return p;
  }
  Potentials inner(const Eigen::VectorXd& c, Complex e) const {
    Potentials p{};
    if (!inside_) return p;
    const int from = 2 * (regular_ + singular_);
    for (int n = 0; n <= singular_; ++n) {
      const Complex a = read(c, from + 2 * n), b = read(c, from + 2 * n + 1);
      if (a == 0.0 && b == 0.0) continue;
      p.phi += a * std::pow(e, n);
      if (n > 0) p.dphi += static_cast<double>(n) * a * std::pow(e, n - 1) / eps_;
      p.psi += b * std::pow(e, n);
    }
    return p;
  }

  Material m_;
  std::optional<Material> inside_;
  Complex x_;
  double eps_;
};

/// T and c2 of the potential energy by extrapolation in even powers.
struct Limits {
  double T, c2;
};
inline Limits limits(const Material& m, const std::optional<Material>& inside, Complex x, const Polynomial& state,
                     double largest) {
  const int n = 6;
  Eigen::MatrixXd A(n, n);
  Eigen::VectorXd b(n);
  for (int i = 0; i < n; ++i) {
    const double eps = largest * (1 - 0.15 * i), square = eps * eps / (largest * largest);
    for (int k = 0; k < n; ++k) A(i, k) = std::pow(square, k);
    b[i] = Disc(m, inside, x, eps).energy_change(state) / (pi * eps * eps);
  }
  const Eigen::VectorXd c = A.fullPivHouseholderQr().solve(b);
  return {c[0], c[1] / (largest * largest)};
}

}  // namespace kerf::series
