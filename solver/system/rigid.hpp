#pragma once
// Rigid motions that the supports leave free, and what the loads do on them.

#include "solver/system/skeleton.hpp"

#include <cmath>
#include <span>
#include <string>

namespace kerf {

/// r(x) = (a - w (y - y0), b + w (x - x0)).
struct RigidMotion {
  Vec2 center = Vec2::Zero();
  Vec2 translation = Vec2::Zero();
  double rotation = 0;
  Vec2 at(const Vec2& x) const {
    const Vec2 d = x - center;
    return translation + rotation * Vec2(-d.y(), d.x());
  }
};

/// "a translation along (1, 0)", "a rotation about (0, 0)": for messages.
std::string describe(const RigidMotion& motion);

/// Orthonormal basis (in a scaled sense) of the rigid motions of the triangles with piece[t] == which that violate no
/// prescribed component. Contact does not count as a support.
std::vector<RigidMotion> free_motions(const Mesh& mesh, const Kernel& k, const Skeleton& s,
                                      const std::vector<Index>& piece, Index which);

/// Work of tractions and body force on a motion, and its size relative to the sum of the absolute contributions, those
/// of the body force as large as if it were parallel to the motion (0 without loads). Of what acts on the first
/// triangles of the mesh.
struct Work {
  double value = 0, size = 0;
  double relative() const {
    return size > 0 ? std::abs(value) / size : 0;
  }
};
Work work_on(const Mesh& mesh, const Kernel& k, const Skeleton& s, const Loading& loading, const RigidMotion& motion,
             Index triangles);

/// As many base unknowns as there are motions, chosen on the boundary so that fixing them excludes every motion. All in
/// one of the pieces (per triangle) where they are given.
std::vector<Index> pins(const Mesh& mesh, const Kernel& k, const Skeleton& s, const std::vector<RigidMotion>& motions,
                        std::span<const Index> piece = {});

/// Trace values of a motion: per skeleton base unknown.
Eigen::VectorXd trace(const Mesh& mesh, const Kernel& k, const Skeleton& s, const RigidMotion& motion);

/// Where the element's displacement sees a motion at the points of a rule: there, at the centroid when it is constant;
/// in curved triangles at the projection of the places onto its displacements.
Points seen_points(const Kernel& k, const Triangle& t, const TriangleRule& rule);

/// The Gram matrix of the motions, as the element's displacement sees them on the first triangles of the mesh.
Eigen::MatrixXd gram_of(const Mesh& mesh, const Kernel& k, const Skeleton& s, const std::vector<RigidMotion>& motions,
                        Index triangles);
/// Shares of the motions in the field that has the `moments` int u . motion: Gram matrix^-1 moments.
Eigen::VectorXd shares(const Mesh& mesh, const Kernel& k, const Skeleton& s, const std::vector<RigidMotion>& motions,
                       const Eigen::VectorXd& moments);

}  // namespace kerf
