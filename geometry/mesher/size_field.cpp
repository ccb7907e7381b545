// The target edge length h(x) = min(cap, background, min over sources of size + grading d), d the distance to the
// source, and its queries. Sources lie in a quadtree whose leaves list those that can be the least one somewhere in
// their square: with the square's center c and r = grading times half its diagonal, a source s is kept if h_s(c) - r is
// below the least h_t(c) + r. A background of sizes at the vertices of a mesh is linear on its triangles and is first
// made to grow by the grading at most along every edge (a shortest path computation, each vertex settled once). Edges
// that are kept raise h beside them:
//   h >= length - .5 d,   so that no point of the mesh crowds them.

#include "geometry/mesher/size_field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <queue>

namespace kerf {

namespace {

constexpr std::size_t few = 4;     // a square with no more sources is a leaf
constexpr std::size_t many = 12;   // no leaf lists more
constexpr int max_depth = 40;      // of the quadtree
constexpr double steepness = 0.5;  // with which the target falls away from an edge that is kept

/// Within the reach: not above cap (d/reach)^.8, which for stresses like d^-1/2 spreads the error evenly.
double size_of(const SizeField& field, const Source& s, const Vec2& x) {
  const double d = distance(x, s.a, s.b), linear = s.size + field.grading * d;
  if (d >= s.reach) return linear;
  return std::min(linear, std::max(s.size, field.cap * std::pow(d / s.reach, 0.8)));
}

struct QuadtreeSquare {
  Vec2 low;
  double width;
  int depth = 0;
};

/// Fills the node of a square with what of the candidates can be the least one somewhere in it.
void grow(SizeField& field, std::size_t node, const QuadtreeSquare& square, const std::vector<Index>& candidates) {
  const double width = square.width;
  const Vec2 center = square.low.array() + width / 2;
  const double reach = field.grading * width / std::numbers::sqrt2;  // h changes no more from the center to a corner
  double upper = field.cap;
  std::vector<double> value;
  value.reserve(candidates.size());
  for (const Index s : candidates) {
    value.push_back(size_of(field, field.sources[std::size_t(s)], center));
    upper = std::min(upper, value.back() + reach);
  }
  std::vector<Index> kept;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (value[i] - reach < upper) kept.push_back(Index(i));
  // Squares as small as the edges themselves need no sharper answer than the few sources that matter most.
  const bool small = width < upper || square.depth == max_depth;
  if (kept.size() <= few || small) {
    if (kept.size() > many) {
      std::partial_sort(kept.begin(), kept.begin() + many, kept.end(), [&](Index i, Index j) {
        return std::pair(value[std::size_t(i)], i) < std::pair(value[std::size_t(j)], j);
      });
      kept.resize(many);
    }
    for (Index& i : kept) i = candidates[std::size_t(i)];
    field.nodes[node].first = Index(field.listed.size());
    field.nodes[node].count = Index(kept.size());
    field.listed.insert(field.listed.end(), kept.begin(), kept.end());
    return;
  }
  for (Index& i : kept) i = candidates[std::size_t(i)];
  const std::size_t child = field.nodes.size();
  field.nodes[node].child = Index(child);
  field.nodes.resize(child + 4);
  for (int q = 0; q < 4; ++q)
    grow(field, child + std::size_t(q), {square.low + width / 2 * Vec2(q & 1, q >> 1), width / 2, square.depth + 1},
         kept);
}

/// Lowers sizes until none exceeds a neighbor's by more than grading times the edge: in the order of the sizes, so
/// that each vertex is settled once.
void limit_growth(const Mesh& mesh, double grading, std::vector<double>& size) {
  std::vector<Index> start(mesh.points.size() + 1, 0), edge(2 * mesh.edges.size());
  for (const auto& e : mesh.edges)
    for (const Index v : e) ++start[std::size_t(v) + 1];
  for (std::size_t v = 0; v + 1 < start.size(); ++v) start[v + 1] += start[v];
  std::vector<Index> fill(start.begin(), start.end() - 1);
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    for (const Index v : mesh.edges[e]) edge[std::size_t(fill[std::size_t(v)]++)] = Index(e);
  using Entry = std::pair<double, Index>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  const auto pass_on = [&](std::size_t v) {
    for (Index i = start[v]; i < start[v + 1]; ++i) {
      const Index e = edge[std::size_t(i)];
      const auto [a, b] = mesh.edges[std::size_t(e)];
      const std::size_t other = std::size_t(std::size_t(a) == v ? b : a);
      const double most = size[v] + grading * length(mesh, e);
      if (!(size[other] > most * (1 + 1e-12))) continue;
      size[other] = most;
      open.push({most, Index(other)});
    }
  };
  for (std::size_t v = 0; v < size.size(); ++v) pass_on(v);
  while (!open.empty()) {
    const auto [h, v] = open.top();
    open.pop();
    if (h == size[std::size_t(v)]) pass_on(std::size_t(v));
  }
}

/// Linear in the triangle that contains x; beyond the boundary the value at the nearest point.
double background_at(const SizeField& field, const Vec2& x) {
  const Mesh& mesh = *field.background;
  Index t = locate(mesh, field.locator, x);
  Vec2 y = x;
  if (t == none) {
    t = nearest_triangle(mesh, field.locator, x);
    double least = infinity;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& v = mesh.triangles[std::size_t(t)];
      const Vec2 &a = mesh.points[std::size_t(v[i])], &b = mesh.points[std::size_t(v[(i + 1) % 3])];
      const Vec2 nearest = a + foot(x, a, b) * (b - a);
      if ((nearest - x).squaredNorm() >= least) continue;
      least = (nearest - x).squaredNorm();
      y = nearest;
    }
  }
  const auto& [a, b, c] = mesh.triangles[std::size_t(t)];
  const Vec2 &p = mesh.points[std::size_t(a)], &q = mesh.points[std::size_t(b)], &r = mesh.points[std::size_t(c)];
  const double whole = cross(q - p, r - p), in_b = cross(y - p, r - p) / whole, in_c = cross(q - p, y - p) / whole;
  const double ha = field.at_vertex[std::size_t(a)], hb = field.at_vertex[std::size_t(b)],
               hc = field.at_vertex[std::size_t(c)];
  return std::clamp(ha + in_b * (hb - ha) + in_c * (hc - ha), std::min({ha, hb, hc}), std::max({ha, hb, hc}));
}

/// Whether an edge that is kept may raise the size within the distance of x.
bool beside_kept(const SizeField& field, const Vec2& x, double distance) {
  return !field.kept.empty() && (x.array() + distance > field.kept_low.array()).all() &&
         (x.array() - distance < field.kept_high.array()).all();
}

}  // namespace

