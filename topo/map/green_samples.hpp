#pragma once
// The regular part of the Green tensor over the body, from a moderate number of points [theory: T.31, T.32].

#include "topo/map/green.hpp"

#include <functional>

namespace kerf {

/// Towards a boundary the tensor grows like a logarithm of the distance, with a coefficient per direction that the
/// half plane tells. This sum of logarithms is taken out before interpolation: distances in the mean of 1/r^3 along the
/// edges, so that they are smooth inside.
struct Wall {
  Vec2 a, b;
  Mat2 axes;   // columns
  Vec2 times;  // of the logarithm, per axis
};
Mat2 wall_logarithms(const std::vector<std::vector<Wall>>& walls, const Vec2& x);

struct GreenSamples {
  std::vector<std::vector<Wall>> walls;         // alike ones together
  std::vector<std::pair<Vec2, Vec2>> barriers;  // segments that no neighbor is seen through
  std::vector<Vec2> x;
  std::vector<Mat2> rest;  // the tensor less the logarithms
  double error = 0;        // see ClampedMap
};

/// Adds points among the candidates (`in`: their triangles), each where the spacing against the distance to the next
/// tip or corner, or 3 distances to the boundary, is the widest, until the tensor at the next ones is predicted well
/// enough for a hole of radius eps, or 400.
GreenSamples sample_green(const Model& model, const Field& state, double eps, std::span<const Vec2> candidates,
                          std::span<const Index> in);

/// int ds/r^3 along a segment: 2/d^2 beside a long straight one.
double inverse_cubes(const Vec2& a, const Vec2& b, const Vec2& x);

/// Moving least squares with cubics over the nearest samples in sight: values in rows.
Eigen::RowVectorXd interpolate_rows(const std::vector<Vec2>& samples,
                                    const std::vector<std::pair<Vec2, Vec2>>& barriers,
                                    const std::function<Eigen::RowVectorXd(std::size_t)>& values, const Vec2& x);

/// Symmetric.
Mat2 interpolate(const GreenSamples& samples, const Vec2& x);

}  // namespace kerf
