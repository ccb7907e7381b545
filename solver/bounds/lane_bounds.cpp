// Bounds of the works between one state u and up to `lanes` duals w_i in one pass over the triangles [theory: B.30];
// the section "Many at once" of docs/theory/bounds.md derives it. Per triangle T the admissible stress p and
// displacement v of every dual are made as in triangle_bounds.cpp, side by side in one SIMD row, and the sums
//   Pi_T(w_i) = -1/2 (A p, p),  1/2 (C eps(v), eps(v)) - (f, v)    and the bilinear    Pi_T(u, w_i)
// are taken. Fields are coefficients in functions that are orthonormal on the triangle [theory: B.42], so that an
// integral of a product is a sum over modes and u enters with its own coefficients alone. In the ring of a dual that is
// cut off [theory: B.20] its body force and eigenstrain add the terms of loads, in a larger set of modes. Triangles
// with data on their edges take the duals one by one through Bounding. Straight triangles, isotropic compressible
// materials, and a state without eigenstrain only; sums run over fixed blocks of triangles, so that bits do not depend
// on the number of threads.

#include "solver/bounds/lane_bounds.hpp"

#include "base/parallel.hpp"
#include "solver/bounds/triangle_bounds.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>

namespace kerf {

namespace {

using Row = Eigen::Array<double, 1, lanes>;
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// c = A b for fields side by side; the rows of b are `stride` lanes apart.
/// Four rows of A at a time share the loads of b; the order of the sums over k is the same in both loops.
void product(const Matrix& A, const double* b, Eigen::Index stride, double* c) {
  const Eigen::Index rows = A.rows(), inner = A.cols();
  Eigen::Index i = 0;
  for (; i + 3 < rows; i += 4) {
    Row sum[4] = {Row::Zero(), Row::Zero(), Row::Zero(), Row::Zero()};
    const double* a = A.data() + i * inner;
    for (Eigen::Index k = 0; k < inner; ++k) {
      const Row x = Eigen::Map<const Row>(b + k * stride * lanes);
      for (int j = 0; j < 4; ++j) sum[j] += a[j * inner + k] * x;
    }
    for (int j = 0; j < 4; ++j) Eigen::Map<Row>(c + (i + j) * lanes) = sum[j];
  }
  for (; i < rows; ++i) {
    Row sum = Row::Zero();
    for (Eigen::Index k = 0; k < inner; ++k) sum += A(i, k) * Eigen::Map<const Row>(b + k * stride * lanes);
    Eigen::Map<Row>(c + i * lanes) = sum;
  }
}

/// Sums over triangles, per field.
/// `lower`, `upper`: shares of the dual's own bounds; `size`: what they are sums of in absolute value, for rounding;
/// `below`, `above`: by how much the rest of its eigenstrain may move them; `crossed_*`: the products with u.
struct Sums {
  Row lower = Row::Zero(), upper = Row::Zero(), size = Row::Zero(), below = Row::Zero(), above = Row::Zero();
  Row crossed_lower = Row::Zero(), crossed_upper = Row::Zero(), crossed_size = Row::Zero();

  void add(const Sums& s) {
    lower += s.lower, upper += s.upper, size += s.size, below += s.below, above += s.above;
    crossed_lower += s.crossed_lower, crossed_upper += s.crossed_upper, crossed_size += s.crossed_size;
  }
  void add(int lane, const Share& s, const Products& p) {
    lower[lane] += s.lower, upper[lane] += s.upper, size[lane] += s.size;
    below[lane] += s.below, above[lane] += s.above;
    crossed_lower[lane] += p.lower, crossed_upper[lane] += p.upper, crossed_size[lane] += p.size;
  }
};

/// The loads of fields side by side in one triangle, in modes.
struct RingRows {
  std::vector<double> strain, force;  // 11, 22, 12; x, y
  Row rest, error, left_out;
};

/// A 2 x 2 matrix of fields side by side, and J x inverse.
struct LaneMat {
  Row m[2][2];
};
/// The four components are `stride` numbers apart.
/// With x the gradient of X, div X = g on the triangle of reference, this is that of the field of divergence g on the
/// body: J (grad X) J^-1/det J by Piola's map for the right-hand side det J g, and the two det J cancel.
LaneMat rotated_gradients(const Mat2& J, const double* x, Eigen::Index stride, const Mat2& inverse) {
  Row by[2][2];
  for (int k = 0; k < 2; ++k) {
    const Eigen::Map<const Row> first(x + 2 * k * stride), second(x + (2 * k + 1) * stride);
    for (int j = 0; j < 2; ++j) by[k][j] = inverse(0, j) * first + inverse(1, j) * second;
  }
  LaneMat y;
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) y.m[i][j] = J(i, 0) * by[0][j] + J(i, 1) * by[1][j];
  return y;
}

class LaneBounding {
 public:
  LaneBounding(const LaneOwn& own, std::span<const LaneDual> duals, const LaneRings& rings, LaneRoom& room)
      : own_(own),
        u_(own.u),
        by_(own.averages),
        duals_(duals),
        rings_(rings),
        states_(room.states),
        conforming_(room.conforming),
        tractions_(room.tractions),
        size_(room.size) {
    for (const LaneDual& dual : duals) data_.push_back(dual.data);
    conforming_lanes(by_, u_.m, states_, data_, conforming_);
    const Index triangles = static_cast<Index>(u_.m.mesh.triangles.size());
    tractions_.resize(triangles, static_cast<Index>(6 * points_per_edge(u_.m.element)));
    size_.resize(triangles, 2);
    for (std::size_t i = 0; i < duals.size(); ++i)
      if (duals[i].ring) ring_shares_[i].resize(duals[i].ring->triangles->size());
    sum_over_triangles();
  }

