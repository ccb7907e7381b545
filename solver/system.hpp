#pragma once
// What a Model has inside: numbering, order, matrix and factor, for the rooms that condense, dualize or move it.

#include "kerf/state.hpp"
#include "solver/contact/contact.hpp"
#include "solver/system/assemble.hpp"
#include "solver/system/rigid.hpp"
#include "solver/system/standing.hpp"

namespace kerf {

struct Inner {
  Kernel kernel;
  Skeleton skeleton;
  Ordering ordering;
  System system;
  std::shared_ptr<const Factor> factor;  // empty when not asked for; shared by models that differ in their loads alone
  std::vector<RigidMotion> floating;     // rigid motions that the supports leave free; the loads balance on them
  SceneData data = {};                   // of the scene on the mesh
  Standing standing = {};                // pieces that contact alone holds
};

/// The same body under other loads, by the factor of `model`: `scene` has the materials and the laws of cracks that the
/// model has, and supports on the same labels and components. Throws as `prepare` does.
Model with_loads(const Model& model, Scene scene);

Triangle triangle(const Model& model, Index t);
/// Of a triangle with its curved edges.
double cell_area(const Model& model, Index t);
/// Throws Error(Usage): `what` is for meshes of straight edges.
void require_straight(const Model& model, std::string_view what);

/// (e, s) with the scene's eigenstrain e.
double work_of_eigenstrain(const Model& m, const Field& s);

/// The scene's eigenstrain (rows 11, 12, 21, 22) at points of triangle t (physical coordinates), times
/// Field::eigenstrain of the field that is looked at; and its derivative along axis 0 or 1 there.
Eigen::Matrix4Xd eigenstrain_at(const Model& m, double share, Index t, const Points& x);
Eigen::Matrix4Xd eigenstrain_slope_at(const Model& m, Index t, const Points& x, int axis);

/// Shares of Inner::floating in the displacement, in the mean of squares.
Eigen::VectorXd floating_shares(const Model& m, const Field& s);

}  // namespace kerf
