// The solutions of up to `lanes` dual problems of one model at once [theory: B.30]: all right-hand sides through one
// factor,
//   K x_i = F_i,
// then per triangle the fields inside, R_T P_T x_i, and the recovered displacements u* [theory: R.1] at the nodes that
// the conforming displacement is averaged at. Whatever depends on the triangle alone (the factors of R_T, the values at
// points) is made once for all of them. Duals that are cut off add, in the triangles of their rings, what their loads
// do there with the edges at rest, and C e to the stress, so that its strain is the whole gradient. Rigid motions that
// nothing holds are taken out in the mean of squares. See "Many at once" in docs/theory/bounds.md.

#include "solver/bounds/lane_states.hpp"

#include "base/parallel.hpp"
#include "solver/anisotropic.hpp"
#include "solver/bounds/right_inverse.hpp"
#include "solver/recovery.hpp"
#include "solver/system/elementwise.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

using Row = Eigen::Array<double, 1, lanes>;

/// K x = F for all, those with more than rounding left corrected by it as long as that pays. Returns false where it
/// stays large.
/// `enough`: relative to the largest load, rounding of the substitution; a residual between `least` and `enough` is
/// accepted where a correction does not halve it, a larger one is not. A column of zeros is solved exactly.
bool solve_rows(const Model& m, const Eigen::MatrixXd& F, Eigen::MatrixXd& x) {
  constexpr double enough = 1e-12, least = 1e-10;
  constexpr int most = 3;
  x = m.inner->factor->solve_all(F);
  std::vector<Eigen::Index> left;
  for (Eigen::Index i = 0; i < F.cols(); ++i)
    if (!F.col(i).isZero(0)) left.push_back(i);
  double before = infinity;
  for (int round = 0; round < most && !left.empty(); ++round) {
    std::vector<Eigen::Index> next;
    std::vector<Eigen::VectorXd> rests;
    double worst = 0;
    for (const Eigen::Index i : left) {
      Eigen::VectorXd rest = F.col(i) - multiply(*m.inner->system.K, x.col(i));
      const double error = rest.cwiseAbs().maxCoeff() / F.col(i).cwiseAbs().maxCoeff();
      if (!std::isfinite(error)) return false;
      if (error <= enough) continue;
      worst = std::max(worst, error);
      next.push_back(i);
      rests.push_back(std::move(rest));
    }
    if (!next.empty() && !(worst < 0.5 * before)) return worst < least;
    before = worst;
    left = std::move(next);
    Eigen::MatrixXd all(F.rows(), static_cast<Eigen::Index>(left.size()));
    for (std::size_t k = 0; k < left.size(); ++k) all.col(static_cast<Eigen::Index>(k)) = rests[k];
    const Eigen::MatrixXd change = m.inner->factor->solve_all(all);
    for (std::size_t k = 0; k < left.size(); ++k) x.col(left[k]) += change.col(static_cast<Eigen::Index>(k));
  }
  return true;
}

/// Per unknown of the skeleton, prescribed ones included.
/// A prescribed value belongs to its dual; rows of the system are shared.
void spread(const Model& m, std::span<const LaneDual> duals, const Eigen::MatrixXd& x, LaneArray& skeleton) {
  const Index total = m.inner->skeleton.total;
  skeleton.resize(total, 1);
  for (Index u = 0; u < total; ++u) {
    const Index row = m.inner->ordering.row[u];
    double* to = skeleton.at(u);
    std::fill_n(to, lanes, 0.0);
    for (std::size_t i = 0; i < duals.size(); ++i)
      to[i] = (row == none ? 0 : x(row, static_cast<Eigen::Index>(i))) + duals[i].model->inner->skeleton.prescribed[u];
  }
}

/// What triangle t sees of the fields.
void gather(const Model& m, const LaneArray& skeleton, Index t, double* traces) {
  const Seen view = seen(m.mesh, m.inner->skeleton, t);
  for (int i = 0; i < view.count; ++i) {
    Eigen::Map<Row> to(traces + i * lanes);
    to = Eigen::Map<const Row>(skeleton.at(view.base[i]));
    if (view.jump[i] != none) to += Eigen::Map<const Row>(skeleton.at(view.jump[i]));
  }
}

/// Per triangle int u . motion, and int motion . motion.
struct Moments {
  LaneArray& of_fields;
  std::vector<Eigen::Matrix3d> gram;
};

