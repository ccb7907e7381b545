#pragma once
// Global numbering of the edge displacements and of the crack jumps. Cracks enter the mathematics here and only here.

#include "kerf/mesh.hpp"
#include "solver/data.hpp"
#include "solver/element/local.hpp"

namespace kerf {

/// What the right side of a crack edge sees is what its left side sees plus a jump. Base unknowns: per_edge per mesh
/// edge (per Gauss point in the edge's direction the two components of `frame`), then per_vertex per corner. Jump
/// unknowns: per_edge per crack edge, numbered behind all base unknowns. Frames of crack edges are (normal, tangent),
/// so that a jump's first component is the opening [u].n >= 0 whatever the direction of the edge. A vertex has one
/// corner for each fan of triangles between cracks that are not bonded.
struct Skeleton {
  int per_edge = 0, per_vertex = 0;
  Index base = 0;                             // base unknowns
  Index total = 0;                            // base and jump unknowns
  std::vector<Mat2> frame;                    // per edge, columns are directions
  std::vector<Mat2> bent;                     // frames at the Gauss points of curved cracks and rollers
  std::vector<Index> bent_at;                 // per edge its first one, or none
  std::vector<Index> jump;                    // per edge its first jump unknown, or none
  Corners corners;                            // empty without unknowns at vertices
  std::vector<Eigen::Matrix3d> corner_frame;  // per corner: see Triangle::corner
  std::vector<double> prescribed;             // per unknown its value where fixed; of a normal jump what it is at
                                              // first contact, -gap; 0 elsewhere
  std::vector<bool> fixed;                    // per unknown: by a support, or the jump of a bonded crack
  std::vector<bool> bounded;                  // per unknown: a normal jump that must not be negative
  std::vector<bool> frictional;               // per unknown: a tangential jump that friction resists
  std::vector<bool> sliding;                  // per unknown: a tangential jump in contact that no law acts on
  EdgeCurvatures curvatures;                  // of curved edges
  std::vector<bool> unseen;                   // per unknown: part of a combination that no triangle sees; or empty
};

/// Directions of the two components at a Gauss point of an edge.
const Mat2& frame_at(const Skeleton& s, Index edge, int point);
/// The same at a point of a curved edge whose frames follow it, s from 0 to 1; else the edge's own.
Mat2 frame_between(const Mesh& mesh, const Skeleton& s, Index edge, double at);
Index edge_unknown(const Skeleton& s, Index edge);
Index corner_unknown(const Skeleton& s, Index corner);

/// A scene and its data on the mesh.
struct Loading {
  const Scene& scene;
  const SceneData& data;
};

/// Supports are projected onto the edge spaces in L2, interpolated in displacement elements.
/// Throws Error(Numerics) for a scene that the element cannot do.
Skeleton number(const Mesh& mesh, const Kernel& k, const Loading& loading, const EdgeCurvatures& curvatures = {});

/// A uniform pressure strains nothing in an incompressible body: whether no edge has a given normal traction, so that
/// its level is free. Throws Error(Numerics) when contact forces would depend on it.
bool has_free_pressure(const Mesh& mesh, const Scene& scene, const Skeleton& s);

Triangle triangle(const Mesh& mesh, const Skeleton& s, Index t);

/// What triangle t is made of.
const Material& material_of(const Mesh& mesh, const Scene& scene, Index t);

/// Unknowns seen by triangle t: base unknowns of its edges, then of its corners; and, where it lies on the right of a
/// crack edge, the jump that it sees on top of the base unknown (none elsewhere).
struct Seen {
  std::array<Index, max_skeleton> base, jump;
  int count = 0;
};
Seen seen(const Mesh& mesh, const Skeleton& s, Index t);
/// What triangle t sees of the values of all unknowns.
SkeletonVector trace_seen(const Mesh& mesh, const Skeleton& s, const Eigen::VectorXd& values, Index t);

/// Loads of the tractions and of the pressures in cracks: their moments against the basis of each such edge, per
/// unknown. On the two sides of a pressed edge p n acts, n away from the crack, normal to the edge: both do work on the
/// jump alone [theory: C.15].
Eigen::VectorXd traction_loads(const Mesh& mesh, const Kernel& k, const Skeleton& s, const SceneData& data);

}  // namespace kerf