  /// Nothing, instead of a poor interval, where the imbalance of the stress is above the share `few_digits` of the
  /// energy: the caller then solves for that dual alone, with refinement.
  std::optional<CrossEnergy> of(int lane) const {
    const auto i = static_cast<std::size_t>(lane);
    const Model& dual = *duals_[i].model;
    if (const std::string why = unseen_by_bounds(dual); !why.empty()) return CrossEnergy{.note = why};
    const Forces& forces = duals_[i].ring ? duals_[i].ring->f : none_inside_;
    const std::vector<Rest> rests = rests_of(dual, data_[i], forces, u_.edges, rings_.columns(lane));
    EnergySums sums{.imbalance = imbalance_[i],
                    .oscillation = oscillation(rests, lane, 1, false),
                    .mismatch = conforming_.of[i].mismatch};
    sums.sum.lower = sum_.lower[lane], sums.sum.upper = sum_.upper[lane], sums.sum.size = sum_.size[lane];
    sums.sum.below = sum_.below[lane], sums.sum.above = sum_.above[lane];
    const EnergyBounds bounds = energy_interval(dual, sums);
    if (!(sums.imbalance <= 0.5 * few_digits * sums.sum.size)) return std::nullopt;
    if (!std::isfinite(bounds.upper - bounds.lower)) return CrossEnergy{.note = bounds.note};
    const double rounding = (64 * std::numeric_limits<double>::epsilon() + 2 * bounds.imbalance) * sums.sum.size;
    const Products p{sum_.crossed_lower[lane], sum_.crossed_upper[lane], sum_.crossed_size[lane]};
    return cross_interval(
        u_.m,
        {u_.bounds, std::max(u_.sum.upper - u_.sum.lower, 0.0), u_.rounding, u_.conforming.mismatch,
         unseen_couples(u_.f)},
        {bounds, std::max(sums.sum.upper - sums.sum.lower, 0.0), rounding, sums.mismatch, false}, p,
        [&](double k) { return oscillation(rests, lane, k, true); },
        [&](double k) { return eigenstrain_unseen(lane, k); });
  }

 private:
  /// Buffers of one thread: rows of `lanes` numbers, components one after the other.
  struct Room {
    std::vector<double> fields, stress, tensor, asymmetry, curl, wanted, correction, nodal, gradient, displacement, own;
    RingRows ring;
  };

  /// The blocks are of a fixed size and are added in their order: the result does not depend on who computed which.
  void sum_over_triangles() {
    constexpr Index block = 512;
    const Index triangles = static_cast<Index>(u_.m.mesh.triangles.size()), blocks = (triangles + block - 1) / block;
    std::vector<Sums> sums(static_cast<std::size_t>(blocks));
    parallel_tasks(blocks, u_.m.threads, [&](Index b) {
      Room room = make_room();
      for (Index t = b * block; t < std::min(triangles, (b + 1) * block); ++t)
        if (u_.edges[static_cast<std::size_t>(t)].empty())
          inside(t, room, sums[static_cast<std::size_t>(b)]);
        else
          beside_data(t, sums[static_cast<std::size_t>(b)]);
    });
    for (const Sums& s : sums) sum_.add(s);
    for (int lane = 0; lane < states_.count; ++lane) {
      Products p;
      const std::vector<EdgeData>& data = data_[static_cast<std::size_t>(lane)];
      // Works on the edges of the data are few: one by one, after the triangles, in the order of the data.
      for (std::size_t i = 0; i < data.size(); ++i)
        p.add(crossed_on_edge(
            {u_.m, u_.data[i], u_.conforming.value[i], u_.shares[data[i].triangle].tractions},
            {*duals_[static_cast<std::size_t>(lane)].model, data[i],
             conforming_.of[static_cast<std::size_t>(lane)].value[i], tractions_at(data[i].triangle, lane)}));
      sum_.add(lane, {}, p);
    }
    sum_imbalance();
  }

  Room make_room() const {
    const auto room = [](Eigen::Index rows) { return std::vector<double>(static_cast<std::size_t>(rows * lanes)); };
    const Modes &low = own_.low, &most = own_.ring ? *own_.ring : own_.low;
    const Eigen::Index moved = dim(by_.degree);
    Room r{room(lane_fields * low.polynomials),
           room(4 * low.polynomials),
           room(4 * most.polynomials),
           room(most.polynomials),
           room(4 * most.count),
           room(most.polynomials),
           room(4 * most.count),
           room(2 * by_.per_triangle),
           room(4 * dim(u_.m.element.trace)),
           room(4 * moved),
           std::vector<double>(static_cast<std::size_t>(8 * most.count)),
           {}};
    r.ring.strain = room(3 * dim(strain_degree));
    r.ring.force = room(2 * moved);
    return r;
  }

  Tractions tractions_at(Index t, int lane) const {
    Tractions at(2, tractions_.rows / 2);
    const double* from = tractions_.at(t) + lane;
    for (Index i = 0; i < tractions_.rows; ++i) at(i % 2, i / 2) = from[i * lanes];
    return at;
  }

  /// Component k, x or y, of the conforming displacements at the nodes of a triangle.
  /// The values lie side by side per node; here components come first, as the matrices of the modes want them.
  void gather(Index t, double* nodal) const {
    const int n = by_.per_triangle;
    for (int i = 0; i < n; ++i) {
      const double* from = conforming_.values.at(by_.of[static_cast<std::size_t>(t) * n + i]);
      for (int k = 0; k < 2; ++k)
        Eigen::Map<Row>(nodal + (k * n + i) * lanes) = Eigen::Map<const Row>(from + k * lanes);
    }
  }

