#pragma once
// The expansion at one point from the values of all its fields there.

#include "kerf/analysis.hpp"

namespace kerf {

Mat2 symmetric(const Eigen::Vector3d& s);              // from s11, s22, s12
Eigen::Vector3d components(const Eigen::Vector4d& s);  // of the symmetric part

/// What removes the body force with the body.
bool removes_body(const Perturbation& p);

/// Which displacements the expansion asks for.
struct Needs {
  bool displacement = false;  // of the state
  bool dual_displacement = false;
  bool recover_dual = true;  // the adjoint's displacement may be recovered from its stress
};
Needs needs(const Analysis& a, const Functional& j, const Perturbation& p);

/// At one point of every state: stresses s11, s22, s12.
struct PointValues {
  Vec2 x;
  Material material;
  Eigen::Vector3d stress, dual = {}, measured = {};
  Vec2 u = Vec2::Zero(), p = Vec2::Zero(), measured_u = Vec2::Zero();
  Eigen::Matrix3Xd openings = {};  // of the responses to openings
  Points opening_u = {};
};

/// T, and the angle of what has one. `closed`, one entry per biactive row, is a guess of which stay closed, and the
/// answer afterwards.
Oriented expand(const Analysis& a, const Functional& j, const Perturbation& p, const PointValues& v,
                std::vector<bool>& closed);
std::vector<bool> no_row_closed(const Analysis& a);
/// What |T| could be for stresses of this size in other directions.
double size_of(const Analysis& a, const Perturbation& p, const PointValues& v);

}  // namespace kerf
