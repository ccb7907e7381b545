// Dislocations along a crack that begins at a free boundary: the straight one, and the rim of a circle of radius 1/eps
// for the change with curvature.
//
// A dislocation A at z0 outside a free circle |Z| = 1, Z = i + eps z, has the potentials A log(Z - Z0), conj(A) log(Z -
// Z0) - A conj(Z0)/(Z - Z0) and their images by the circle theorem [Muskhelishvili 1953], with the opposite dislocation
// inside the circle, as the crack is cut from the rim. With Delta = i (z - conj z0) - eps conj(z0) z their sum has a
// limit for eps = 0, the half plane y > 0 [theory: M.3]. On s = ((1 + y)/2)^4 the density is g(y)/sqrt(1 - y^2) with
// g(-1) = 0: Gauss and Chebyshev's rule [Erdogan, Gupta 1972]. K = 2 sqrt(2) pi g(1)/2 sqrt(pi a), exactly as the
// singular part of the kernel is 2/(s - s0).

#include "inspect/mouth.hpp"

#include "base/parallel.hpp"

#include <fmt/format.h>
#include <Eigen/LU>

#include <cmath>
#include <complex>

namespace kerf::inspect {

namespace {

using Complex = std::complex<double>;

constexpr int grading = 4;  // of the points towards the mouth: s = ((1 + y)/2)^grading

/// Normal traction and shear at z across the direction `turn` = exp(2 i beta), of a dislocation A at z0.
struct FaceLoad {
  double normal, shear;
};
FaceLoad traction(Complex z, Complex z0, Complex A, double eps, Complex turn) {
  using std::conj;
  const Complex i(0, 1), c0 = conj(z0), Ac = conj(A);
  const Complex Z = i + eps * z, Z0 = i + eps * z0, C0 = conj(Z0);
  const Complex delta = i * (z - c0) - eps * c0 * z;
  // (|Z0|^2 - 1)/eps and (|Z|^2 - 1)/eps without cancellation.
  const double m0 = eps * std::norm(z0) + 2 * z0.imag(), m = eps * std::norm(z) + 2 * z.imag();
  // eps phi' of the image, eps^2 phi'', all divided by the powers of eps that they have.
  const Complex k = Ac * m0 / C0;
  const Complex p1 = k / (delta * delta) + A * C0 / delta;
  const Complex p2 = 2. * k * C0 / (delta * delta * delta) + A * C0 * C0 / (delta * delta);
  const double sum = 4 * std::real(A / (z - z0) + p1);
  const Complex difference = -A * conj(z - z0) / ((z - z0) * (z - z0)) + Ac / (z - z0) + p2 * m / Z + p1 / (Z * Z) +
                             Ac * C0 / delta - eps * A / (Z0 * Z * Z);
  const Complex turned = 2. * difference * turn;
  return {(sum + turned.real()) / 2, turned.imag() / 2};
}

/// The equations of the density: rows of normal and shear tractions at the points between, of opening and sliding.
struct Equations {
  Eigen::MatrixXd normal_open, normal_slide, shear_open, shear_slide;
  Eigen::VectorXd at;             // s of the rows
  Eigen::RowVectorXd mouth, tip;  // g(-1), and K/sqrt(pi a) by g(1)
};

Equations equations(double beta, double eps, int n) {
  Equations e;
  e.at.resize(n - 1);
  for (Eigen::MatrixXd* m : {&e.normal_open, &e.normal_slide, &e.shear_open, &e.shear_slide}) m->resize(n - 1, n);
  e.mouth.resize(n);
  e.tip.resize(n);
  const Complex along = std::polar(1., beta), turn = along * along;
  const auto s_at = [](double angle) { return std::pow(std::cos(angle / 2), 2 * grading); };  // y = cos(angle)
  for (int r = 0; r < n - 1; ++r) e.at[r] = s_at((r + 1) * pi / n);
  for (int q = 0; q < n; ++q) {
    const double angle = (2 * q + 1) * pi / (2 * n), sign = q % 2 == 0 ? 1 : -1;
    e.tip[q] = std::sqrt(2.) * 2 * pi / std::sqrt(static_cast<double>(grading)) * sign / std::tan(angle / 2) / n;
    e.mouth[q] = (n % 2 == 0 ? -1 : 1) * sign * std::tan(angle / 2) / n;
    const Complex z0 = s_at(angle) * along;
    for (int r = 0; r < n - 1; ++r) {
      const FaceLoad open = traction(e.at[r] * along, z0, along, eps, turn);
      const FaceLoad slide = traction(e.at[r] * along, z0, Complex(0, -1) * along, eps, turn);
      e.normal_open(r, q) = pi / n * open.normal;
      e.shear_open(r, q) = pi / n * open.shear;
      e.normal_slide(r, q) = pi / n * slide.normal;
      e.shear_slide(r, q) = pi / n * slide.shear;
    }
  }
  return e;
}

/// K per power of the loads N and T.
struct Intensities {
  std::array<std::array<Powers, 2>, 2> K;
};

Intensities open_faces(const Equations& e) {
  const auto n = static_cast<int>(e.tip.size());
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  all.topLeftCorner(n - 1, n) = e.normal_open;
  all.topRightCorner(n - 1, n) = e.normal_slide;
  all.block(n, 0, n - 1, n) = e.shear_open;
  all.block(n, n, n - 1, n) = e.shear_slide;
  all.block(n - 1, 0, 1, n) = e.mouth;
  all.block(2 * n - 1, n, 1, n) = e.mouth;
  Eigen::MatrixXd loads = Eigen::MatrixXd::Zero(2 * n, 2 * powers);
  for (int j = 0; j < powers; ++j)
    for (int load = 0; load < 2; ++load)
      loads.block(load * n, load * powers + j, n - 1, 1) = -e.at.array().pow(j).matrix();
  const Eigen::MatrixXd g = all.partialPivLu().solve(loads);
  Intensities found;
  for (std::size_t mode = 0; mode < 2; ++mode)
    for (std::size_t load = 0; load < 2; ++load)
      for (std::size_t j = 0; j < powers; ++j)
        found.K[mode][load][j] =
            e.tip.dot(g.col(static_cast<Index>(load * powers + j)).segment(static_cast<Index>(mode) * n, n));
  return found;
}

Powers sliding_faces(const Equations& e, double friction) {
  const auto n = static_cast<int>(e.tip.size());
  Eigen::MatrixXd all(n, n), loads = Eigen::MatrixXd::Zero(n, powers);
  all.topRows(n - 1) = e.shear_slide + friction * e.normal_slide;
  all.row(n - 1) = e.mouth;
  for (int j = 0; j < powers; ++j) loads.col(j).head(n - 1) = -e.at.array().pow(j).matrix();
  const Eigen::MatrixXd g = all.partialPivLu().solve(loads);
  Powers found;
  for (std::size_t j = 0; j < powers; ++j) found[j] = e.tip.dot(g.col(static_cast<Index>(j)));
  return found;
}

constexpr double small = 1e-3;  // of eps: the derivative is one-sided, of second order

/// The rim of a hole has the curvature -eps.
Column column(const Powers& straight, const Powers& once, const Powers& twice) {
  Column c{straight, {}};
  for (std::size_t j = 0; j < powers; ++j) c.curved[j] = (3 * straight[j] - 4 * once[j] + twice[j]) / (2 * small);
  return c;
}

void check_angle(double beta) {
  if (!(beta > 0 && beta < pi))
    throw Error(Fault::Usage, fmt::format("a crack leaves the boundary at {} degrees; between 0 and 180 are wanted",
                                          beta * 180 / pi));
}

/// Lagrange's polynomials of Chebyshev's points at x, by the barycentric formula.
std::vector<double> weights_at(const std::vector<double>& nodes, double x) {
  const std::size_t n = nodes.size();
  std::vector<double> w(n);
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (x == nodes[i]) {
      std::fill(w.begin(), w.end(), 0.);
      w[i] = 1;
      return w;
    }
    const double sign = i % 2 == 0 ? 1 : -1;
    w[i] = sign * std::sin((2 * static_cast<double>(i) + 1) * pi / (2 * static_cast<double>(n))) / (x - nodes[i]);
    sum += w[i];
  }
  for (double& each : w) each /= sum;
  return w;
}

void add(Column& to, double weight, const Column& c) {
  for (std::size_t j = 0; j < powers; ++j) {
    to.straight[j] += weight * c.straight[j];
    to.curved[j] += weight * c.curved[j];
  }
}

}  // namespace

