// What a plane of symmetry asks of a case: straight sides, and a body whose mirror image in them has the same forces,
// strains and materials beside the plane. What is wrong is refused at the key that asks for it.

#include "geometry/plane.hpp"
#include "io/case/sections.hpp"
#include "io/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace kerf {

namespace {

/// A straight piece of a side, with the outward normal.
struct Piece {
  Vec2 a, b, n;
};

/// The pieces of a label, from the mesh of a file or as drawn. Fails on arcs, and where a side turns by less than a
/// corner does: a curve that is drawn by chords.
std::vector<Piece> straight_pieces(const Position& blamed, Index label, const Case& c) {
  constexpr double corner = pi / 6;
  const std::string name = quote(c.shape.labels[static_cast<std::size_t>(label)]);
  const auto refuse = [&](const Vec2& at) {
    fail(blamed,
         fmt::format("symmetry: {} is curved at ({:.6g}, {:.6g}), and a plane of symmetry is straight; give the "
                     "straight sides a label of their own",
                     name, at.x(), at.y()));
  };
  std::vector<Piece> pieces;
  const double size = extent(c.shape);
  if (c.mesh)
    for (Index e = 0; e < static_cast<Index>(c.mesh->edges.size()); ++e) {
      if (c.mesh->label[e] != label) continue;
      const auto& [a, b] = c.mesh->edges[e];
      pieces.push_back({c.mesh->points[a], c.mesh->points[b], outward_normal(*c.mesh, e)});
      if (!c.mesh->arc.empty() && c.mesh->arc[e] != none) refuse(pieces.back().a);
    }
  const auto look = [&](const Loop& loop, bool hole) {
    const Polygon outline = flatten(loop, 1e-3 * size, size);
    for (std::size_t i = 0; i < loop.sides.size(); ++i) {
      if (loop.sides[i].label != label) continue;
      if (loop.sides[i].arc) refuse(loop.sides[i].start);
      const Vec2 a = loop.sides[i].start, b = loop.sides[(i + 1) % loop.sides.size()].start,
                 right = Vec2((b - a).y(), -(b - a).x()).normalized();
      const bool within = inside(outline.points, 0.5 * (a + b) + 1e-6 * size * right);
      pieces.push_back({a, b, within == hole ? right : Vec2(-right)});
    }
  };
  if (!c.mesh) {
    look(c.shape.outline, false);
    for (const Loop& hole : c.shape.holes) look(hole, true);
  }
  std::map<std::pair<double, double>, Vec2> normal;  // at ends
  for (const Piece& p : pieces)
    for (const Vec2& x : {p.a, p.b}) {
      const auto [before, is_new] = normal.emplace(std::pair(x.x(), x.y()), p.n);
      const double turn = is_new ? 0 : std::acos(std::clamp(before->second.dot(p.n), -1.0, 1.0));
      constexpr double rounding = 1e-6;
      if (turn > rounding && turn < corner) refuse(x);
    }
  return pieces;
}

/// The region at a point just inside, none outside all of them.
Index region_at(const Case& c, const Piece& p, const Vec2& x) {
  const Vec2 inner = x - 1e-6 * extent(c.shape) * p.n;
  if (c.mesh) return region_of(*c.mesh, std::max<Index>(0, locate(*c.mesh, {&inner, 1})[0]));
  Index found = none;
  double least = infinity;
  for (std::size_t r = 0; r < c.shape.regions.size(); ++r) {
    const Polygon outline = flatten(c.shape.regions[r], 1e-4 * extent(c.shape), extent(c.shape));
    double size = 0;
    for (std::size_t i = 0; i < outline.points.size(); ++i)
      size += 0.5 * cross(outline.points[i], outline.points[(i + 1) % outline.points.size()]);
    if (size < least && inside(outline.points, inner)) found = static_cast<Index>(r), least = size;
  }
  return found;
}

}  // namespace

/// What cannot be on a plane of symmetry: curved sides, a body force across it, an eigenstrain with a shear, a material
/// whose axes it does not halve.
void require_symmetry(const Position& blamed, Index plane, const VectorField& body, const Case& c) {
  const std::string name = quote(c.shape.labels[static_cast<std::size_t>(plane)]);
  const auto refuse = [&](const std::string& what, const Vec2& at) {
    fail(blamed,
         fmt::format("symmetry: {} at ({:.6g}, {:.6g}) on {}, so that the body is not its own mirror image; if it "
                     "only slides there, write displacement_normal = 0",
                     what, at.x(), at.y(), name));
  };
  constexpr double rounding = 1e-9;
  for (const Piece& p : straight_pieces(blamed, plane, c))
    for (const double share : {0.02, 0.27, 0.5, 0.77, 0.98}) {
      const Vec2 x = p.a + share * (p.b - p.a), t(-p.n.y(), p.n.x());
      if (body)
        if (const Vec2 f = body(x); std::abs(f.dot(p.n)) > rounding * f.norm())
          refuse(fmt::format("the body force has a component {:.4g} across the plane", f.dot(p.n)), x);
      const auto region = static_cast<std::size_t>(region_at(c, p, x) + 1);
      if (region < c.scene.eigenstrain.size() && c.scene.eigenstrain[region]) {
        const Vec2 normal = c.scene.eigenstrain[region].normal(x);
        const double xy = c.scene.eigenstrain[region].shear(x).x(), shear = p.n.x() * t.x() * normal.x() +
                                                                            p.n.y() * t.y() * normal.y() +
                                                                            (p.n.x() * t.y() + p.n.y() * t.x()) * xy;
        if (std::abs(shear) > rounding * (normal.norm() + std::abs(xy)))
          refuse(fmt::format("the eigenstrain shears by {:.4g}", shear), x);
      }
      const auto& axes = region == 0 ? c.orthotropy : c.regions[region - 1].orthotropy;
      if (axes)
        if (const double turn = std::remainder(axes->angle - std::atan2(p.n.y(), p.n.x()), pi / 2);
            std::abs(turn) > 1e-6)
          refuse(fmt::format("the axes of the material are {:.4g} degrees off the plane", turn * 180 / pi), x);
    }
}

}  // namespace kerf
