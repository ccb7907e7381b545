// Narrow gaps: for points along the sides and cracks, the nearest piece that faces them across the body.
// For points along every strand, and for corners and tips, the nearest strand across the body within twice the mesh
// size asks for `across` edges over the width between them. Two sides face each other if the way across makes an angle
// below 45 degrees with the normal of the one and below 60 with that of the other; strands that share a corner make an
// angle and no gap. Stretches are halved until they are shorter than 1.5 widths, so that a wedge of a gap is seen where
// it is narrow. Targets are filed in cells as wide as the search reaches.

#include "geometry/mesher/size_field.hpp"
#include "geometry/plane/cells.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr std::size_t max_samples = 200000;
constexpr double leaving = 0.7;   // least cosine between the normal of the one side and the way across
constexpr double arriving = 0.5;  // and of the other

Vec2 left(const Vec2& d) {
  return {-d.y(), d.x()};
}

/// A piece of a strand.
struct Target {
  Index strand;
  bool tip_a, tip_b;  // free ends of a crack face every way
};

struct Gap {
  double width = infinity;
  Vec2 across = Vec2::Zero();
  Index strand = none;
};

/// Pieces in cells as wide as the search reaches, so that nine cells are enough.
struct Targets {
  std::vector<Target> all;
  std::vector<std::array<Vec2, 2>> segments;
  Cells cells;
};

int even_pieces(const Drawing& drawing, const Strand& strand, double longest) {
  if (!strand.arc) {
    const double length = (drawing.corners[std::size_t(strand.to)] - drawing.corners[std::size_t(strand.from)]).norm();
    return int(std::clamp(std::ceil(length / longest), 1.0, 1e6));
  }
  const double angle = std::abs(strand.arc->to - strand.arc->from);
  return int(std::clamp(std::ceil(angle * std::max(largest_radius(*strand.arc) / longest, 16 / pi)), 1.0, 1e6));
}

/// A piece is at most as long as the search reaches, so that it lies in few cells.
Targets targets_of(const Drawing& drawing, const std::vector<bool>& tip, double reach) {
  Targets targets;
  for (std::size_t k = 0; k < drawing.strands.size(); ++k) {
    const Strand& strand = drawing.strands[k];
    const int count = even_pieces(drawing, strand, reach);
    for (int i = 0; i < count; ++i) {
      targets.segments.push_back(
          {point(drawing, strand, double(i) / count), point(drawing, strand, double(i + 1) / count)});
      targets.all.push_back(
          {Index(k), i == 0 && tip[std::size_t(strand.from)], i + 1 == count && tip[std::size_t(strand.to)]});
    }
  }
  targets.cells = file(targets.segments, reach, 0, 1000);
  return targets;
}

/// A point that looks across the body.
struct Look {
  Vec2 x, normal;       // zero: every way
  Index from;           // its strand
  Index corner = none;  // where it lies, if on one
};

/// Whether a strand makes a gap with that of the point: those that share a corner make an angle.
bool faces(const Drawing& drawing, const Look& look, Index strand) {
  const Strand &own = drawing.strands[std::size_t(look.from)], &other = drawing.strands[std::size_t(strand)];
  if (look.corner != none) return other.from != look.corner && other.to != look.corner;
  // Cracks and regions have short edges where they face themselves.
  if (strand == look.from) return own.arc && own.loop != none;
  return other.from != own.from && other.from != own.to && other.to != own.from && other.to != own.to;
}

