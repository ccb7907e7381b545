// The error indicator of mixed elements [Carstensen, Dolzmann 1998]. A strain with its rotation, D = A s + Gamma(omega)
// + eigenstrain, would be a gradient: no curl in triangles, the same derivative along an edge from both sides. Per
// triangle
//   eta_T^2 = |as s|^2 + (2 mu)^2 (h^2 |curl D|^2 + sum_e w_e |e| |J_e|^2) + h^2 |f + div s|^2      [theory: R.4],
//   J_e = [D tau] between triangles (w = 1/2), D tau - d_tau u_D on held components (w = 1), else 0   [theory: R.5].
// On a crack the slope of the discrete jump is taken off; what is left counts along the normal where faces touch, along
// the tangent where they stick. What the element does not see of the data is added per triangle, and an index that is
// measured on the body (calibrate.cpp) turns eta into an error [theory: R.6]. An estimate, not a bound. Not for
// displacement elements, whose gradients are compatible. docs/theory/recovery_and_estimates.md, "Error indicator".

#include "kerf/adaptive.hpp"
#include "solver/recovery.hpp"
#include "solver/shared_estimate.hpp"

#include "solver/post/calibrate.hpp"
#include "solver/system.hpp"

#include "base/dense.hpp"
#include "base/parallel.hpp"
#include "base/polynomial.hpp"
#include "kerf/recover.hpp"

#include <Eigen/LU>

#include <array>
#include <cmath>

