#pragma once
// Singular fields whose reciprocal work with a state is a quantity of it: a stress at a point, K at a tip [theory:
// B.11].

#include "kerf/material.hpp"

#include <array>
#include <functional>

namespace kerf {

/// A field in equilibrium without body force, away from where it is singular. Compliance of one isotropic material.
struct Nucleus {
  std::function<Vec2(const Vec2& x)> displacement;
  std::function<Mat2(const Vec2& x)> stress;
};

/// Several fields that are singular at the same place, at once.
struct NucleusValue {
  Vec2 displacement = Vec2::Zero();
  Mat2 stress = Mat2::Zero();
};
struct Nuclei {
  static constexpr int most = 3;
  std::function<void(const Vec2& x, std::array<NucleusValue, most>& values)> at;
};

enum class PointStress { Trace, Difference, Shear };  // s11 + s22, (s22 - s11)/2, s12
/// int_boundary (t.G - s(G) n.u) around x, of a state without body force near x, is that part of its stress at x.
Nucleus point_nucleus(const Material& material, const Vec2& x, PointStress part);

/// All three, in their order.
Nuclei point_nuclei(const Material& material, const Vec2& x);

/// The mean over the disc |x - center| < radius instead: the field of a uniform eigenstrain there [Eshelby 1957], with
/// its displacement everywhere and its stress outside [theory: B.21].
Nucleus disc_nucleus(const Material& material, const Vec2& center, double radius, PointStress part);
/// The mean along the line, of the stress in its frame: 1 along it, 2 across [theory: B.22].
Nucleus line_nucleus(const Material& material, const Vec2& from, const Vec2& to, PointStress part);

/// The same for K_I or K_II of a straight crack that ends at `tip` and runs along frame's -x from there, over `length`
/// to its other tip, or without end (infinity). Its faces carry no traction, and it has no dislocation [Bueckner 1970].
Nucleus tip_nucleus(const Material& material, const Vec2& tip, const Mat2& frame, double length, int mode);

/// K_I and K_II, of a crack without end.
Nuclei tip_nuclei(const Material& material, const Vec2& tip, const Mat2& frame);

/// The same for a crack along an arc of a circle, from the end `other` to `tip`; `inside` is a point of it between
/// them, `frame` that of the tip. It does not fade far away; nothing is singular at the center [theory: B.41].
struct ArcTip {
  Vec2 center, tip, other, inside;
  Mat2 frame;
};
Nucleus arc_tip_nucleus(const Material& material, const ArcTip& tip, int mode);

}  // namespace kerf