  /// In a triangle where some duals have a ring and others do not, the pass is made twice, each for its own lanes by a
  /// mask of zeros and ones; a triangle that is in no ring takes the small set of modes alone.
  void inside(Index t, Room& room, Sums& sums) {
    const Triangle shape = triangle(u_.m, t);
    const Mat2 J = jacobian(shape.x), inverse = J.inverse();
    const Modes& low = own_.low;
    Points nodes(2, low.nodes.cols());
    for (Eigen::Index q = 0; q < nodes.cols(); ++q)
      nodes.col(q) =
          shape.x[0] + low.nodes(0, q) * (shape.x[1] - shape.x[0]) + low.nodes(1, q) * (shape.x[2] - shape.x[0]);
    evaluate_lanes(u_.m.inner->kernel, shape, states_.interior.at(t), nodes, room.fields.data());
    const unsigned mask = rings_.mask(t);
    if (mask != 0) add_couples(t, mask, low.polynomials, room.fields.data());
    put_tractions(t, shape, room);
    for (int c = 0; c < 4; ++c)
      product(low.to_modes, room.fields.data() + c * lanes, lane_fields,
              room.stress.data() + c * low.polynomials * lanes);
    gather(t, room.nodal.data());
    make_gradients({J, inverse}, room);
    Row in_ring = Row::Zero();
    for (int lane = 0; lane < lanes; ++lane) in_ring[lane] = mask >> lane & 1 ? 1 : 0;
    const unsigned every = (1u << states_.count) - 1;
    const Cell cell{t, shape, material_of(u_.m.mesh, u_.m.scene, t), J, inverse, area(shape)};
    if (mask != every)
      in_modes(cell, {own_.low, own_.fields.col(t).data(), room.stress.data(), nullptr, 1 - in_ring}, room, sums);
    if (mask != 0) {
      gather_loads(t, mask, room);
      in_modes(cell, {*own_.ring, own_in_ring(t, room), whole_stress(cell, room), &room.ring, in_ring}, room, sums);
    }
  }

  struct Cell {
    Index t;
    const Triangle& shape;
    const Material& material;
    const Mat2 &J, &inverse;
    double area;
  };
  /// One way to sum over a triangle, for the fields that are `active` (1, else 0).
  struct Way {
    const Modes& modes;
    const double* own;     // stress and strain of u, 4 columns each
    const double* stress;  // components of all polynomials
    const RingRows* ring;  // or nothing
    Row active;
  };
  void in_modes(const Cell& cell, const Way& way, Room& room, Sums& sums) {
    RingSums of_ring;
    lower(cell, way, room, sums, of_ring);
    upper(cell, way, room, sums, of_ring);
    if (way.ring) put_ring(cell, way, of_ring, sums);
  }

  /// The mean asymmetry that body forces need which the element sees by their means alone.
  void add_couples(Index t, unsigned mask, Eigen::Index nodes, double* fields) const {
    for (int lane = 0; lane < states_.count; ++lane) {
      if (!(mask >> lane & 1)) continue;
      const Eigen::VectorXd& couple = duals_[static_cast<std::size_t>(lane)].ring->f.couple;
      if (couple.size() == 0) continue;
      const double half = 0.5 * couple[rings_.column(t, lane)];
      for (Eigen::Index q = 0; q < nodes; ++q) {
        fields[(q * lane_fields + 1) * lanes + lane] += half;
        fields[(q * lane_fields + 2) * lanes + lane] -= half;
      }
    }
  }

  /// From the monomials of the eigenstrain and the nodal values of the body force to modes of the ring; lanes that have
  /// no load here stay 0.
  void gather_loads(Index t, unsigned mask, Room& room) const {
    const Modes& modes = *own_.ring;
    RingRows& to = room.ring;
    std::fill(to.strain.begin(), to.strain.end(), 0.0);
    std::fill(to.force.begin(), to.force.end(), 0.0);
    to.rest.setZero(), to.error.setZero(), to.left_out.setZero();
    constexpr int n = dim(strain_degree);
    const Eigen::Index moved = dim(by_.degree);
    for (int lane = 0; lane < states_.count; ++lane) {
      if (!(mask >> lane & 1)) continue;
      const RingLoads& ring = *duals_[static_cast<std::size_t>(lane)].ring;
      const Index column = rings_.column(t, lane);
      const Eigen::Map<const Eigen::Matrix<double, 4, n>> e(ring.strain.coefficients.col(column).data());
      const Eigen::Matrix<double, n, 3> of_strain = modes.strain * e.topRows<3>().transpose();
      for (int c = 0; c < 3; ++c)
        for (int r = 0; r < n; ++r) to.strain[static_cast<std::size_t>((c * n + r) * lanes + lane)] = of_strain(r, c);
      const Eigen::Map<const Points> f(ring.f.nodal.col(column).data(), 2, moved);
      for (int c = 0; c < 2; ++c)
        for (Eigen::Index r = 0; r < moved; ++r)
          to.force[static_cast<std::size_t>((c * moved + r) * lanes + lane)] = modes.displacement.row(r).dot(f.row(c));
      to.rest[lane] = ring.strain.rest[column];
      to.error[lane] = ring.strain.error[column];
      to.left_out[lane] = ring.f.left_out[column];
    }
  }

  /// Stress and strain of u in the modes of the ring.
  const double* own_in_ring(Index t, Room& room) const {
    if (own_.ring_fields.cols() > 0) return own_.ring_fields.col(t).data();
    const Eigen::Map<const Eigen::MatrixXd> from(own_.fields.col(t).data(), own_.low.count, 8);
    Eigen::Map<Eigen::MatrixXd>(room.own.data(), own_.ring->count, 8).noalias() = own_.change * from;
    return room.own.data();
  }

