// Tractions at corners that no symmetric stress has. At a vertex whose edges lie on two lines with normals a, b a
// symmetric stress has a . s b = b . s a, and cubic traces have a combination z there that no triangle of the fan sees.
// Loads must do no work on it; where they do they are changed as little as possible in the mean of squares,
//   g_e -> g_e - y_e (sum_f int g_f . z_f)/(sum_f int y_f . z_f)   [theory: E.22],
// y_e the part of z_e of degree 2 and 3, without resultant and moment on its edge. Only the two boundary edges at the
// ends of a fan carry loads. Derived in docs/theory/elements.md, section Singular vertices (under Spaces).

#include "solver/system/corner_loads.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr double parallel = 1e-6;

// A side of a fan of triangles around a vertex, and what the unseen combination has on it.
struct Spoke {
  Index edge;
  Vec2 direction = Vec2::Zero();  // of the trace at the vertex
};

// The triangles at a vertex in order, from one boundary edge to the other.
class Fans {
 public:
  Fans(const Mesh& mesh, const Scene& scene) : mesh_(mesh), scene_(scene) {}

  // Spokes from boundary edge `first` on around `vertex`, and the triangles between them.
  bool collect(Index vertex, Index first, std::vector<Index>& spokes, std::vector<Index>& triangles) const {
    spokes = {first};
    triangles.clear();
    Index t = mesh_.sides[first][mesh_.sides[first][0] == none ? 1 : 0], edge = first;
    while (true) {
      triangles.push_back(t);
      edge = other(t, vertex, edge);
      spokes.push_back(edge);
      if (mesh_.crack[edge] != none && scene_.laws[mesh_.crack[edge]].kind != CrackLaw::Kind::Bonded) return false;
      const Index next = mesh_.sides[edge][0] == t ? mesh_.sides[edge][1] : mesh_.sides[edge][0];
      if (next == none) return true;
      t = next;
    }
  }

 private:
  Index other(Index t, Index vertex, Index edge) const {
    for (int i = 0; i < 3; ++i)
      if (mesh_.edges_of[t][i] != edge && mesh_.triangles[t][i] != vertex) return mesh_.edges_of[t][i];
    return none;
  }
  const Mesh& mesh_;
  const Scene& scene_;
};

// +1 where the normal of the edge points out of the triangle.
// sides[0] is the left triangle, which sees the edge run counter-clockwise and its normal point out.
double outward(const Mesh& mesh, Index edge, Index t) {
  return mesh.sides[edge][0] == t ? 1 : -1;
}

// Legendre's polynomials of degree 2 and 3 on [0, 1], each with (2k + 1) times its value at an end.
// The point value at an end is sum_k (2k + 1) P_k(end) P_k; degrees 0 and 1 are resultant and moment, 2 and 3 are what
// is left in P_3.
double without_resultant(double end, double s) {
  const double t = 2 * s - 1, sign = end > 0.5 ? 1 : -1;
  return 5 * (1.5 * t * t - 0.5) + sign * 7 * (2.5 * t * t * t - 1.5 * t);
}

// The combination that no triangle of the fan sees; empty where one does, or a support holds a part of it.
// From spoke to spoke the amount follows from what the triangle between them must not see; the signs are those of the
// outward normals.
std::vector<Spoke> unseen(const Mesh& mesh, const Skeleton& s, const std::vector<Index>& spokes,
                          const std::vector<Index>& triangles) {
  for (std::size_t i = 2; i < spokes.size(); ++i)
    if (std::abs(cross(normal(mesh, spokes[i]), normal(mesh, spokes[i - 2]))) > parallel) return {};
  std::vector<Spoke> z;
  double amount = 1;
  for (std::size_t i = 0; i < spokes.size(); ++i) {
    const std::size_t across = i + 1 < spokes.size() ? i + 1 : i - 1;
    // With the normals of the first two spokes for their lines: parallel ones differ by a sign only.
    const Vec2 line = normal(mesh, spokes[across % 2]);
    z.push_back({spokes[i], amount * line});
    if (i + 1 == spokes.size()) break;
    const auto sign = [&](std::size_t k) {
      const double along = normal(mesh, spokes[k]).dot(normal(mesh, spokes[k % 2]));
      return outward(mesh, spokes[k], triangles[i]) * (along > 0 ? 1 : -1);
    };
    amount *= -sign(i) / sign(i + 1);
  }
  for (const std::size_t end : {std::size_t{0}, spokes.size() - 1})
    for (int d = 0; d < 2; ++d)
      if (s.fixed[edge_unknown(s, spokes[end]) + d] &&
          std::abs(z[end].direction.dot(s.frame[spokes[end]].col(d))) > parallel)
        return {};
  return z;
}

}  // namespace

std::vector<CornerLoad> fit_corner_loads(const Mesh& mesh, const Kernel& k, const Scene& scene, const Skeleton& s,
                                         Eigen::VectorXd& loads) {
  std::vector<CornerLoad> fitted;
  const Fans fans(mesh, scene);
  std::vector<Index> spokes, triangles;
  for (Index first = 0; first < static_cast<Index>(mesh.edges.size()); ++first) {
    if (mesh.sides[first][0] != none && mesh.sides[first][1] != none) continue;
    for (const Index vertex : mesh.edges[first]) {
      if (!fans.collect(vertex, first, spokes, triangles) || spokes.front() > spokes.back()) continue;  // once
      const std::vector<Spoke> z = unseen(mesh, s, spokes, triangles);
      if (z.empty()) continue;
      // Traces that are a point value at the vertex, tested with the loads: what does not fit. The least tractions that
      // change it and have neither resultant nor moment on their edge.
      const auto both = {z.front(), z.back()};
      double misfit = 0, size = 0, change = 0;
      const auto each = [&](const auto& visit) {
        for (const Spoke& spoke : both) {
          const double end = mesh.edges[spoke.edge][0] == vertex ? 0.0 : 1.0;
          const Eigen::VectorXd value = trace_basis(k.trace, end);
          const double h = length(mesh, spoke.edge);
          for (Eigen::Index g = 0; g < value.size(); ++g) {
            const double z = value[g] / (h * k.trace.w[g]), y = k.trace.w[g] * without_resultant(end, k.trace.s[g]);
            for (int d = 0; d < 2; ++d) {
              const double along = spoke.direction.dot(s.frame[spoke.edge].col(d));
              visit(edge_unknown(s, spoke.edge) + 2 * static_cast<Index>(g) + d, z * along, y * along);
            }
          }
        }
      };
      each([&](Index u, double z_u, double y_u) {
        misfit += loads[u] * z_u;
        size += std::abs(loads[u] * z_u);
        change += z_u * y_u;
      });
      constexpr double rounding = 1e-12;
      if (!(std::abs(misfit) > rounding * size)) continue;
      each([&](Index u, double, double y_u) { loads[u] -= misfit / change * y_u; });
      fitted.push_back({mesh.points[vertex], std::abs(misfit)});
    }
  }
  return fitted;
}

}  // namespace kerf
