#pragma once
// What a .msh file of gmsh says, before any of it is understood as a body.

#include "kerf/types.hpp"

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace kerf {

/// A line or a triangle. `entity`: the curve or surface of the geometry that it is a part of; `groups`: which of
/// RawMesh::groups it is in; `middle`: of second order the nodes between v[i] and v[i + 1].
struct RawLine {
  std::array<Index, 2> v;
  std::int64_t tag;
  std::int32_t entity;
  Index groups;
};
struct RawTriangle {
  std::array<Index, 3> v;
  std::int64_t tag;
  std::int32_t entity;
  Index groups;
  std::array<Index, 3> middle = {none, none, none};
};

/// A curve of the geometry that a mesh was made of. `points`: along it, its ends among them.
struct RawCurve {
  enum class Kind { Line, Circle, Other } kind = Kind::Line;
  Vec2 center = Vec2::Zero();  // of a circle
  double radius = 0;
  std::vector<Vec2> points;
};

struct RawMesh {
  std::string file;  // for messages
  std::vector<Vec2> points;
  std::vector<std::int64_t> tags;  // of the points
  std::vector<RawLine> lines;
  std::vector<RawTriangle> triangles;
  std::vector<std::vector<std::int32_t>> groups;              // sets of physical tags; the first is empty
  std::map<std::pair<int, std::int32_t>, std::string> names;  // of a dimension and a physical tag
  std::map<std::int32_t, RawCurve> curves = {};               // of the geometry, by entity, where it is known
};

/// Formats 2.x and 4.1, in ASCII or binary. What is in the file is checked cell by cell: counts, numbers, tags that
/// stand twice, cells of other kinds, points out of the plane. Throws Error(Geometry) naming file, line (or byte) and
/// tag, Error(Files) for a file that cannot be read.
RawMesh read_msh(const std::filesystem::path& path);
RawMesh parse_msh(std::string name, std::string_view bytes);

/// The name of a physical group, or its number.
std::string group_name(const RawMesh& mesh, int dimension, std::int32_t tag);

}  // namespace kerf