  /// The stress with what the element does not see of the body force.
  /// `unseen_` maps modes of a body force to those of a stress without normal trace whose divergence is what the
  /// element does not see of it. Piola's map of a row is J row/det J; det J cancels against that of the right-hand
  /// side.
  const double* whole_stress(const Cell& cell, Room& room) const {
    const Modes &low = own_.low, &modes = *own_.ring;
    const Eigen::Index n = modes.polynomials, moved = dim(by_.degree);
    Row part[2];
    // The body force in the nodal values that `unseen_force` takes is made of modes again: both are polynomials.
    for (int row = 0; row < 2; ++row)
      for (Eigen::Index r = 0; r < n; ++r) {
        for (int k = 0; k < 2; ++k) {
          part[k].setZero();
          for (Eigen::Index j = 0; j < moved; ++j)
            part[k] += unseen_(k * n + r, j) *
                       Eigen::Map<const Row>(&room.ring.force[static_cast<std::size_t>((row * moved + j) * lanes)]);
        }
        for (int axis = 0; axis < 2; ++axis) {
          const int c = 2 * row + axis;
          Eigen::Map<Row> to(&room.tensor[static_cast<std::size_t>((c * n + r) * lanes)]);
          to = cell.J(axis, 0) * part[0] + cell.J(axis, 1) * part[1];
          if (r < low.polynomials)
            to += Eigen::Map<const Row>(&room.stress[static_cast<std::size_t>((c * low.polynomials + r) * lanes)]);
        }
      }
    return room.tensor.data();
  }

  /// As Bounding::tractions, from values at the nodes of the stress.
  void put_tractions(Index t, const Triangle& shape, Room& room) {
    const Eigen::Index points = u_.m.inner->kernel.trace.w.size();
    for (int e = 0; e < 3; ++e) {
      const Vec2 side = shape.x[(e + 2) % 3] - shape.x[(e + 1) % 3];
      const Vec2 n = Vec2(side.y(), -side.x()).normalized();
      const Modes::Matrix& at = own_.low.at_edge[e][shape.forward[e] ? 1 : 0];
      for (Eigen::Index g = 0; g < points; ++g) {
        Row s[4] = {Row::Zero(), Row::Zero(), Row::Zero(), Row::Zero()};
        for (Eigen::Index k = 0; k < at.cols(); ++k)
          for (int c = 0; c < 4; ++c)
            s[c] += at(g, k) * Eigen::Map<const Row>(room.fields.data() + (k * lane_fields + c) * lanes);
        const Row x = n.x() * s[0] + n.y() * s[1], y = n.x() * s[2] + n.y() * s[3];
        for (int k = 0; k < 2; ++k)
          Eigen::Map<Row>(tractions_.at(t) + (2 * (points * e + g) + k) * lanes) =
              shape.frame[e](0, k) * x + shape.frame[e](1, k) * y;
      }
    }
  }

  struct Maps {
    const Mat2 &J, &inverse;
  };
  /// d_j v_k of the conforming displacements in polynomials of degree trace, and those of degree trace + 1 of v.
  void make_gradients(const Maps& by, Room& room) const {
    const Eigen::Index slopes = dim(u_.m.element.trace), n = by_.per_triangle, moved = dim(by_.degree);
    for (int k = 0; k < 2; ++k)
      for (Eigen::Index r = 0; r < slopes; ++r) {
        Row d[2] = {Row::Zero(), Row::Zero()};
        for (Eigen::Index i = 0; i < n; ++i) {
          const Eigen::Map<const Row> v(room.nodal.data() + (k * n + i) * lanes);
          for (int axis = 0; axis < 2; ++axis) d[axis] += own_.low.slope[axis](r, i) * v;
        }
        for (int j = 0; j < 2; ++j)
          Eigen::Map<Row>(room.gradient.data() + ((2 * k + j) * slopes + r) * lanes) =
              by.inverse(0, j) * d[0] + by.inverse(1, j) * d[1];
      }
    for (int k = 0; k < 2; ++k)
      product(own_.low.displacement, room.nodal.data() + k * n * lanes, 1,
              room.displacement.data() + k * moved * lanes);
  }

  /// What is gathered in a triangle of a ring on the way.
  struct RingSums {
    Row square = Row::Zero(), stress = Row::Zero(), strain = Row::Zero(), elastic = Row::Zero();
  };

  static Eigen::Map<const Row> at(const std::vector<double>& rows, Eigen::Index i) {
    return Eigen::Map<const Row>(rows.data() + i * lanes);
  }

  /// As Bounding::lower.
  /// With modes orthonormal in the mean over T, (a, b)_T = |T| sum_r a_r b_r. The modes r < n are polynomials, which
  /// the stress has beside the curl; the others only the curl reaches. In a ring the first `strains` modes are the
  /// polynomials of degree 4 that the rest of the eigenstrain does not work on: what the stress has in the others is
  /// its `square`.
  void lower(const Cell& cell, const Way& way, Room& room, Sums& sums, RingSums& of_ring) const {
    const Modes& modes = way.modes;
    const Eigen::Index n = modes.polynomials, count = modes.count;
    const auto tensor = [&](int c, Eigen::Index r) { return Eigen::Map<const Row>(way.stress + (c * n + r) * lanes); };
    for (Eigen::Index r = 0; r < n; ++r)
      Eigen::Map<Row>(room.asymmetry.data() + r * lanes) = tensor(1, r) - tensor(2, r);
    product(modes.derivative, room.asymmetry.data(), 1, room.curl.data());
    const double shear = 1 / (2 * cell.material.mu), c = cell.material.c;
    constexpr int strains = dim(strain_degree);
    Row energy = Row::Zero(), crossed = Row::Zero(), size = Row::Zero(), freed = Row::Zero();
    Row largest[3] = {Row::Zero(), Row::Zero(), Row::Zero()};
    for (Eigen::Index r = 0; r < count; ++r) {
      const LaneMat g = rotated_gradients(cell.J, room.curl.data() + r * lanes, count * lanes, cell.inverse);
      Row s11 = g.m[0][1], s12 = -g.m[0][0], s21 = g.m[1][1], s22 = -g.m[1][0];
      if (r < n) s11 += tensor(0, r), s12 += tensor(1, r), s21 += tensor(2, r), s22 += tensor(3, r);
      const Row trace = s11 + s22, difference = s11 - s22;
      energy += shear * (0.5 * difference * difference + s12 * s12 + s21 * s21) + c * trace * trace;
      const double *p = way.own + r, p11 = p[0], p12 = p[count], p21 = p[2 * count], p22 = p[3 * count];
      const Row work = shear * (0.5 * (p11 - p22) * difference + p12 * s12 + p21 * s21) + c * (p11 + p22) * trace;
      crossed += work;
      size += work.abs();
      if (!way.ring) continue;
      if (r < strains) {
        const Eigen::Map<const Row> e11 = at(way.ring->strain, r), e22 = at(way.ring->strain, strains + r),
                                    e12 = at(way.ring->strain, 2 * strains + r);
        freed += e11 * s11 + e22 * s22 + e12 * (s12 + s21);
        const Row of_own = e11 * p11 + e22 * p22 + e12 * (p12 + p21);
        crossed += of_own;
        size += of_own.abs();
      } else {
        of_ring.square += s11 * s11 + s12 * s12 + s21 * s21 + s22 * s22;
      }
      largest[0] += modes.peak[r] * s11.abs(), largest[1] += modes.peak[r] * s12.abs(),
          largest[2] += modes.peak[r] * s22.abs();
    }
    const double half = 0.5 * cell.area;
    sums.lower -= way.active * (half * energy + cell.area * freed);
    sums.size += way.active * (half * energy + cell.area * freed.abs());
    sums.crossed_lower -= way.active * half * crossed;
    sums.crossed_size += way.active * half * size;
    // A sum of |coefficient| times the peak of its mode is at least the largest value.
    of_ring.stress = largest[0].max(largest[1]).max(largest[2]);
  }

