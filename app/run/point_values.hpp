#pragma once
// Values at points of a solved body.

#include "app/point_values.hpp"
#include "app/run/collect.hpp"

namespace kerf {

/// A solved body, and where its triangles lie.
struct SolvedBody {
  const Model& model;
  const Field& state;
  bool plane_strain;
  const Locator& locator;
};

/// `mapped`: the analysis of the map, or null without one; a clamped hole, which would need solves, has no T.
ValuesAt values_at(const SolvedBody& body, const Analysis* mapped, const MapTask& task, std::span<const Vec2> points);

}  // namespace kerf
