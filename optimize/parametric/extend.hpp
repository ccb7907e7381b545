#pragma once
// The motion of a boundary carried into the mesh, and forces on the mesh carried back to the boundary [theory: S.7].

#include "kerf/mesh.hpp"
#include "solver/factor.hpp"

#include <optional>
#include <span>

namespace kerf {

/// Harmonic extension: u = u_given at the given vertices and sum_T |T|^-1 int_T grad u . grad v = 0 for every v that is
/// linear on the triangles and vanishes there. The weight keeps small triangles stiff.
struct Extension {
  struct Coupling {
    Index row, vertex;  // of a free vertex, and a given one
    double value;
  };
  std::vector<Index> sequence;  // vertex_sequence of the mesh (solver/moved.hpp)
  std::vector<Index> row;       // per vertex, none where given
  LowerTriangle inner;
  Factor factor;
  std::vector<Coupling> couplings;
};
/// `given`: per vertex; of each connected piece of the mesh some vertex must be.
Extension make_extension(const Mesh& mesh, const std::vector<bool>& given);

/// Motions of all vertices (2 x vertices) from those of the given ones; the other columns are not looked at.
Points extend(const Extension& e, const Points& motion);
/// Its transpose: sum_v force(v) . extend(motion)(v) = sum over given v of gather(force)(v) . motion(v). Columns of the
/// free vertices are 0.
Points gather(const Extension& e, const Points& force);

/// Vertices on the boundary, on cracks and where regions meet.
std::vector<bool> vertices_that_mean_something(const Mesh& mesh);

/// Smallest angle of every triangle in degrees; 0 or less where it is flat or turned over.
std::vector<double> smallest_angles(const Mesh& mesh);

/// What a moved mesh may look like: what was fine enough across a gap that narrows is not any more.
struct Strain {
  double least_angle = 13;  // degrees; an angle below it and below 0.6 of what it was is refused
  double stretch = 1.6;     // of a triangle, and its inverse
};
/// The mesh after a motion of the given vertices, or nothing where that strains it too much. `angles`: those of `mesh`.
std::optional<Mesh> carry(const Extension& e, const Mesh& mesh, std::span<const double> angles, const Points& motion,
                          const Strain& most = {});

}  // namespace kerf