  static void put_rows(std::vector<Row>& rows, Eigen::Index mode, const std::array<Row, 3>& of) {
    for (std::size_t c = 0; c < 3; ++c) rows[3 * static_cast<std::size_t>(mode) + c] = of[c];
  }
  /// Of three components, at the points of the rule.
  static Row largest_of(const Modes& modes, const std::vector<Row>& rows) {
    Row largest = Row::Zero();
    for (Eigen::Index q = 0; q < modes.values.rows(); ++q)
      for (std::size_t c = 0; c < 3; ++c) {
        Row at = Row::Zero();
        for (Eigen::Index r = 0; r < modes.count; ++r)
          at += modes.values(q, r) * rows[3 * static_cast<std::size_t>(r) + c];
        largest = largest.max(at.abs());
      }
    return largest;
  }

  /// As Bounding::upper.
  /// e, b, a: the energy of v + alpha w is e + alpha b + alpha^2 a per area. with_g and with_h: the products of u's
  /// strain with those of v and of w. Modes of v end at `slopes`, those of an eigenstrain at `strains`. c > 0
  /// throughout, so that alpha minimises.
  void upper(const Cell& cell, const Way& way, Room& room, Sums& sums, RingSums& of_ring) {
    const Modes& modes = way.modes;
    const Eigen::Index count = modes.count, slopes = dim(u_.m.element.trace);
    constexpr int strains = dim(strain_degree);
    want_divergence(cell, way, room);
    product(modes.derivative, room.wanted.data(), 1, room.correction.data());
    const double mu = cell.material.mu, bulk = 1 / (4 * cell.material.c);
    Row e = Row::Zero(), b = Row::Zero(), a = Row::Zero(), ww = Row::Zero();
    Row with_g = Row::Zero(), with_h = Row::Zero(), size_g = Row::Zero(), size_h = Row::Zero();
    // Of a ring 11, 22 and 12 of v, less the eigenstrain, and of the correction: a row per mode.
    std::vector<Row> strain_of_v(way.ring ? 3 * static_cast<std::size_t>(count) : 0, Row::Zero()),
        strain_added = strain_of_v;
    for (Eigen::Index r = 0; r < count; ++r) {
      const LaneMat h = rotated_gradients(cell.J, room.correction.data() + r * lanes, count * lanes, cell.inverse);
      const Row own_volume = h.m[0][0] + h.m[1][1], own_difference = h.m[0][0] - h.m[1][1],
                own_shear = h.m[0][1] + h.m[1][0];
      a += 0.5 * (mu * (own_difference * own_difference + own_shear * own_shear) + bulk * own_volume * own_volume);
      if (way.ring) put_rows(strain_added, r, {h.m[0][0], h.m[1][1], 0.5 * own_shear});
      ww += h.m[0][0] * h.m[0][0] + h.m[0][1] * h.m[0][1] + h.m[1][0] * h.m[1][0] + h.m[1][1] * h.m[1][1];
      const double *d = way.own + 4 * count + r, u_difference = mu * (d[0] - d[3 * count]),
                   u_shear = mu * (d[count] + d[2 * count]), u_volume = bulk * (d[0] + d[3 * count]);
      const Row in_h = u_difference * own_difference + u_shear * own_shear + u_volume * own_volume;
      with_h += in_h;
      size_h += in_h.abs();
      const bool strained = way.ring && r < strains;
      if (r >= slopes && !strained) continue;
      Row g11 = Row::Zero(), g22 = Row::Zero(), shear = Row::Zero();
      if (r < slopes) {
        g11 = at(room.gradient, r), g22 = at(room.gradient, 3 * slopes + r);
        shear = at(room.gradient, slopes + r) + at(room.gradient, 2 * slopes + r);
      }
      if (strained) {
        g11 -= at(way.ring->strain, r), g22 -= at(way.ring->strain, strains + r);
        shear -= 2 * at(way.ring->strain, 2 * strains + r);
      }
      if (way.ring) put_rows(strain_of_v, r, {g11, g22, 0.5 * shear});
      const Row volume = g11 + g22, difference = g11 - g22;
      e += 0.5 * (mu * (difference * difference + shear * shear) + bulk * volume * volume);
      b += mu * (difference * own_difference + shear * own_shear) + bulk * volume * own_volume;
      const Row in_g = u_difference * difference + u_shear * shear + u_volume * volume;
      with_g += in_g;
      size_g += in_g.abs();
    }
    const Row alone = e, with_own = b;
    Row size = e;
    if (way.ring || own_.force.cols() > 0) add_works(cell, way, room, {e, b, size, with_g, with_h});
    const Row alpha = (a > 0).select(-0.5 * b / a, Row::Zero());
    sums.upper += way.active * cell.area * (e + alpha * (b + alpha * a));
    sums.size += way.active * cell.area * size;
    sums.crossed_upper += way.active * 0.5 * cell.area * (with_g + alpha * with_h);
    sums.crossed_size += way.active * 0.5 * cell.area * (size_g + alpha.abs() * size_h);
    of_ring.elastic = cell.area * (alone + alpha * (with_own + alpha * a));
    if (way.ring) of_ring.strain = largest_of(modes, strain_of_v) + alpha.abs() * largest_of(modes, strain_added);
    Row moved = Row::Zero();
    for (int i = 0; i < 2 * by_.per_triangle; ++i) moved = moved.max(at(room.nodal, i).abs());
    put_size(cell.t, way.active, moved, (cell.area * ww).sqrt() * alpha.abs());
  }

