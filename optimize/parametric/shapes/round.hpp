#pragma once
// What circles, ellipses and circular inclusions share. Their variables begin with the center.

#include "optimize/parametric/shapes/shape.hpp"

namespace kerf {

/// Places in the axes: x = center + axes local.
std::function<Spot(const Vec2& x)> locate_in(const Vec2& center, const Mat2& axes);
CoordinateBox box_around_center(const Drawn& d, double radius);

// The third variable is the radius.
void require_radius(const Drawn& d);
std::function<Spot(const Vec2& x)> locate_on_disc(const Eigen::VectorXd& v, double size);
Vec2 position_on_disc(const Spot& spot, const Eigen::VectorXd& v);
void pull_disc(const Spot& spot, const Eigen::VectorXd& v, const Vec2& force, Eigen::Ref<Eigen::VectorXd> sum);
DesignCurve disc_boundary(const Drawn& d, const Eigen::VectorXd& v, bool cut);
CoordinateBox box_of_disc(const Drawn& d);

}  // namespace kerf
