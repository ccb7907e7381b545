// Numbers and a picture of the cracks in grown.toml, the body at the end of a run that grew them. Paths are polylines,
// as the file has them.

#include "bench/verify/paths.hpp"

#include "geometry/plane.hpp"
#include "io/words.hpp"
#include "kerf/case_file.hpp"
#include "kerf/mesher.hpp"
#include "plot/picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace kerf {

namespace {

using Path = std::vector<Vec2>;

[[noreturn]] void no_place(const std::string& where, const std::string& why) {
  throw Error(Fault::Usage, fmt::format("{} is no place of a path: {}", quote(where), why));
}

Case grown_in(const std::filesystem::path& folder) {
  return read_case(folder / "grown.toml");
}

const Path& path_named(const Shape& shape, const std::string& name, const std::string& where) {
  const auto crack = std::ranges::find(shape.cracks, name, &Crack::name);
  if (crack == shape.cracks.end()) no_place(where, "there is no crack " + quote(name));
  return crack->points;
}

double distance_to(const Path& path, const Vec2& x) {
  double least = infinity;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) least = std::min(least, distance(x, path[i], path[i + 1]));
  return least;
}

double length_of(const Path& path) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) sum += (path[i + 1] - path[i]).norm();
  return sum;
}

/// The point where coordinate `axis` is first `value`, and the length up to there.
std::pair<Vec2, double> passing(const Path& path, int axis, double value, const std::string& where) {
  double length = 0;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const Vec2 &a = path[i], &b = path[i + 1];
    const double from = a[axis] - value, to = b[axis] - value, share = from == 0 ? 0 : from / (from - to);
    if (from * to <= 0 && std::isfinite(share)) {
      const Vec2 at = a + share * (b - a);
      return {at, length + (at - a).norm()};
    }
    length += (b - a).norm();
  }
  no_place(where, "the path does not pass there");
}

double coordinate(const Path& path, const std::string& what, const std::string& where) {
  const char of = what[0];
  const std::string at = what.substr(2);
  if (at == "end" || at == "start") {
    if (of == 's') no_place(where, "write length");
    const Vec2& x = at == "end" ? path.back() : path.front();
    return of == 'x' ? x.x() : x.y();
  }
  double value = nan;
  const bool known = at.starts_with("x=") || at.starts_with("y=");
  if (known) std::from_chars(at.data() + 2, at.data() + at.size(), value);
  if (!std::isfinite(value)) no_place(where, "write @end, @start, @x=NUMBER or @y=NUMBER");
  const auto [point, length] = passing(path, at[0] == 'x' ? 0 : 1, value, where);
  return of == 's' ? length : of == 'x' ? point.x() : point.y();
}

double turned(const Path& path, const Path& other) {
  const bool same = &path == &other;
  const Vec2 twice = path.front() + (same ? path.back() : other.front());
  double most = 0;
  for (const Vec2& x : path) most = std::max(most, distance_to(other, twice - x));
  return most;
}

/// A small circle as a line.
Trace ring(const Vec2& at, double radius) {
  constexpr int corners = 16;
  Trace t{.line = {}, .rgb = 0x202020, .width = 2};
  for (int k = 0; k <= corners; ++k)
    t.line.push_back(at + radius * Vec2(std::cos(2 * pi * k / corners), std::sin(2 * pi * k / corners)));
  return t;
}

}  // namespace

double read_path_number(const std::filesystem::path& folder, const std::string& where,
                        const std::vector<ManualReference>& references) {
  const std::size_t first = where.find(':'), second = where.find(':', first + 1);
  if (second == std::string::npos) no_place(where, "write path:CRACK:WHAT");
  const Shape shape = grown_in(folder).shape;
  const Path& path = path_named(shape, where.substr(first + 1, second - first - 1), where);
  const std::string what = where.substr(second + 1), of = what.substr(what.find(':') + 1);
  if (what == "length") return length_of(path);
  if (what.size() > 2 && what[1] == '@' && std::string("xys").find(what[0]) != std::string::npos)
    return coordinate(path, what, where);
  if (what.starts_with("turned:")) return turned(path, path_named(shape, of, where));
  if (!what.starts_with("to:")) no_place(where, "unknown " + quote(what));
  const auto reference = std::ranges::find(references, of, &ManualReference::name);
  if (reference == references.end()) no_place(where, "there is no reference " + quote(of));
  double most = 0;
  for (const Vec2& x : reference->points) most = std::max(most, distance_to(path, x));
  return most;
}

void draw_paths(const std::filesystem::path& png, const ManualEntry& entry,
                const std::vector<std::filesystem::path>& runs) {
  struct Color {
    const char* name;
    std::uint32_t rgb;
  };
  constexpr std::array<Color, 5> colors{
      {{"red", 0xc0392b}, {"blue", 0x2166ac}, {"green", 0x1b7837}, {"orange", 0xd95f02}, {"violet", 0x762a83}}};
  const Case body = grown_in(runs.front());
  const Shape& shape = body.shape;
  const Mesh mesh = triangulate(shape, body.sizing);
  Picture p{.title = entry.title, .subtitle = {}};
  p.points = mesh.points;
  p.triangles = mesh.triangles;
  p.solid = true;
  p.color = 0xe6ecf2;
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    if (mesh.sides[e][0] == none || mesh.sides[e][1] == none)
      p.outlines.push_back({mesh.points[static_cast<std::size_t>(mesh.edges[e][0])],
                            mesh.points[static_cast<std::size_t>(mesh.edges[e][1])]});
  const auto mention = [&p](const std::string& words) { p.subtitle += (p.subtitle.empty() ? "" : ", ") + words; };
  for (std::size_t k = 0; k < runs.size(); ++k) {
    if (!std::filesystem::exists(runs[k] / "grown.toml")) continue;  // a run of another kind
    const Color& color = colors[k % colors.size()];
    for (const Crack& crack : grown_in(runs[k]).shape.cracks) p.traces.push_back({crack.points, color.rgb, 3});
    mention(fmt::format("{}: {}", color.name, entry.runs[k].name.empty() ? "kerf" : entry.runs[k].name));
  }
  constexpr double radius = 0.006;  // of the extent
  for (const ManualReference& r : entry.references) {
    for (const Vec2& x : r.points) p.traces.push_back(ring(x, radius * extent(shape)));
    mention("rings: " + r.title);
  }
  draw(png, p);
}

}  // namespace kerf
