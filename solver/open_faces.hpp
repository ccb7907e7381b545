#pragma once
// Cracks that may touch and do not: what is bounded of the body with cracks that never touch.

#include "kerf/state.hpp"

namespace kerf {

/// Cracks may touch, and none does anywhere on this mesh.
bool open_everywhere(const Model& m, const State& s);

/// A body whose cracks never touch, and its state.
struct Opened {
  Model model;
  State state;
};
/// That of a body whose cracks may touch.
Opened opened(const Model& m, int threads);

/// What the intervals of that body are for the one whose cracks may touch.
inline constexpr const char* of_opened =
    "the interval is that of a crack whose faces may penetrate: on this mesh they are open everywhere";

}  // namespace kerf
