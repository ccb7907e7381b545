#pragma once
// How a design becomes a mesh again: what it takes, and whether it always works.

#include "bench/optimize/optimize_problems.hpp"

namespace kerf {

/// What a new mesh takes of an iteration.
struct Remeshing {
  Index triangles = 0;
  int iterations = 0;
  double iteration_s = 0;          // processor seconds of the mean iteration, line search included
  double carve_s = 0, mesh_s = 0;  // of one iteration: its contour is drawn twice, to correct the area
  double share() const {
    return (carve_s + mesh_s) / iteration_s;
  }
};
/// `size`: edges of the body's mesh; 0.0105 gives about 20,000 triangles of the cantilever.
Remeshing measure_remeshing(OptimizeProblem p, double size, int iterations);

/// Seeded designs through carving and meshing: overlapping circles, slits, tangent holes, holes over cracks.
struct RandomDesigns {
  int count = 0, meshed = 0, refused = 0;  // refused: with a named reason
  std::vector<std::string> failures;       // anything else
  double seconds = 0, slowest = 0;         // processor seconds of all, of one
};
RandomDesigns try_random_designs(int count, const std::function<bool()>& stop_asked = {});

}  // namespace kerf
