// Displacements of a lattice of bilinear square elements: K = sum over cells of E (mu K_mu + lambda K_lambda) +
// springs, by a sparse factor. The matrices of a unit cell are those of two Gauss points each way, exact for squares.
// The pattern of the matrix and the places of the 36 entries of each cell's lower triangle are made once per lattice,
// nodes in the order of nested dissection; each density fills in values and refactors. cell_energies are u'K u per cell
// at relative stiffness 1, for (P.4). docs/theory/density.md, section "Lattice".

#include "optimize/density/stiffness.hpp"

#include <algorithm>

namespace kerf {

namespace {

using Cell = Eigen::Matrix<double, 8, 8>;

/// The stiffness of a square cell of bilinear functions is mu times the first plus lambda times the second; corners
/// counter-clockwise, unknowns 2 corner + component. Two Gauss points each way.
struct CellMatrices {
  Cell mu = Cell::Zero(), lambda = Cell::Zero();
  CellMatrices() {
    constexpr std::array<double, 4> sx{-1, 1, 1, -1}, sy{-1, -1, 1, 1};
    const double g = 1 / std::sqrt(3.0);
    for (const double s : {-g, g})
      for (const double t : {-g, g}) {
        Eigen::Matrix<double, 3, 8> strain = Eigen::Matrix<double, 3, 8>::Zero();  // xx, yy, 2 xy
        for (int i = 0; i < 4; ++i) {
          // Derivatives on a cell of length 1; s and t run from -1 to 1.
          const double dx = sx[i] * (1 + sy[i] * t) / 2, dy = sy[i] * (1 + sx[i] * s) / 2;
          strain(0, 2 * i) = strain(2, 2 * i + 1) = dx;
          strain(1, 2 * i + 1) = strain(2, 2 * i) = dy;
        }
        // eps : C eps = 2 mu (xx^2 + yy^2 + 2 xy^2) + lambda (xx + yy)^2, the third strain twice xy.
        const Eigen::Matrix<double, 1, 8> trace = strain.row(0) + strain.row(1);
        mu += (strain.transpose() * Eigen::Vector3d(2, 2, 1).asDiagonal() * strain) / 4;
        lambda += trace.transpose() * trace / 4;
      }
  }
};

const CellMatrices& cell_matrices() {
  static const CellMatrices matrices;
  return matrices;
}

/// Nodes of the cells of the body in the order of elimination; none: others.
/// Nodes are ordered, so that both components of one stay together.
std::vector<Index> ordered_nodes(const Lattice& l, Index& count) {
  std::vector<Index> number(static_cast<std::size_t>(l.nodes()), none), nodes;
  for (const Index c : l.cells)
    for (const Index v : l.corners(c)) number[static_cast<std::size_t>(v)] = 0;
  for (Index v = 0; v < l.nodes(); ++v)
    if (number[static_cast<std::size_t>(v)] == 0) {
      number[static_cast<std::size_t>(v)] = static_cast<Index>(nodes.size());
      nodes.push_back(v);
    }
  count = static_cast<Index>(nodes.size());
  std::vector<std::vector<Index>> around(nodes.size());
  for (const Index c : l.cells)
    for (const Index v : l.corners(c))
      for (const Index w : l.corners(c))
        if (v != w)
          around[static_cast<std::size_t>(number[static_cast<std::size_t>(v)])].push_back(
              number[static_cast<std::size_t>(w)]);
  std::vector<Index> start{0}, neighbors;
  for (std::vector<Index>& list : around) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    neighbors.insert(neighbors.end(), list.begin(), list.end());
    start.push_back(static_cast<Index>(neighbors.size()));
  }
  const std::vector<Index> order = dissection(start, neighbors);
  std::vector<Index> rank(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) rank[static_cast<std::size_t>(order[k])] = static_cast<Index>(k);
  for (Index& v : number)
    if (v != none) v = rank[static_cast<std::size_t>(v)];
  return number;
}

std::array<Index, 8> unknowns(const Lattice& l, const LatticePattern& pattern, Index c) {
  std::array<Index, 8> u;
  const std::array<Index, 4> corners = l.corners(c);
  for (std::size_t i = 0; i < 8; ++i) u[i] = pattern.unknown[static_cast<std::size_t>(2 * corners[i / 2]) + i % 2];
  return u;
}

}  // namespace

