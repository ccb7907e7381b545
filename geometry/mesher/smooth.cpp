// Smoothing of a mesh: vertices move and edges flip to lower the sum over triangles of
//   1/quality = (a^2 + b^2 + c^2)/(4 sqrt(3) area),   1 for an equilateral triangle, infinite for a flat one.
// A vertex takes one Newton step on the sum around it, halved up to three times until the sum falls and no angle gets
// worse than the promised one (or than the worst one was). An edge between two triangles is flipped under the same
// conditions. Vertices and edges of the boundary, of cracks and of borders between regions stay. Triangles below 1.02
// are left alone, so that sweeps touch only what changed. Topology lives in `across` (the triangle beyond each edge),
// updated by each flip.

#include "geometry/mesher/smooth.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kerf {

namespace {

constexpr double good = 1.02;  // 1 / quality of a triangle that may stay as it is

constexpr Index next(Index i) {
  return i == 2 ? 0 : i + 1;
}
constexpr Index previous(Index i) {
  return i == 0 ? 2 : i - 1;
}

/// 1 / quality = sum of squared edges / (4 sqrt 3 area), infinite when turned over; the least squared tangent of an
/// angle.
struct Measure {
  double cost, squared_tangent;
};

Measure measure(const Vec2& a, const Vec2& b, const Vec2& c) {
  const double twice = cross(b - a, c - a);
  if (!(twice > 0)) return {infinity, 0};
  const double p = (c - b).squaredNorm(), q = (a - c).squaredNorm(), r = (b - a).squaredNorm();
  const double sum = p + q + r, tangent = 2 * twice / (sum - 2 * std::min({p, q, r}));
  return {sum / (2 * std::numbers::sqrt3 * twice), tangent * tangent};
}

struct Mosaic {
  std::vector<Vec2> points;
  std::vector<std::array<Index, 3>> triangles;
  std::vector<std::array<Index, 3>> across;  // per edge the triangle beyond, none where it must stay
  std::vector<Index> around;                 // per vertex one of its triangles, none where it must stay
  std::vector<bool> restless;                // vertices to look at in the next sweep
  double least;                              // squared tangent that no angle may fall below

  const Vec2& point(Index t, Index i) const {
    return points[std::size_t(triangles[std::size_t(t)][std::size_t(i)])];
  }
  Measure of(Index t) const {
    return measure(point(t, 0), point(t, 1), point(t, 2));
  }
  Index corner(Index t, Index vertex) const {
    const auto& v = triangles[std::size_t(t)];
    return v[0] == vertex ? 0 : v[1] == vertex ? 1 : 2;
  }
  Index edge_to(Index t, Index other) const {
    const auto& n = across[std::size_t(t)];
    return n[0] == other ? 0 : n[1] == other ? 1 : n[2] == other ? 2 : none;
  }
  bool allowed(double before, double after) const {
    return after >= std::min(before, least);
  }
  void wake(Index t) {
    for (const Index v : triangles[std::size_t(t)]) restless[std::size_t(v)] = true;
  }
};

/// A vertex on anything that stays has no triangle in `around`, and does not move; an edge that stays has none in
/// `across`.
Mosaic mosaic(const Mesh& mesh, double min_angle_deg) {
  const double tangent = std::tan(min_angle_deg * pi / 180);
  Mosaic m{mesh.points, mesh.triangles, {}, {}, {}, tangent * tangent};
  m.across.resize(mesh.triangles.size());
  m.around.assign(mesh.points.size(), none);
  m.restless.assign(mesh.points.size(), false);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t e = std::size_t(mesh.edges_of[t][i]);
      const auto& [left, right] = mesh.sides[e];
      const bool stays = mesh.label[e] != none || mesh.crack[e] != none || is_interface(mesh, Index(e));
      m.across[t][i] = stays ? none : left == Index(t) ? right : left;
      m.around[std::size_t(mesh.triangles[t][i])] = Index(t);
    }
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    if (mesh.label[e] != none || mesh.crack[e] != none || mesh.sides[e][0] == none || mesh.sides[e][1] == none ||
        is_interface(mesh, Index(e)))
      for (const Index v : mesh.edges[e]) m.around[std::size_t(v)] = none;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (m.of(Index(t)).cost > good) m.wake(Index(t));
  return m;
}

