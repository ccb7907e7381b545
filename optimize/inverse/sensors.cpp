// Displacements at points of the boundary, from the traces on the edges of a mesh; weighted sums of them as integrals
// over the label, whose derivatives by state and shape are known (docs/theory/inverse.md, "Least squares").

#include "optimize/inverse/sensors.hpp"

#include "geometry/plane.hpp"
#include "solver/system.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

namespace kerf {

Sensors::Sensors(const Mesh& mesh, const Readings& readings) : label_(readings.label) {
  double size = 0;
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e)
    if (mesh.label[e] == label_) {
      lines_.push_back({e, mesh.points[mesh.edges[e][0]], mesh.points[mesh.edges[e][1]]});
      size += (lines_.back().b - lines_.back().a).norm();
    }
  if (lines_.empty()) throw Error(Fault::Usage, "readings: nothing of the boundary has the label they belong to");
  for (const Vec2& x : readings.at) {
    // At a vertex both edges are as near, and each has half.
    double least = infinity;
    std::vector<Spot> near;
    for (const Line& line : lines_) {
      const double t = foot(x, line.a, line.b), away = (x - line.a - t * (line.b - line.a)).norm();
      if (away < least - 1e-9 * size) near.clear();
      if (away < least + 1e-9 * size) near.push_back({line.edge, t, 1});
      least = std::min(least, away);
    }
    for (Spot& spot : near) spot.share = 1.0 / static_cast<double>(near.size());
    spots_.push_back(std::move(near));
  }
}

// Traces are in the frame of their edge; the polynomials are those of Lagrange at its Gauss points.
Eigen::VectorXd Sensors::read(const Model& m, const Field& s) const {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(2 * static_cast<Eigen::Index>(spots_.size()));
  for (std::size_t i = 0; i < spots_.size(); ++i)
    for (const Spot& spot : spots_[i]) {
      const Eigen::VectorXd basis = trace_basis(m.inner->kernel.trace, spot.at);
      const Index first = edge_unknown(m.inner->skeleton, spot.edge);
      for (Eigen::Index g = 0; g < basis.size(); ++g)
        out.segment<2>(2 * static_cast<Eigen::Index>(i)) +=
            spot.share * basis[g] *
            (m.inner->skeleton.frame[spot.edge] * s.skeleton.segment<2>(first + 2 * static_cast<Index>(g)));
    }
  return out;
}

Term Sensors::weighted(const Model& m, const Eigen::VectorXd& weights) const {
  // On an edge of length l: the representer of a value at t is sum_g b_g(t)/(w_g l) b_g(s), with the basis b of
  // Lagrange at Gauss points of weights w: their products are integrated exactly.
  const EdgeRule& trace = m.inner->kernel.trace;
  struct OnEdge {
    Vec2 a, along;
    double length;
    Eigen::Matrix2Xd coefficient;  // per Gauss point
  };
  auto edges = std::make_shared<std::vector<OnEdge>>();
  std::map<Index, std::size_t> place;
  for (const Line& line : lines_) {
    place[line.edge] = edges->size();
    const double length = (line.b - line.a).norm();
    edges->push_back({line.a, (line.b - line.a) / length, length, Eigen::Matrix2Xd::Zero(2, trace.s.size())});
  }
  for (std::size_t i = 0; i < spots_.size(); ++i)
    for (const Spot& spot : spots_[i]) {
      OnEdge& on = (*edges)[place.at(spot.edge)];
      const Eigen::VectorXd basis = trace_basis(trace, spot.at);
      for (Eigen::Index g = 0; g < basis.size(); ++g)
        on.coefficient.col(g) +=
            spot.share * basis[g] / (trace.w[g] * on.length) * weights.segment<2>(2 * static_cast<Eigen::Index>(i));
    }
  std::erase_if(*edges, [](const OnEdge& e) { return e.coefficient.isZero(0); });
  Term term{.kind = "reading", .linear = true, .label = label_};
  // A boundary point knows no edge: the one that it lies on is looked for.
  term.on_boundary = [edges, trace](const Vec2& x, const Vec2&, const Vec2& u) {
    Density out;
    for (const OnEdge& e : *edges) {
      const double t = (x - e.a).dot(e.along) / e.length;
      if (t < 0 || t > 1 || std::abs(cross(e.along, x - e.a)) > 1e-9 * e.length) continue;
      const Eigen::VectorXd basis = trace_basis(trace, t);
      out.by_displacement = e.coefficient * basis;
      out.value = out.by_displacement.dot(u);
      break;
    }
    return out;
  };
  return term;
}

}  // namespace kerf
