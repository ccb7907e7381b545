#include "solver/bounds/lane_bounds.hpp"

#include "solver/bounds/triangle_bounds.hpp"
#include "solver/parallel.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>

namespace kerf {

namespace {

using Row = Eigen::Array<double, 1, lanes>;
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// c = A b for fields side by side; the rows of b are `stride` lanes apart.
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

/// A TriangleReference for products with fields side by side, from nodal values of the conforming displacement.
struct LaneReference {
  explicit LaneReference(const TriangleReference& of) : r(of), derivative(of.inverse.derivative), at_rule(of.at_rule) {
    for (int k = 0; k < 2; ++k) {
      slope[k] = of.field_slope[k] * of.raise;
      slope_at_rule[k] = of.field_slope_at_rule[k] * of.raise;
      for (int e = 0; e < 3; ++e) at_edge[e][k] = of.at_edge[e][k];
    }
  }
  const TriangleReference& r;
  Matrix derivative, at_rule;
  std::array<Matrix, 2> slope, slope_at_rule;
  std::array<std::array<Matrix, 2>, 3> at_edge;
};

/// Sums over triangles, per field.
struct Sums {
  Row lower = Row::Zero(), upper = Row::Zero(), size = Row::Zero();
  Row crossed_lower = Row::Zero(), crossed_upper = Row::Zero(), crossed_size = Row::Zero();

  void add(const Sums& s) {
    lower += s.lower, upper += s.upper, size += s.size;
    crossed_lower += s.crossed_lower, crossed_upper += s.crossed_upper, crossed_size += s.crossed_size;
  }
  void add(int lane, const Share& s, const Products& p) {
    lower[lane] += s.lower, upper[lane] += s.upper, size[lane] += s.size;
    crossed_lower[lane] += p.lower, crossed_upper[lane] += p.upper, crossed_size[lane] += p.size;
  }
};

/// A 2 x 2 matrix of fields side by side, and J x inverse.
struct LaneMat {
  Row m[2][2];
};
LaneMat turned(const Mat2& J, const double* x, const Mat2& inverse) {
  Row by[2][2];
  for (int k = 0; k < 2; ++k) {
    const Eigen::Map<const Row> first(x + 2 * k * lanes), second(x + (2 * k + 1) * lanes);
    for (int j = 0; j < 2; ++j) by[k][j] = inverse(0, j) * first + inverse(1, j) * second;
  }
  LaneMat y;
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) y.m[i][j] = J(i, 0) * by[0][j] + J(i, 1) * by[1][j];
  return y;
}

class LaneBounding {
 public:
  LaneBounding(const AdmissiblePair& u, const Averaging& by, std::span<const Model* const> duals, LaneRoom& room)
      : u_(u),
        by_(by),
        duals_(duals),
        states_(room.states),
        plain_(u.references->plain),
        conforming_(room.conforming),
        tractions_(room.tractions),
        size_(room.size) {
    for (const Model* dual : duals) data_.push_back(edge_data(*dual));
    conforming_lanes(by, u.m, states_, data_, conforming_);
    const Index triangles = static_cast<Index>(u.m.mesh.triangles.size());
    tractions_.resize(triangles, static_cast<Index>(6 * points_per_edge(u.m.element)));
    size_.resize(triangles, 2);
    sum_over_triangles();
  }

  std::optional<CrossEnergy> of(int lane) const {
    const auto i = static_cast<std::size_t>(lane);
    const Model& dual = *duals_[i];
    if (const std::string why = unseen_by_bounds(dual); !why.empty()) return CrossEnergy{.note = why};
    const std::vector<Rest> rests = rests_of(dual, data_[i], {}, u_.edges);
    EnergySums sums{.imbalance = imbalance_[i],
                    .oscillation = oscillation(rests, lane, 1, false),
                    .mismatch = conforming_.of[i].mismatch};
    sums.sum.lower = sum_.lower[lane], sums.sum.upper = sum_.upper[lane], sums.sum.size = sum_.size[lane];
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
        [&](double k) { return oscillation(rests, lane, k, true); }, [](double) { return 0.0; });
  }

