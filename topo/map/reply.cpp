#include "topo/map/reply.hpp"

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

std::vector<TangentField> BodyReply::to(const Vec2& x0, std::span<const Nucleus> fields, std::span<const Index> only,
                                        double enough) {
  const Model& m = model_;
  const Skeleton& skeleton = m.inner->skeleton;
  const EdgeRule& trace = m.inner->kernel.trace;
  static const EdgeRule rule = gauss(8);
  std::vector<Eigen::VectorXd> load(fields.size(), Eigen::VectorXd::Zero(skeleton.total));
  std::vector<std::vector<double>> prescribed(fields.size(),
                                              std::vector<double>(static_cast<std::size_t>(skeleton.total), 0));
  for (const Index e : edges_) {
    const Vec2& a = m.mesh.points[m.mesh.edges[e][0]];
    const Vec2& b = m.mesh.points[m.mesh.edges[e][1]];
    const bool boundary = m.mesh.sides[e][0] == none || m.mesh.sides[e][1] == none;
    // Tractions on both faces of a crack cancel in what both see: the right face's go to the jump.
    const Vec2 outward = boundary ? Vec2(-outward_normal(m.mesh, e)) : normal(m.mesh, e);
    const Index first = boundary ? edge_unknown(skeleton, e) : skeleton.jump[e];
    const int pieces = pieces_beside(x0, a, b);
    for (int piece = 0; piece < pieces; ++piece)
      for (Eigen::Index q = 0; q < rule.s.size(); ++q) {
        const double s = (piece + rule.s[q]) / pieces, w = rule.w[q] / pieces;
        const OnEdge at = on_edge(m.mesh, skeleton.bows, e, s);
        const Vec2 n = normal_at(at, outward);  // times |dx/ds|
        const Vec2& x = at.x;
        const Eigen::VectorXd basis = trace_basis(trace, s);
        for (std::size_t j = 0; j < fields.size(); ++j) {
          const Vec2 moved = fields[j].displacement(x), traction = fields[j].stress(x) * n;
          for (int g = 0; g < static_cast<int>(basis.size()); ++g)
            for (int d = 0; d < 2; ++d) {
              const Index u = first + 2 * g + d;
              const Vec2 direction = frame_at(skeleton, e, g).col(d);
              if (skeleton.fixed[u])
                prescribed[j][u] -= w * basis[g] / trace.w[g] * direction.dot(moved);
              else
                load[j][u] += w * basis[g] * direction.dot(traction);
            }
        }
      }
  }
  std::vector<TangentField> replies;
  for (std::size_t j = 0; j < fields.size(); ++j)
    replies.push_back(solver_.solve(load[j], prescribed[j], enough, only));
  return replies;
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