  /// Lanes are written once per pass: those that are not active keep what the other pass wrote.
  void put_size(Index t, const Row& active, const Row& largest, const Row& rough) {
    Eigen::Map<Row> first(size_.at(t)), second(size_.at(t) + lanes);
    first = (active > 0).select(largest, first);
    second = (active > 0).select(rough, second);
  }

  /// tr A s, with that of the eigenstrain, less the divergence of the conforming displacement.
  void want_divergence(const Cell& cell, const Way& way, Room& room) const {
    const Eigen::Index n = way.modes.polynomials, low = own_.low.polynomials, slopes = dim(u_.m.element.trace);
    constexpr int strains = dim(strain_degree);
    for (Eigen::Index r = 0; r < n; ++r) {
      Row sum = Row::Zero();
      if (r < low) sum += 2 * cell.material.c * (at(room.stress, r) + at(room.stress, 3 * low + r));
      if (r < slopes) sum -= at(room.gradient, r) + at(room.gradient, 3 * slopes + r);
      if (way.ring && r < strains) sum += at(way.ring->strain, r) + at(way.ring->strain, strains + r);
      Eigen::Map<Row>(room.wanted.data() + r * lanes) = sum;
    }
  }

  struct Works {
    Row &e, &b, &size, &with_g, &with_h;
  };
  /// Of body forces on displacements: of the dual in its ring on its own and on that of u, of the state everywhere.
  void add_works(const Cell& cell, const Way& way, Room& room, const Works& to) const {
    const Eigen::Index moved = dim(by_.degree);
    const double* f = own_.force.cols() > 0 ? own_.force.col(cell.t).data() : nullptr;
    const double* v = own_.displacement.cols() > 0 ? own_.displacement.col(cell.t).data() : nullptr;
    double* values = room.displacement.data() + 2 * moved * lanes;  // of the correction, on the triangle of reference
    product(way.modes.value, room.wanted.data(), 1, values);
    for (Eigen::Index r = 0; r < moved; ++r) {
      const Eigen::Map<const Row> first(values + r * lanes), second(values + (moved + r) * lanes);
      for (int k = 0; k < 2; ++k) {
        const Row own = cell.J(k, 0) * first + cell.J(k, 1) * second;
        const Eigen::Map<const Row> low = at(room.displacement, k * moved + r);
        if (f) {
          to.with_g -= f[k * moved + r] * low;
          to.with_h -= f[k * moved + r] * own;
        }
        if (!way.ring) continue;
        const Eigen::Map<const Row> pull = at(way.ring->force, k * moved + r);
        to.e -= pull * low;
        to.size += (pull * low).abs();
        to.b -= pull * own;
        to.with_g -= v[k * moved + r] * pull;
      }
    }
  }

  /// What the rest of the eigenstrain may move the bounds by.
  /// force bounds |(f, w)| over w in H^1_0(T) by |grad w|: h/pi |f| by Poincare, and what the polynomial of f leaves
  /// out.
  void put_ring(const Cell& cell, const Way& way, const RingSums& of, Sums& sums) {
    const Eigen::Index moved = dim(by_.degree);
    Row pull = Row::Zero();
    for (Eigen::Index r = 0; r < 2 * moved; ++r) pull += at(way.ring->force, r).square();
    for (int lane = 0; lane < states_.count; ++lane) {
      if (!(way.active[lane] > 0)) continue;
      const double force = diameter(cell.shape) / pi * std::sqrt(cell.area * pull[lane]) + way.ring->left_out[lane];
      put_share(cell, lane, {of.square[lane], of.stress[lane], of.elastic[lane], of.strain[lane], force},
                {way.ring->rest[lane], way.ring->error[lane]}, sums);
    }
  }
  struct Left {
    double rest, error;  // of an eigenstrain
  };
  void put_share(const Cell& cell, int lane, const StrainShare& s, const Left& left, Sums& sums) {
    ring_shares_[static_cast<std::size_t>(lane)][static_cast<std::size_t>(rings_.column(cell.t, lane))] = s;
    sums.below[lane] += cell.area * (std::sqrt(left.rest * s.square) + left.error * s.stress);
    sums.above[lane] += moved_by_eigenstrain(cell.material, cell.shape, left.rest, left.error,
                                             {s.elastic, s.strain, s.stress, s.force});
  }

