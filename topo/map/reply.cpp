// What a body answers to singular fields G in closed form: the regular w with sigma(w) n = -sigma(G) n on free sides
// and open faces and w = -G where held, contact linearized [theory: T.28, Q.4]. The loads are the moments of the
// tractions of G, and its displacements, on the boundary and on cracks that move; edges near the singular point are
// integrated in pieces. `to` solves for w itself. `displacements` reads the recovered displacement of w at the singular
// point alone, for many points at once: loads and readings are sparse vectors that meet half way through the factor
// [theory: T.38]. docs/theory/second_order.md, section "The reply of the body".

#include "topo/map/reply.hpp"

#include "solver/recovery.hpp"
#include "solver/system.hpp"
#include "topo/functional/integrate.hpp"

namespace kerf {

BodyReply::BodyReply(const Model& m, TangentCone cone) : model_(m), solver_(m, std::move(cone)) {
  for (Index e = 0; e < static_cast<Index>(m.mesh.edges.size()); ++e) {
    const bool boundary = m.mesh.sides[e][0] == none || m.mesh.sides[e][1] == none;
    const bool moves = m.mesh.crack[e] != none && m.scene.laws[m.mesh.crack[e]].kind != CrackLaw::Kind::Bonded;
    if (boundary || moves) edges_.push_back(e);
  }
}

// The trace on the boundary; of a crack the jump, per_edge unknowns of each edge.
std::vector<Index> BodyReply::loaded_unknowns() const {
  const Mesh& mesh = model_.mesh;
  const Skeleton& skeleton = model_.inner->skeleton;
  std::vector<Index> unknowns;
  for (const Index e : edges_) {
    const bool boundary = mesh.sides[e][0] == none || mesh.sides[e][1] == none;
    const Index first = boundary ? edge_unknown(skeleton, e) : skeleton.jump[e];
    for (int k = 0; k < skeleton.per_edge; ++k) unknowns.push_back(first + k);
  }
  return unknowns;
}

void BodyReply::load(const Vec2& x0, std::span<const Nucleus> fields, Eigen::Ref<Eigen::MatrixXd> load,
                     Eigen::Ref<Eigen::MatrixXd> prescribed) const {
  const Model& m = model_;
  const Skeleton& skeleton = m.inner->skeleton;
  const EdgeRule& trace = m.inner->kernel.trace;
  static const EdgeRule rule = gauss(8);
  load.setZero();
  prescribed.setZero();
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    const Index e = edges_[i];
    const Vec2& a = m.mesh.points[m.mesh.edges[e][0]];
    const Vec2& b = m.mesh.points[m.mesh.edges[e][1]];
    const bool boundary = m.mesh.sides[e][0] == none || m.mesh.sides[e][1] == none;
    // Tractions on both faces of a crack cancel in what both see: the right face's go to the jump.
    const Vec2 outward = boundary ? Vec2(-outward_normal(m.mesh, e)) : normal(m.mesh, e);
    const Index first = boundary ? edge_unknown(skeleton, e) : skeleton.jump[e];
    const Eigen::Index at_first = static_cast<Eigen::Index>(i) * skeleton.per_edge;
    const int pieces = pieces_beside(x0, a, b);
    for (int piece = 0; piece < pieces; ++piece)
      for (Eigen::Index q = 0; q < rule.s.size(); ++q) {
        const double s = (piece + rule.s[q]) / pieces, w = rule.w[q] / pieces;
        const OnEdge at = on_edge(m.mesh, skeleton.curvatures, e, s);
        const Vec2 n = normal_at(at, outward);  // times |dx/ds|
        const Vec2& x = at.x;
        const Eigen::VectorXd basis = trace_basis(trace, s);
        for (std::size_t j = 0; j < fields.size(); ++j) {
          // Where held w = -G, as moments over the trace's weights; where free the tractions -sigma(G) n.
          const Vec2 moved = fields[j].displacement(x), traction = fields[j].stress(x) * n;
          for (int g = 0; g < static_cast<int>(basis.size()); ++g)
            for (int d = 0; d < 2; ++d) {
              const int k = 2 * g + d;
              const Vec2 direction = frame_at(skeleton, e, g).col(d);
              const Eigen::Index column = static_cast<Eigen::Index>(j);
              if (skeleton.fixed[first + k])
                prescribed(at_first + k, column) -= w * basis[g] / trace.w[g] * direction.dot(moved);
              else
                load(at_first + k, column) += w * basis[g] * direction.dot(traction);
            }
        }
      }
  }
}

