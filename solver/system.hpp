#pragma once
// What a Model has inside: numbering, order, matrix and factor, for the rooms that condense, dualize or move it.

#include "kerf/state.hpp"
#include "solver/contact/contact.hpp"
#include "solver/system/assemble.hpp"
#include "solver/system/rigid.hpp"

namespace kerf {

struct Inner {
  Kernel kernel;
  Skeleton skeleton;
  Ordering ordering;
  System system;
  Factor factor;                      // empty when not asked for
  std::vector<RigidMotion> floating;  // rigid motions that the supports leave free; the loads balance on them
  SceneData data = {};                // of the scene on the mesh
};

Triangle triangle(const Model& model, Index t);

/// Shares of Inner::floating in the displacement, in the mean of squares.
Eigen::VectorXd floating_shares(const Model& m, const Field& s);

}  // namespace kerf