  /// As that of two states.
  /// The state has no eigenstrain, so that the rest of u + k w is k times that of w: its mean square has k^2.
  double eigenstrain_unseen(int lane, double k) const {
    const auto i = static_cast<std::size_t>(lane);
    if (!duals_[i].ring) return 0;
    const RingLoads& ring = *duals_[i].ring;
    double sum = 0;
    for (std::size_t c = 0; c < ring.triangles->size(); ++c) {
      const Index t = (*ring.triangles)[c];
      const double own = ring.strain.rest[static_cast<Eigen::Index>(c)],
                   error = k * ring.strain.error[static_cast<Eigen::Index>(c)], rest = k * k * own;
      if (rest == 0 && error == 0) continue;
      sum += kerf::eigenstrain_unseen(material_of(u_.m.mesh, u_.m.scene, t), triangle(u_.m, t), rest, error,
                                      u_.shares[static_cast<std::size_t>(t)], ring_shares_[i][c], k);
    }
    return sum;
  }

  /// A triangle with data on its edges, field by field.
  /// Such triangles lie along boundaries and loaded cracks and are few; their rule and degree are higher.
  void beside_data(Index t, Sums& sums) {
    const std::vector<Index>& edges = u_.edges[static_cast<std::size_t>(t)];
    std::vector<double> nodal(static_cast<std::size_t>(2 * by_.per_triangle) * lanes);
    gather(t, nodal.data());
    std::fill_n(size_.at(t), 2 * lanes, 0.0);
    std::fill_n(tractions_.at(t), tractions_.rows * lanes, 0.0);
    for (int lane = 0; lane < states_.count; ++lane) {
      const auto i = static_cast<std::size_t>(lane);
      Eigen::VectorXd v(2 * by_.per_triangle);
      for (int k = 0; k < 2; ++k)
        for (int j = 0; j < by_.per_triangle; ++j)
          v[2 * j + k] = nodal[static_cast<std::size_t>((k * by_.per_triangle + j) * lanes + lane)];
      const Eigen::VectorXd interior = states_.interior.column(t, lane);
      const RingLoads* ring = rings_.mask(t) >> lane & 1 ? &*duals_[i].ring : nullptr;
      Bounding bounding{*duals_[i].model, ring ? ring->f : none_inside_, data_[i], conforming_.of[i], true};
      const Index column = ring ? rings_.column(t, lane) : none;
      if (ring) bounding.loads.emplace(Bounding::Elsewhere{ring->strain, column});
      const CellFields at{interior, interior, v};
      Share share;
      bounding.lower(own_.references.rich, t, at, edges, share);
      bounding.upper(own_.references.rich, t, at, edges, share);
      sums.add(lane, share, crossed_beside_data(t, share, ring, column));
      if (ring) ring_shares_[i][static_cast<std::size_t>(column)] = share;
      double* tractions = tractions_.at(t) + lane;
      for (Index k = 0; k < tractions_.rows; ++k) tractions[k * lanes] = share.tractions(k % 2, k / 2);
      size_.at(t)[lane] = share.largest;
      size_.at(t)[lanes + lane] = share.rough;
    }
  }

  /// Pi is quadratic: the bilinear form has half of each load's work on the displacement of the other.
  Products crossed_beside_data(Index t, const Share& share, const RingLoads* ring, Index column) const {
    const Share& own = u_.shares[static_cast<std::size_t>(t)];
    const double size = area(triangle(u_.m, t));
    Products p = crossed_fields(material_of(u_.m.mesh, u_.m.scene, t), size, u_.rich, own, share);
    if (ring) {
      const Eigen::Matrix4Xd e = strain_at(ring->strain, column, u_.rich.x);
      p.add_lower(-0.5 * size * e.cwiseProduct(own.kept_stress).colwise().sum().dot(u_.rich.w));
    }
    const auto work = [&](const Forces& f, Index at, const Points& on) {
      const Eigen::Map<const Points> nodal(f.nodal.col(at).data(), 2, f.nodal.rows() / 2);
      return (nodal * interpolation(f.degree, u_.rich.x).transpose()).cwiseProduct(on).colwise().sum().dot(u_.rich.w);
    };
    double works = ring ? work(ring->f, column, own.kept_displacement) : 0;
    if (u_.f.nodal.cols() > 0) works += work(u_.f, t, share.kept_displacement);
    p.add_upper(-0.5 * size * works);
    return p;
  }

  /// Inner edges that carry nothing and lie in no crack are summed side by side; at all others imbalance_on knows the
  /// cases.
  void sum_imbalance() {
    const Model& m = u_.m;
    const Skeleton& skeleton = m.inner->skeleton;
    std::vector<Index> place(m.mesh.edges.size(), none);
    const std::vector<EdgeData>& first = data_.front();
    for (std::size_t i = first.size(); i-- > 0;) place[first[i].edge] = static_cast<Index>(i);
    const Index rows = skeleton.per_edge;
    const EdgeRule& trace = m.inner->kernel.trace;
    Row total = Row::Zero();
    imbalance_.assign(static_cast<std::size_t>(lanes), 0.0);
    for (Index e = 0; e < static_cast<Index>(m.mesh.edges.size()); ++e) {
      std::array<const double*, 2> side{nullptr, nullptr};
      for (int k = 0; k < 2; ++k) {
        const Index t = m.mesh.sides[e][k];
        if (t == none) continue;
        int i = 0;
        while (m.mesh.edges_of[t][i] != e) ++i;
        side[k] = tractions_.at(t) + i * rows * lanes;
      }
      if (place[e] != none || m.mesh.crack[e] != none || !side[0] || !side[1]) {
        for (int lane = 0; lane < states_.count; ++lane)
          imbalance_[static_cast<std::size_t>(lane)] += imbalance_on(m, work_at(e, side, place[e], lane));
        continue;
      }
      const double l = length(m.mesh, e);
      for (Index i = 0; i < rows; ++i)
        total += l * trace.w[i / 2] *
                 ((Eigen::Map<const Row>(side[0] + i * lanes) + Eigen::Map<const Row>(side[1] + i * lanes)) *
                  Eigen::Map<const Row>(states_.skeleton.at(e * rows + i)))
                     .abs();
    }
    for (int lane = 0; lane < lanes; ++lane) imbalance_[static_cast<std::size_t>(lane)] += total[lane];
  }

