// The data as polynomials, and what these leave out [theory: B.7, D.3]; docs/theory/bounds.md, "What the polynomials
// leave out". Per triangle the L2 projection f_h of the body force onto polynomials of degree trace + 1 (of J f on
// curved triangles),
//   left_out = h/pi |f - f_h|,   h the diameter, with the rest that enclosures prove [theory: D.4];
// per edge the moments of tractions against polynomials of degree 5, as values at 6 Gauss points, what the element does
// not see of them (`unbalanced`), and the square of what degree 5 leaves of degree 7. Components are those of the frame
// of the edge. Crack faces under pressure have one entry for either side, supports and tractions on the same edge share
// one.

#include "solver/bounds/polynomial_data.hpp"

#include "solver/system.hpp"

#include "base/dense.hpp"
#include "base/parallel.hpp"
#include "base/polynomial.hpp"
#include "solver/bounds/right_inverse.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kerf {

/// M c = int basis f with M = int basis basis': the rule must be exact for products of two such polynomials.
Eigen::MatrixXd projection(int degree, const TriangleRule& rule) {
  const Eigen::MatrixXd basis = interpolation(degree, rule.x);  // of the Lagrange functions at the points
  const Eigen::MatrixXd weighted = rule.w.asDiagonal() * basis;
  return solve_lu(transposed_multiply(basis, weighted), weighted.transpose());
}

Eigen::MatrixXd traces(const EdgeRule& carrier, const Eigen::VectorXd& s) {
  Eigen::MatrixXd value(carrier.s.size(), s.size());
  for (Eigen::Index q = 0; q < s.size(); ++q) value.col(q) = trace_basis(carrier, s[q]);
  return value;
}

double diameter(const Triangle& t) {
  double h = 0;
  for (int i = 0; i < 3; ++i) h = std::max(h, (t.x[(i + 1) % 3] - t.x[i]).norm());
  return h;
}

/// couple: the element balances the force that it sees, a mean on each triangle where displacements are constant; the
/// moment of the rest about the centroid asks for a mean asymmetry of the stress of the same size. On a curved cell a
/// constant antisymmetric stress of asymmetry g has the mean g tr(D)/2 there, which `turn` divides by [theory: B.29].
Forces forces(const Model& m) {
  const Element& e = m.element;
  Forces f;
  if (!m.scene.body) return f;
  f.degree = !m.inner->floating.empty() && e.displacement == 0 ? 0 : e.trace + 1;
  const TriangleRule& rule = m.inner->kernel.load;
  const Eigen::MatrixXd project = projection(f.degree, rule), back = interpolation(f.degree, rule.x),
                        mean = multiply(interpolation(e.displacement, rule.x), projection(e.displacement, rule));
  const Index triangles = static_cast<Index>(m.mesh.triangles.size());
  f.nodal.resize(2 * dim(f.degree), triangles);
  f.couple = Eigen::VectorXd::Zero(triangles);
  f.left_out.resize(triangles);
  f.moved = Eigen::VectorXd::Zero(triangles);
  Eigen::VectorXd size(triangles), rest(triangles);
  parallel_for(triangles, m.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) {
      const Triangle shape = triangle(m, t);
      const Points x = rule_points(rule, shape);
      Points value = body_force(m.inner->data, m.scene, t, x);
      const bool curved = is_curved(shape);
      Eigen::RowVectorXd turn = Eigen::RowVectorXd::Ones(x.cols());  // half the trace of D
      for (Eigen::Index q = 0; curved && q < x.cols(); ++q) {
        const CellMap map = cell_map(shape, rule.x.col(q));
        value.col(q) *= map.J;
        turn[q] = 0.5 * map.D.trace();
      }
      const Points nodal = value * project.transpose(), seen = nodal * back.transpose();
      const Points unseen = seen - value * mean.transpose();  // by the element
      f.nodal.col(t) = Eigen::Map<const Eigen::VectorXd>(nodal.data(), nodal.size());
      double square = area(shape) * (value - seen).colwise().squaredNorm().dot(rule.w.transpose());
      if (!m.inner->data.body.empty()) {
        square += area(shape) * m.inner->data.body[t].rest;
        f.moved[t] = area(shape) * m.inner->data.body[t].error;
      }
      f.left_out[t] = diameter(shape) / pi * std::sqrt(square);
      size[t] = value.cwiseAbs().maxCoeff();
      rest[t] = unseen.cwiseAbs().maxCoeff();
      if (e.displacement > 0 && !curved) continue;
      for (Eigen::Index q = 0; q < x.cols(); ++q)
        f.couple[t] -= rule.w[q] * cross(unseen.col(q), x.col(q) - centroid(shape));
      f.couple[t] /= turn * rule.w;
    }
  });
  // Below 1000 roundings of the largest force nothing is left to correct.
  f.balanced = rest.maxCoeff() <= 1e3 * std::numeric_limits<double>::epsilon() * size.maxCoeff();
  if (f.balanced || (e.displacement > 0 && m.mesh.arc.empty())) f.couple.resize(0);
  return f;
}

