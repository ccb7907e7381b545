// What never changes while a level set moves (canvas, solid parts, prices, target), and designs drawn from a function
// on the canvas. The canvas is meshed twice as finely as the body, so that a design's boundary is smoother than its
// mesh. The smallest length of designs is that of the mesh, or down to half of it where the density stage tells finer
// members apart. Strips of 1.5 edges along loads stay solid, and where stresses count reentrant corners of the frame
// stay cut out, since a sharp corner has no finite stress. `draw` carves the zero line into a shape, meshes and solves
// it. Carving drops what is too small and fills slits, so that phi is corrected to what was drawn, and shifted by
// (drawn - wanted area)/(length of the zero line) until the drawn area is the one wanted to 1e-5 of the frame.
// docs/theory/level_set.md.

#include "optimize/level_set/ground.hpp"

#include "kerf/mesher.hpp"
#include "optimize/constraints/mirrored.hpp"
#include "optimize/density/density.hpp"
#include "optimize/ersatz.hpp"
#include "optimize/level_set/solid.hpp"
#include "optimize/stress_zones.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kerf {

namespace {

// Lengths relative to the smallest length of designs.
constexpr double fine = 0.5;         // the canvas against the mesh of the body
constexpr double strip = 1.5;        // of canvas edges beside loads that stay solid
constexpr double area_error = 1e-5;  // of the shape drawn, of the frame's area

// Pieces and holes smaller than an edge of the canvas squared are dropped; what touches loads and supports is kept.
Carving carving(const Ground& g, double coarse) {
  const double edge = (g.weak() ? 1 : fine) * g.size;
  Carving how{.spacing = coarse * g.size, .least_area = edge * edge, .keep = g.loaded, .holding = g.holding};
  how.keep.insert(how.keep.end(), g.holding.begin(), g.holding.end());
  return how;
}

/// What carving dropped or filled, out of the function: whole pieces, and what lies more than half an edge of the
/// canvas on the wrong side. What it turned nearer to the zero line is a matter of smoothing.
void settle(const BackgroundMesh& b, const std::vector<char>& inside, Eigen::VectorXd& phi) {
  for (Eigen::Index v = 0; v < phi.size(); ++v)
    if ((phi[v] < 0) != bool(inside[static_cast<std::size_t>(v)]) && std::abs(phi[v]) > 0.5 * b.size) phi[v] = -phi[v];
}

/// The shape of a function on the canvas; with a mirror one half of it and its image.
/// Left or right, whichever makes a body; carving that is no mirror image has neither, and the end says so.
Carved carve_on(const Ground& g, const Eigen::VectorXd& phi, const Carving& how) {
  Carved carved = carve(g.p.frame, g.background.mesh, phi, how);
  if (g.background.mirror)
    for (const double side : {1.0, -1.0})
      if (auto shape = symmetric(carved.shape, g.p.frame, *g.background.mirror, side)) {
        carved.shape = std::move(*shape);
        carved.area = area(carved.shape);
        break;
      }
  return carved;
}

double length_of(const std::vector<ZeroPiece>& line) {
  return std::accumulate(line.begin(), line.end(), 0.0,
                         [](double sum, const ZeroPiece& z) { return sum + (z.a - z.b).norm(); });
}

bool bounds_stress(const Ground& g) {
  return counts_stress(g.p.objective) ||
         std::ranges::any_of(g.r.bounds, [&](const FunctionalBound& b) { return counts_stress(b.functional); });
}

/// Sharp corners have no finite stress: where stress counts they stay notches that the mesh resolves.
void hollow_corners(Ground& g) {
  constexpr double radius = 2;  // mesh sizes
  if (!bounds_stress(g)) return;
  for (const Vec2& x : sharp_corners(g.p.frame, g.loaded, g.holding, 0.01 * g.size)) {
    Eigen::VectorXd& hollow = g.background.hollow;
    if (hollow.size() == 0) hollow = Eigen::VectorXd::Constant(g.background.lumped.size(), -infinity);
    for (Eigen::Index v = 0; v < hollow.size(); ++v)
      hollow[v] =
          std::max(hollow[v], radius * g.size - (g.background.mesh.points[static_cast<std::size_t>(v)] - x).norm());
    g.notes.push_back(fmt::format(
        "the corner at ({:.4g}, {:.4g}) stays cut out, by a radius of {:.3g}: a sharp one has no finite stress", x.x(),
        x.y(), radius * g.size));
  }
}

/// The mesh size; where that is coarser than what the density stage tells apart, down to half of it: a design must not
/// lose its thin members to a coarse mesh.
double length_of_designs(const Shape& frame, double mesh_size) {
  constexpr double cells = 1.25;
  return std::min(mesh_size, std::max(mesh_size / 2, cells * lattice_cell(frame)));
}

}  // namespace

