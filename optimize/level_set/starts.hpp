#pragma once
// What a level set begins with.

#include "optimize/level_set/ground.hpp"

namespace kerf {

struct LevelSetStart {
  std::string name;        // in messages
  Eigen::VectorXd phi;     // on the canvas
  int solves = 0;          // that choosing it took
  bool explore = false;    // without the holes that it needs: they appear on the way
  std::string ended = {};  // why there is no way down for a level set from here, in words; empty mostly
};

/// The full body, or with the holes asked for.
LevelSetStart given_start(const Ground& g);

/// The one to go on from. Throws Error(Usage | Geometry | Numerics).
LevelSetStart best_start(const Ground& g);

}  // namespace kerf