// A solve per field; `only`: the triangles whose interior is wanted.
std::vector<TangentField> BodyReply::to(const Vec2& x0, std::span<const Nucleus> fields, std::span<const Index> only,
                                        double enough) {
  const std::vector<Index> unknowns = loaded_unknowns();
  const auto total = static_cast<std::size_t>(model_.inner->skeleton.total);
  Eigen::MatrixXd loads(unknowns.size(), fields.size()), values = loads;
  load(x0, fields, loads, values);
  std::vector<TangentField> replies;
  for (Eigen::Index j = 0; j < loads.cols(); ++j) {
    Eigen::VectorXd load = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(total));
    std::vector<double> prescribed(total, 0);
    for (std::size_t i = 0; i < unknowns.size(); ++i) {
      load[unknowns[i]] = loads(static_cast<Eigen::Index>(i), j);
      prescribed[unknowns[i]] = values(static_cast<Eigen::Index>(i), j);
    }
    replies.push_back(solver_.solve(load, prescribed, enough, only));
  }
  return replies;
}

// Per singular point two readings (x, y) of every field; nothing where the factor cannot be read from.
std::optional<std::vector<Points>> BodyReply::displacements(std::span<const Singularity> many) const {
  FewLoads loads{.unknowns = loaded_unknowns(), .load = {}, .prescribed = {}};
  Eigen::Index problems = 0;
  for (const Singularity& s : many) problems += static_cast<Eigen::Index>(s.fields.size());
  loads.load.resize(static_cast<Eigen::Index>(loads.unknowns.size()), problems);
  loads.prescribed.resizeLike(loads.load);
  std::vector<Reading> readings;
  Eigen::Index first = 0;
  for (const Singularity& s : many) {
    const Eigen::Index n = static_cast<Eigen::Index>(s.fields.size());
    load(s.at, s.fields, loads.load.middleCols(first, n), loads.prescribed.middleCols(first, n));
    for (int d = 0; d < 2; ++d) {
      const Eigen::VectorXd weights = weigh_recovered(model_, s.in, s.at, Vec2::Unit(d));
      for (Eigen::Index j = 0; j < n; ++j) readings.push_back({first + j, s.in, weights});
    }
    first += n;
  }
  const std::optional<Eigen::VectorXd> found = solver_.read(loads, readings);
  if (!found) return std::nullopt;
  std::vector<Points> all;
  Eigen::Index next = 0;
  for (const Singularity& s : many) {
    Points& u = all.emplace_back(2, static_cast<Eigen::Index>(s.fields.size()));
    for (int d = 0; d < 2; ++d)
      for (Eigen::Index j = 0; j < u.cols(); ++j) u(d, j) = (*found)[next++];
  }
  return all;
}

// The nuclei are those of unit stresses (tr s, half the difference, the shear) [theory: B.11]; the dipoles in terms of
// them, phi = -conj(b1)/z, psi = -2 a1/z.
Nucleus dipole_field(const Material& m, const Vec2& x, const Dipoles& sent) {
  const double unit = 8 * pi / plane_modulus(m);
  const std::array<double, 3> share{0.5 * unit * sent.a1, unit * sent.b1.real(), unit * sent.b1.imag()};
  const std::array<Nucleus, 3> part{point_nucleus(m, x, PointStress::Trace),
                                    point_nucleus(m, x, PointStress::Difference),
                                    point_nucleus(m, x, PointStress::Shear)};
  return {[=](const Vec2& at) -> Vec2 {
            Vec2 u = Vec2::Zero();
            for (std::size_t i = 0; i < part.size(); ++i) u += share[i] * part[i].displacement(at);
            return u;
          },
          [=](const Vec2& at) -> Mat2 {
            Mat2 s = Mat2::Zero();
            for (std::size_t i = 0; i < part.size(); ++i) s += share[i] * part[i].stress(at);
            return s;
          }};
}

}  // namespace kerf