SizeField size_field(std::vector<Source> sources, double cap, double grading, const Vec2& low, const Vec2& high) {
  SizeField field{.cap = cap,
                  .grading = grading,
                  .sources = std::move(sources),
                  .low = low,
                  .width = (high - low).maxCoeff(),
                  .nodes = std::vector<SizeField::Node>(1)};
  std::vector<Index> all(field.sources.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = Index(i);
  grow(field, 0, {field.low, field.width}, all);
  return field;
}

void add_background(SizeField& field, const Background& background, double least) {
  const Mesh& mesh = *background.mesh;
  if (background.size.size() != mesh.points.size() || mesh.triangles.empty())
    throw std::invalid_argument(fmt::format("a background of {} sizes for a mesh of {} vertices and {} triangles",
                                            background.size.size(), mesh.points.size(), mesh.triangles.size()));
  field.at_vertex = background.size;
  for (double& h : field.at_vertex) {
    if (!(h > 0)) throw std::invalid_argument(fmt::format("the background has a size of {}; it must be positive", h));
    h = std::clamp(h, least, field.cap);
  }
  limit_growth(mesh, field.grading, field.at_vertex);
  field.cap = *std::max_element(field.at_vertex.begin(), field.at_vertex.end());
  field.background = &mesh;
  field.locator = make_locator(mesh);
}

/// Only edges that the rest would have shorter need room: for the others the field is right as it is.
void add_kept(SizeField& field, const Drawing& drawing) {
  std::vector<Source> kept;
  for (const Strand& strand : drawing.strands) {
    if (!strand.keep) continue;
    const double side = length(drawing, strand);
    double wanted = side;
    for (const double s : {0.0, 0.5, 1.0}) wanted = std::min(wanted, size_at(field, point(drawing, strand, s)));
    if (wanted < side * (1 - 1e-9)) kept.push_back({point(drawing, strand, 0), point(drawing, strand, 1), side});
  }
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const Source& k = kept[i];
    const Vec2 low = k.a.cwiseMin(k.b).array() - k.size / steepness,
               high = k.a.cwiseMax(k.b).array() + k.size / steepness;
    field.kept_low = i == 0 ? low : field.kept_low.cwiseMin(low);
    field.kept_high = i == 0 ? high : field.kept_high.cwiseMax(high);
  }
  field.kept = std::move(kept);
}

double largest_size(const SizeField& field, const Vec2& x, double distance) {
  double largest = field.cap;
  if (beside_kept(field, x, distance))
    for (const Source& k : field.kept) largest = std::max(largest, k.size);
  return largest;
}

double steepest(const SizeField& field, const Vec2& x, double distance) {
  return beside_kept(field, x, distance) ? std::max(field.grading, steepness) : field.grading;
}

/// Down the quadtree by doubling the coordinates within the square: no square's box is stored.
double size_at(const SizeField& field, const Vec2& x) {
  const SizeField::Node* node = field.nodes.data();
  Vec2 local = (x - field.low) / field.width;
  while (node->child != none) {
    local *= 2;
    const int right = local.x() >= 1, top = local.y() >= 1;
    local -= Vec2(right, top);
    node = &field.nodes[std::size_t(node->child + right + 2 * top)];
  }
  double h = field.background ? std::min(field.cap, background_at(field, x)) : field.cap;
  for (Index i = 0; i < node->count; ++i)
    h = std::min(h, size_of(field, field.sources[std::size_t(field.listed[std::size_t(node->first + i)])], x));
  if (beside_kept(field, x, 0))
    for (const Source& k : field.kept) h = std::max(h, k.size - steepness * distance(x, k.a, k.b));
  return h;
}

}  // namespace kerf
