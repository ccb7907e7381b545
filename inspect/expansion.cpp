// K of an edge crack by superposition. On the line of the crack, direction d at the angle beta, normal n = d turned by
// +90 degrees, the uncracked body has N(s) = n.s n + p and T(s) = d.s n; p: what presses in the crack. Then
//   K_i = sqrt(pi a) sum_j a^j [ N_j (F_iN,j + kappa a H_iN,j) + T_j (F_iT,j + kappa a H_iT,j) ]        [theory: M.1]
// with the columns of mouth.hpp. Where that makes K_I <= 0 the faces are closed, K_I = 0, and K_II is that of sliding
// faces under T + mu N where |T| > mu |N| in the mean that K takes, else 0 [theory: M.4].

#include "inspect/expansion.hpp"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>

namespace kerf::inspect {

namespace {

using Basis = Eigen::Matrix<double, 6, 1>;

Basis monomials(const Vec2& x) {
  Basis b;
  b << 1, x.x(), x.y(), x.x() * x.x(), x.x() * x.y(), x.y() * x.y();
  return b;
}

/// Loads on the line of the crack, by powers of s/a.
struct Loads {
  Powers normal = {}, shear = {};
};
Loads loads_on(const LocalStress& stress, const MouthAt& at, double beta) {
  const double c = std::cos(beta), s = std::sin(beta);
  // Along x = c r, y = s r: coefficients of 1, r, r^2 of each component.
  Eigen::Matrix3d by_power;
  by_power.col(0) = stress.of.col(0);
  by_power.col(1) = c * stress.of.col(1) + s * stress.of.col(2);
  by_power.col(2) = c * c * stress.of.col(3) + c * s * stress.of.col(4) + s * s * stress.of.col(5);
  const Eigen::RowVector3d normal(s * s, c * c, -2 * s * c), shear(-s * c, s * c, c * c - s * s);
  Loads loads;
  for (std::size_t j = 0; j < powers; ++j) {
    loads.normal[j] = normal * by_power.col(static_cast<Index>(j));
    loads.shear[j] = shear * by_power.col(static_cast<Index>(j));
  }
  loads.normal[0] += at.pressure;
  return loads;
}

double sum(const Column& column, const Powers& load, double bend) {
  double all = 0;
  for (std::size_t j = 0; j < powers; ++j) all += load[j] * (column.straight[j] + bend * column.curved[j]);
  return all;
}

}  // namespace

const std::array<Vec2, samples>& sample_places() {
  static const std::array<Vec2, samples> all = [] {
    std::array<Vec2, samples> places{Vec2(0, 0)};
    std::size_t n = 1;
    for (const double radius : {0.5, 1.})
      for (const double degrees : {30., 60., 90., 120., 150.})
        places[n++] = radius * Vec2(std::cos(degrees * pi / 180), std::sin(degrees * pi / 180));
    return places;
  }();
  return all;
}

LocalStress fit_stress(const Eigen::Matrix<double, 3, samples>& values, const Vec2& loads) {
  using Points = Eigen::Matrix<double, samples, 6>;
  struct Fit {
    Points of;
    Eigen::Matrix<double, 6, samples> free;
    Eigen::Matrix<double, 5, samples> tied;  // without the constant term
  };
  static const Fit fit = [] {
    Fit f;
    for (int i = 0; i < samples; ++i) f.of.row(i) = monomials(sample_places()[static_cast<std::size_t>(i)]).transpose();
    f.free = f.of.completeOrthogonalDecomposition().pseudoInverse();
    f.tied = f.of.rightCols<5>().completeOrthogonalDecomposition().pseudoInverse();
    return f;
  }();
  LocalStress stress;
  stress.of.row(0) = values.row(0) * fit.free.transpose();
  for (int k = 0; k < 2; ++k) {
    stress.of(1 + k, 0) = loads[k];
    stress.of.block<1, 5>(1 + k, 1) = (values.row(1 + k).array() - loads[k]).matrix() * fit.tied.transpose();
  }
  const double left = (stress.of * fit.of.transpose() - values).norm() / std::sqrt(static_cast<double>(samples));
  const double largest = values.colwise().norm().maxCoeff();
  stress.rough = largest > 0 ? left / largest : 0;
  return stress;
}

namespace {

/// `sliding`: the column of a sense.
template <class Sliding>
EdgeIntensity intensity_of(const OpenMouth& open, const Sliding& sliding, double friction, const LocalStress& stress,
                           const MouthAt& at, double beta) {
  const Loads loads = loads_on(stress, at, beta);
  const double bend = at.curvature * at.length, root = std::sqrt(pi * at.length);
  const auto K = [&](std::size_t mode) {
    return root * (sum(open.K[mode][0], loads.normal, bend) + sum(open.K[mode][1], loads.shear, bend));
  };
  EdgeIntensity found{K(0), K(1)};
  if (found.K_I > 0) return found;
  found.closed = true;
  found.K_I = 0;
  const double sense = sum(sliding(1.), loads.shear, bend) < 0 ? -1 : 1;
  const Column column = sliding(sense);
  const double driven = sum(column, loads.shear, bend) + sense * friction * sum(column, loads.normal, bend);
  found.K_II = sense * driven > 0 ? root * driven : 0;
  return found;
}

}  // namespace

EdgeIntensity intensity(const Mouths& mouths, const LocalStress& stress, const MouthAt& at, double beta) {
  return intensity_of(
      mouths.open(beta), [&](double sense) { return mouths.sliding(beta, sense); }, mouths.friction(), stress, at,
      beta);
}

double worst_angle(const Mouths& mouths, const LocalStress& stress, const MouthAt& at) {
  const auto square = [](const EdgeIntensity& k) { return k.K_I * k.K_I + k.K_II * k.K_II; };
  const auto released = [&](double beta) { return square(intensity(mouths, stress, at, beta)); };
  // The angles that are known; then a golden section in the two intervals beside the best.
  const std::vector<Mouths::Known>& known = mouths.known();
  const double least = Mouths::flattest, step = known[1].angle - known[0].angle;
  double best = pi / 2, most = released(best);
  for (const Mouths::Known& k : known) {
    const auto sliding = [&k](double sense) { return sense < 0 ? k.back : k.forth; };
    const double value = square(intensity_of(k.open, sliding, mouths.friction(), stress, at, k.angle));
    if (value > most * (1 + 1e-9)) best = k.angle, most = value;
  }
  double low = std::max(best - step, least), high = std::min(best + step, pi - least);
  const double golden = (std::sqrt(5.) - 1) / 2;
  double a = high - golden * (high - low), b = low + golden * (high - low);
  double at_a = released(a), at_b = released(b);
  constexpr double enough = 1e-3;  // radians
  while (high - low > enough)
    if (at_a > at_b) {
      high = b, b = a, at_b = at_a;
      a = high - golden * (high - low), at_a = released(a);
    } else {
      low = a, a = b, at_a = at_b;
      b = low + golden * (high - low), at_b = released(b);
    }
  const double middle = (low + high) / 2;
  return released(middle) > most ? middle : best;
}

}  // namespace kerf::inspect
