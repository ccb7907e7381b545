// Arrays for the page: points, triangles, fields at corners, lines, map with its masks, designs and what was found.
// Names and widths are those that the page's script knows (plot/page/script.cpp). Numbers are floats. Lines are pairs
// of corners; designs are one list of points with a list of lines beside it, (design, kind, count) each. `margin` is
// the room of a change in its radius, and `near` says what is in the way.

#include "app/write/page_data.hpp"

#include "app/write/draw.hpp"
#include "solver/stress.hpp"
#include "topo/near.hpp"

#include <cmath>

namespace kerf {

namespace {

NamedArray floats(const char* name, const Eigen::MatrixXd& columns) {
  NamedArray out{.name = name, .width = static_cast<std::size_t>(columns.rows())};
  out.numbers.reserve(static_cast<std::size_t>(columns.size()));
  for (const double value : columns.reshaped()) out.numbers.push_back(static_cast<float>(value));
  return out;
}

std::uint32_t index(Index i) {
  return static_cast<std::uint32_t>(i);
}

/// The corner number that a triangle has at a vertex.
std::uint32_t corner_number(const Mesh& mesh, const Corners& corners, Index t, Index vertex) {
  for (int i = 0; i < 3; ++i)
    if (mesh.triangles[t][i] == vertex) return index(corners.of[t][i]);
  return 0;
}

/// Pairs of corners: boundary edges, edges between materials, both faces of cracks.
void add_line_arrays(std::vector<NamedArray>& arrays, const Mesh& mesh, const Corners& corners) {
  NamedArray outline{.name = "outline", .width = 2}, interfaces{.name = "interfaces", .width = 2},
      cracks{.name = "cracks", .width = 2};
  const auto add = [&](NamedArray& to, Index t, Index e) {
    for (const Index v : mesh.edges[e]) to.indices.push_back(corner_number(mesh, corners, t, v));
  };
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e) {
    const auto& [left, right] = mesh.sides[e];
    if (left == none || right == none) add(outline, left == none ? right : left, e);
    if (is_interface(mesh, e)) add(interfaces, left, e);
    if (mesh.crack[e] == none) continue;
    for (const Index t : {left, right})
      if (t != none) add(cracks, t, e);
  }
  for (NamedArray* a : {&outline, &interfaces, &cracks})
    if (!a->indices.empty()) arrays.push_back(std::move(*a));
}

void add_pieces(std::vector<NamedArray>& arrays, const char* name, const std::vector<std::vector<Vec2>>& lines) {
  NamedArray out{.name = name, .width = 4};
  for (const auto& line : lines)
    for (std::size_t i = 1; i < line.size(); ++i)
      for (const double value : {line[i - 1].x(), line[i - 1].y(), line[i].x(), line[i].y()})
        out.numbers.push_back(static_cast<float>(value));
  if (!out.numbers.empty()) arrays.push_back(std::move(out));
}

}  // namespace

void add_state(std::vector<NamedArray>& arrays, const Adapted& adapted, const PlotData& data, const Picture& drawing) {
  const auto n = static_cast<Eigen::Index>(data.points.size());
  Eigen::MatrixXd points(2, n), stress(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    points.col(i) = data.points[static_cast<std::size_t>(i)];
    stress.col(i) = symmetric_part(data.values.stress.col(i));
  }
  arrays.push_back(floats("points", points));
  NamedArray triangles{.name = "triangles", .width = 3};
  for (const auto& t : data.corners.of)
    for (const Index c : t) triangles.indices.push_back(index(c));
  arrays.push_back(std::move(triangles));
  arrays.push_back(floats("u", data.values.displacement));
  arrays.push_back(floats("stress", stress));
  arrays.push_back(floats("von_mises", data.von_mises.transpose()));
  if (adapted.indicator.eta.size() > 0) arrays.push_back(floats("error_indicator", adapted.indicator.eta.transpose()));
  add_line_arrays(arrays, adapted.model.mesh, data.corners);
  add_pieces(arrays, "supports", drawing.supports);
  add_pieces(arrays, "rollers", drawing.rollers);
  std::vector<std::vector<Vec2>> arrows;
  for (const auto& [from, to] : drawing.arrows) arrows.push_back({from, to});
  add_pieces(arrays, "arrows", arrows);
}