/// One Newton step of the vertex on the sum of the costs around it, halved until it lowers the sum.
/// cost = N/D: with g the gradient of one term, the gradient of N is g D + cost d, and the second derivatives follow.
/// Where the Hessian is not clearly definite a gradient step of the size of its trace is taken.
void move(Mosaic& m, Index vertex, std::vector<Index>& star) {
  star.clear();
  const Vec2 x = m.points[std::size_t(vertex)];
  double cost = 0, tangent = infinity, worst = 0;
  Vec2 gradient = Vec2::Zero();
  Mat2 hessian = Mat2::Zero();
  Index t = m.around[std::size_t(vertex)];
  do {
    star.push_back(t);
    const Index i = m.corner(t, vertex);
    const Vec2 &a = m.point(t, next(i)), &b = m.point(t, previous(i));
    const Measure now = measure(x, a, b);
    cost += now.cost;
    worst = std::max(worst, now.cost);
    tangent = std::min(tangent, now.squared_tangent);
    // cost = N / D with D = 2 sqrt 3 cross(b - a, x - a) and N quadratic in x.
    const Vec2 d = 2 * std::numbers::sqrt3 * Vec2(-(b - a).y(), (b - a).x());
    const double D = d.dot(x - a);
    const Vec2 g = (2 * (2 * x - a - b) - now.cost * d) / D;
    gradient += g;
    hessian += (4 * Mat2::Identity() - g * d.transpose() - d * g.transpose()) / D;
    t = m.across[std::size_t(t)][std::size_t(next(i))];
  } while (t != star.front());
  m.restless[std::size_t(vertex)] = false;
  if (worst <= good) return;

  const double trace = hessian.trace(), product = cross(hessian.col(0), hessian.col(1));
  Vec2 step;
  if (product > 1e-3 * trace * trace) {
    step = -Vec2(hessian(1, 1) * gradient.x() - hessian(0, 1) * gradient.y(),
                 hessian(0, 0) * gradient.y() - hessian(1, 0) * gradient.x()) /
           product;
  } else {
    step = -gradient / std::abs(trace);
  }
  const double reach = (m.point(star.front(), next(m.corner(star.front(), vertex))) - x).norm();
  if (!(step.norm() > 1e-3 * reach)) return;
  for (int attempt = 0; attempt < 4; ++attempt, step /= 2) {
    const Vec2 y = x + step;
    double cost_there = 0, tangent_there = infinity;
    for (const Index s : star) {
      const Index i = m.corner(s, vertex);
      const Measure there = measure(y, m.point(s, next(i)), m.point(s, previous(i)));
      cost_there += there.cost;
      tangent_there = std::min(tangent_there, there.squared_tangent);
    }
    if (!(cost_there < cost) || !m.allowed(tangent, tangent_there)) continue;
    m.points[std::size_t(vertex)] = y;
    for (const Index s : star) m.wake(s);
    return;
  }
}

/// The other diagonal of the two triangles at edge i of t, when that is better.
void flip(Mosaic& m, Index t, Index i) {
  const Index u = m.across[std::size_t(t)][std::size_t(i)];
  if (u == none) return;
  const Index j = m.edge_to(u, t);
  const auto [a, b, c] =
      std::array{m.triangles[std::size_t(t)][std::size_t(i)], m.triangles[std::size_t(t)][std::size_t(next(i))],
                 m.triangles[std::size_t(t)][std::size_t(previous(i))]};
  const Index d = m.triangles[std::size_t(u)][std::size_t(j)];
  const auto x = [&](Index v) -> const Vec2& { return m.points[std::size_t(v)]; };
  const Measure p = m.of(t), q = m.of(u), r = measure(x(a), x(b), x(d)), s = measure(x(a), x(d), x(c));
  if (!(r.cost + s.cost < (p.cost + q.cost) * (1 - 1e-9))) return;
  if (!m.allowed(std::min(p.squared_tangent, q.squared_tangent), std::min(r.squared_tangent, s.squared_tangent)))
    return;

  // t was (a, b, c), u was (d, c, b); now t = (a, b, d), u = (a, d, c).
  const Index ca = m.across[std::size_t(t)][std::size_t(next(i))],
              ab = m.across[std::size_t(t)][std::size_t(previous(i))];
  const Index bd = m.across[std::size_t(u)][std::size_t(next(j))],
              dc = m.across[std::size_t(u)][std::size_t(previous(j))];
  m.triangles[std::size_t(t)] = {a, b, d};
  m.triangles[std::size_t(u)] = {a, d, c};
  m.across[std::size_t(t)] = {bd, u, ab};
  m.across[std::size_t(u)] = {dc, ca, t};
  if (bd != none) m.across[std::size_t(bd)][std::size_t(m.edge_to(bd, u))] = t;
  if (ca != none) m.across[std::size_t(ca)][std::size_t(m.edge_to(ca, t))] = u;
  for (const Index v : {a, b, c, d})
    if (m.around[std::size_t(v)] != none) m.around[std::size_t(v)] = v == c ? u : t;
  m.wake(t);
  m.wake(u);
}

}  // namespace

/// Vertices in their order, then edges, so that the result depends on the mesh alone.
Smoothed smooth(const Mesh& mesh, double min_angle_deg, int sweeps) {
  Mosaic m = mosaic(mesh, min_angle_deg);
  std::vector<Index> star;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (std::size_t v = 0; v < m.points.size(); ++v)
      if (m.restless[v] && m.around[v] != none) move(m, Index(v), star);
    for (std::size_t t = 0; t < m.triangles.size(); ++t) {
      const auto& v = m.triangles[t];
      if (!m.restless[std::size_t(v[0])] && !m.restless[std::size_t(v[1])] && !m.restless[std::size_t(v[2])]) continue;
      if (m.of(Index(t)).cost <= good) continue;
      for (Index i = 0; i < 3; ++i) flip(m, Index(t), i);
    }
  }
  return {std::move(m.points), std::move(m.triangles)};
}

}  // namespace kerf