namespace kerf {

namespace {

constexpr int edge_points = 5;   // exact for the square of a stress of degree 4
constexpr double fading = 3;     // of [theory: B.10]
constexpr double steep = 1e4;    // the square of a derivative over that of the function, of a polynomial of degree 7
constexpr double large = 1e100;  // instead of infinity, so that sums and orders stay

// D tau at the Gauss points of the three edges, in each edge's own direction.
using EdgeTraces = Eigen::Matrix<double, 2, 3 * edge_points>;

struct Interior {
  double square = 0;  // the part of eta^2 that the triangle has by itself
  double unseen = 0;  // of data: of the square of the error
  double stress = 0;  // |s|^2
};

// Derivatives of a polynomial known at the quadrature points, by interpolation in (l1, l2).
// Exact for polynomials of that degree: the rule determines them.
struct Derivatives {
  Eigen::MatrixXd along[2];  // values at the points -> values of d/dl1, d/dl2 there
};

Derivatives derivatives(const TriangleRule& rule, int degree) {
  const Eigen::MatrixXd v = monomials(degree, rule.x).transpose();
  const Eigen::MatrixXd fit = pseudo_inverse(v);
  Derivatives d;
  for (int axis = 0; axis < 2; ++axis) d.along[axis] = multiply(v, derivative(degree, axis), fit);
  return d;
}

// The body force at the points of Kernel::rule: of what the rules do not resolve, its polynomial.
// Where the rules do not resolve the force its own values at points would say nothing of the integral.
Points force_on(const Model& m, Index t, const Points& x) {
  Points force = Points::Zero(2, x.cols());
  if (!m.scene.body) return force;
  const std::vector<TriangleValues>& stored = m.inner->data.body;
  if (!stored.empty() && !stored[t].whole)
    return polynomial_at(stored[t], m.inner->kernel.load, m.inner->kernel.rule.x);
  for (Eigen::Index q = 0; q < x.cols(); ++q) force.col(q) = m.scene.body(x.col(q));
  return force;
}

/// Rows of D: d1 u1, d2 u1, d1 u2, d2 u2, so that curl of row i is d1 D_i2 - d2 D_i1. In curved triangles the
/// derivatives along the reference coordinates are those of a function of the place through the map, D^-1 at every
/// point.
Interior interior_part(const Model& m, const Field& s, Index t, const Derivatives& d) {
  const Triangle shape = triangle(m, t);
  const TriangleRule& rule = m.inner->kernel.rule;
  const Points x = rule_points(rule, shape);
  const Fields f = evaluate(m.inner->kernel, shape, s.interior.col(t), x);
  const Material& material = material_of(m.mesh, m.scene, t);
  const double mu = material.mu;
  double h = 0;
  for (int i = 0; i < 3; ++i) h = std::max(h, (shape.x[(i + 1) % 3] - shape.x[i]).norm());

  Mat2 jacobian;
  jacobian << shape.x[1] - shape.x[0], shape.x[2] - shape.x[0];
  const Mat2 inverse = jacobian.inverse();  // d/dx = sum_k inverse(k, x) d/dl_k
  const Eigen::Index n = x.cols();
  const Eigen::VectorXd w = rule_weights(rule, shape);
  std::vector<Mat2> bent;  // the same in curved triangles, where it changes from point to point
  if (is_curved(shape))
    for (Eigen::Index q = 0; q < n; ++q) bent.emplace_back(inverse * cell_map(shape, rule.x.col(q)).D.inverse());
  Eigen::MatrixX4d gradient(n, 4), stress = f.stress.transpose();
  for (Eigen::Index q = 0; q < n; ++q)
    gradient.row(q) = displacement_gradient(material, f.stress.col(q), f.rotation[q]).transpose();
  const auto derive = [&](const auto& column, int axis) -> Eigen::VectorXd {
    const Eigen::VectorXd first = d.along[0] * column, second = d.along[1] * column;
    if (bent.empty()) return inverse(0, axis) * first + inverse(1, axis) * second;
    Eigen::VectorXd slope(n);
    for (Eigen::Index q = 0; q < n; ++q)
      slope[q] = bent[static_cast<std::size_t>(q)](0, axis) * first[q] +
                 bent[static_cast<std::size_t>(q)](1, axis) * second[q];
    return slope;
  };
  Interior result;
  const bool strained = !m.inner->data.strain.empty();
  std::array<Eigen::Matrix4Xd, 2> free;  // derivatives of the eigenstrain
  for (int axis = 0; axis < 2 && strained; ++axis) free[axis] = eigenstrain_slope_at(m, t, x, axis);
  const Points force = force_on(m, t, x);
  if (!m.inner->data.body.empty()) result.unseen = h * h * std::min(m.inner->data.body[t].rest, large);
  for (int row = 0; row < 2; ++row) {
    Eigen::VectorXd curl = derive(gradient.col(2 * row + 1), 0) - derive(gradient.col(2 * row), 1);
    if (strained) curl += (free[0].row(2 * row + 1) - free[1].row(2 * row)).transpose();
    result.square += 4 * mu * mu * h * h * w.dot(curl.cwiseAbs2());
    if (m.scene.body) {
      const Eigen::VectorXd rest = derive(stress.col(2 * row), 0) + derive(stress.col(2 * row + 1), 1);
      result.square += h * h * w.dot((rest + force.row(row).transpose()).cwiseAbs2());
    }
  }
  result.square += w.dot((stress.col(1) - stress.col(2)).cwiseAbs2());
  for (int c = 0; c < 4; ++c) result.stress += w.dot(stress.col(c).cwiseAbs2());
  if (strained) {
    result.unseen += 4 * mu * mu * std::min(m.inner->data.strain.rest[t], large);
    constexpr double rounding = 1e-12;  // of the stress that the eigenstrain could make
    result.stress += rule.w.dot((rounding * 2 * mu * eigenstrain_at(m, 1, t, x)).colwise().squaredNorm().transpose());
  }
  result.square *= area(shape);
  result.unseen *= area(shape);
  result.stress *= area(shape);
  return result;
}

/// D tau of one triangle on its three edges; neighbours are compared point by point, since both use the edge's own
/// direction.
EdgeTraces edge_traces(const Model& m, const Field& s, Index t, const EdgeRule& rule) {
  const Triangle shape = triangle(m, t);
  Points x(2, 3 * edge_points);
  Points tau(2, 3 * edge_points);
  for (int e = 0; e < 3; ++e) {
    const Index edge = m.mesh.edges_of[t][e];
    const double chord = length(m.mesh, edge);
    for (int g = 0; g < edge_points; ++g) {
      const OnEdge at = on_edge(m.mesh, m.inner->skeleton.curvatures, edge, rule.s[g]);
      x.col(edge_points * e + g) = at.x;
      tau.col(edge_points * e + g) = at.slope / chord;  // of a curved edge per length of its chord
    }
  }
  const Fields f = evaluate(m.inner->kernel, shape, s.interior.col(t), x);
  const Eigen::Matrix4Xd free = eigenstrain_at(m, s.eigenstrain, t, x);
  EdgeTraces traces;
  for (int i = 0; i < 3 * edge_points; ++i) {
    const Eigen::Vector4d d =
        displacement_gradient(material_of(m.mesh, m.scene, t), f.stress.col(i), f.rotation[i]) + free.col(i);
    const Vec2 direction = tau.col(i);
    traces.col(i) << d.head<2>().dot(direction), d.tail<2>().dot(direction);
  }
  return traces;
}

// The data of an edge of the boundary or of a crack under pressure in its frame: which components are prescribed and
// d_tau u_D at the Gauss points, and what the element does not see of the data: the squares of |e| d_tau (u_D - P) and
// of |e| (g - P), their means over the edge.
struct Prescribed {
  std::array<bool, 2> component{false, false};
  Eigen::Matrix<double, 2, edge_points> slope = decltype(slope)::Zero();
  double displacement = 0, traction = 0;
};

// d/ds at s of the polynomials that carry the data.
Eigen::Matrix<double, data_points, 1> data_slope(double s) {
  static const EdgeRule rule = gauss(data_points);
  constexpr double step = 1e-4;  // central differences: exact to 1e-7 for polynomials of degree 7
  return (trace_basis(rule, s + step) - trace_basis(rule, s - step)) / (2 * step);
}

void add_displacement(const Support& support, const EdgeValues& v, Prescribed& p) {
  static const EdgeRule rule = gauss(edge_points);
  for (int d = 0; d < 2; ++d) {
    if (!(d == 0 ? support.first : support.second)) continue;
    p.component[d] = true;
    for (int g = 0; g < edge_points; ++g) p.slope(d, g) = v.at.row(d) * data_slope(rule.s[g]);
    // A polynomial of degree 7 that jumps: its derivative is at most 2 * 7^2 times as large.
    constexpr double most = 1e4;
    p.displacement += std::min({v.rough[d], most * v.rest[d], large});
  }
}

// g less the trace functions: what no stress of the element takes on the edge.
// Legendre polynomials beyond the trace functions hold what a stress of the element cannot take up. The rest beyond
// degree 7 [theory: D.3] counts by its square or, where it changes rapidly, by `fading` times its norm times that of
// its primitive.
double unseen_traction(const Model& m, const EdgeValues& v) {
  static const EdgeRule rule = gauss(data_points);
  double square = 0;
  // Stresses at vertices take the values at both ends as well: cubics.
  const int seen = points_per_edge(m.element) + (m.element.at_vertices == AtVertices::Stress ? 2 : 0);
  for (int k = seen; k < data_points; ++k) {
    Vec2 moment = Vec2::Zero();
    for (int q = 0; q < data_points; ++q) moment += rule.w[q] * legendre(k, rule.s[q]) * v.at.col(q);
    square += moment.squaredNorm();
  }
  // Of rapid changes the stress feels the primitive as well: between the norms of both.
  for (int d = 0; d < 2; ++d) {
    const double values = v.at.row(d).squaredNorm() / data_points;
    const double primitive = std::isfinite(v.primitive[d]) ? v.primitive[d] : values;
    square += v.rest[d] < large ? std::min(v.rest[d], fading * std::sqrt(primitive * v.rest[d])) : steep * primitive;
  }
  return square;
}

// Per edge of the mesh its place in a list of those with data, and these.
struct EdgesWithData {
  std::vector<Index> place;
  std::vector<Prescribed> edges;
};
/// Several tractions on one edge add up; a support holds components of its own.
EdgesWithData edges_with_data(const Model& m) {
  const SceneData& data = m.inner->data;
  EdgesWithData all{std::vector<Index>(m.mesh.edges.size(), none), {}};
  const auto entry = [&](Index e) -> Prescribed& {
    if (all.place[e] == none) {
      all.place[e] = static_cast<Index>(all.edges.size());
      all.edges.emplace_back();
    }
    return all.edges[all.place[e]];
  };
  for (std::size_t i = 0; i < data.supports.size(); ++i)
    for (std::size_t j = 0; j < data.supports[i].values.size(); ++j)
      add_displacement(m.scene.supports[i], data.supports[i].values[j],
                       entry(labeled(data, data.supports[i].label)[j]));
  for (const LoadedEdges& t : data.tractions)
    for (std::size_t j = 0; j < t.values.size(); ++j) {
      const Index e = labeled(data, t.label)[j];
      entry(e).traction += unseen_traction(m, t.values[j]) * std::pow(length(m.mesh, e), 2);
    }
  for (const LoadedCrack& c : data.pressures)
    for (std::size_t j = 0; j < c.values.size(); ++j) {
      const Index e = m.mesh.cracks[c.crack][j].edge;
      entry(e).traction = unseen_traction(m, c.values[j]) * std::pow(length(m.mesh, e), 2);
    }
  return all;
}

// d/dtau of the discrete jump of a crack edge in its frame: where a part of it is open, D tau jumps by as much. Of a
// curved edge per length of its chord, and not in a frame, which turns.
// Of the trace functions of the multiplier, which are polynomials.
Vec2 jump_slope(const Model& m, const Field& s, Index e, double at) {
  constexpr double step = 1e-4;  // central differences: exact to 1e-8 for the cubic functions of a trace
  const Eigen::VectorXd slope =
      (trace_basis(m.inner->kernel.trace, at + step) - trace_basis(m.inner->kernel.trace, at - step)) /
      (2 * step * length(m.mesh, e));
  Vec2 sum = Vec2::Zero();
  for (Eigen::Index g = 0; g < slope.size(); ++g)
    sum += slope[g] * (curvature_at(m.inner->skeleton.curvatures, e)
                           ? Vec2(frame_at(m.inner->skeleton, e, static_cast<int>(g)) *
                                  s.skeleton.segment<2>(m.inner->skeleton.jump[e] + 2 * g))
                           : Vec2(s.skeleton.segment<2>(m.inner->skeleton.jump[e] + 2 * g)));
  return sum;
}

// Where the faces of a crack touch, and where they do not slide either.
struct Faces {
  bool touch = false, stick = false;
};
/// An edge touches if one of its Gauss points does, and sticks if one that touches is held.
Faces faces_of_edge(const Model& m, const Field& s, Index e) {
  const Skeleton& skeleton = m.inner->skeleton;
  Faces f;
  if (skeleton.jump[e] == none) return f;
  for (int k = 0; k < skeleton.per_edge; k += 2) {
    const Index normal = skeleton.jump[e] + k, tangential = normal + 1;
    const bool bonded = skeleton.fixed[normal], touching = bonded || s.force[normal] > 0;
    f.touch = f.touch || touching;
    const bool held = skeleton.frictional[tangential] && s.skeleton[tangential] == skeleton.prescribed[tangential];
    f.stick = f.stick || (touching && (bonded || held));
  }
  return f;
}

// What D tau lacks on the edges of the triangles.
struct EdgeResiduals {
  const Model& m;
  const Field& s;
  const EdgeRule& rule;
  const std::vector<EdgeTraces>& traces;
  const EdgesWithData& data;

