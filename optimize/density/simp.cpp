#include "optimize/density/simp.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr double fine = 0x1p24;  // densities are multiples of 1/fine: rounding in the solver rarely changes one

double volume(const Lattice& l, const Eigen::VectorXd& density) {
  return l.part.dot(density);
}

}  // namespace

double Stiffening::stiffness(double density) const {
  return least + (1 - least) * std::pow(density, exponent);
}

double Stiffening::derivative(double density) const {
  return (1 - least) * exponent * std::pow(density, exponent - 1);
}

Compliances compliances(const Lattice& l, LatticeStiffness& stiffness, const Stiffening& law,
                        const Eigen::VectorXd& density) {
  Eigen::VectorXd relative = Eigen::VectorXd::Zero(density.size()), slope = relative;
  for (const Index c : l.cells) relative[c] = law.stiffness(density[c]), slope[c] = law.derivative(density[c]);
  Eigen::MatrixXd force = l.force;
  for (std::size_t k = 0; k < l.body.size(); ++k)
    for (const Index c : l.cells)
      for (const Index v : l.corners(c))
        force.block<2, 1>(2 * v, static_cast<Eigen::Index>(k)) += density[c] / 4 * l.body[k].col(c);
  const Eigen::MatrixXd u = stiffness.displacements(relative, force);
  Compliances all{force.cwiseProduct(u).colwise().sum().transpose(), Eigen::MatrixXd(density.size(), force.cols())};
  for (Eigen::Index k = 0; k < force.cols(); ++k) {
    all.by_density.col(k) = -slope.cwiseProduct(cell_energies(l, u.col(k)));
    if (l.body.empty()) continue;
    for (const Index c : l.cells) {
      Vec2 mean = Vec2::Zero();
      for (const Index v : l.corners(c)) mean += u.block<2, 1>(2 * v, k) / 4;
      all.by_density(c, k) += 2 * l.body[static_cast<std::size_t>(k)].col(c).dot(mean);
    }
  }
  return all;
}

Densities optimality_criteria(const Lattice& l, const LatticePattern& pattern, const Criteria& how) {
  const LatticeFilter filter(l, how.radius);
  const LatticeMirror mirror(l);
  LatticeStiffness stiffness(l, pattern);
  const Stiffening law;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(l.part.size());
  double solid = 0;
  for (const Index c : l.cells)
    if (l.solid[static_cast<std::size_t>(c)]) solid += l.part[c];
  const double even = std::clamp((how.area - solid) / std::max(l.part.sum() - solid, 1e-9), 0.0, 1.0);
  for (const Index c : l.cells) x[c] = l.solid[static_cast<std::size_t>(c)] ? 1 : even;
  Densities d{x, 0};
  while (d.steps < how.most_steps) {
    ++d.steps;
    const Compliances now = compliances(l, stiffness, law, x);
    Eigen::VectorXd gain = -mirror.symmetrized(filter.smooth_derivative(x, now.by_density * how.weights));
    for (const Index c : l.cells) gain[c] = std::max(gain[c], 0.0);  // per cell: the area of the share counts the same
    for (const Index c : l.cells) gain[c] /= l.part[c];
    Eigen::VectorXd next = x;
    const auto step = [&](double price) {
      for (const Index c : l.cells)
        if (!l.solid[static_cast<std::size_t>(c)])
          next[c] = std::clamp(x[c] * std::sqrt(gain[c] / price), std::max(0.0, x[c] - how.move),
                               std::min(1.0, x[c] + how.move));
      return volume(l, next);
    };
    double low = 1e-12 * gain.maxCoeff(), high = 1e6 * gain.maxCoeff();
    if (!(high > 0)) break;
    while (high > (1 + 1e-10) * low) {
      const double price = std::sqrt(low * high);
      (step(price) > how.area ? low : high) = price;
    }
    next = mirror.symmetrized(next);
    for (const Index c : l.cells) next[c] = std::round(next[c] * fine) / fine;
    const double change = (next - x).cwiseAbs().maxCoeff();
    x = next;
    if (change < how.least_change) break;
  }
  d.density = x;
  return d;
}

Eigen::VectorXd black_and_white(const Lattice& l, const Eigen::VectorXd& density, double area) {
  constexpr int across = 4;
  constexpr int samples = across * across;
  Eigen::VectorXd continued = density;
  for (Eigen::Index c = 0; c < density.size(); ++c) continued[c] = density[l.inside[static_cast<std::size_t>(c)]];
  Eigen::MatrixXd at(samples, static_cast<Eigen::Index>(l.cells.size()));
  for (std::size_t k = 0; k < l.cells.size(); ++k)
    for (int i = 0; i < samples; ++i) {
      const Vec2 x = l.center(l.cells[k]) + Vec2((i % across + 0.5) / across - 0.5, (i / across + 0.5) / across - 0.5);
      double value = 0;
      for (const auto& [cell, weight] : between_centers(l.columns, l.rows, x)) value += weight * continued[cell];
      at(i, static_cast<Eigen::Index>(k)) = l.solid[static_cast<std::size_t>(l.cells[k])] ? infinity : value;
    }
  Eigen::VectorXd share = Eigen::VectorXd::Zero(density.size());
  const auto above = [&](double level) {
    for (std::size_t k = 0; k < l.cells.size(); ++k)
      share[l.cells[k]] = static_cast<double>((at.col(static_cast<Eigen::Index>(k)).array() > level).count()) / samples;
    return volume(l, share);
  };
  double low = -1e-9, high = 1;
  for (int i = 0; i < 40; ++i) {
    const double level = (low + high) / 2;
    (above(level) > area ? low : high) = level;
  }
  above(high);
  return share;
}

}  // namespace kerf