/// Takes out the motions that no support holds, in the mean of squares.
/// For each field the combination sum_k a_k m_k with G a = (int u . m_k), G = (int m_j . m_k) over the body, is
/// subtracted from multipliers, fields inside, and nodal values alike: the three stay those of one displacement.
void take_out_motions(const Model& m, const Moments& moments, LaneStates& s) {
  const std::vector<RigidMotion>& motions = m.inner->floating;
  const Skeleton& skeleton = m.inner->skeleton;
  const Points at = lattice(m.element.trace + 1);
  const Eigen::Index free = static_cast<Eigen::Index>(motions.size());
  Eigen::Matrix<double, Eigen::Dynamic, lanes> sum = Eigen::Matrix<double, Eigen::Dynamic, lanes>::Zero(free, lanes);
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  for (std::size_t t = 0; t < moments.gram.size(); ++t) {
    gram += moments.gram[t];
    for (Eigen::Index k = 0; k < free; ++k)
      sum.row(k) +=
          Eigen::Map<const Eigen::Matrix<double, 1, lanes>>(moments.of_fields.at(static_cast<Index>(t)) + k * lanes);
  }
  const Eigen::MatrixXd square = gram.topLeftCorner(free, free);
  const Eigen::Matrix<double, Eigen::Dynamic, lanes> share = square.llt().solve(sum);
  for (std::size_t k = 0; k < motions.size(); ++k) {
    const Row by = share.row(static_cast<Eigen::Index>(k)).array();
    const Eigen::VectorXd on_edges = trace(m.mesh, m.inner->kernel, skeleton, motions[k]);
    for (Index u = 0; u < skeleton.base; ++u) Eigen::Map<Row>(s.skeleton.at(u)) -= by * on_edges[u];
  }
  for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t) {
    const Triangle shape = triangle(m, t);
    LaneMotions whole = LaneMotions::Zero();
    for (std::size_t k = 0; k < motions.size(); ++k) {
      const Vec2 moved = motions[k].at(centroid(shape));
      const auto by = share.row(static_cast<Eigen::Index>(k));
      whole.row(0) -= moved.x() * by;
      whole.row(1) -= moved.y() * by;
      whole.row(2) -= motions[k].rotation * by;
    }
    add_motions(m.element, shape, whole, s.interior.at(t));
    for (Eigen::Index q = 0; q < at.cols(); ++q) {
      const Vec2 x =
          shape.x[0] + at(0, q) * (shape.x[1] - shape.x[0]) + at(1, q) * (shape.x[2] - shape.x[0]) - centroid(shape);
      Eigen::Map<Row>(s.nodal.at(t) + 2 * q * lanes) += (whole.row(0) - x.y() * whole.row(2)).array();
      Eigen::Map<Row>(s.nodal.at(t) + (2 * q + 1) * lanes) += (whole.row(1) + x.x() * whole.row(2)).array();
    }
  }
}

/// `fields`: at the points of the rule.
void add_moments(const Model& m, Index t, const double* fields, Moments& to) {
  const TriangleRule& rule = m.inner->kernel.rule;
  const std::vector<RigidMotion>& motions = m.inner->floating;
  const Triangle shape = triangle(m, t);
  const Points places = seen_points(m.inner->kernel, shape, rule);
  Eigen::Matrix3d& gram = to.gram[static_cast<std::size_t>(t)];
  gram.setZero();
  for (Eigen::Index q = 0; q < places.cols(); ++q) {
    const double* u = fields + (q * lane_fields + 4) * lanes;
    Eigen::Matrix<double, 2, 3> at = Eigen::Matrix<double, 2, 3>::Zero();
    for (std::size_t k = 0; k < motions.size(); ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      at.col(column) = motions[k].at(places.col(q));
      const Vec2 by = area(shape) * rule.w[q] * at.col(column);
      Eigen::Map<Row>(to.of_fields.at(t) + k * lanes) +=
          by.x() * Eigen::Map<const Row>(u) + by.y() * Eigen::Map<const Row>(u + lanes);
    }
    gram += area(shape) * rule.w[q] * at.transpose() * at;
  }
}

}  // namespace

void LaneArray::resize(Index items, Index rows_each) {
  rows = rows_each;
  size_ = place(items);
  if (size_ <= room_) return;
  values_.reset();  // before there is another
  values_.reset(new double[size_]);
  room_ = size_;
}

void LaneArray::clear() {
  std::fill_n(values_.get(), size_, 0.0);
}

/// What the pass does not know: curved cells, penalties of incompressible bodies, contact, unknowns at vertices, traces
/// that no triangle sees, orthotropic materials. Such duals are solved one by one.
bool can_solve_together(const Model& m) {
  const std::vector<Material> all = all_materials(m.scene);
  return m.mesh.arc.empty() && is_mixed(m.element) && is_definite(m.element) &&
         m.element.at_vertices == AtVertices::Nothing && m.inner->system.penalty == 0 && m.inner->ordering.size > 0 &&
         m.inner->ordering.contact_rows == 0 && m.inner->skeleton.unseen.empty() && m.inner->semicoercive.empty() &&
         !has_large_contact(m) && std::ranges::all_of(all, [](const Material& of) { return isotropic(of); });
}

