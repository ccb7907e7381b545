// Loads of duals that are cut off, in the triangles where grad chi is not 0 [theory: B.20, B.42];
// docs/theory/bounds.md, "Cut off, many at once". For all fields G that share a disc, sampled together at the points of
// a triangle,
//   body force f = sigma_G grad chi,   eigenstrain e = -sym(grad chi x G);
// f as a polynomial of degree trace + 1 and e of degree 4, with what both leave out and the errors of their integrals,
// as solver/bounds/polynomial_data.cpp and solver/data/strain.cpp do for the data of a scene. One elimination per
// triangle makes of their moments the fields inside with the edges at rest (`interior`) and the loads on the edges
// (`given`). assemble_ring adds these up to a right-hand side; in a body that nothing holds, tractions on free edges
// balance what is left.

#include "solver/bounds/ring_loads.hpp"

#include "base/dense.hpp"
#include "base/parallel.hpp"
#include "base/polynomial.hpp"
#include "solver/bounds/right_inverse.hpp"
#include "solver/bounds/statics.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr int degree = 4;  // of the polynomials that an eigenstrain enters by

/// What one dual has at points: body force, the normal components of its eigenstrain, shear and nothing.
struct RingValues {
  std::array<Points, 3> of;
  void resize(Eigen::Index points) {
    for (Points& p : of) p.setZero(2, points);
  }
  bool vanish() const {
    return of[0].isZero(0) && of[1].isZero(0) && of[2].isZero(0);
  }
};
using AllValues = std::array<RingValues, Nuclei::most>;

/// Rows of `of`: force x, y; strain 11, 22; strain 12 and 0.
void put(const NucleusValue& G, const Vec2& slope, Eigen::Index q, RingValues& to) {
  to.of[0].col(q) = G.stress * slope;
  to.of[1].col(q) = -slope.cwiseProduct(G.displacement);
  to.of[2](0, q) = -0.5 * (slope.x() * G.displacement.y() + slope.y() * G.displacement.x());
}

/// All that does not depend on the triangle is made once per block: projections onto polynomials, and the buffers.
class RingSampling {
 public:
  RingSampling(const Model& m, const CutOffRing& ring, std::span<const std::size_t> fields)
      : m_(m), kernel_(m.inner->kernel), ring_(ring), fields_(fields) {
    const TriangleRule &rule = kernel_.load, &finer = finer_rule();
    const int force = m.element.trace + 1, seen = m.element.displacement;
    project_force_ = projection(force, rule).transpose();
    force_at_ = interpolation(force, rule.x).transpose();
    mean_at_ = multiply(interpolation(seen, rule.x), projection(seen, rule)).transpose();
    basis_ = monomials(degree, rule.x);
    const Eigen::MatrixXd weighted = basis_ * rule.w.asDiagonal();
    project_strain_ = solve_spd(multiply_transposed(weighted, basis_), weighted).transpose();
    exact_ = triangle_rule(degree + stress_degree(m.element));
    for (RingValues& v : at_) v.resize(rule.w.size());
    for (RingValues& v : finer_) v.resize(finer.w.size());
    moments_.resize(displacement_count(m.element) + stress_count(m.element), static_cast<Eigen::Index>(fields.size()));
    interior_.resize(interior_count(m.element), moments_.cols());
    given_.resize(skeleton_count(m.element), moments_.cols());
  }

