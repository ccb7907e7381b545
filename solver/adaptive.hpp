#pragma once
// Solve, estimate, refine: until the estimated error of the stress is small enough.

#include "geometry/adapt.hpp"
#include "geometry/mesher.hpp"
#include "solver/estimate.hpp"

namespace kerf {

/// Remesh: a new mesh with the sizes that the indicator asks for; few rounds, curved sides stay exact. Bisect: halve
/// the triangles that carry half of the squared error [Doerfler 1996]; more rounds, nested meshes.
enum class Refinement { Remesh, Bisect };

struct Adaptation {
  double error = 1e-2;  // wanted: Indicator::relative
  Index max_triangles = 200000;
  Refinement refinement = Refinement::Remesh;
  ContactMethod contact = ContactMethod::DualQp;
  bool saddle_point = false;  // solve_extended instead of solve
  int threads = 1;
};

struct Round {
  Index triangles = 0;
  double estimated_error = 0;
  double mesh = 0, assemble = 0, factor = 0, solve = 0, contact = 0, estimate = 0;  // seconds; contact within solve
};

struct Adapted {
  Model model;
  State state;
  Indicator indicator;
  std::vector<Round> rounds;
  std::string stopped;  // why, in words; begins with "reached" when the error is
};

/// From the mesh that `sizing` asks for, which stays the coarsest allowed. `go_on` is asked after each round. Throws as
/// triangulate and prepare do, and Error(Usage) for an element without an error indicator.
Adapted solve_adaptively(const Shape& shape, const Sizing& sizing, const Element& e, const Scene& scene,
                         const Adaptation& adaptation, const std::function<bool(const Round&)>& go_on = {});

}  // namespace kerf
