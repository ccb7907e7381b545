// A bound on the largest stress, box by box [theory: K.6]. In each box the constraint is the p-norm over it scaled to
// its own largest stress, so that a notch is paid for where it is: of one norm over the body all members would pay for
// it. A mesh of straight edges sees the points of its quadrature, which lie inside: what a finer one with curved edges
// says of the same design is a factor of each box.

#include "optimize/curves/stress_rows.hpp"

#include "kerf/shape_gradient.hpp"
#include "topo/max_stress.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr double box_of_body = 0.035;  // edge, in diagonals of the frame
constexpr double counts_from = 0.75;   // of the bound
constexpr double least_factor = 0.8, most_factor = 1.4;

}  // namespace

StressBoxes::StressBoxes(const Shape& frame) : edge_(box_of_body * extent(frame)) {
  const Polygon outline = flatten(frame.outline, 1e-3 * edge_, edge_);
  Vec2 high = low_ = outline.points.front();
  for (const Vec2& x : outline.points) low_ = low_.cwiseMin(x), high = high.cwiseMax(x);
  columns_ = static_cast<Index>(std::ceil((high.x() - low_.x()) / edge_ + 1e-9));
  rows_ = static_cast<Index>(std::ceil((high.y() - low_.y()) / edge_ + 1e-9));
}

Index StressBoxes::of(const Vec2& x) const {
  const auto place = [&](double at, Index most) {
    return std::clamp<Index>(static_cast<Index>(std::floor(at / edge_)), 0, most - 1);
  };
  return place(x.x() - low_.x(), columns_) + columns_ * place(x.y() - low_.y(), rows_);
}

// Those at the rim reach beyond it, for points that round off or steps take there.
std::array<Vec2, 2> StressBoxes::box(Index i) const {
  const Index column = i % columns_, row = i / columns_;
  Vec2 low = low_ + edge_ * Vec2(column, row), high = low + Vec2::Constant(edge_);
  if (column == 0) low.x() -= edge_;
  if (row == 0) low.y() -= edge_;
  if (column + 1 == columns_) high.x() += edge_;
  if (row + 1 == rows_) high.y() += edge_;
  return {low, high};
}

Eigen::VectorXd StressBoxes::largest(const LargestStress& what, const SolvedCase& c) const {
  Eigen::VectorXd most = Eigen::VectorXd::Zero(count());
  for (const StressAt& s : stresses_outside(what, c.model, c.state)) most[of(s.at)] = std::max(most[of(s.at)], s.value);
  return most;
}

const LargestStress* largest_of(const Functional& j) {
  return j.terms.size() == 1 && j.terms.front().factor == 1 ? j.terms.front().largest.get() : nullptr;
}

StressRows stress_rows(const LargestStress& what, double at_most, const StressBoxes& boxes,
                       const Eigen::VectorXd& factor, const SolvedCase& c, const CurveMesh& follows,
                       const DesignCurves& d) {
  const Eigen::VectorXd most = boxes.largest(what, c).cwiseProduct(factor) / at_most;
  StressRows rows{Eigen::VectorXd::Constant(boxes.count(), idle_box),
                  Eigen::MatrixXd::Zero(d.variables, boxes.count())};
  for (Index i = 0; i < boxes.count(); ++i) {
    if (most[i] < counts_from) continue;
    const auto [low, high] = boxes.box(i);
    const Functional norm{.kind = "max_stress", .terms = {norm_in_box(what, low, high)}};
    const Analysis a = analyze(norm, c.model, c.state);
    if (!(a.value > 0)) continue;
    rows.value[i] = most[i] - 1;
    rows.by.col(i) = most[i] / a.value * pull_back(follows, d, shape_gradient(a, norm));
  }
  return rows;
}

double fully_stressed(const LargestStress& what, double at_most, std::span<const SolvedCase> cases) {
  constexpr double nearly = 0.9;
  const Mesh& mesh = cases.front().model.mesh;
  std::vector<double> most(mesh.edges.size(), -1);
  for (const SolvedCase& c : cases) {
    const auto bears = [&](Index label) {
      const auto on = [label](const auto& x) { return x.label == label; };
      return label != none &&
             (std::ranges::any_of(c.model.scene.supports, on) || std::ranges::any_of(c.model.scene.tractions, on));
    };
    for (const EdgeStress& s : boundary_stresses(what, c.model, c.state))
      if (!bears(mesh.label[static_cast<std::size_t>(s.edge)]))
        most[static_cast<std::size_t>(s.edge)] = std::max(most[static_cast<std::size_t>(s.edge)], s.value);
  }
  double all = 0, full = 0;
  for (std::size_t e = 0; e < most.size(); ++e) {
    if (most[e] < 0) continue;
    const double part = length(mesh, static_cast<Index>(e));
    all += part;
    if (most[e] >= nearly * at_most) full += part;
  }
  return all > 0 ? full / all : 0;
}

double stress_factor(double finer, double here) {
  return std::clamp(finer / std::max(here, 1e-300), least_factor, most_factor);
}

}  // namespace kerf
