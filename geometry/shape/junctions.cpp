// Where cracks meet one another, and the borders of regions: shared ends, ends and kinks on a strand, crossings.
// In three steps: corners of two cracks within 1e-6 of the extent become one; ends and kinks near a strand of another
// crack are moved onto it and cut it; strands that cross cut each other at a new corner, unless a corner is there
// already. Crossings of lines and circles are computed directly, those of an arc and an ellipse by bisection between
// samples. Corners on loops and of regions never move. The result is cut strands that share corners.

#include "geometry/shape/drawing.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

namespace kerf {

namespace {

constexpr double least_sine = 0.017;  // find_problem refuses cracks that meet at less than a degree

/// Where two strands cross.
/// s on the first, t on the second, both from 0 to 1.
struct Crossing {
  double s, t;
  Vec2 at;
};

struct Joiner {
  Drawing& drawing;
  const double join;  // corners nearer than this are one
  std::size_t first;  // strand that is no side of a loop
  const std::function<bool(const Strand&, const Strand&)>& meet;
  std::vector<bool> fixed;                   // per corner: on a loop, or moved already
  std::vector<std::vector<StrandCut>> cuts;  // per strand, counted from `first`

  const Strand& strand(std::size_t k) const {
    return drawing.strands[first + k];
  }
  const Vec2& at(Index corner) const {
    return drawing.corners[std::size_t(corner)];
  }
  bool has(std::size_t k, Index corner) const {
    return strand(k).from == corner || strand(k).to == corner ||
           std::any_of(cuts[k].begin(), cuts[k].end(), [&](const StrandCut& cut) { return cut.corner == corner; });
  }
  template <class Visit>
  void each_corner(std::size_t k, Visit&& visit) const {
    visit(strand(k).from);
    visit(strand(k).to);
    for (const StrandCut& cut : cuts[k]) visit(cut.corner);
  }
  /// Its ends; the seam of a whole circle is no corner.
  std::vector<Index> ends(std::size_t k) const {
    if (whole(strand(k))) return {};
    return {strand(k).from, strand(k).to};
  }
};

/// Pairs of strands whose boxes meet, in an order that depends on the drawing alone.
template <class Visit>
void each_pair(const Joiner& j, Visit&& visit) {
  std::vector<AxisBox> boxes;
  for (std::size_t k = 0; k < j.cuts.size(); ++k) boxes.push_back(box_of(j.drawing, j.strand(k)).grown(j.join));
  const BoxTree tree(boxes);
  std::vector<std::vector<Index>> later;  // before any visit, which may move corners
  for (std::size_t k = 0; k < boxes.size(); ++k) {
    later.push_back(tree.meeting(boxes[k]));
    std::erase_if(later.back(),
                  [&](Index l) { return std::size_t(l) <= k || !j.meet(j.strand(std::size_t(l)), j.strand(k)); });
  }
  for (std::size_t k = 0; k < later.size(); ++k)
    for (const Index l : later[k]) visit(k, std::size_t(l));
}

/// One corner for those of two cracks that coincide: the one on a loop, or the earlier one.
void merge_corners(Joiner& j) {
  std::vector<Index> next(j.drawing.corners.size());  // on the way to the one that stands for it
  std::iota(next.begin(), next.end(), Index(0));
  const auto instead = [&](Index v) {
    while (next[std::size_t(v)] != v) v = next[std::size_t(v)] = next[std::size_t(next[std::size_t(v)])];
    return v;
  };
  each_pair(j, [&](std::size_t k, std::size_t l) {
    for (const Index given : j.ends(k))
      for (const Index other : j.ends(l)) {
        const Index a = instead(given), b = instead(other);
        if (a == b || (j.at(given) - j.at(other)).norm() > j.join) continue;
        const bool keep_b = j.fixed[std::size_t(b)] && !j.fixed[std::size_t(a)];
        next[std::size_t(keep_b ? a : b)] = keep_b ? b : a;
      }
  });
  for (std::size_t k = 0; k < j.cuts.size(); ++k) {
    Strand& strand = j.drawing.strands[j.first + k];
    strand.from = instead(strand.from);
    strand.to = instead(strand.to);
  }
}

/// Ends and kinks that lie on a strand of another crack cut it. They are moved onto it, unless they are fixed.
void cut_at_corners(Joiner& j) {
  each_pair(j, [&](std::size_t a, std::size_t b) {
    for (const auto& [k, l] : {std::pair(a, b), std::pair(b, a)})
      for (const Index v : j.ends(k)) {
        if (j.has(l, v)) continue;
        const Foot foot = nearest(j.drawing, j.strand(l), j.at(v));
        if (!(foot.distance <= j.join)) continue;
        j.cuts[l].push_back({foot.s, v});
        if (!j.fixed[std::size_t(v)] && foot.distance > 1e-13 * j.drawing.extent)
          j.drawing.corners[std::size_t(v)] = point(j.drawing, j.strand(l), foot.s);
        j.fixed[std::size_t(v)] = true;
      }
  });
}

bool is_circle(const Arc& arc) {
  return largest_radius(arc) - smallest_radius(arc) <= 1e-9 * largest_radius(arc);
}

/// s of the point x of the arc's circle or ellipse, or a number outside [0, 1].
double place_on_arc(const Arc& arc, const Vec2& x) {
  const double turn = arc.to - arc.from;
  if (is_circle(arc)) return 0.5 + beyond_middle(arc, x) / turn;
  return 0.5 + std::remainder(parameter(arc, x) - arc.from - turn / 2, 2 * pi) / turn;
}

/// s of a strand where it crosses an ellipse that is no circle: where |A^-1 (x - center)| = 1.
std::vector<double> crossings_of_ellipse(const Drawing& drawing, const Strand& p, const Arc& ellipse) {
  const auto round = [&](const Vec2& x) {  // A^-1 (x - center)
    const Vec2 d = x - ellipse.center, p = ellipse.axes.col(0), q = ellipse.axes.col(1);
    return Vec2(cross(d, q) / cross(p, q), cross(p, d) / cross(p, q));
  };
  if (!p.arc) {
    const Vec2 a = round(drawing.corners[std::size_t(p.from)]), d = round(drawing.corners[std::size_t(p.to)]) - a;
    const double s = -a.dot(d) / d.squaredNorm(), height = (a + s * d).norm();
    if (height >= 1) return {};
    const double half = std::sqrt((1 - height) * (1 + height)) / d.norm();
    return {s - half, s + half};
  }
  constexpr int samples = 256, steps = 60;
  const auto outside = [&](double s) { return round(point(drawing, p, s)).squaredNorm() > 1; };
  std::vector<double> found;
  for (int i = 0; i < samples; ++i) {
    double low = double(i) / samples, high = double(i + 1) / samples;
    const bool before = outside(low);
    if (before == outside(high)) continue;
    for (int step = 0; step < steps; ++step) {
      const double middle = (low + high) / 2;
      (outside(middle) == before ? low : high) = middle;
    }
    found.push_back((low + high) / 2);
  }
  return found;
}

/// Two circles: `along` is the distance of the common chord from the first center. Differences of squares are written
/// as products.
std::vector<Crossing> crossings(const Drawing& drawing, const Strand& p, const Strand& q) {
  std::vector<Crossing> found;
  const auto offer = [&](double s, double t, const Vec2& at) {
    if (s >= 0 && s <= 1 && t >= 0 && t <= 1) found.push_back({s, t, at});
  };
  const Vec2& a = drawing.corners[std::size_t(p.from)];
  const Vec2 d = drawing.corners[std::size_t(p.to)] - a;
  if (q.arc && !is_circle(*q.arc)) {
    for (const double s : crossings_of_ellipse(drawing, p, *q.arc)) {
      const Vec2 x = p.arc ? at(*p.arc, p.arc->from + s * (p.arc->to - p.arc->from)) : Vec2(a + s * d);
      offer(s, place_on_arc(*q.arc, x), x);
    }
  } else if (!p.arc && !q.arc) {
    const Vec2& b = drawing.corners[std::size_t(q.from)];
    const Vec2 e = drawing.corners[std::size_t(q.to)] - b;
    const double product = cross(d, e);
    if (std::abs(product) <= 1e-9 * d.norm() * e.norm()) return {};
    const double s = cross(b - a, e) / product;
    offer(s, cross(b - a, d) / product, a + s * d);
  } else if (!p.arc) {
    const double radius = largest_radius(*q.arc), s = (q.arc->center - a).dot(d) / d.squaredNorm();
    const double height = (a + s * d - q.arc->center).norm();
    if (height >= radius) return {};
    const double half = std::sqrt((radius - height) * (radius + height)) / d.norm();
    for (const double u : {s - half, s + half}) offer(u, place_on_arc(*q.arc, a + u * d), a + u * d);
  } else if (!q.arc || !is_circle(*p.arc)) {
    for (const Crossing& c : crossings(drawing, q, p)) found.push_back({c.t, c.s, c.at});
  } else {
    const double r = largest_radius(*p.arc), other = largest_radius(*q.arc);
    const Vec2 way = q.arc->center - p.arc->center;
    const double apart = way.norm();
    if (!(apart > 1e-9 * (r + other))) return {};
    const double along = ((r - other) * (r + other) / apart + apart) / 2;
    if (std::abs(along) >= r) return {};
    const Vec2 foot = p.arc->center + along / apart * way, across = Vec2(-way.y(), way.x()) / apart;
    const double half = std::sqrt((r - along) * (r + along));
    for (const double h : {-half, half}) {
      const Vec2 x = foot + h * across;
      offer(place_on_arc(*p.arc, x), place_on_arc(*q.arc, x), x);
    }
  }
  return found;
}

/// A crossing near a corner that both strands have already is that corner: ends that were moved onto a strand cross it
/// again by rounding.
void cut_at_crossings(Joiner& j) {
  each_pair(j, [&](std::size_t k, std::size_t l) {
    for (const Crossing& c : crossings(j.drawing, j.strand(k), j.strand(l))) {
      const Vec2 u = velocity(j.drawing, j.strand(k), c.s).normalized(),
                 v = velocity(j.drawing, j.strand(l), c.t).normalized();
      // A corner that was moved by up to `join` lies that far from the crossing, divided by the sine.
      const double reach = 2 * j.join / std::max(std::abs(cross(u, v)), least_sine);
      bool known = false;
      Index corner = none;
      double least = j.join;
      j.each_corner(k, [&](Index x) {
        if ((j.at(x) - c.at).norm() <= reach && j.has(l, x)) known = true;
      });
      if (known) continue;
      for (const std::size_t m : {k, l})
        j.each_corner(m, [&](Index x) {
          if ((j.at(x) - c.at).norm() > least) return;
          least = (j.at(x) - c.at).norm();
          corner = x;
        });
      if (corner == none) {
        corner = Index(j.drawing.corners.size());
        j.drawing.corners.push_back(c.at);
      }
      if (!j.has(k, corner)) j.cuts[k].push_back({c.s, corner});
      if (!j.has(l, corner)) j.cuts[l].push_back({c.t, corner});
    }
  });
}

/// `meet`: which pairs of strands are looked at, from `first` on.
void join(Drawing& drawing, std::size_t first, const std::function<bool(const Strand&, const Strand&)>& meet) {
  std::vector<bool> fixed(drawing.corners.size(), false);
  for (const Strand& strand : drawing.strands)
    if (strand.loop != none || is_border(strand))
      fixed[std::size_t(strand.from)] = fixed[std::size_t(strand.to)] = true;
  Joiner joiner{drawing,
                join_tolerance * drawing.extent,
                first,
                meet,
                std::move(fixed),
                std::vector<std::vector<StrandCut>>(drawing.strands.size() - first)};
  merge_corners(joiner);
  cut_at_corners(joiner);
  cut_at_crossings(joiner);
  std::vector<Strand> strands(drawing.strands.begin(), drawing.strands.begin() + Index(first));
  for (std::size_t k = 0; k < joiner.cuts.size(); ++k)
    append_pieces(joiner.strand(k), std::move(joiner.cuts[k]), strands);
  drawing.strands = std::move(strands);
}

}  // namespace

void join_cracks(Drawing& drawing) {
  std::size_t first = 0;
  while (first < drawing.strands.size() && drawing.strands[first].loop != none) ++first;
  join(drawing, first, [](const Strand& a, const Strand& b) { return a.crack != b.crack; });
}

/// Corners of borders and loops stay. The seam of a whole circle is no corner.
void join_borders(Drawing& drawing) {
  const auto has = [&](auto&& is) { return std::ranges::any_of(drawing.strands, is); };
  const auto is_crack = [](const Strand& s) { return s.crack != none && !is_border(s); };
  if (!has(is_border) || !has(is_crack)) return;
  std::size_t first = 0;
  while (first < drawing.strands.size() && drawing.strands[first].loop != none) ++first;
  join(drawing, first, [&](const Strand& a, const Strand& b) {
    return (is_border(a) && is_crack(b)) || (is_border(b) && is_crack(a));
  });
}

}  // namespace kerf