// The fixed point and the weak phase have no finer designs than the mesh: their boundary is not moved along normals.
Ground make_ground(const Problem& p, const OptimizeRequest& r) {
  Ground g{.p = p, .r = r};
  const LevelSetRequest& how = r.level_set;
  const double of_volume = price_of_volume(p, r);
  g.mesh_size = target_size(p.sizing, p.frame);
  g.size = g.weak() || g.turns() ? g.mesh_size : length_of_designs(p.frame, g.mesh_size);
  g.price = of_volume + r.volume_penalty;
  g.limited = r.volume_at_most && *r.volume_at_most < 1;
  Sizing even = p.sizing;
  even.across = 1;
  even.size = (how.ersatz > 0 ? 1 : fine) * g.size;
  even.crack_tip_size = even.size;
  const Solid solid = solid_parts(p, r, strip * even.size, g.notes);
  g.background = background_mesh(triangulate(p.frame, even), solid, how.mirror);
  g.whole = g.background.lumped.sum();
  g.target = r.volume_at_most.value_or(1) * g.whole;
  g.loaded = solid.labels;
  g.holding = solid.held;
  if (how.mirror && !are_mirrored(p.frame, scenes_of(p, r), *how.mirror))
    g.notes.emplace_back(
        "the loads or the supports are not their own mirror image: the design is, its stresses are not");
  hollow_corners(g);
  for (const FunctionalBound& bound : r.bounds)
    for (const Term& term : bound.functional.terms)
      if (const std::string zones = term.largest ? zones_in_words(*term.largest) : ""; !zones.empty())
        g.notes.push_back(fmt::format("\"{}\" leaves out {}", bound.name, zones));
  const double smoothing = how.smoothing > 0 ? how.smoothing : g.size;
  if (!g.turns() && how.product == LevelSetRequest::Product::Elasticity)
    g.elastic = std::make_unique<ElasticProduct>(g.background, smoothing);
  if (g.turns())
    g.filter = std::make_unique<Helmholtz>(g.background, how.smoothing > 0 ? how.smoothing : 1.5 * g.background.size);
  return g;
}

bool counts_stress(const Functional& j) {
  return std::ranges::any_of(j.terms, [](const Term& term) { return term.stress_power > 0 || term.edge_cracks; });
}

Carved carved_again(const Ground& g, const Eigen::VectorXd& phi) {
  return carve_on(g, phi, carving(g, 1));
}

Problem fitted(const Ground& g, double coarse) {
  Problem p = g.p;
  p.sizing.size = coarse * g.mesh_size;
  p.sizing.across = 1;
  return p;
}

// Ends with the function that was drawn, so that the next step starts from what was solved.
DrawnLevelSet draw(const Ground& g, Eigen::VectorXd phi, std::optional<double> wanted, double coarse) {
  if (g.weak()) return {phi, {}, std::make_shared<const Evaluated>(evaluate_ersatz(g.p, g.r, g.background, phi))};
  const Carving how = carving(g, coarse);
  Carved carved = carve_on(g, phi, how);
  settle(g.background, carved.inside, phi);
  // Newton's method on a length that carving changes: eight steps, each at most half an edge.
  constexpr int most = 8;
  for (int i = 0; wanted && i < most && std::abs(carved.area - *wanted) > area_error * g.whole; ++i) {
    const double length = length_of(zero_line(g.background.mesh, phi)), reach = 0.5 * g.background.size;
    if (!(length > 0)) break;
    phi.array() += std::clamp((carved.area - *wanted) / length, -reach, reach);
    phi = clipped(g.background, std::move(phi));
    carved = carve_on(g, phi, how);
    settle(g.background, carved.inside, phi);
  }
  auto design = std::make_shared<const Evaluated>(
      evaluate_design(fitted(g, coarse), g.r, std::move(carved.shape), carved.crack_of));
  return {std::move(phi), std::move(carved.notes), std::move(design)};
}

}  // namespace kerf
