#pragma once
// Sites whose balls keep apart, on one mesh and with one factor.

#include "kerf/map.hpp"
#include "topo/validate/differences.hpp"
#include "topo/validate/sites.hpp"

namespace kerf {

/// The body with balls around sites, each with the contours of its radii; the mesh outside them is that of a user.
struct Batch {
  Filled filled;
  std::vector<BallMesh> balls;
  Preparation how;  // what keeps the balls' boundaries
};

/// What is drawn at the sites: aspect, and per site the angle (radians) of the longer axis.
struct SiteEllipses {
  double aspect = 1;
  std::vector<double> angle = {};  // none: 0
};
/// Balls with `sides` edges. Throws Error(Geometry) as triangulate does.
Batch mesh_batch(const Meshing& meshing, const std::vector<Site>& sites, int sides, const SiteEllipses& drawn);
/// The same in a mesh of with_balls.
Batch fill_batch(const Mesh& outside, const std::vector<Site>& sites, int sides, const SiteEllipses& drawn,
                 bool curved);

/// A batch solved, and what J changes by per site and radius. The batch and the functional must outlive it.
struct SolvedBatch {
  /// What the body is made of, what acts on it, and by how many threads it is solved.
  struct Body {
    const Element& element;
    const Scene& scene;
    int threads = 1;
    const ScenesOfChanges* drawn = nullptr;  // what is drawn at the sites, if not by the library's rule
  };
  /// Throws Error(Numerics) where the body cannot be solved, and as analyze does.
  SolvedBatch(const Batch& batch, const Body& body, const Functional& j, const Perturbation& p);
  SolvedBatch(const SolvedBatch&) = delete;
  SolvedBatch& operator=(const SolvedBatch&) = delete;

  Model model;
  State state;
  Analysis a;
  std::vector<std::vector<Difference>> differences;
};

}  // namespace kerf