void add_map(std::vector<NamedArray>& arrays, const MapTask& task, const Mapped& map, const Model& model,
             const PlotData& data) {
  if (!is_everywhere(map.full)) return;
  arrays.push_back(floats("map", map.full.at_corners.transpose()));
  if (map.full.lower.size() > 0) {
    arrays.push_back(floats("lower", map.full.lower.transpose()));
    arrays.push_back(floats("upper", map.full.upper.transpose()));
  }
  if (map.full.angle.size() > 0) arrays.push_back(floats("angle", map.full.angle.transpose() * (180 / pi)));
  arrays.push_back(floats("margin", map.full.margin.transpose()));
  NamedArray near{.name = "near"}, left_out{.name = "left_out"};
  const double radius = task.request.radius;
  for (const Near what : nearest(model, task.functional, data.points, clear_radii * radius, radius))
    near.indices.push_back(static_cast<std::uint32_t>(what));
  constexpr std::uint32_t second_term = 1 + static_cast<std::uint32_t>(Near::Ring);
  for (Eigen::Index i = 0; i < map.full.c2.size(); ++i)
    if (std::isfinite(map.full.c2[i])) near.indices[static_cast<std::size_t>(i)] = second_term;
  for (const LeftOut what : map.left_out_corner) left_out.indices.push_back(static_cast<std::uint32_t>(what));
  arrays.push_back(std::move(near));
  arrays.push_back(std::move(left_out));
}

void add_shots(std::vector<NamedArray>& arrays, const std::string& of, const std::vector<Snapshot>& snapshots) {
  NamedArray shots{.name = of + ".shots", .width = 3}, lines{.name = of + ".lines", .width = 3},
      points{.name = of + ".points", .width = 2};
  const auto add = [&](std::size_t shot, std::uint32_t kind, const std::vector<Vec2>& line) {
    lines.indices.insert(lines.indices.end(),
                         {static_cast<std::uint32_t>(shot), kind, static_cast<std::uint32_t>(line.size())});
    for (const Vec2& p : line)
      for (const double value : {p.x(), p.y()}) points.numbers.push_back(static_cast<float>(value));
  };
  for (std::size_t i = 0; i < snapshots.size(); ++i) {
    const Snapshot& s = snapshots[i];
    for (const double value : {static_cast<double>(s.iteration), s.objective, s.volume_fraction})
      shots.numbers.push_back(static_cast<float>(value));
    for (const auto& line : s.contours.boundary) add(i, 0, line);
    for (const auto& line : s.contours.cracks) add(i, 1, line);
  }
  if (shots.numbers.empty() || points.numbers.empty()) return;
  for (NamedArray* a : {&shots, &lines, &points}) arrays.push_back(std::move(*a));
}

void add_found(std::vector<NamedArray>& arrays, const Picture& found) {
  NamedArray lines{.name = "found.lines", .width = 2}, points{.name = "found.points", .width = 2};
  const auto add = [&](std::uint32_t kind, const std::vector<Vec2>& line) {
    lines.indices.insert(lines.indices.end(), {kind, static_cast<std::uint32_t>(line.size())});
    for (const Vec2& p : line)
      for (const double value : {p.x(), p.y()}) points.numbers.push_back(static_cast<float>(value));
  };
  for (const Trace& t : found.traces)
    add(t.dashed ? 0 : t.rgb == true_color ? 1 : t.rgb == found_color ? 2 : 3, t.line);
  for (const auto* all : {&found.outlines, &found.cracks})
    for (const auto& line : *all) add(4, line);
  for (NamedArray* a : {&lines, &points}) arrays.push_back(std::move(*a));
}

}  // namespace kerf