  /// A field of which neither rule sees anything in this triangle has no load there.
  void operator()(Index column, Index t, std::vector<RingLoads>& to) {
    const Triangle shape = triangle(m_, t);
    sample(shape, kernel_.load, at_);
    sample(shape, finer_rule(), finer_);
    bool vanish = true;
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      const bool none_here = at_[fields_[i]].vanish() && finer_[fields_[i]].vanish();
      if (none_here)
        moments_.col(static_cast<Eigen::Index>(i)).setZero();
      else
        look(column, shape, i, to[i]);
      vanish = vanish && none_here;
    }
    if (vanish) return;
    Loaded local{interior_, given_};
    loaded(kernel_, shape, material_of(m_.mesh, m_.scene, t), moments_, local);
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      if (to[i].f.couple.size() > 0) add_couple(shape, to[i].f.couple[column], static_cast<Eigen::Index>(i));
      to[i].interior.col(column) = interior_.col(static_cast<Eigen::Index>(i));
      to[i].given.col(column) = given_.col(static_cast<Eigen::Index>(i));
    }
  }

  /// Data somewhere were not resolved.
  bool is_open() const {
    return open_;
  }

 private:
  void sample(const Triangle& shape, const TriangleRule& rule, AllValues& to) const {
    std::array<NucleusValue, Nuclei::most> G;
    for (Eigen::Index q = 0; q < rule.w.size(); ++q) {
      const Vec2 x = (1 - rule.x(0, q) - rule.x(1, q)) * shape.x[0] + rule.x(0, q) * shape.x[1] +
                     rule.x(1, q) * shape.x[2],
                 slope = ring_.slope(x);
      if (slope.isZero(0)) {
        for (const std::size_t i : fields_) put({}, slope, q, to[i]);
        continue;
      }
      ring_.fields.at(x, G);
      for (const std::size_t i : fields_) put(G[i], slope, q, to[i]);
    }
  }

  /// `first_look` settles most triangles from the two rules; the others are cut and looked at until the data are
  /// resolved.
  TriangleValues values(const Triangle& shape, std::size_t field, int kind) const {
    const auto which = static_cast<std::size_t>(kind);
    if (std::optional<TriangleValues> v = first_look(at_[field].of[which], kernel_.load, finer_[field].of[which]))
      return std::move(*v);
    const VectorField f = [&](const Vec2& x) -> Vec2 {
      RingValues one;
      one.resize(1);
      if (const Vec2 slope = ring_.slope(x); !slope.isZero(0)) {
        std::array<NucleusValue, Nuclei::most> G;
        ring_.fields.at(x, G);
        put(G[field], slope, 0, one);
      }
      return one.of[which].col(0);
    };
    return triangle_values(f, shape.x, kernel_.load, 0, kind == 0 ? "body force" : "eigenstrain");
  }

  /// Moments of the force against displacements and of the eigenstrain against stresses, the right-hand side of the
  /// elimination.
  void look(Index column, const Triangle& shape, std::size_t i, RingLoads& to) {
    const std::size_t field = fields_[i];
    const TriangleValues body = values(shape, field, 0), normal = values(shape, field, 1),
                         shear = values(shape, field, 2);
    for (const TriangleValues* v : {&body, &normal, &shear}) open_ = open_ || v->how == Resolution::Open;
    set_force(column, shape, body, to.f);
    set_strain(column, normal, shear, to.strain);
    auto moments = moments_.col(static_cast<Eigen::Index>(i));
    moments.head(displacement_count(m_.element)) = force_moments(kernel_, shape, body.at);
    const Eigen::Index n = exact_.w.size();
    const Fields w{strain_at(to.strain, column, exact_.x) * exact_.w.asDiagonal(), Points::Zero(2, n),
                   Eigen::RowVectorXd::Zero(n)};
    moments.tail(stress_count(m_.element)) =
        weigh(kernel_, shape, rule_points(exact_, shape), w).head(stress_count(m_.element));
  }

  /// As `forces`.
  void set_force(Index column, const Triangle& shape, const TriangleValues& v, Forces& f) const {
    const Eigen::VectorXd& w = kernel_.load.w;
    const Points nodal = v.at * project_force_, seen = nodal * force_at_;
    f.nodal.col(column) = Eigen::Map<const Eigen::VectorXd>(nodal.data(), nodal.size());
    const double square = area(shape) * ((v.at - seen).colwise().squaredNorm().dot(w.transpose()) + v.rest);
    f.left_out[column] = diameter(shape) / pi * std::sqrt(square);
    f.moved[column] = area(shape) * v.error;
    if (f.couple.size() == 0) return;
    const Points unseen = seen - v.at * mean_at_;
    double couple = 0;
    for (Eigen::Index q = 0; q < w.size(); ++q) {
      const Vec2 d = kernel_.load.x(0, q) * (shape.x[1] - shape.x[0]) +
                     kernel_.load.x(1, q) * (shape.x[2] - shape.x[0]) + shape.x[0] - centroid(shape);
      couple -= w[q] * cross(unseen.col(q), d);
    }
    f.couple[column] = couple;
  }

  /// As `strain_data`.
  void set_strain(Index column, const TriangleValues& normal, const TriangleValues& shear, StrainData& to) const {
    Eigen::Matrix4Xd at(4, normal.at.cols());
    at << normal.at, shear.at;
    const Eigen::Matrix4Xd c = at * project_strain_, left = at - c * basis_;
    to.coefficients.col(column) = Eigen::Map<const Eigen::VectorXd>(c.data(), c.size());
    const Eigen::RowVector4d counts(1, 1, 2, 0);  // the shear counts twice in |e|
    to.rest[column] = normal.rest + 2 * shear.rest + counts * left.cwiseAbs2() * kernel_.load.w;
    to.error[column] = normal.error + 2 * shear.error;
  }

  /// As static_interior.
  /// The couple is a load of the displacement, too, not of the stress alone: see "Cut off, many at once" in
  /// docs/theory/bounds.md.
  void add_couple(const Triangle& shape, double couple, Eigen::Index i) {
    const Mat2 stress = antisymmetric(couple);
    Eigen::Index at = 0;
    for (int e = 0; e < 3; ++e) {
      const Vec2 side = shape.x[(e + 2) % 3] - shape.x[(e + 1) % 3];
      const Vec2 force = shape.frame[e].transpose() * stress * Vec2(side.y(), -side.x());
      for (Eigen::Index g = 0; g < kernel_.trace.w.size(); ++g)
        for (int d = 0; d < 2; ++d, ++at) given_(at, i) -= kernel_.trace.w[g] * force[d];
    }
  }

  const Model& m_;
  const Kernel& kernel_;
  const CutOffRing& ring_;
  std::span<const std::size_t> fields_;
  Eigen::MatrixXd project_force_, force_at_, mean_at_, basis_, project_strain_;
  TriangleRule exact_;
  AllValues at_, finer_;
  Eigen::MatrixXd moments_, interior_, given_;
  bool open_ = false;
};