namespace {

/// What the loads in a ring cause where the edges rest.
void add_interior(std::span<const LaneDual> duals, const LaneRings& rings, Index t, LaneArray& interior) {
  for (std::size_t i = 0; i < duals.size(); ++i) {
    const int lane = static_cast<int>(i);
    if (!(rings.mask(t) >> i & 1)) continue;
    const auto own = duals[i].ring->interior.col(rings.column(t, lane));
    double* to = interior.at(t) + lane;
    for (Eigen::Index k = 0; k < own.size(); ++k) to[k * lanes] += own[k];
  }
}

/// Adds C e to stresses at the points of the rule, so that their strain is the whole gradient.
/// C e = (tr e)/(4 c) I + 2 mu dev e; with the stress s of the element eps(u*) = A s + e = A (s + C e).
void add_strains(const Model& m, std::span<const LaneDual> duals, const LaneRings& rings, Index t, double* fields) {
  const Material& material = material_of(m.mesh, m.scene, t);
  const Points& at = m.inner->kernel.rule.x;
  for (std::size_t i = 0; i < duals.size(); ++i) {
    const int lane = static_cast<int>(i);
    if (!(rings.mask(t) >> i & 1)) continue;
    const Eigen::Matrix4Xd e = strain_at(duals[i].ring->strain, rings.column(t, lane), at);
    for (Eigen::Index q = 0; q < e.cols(); ++q) {
      double* to = fields + q * lane_fields * lanes + lane;
      const double pressure = (e(0, q) + e(3, q)) / (4 * material.c), difference = material.mu * (e(0, q) - e(3, q)),
                   shear = 2 * material.mu * e(1, q);
      to[0] += pressure + difference;
      to[lanes] += shear;
      to[2 * lanes] += shear;
      to[3 * lanes] += pressure - difference;
    }
  }
}

}  // namespace

/// Triangles are independent once the multipliers are known. The rigid motion that is taken out before the elimination
/// (strain_lanes) and put back after it keeps digits where a triangle moves far and strains little.
bool solve_together(const Model& m, std::span<const LaneDual> duals, const LaneRings& rings, LaneStates& s) {
  const Kernel& kernel = m.inner->kernel;
  const Index triangles = static_cast<Index>(m.mesh.triangles.size());
  const Eigen::Index count = static_cast<Eigen::Index>(duals.size());
  Eigen::MatrixXd F(m.inner->ordering.size, count);
  for (Eigen::Index i = 0; i < count; ++i) F.col(i) = duals[static_cast<std::size_t>(i)].F;
  if (!solve_rows(m, F, s.x)) return false;
  s.count = static_cast<int>(count);
  spread(m, duals, s.x, s.skeleton);
  const Points at = lattice(m.element.trace + 1);
  s.interior.resize(triangles, interior_count(m.element));
  s.nodal.resize(triangles, static_cast<Index>(2 * at.cols()));
  const TriangleRule places{at, Eigen::VectorXd::Zero(at.cols())};
  const std::vector<RigidMotion>& motions = m.inner->floating;
  const Eigen::Index free = static_cast<Eigen::Index>(motions.size());
  Moments moments{s.moments, {}};
  moments.of_fields.resize(free > 0 ? triangles : 0, static_cast<Index>(free));
  moments.of_fields.clear();
  moments.gram.resize(free > 0 ? m.mesh.triangles.size() : 0);
  parallel_for(triangles, m.threads, [&](Index begin, Index end) {
    const TriangleRule& rule = kernel.rule;
    std::vector<double> traces(static_cast<std::size_t>(max_skeleton) * lanes),
        fields(static_cast<std::size_t>(rule.w.size()) * lane_fields * lanes);
    for (Index t = begin; t < end; ++t) {
      const Triangle shape = triangle(m, t);
      const Material& material = material_of(m.mesh, m.scene, t);
      gather(m, s.skeleton, t, traces.data());
      const LaneMotions moved = strain_lanes(kernel, shape, traces.data());
      interiors_lanes(kernel, shape, material, traces.data(), s.interior.at(t));
      add_motions(m.element, shape, moved, s.interior.at(t));
      const bool in_ring = rings.mask(t) != 0;
      if (in_ring) add_interior(duals, rings, t, s.interior);
      evaluate_lanes(kernel, shape, s.interior.at(t), rule_points(rule, shape), fields.data());
      if (in_ring) add_strains(m, duals, rings, t, fields.data());
      recovered_lanes(m, t, fields.data(), rule_points(places, shape), s.nodal.at(t));
      if (free > 0) add_moments(m, t, fields.data(), moments);
    }
  });
  if (free > 0) take_out_motions(m, moments, s);
  return true;
}

}  // namespace kerf