  /// One field of the many, as imbalance_on wants it.
  EdgeWork work_at(Index e, const std::array<const double*, 2>& side, Index place, int lane) const {
    const Skeleton& skeleton = u_.m.inner->skeleton;
    const Index rows = skeleton.per_edge;
    EdgeWork at{e, {}, place == none ? nullptr : &data_[static_cast<std::size_t>(lane)][place], {}, {}, 0};
    for (int k = 0; k < 2; ++k) {
      at.side[k] = Tractions::Zero(2, rows / 2);
      for (Index i = 0; side[k] && i < rows; ++i) at.side[k](i % 2, i / 2) = side[k][i * lanes + lane];
    }
    at.base.resize(rows);
    for (Index i = 0; i < rows; ++i) at.base[i] = states_.skeleton.at(e * rows + i)[lane];
    if (skeleton.jump[e] == none) return at;
    at.jump.resize(rows);
    for (Index i = 0; i < rows; ++i) at.jump[i] = states_.skeleton.at(skeleton.jump[e] + i)[lane];
    return at;
  }

  /// What the data of u + k w and of u - k w leave out, or those of w.
  /// Both signs of k have the same bound, since each factor of u and w is at least 0.
  Oscillation oscillation(const std::vector<Rest>& rests, int lane, double k, bool with_u) const {
    Oscillation o;
    double square = 0;
    for (std::size_t t = 0; t < rests.size(); ++t) {
      const Rest &a = u_.rests[t], &b = rests[t];
      const bool any_of_u = with_u && (a.data != 0 || a.body != 0 || a.quadrature != 0);
      if (!any_of_u && b.data == 0 && b.body == 0 && b.quadrature == 0) continue;
      const Share& own = u_.shares[t];
      const double* size = size_.at(static_cast<Index>(t));
      const auto both = [&](double of_u, double of_w) { return (with_u ? of_u : 0) + k * of_w; };
      square += std::pow(both(a.data, b.data), 2);
      o.correction += both(a.body, b.body) * both(own.rough, size[lanes + lane]);
      o.quadrature += both(a.quadrature, b.quadrature) * both(own.largest, size[lane]);
    }
    o.eta = std::sqrt(square);
    return o;
  }

  const LaneOwn& own_;
  const AdmissiblePair& u_;
  const Averaging& by_;
  std::span<const LaneDual> duals_;
  const LaneRings& rings_;
  const LaneStates& states_;
  const Forces none_inside_{};
  Modes::Matrix unseen_ = own_.ring ? Modes::Matrix(own_.ring->unseen_force * own_.nodal_force) : Modes::Matrix();
  std::vector<std::vector<EdgeData>> data_;
  LaneConforming& conforming_;
  LaneArray &tractions_, &size_;  // size: the largest |v|, and what of it is rough
  std::array<std::vector<StrainShare>, lanes> ring_shares_;
  std::vector<double> imbalance_;
  Sums sum_;
};

Forces of_degree(int degree) {
  Forces f;
  f.degree = degree;
  return f;
}

}  // namespace

/// Triangles with data on their edges have no modes: their products are taken at the points of the rich rule.
LaneOwn::LaneOwn(const AdmissiblePair& pair, bool cut_off)
    : u(pair),
      averages(averaging(pair.m)),
      references(
          kerf::references(pair.m.element, pair.references->plain.n, of_degree(pair.m.element.trace + 1), false)),
      low(references.plain, pair.m.element, degree_inside(pair.m, false, false)) {
  if (cut_off) {
    ring.emplace(references.plain, pair.m.element, references.plain.n);
    change = ring->of(low.values.transpose());
    nodal_force = ring->displacement.inverse();
  }
  const Index triangles = static_cast<Index>(u.m.mesh.triangles.size());
  const bool forced = u.f.nodal.cols() > 0;
  const Eigen::Index moved = dim(u.m.element.trace + 1);
  fields.resize(8 * low.count, triangles);
  if (cut_off && forced) ring_fields.resize(8 * ring->count, triangles);
  if (cut_off) displacement.resize(2 * moved, triangles);
  if (forced) force.resize(2 * moved, triangles);
  parallel_for(triangles, u.m.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) {
      if (!u.edges[static_cast<std::size_t>(t)].empty()) continue;
      const Share& share = u.shares[static_cast<std::size_t>(t)];
      const auto put = [&](const Modes& modes, Eigen::MatrixXd& to) {
        Eigen::Map<Eigen::MatrixXd> all(to.col(t).data(), modes.count, 8);
        all.leftCols<4>() = modes.of(share.kept_stress);
        all.rightCols<4>() = modes.of(share.kept_strain);
      };
      put(low, fields);
      if (ring_fields.cols() > 0) put(*ring, ring_fields);
      if (cut_off)
        Eigen::Map<Eigen::MatrixXd>(displacement.col(t).data(), moved, 2) =
            low.of(share.kept_displacement).topRows(moved);
      if (!forced) continue;
      const Eigen::Map<const Points> nodal(u.f.nodal.col(t).data(), 2, u.f.nodal.rows() / 2);
      Eigen::Map<Eigen::MatrixXd>(force.col(t).data(), moved, 2) =
          low.of(Points(nodal * interpolation(u.f.degree, references.plain.rule.x).transpose())).topRows(moved);
    }
  });
}

/// One pass makes all sums; each dual then has its own oscillation and its own best step k.
std::vector<std::optional<CrossEnergy>> cross_energies(const LaneOwn& own, std::span<const LaneDual> duals,
                                                       const LaneRings& rings, LaneRoom& room) {
  const LaneBounding bounding(own, duals, rings, room);
  std::vector<std::optional<CrossEnergy>> all;
  for (int lane = 0; lane < room.states.count; ++lane) all.push_back(bounding.of(lane));
  return all;
}

}  // namespace kerf
