// Narrow gaps: for points along the sides and cracks, the nearest piece that faces them across the body.
// For points along every strand, and for corners and tips, the nearest strand across the body within twice the mesh
// size asks for `across` edges over the width between them. Two sides face each other if the way across makes an angle
// below 45 degrees with the normal of the one and below 60 with that of the other; strands that share a corner make an
// angle and no gap. Stretches are halved until they are shorter than 1.5 widths, so that a wedge of a gap is seen where
// it is narrow. Targets are filed in cells as wide as the search reaches.

#include "geometry/boxes.hpp"
#include "geometry/mesher/size_field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace kerf {

namespace {

constexpr std::size_t max_samples = 200000, samples_per_piece = 4;
constexpr double leaving = 0.7;   // least cosine between the normal of the one side and the way across
constexpr double arriving = 0.5;  // and of the other
constexpr double leaving_sine = 0.71414284285428498;  // that belongs to the cosine

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

struct Targets {
  std::vector<Target> all;
  std::vector<std::array<Vec2, 2>> segments;
  BoxTree tree;
  std::vector<Index> of_box;  // the target of each box: long ones askew have boxes for their parts, thin enough to tell
                              // the teeth of a comb or a star apart
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
  std::vector<AxisBox> boxes;
  const double thin = drawing.extent / std::sqrt(double(targets.all.size()));
  for (std::size_t t = 0; t < targets.all.size(); ++t) {
    const auto& [a, b] = targets.segments[t];
    const int count = int(std::clamp(std::ceil((b - a).cwiseAbs().minCoeff() / thin), 1.0, 64.0));
    for (int i = 0; i < count; ++i) {
      const AxisBox box = box_around(a + (b - a) * i / count, a + (b - a) * (i + 1) / count);
      boxes.push_back(box.grown(touch_tolerance * drawing.extent));  // more than rounding
      targets.of_box.push_back(Index(t));
    }
  }
  targets.tree = BoxTree(boxes);
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
  const Vec2 &x = look.x, n = look.normal;
  const bool every_way = n == Vec2::Zero();
  // A box is in sight if some of it lies on the inner side of both flanks of the cone.
  const Vec2 one = leaving_sine * n + leaving * left(n), other = leaving_sine * n - leaving * left(n);
  const double slack = 1e-9 * reach, at_one = one.dot(x) - slack, at_other = other.dot(x) - slack;
  const auto in_sight = [&](const AxisBox& box) {
    return every_way || (box.farthest(one) >= at_one && box.farthest(other) >= at_other);
  };
  Gap best{.width = reach};
  std::tuple<double, double, Index> nearest_place{-infinity, 0, none};
  targets.tree.each_near(x, best.width, in_sight, [&](Index i) {
    const Index t = targets.of_box[std::size_t(i)];
    const Target& target = targets.all[std::size_t(t)];
    const auto& [a, b] = targets.segments[std::size_t(t)];
    const Vec2 d = b - a;
    const double s = foot(x, a, b);
    const Vec2 y = a + s * d;
    constexpr double rounding = 1 + 1e-12;
    if ((y - x).squaredNorm() > best.width * best.width * rounding) return;
    const double width = (y - x).norm();
    const std::tuple place(y.y(), y.x(), t);  // whatever the order of the visits
    if (width > best.width || (width == best.width && !(place < nearest_place)) || width == 0 ||
        !faces(drawing, look, target.strand))
      return;
    if (!every_way && n.dot(y - x) < leaving * width) return;
    const bool tip = (s == 0 && target.tip_a) || (s == 1 && target.tip_b);
    const double turned = left(d).dot(x - y) / d.norm();
    const bool both = drawing.strands[std::size_t(target.strand)].loop == none;  // sides face the body
    if (!tip && (both ? std::abs(turned) : turned) < arriving * width) return;
    best = {width, y, target.strand};
    nearest_place = place;
  });
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

  const std::size_t limit = sources.size() + max_samples + samples_per_piece * targets.all.size();
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
