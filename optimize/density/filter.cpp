// Averages over discs of cells with the weights w_cd = s_d max(0, r - |x_c - x_d|), normed to the sum 1 over d, s_d the
// share of a cell in the body. They are rows of a sparse matrix over the cells of the body: averages are w x, their
// transpose w' g carries derivatives back, and smoothed derivatives w (x g)/max(x, 1e-3) are derivatives of nothing,
// but keep checkerboards away [Sigmund 1997; theory: P.5]. The mean of a density and its mirror image takes the image
// of a center bilinearly from four centers; where it leaves the body a cell is its own image. Lengths are in cells.
// docs/theory/density.md, section "Filters".

#include "optimize/density/filter.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

// Rows of the matrix w, compressed: cone weights times shares, summed to 1, of the cells of the body within the radius.
LatticeFilter::LatticeFilter(const Lattice& lattice, double radius) : l_(lattice), start_{0} {
  const Index reach = static_cast<Index>(std::ceil(radius));
  for (const Index c : l_.cells) {
    const Index column = c % l_.columns, row = c / l_.columns;
    const std::size_t first = weight_.size();
    double sum = 0;
    for (Index y = std::max(row - reach, 0); y <= std::min(row + reach, l_.rows - 1); ++y)
      for (Index x = std::max(column - reach, 0); x <= std::min(column + reach, l_.columns - 1); ++x) {
        const double weight = (radius - std::hypot(x - column, y - row)) * l_.part[x + l_.columns * y];
        if (!(weight > 0)) continue;
        cell_.push_back(x + l_.columns * y);
        weight_.push_back(weight);
        sum += weight;
      }
    for (std::size_t i = first; i < weight_.size(); ++i) weight_[i] /= sum;
    start_.push_back(static_cast<Index>(weight_.size()));
  }
}

Eigen::VectorXd LatticeFilter::average(const Eigen::VectorXd& x) const {
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(x.size());
  for (std::size_t k = 0; k < l_.cells.size(); ++k) {
    double sum = 0;
    for (Index i = start_[k]; i < start_[k + 1]; ++i)
      sum += weight_[static_cast<std::size_t>(i)] * x[cell_[static_cast<std::size_t>(i)]];
    mean[l_.cells[k]] = sum;
  }
  return mean;
}

Eigen::VectorXd LatticeFilter::pull_back(const Eigen::VectorXd& derivative) const {
  Eigen::VectorXd back = Eigen::VectorXd::Zero(derivative.size());
  for (std::size_t k = 0; k < l_.cells.size(); ++k)
    for (Index i = start_[k]; i < start_[k + 1]; ++i)
      back[cell_[static_cast<std::size_t>(i)]] += weight_[static_cast<std::size_t>(i)] * derivative[l_.cells[k]];
  return back;
}

Eigen::VectorXd LatticeFilter::smooth_derivative(const Eigen::VectorXd& x, const Eigen::VectorXd& derivative) const {
  // Nearly empty cells would divide by nothing.
  constexpr double least = 1e-3;  // density divided by
  Eigen::VectorXd smooth = average(x.cwiseProduct(derivative));
  for (const Index c : l_.cells) smooth[c] /= std::max(x[c], least);
  return smooth;
}

std::array<std::pair<Index, double>, 4> between_centers(Index columns, Index rows, const Vec2& x) {
  const auto split = [](double at, Index count) {
    const double place = std::clamp(at - 0.5, 0.0, count - 1.0);
    const Index low = std::min(static_cast<Index>(place), std::max(count - 2, 0));
    return std::pair{low, place - low};
  };
  const auto [i, s] = split(x.x(), columns);
  const auto [j, t] = split(x.y(), rows);
  const Index right = std::min(i + 1, columns - 1), up = std::min(j + 1, rows - 1);
  return {{{i + columns * j, (1 - s) * (1 - t)},
           {right + columns * j, s * (1 - t)},
           {i + columns * up, (1 - s) * t},
           {right + columns * up, s * t}}};
}

// The density at the mirror image of a center lies between four centers; where the image leaves the body it is the
// cell's own.
LatticeMirror::LatticeMirror(const Lattice& lattice) : l_(lattice) {
  if (!l_.mirror) return;
  for (const Index c : l_.cells) {
    const Vec2 d = l_.center(c) - l_.mirror->point, along = l_.mirror->direction;
    const Vec2 x = l_.mirror->point + 2 * along.dot(d) * along - d;
    auto image = between_centers(l_.columns, l_.rows, x);
    const Index at = std::clamp(static_cast<Index>(x.x()), 0, l_.columns - 1) +
                     l_.columns * std::clamp(static_cast<Index>(x.y()), 0, l_.rows - 1);
    const bool off = x.x() < 0 || x.y() < 0 || x.x() > l_.columns || x.y() > l_.rows;
    if (off || l_.part[at] == 0) image = {{{c, 1}, {c, 0}, {c, 0}, {c, 0}}};
    for (auto& [cell, weight] : image) cell = l_.inside[static_cast<std::size_t>(cell)];
    image_.push_back(image);
  }
}

Eigen::VectorXd LatticeMirror::symmetrized(const Eigen::VectorXd& x) const {
  if (image_.empty()) return x;
  Eigen::VectorXd mean = x;
  for (std::size_t k = 0; k < image_.size(); ++k) {
    double image = 0;
    for (const auto& [cell, weight] : image_[k]) image += weight * x[cell];
    mean[l_.cells[k]] = (x[l_.cells[k]] + image) / 2;
  }
  return mean;
}

}  // namespace kerf
