#pragma once
// K of a short crack that begins at a free boundary, for loads on its faces: the numbers that the expansion of edge
// cracks is made of [theory: M.2, M.3, M.4].
//
// A crack of length a leaves the boundary at the angle beta (radians, 0 < beta < pi) from its tangent, the body to the
// left of the tangent. In the frame of the crack, x towards the tip, y = x turned by +90 degrees, its faces bear the
// normal load N(s) and the shear T(s), s in [0, a] from the mouth: what the body without the crack has there.

#include "kerf/types.hpp"

#include <array>
#include <vector>

namespace kerf::inspect {

/// Loads are polynomials in s/a, of these powers: 0, 1, 2.
inline constexpr int powers = 3;
using Powers = std::array<double, powers>;

/// K / sqrt(pi a) for loads (s/a)^j: that of a straight boundary, and its change per curvature times length. Curvature
/// is positive where the body is convex.
struct Column {
  Powers straight = {}, curved = {};
};

/// Open faces: K_I, K_II (first index) of the loads N, T (second index).
struct OpenMouth {
  std::array<std::array<Column, 2>, 2> K;
};
/// By a density of dislocations on `points` graded points. Throws Error(Usage) for an angle that is not between 0 and
/// 180 degrees.
OpenMouth open_mouth(double beta, int points = 60);

/// Closed faces that slide: K_II of the load T + friction N. `friction` is Coulomb's coefficient with the sign of the
/// shear: |T| must reach friction |N|. Pressure that sliding itself makes counts [theory: M.4].
Column sliding_mouth(double beta, double friction, int points = 60);

/// The same at any angle between `flattest` and 180 degrees less that, interpolated; and how well: 1e-4.
class Mouths {
 public:
  explicit Mouths(double friction, int threads = 1);
  OpenMouth open(double beta) const;
  /// `sense`: the sign of the shear.
  Column sliding(double beta, double sense) const;
  /// The same at angles that are looked at often, from one end to the other.
  struct Known {
    double angle = 0;
    OpenMouth open;
    Column forth, back;  // sliding, sense +1 and -1
  };
  const std::vector<Known>& known() const {
    return known_;
  }
  double friction() const {
    return friction_;
  }
  static constexpr double flattest = 30 * pi / 180;

 private:
  double friction_;
  std::vector<double> nodes_;
  std::vector<OpenMouth> open_;
  std::vector<Column> sliding_;  // sense +1; the other one is its mirror image
  std::vector<Known> known_;
};

}  // namespace kerf::inspect
