// Tables of edge cracks: all places of the boundary with the direction of the crack there (degrees from x) and its
// angle to the boundary, and the cracks that were drawn.

#include "io/csv.hpp"
#include "io/files.hpp"
#include "io/result.hpp"
#include "io/result/edge_crack_columns.hpp"

#include <cmath>

namespace kerf {

namespace {

void append_name(fmt::memory_buffer& out, std::string_view name) {
  fmt::format_to(std::back_inserter(out), ",{}", name);
}

void append_number(fmt::memory_buffer& out, double value) {
  out.push_back(',');
  append_cell(out, value);
}

}  // namespace

void write_edge_cracks_csv(const std::filesystem::path& path, const inspect::EdgeCrackMap& map) {
  constexpr double degree = pi / 180;
  fmt::memory_buffer out;
  fmt::format_to(std::back_inserter(out), "x,y,direction,angle");
  for (const auto& [name, member] : columns_of_edge_crack) append_name(out, name);
  fmt::format_to(std::back_inserter(out), ",faces,masked");
  const bool tolerance = !map.tolerance.empty();
  if (tolerance) {
    append_name(out, "tolerated");
    for (const auto& [name, member] : columns_of_tolerance) append_name(out, name);
  }
  out.push_back('\n');
  for (std::size_t i = 0; i < map.places.size(); ++i) {
    const inspect::EdgeCrack& crack = map.places[i];
    const Vec2 along = crack.direction();
    append_cell(out, crack.at.x());
    for (const double value : {crack.at.y(), std::atan2(along.y(), along.x()) / degree, crack.angle / degree})
      append_number(out, value);
    for (const auto& [name, member] : columns_of_edge_crack) append_number(out, crack.*member);
    append_name(out, crack.closed ? "closed" : "open");
    append_name(out, word(crack.masked));
    if (tolerance) {
      append_name(out, word(map.tolerance[i].how));
      for (const auto& [name, member] : columns_of_tolerance) append_number(out, map.tolerance[i].*member);
    }
    out.push_back('\n');
  }
  write_file(path, {out.data(), out.size()});
}

void write_drawn_edge_cracks_csv(const std::filesystem::path& path, const std::vector<inspect::DrawnPlace>& drawn) {
  fmt::memory_buffer out;
  fmt::format_to(std::back_inserter(out), "x,y,angle");
  for (const auto& [name, member] : columns_of_drawn_edge) append_name(out, name);
  fmt::format_to(std::back_inserter(out), ",valid,verdict\n");
  for (const inspect::DrawnPlace& place : drawn)
    for (const inspect::DrawnEdge& row : place.rows) {
      append_cell(out, place.crack.at.x());
      for (const double value : {place.crack.at.y(), place.crack.angle * 180 / pi}) append_number(out, value);
      for (const auto& [name, member] : columns_of_drawn_edge) append_number(out, row.*member);
      append_name(out, row.valid ? "yes" : "no");
      append_name(out, word(place.verdict));
      out.push_back('\n');
    }
  write_file(path, {out.data(), out.size()});
}

}  // namespace kerf
