#pragma once
// Fields at the center of a ball, and the formula there.

#include "topo/map/modes.hpp"

#include <Eigen/QR>

namespace kerf {

/// Triangles of a ball: first <= t < end, centered and as large as `radius`.
struct BallIn {
  Index first, end;
  Vec2 at;
  double radius;
};

/// Stress and displacement of a state at the center of a ball: polynomials of degree 4 in the mean of squares over its
/// inner half, which keep the order of the element and average its noise.
class Center {
 public:
  Center(const Model& m, const BallIn& ball);

  struct Value {
    double coefficient, size;  // T, and what |T| could be (size_of)
    std::vector<Mode> modes;
  };
  Value value(const Expansion& e) const;

 private:
  Eigen::Vector3d stress(const Field& s) const;
  Vec2 displacement(const Field& s, bool recovered) const;

  const Model& m_;
  Vec2 at_;
  Index last_;  // triangle of the ball
  std::vector<Index> use_;
  Eigen::VectorXd weight_;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> fit_;
};

}  // namespace kerf