  // Across edge i of triangle t to `other`, at the Gauss point g; on a crack in its frame.
  // D includes the eigenstrain: a jump of it between regions is no residual where the elastic strain makes up for it.
  Vec2 across(Index t, int i, Index other, int g) const {
    const Index e = m.mesh.edges_of[t][i];
    int j = 0;
    while (m.mesh.edges_of[other][j] != e) ++j;
    Vec2 jump = traces[t].col(edge_points * i + g);
    jump -= traces[other].col(edge_points * j + g);
    if (m.inner->skeleton.jump[e] == none) return jump;
    const double sign = m.mesh.sides[e][0] == t ? 1 : -1;  // the jump is right minus left
    if (curvature_at(m.inner->skeleton.curvatures, e))
      return frame_between(m.mesh, m.inner->skeleton, e, rule.s[g]).transpose() *
             (jump + sign * jump_slope(m, s, e, rule.s[g]));
    return m.inner->skeleton.frame[e].transpose() * jump + sign * jump_slope(m, s, e, rule.s[g]);
  }

  // On the boundary, in the edge's frame.
  // Where no data are prescribed the tangential derivative is free.
  Vec2 on_boundary(Index t, int i, int g) const {
    const Index e = m.mesh.edges_of[t][i];
    if (data.place[e] == none) return Vec2::Zero();
    const Prescribed& given = data.edges[data.place[e]];
    const Vec2 trace = traces[t].col(edge_points * i + g);
    Vec2 jump = frame_between(m.mesh, m.inner->skeleton, e, rule.s[g]).transpose() * trace -
                given.slope.col(g) / length(m.mesh, e);
    for (int d = 0; d < 2; ++d)
      if (!given.component[d]) jump[d] = 0;
    return jump;
  }

