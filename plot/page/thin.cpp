// Meshes for the page: triangles become fewer by moving a vertex inside the body into a neighbor, which removes two of
// them. Among the neighbors the one is taken that leaves the best worst shape, twice the area over the square of the
// longest side; no move that leaves less than 0.2, then 0.1, 0.05 and 0.02 is made. In a pass neighbors of a vertex
// that went stay, so that the grading of the mesh stays, too. Fixed are corners of outlines, borders and cracks and
// those where the von Mises stress or the map is least or largest. Values at the vertices that are left are those of
// the mesh, and so are these extremes.

#include "plot/page.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace kerf {

namespace {

using Triangle = std::array<std::uint32_t, 3>;

/// Triangles in the plane that lose vertices, one into a neighbor at a time.
class Mesh2 {
 public:
  Mesh2(const std::vector<float>& points, std::vector<Triangle> triangles, std::vector<bool> fixed)
      : points_(points), triangles_(std::move(triangles)), fixed_(std::move(fixed)), alive_(triangles_.size()) {
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) of_.push_back(t);
  }

  /// Every vertex at most once, and no two neighbors: what is left is as finely graded as before. No triangle is made
  /// whose shape is not better than `good`. Whether any vertex went.
  bool pass(std::size_t at_most, double good) {
    list_fans();
    std::vector<bool> locked(fixed_.size(), false);
    const std::size_t before = alive_;
    for (std::uint32_t v = 0; v < fixed_.size() && alive_ > at_most; ++v)
      if (!fixed_[v] && !locked[v] && first_[v + 1] > first_[v]) remove(v, good, locked);
    std::size_t kept = 0;
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      if (triangles_[t][0] == triangles_[t][1]) continue;  // gone
      triangles_[kept] = triangles_[t];
      of_[kept++] = of_[t];
    }
    triangles_.resize(kept);
    of_.resize(kept);
    return alive_ < before;
  }

  std::size_t size() const {
    return alive_;
  }
  const std::vector<Triangle>& triangles() const {
    return triangles_;
  }
  /// The numbers that they had at first.
  const std::vector<std::uint32_t>& of() const {
    return of_;
  }

 private:
  void list_fans() {
    first_.assign(fixed_.size() + 1, 0);
    for (const Triangle& t : triangles_)
      for (const std::uint32_t v : t) ++first_[v + 1];
    for (std::size_t v = 0; v < fixed_.size(); ++v) first_[v + 1] += first_[v];
    fan_.resize(3 * triangles_.size());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t t = 0; t < triangles_.size(); ++t)
      for (const std::uint32_t v : triangles_[t]) fan_[next[v]++] = t;
  }

  double x(std::uint32_t v) const {
    return points_[2 * v];
  }
  double y(std::uint32_t v) const {
    return points_[2 * v + 1];
  }
  /// Twice the area over the square of the longest side.
  double shape(const Triangle& t) const {
    const auto [a, b, c] = t;
    const double twice = (x(b) - x(a)) * (y(c) - y(a)) - (x(c) - x(a)) * (y(b) - y(a));
    double longest = 0;
    for (const auto& [p, q] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
      longest = std::max(longest, (x(p) - x(q)) * (x(p) - x(q)) + (y(p) - y(q)) * (y(p) - y(q)));
    return longest > 0 ? twice / longest : 0;
  }

  void remove(std::uint32_t v, double good, std::vector<bool>& locked) {
    const auto begin = fan_.begin() + first_[v], end = fan_.begin() + first_[v + 1];
    std::vector<std::uint32_t> ring;
    for (auto t = begin; t != end; ++t)
      for (const std::uint32_t w : triangles_[*t])
        if (w != v && std::find(ring.begin(), ring.end(), w) == ring.end()) ring.push_back(w);
    if (ring.size() != static_cast<std::size_t>(end - begin)) return;  // of the boundary
    std::uint32_t into = v;
    double best = good;
    for (const std::uint32_t w : ring) {
      double worst = 1;
      for (auto t = begin; t != end && worst > best; ++t) {
        Triangle moved = triangles_[*t];
        if (std::find(moved.begin(), moved.end(), w) != moved.end()) continue;
        std::replace(moved.begin(), moved.end(), v, w);
        worst = std::min(worst, shape(moved));
      }
      if (worst > best) {
        best = worst;
        into = w;
      }
    }
    if (into == v) return;
    for (auto t = begin; t != end; ++t) {
      Triangle& own = triangles_[*t];
      if (std::find(own.begin(), own.end(), into) != own.end()) {
        own = {0, 0, 0};
        --alive_;
      } else {
        std::replace(own.begin(), own.end(), v, into);
      }
    }
    for (const std::uint32_t w : ring) locked[w] = true;
  }

  const std::vector<float>& points_;
  std::vector<Triangle> triangles_;
  std::vector<bool> fixed_;
  std::size_t alive_;
  std::vector<std::uint32_t> of_, first_, fan_;  // the triangles of vertex v are fan_[first_[v]] .. fan_[first_[v + 1]]
};