/// The nine cells around the point hold every piece within the reach, as cells are that wide.
Gap nearest(const Drawing& drawing, const Targets& targets, const Look& look, double reach) {
  const Vec2& x = look.x;
  Gap best{.width = reach};
  const Cells& cells = targets.cells;
  const int c = cells.column(x.x()), r = cells.row(x.y());
  for (int j = std::max(0, r - 1); j <= std::min(cells.rows - 1, r + 1); ++j)
    for (int i = std::max(0, c - 1); i <= std::min(cells.columns - 1, c + 1); ++i)
      for (const Index t : cells.at(i, j)) {
        const Target& target = targets.all[std::size_t(t)];
        const auto& [a, b] = targets.segments[std::size_t(t)];
        const Vec2 d = b - a;
        const double s = foot(x, a, b);
        const Vec2 y = a + s * d;
        const double width = (y - x).norm();
        if (!(width < best.width) || width == 0 || !faces(drawing, look, target.strand)) continue;
        if (look.normal != Vec2::Zero() && look.normal.dot(y - x) < leaving * width) continue;
        const bool tip = (s == 0 && target.tip_a) || (s == 1 && target.tip_b);
        const double turned = left(d).dot(x - y) / d.norm();
        const bool both = drawing.strands[std::size_t(target.strand)].loop == none;  // sides face the body
        if (!tip && (both ? std::abs(turned) : turned) < arriving * width) continue;
        best = {width, y, target.strand};
      }
  return best;
}

}  // namespace

/// `limit` stops a gap that is far thinner than long before it fills the memory: the message names both sides.
void add_gaps(const Shape& shape, const Drawing& drawing, const std::vector<Ligament>& ligaments, double size,
              double across, std::vector<Source>& sources) {
  const double reach = 2 * size;
  std::vector<int> degree(drawing.corners.size(), 0);
  std::vector<bool> tip(drawing.corners.size(), false);
  for (const Strand& strand : drawing.strands) {
    ++degree[std::size_t(strand.from)];
    ++degree[std::size_t(strand.to)];
  }
  for (std::size_t v = 0; v < degree.size(); ++v) tip[v] = degree[v] == 1;
  const std::vector<bool> reentrant = reentrant_corners(drawing);
  const Targets targets = targets_of(drawing, tip, reach);

  const std::size_t limit = sources.size() + max_samples + targets.all.size();
  const auto use = [&](const Vec2& x, const Gap& gap, Index from) {
    if (gap.strand == none) return;
    sources.push_back({x, gap.across, gap.width / across});
    if (sources.size() > limit)
      throw Error(Fault::Geometry,
                  fmt::format("the gap between {} and {} at ({:.6g}, {:.6g}) is only {:.3g} wide over a long stretch: "
                              "more triangles than can be meshed; widen or close it",
                              name(shape, drawing.strands[std::size_t(from)]),
                              name(shape, drawing.strands[std::size_t(gap.strand)]), x.x(), x.y(), gap.width));
  };

  for (std::size_t k = 0; k < drawing.strands.size(); ++k) {
    const Strand& strand = drawing.strands[k];
    for (const Index corner : {strand.from, strand.to}) {
      if (strand.loop != none && !reentrant[std::size_t(corner)]) continue;
      const Vec2& x = drawing.corners[std::size_t(corner)];
      // Both strands of an inner corner ask: the same answer twice does no harm.
      use(x, nearest(drawing, targets, {x, Vec2::Zero(), Index(k), corner}, reach), Index(k));
    }
    const int count = even_pieces(drawing, strand, size);
    std::vector<std::array<double, 2>> open;
    for (int i = count - 1; i >= 0; --i) open.push_back({double(i) / count, double(i + 1) / count});
    while (!open.empty()) {
      const auto [from, to] = open.back();
      open.pop_back();
      const Vec2 x = point(drawing, strand, (from + to) / 2);
      const Vec2 along = point(drawing, strand, to) - point(drawing, strand, from);
      const Vec2 normal = left(along).normalized();
      double width = reach;
      for (const double sign : {1.0, -1.0}) {
        if (sign < 0 && strand.loop != none) break;  // a side faces the body on its left only
        const Gap gap = nearest(drawing, targets, {x, sign * normal, Index(k)}, reach);
        if (in_ligament(ligaments, Index(k), gap.strand, from, to)) continue;
        const double middle = (from + to) / 2;
        if (!in_ligament(ligaments, Index(k), gap.strand, middle, middle)) use(x, gap, Index(k));
        width = std::min(width, gap.width);
      }
      if (along.norm() > 1.5 * width) {
        const double middle = (from + to) / 2;
        open.push_back({middle, to});
        open.push_back({from, middle});
      }
    }
  }
}

}  // namespace kerf