namespace {

// Data of an edge at gauss(data_points).
using Sampled = Eigen::Matrix<double, 2, data_points>;

// A pressure and a shear on a face whose normal turns, per length of the chord and in its frame. What a product with
// the normal leaves out is at most the longest normal times the rest.
// Data are sampled on the curve; slope/l is dx/ds over the length of the chord, whose rotation is the normal times
// |dx/ds|.
void along_curve(const Model& m, const EdgeValues& given, EdgeData& d, Sampled& at) {
  const EdgeRule sample = gauss(data_points);
  const double l = length(m.mesh, d.edge);
  double longest = 1;
  for (int q = 0; q < data_points; ++q) {
    const Vec2 slope = on_edge(m.mesh, m.inner->skeleton.curvatures, d.edge, sample.s[q]).slope / l,
               n(slope.y(), -slope.x());
    at.col(q) =
        m.inner->skeleton.frame[d.edge].transpose() * (given.at(0, q) * n + given.at(1, q) * Vec2(-n.y(), n.x()));
    longest = std::max(longest, n.norm());
  }
  d.unseen.setConstant(longest * given.rest.cwiseSqrt().sum());
  d.primitive = d.unseen;
  d.moved.setConstant(longest * given.error.sum());
}

// Both sides of the cracks whose faces are loaded, and what acts on them, in the frame of the edge.
// The pressure pushes the left face against the normal, the right one along it.
void add_pressures(const Model& m, std::vector<EdgeData>& data, std::vector<Sampled>& load) {
  for (const LoadedCrack& c : m.inner->data.pressures)
    for (std::size_t j = 0; j < c.values.size(); ++j)
      for (const int side : {0, 1}) {
        const EdgeValues& given = c.values[j];
        EdgeData d;
        d.edge = m.mesh.cracks[c.crack][j].edge;
        d.triangle = m.mesh.sides[d.edge][side];
        while (m.mesh.edges_of[d.triangle][d.side] != d.edge) ++d.side;
        d.displacement.setZero();
        d.unseen = given.rest.cwiseSqrt();
        d.primitive = given.primitive.cwiseSqrt();
        d.moved = given.error;
        Sampled at = given.at;
        if (curvature_at(m.inner->skeleton.curvatures, d.edge)) along_curve(m, given, d, at);
        data.push_back(d);
        load.emplace_back((side == 0 ? -1 : 1) * at);
      }
}

}  // namespace

/// Frames of such an edge differ from point to point (Skeleton::bent_at).
bool rolls_along_curve(const Model& m, Index edge) {
  const Skeleton& s = m.inner->skeleton;
  return m.mesh.label[edge] != none && s.bent_at[edge] != none && curvature_at(s.curvatures, edge);
}

namespace {

/// What is prescribed and what acts on edges, edge by edge; loads as they are sampled until all are there.
class GivenOnEdges {
 public:
  explicit GivenOnEdges(const Model& m) : m_(m), place_(m.mesh.edges.size(), none) {}

