#pragma once
// What a Model has inside: numbering, order, matrix and factor, for the rooms that condense, dualize or move it.

#include "kerf/state.hpp"
#include "solver/contact/contact.hpp"
#include "solver/system/assemble.hpp"
#include "solver/system/held.hpp"
#include "solver/system/rigid.hpp"
#include "solver/system/semicoercive.hpp"

#include <optional>

namespace kerf {

/// Of a part of a body that several processes solve together (solver/divided_body.hpp): what counts here. Integrals
/// over a model run over own triangles, so that those of the processes add up to that of the body.
struct OwnShare {
  Index triangles = 0;        // own ones, the first of the mesh
  Index here = 0;             // this process
  std::vector<Index> holder;  // per triangle whose it is; in a model per skeleton unknown who answers for it: for a
                              // trace the first process that sees it, for a jump that of the crack's right side
  std::shared_ptr<const Mesh> whole = {};  // the body before its mesh was divided: where its features are
};
/// The mesh that has all sides, cracks and borders of the body.
const Mesh& whole_mesh(const Model& m);

struct Inner {
  Kernel kernel;
  Skeleton skeleton;
  Ordering ordering;
  System system;
  // Empty when not asked for, none with large contact; shared by models that differ in their loads alone.
  std::shared_ptr<const Factor> factor;
  std::vector<RigidMotion> floating;       // rigid motions that the supports leave free; the loads balance on them
  SceneData data = {};                     // of the scene on the mesh
  Semicoercive semicoercive = {};          // pieces that contact alone holds
  std::shared_ptr<HeldFactors> held = {};  // instead of `factor` where contact is too large for a dense matrix
  std::vector<Motion> start = {};          // per row in contact: the set to begin with there, or nothing
  std::optional<OwnShare> own = {};        // nothing: all of it
};

/// What its solves in parts took so far; nothing without parts.
std::optional<SolverEffort> solver_effort(const Model& model);

/// What is fixed of a body that its supports leave free to move: of the edge between two points the unknown `at`.
struct Pin {
  std::array<Vec2, 2> edge;
  int at = 0;
};
/// The motions that are left free, and the pins, as many, for meshes that are `divisions` times divided.
struct Floating {
  std::vector<RigidMotion> motions = {};
  std::vector<Pin> pins = {};
};
Floating floating_of(const Model& model, int divisions);
/// The scene with the body force, a combination of the motions, that undoes the work of the loads on them.
Scene balanced(Scene scene, const std::vector<RigidMotion>& motions, const Eigen::VectorXd& share);
/// Of a part of a body, without a matrix: `own.holder` per triangle.
Model prepare_part(Mesh mesh, const Element& e, Scene scene, int threads, OwnShare own, const Floating& floating);
/// How many triangles integrals run over, the first ones; whether an unknown counts.
Index own_triangles(const Model& m);
bool owns(const Model& m, Index unknown);

/// No dense matrix of contact: a factor per set of held rows.
bool has_large_contact(const Model& model);

/// The same body under other loads, by the factor of `model`: `scene` has the materials and the laws of cracks that the
/// model has, and supports on the same labels and components. Throws as `prepare` does.
Model with_loads(const Model& model, Scene scene);

/// The same with the loads alone, for those who solve many at once: K is left empty.
Model loads_alone(const Model& model, Scene scene);

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