NamedArray* find(std::vector<NamedArray>& arrays, std::string_view name) {
  const auto found = std::find_if(arrays.begin(), arrays.end(), [&](const NamedArray& a) { return a.name == name; });
  return found == arrays.end() ? nullptr : &*found;
}

/// The rows of these numbers.
void take(NamedArray& a, const std::vector<std::uint32_t>& rows) {
  NamedArray out{.name = a.name, .width = a.width};
  for (const std::uint32_t row : rows)
    for (std::size_t k = 0; k < a.width; ++k) {
      if (a.is_indices())
        out.indices.push_back(a.indices[row * a.width + k]);
      else
        out.numbers.push_back(a.numbers[row * a.width + k]);
    }
  a = std::move(out);
}

constexpr const char* pairs[] = {"outline", "interfaces", "cracks"};

/// Lines stay, and so do the corners where a field is least or largest.
std::vector<bool> fixed_corners(const std::vector<NamedArray>& arrays, std::size_t count) {
  std::vector<bool> fixed(count, false);
  for (const char* name : pairs)
    if (const NamedArray* a = find_array(arrays, name))
      for (const std::uint32_t c : a->indices) fixed[c] = true;
  for (const char* name : {"von_mises", "map"}) {
    const NamedArray* a = find_array(arrays, name);
    if (!a || a->numbers.size() != count || count == 0) continue;
    const auto [least, most] = std::minmax_element(a->numbers.begin(), a->numbers.end());
    fixed[static_cast<std::size_t>(least - a->numbers.begin())] = true;
    fixed[static_cast<std::size_t>(most - a->numbers.begin())] = true;
  }
  return fixed;
}

}  // namespace

void thin(std::vector<NamedArray>& arrays, std::size_t at_most) {
  NamedArray *points = find(arrays, "points"), *triangles = find(arrays, "triangles");
  if (!points || !triangles || triangles->rows() <= at_most) return;
  const std::size_t corners = points->rows(), count = triangles->rows();
  std::vector<Triangle> all(count);
  for (std::size_t t = 0; t < count; ++t)
    for (std::size_t k = 0; k < 3; ++k) all[t][k] = triangles->indices[3 * t + k];
  Mesh2 mesh(points->numbers, std::move(all), fixed_corners(arrays, corners));
  for (const double good : {0.2, 0.1, 0.05, 0.02})  // shapes as good as will do
    while (mesh.size() > at_most && mesh.pass(at_most, good)) {
    }
  std::vector<std::uint32_t> kept, number(corners, 0);
  std::vector<bool> used(corners, false);
  for (const Triangle& t : mesh.triangles())
    for (const std::uint32_t v : t) used[v] = true;
  for (std::uint32_t v = 0; v < corners; ++v)
    if (used[v]) {
      number[v] = static_cast<std::uint32_t>(kept.size());
      kept.push_back(v);
    }
  for (const char* name : pairs)
    if (NamedArray* a = find(arrays, name))
      for (std::uint32_t& c : a->indices) c = number[c];
  for (const char* name : {"points", "u", "stress", "von_mises", "map", "lower", "upper", "margin", "near", "left_out"})
    if (NamedArray* a = find(arrays, name); a && a->rows() == corners) take(*a, kept);
  for (const char* name : {"error_indicator", "angle"})
    if (NamedArray* a = find(arrays, name); a && a->rows() == count) take(*a, mesh.of());
  triangles->indices.clear();
  for (const Triangle& t : mesh.triangles())
    for (const std::uint32_t v : t) triangles->indices.push_back(number[v]);
}

}  // namespace kerf
