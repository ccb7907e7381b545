#pragma once
// What an optimisation is asked to do, as a case file says it.

#include "optimize/design.hpp"
#include "topo/functional.hpp"

namespace kerf {

/// Another set of loads on the same body with the same supports: J is the sum of weight J(state under these loads).
struct LoadCase {
  std::string name;
  double weight = 1;
  std::vector<Traction> tractions;
  VectorField body;  // empty: none
};

/// A functional that must not exceed a value. With several load cases: the worst of them.
struct FunctionalBound {
  std::string name;  // in messages and tables
  Functional functional;
  double at_most = 0;
};

/// A line through which the design is its own mirror image.
struct Mirror {
  Vec2 point = Vec2::Zero(), direction = Vec2::UnitX();
};

/// Circular holes to begin with: a regular pattern, or seeded random places.
struct StartHoles {
  int columns = 0, rows = 0;  // regular pattern in the bounding box, every other column shifted by half a row
  int random = 0;             // or this many random holes
  unsigned seed = 1;
  double radius = 0.1;
};

struct LevelSetRequest {
  enum class Move { ShapeGradient, FixedPoint } move = Move::ShapeGradient;
  enum class Product { H1, Elasticity } product = Product::H1;
  double smoothing = 0;    // length of the inner product that regularises velocities; 0: chosen from the mesh size
  double min_feature = 0;  // members and gaps thinner than this are not wanted; 0: none
  int nucleate_every = 5;  // 0: never
  double nucleate_fraction = 0.02;
  std::vector<Loop> frozen;  // stays solid; may touch and leave the body
  std::optional<Mirror> mirror;
  std::optional<StartHoles> start;
  double ersatz = 0;  // weak phase instead of void: its stiffness relative to the body's; 0: none
};

struct OptimizeRequest {
  std::string method = "level-set";      // | mma | ccsaq | slsqp | cobyla
  std::optional<double> volume_at_most;  // fraction of the area of the body without the design's holes
  double volume_penalty = 0;             // J + penalty * area
  int max_iterations = 100;              // of the level set; state evaluations of the others
  double tolerance = 1e-3;               // relative change, KKT residual
  double min_distance = 0;               // NLopt methods: between holes, and from holes to cracks and the outline
  std::vector<FunctionalBound> bounds;
  std::vector<LoadCase> load_cases;  // empty: the loads of the scene alone
  LevelSetRequest level_set;
  Design design;
};

}  // namespace kerf
