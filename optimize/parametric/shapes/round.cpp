// What circles, ellipses and circular inclusions share: places in their axes, x = center + axes local, and derivatives.

#include "optimize/parametric/shapes/round.hpp"

namespace kerf {

using Eigen::VectorXd;

std::function<Spot(const Vec2& x)> locate_in(const Vec2& center, const Mat2& a) {
  const Mat2 inverse = Mat2{{a(1, 1), -a(0, 1)}, {-a(1, 0), a(0, 0)}} / (a(0, 0) * a(1, 1) - a(0, 1) * a(1, 0));
  return [=](const Vec2& x) { return Spot{.local = inverse * (x - center)}; };
}

CoordinateBox box_around_center(const Drawn& d, double radius) {
  return {d.lower.head<2>().array() - radius, d.upper.head<2>().array() + radius};
}

void require_radius(const Drawn& d) {
  require(d.lower[2] > 0, d, "the radius must not vanish; give it a positive lower bound");
}

std::function<Spot(const Vec2& x)> locate_on_disc(const VectorXd& v, double) {
  return locate_in(v.head<2>(), v[2] * Mat2::Identity());
}

Vec2 position_on_disc(const Spot& spot, const VectorXd& v) {
  const Mat2 axes = v[2] * Mat2::Identity();
  return v.head<2>() + axes * spot.local;
}

// x = center + radius local.
void pull_disc(const Spot& spot, const VectorXd&, const Vec2& force, Eigen::Ref<VectorXd> sum) {
  sum.head<2>() += force;
  sum[2] += force.dot(spot.local);
}

DesignCurve disc_boundary(const Drawn&, const VectorXd& v, bool) {
  DesignCurve c = fixed_disc(v.head<2>(), v[2]);
  c.by_center = Eigen::Matrix2Xd::Zero(2, v.size());
  c.by_center(0, 0) = c.by_center(1, 1) = 1;
  c.by_radius = VectorXd::Zero(v.size());
  c.by_radius[2] = 1;
  return c;
}

CoordinateBox box_of_disc(const Drawn& d) {
  return box_around_center(d, d.upper[2]);
}

}  // namespace kerf
