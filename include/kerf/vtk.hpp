#pragma once
// Fields on triangles and on lines, to files ParaView opens. VTK lives in vtk_module.cpp and nowhere else.

#include "kerf/mesh.hpp"
#include "kerf/types.hpp"

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace kerf {

/// `values` is components x (points or cells). Two components are written as 3-vectors (z = 0) so that ParaView can
/// warp by them; four as xx, yy, xy, yx with component names; three as xx, yy, xy.
struct NamedField {
  std::string name;
  bool per_cell = false;
  Eigen::MatrixXd values;
};

/// Loads VTK now. Throws Error(Files) when it cannot be had: better before the solve than after.
void require_vtk();

/// Points in the middle of the edges of triangles that have a curved one.
struct MiddlePoints {
  std::vector<Vec2> at;                       // on the arc, or on the chord of a straight edge
  std::vector<std::array<Index, 2>> between;  // the ends of its edge, as `triangles` number them
  std::vector<std::array<Index, 3>> of;  // per triangle, of its edges from corner i to corner i + 1, or none; empty
                                         // when all triangles are straight
};
/// `triangles`: those of the mesh, by numbers of points that they share with a neighbor or not (as at cracks).
MiddlePoints middle_points(const Mesh& mesh, std::span<const std::array<Index, 3>> triangles);

/// XML unstructured grid of triangles, raw binary (doubles hardly compress). Those with middle points are quadratic
/// ones, these points follow the others, with the mean of what the fields are at both ends. Throws Error(Files) naming
/// the path.
void write_vtu(const std::filesystem::path& path, std::span<const Vec2> points,
               std::span<const std::array<Index, 3>> triangles, std::span<const NamedField> fields,
               const MiddlePoints& middle = {});

/// The grid that these pieces (files beside it) are parts of, each with fields of these names, kinds and components.
void write_pvtu(const std::filesystem::path& path, std::span<const std::string> pieces,
                std::span<const NamedField> fields);

/// XML poly data: one polyline per entry of `lines`, lone points where each has one; point fields numbered through all
/// lines.
void write_vtp(const std::filesystem::path& path, std::span<const std::vector<Vec2>> lines,
               std::span<const NamedField> fields);

}  // namespace kerf