// Columns of the lower triangle list their rows; springs are added once, values of cells at each density.
LatticePattern lattice_pattern(const Lattice& l) {
  LatticePattern pattern;
  Index count = 0;
  const std::vector<Index> number = ordered_nodes(l, count);
  for (const Index v : number)
    for (int k = 0; k < 2; ++k) pattern.unknown.push_back(v == none ? none : 2 * v + k);
  std::vector<std::vector<Index>> below(static_cast<std::size_t>(2 * count));
  for (const Index c : l.cells)
    for (const Index j : unknowns(l, pattern, c))
      for (const Index i : unknowns(l, pattern, c))
        if (i >= j) below[static_cast<std::size_t>(j)].push_back(i);
  LowerTriangle& a = pattern.empty;
  a.size = 2 * count;
  a.start = {0};
  for (std::vector<Index>& list : below) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    a.rows.insert(a.rows.end(), list.begin(), list.end());
    a.start.push_back(static_cast<Index>(a.rows.size()));
  }
  const auto place = [&a](Index i, Index j) {
    const auto first = a.rows.begin() + a.start[static_cast<std::size_t>(j)];
    const auto last = a.rows.begin() + a.start[static_cast<std::size_t>(j) + 1];
    return static_cast<Index>(std::lower_bound(first, last, i) - a.rows.begin());
  };
  for (const Index c : l.cells) {
    const std::array<Index, 8> u = unknowns(l, pattern, c);
    auto& at = pattern.at.emplace_back();
    std::size_t n = 0;
    for (std::size_t i = 0; i < 8; ++i)
      // In the order in which `displacements` adds.
      for (std::size_t j = 0; j <= i; ++j) at[n++] = place(std::max(u[i], u[j]), std::min(u[i], u[j]));
  }
  pattern.springs.assign(a.rows.size(), 0);
  for (const Lattice::Spring& s : l.springs) {
    const Index i = pattern.unknown[static_cast<std::size_t>(s.first)];
    const Index j = pattern.unknown[static_cast<std::size_t>(s.second)];
    // Springs are listed both ways: one of them is of the lower triangle.
    if (i >= j) pattern.springs[static_cast<std::size_t>(place(i, j))] += s.stiffness;
  }
  return pattern;
}

// One factor for all load cases; the symbolic part serves every density.
Eigen::MatrixXd LatticeStiffness::displacements(const Eigen::VectorXd& relative, const Eigen::MatrixXd& force) {
  if (matrix_.size == 0) matrix_ = pattern_.empty;
  matrix_.values = pattern_.springs;
  const CellMatrices& unit = cell_matrices();
  for (std::size_t k = 0; k < l_.cells.size(); ++k) {
    const Index c = l_.cells[k];
    const double mu = relative[c] * l_.mu[c], lambda = relative[c] * l_.lambda[c];
    const std::array<Index, 36>& at = pattern_.at[k];
    std::size_t n = 0;
    for (int i = 0; i < 8; ++i)
      for (int j = 0; j <= i; ++j)
        matrix_.values[static_cast<std::size_t>(at[n++])] += mu * unit.mu(i, j) + lambda * unit.lambda(i, j);
  }
  if (factor_)
    factor_->refactor(matrix_);
  else
    factor_ = std::make_unique<Factor>(matrix_, 0);
  Eigen::MatrixXd b(matrix_.size, force.cols());
  for (std::size_t i = 0; i < pattern_.unknown.size(); ++i)
    if (pattern_.unknown[i] != none) b.row(pattern_.unknown[i]) = force.row(static_cast<Eigen::Index>(i));
  Eigen::MatrixXd x(b.rows(), b.cols());
  for (Eigen::Index k = 0; k < b.cols(); ++k) x.col(k) = factor_->solve(Eigen::VectorXd(b.col(k)));
  Eigen::MatrixXd u = Eigen::MatrixXd::Zero(force.rows(), force.cols());
  for (std::size_t i = 0; i < pattern_.unknown.size(); ++i)
    if (pattern_.unknown[i] != none) u.row(static_cast<Eigen::Index>(i)) = x.row(pattern_.unknown[i]);
  return u;
}

Eigen::VectorXd cell_energies(const Lattice& l, const Eigen::Ref<const Eigen::VectorXd>& u) {
  const CellMatrices& unit = cell_matrices();
  Eigen::VectorXd energies = Eigen::VectorXd::Zero(l.part.size());
  for (const Index c : l.cells) {
    Eigen::Matrix<double, 8, 1> at;
    const std::array<Index, 4> corners = l.corners(c);
    for (std::size_t i = 0; i < 4; ++i) at.segment<2>(static_cast<Eigen::Index>(2 * i)) = u.segment<2>(2 * corners[i]);
    energies[c] = l.mu[c] * at.dot(unit.mu * at) + l.lambda[c] * at.dot(unit.lambda * at);
  }
  return energies;
}

}  // namespace kerf
