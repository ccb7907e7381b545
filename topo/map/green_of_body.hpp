#pragma once
// What topo/clamped_parts.hpp hands from the first process to the others.

#include "topo/map/green_samples.hpp"

#include <optional>

namespace kerf {

struct GreenOfBody {
  struct Tensor {
    GreenSamples samples;
    std::vector<Mat2> at;  // its regular part at the listed points
  };
  std::vector<Vec2> points;  // listed ones
  Tensor body;
  std::optional<Tensor> measured;  // of a misfit

  /// The regular part of one of them.
  Mat2 regular(const Tensor& tensor, const Vec2& x) const;
};

}  // namespace kerf