  void add_support(const Support& support, Index e, const EdgeValues& given) {
    const EdgeLine line = edge_line(m_.mesh, e);
    EdgeData& d = data_[entry(e)];
    for (int k = 0; k < 2; ++k) {
      if (!(k == 0 ? support.first : support.second)) continue;
      d.held[k] = true;
      d.bent = d.bent || rolls_along_curve(m_, e);
      d.displacement.row(k) = given.at.row(k);
      d.ends.row(k) << support.value(line.a, line.n)[k], support.value(line.b, line.n)[k];
      d.rest[k] = given.rest[k];
      d.rough[k] = given.rough[k];
    }
  }

  void add_traction(Index e, const EdgeValues& given) {
    EdgeData& d = data_[entry(e)];
    const Mat2& frame = m_.inner->skeleton.frame[e];
    load_[place_[e]] += frame.transpose() * given.at;
    // Of the components along the frame, at most.
    for (int k = 0; k < 2; ++k) {
      const Vec2 share = frame.col(k).cwiseAbs();
      for (int c = 0; c < 2; ++c) {
        if (share[c] == 0) continue;
        d.unseen[k] += share[c] * std::sqrt(given.rest[c]);
        d.primitive[k] += share[c] * std::sqrt(given.primitive[c]);
      }
      d.moved[k] += share.dot(given.error);
    }
  }

  /// With pressures on cracks. d.load has the moments against the trace basis at 6 points divided by the weights;
  /// `unbalanced` is that less the same with the trace functions of the element, both at the 6 points. A held component
  /// takes up whatever acts on it.
  std::vector<EdgeData> fitted() && {
    add_pressures(m_, data_, load_);
    const EdgeRule carrier = gauss(data_carriers), sample = gauss(data_points), &own = m_.inner->kernel.trace;
    const Eigen::MatrixXd basis = traces(carrier, sample.s), trace = traces(own, sample.s),
                          trace_at_carrier = traces(own, carrier.s);
    for (std::size_t i = 0; i < data_.size(); ++i) {
      EdgeData& d = data_[i];
      const Eigen::Matrix<double, 2, data_points> weighted = load_[i] * sample.w.asDiagonal();
      d.load = weighted * basis.transpose() * carrier.w.cwiseInverse().asDiagonal();
      d.unbalanced = d.load - weighted * trace.transpose() * own.w.cwiseInverse().asDiagonal() * trace_at_carrier;
      const Eigen::Matrix<double, 2, data_points> rest = load_[i] - d.load * basis;
      for (int k = 0; k < 2; ++k) {
        if (d.held[k] || d.bent) d.unbalanced.row(k).setZero();
        if (!d.held[k]) d.left_out += length(m_.mesh, d.edge) * rest.row(k).cwiseAbs2().dot(sample.w.transpose());
      }
    }
    return std::move(data_);
  }

 private:
  Index entry(Index e) {
    if (place_[e] == none) {
      place_[e] = static_cast<Index>(data_.size());
      EdgeData d;
      d.edge = e;
      d.triangle = m_.mesh.sides[e][m_.mesh.sides[e][0] == none ? 1 : 0];
      while (m_.mesh.edges_of[d.triangle][d.side] != e) ++d.side;
      d.displacement.setZero();
      data_.push_back(d);
      load_.emplace_back(Sampled::Zero());
    }
    return place_[e];
  }

  const Model& m_;
  std::vector<Index> place_;
  std::vector<EdgeData> data_;
  std::vector<Sampled> load_;
};

}  // namespace

std::vector<EdgeData> edge_data(const Model& m) {
  GivenOnEdges given(m);
  const SceneData& scene = m.inner->data;
  for (std::size_t i = 0; i < scene.supports.size(); ++i)
    for (std::size_t j = 0; j < scene.supports[i].values.size(); ++j)
      given.add_support(m.scene.supports[i], labeled(scene, m.scene.supports[i].label)[j], scene.supports[i].values[j]);
  for (const LoadedEdges& traction : scene.tractions)
    for (std::size_t j = 0; j < traction.values.size(); ++j)
      given.add_traction(labeled(scene, traction.label)[j], traction.values[j]);
  return std::move(given).fitted();
}

}  // namespace kerf
