// Curved edges of triangles as polynomials x(s) = (1 - s) x_a + s x_b + s (1 - s) q(s), 0 <= s <= 1, of degree min(k +
// 1, 4) for an element of degree k. They have the ends of an arc of an ellipse and its tangents there; for the unit
// circle with half angle a, S = sin a, C = cos a, along and across the chord and t = 2 s - 1:
//   degree 2: q = (0, 2 S^2/C);   degree 3: Bezier's handles 4/3 tan(a/2);
//   degree 4: x = p t + (S - p) t^3, y = 1 - p^2 t^2/2 + e t^4, e = C - 1 + p^2/2, p = (S - (1 - C)^(3/2))/C.
// Arcs of ellipses are affine images. The distance from the arc is O(h^(2k + 2)), O(h^8) for k = 4 as well. Derived in
// docs/theory/elements.md, section Curved triangles [theory: E.24, E.25]. Here, too, a mesh is refused in which the map
// of a triangle folds, before and after divisions of its curved edges.

#include "solver/element/edge_curvature.hpp"

#include "geometry/part.hpp"
#include "kerf/folded.hpp"
#include "solver/divided.hpp"
#include "solver/element/local.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

/// The height of a polynomial over the chord of the unit arc of angle 2a with its middle at (0, 1): `along`
/// the chord and `across` it.
struct UnitHeight {
  std::array<double, 3> along, across;
};

// Written with sin(a/2) in place of 1 - cos a, whose digits cancel for short arcs.
UnitHeight unit_height(double a, int degree) {
  const double s = std::sin(a), c = std::cos(a), half = std::sin(0.5 * a), rise = 2 * half * half;  // 1 - c
  switch (degree) {
    case 2:
      return {{0, 0, 0}, {2 * s * s / c, 0, 0}};
    case 3: {  // Bezier's handles
      const double handle = 4.0 / 3 * std::tan(0.5 * a), turn = 3 * (handle * c - 2 * s / 3);
      return {{turn, -2 * turn, 0}, {3 * handle * s, 0, 0}};
    }
    default: {
      // x = p t + (s - p) t^3, y = 1 - p^2 t^2/2 + e t^4 with x^2 + y^2 - 1 = e^2 t^4 (1 - t^2)^2.
      const double beyond = half * half * (2 * s - 2 * std::sqrt(2.0) * half) / c;  // p - s
      const double p = s + beyond, e = 0.5 * p * p - rise;
      const auto square = [](double by) { return std::array<double, 3>{by, -4 * by, 4 * by}; };  // by (2 s - 1)^2
      const std::array<double, 3> bend = square(-4 * e);
      return {{-4 * beyond, 8 * beyond, 0}, {4 * rise + bend[0], bend[1], bend[2]}};
    }
  }
}

/// Whether the cell's map turns over or shrinks too much, on a lattice.
/// The least J must be above a fifth of the largest one, because stresses are divided by it (E.26). A lattice of 45
/// points is a test, not a proof.
bool folds(const Triangle& t) {
  constexpr int n = 8;
  constexpr double least = 0.2;
  double low = infinity, high = 0;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j) {
      const double J = cell_map(t, {double(i) / n, double(j) / n}).J;
      low = std::min(low, J);
      high = std::max(high, J);
    }
  return !(low > least * high);
}

}  // namespace

// `axes` takes the unit circle to the ellipse: the polynomial of the circle goes along.
EdgeCurvature curvature_of(const Arc& piece, int degree) {
  const double a = 0.5 * (piece.to - piece.from), middle = 0.5 * (piece.from + piece.to);
  const UnitHeight h = unit_height(a, degree);
  const Vec2 out(std::cos(middle), std::sin(middle)), along(-out.y(), out.x());
  EdgeCurvature b;
  for (std::size_t i = 0; i < 3; ++i) b.q[i] = piece.axes * (h.across[i] * out + h.along[i] * along);
  return b;
}

// Halves of curved edges are pieces of the same arcs, in triangles of other shapes: each division is checked, on the
// triangles beside curved edges alone.
void check_division(const Mesh& mesh, const Element& e, int divisions) {
  Mesh beside = mesh;
  for (int time = 0; !beside.arc.empty(); ++time) {
    curvatures_of(beside, e);
    if (time == divisions) return;
    std::vector<bool> use;
    for (const auto& edges : beside.edges_of)
      use.push_back(std::ranges::any_of(edges, [&](Index k) { return beside.arc[k] != none; }));
    beside = refine(part_without_cracks(std::move(beside), use));
  }
}

const EdgeCurvature* curvature_at(const EdgeCurvatures& curvatures, Index edge) {
  const Index at = curvatures.of.empty() ? none : curvatures.of[edge];
  return at == none ? nullptr : &curvatures.all[at];
}

EdgeCurvatures curvatures_of(const Mesh& mesh, const Element& e) {
  EdgeCurvatures curvatures;
  if (mesh.arc.empty()) return curvatures;
  require(e, can_be_curved);
  curvatures.of.assign(mesh.edges.size(), none);
  for (std::size_t k = 0; k < mesh.edges.size(); ++k) {
    if (mesh.arc[k] == none) continue;
    curvatures.of[k] = static_cast<Index>(curvatures.all.size());
    curvatures.all.push_back(curvature_of(mesh.arcs[mesh.arc[k]], e.stress + 1));
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle cell = cell_of(mesh, curvatures, static_cast<Index>(t));
    if (!is_curved(cell) || !folds(cell)) continue;
    throw FoldedTriangle(centroid(cell));
  }
  return curvatures;
}

OnEdge on_edge(const Mesh& mesh, const EdgeCurvatures& curvatures, Index edge, double s) {
  const Vec2 &a = mesh.points[mesh.edges[edge][0]], &b = mesh.points[mesh.edges[edge][1]];
  OnEdge at{a + s * (b - a), b - a};
  if (const EdgeCurvature* curvature = curvature_at(curvatures, edge)) {
    const Vec2 h = height(*curvature, s);
    at.x += s * (1 - s) * h;
    at.slope += (1 - 2 * s) * h + s * (1 - s) * height_slope(*curvature, s);
  }
  return at;
}

}  // namespace kerf