  // Adds what edge i of triangle t has: |e| times an integral over it.
  // An inner edge belongs to two triangles, hence the weight 1/2 on each; |e| times the integral over an edge of length
  // |e| is the mean over its Gauss points times |e|^2.
  void add(Index t, int i, Interior& to) const {
    const Index e = m.mesh.edges_of[t][i];
    const Index other = m.mesh.sides[e][0] == t ? m.mesh.sides[e][1] : m.mesh.sides[e][0];
    // Between two materials most of the jump is the strain error of the softer one.
    const double mu = material_of(m.mesh, m.scene, t).mu,
                 softer = other == none ? mu : std::min(mu, material_of(m.mesh, m.scene, other).mu);
    const double l = length(m.mesh, e), scale = 4 * std::pow(softer * l, 2), weight = other == none ? 1 : 0.5;
    const Faces contact = faces_of_edge(m, s, e);
    for (int g = 0; g < edge_points; ++g) {
      Vec2 jump = other == none ? on_boundary(t, i, g) : across(t, i, other, g);
      if (other != none && m.inner->skeleton.jump[e] != none) {
        if (!contact.touch) jump[0] = 0;
        if (!contact.stick) jump[1] = 0;
      }
      to.square += weight * scale * rule.w[g] * jump.squaredNorm();
    }
    if (data.place[e] != none) {  // a pressure in a crack acts on both sides
      const Prescribed& given = data.edges[data.place[e]];
      to.unseen += 4 * mu * mu * given.displacement + given.traction;
    }
  }
};

}  // namespace

/// Triangles at singular points have a smaller index: their eta is raised to what it would be in the regular part, so
/// that equal eta stands for equal error when the mesh is refined.
Indicator error_indicator(const Model& m, const State& s) {
  return error_indicator(m, s, {});
}

Indicator error_indicator(const Model& m, const State& s, const Sums& sums) {
  if (!can_estimate_error(m.element))  // their gradients are compatible, what they lack is equilibrium
    return {Eigen::VectorXd::Zero(static_cast<Eigen::Index>(m.mesh.triangles.size())), nan};
  const Index triangles = static_cast<Index>(m.mesh.triangles.size());
  const Derivatives difference =
      derivatives(m.inner->kernel.rule, std::max(stress_degree(m.element), m.element.rotation));
  const EdgeRule rule = gauss(edge_points);
  std::vector<Interior> own(triangles);
  std::vector<EdgeTraces> traces(triangles);
  parallel_for(triangles, m.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) {
      own[t] = interior_part(m, s, t, difference);
      traces[t] = edge_traces(m, s, t, rule);
    }
  });
  const EdgesWithData data = edges_with_data(m);
  const EdgeResiduals edges{m, s, rule, traces, data};
  Indicator result{Eigen::VectorXd(triangles), 0};
  double stress = 0;
  for (Index t = 0; t < triangles; ++t) {
    for (int i = 0; i < 3; ++i) edges.add(t, i, own[t]);
    result.eta[t] = std::sqrt(own[t].square);
    if (t < own_triangles(m)) stress += own[t].stress;
  }
  // An efficiency index measures residuals, not what no residual shows.
  const Efficiency index = efficiency(m, s, result.eta, sums);
  double error = 0;
  for (Index t = 0; t < triangles; ++t) {
    const double square =
        own[t].square / std::pow(index.recovered[t] ? index.regular : index.singular, 2) + own[t].unseen;
    if (t < own_triangles(m)) error += square;
    result.eta[t] = index.regular * std::sqrt(square);
  }
  if (sums.add) {
    std::array<double, 2> all{error, stress};
    sums.add(all);
    error = all[0], stress = all[1];
  }
  if (stress > 0) result.relative = std::sqrt(error / stress);
  result.error = error;
  result.stress = stress;
  return result;
}

}  // namespace kerf
