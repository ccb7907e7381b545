// The body against what is asked of it: mirrors, frozen parts and parts that stay void.

#include "geometry/plane.hpp"
#include "optimize/constraints/mirrored.hpp"
#include "optimize/constraints/sides.hpp"
#include "optimize/refuse.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

/// Points along all loops and cracks.
/// At most `step` apart; corners are among them.
std::vector<Vec2> points_along(const Shape& shape, double step) {
  std::vector<Vec2> out;
  const auto add = [&](const Vec2& a, const Vec2& b) {
    const int pieces = std::max(1, static_cast<int>(std::ceil((b - a).norm() / step)));
    for (int k = 0; k < pieces; ++k) out.push_back(a + (b - a) * k / pieces);
  };
  const auto add_loop = [&](const Loop& loop) {
    const Polygon p = flatten(loop, 1e-3 * step, step);
    for (std::size_t i = 0; i < p.points.size(); ++i) add(p.points[i], p.points[(i + 1) % p.points.size()]);
  };
  add_loop(shape.outline);
  for (const auto* loops : {&shape.holes, &shape.regions})
    for (const Loop& loop : *loops) add_loop(loop);
  for (const Crack& crack : shape.cracks) {
    if (crack.arc) {
      const int pieces = std::max(1, static_cast<int>(std::ceil(path_length(crack) / step)));
      const std::vector<Vec2> points = points_on(*crack.arc, pieces);
      out.insert(out.end(), points.begin(), points.end());
      continue;
    }
    for (std::size_t i = 0; i + 1 < crack.points.size(); ++i) add(crack.points[i], crack.points[i + 1]);
    out.push_back(crack.points.back());
  }
  return out;
}

}  // namespace

std::optional<std::string> wrong_mirror(const Shape& body, const Mirror& mirror) {
  if (!(std::abs(mirror.direction.norm() - 1) < 1e-9)) return "the direction of the mirror line must have length 1";
  // Each point's image lies near some other point, as near as they lie.
  const double size = extent(body), step = 0.005 * size;
  std::vector<Vec2> points = points_along(body, step);
  std::sort(points.begin(), points.end(), [](const Vec2& a, const Vec2& b) { return a.x() < b.x(); });
  for (const Vec2& x : points) {
    const Vec2 image = image_of(mirror, x);
    // Sorted by x: only points within a step of the image's x are looked at.
    auto near = std::lower_bound(points.begin(), points.end(), image.x() - step,
                                 [](const Vec2& p, double limit) { return p.x() < limit; });
    while (near != points.end() && near->x() < image.x() + step && !((*near - image).norm() < step)) ++near;
    if (near == points.end() || !(near->x() < image.x() + step))
      return fmt::format(
          "the body is not its own mirror image about that line: nothing is drawn at ({:.6g}, {:.6g}), "
          "the image of ({:.6g}, {:.6g})",
          image.x(), image.y(), x.x(), x.y());
  }
  return std::nullopt;
}

std::optional<std::string> wrong_mask(const Shape& body, const Loop& mask) {
  Shape alone;
  alone.outline = mask;
  if (auto problem = find_problem(alone)) {
    // The mask was drawn as an outline; its user calls it a border.
    const std::string blamed = "the outline";
    for (std::size_t at; (at = problem->find(blamed)) != std::string::npos;)
      problem->replace(at, blamed.size(), "its border");
    return fmt::format("region \"{}\": {}", mask.name, *problem);
  }
  if (find_problem(body)) return std::nullopt;  // which is what the user will hear of
  const double step = 0.005 * extent(body), own_step = 0.005 * extent(alone);
  Shape outline;
  outline.outline = body.outline;
  const std::vector<Vec2> border = points_along(outline, step), own = points_along(alone, own_step);
  const auto count = [](const std::vector<Vec2>& points, const std::vector<Vec2>& polygon) {
    return std::count_if(points.begin(), points.end(), [&](const Vec2& x) { return inside(polygon, x); });
  };
  // A part that surrounds the whole outline has all of its points inside.
  const auto in_mask = count(border, own);
  if (in_mask == 0 && count(own, border) == 0)
    return fmt::format("region \"{}\" lies outside the body: there is nothing to freeze", mask.name);
  if (in_mask == static_cast<std::ptrdiff_t>(border.size()))
    return fmt::format("region \"{}\" covers the whole body: nothing is left to design", mask.name);
  return std::nullopt;
}

std::optional<std::string> wrong_keep_out(const Shape& body, const Scene& scene, const Loop& keep_out) {
  Shape alone;
  alone.outline = keep_out;
  if (const auto problem = find_problem(alone))
    return fmt::format("keep_out \"{}\" is no region: {}", keep_out.name, *problem);
  if (find_problem(body)) return std::nullopt;  // which is what the user will hear of
  Shape rest;
  try {
    rest = without(body, keep_out);
  } catch (const Error& e) {
    return e.what();
  }
  if (rest.labels.size() == body.labels.size())
    return fmt::format("keep_out \"{}\" lies outside the body: there is nothing to keep out", keep_out.name);
  if (const auto problem = find_problem(rest))
    return fmt::format("keep_out \"{}\" leaves no body: {}", keep_out.name, *problem);
  constexpr int samples = 64;  // of a side
  const Region region(keep_out);
  const double near = 1e-9 * extent(body);
  for (const DrawnSide& side : sides_of(body)) {
    if (side.label == none) continue;
    for (int k = 0; k <= samples; ++k) {
      const double part = double(k) / samples;
      const Vec2 x = at(side, part), t = tangent(side, part), outwards(t.y(), -t.x());
      if (region.depth(x) <= near) continue;
      const bool held = std::ranges::any_of(scene.supports, [&](const Support& s) { return s.label == side.label; });
      const bool loaded = std::ranges::any_of(scene.tractions, [&](const Traction& t) {
        return t.label == side.label && t.value && t.value(x, outwards).norm() > 0;
      });
      if (held || loaded)
        return fmt::format("keep_out \"{}\" takes away a part of \"{}\", which is {}, at ({:.6g}, {:.6g})",
                           keep_out.name, body.labels[std::size_t(side.label)], held ? "held" : "loaded", x.x(), x.y());
    }
  }
  return std::nullopt;
}

}  // namespace kerf
