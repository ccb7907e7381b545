#pragma once
// An exact field for every Poisson's ratio, as values and as text for case files; and the pieces of case files.

#include "bench/hard/family.hpp"

namespace kerf {

/// "1.5", "-2e-12": 17 digits, a TOML float.
std::string decimal(double value);
/// "[x, y]"
std::string decimal(const Vec2& x);
/// "[[x, y], ...]"
std::string decimals(const std::vector<Vec2>& points);

/// Where the local frame of a field lies: X = origin + length R(angle) x, stresses times `load`.
struct Placed {
  Vec2 origin = Vec2::Zero();
  double length = 1, angle = 0, load = 1;  // radians
  Vec2 at(const Vec2& local) const;
  Vec2 local(const Vec2& x) const;
};

/// The stress is linear, without body force [Muskhelishvili 1953]: with phi = (z^2 + z)/4, psi = z/4
///   s11 + s22 = 2x + 1,  s22 - s11 = x + 1/2,  s12 = -y/2,  2 mu (u1 + i u2) = kappa phi - z conj(phi') - conj(psi),
/// kappa = 3 - 4 nu in plane strain [theory: N.6]. Elements with linear stresses have it exactly, so that what is left
/// is rounding.
Eigen::Vector3d linear_stress(const Placed& placed, const Vec2& x);  // 11, 22, 12
/// "[define]" with c, s, the local coordinates p and, where it is needed, q; expressions of them.
std::string local_frame(const Placed& placed);
std::string linear_frame(const Placed& placed);
std::string linear_traction(const Placed& placed);  // ["..", ".."]
/// `turn`: a rotation of the body by so much, in linear elasticity, is added.
std::string linear_displacement(const Placed& placed, double young, double poisson, double turn = 0);

/// The largest error of the probe's stresses against `exact` there, over the largest of them.
double stress_error(const HardRun& seen, const std::function<Eigen::Vector3d(const Vec2&)>& exact);

/// "[material]", plane strain.
std::string material(double young, double poisson);
/// "[[boundary]]" with what is given on a label.
std::string boundary(const std::string& on, const std::string& what);
std::string outline(const std::vector<Vec2>& points, const std::vector<std::string>& sides);
std::string probe(const std::vector<Vec2>& points);
/// "[mesh]" and no files but the numbers.
std::string mesh_and_output(double size, const std::string& more = {});

}  // namespace kerf