/// A body force that is seen by its means alone needs couples; `balanced` is false, as the element never sees all of
/// it.
RingLoads empty_loads(const Model& m, std::shared_ptr<const std::vector<Index>> triangles) {
  const Eigen::Index count = static_cast<Eigen::Index>(triangles->size());
  const Element& e = m.element;
  RingLoads r;
  r.triangles = std::move(triangles);
  r.f.degree = e.trace + 1;
  r.f.nodal.setZero(2 * dim(r.f.degree), count);
  r.f.balanced = false;
  if (e.displacement == 0) r.f.couple.setZero(count);
  r.f.left_out.setZero(count);
  r.f.moved.setZero(count);
  r.strain.degree = degree;
  r.strain.coefficients.setZero(4 * dim(degree), count);
  r.strain.rest.setZero(count);
  r.strain.error.setZero(count);
  r.interior.setZero(interior_count(e), count);
  r.given.setZero(skeleton_count(e), count);
  return r;
}

}  // namespace

/// A superset: triangles that are surely within the inner circle or beyond the outer one are left out.
std::shared_ptr<const std::vector<Index>> ring_triangles(const Model& m, const CutOffRing& ring) {
  auto all = std::make_shared<std::vector<Index>>();
  for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t) {
    const Triangle shape = triangle(m, t);
    double nearest = infinity, farthest = 0;
    for (const Vec2& x : shape.x) {
      const double r = (x - ring.middle).norm();
      nearest = std::min(nearest, r);
      farthest = std::max(farthest, r);
    }
    if (farthest > ring.inner && nearest - diameter(shape) < ring.outer) all->push_back(t);
  }
  return all;
}

/// Blocks of a fixed size write to columns of their own; the sampling keeps its buffers within a block.
std::vector<RingLoads> ring_loads(const Model& m, const CutOffRing& ring, std::span<const std::size_t> fields) {
  const std::shared_ptr<const std::vector<Index>> triangles = ring_triangles(m, ring);
  std::vector<RingLoads> all;
  for (std::size_t i = 0; i < fields.size(); ++i) all.push_back(empty_loads(m, triangles));
  const Index count = static_cast<Index>(triangles->size());
  constexpr Index block = 256;
  std::vector<unsigned char> open(static_cast<std::size_t>((count + block - 1) / block), 0);
  parallel_tasks(static_cast<Index>(open.size()), m.threads, [&](Index b) {
    RingSampling sampling(m, ring, fields);
    for (Index i = b * block; i < std::min(count, (b + 1) * block); ++i)
      sampling(i, (*triangles)[static_cast<std::size_t>(i)], all);
    open[static_cast<std::size_t>(b)] = sampling.is_open() ? 1 : 0;
  });
  for (RingLoads& r : all) r.open = std::ranges::count(open, 1) > 0;
  return all;
}

namespace {

/// What tractions on free edges must take: the combination of motions that undoes the work `net` on each.
/// Tractions sum_k a_k m_k with the motions m_k, G a = -net, G = int m_j . m_k over the free edges. They count as an
/// error of the integral of the data on each edge (`moved`), by their largest size.
struct EdgeBalance {
  const Model& m;
  std::vector<EdgeData*> edges;