 private:
  struct Room {
    std::vector<double> stress, along, asymmetry, wanted, at, curl, correction, nodal, dx, dy;
  };

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
      for (std::size_t i = 0; i < data.size(); ++i)
        p.add(crossed_on_edge(
            {u_.m, u_.data[i], u_.conforming.value[i], u_.shares[data[i].triangle].tractions},
            {*duals_[static_cast<std::size_t>(lane)], data[i], conforming_.of[static_cast<std::size_t>(lane)].value[i],
             tractions_at(data[i].triangle, lane)}));
      sum_.add(lane, {}, p);
    }
    sum_imbalance();
  }

  Room make_room() const {
    const auto room = [](Eigen::Index rows) { return std::vector<double>(static_cast<std::size_t>(rows * lanes)); };
    const Eigen::Index nodes = plain_.r.nodes.cols(), points = plain_.r.rule.w.size();
    return {room(lane_fields * nodes), room(4),          room(nodes),      room(nodes),
            room(4 * points),          room(4 * points), room(4 * points), room(2 * by_.per_triangle),
            room(2 * points),          room(2 * points)};
  }

  Tractions tractions_at(Index t, int lane) const {
    Tractions at(2, tractions_.rows / 2);
    const double* from = tractions_.at(t) + lane;
    for (Index i = 0; i < tractions_.rows; ++i) at(i % 2, i / 2) = from[i * lanes];
    return at;
  }

  /// Component k, x or y, of the conforming displacements at the nodes of a triangle.
  void gather(Index t, double* nodal) const {
    const int n = by_.per_triangle;
    for (int i = 0; i < n; ++i) {
      const double* from = conforming_.values.at(by_.of[static_cast<std::size_t>(t) * n + i]);
      for (int k = 0; k < 2; ++k)
        Eigen::Map<Row>(nodal + (k * n + i) * lanes) = Eigen::Map<const Row>(from + k * lanes);
    }
  }

  void inside(Index t, Room& room, Sums& sums) {
    const Triangle shape = triangle(u_.m, t);
    const Mat2 J = jacobian(shape.x), inverse = J.inverse();
    const Material& material = material_of(u_.m.mesh, u_.m.scene, t);
    Points nodes(2, plain_.r.nodes.cols());
    for (Eigen::Index q = 0; q < nodes.cols(); ++q)
      nodes.col(q) = shape.x[0] + plain_.r.nodes(0, q) * (shape.x[1] - shape.x[0]) +
                     plain_.r.nodes(1, q) * (shape.x[2] - shape.x[0]);
    evaluate_lanes(u_.m.inner->kernel, shape, states_.interior.at(t), nodes, room.stress.data());
    put_tractions(t, shape, room);
    lower(t, shape, material, {J, inverse}, room, sums);
    upper(t, shape, material, {J, inverse}, room, sums);
  }

  void put_tractions(Index t, const Triangle& shape, Room& room) {
    const Eigen::Index points = u_.m.inner->kernel.trace.w.size();
    for (int e = 0; e < 3; ++e) {
      const Vec2 side = shape.x[(e + 2) % 3] - shape.x[(e + 1) % 3];
      const Vec2 n = Vec2(side.y(), -side.x()).normalized();
      const Matrix& at = plain_.at_edge[e][shape.forward[e] ? 1 : 0];
      for (Eigen::Index g = 0; g < points; ++g) {
        Row s[4] = {Row::Zero(), Row::Zero(), Row::Zero(), Row::Zero()};
        for (Eigen::Index k = 0; k < at.cols(); ++k)
          for (int c = 0; c < 4; ++c)
            s[c] += at(g, k) * Eigen::Map<const Row>(room.stress.data() + (k * lane_fields + c) * lanes);
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

  /// As Bounding::lower.
  void lower(Index t, const Triangle& shape, const Material& material, const Maps& by, Room& room, Sums& sums) const {
    const Eigen::Index nodes = plain_.r.nodes.cols(), points = plain_.r.rule.w.size();
    const auto stress = [&](Eigen::Index node, int c) {
      return Eigen::Map<const Row>(room.stress.data() + (node * lane_fields + c) * lanes);
    };
    for (Eigen::Index i = 0; i < nodes; ++i)
      Eigen::Map<Row>(room.asymmetry.data() + i * lanes) = stress(i, 1) - stress(i, 2);
    product(plain_.derivative, room.asymmetry.data(), 1, room.curl.data());
    for (int c = 0; c < 4; ++c)
      product(plain_.at_rule, room.stress.data() + c * lanes, lane_fields, room.at.data() + c * points * lanes);
    const Share& own = u_.shares[static_cast<std::size_t>(t)];
    const double shear = 1 / (2 * material.mu), c = material.c;
    Row energy = Row::Zero(), crossed = Row::Zero(), size = Row::Zero();
    for (Eigen::Index q = 0; q < points; ++q) {
      const auto at = [&](int k) { return Eigen::Map<const Row>(room.at.data() + (k * points + q) * lanes); };
      const LaneMat g = turned(by.J, room.curl.data() + 4 * q * lanes, by.inverse);
      const Row s11 = at(0) + g.m[0][1], s12 = at(1) - g.m[0][0], s21 = at(2) + g.m[1][1], s22 = at(3) - g.m[1][0],
                trace = s11 + s22, difference = s11 - s22;
      const double w = plain_.r.rule.w[q];
      energy += w * (shear * (0.5 * difference * difference + s12 * s12 + s21 * s21) + c * trace * trace);
      const auto p = own.kept_stress.col(q);
      const Row work =
          w * (shear * (0.5 * (p[0] - p[3]) * difference + p[1] * s12 + p[2] * s21) + c * (p[0] + p[3]) * trace);
      crossed += work;
      size += work.abs();
    }
    const double half = 0.5 * area(shape);
    sums.lower -= half * energy;
    sums.size += half * energy;
    sums.crossed_lower -= half * crossed;
    sums.crossed_size += half * size;
  }

  /// As Bounding::upper.
  void upper(Index t, const Triangle& shape, const Material& material, const Maps& by, Room& room, Sums& sums) {
    const Eigen::Index points = plain_.r.rule.w.size();
    gather(t, room.nodal.data());
    const int n = by_.per_triangle;
    Row largest = Row::Zero();
    for (int i = 0; i < 2 * n; ++i) largest = largest.max(Eigen::Map<const Row>(room.nodal.data() + i * lanes).abs());
    want_divergence(material, by, room);
    product(plain_.derivative, room.wanted.data(), 1, room.correction.data());
    for (int k = 0; k < 2; ++k) {
      product(plain_.slope_at_rule[0], room.nodal.data() + k * n * lanes, 1, room.dx.data() + k * points * lanes);
      product(plain_.slope_at_rule[1], room.nodal.data() + k * n * lanes, 1, room.dy.data() + k * points * lanes);
    }
    const Share& own = u_.shares[static_cast<std::size_t>(t)];
    const double mu = material.mu, bulk = 1 / (4 * material.c);
    Row e = Row::Zero(), b = Row::Zero(), a = Row::Zero(), ww = Row::Zero();
    Row with_g = Row::Zero(), with_h = Row::Zero(), size_g = Row::Zero(), size_h = Row::Zero();
    for (Eigen::Index q = 0; q < points; ++q) {
      LaneMat g;
      for (int k = 0; k < 2; ++k) {
        const Eigen::Map<const Row> dx(room.dx.data() + (k * points + q) * lanes),
            dy(room.dy.data() + (k * points + q) * lanes);
        for (int j = 0; j < 2; ++j) g.m[k][j] = by.inverse(0, j) * dx + by.inverse(1, j) * dy;
      }
      const LaneMat h = turned(by.J, room.correction.data() + 4 * q * lanes, by.inverse);
      const Row volume = g.m[0][0] + g.m[1][1], own_volume = h.m[0][0] + h.m[1][1], difference = g.m[0][0] - g.m[1][1],
                own_difference = h.m[0][0] - h.m[1][1], shear = g.m[0][1] + g.m[1][0],
                own_shear = h.m[0][1] + h.m[1][0];
      const double w = plain_.r.rule.w[q];
      e += 0.5 * w * (mu * (difference * difference + shear * shear) + bulk * volume * volume);
      b += w * (mu * (difference * own_difference + shear * own_shear) + bulk * volume * own_volume);
      a += 0.5 * w * (mu * (own_difference * own_difference + own_shear * own_shear) + bulk * own_volume * own_volume);
      ww += w * (h.m[0][0] * h.m[0][0] + h.m[0][1] * h.m[0][1] + h.m[1][0] * h.m[1][0] + h.m[1][1] * h.m[1][1]);
      const auto d = own.kept_strain.col(q);
      const double u_difference = mu * (d[0] - d[3]), u_shear = mu * (d[1] + d[2]), u_volume = bulk * (d[0] + d[3]);
      const Row in_g = w * (u_difference * difference + u_shear * shear + u_volume * volume),
                in_h = w * (u_difference * own_difference + u_shear * own_shear + u_volume * own_volume);
      with_g += in_g, with_h += in_h;
      size_g += in_g.abs(), size_h += in_h.abs();
    }
    const double whole = area(shape);
    const Row alpha = (a > 0).select(-0.5 * b / a, Row::Zero());
    sums.upper += whole * (e + alpha * (b + alpha * a));
    sums.size += whole * e;
    sums.crossed_upper += 0.5 * whole * (with_g + alpha * with_h);
    sums.crossed_size += 0.5 * whole * (size_g + alpha.abs() * size_h);
    Eigen::Map<Row>(size_.at(t)) = largest;
    Eigen::Map<Row>(size_.at(t) + lanes) = (whole * ww).sqrt() * alpha.abs();
  }

  /// 2 c tr s less the divergence of the conforming displacement.
  void want_divergence(const Material& material, const Maps& by, Room& room) const {
    const Eigen::Index nodes = plain_.r.nodes.cols();
    const int n = by_.per_triangle;
    for (Eigen::Index i = 0; i < nodes; ++i) {
      const double* s = room.stress.data() + i * lane_fields * lanes;
      Row sum = 2 * material.c * (Eigen::Map<const Row>(s) + Eigen::Map<const Row>(s + 3 * lanes));
      for (int k = 0; k < 2; ++k)
        for (int j = 0; j < n; ++j) {
          const double slope = plain_.slope[k](i, j);
          for (int axis = 0; axis < 2; ++axis)
            sum -= by.inverse(k, axis) * slope * Eigen::Map<const Row>(room.nodal.data() + (axis * n + j) * lanes);
        }
      Eigen::Map<Row>(room.wanted.data() + i * lanes) = sum;
    }
  }

  /// A triangle with data on its edges, field by field.
  void beside_data(Index t, Sums& sums) {
    static const Forces none_inside;
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
      const Bounding bounding{*duals_[i], none_inside, data_[i], conforming_.of[i], true};
      const CellFields at{interior, interior, v};
      Share share;
      bounding.lower(u_.references->rich, t, at, edges, share);
      bounding.upper(u_.references->rich, t, at, edges, share);
      sums.add(lane, share,
               crossed_fields(material_of(u_.m.mesh, u_.m.scene, t), area(triangle(u_.m, t)), u_.rich,
                              u_.shares[static_cast<std::size_t>(t)], share));
      double* tractions = tractions_.at(t) + lane;
      for (Index k = 0; k < tractions_.rows; ++k) tractions[k * lanes] = share.tractions(k % 2, k / 2);
      size_.at(t)[lane] = share.largest;
      size_.at(t)[lanes + lane] = share.rough;
    }
  }

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

  const AdmissiblePair& u_;
  const Averaging& by_;
  std::span<const Model* const> duals_;
  const LaneStates& states_;
  LaneReference plain_;
  std::vector<std::vector<EdgeData>> data_;
  LaneConforming& conforming_;
  LaneArray &tractions_, &size_;  // size: the largest |v|, and what of it is rough
  std::vector<double> imbalance_;
  Sums sum_;
};

}  // namespace

std::vector<std::optional<CrossEnergy>> cross_energies(const AdmissiblePair& u, const Averaging& by,
                                                       std::span<const Model* const> duals, LaneRoom& room) {
  const LaneBounding bounding(u, by, duals, room);
  std::vector<std::optional<CrossEnergy>> all;
  for (int lane = 0; lane < room.states.count; ++lane) all.push_back(bounding.of(lane));
  return all;
}

}  // namespace kerf
