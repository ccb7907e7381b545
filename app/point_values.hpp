#pragma once
// What a run found, read at any points: without another solve.

#include "kerf/mesh.hpp"

#include <functional>
#include <span>
#include <vector>

namespace kerf {

/// A column or an entry per point; NaN outside the body.
struct ValuesAt {
  std::vector<Index> triangle;  // none: outside
  Points displacement;          // recovered, as probes have it [theory: R.1]
  Eigen::Matrix4Xd stress;      // the element's own: s11, s12, s21, s22
  Eigen::RowVectorXd rotation, von_mises;
  Eigen::VectorXd derivative;  // T; empty without a map of this body
  std::vector<bool> masked;    // of it
};
using ReadPoints = std::function<ValuesAt(std::span<const Vec2>)>;

}  // namespace kerf