  Vec2 at(const Eigen::VectorXd& share, const Vec2& x) const {
    Vec2 sum = Vec2::Zero();
    for (Eigen::Index k = 0; k < share.size(); ++k)
      sum += share[k] * m.inner->floating[static_cast<std::size_t>(k)].at(x);
    return sum;
  }
  Vec2 place(Index e, double s) const {
    const auto& [a, b] = m.mesh.edges[e];
    return m.mesh.points[a] + s * (m.mesh.points[b] - m.mesh.points[a]);
  }
  /// Two Gauss points integrate products of two motions, which are linear along an edge.
  Eigen::VectorXd shares(const Eigen::VectorXd& net) const {
    const std::vector<RigidMotion>& motions = m.inner->floating;
    const EdgeRule rule = gauss(2);
    const Eigen::Index n = net.size();
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(n, n);
    for (const EdgeData* d : edges)
      for (Eigen::Index q = 0; q < rule.w.size(); ++q) {
        const Vec2 x = place(d->edge, rule.s[q]);
        for (Eigen::Index i = 0; i < n; ++i)
          for (Eigen::Index j = 0; j < n; ++j)
            gram(i, j) += length(m.mesh, d->edge) * rule.w[q] *
                          motions[static_cast<std::size_t>(i)].at(x).dot(motions[static_cast<std::size_t>(j)].at(x));
      }
    return -solve_spd(gram, net);
  }
  void add(const Eigen::VectorXd& share, Eigen::VectorXd& F) const {
    static const EdgeRule carrier = gauss(data_carriers);
    const EdgeRule& trace = m.inner->kernel.trace;
    for (EdgeData* d : edges) {
      const Mat2& frame = m.inner->skeleton.frame[d->edge];
      for (int q = 0; q < data_carriers; ++q)
        d->load.col(q) += frame.transpose() * at(share, place(d->edge, carrier.s[q]));
      const double most = std::max(at(share, place(d->edge, 0)).norm(), at(share, place(d->edge, 1)).norm());
      d->moved += Vec2::Constant(most);
      for (Eigen::Index g = 0; g < trace.w.size(); ++g) {
        const Vec2 moment =
            length(m.mesh, d->edge) * trace.w[g] * frame.transpose() * at(share, place(d->edge, trace.s[g]));
        for (int k = 0; k < 2; ++k)
          if (const Index row = m.inner->ordering.row[d->edge * m.inner->skeleton.per_edge + 2 * g + k]; row != none)
            F[row] += moment[k];
      }
    }
  }
};

}  // namespace

/// The work of the loads on a rigid motion is known to vanish for the exact loads of G; what is left is the
/// quadrature's.
bool assemble_ring(LaneDual& dual) {
  const Model& m = *dual.model;
  const RingLoads& ring = *dual.ring;
  const std::vector<RigidMotion>& motions = m.inner->floating;
  dual.F = m.inner->system.F;
  std::vector<Eigen::VectorXd> moved;
  for (const RigidMotion& motion : motions) moved.push_back(trace(m.mesh, m.inner->kernel, m.inner->skeleton, motion));
  Eigen::VectorXd net = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(motions.size())), size = net;
  for (std::size_t c = 0; c < ring.triangles->size(); ++c) {
    const Seen view = seen(m.mesh, m.inner->skeleton, (*ring.triangles)[c]);
    const auto given = ring.given.col(static_cast<Eigen::Index>(c));
    for (int i = 0; i < view.count; ++i) {
      for (const Index u : {view.base[i], view.jump[i]})
        if (u != none && m.inner->ordering.row[u] != none) dual.F[m.inner->ordering.row[u]] += given[i];
      for (std::size_t k = 0; k < moved.size(); ++k) {
        const double work = given[i] * moved[k][view.base[i]];
        net[static_cast<Eigen::Index>(k)] += work;
        size[static_cast<Eigen::Index>(k)] += std::abs(work);
      }
    }
  }
  if (motions.empty()) return true;
  // Of the sum of absolute works: beyond it the quadrature has not resolved the loads.
  constexpr double small = 1e-4;
  if (!((net.array().abs() <= small * size.array()).all())) return false;
  EdgeBalance balance{m, {}};
  for (EdgeData& d : dual.data)
    if (m.mesh.crack[d.edge] == none && !d.held[0] && !d.held[1]) balance.edges.push_back(&d);
  if (balance.edges.empty() || m.element.trace < 1) return false;
  balance.add(balance.shares(net), dual.F);
  return true;
}

/// At most `lanes` duals, eight bits.
LaneRings::LaneRings(std::span<const LaneDual> duals, Index triangles) {
  for (std::size_t i = 0; i < duals.size(); ++i) {
    if (!duals[i].ring) continue;
    if (mask_.empty()) mask_.assign(static_cast<std::size_t>(triangles), 0);
    column_[i].assign(static_cast<std::size_t>(triangles), none);
    const std::vector<Index>& of = *duals[i].ring->triangles;
    for (std::size_t c = 0; c < of.size(); ++c) {
      mask_[static_cast<std::size_t>(of[c])] |= static_cast<unsigned char>(1u << i);
      column_[i][static_cast<std::size_t>(of[c])] = static_cast<Index>(c);
    }
  }
}

}  // namespace kerf