namespace {

/// The straight boundary and two curved ones, for the derivative by the curvature.
using Curved = std::array<Equations, 3>;
Curved curved(double beta, int points) {
  check_angle(beta);
  return {equations(beta, 0, points), equations(beta, small, points), equations(beta, 2 * small, points)};
}

OpenMouth open_mouth_of(const Curved& e) {
  const Intensities straight = open_faces(e[0]), once = open_faces(e[1]), twice = open_faces(e[2]);
  OpenMouth mouth;
  for (std::size_t mode = 0; mode < 2; ++mode)
    for (std::size_t load = 0; load < 2; ++load)
      mouth.K[mode][load] = column(straight.K[mode][load], once.K[mode][load], twice.K[mode][load]);
  return mouth;
}

Column sliding_mouth_of(const Curved& e, double friction) {
  return column(sliding_faces(e[0], friction), sliding_faces(e[1], friction), sliding_faces(e[2], friction));
}

}  // namespace

OpenMouth open_mouth(double beta, int points) {
  return open_mouth_of(curved(beta, points));
}

Column sliding_mouth(double beta, double friction, int points) {
  return sliding_mouth_of(curved(beta, points), friction);
}

// Mirrored about the normal, N stays and T changes its sign: K of the diagonal is even in beta - 90 degrees, the rest
// odd, and sliding with friction is that of the mirror image with the opposite sign of friction.
Mouths::Mouths(double friction, int threads) : friction_(friction) {
  constexpr Index count = 15;
  for (Index i = 0; i < count; ++i)
    nodes_.push_back(pi / 2 + (pi / 2 - flattest) * std::cos((2. * i + 1) * pi / (2. * count)));
  open_.resize(count);
  sliding_.resize(count);
  parallel_for(count / 2 + 1, threads, [&](Index first, Index last) {
    for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last); ++i) {
      const std::size_t mirror = count - 1 - i;
      constexpr int points = 60;
      const Curved e = curved(nodes_[i], points);
      open_[i] = open_mouth_of(e);
      sliding_[mirror] = sliding_mouth_of(e, -friction);
      sliding_[i] = sliding_mouth_of(e, friction);
      if (mirror == i) continue;
      open_[mirror] = open_[i];
      for (std::size_t load = 0; load < 2; ++load) {
        Column& odd = open_[mirror].K[1 - load][load];
        odd = {};
        add(odd, -1, open_[i].K[1 - load][load]);
      }
    }
  });
  constexpr int steps = 40;
  for (int i = 0; i <= steps; ++i) {
    const double angle = flattest + i * (pi - 2 * flattest) / steps;
    known_.push_back({angle, open(angle), sliding(angle, 1), sliding(angle, -1)});
  }
}

OpenMouth Mouths::open(double beta) const {
  const std::vector<double> w = weights_at(nodes_, beta);
  OpenMouth sum;
  for (std::size_t i = 0; i < w.size(); ++i)
    for (std::size_t mode = 0; mode < 2; ++mode)
      for (std::size_t load = 0; load < 2; ++load) add(sum.K[mode][load], w[i], open_[i].K[mode][load]);
  return sum;
}

Column Mouths::sliding(double beta, double sense) const {
  const std::vector<double> w = weights_at(nodes_, sense < 0 ? pi - beta : beta);
  Column sum;
  for (std::size_t i = 0; i < w.size(); ++i) add(sum, w[i], sliding_[i]);
  return sum;
}

}  // namespace kerf::inspect
