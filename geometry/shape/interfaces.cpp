// Regions that touch: sides that they share with each other, with the outline and with holes; paths of interfaces.
// Sides that coincide are first made to do so from corner to corner: corners within 1e-6 of the extent become one, and
// corners of others cut a strand. Then one strand stays for all that are one curve, with the region on its left and
// what lies on its right (`beyond`); what a region shares with a loop is the loop's. Of regions that overlap one must
// contain the other, the smaller counts: nesting follows from points just inside each region. A crack that is made of
// sides of regions is an interface and takes their strands. Paths between two regions end where a third one or a loop
// comes in.

#include "geometry/interfaces.hpp"
#include "geometry/shape/drawing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace kerf {

namespace {

/// From its end to its start.
Strand turned(Strand strand) {
  std::swap(strand.from, strand.to);
  if (strand.arc) std::swap(strand.arc->from, strand.arc->to);
  const Index left = strand.region;
  if (strand.beyond) strand.region = *strand.beyond;
  strand.beyond = left;
  return strand;
}

BoxTree tree_of(const std::vector<Vec2>& points) {
  std::vector<AxisBox> boxes;
  for (const Vec2& x : points) boxes.push_back({x, x});
  return BoxTree(boxes);
}

/// Shares corners and cuts strands so that sides that coincide do so from corner to corner.
class Sharing {
 public:
  explicit Sharing(Drawing& drawing) : drawing_(drawing), join_(join_tolerance * drawing.extent) {
    instead_.resize(drawing.corners.size());
    for (std::size_t v = 0; v < instead_.size(); ++v) instead_[v] = Index(v);
  }

  /// Corners first: cuts are counted in the strands between them. Whether anything was shared.
  bool share() {
    merge_corners();
    std::vector<std::vector<StrandCut>> cuts(drawing_.strands.size());
    for (std::size_t k = 0; k < cuts.size(); ++k)
      if (drawing_.strands[k].crack == none) cuts[k] = cuts_of(k);
    std::vector<Strand> pieces;
    bool any = merged_;
    for (std::size_t k = 0; k < cuts.size(); ++k) {
      any = any || !cuts[k].empty();
      append_pieces(drawing_.strands[k], std::move(cuts[k]), pieces);
    }
    drawing_.strands = std::move(pieces);
    return any;
  }

 private:
  /// A region's corner that is another's, or a loop's, becomes that one. The seam of a whole circle is no corner.
  void merge_corners() {
    const BoxTree tree = tree_of(drawing_.corners);
    std::vector<Index> place(drawing_.corners.size(), none);  // among the corners seen so far
    const auto seen = [&](Index v) { return place[std::size_t(v)] != none; };
    for (Strand& strand : drawing_.strands) {
      if (strand.crack != none || whole(strand)) continue;
      for (Index* end : {&strand.from, &strand.to}) {
        Index& v = instead_[std::size_t(*end)];
        if (v == *end && strand.region != none && !seen(v)) {
          Index first = none;
          for (const Index other : tree.meeting(AxisBox{at(v), at(v)}.grown(join_)))
            if (seen(other) && (at(other) - at(*end)).norm() <= join_ &&
                (first == none || place[std::size_t(other)] < place[std::size_t(first)]))
              first = other;
          if (first != none) v = first, merged_ = true;
        }
        if (v == *end && !seen(v)) {
          place[std::size_t(v)] = Index(corners_.size());
          corners_.push_back(v);
        }
        *end = v;
      }
    }
    std::vector<Vec2> points;
    for (const Index v : corners_) points.push_back(at(v));
    tree_ = tree_of(points);
    of_region_.assign(drawing_.corners.size(), true);
    for (const Strand& strand : drawing_.strands)
      if (strand.region == none) of_region_[std::size_t(strand.from)] = of_region_[std::size_t(strand.to)] = false;
  }

  /// Corners of others on strand k.
  std::vector<StrandCut> cuts_of(std::size_t k) {
    const Strand& strand = drawing_.strands[k];
    std::vector<StrandCut> cuts;
    const AxisBox box = box_of(drawing_, strand).grown(join_);
    for (const Index place : tree_.meeting(box.grown(join_))) {  // a corner may have moved by that
      const Index v = corners_[std::size_t(place)];
      const Vec2& x = at(v);
      if (v == strand.from || v == strand.to) continue;
      if (strand.region == none && !of_region_[std::size_t(v)]) continue;  // loops are no matter of regions
      if (!box.has(x)) continue;
      const Foot foot = nearest(drawing_, strand, x);
      if (!(foot.distance <= join_)) continue;
      cuts.push_back({foot.s, v});
      if (of_region_[std::size_t(v)] && foot.distance > 1e-13 * drawing_.extent && moved_.insert(v).second)
        drawing_.corners[std::size_t(v)] = point(drawing_, strand, foot.s);
    }
    return cuts;
  }

  const Vec2& at(Index corner) const {
    return drawing_.corners[std::size_t(corner)];
  }

  Drawing& drawing_;
  const double join_;
  bool merged_ = false;  // any corners
  std::vector<Index> instead_, corners_;
  BoxTree tree_;  // of the corners
  std::vector<bool> of_region_;
  std::set<Index> moved_;
};

/// Which regions contain which.
/// Regions of equal area that contain each other's points overlap: neither is the inner one.
struct Nesting {
  std::vector<double> area;
  std::vector<Index> around;  // the innermost one that contains the region, or none
  std::optional<std::string> overlap;
};

/// Points just inside a region, beside the middle of each of its strands.
std::vector<Vec2> inner_points(const Drawing& drawing, const std::vector<std::size_t>& strands,
                               const std::vector<Vec2>& border) {
  std::vector<Vec2> points;
  for (const std::size_t k : strands) {
    const Strand& strand = drawing.strands[k];
    const Vec2 x = point(drawing, strand, 0.5), along = velocity(drawing, strand, 0.5).normalized();
    const Vec2 inwards(-along.y(), along.x());
    for (double step = 0.01 * length(drawing, strand); step > 4 * join_tolerance * drawing.extent; step /= 2)
      if (const Vec2 inner = x + step * inwards; inside(border, inner)) {
        points.push_back(inner);
        break;
      }
  }
  return points;
}

/// Of strands that end where others touch them.
Nesting nest(const Drawing& drawing, const Shape& shape) {
  const std::size_t n = shape.regions.size();
  Nesting nesting{.area = {}, .around = std::vector<Index>(n, none), .overlap = {}};
  std::vector<std::vector<Vec2>> border;
  for (const Loop& region : shape.regions) {
    nesting.area.push_back(std::abs(signed_area(region)));
    border.push_back(flatten(region, 1e-6 * drawing.extent, drawing.extent).points);
  }
  std::vector<std::vector<std::size_t>> strands(n);
  for (std::size_t k = 0; k < drawing.strands.size(); ++k)
    if (const Index r = drawing.strands[k].region; r != none) strands[std::size_t(r)].push_back(k);
  std::vector<AxisBox> boxes(n);
  for (std::size_t r = 0; r < n; ++r)
    for (const Vec2& x : border[r]) boxes[r].add(x);
  const BoxTree tree(boxes);
  for (std::size_t r = 0; r < n; ++r) {
    const std::vector<Vec2> inner = inner_points(drawing, strands[r], border[r]);
    AxisBox around_inner;
    for (const Vec2& x : inner) around_inner.add(x);
    for (const Index o : tree.meeting(around_inner)) {
      const auto other = std::size_t(o);
      if (other == r || nesting.area[other] < nesting.area[r]) continue;
      const auto within = std::ranges::count_if(inner, [&](const Vec2& x) { return inside(border[other], x); });
      if (within == 0) continue;
      if (within < std::ssize(inner) || nesting.area[other] == nesting.area[r]) {
        if (!nesting.overlap)
          nesting.overlap = fmt::format(
              "regions '{}' and '{}' overlap; let one contain the other, or let them share "
              "no more than a border",
              shape.regions[r].name, shape.regions[other].name);
        continue;
      }
      Index& around = nesting.around[r];
      if (around == none || nesting.area[other] < nesting.area[std::size_t(around)]) around = o;
    }
  }
  return nesting;
}

/// Strands between the same corners that are one curve.
bool coincide(const Drawing& drawing, const Strand& a, const Strand& b) {
  if (std::minmax(a.from, a.to) != std::minmax(b.from, b.to)) return false;
  if (a.from == a.to && !(whole(a) && whole(b))) return false;
  const double join = join_tolerance * drawing.extent;
  return nearest(drawing, b, point(drawing, a, 0.5)).distance <= 2 * join &&
         nearest(drawing, a, point(drawing, b, 0.5)).distance <= 2 * join;
}

/// One strand for all that are one curve; none for what regions share with loops.
void unite(Drawing& drawing, const Nesting& nesting) {
  const auto smaller = [&](Index a, Index b) { return nesting.area[std::size_t(a)] < nesting.area[std::size_t(b)]; };
  std::map<std::pair<Index, Index>, std::vector<std::size_t>> at;
  for (std::size_t k = 0; k < drawing.strands.size(); ++k)
    if (drawing.strands[k].crack == none) at[std::minmax(drawing.strands[k].from, drawing.strands[k].to)].push_back(k);
  std::vector<bool> gone(drawing.strands.size(), false);
  for (std::size_t k = 0; k < drawing.strands.size(); ++k) {
    Strand& strand = drawing.strands[k];
    if (strand.region == none || gone[k]) continue;
    std::vector<Index> left{strand.region}, right;
    for (const std::size_t m : at[std::minmax(strand.from, strand.to)]) {
      const Strand& other = drawing.strands[m];
      if (m == k || gone[m] || !coincide(drawing, strand, other)) continue;
      const bool same = velocity(drawing, strand, 0.5).dot(velocity(drawing, other, 0.5)) > 0;
      if (other.region == none) {
        gone[k] = gone[k] || same;  // the other way round it lies outside the body, which is refused
        continue;
      }
      (same ? left : right).push_back(other.region);
      gone[m] = true;
    }
    strand.region = std::ranges::min(left, smaller);
    strand.beyond =
        right.empty() ? nesting.around[std::size_t(std::ranges::max(left, smaller))] : std::ranges::min(right, smaller);
  }
  std::vector<Strand> kept;
  for (std::size_t k = 0; k < gone.size(); ++k)
    if (!gone[k]) kept.push_back(drawing.strands[k]);
  drawing.strands = std::move(kept);
}

/// The strands between two regions as paths with the first one on their left. Where paths meet each other or a loop
/// they end.
std::vector<std::vector<Strand>> paths_between(const Drawing& drawing, Index region, Index other) {
  std::vector<Strand> strands;
  std::map<Index, int> leaving, arriving;
  std::set<Index> on_loop;
  for (const Strand& strand : drawing.strands) {
    if (strand.loop != none) on_loop.insert(strand.from);
    if (!strand.beyond) continue;
    if (strand.region == region && strand.beyond == other)
      strands.push_back(strand);
    else if (strand.region == other && strand.beyond == region)
      strands.push_back(turned(strand));
    else
      continue;
    ++leaving[strands.back().from];
    ++arriving[strands.back().to];
  }
  const auto passes = [&](Index v) { return leaving[v] == 1 && arriving[v] == 1 && !on_loop.contains(v); };
  std::vector<bool> used(strands.size(), false);
  std::vector<std::vector<Strand>> paths;
  const auto follow = [&](std::size_t k) {
    std::vector<Strand>& path = paths.emplace_back();
    while (!used[k]) {
      used[k] = true;
      path.push_back(strands[k]);
      if (!passes(strands[k].to)) return;
      k = std::size_t(std::ranges::find(strands, strands[k].to, &Strand::from) - strands.begin());
    }
  };
  for (std::size_t k = 0; k < strands.size(); ++k)
    if (!passes(strands[k].from)) follow(k);
  for (std::size_t k = 0; k < strands.size(); ++k)
    if (!used[k]) follow(k);
  return paths;
}

bool same_curve(const Arc& a, const Arc& b) {
  constexpr double rounding = 1e-12;
  return (a.center - b.center).norm() + (a.axes - b.axes).norm() <= rounding * a.axes.norm() &&
         (a.to > a.from) == (b.to > b.from);
}

/// A path as polylines and arcs. A closed one begins where it changes from one to the other, if it does.
std::vector<Crack> cracks_along(const Drawing& drawing, std::vector<Strand> path) {
  const auto goes_on = [](const Strand& a, const Strand& b) {
    return a.arc && b.arc ? same_curve(*a.arc, *b.arc) : !a.arc && !b.arc;
  };
  if (path.front().from == path.back().to)
    for (std::size_t k = 0; k < path.size(); ++k)
      if (!goes_on(path[(k + path.size() - 1) % path.size()], path[k])) {
        std::rotate(path.begin(), path.begin() + Index(k), path.end());
        break;
      }
  std::vector<Crack> cracks;
  for (std::size_t k = 0; k < path.size(); ++k) {
    const Strand& strand = path[k];
    const Vec2 &from = drawing.corners[std::size_t(strand.from)], &to = drawing.corners[std::size_t(strand.to)];
    if (k == 0 || !goes_on(path[k - 1], strand)) {
      cracks.push_back({{}, {from, to}, strand.arc});
    } else if (strand.arc) {
      cracks.back().arc->to += strand.arc->to - strand.arc->from;
      cracks.back().points.back() = to;
    } else {
      cracks.back().points.push_back(to);
    }
  }
  return cracks;
}

/// Where on its path a point lies, in pieces from its start; nothing when it lies further than `join` from it.
std::optional<double> place_on_crack(const Crack& crack, const Vec2& x, double join) {
  if (crack.arc) {
    const Arc& arc = *crack.arc;
    const double t = parameter(arc, x), turn = arc.to - arc.from;
    if (!((at(arc, t) - x).norm() <= join)) return std::nullopt;
    const double s = 0.5 + std::remainder(t - arc.from - turn / 2, 2 * pi) / turn;
    const double slack = join / smallest_radius(arc) / std::abs(turn);
    return s >= -slack && s <= 1 + slack ? std::optional(std::clamp(s, 0.0, 1.0)) : std::nullopt;
  }
  std::optional<double> place;
  double least = join;
  for (std::size_t i = 0; i + 1 < crack.points.size(); ++i) {
    const Vec2 &a = crack.points[i], &b = crack.points[i + 1];
    if (const double away = distance(x, a, b); away <= least) {
      least = away;
      place = double(i) + foot(x, a, b);
    }
  }
  return place;
}

/// Direction of the path there.
Vec2 direction_at(const Crack& crack, double place) {
  if (crack.arc)
    return velocity(*crack.arc, crack.arc->from + place * (crack.arc->to - crack.arc->from)) *
           (crack.arc->to > crack.arc->from ? 1 : -1);
  const std::size_t i = std::min(std::size_t(place), crack.points.size() - 2);
  return crack.points[i + 1] - crack.points[i];
}

/// The sides of regions that lie on the crack, in the order and the direction of its path.
std::vector<Strand> strands_of(const Drawing& drawing, const Crack& crack) {
  const double join = 2 * join_tolerance * drawing.extent;
  std::vector<std::pair<double, Strand>> found;
  for (const Strand& strand : drawing.strands) {
    if (!strand.beyond || strand.crack != none) continue;
    const auto middle = place_on_crack(crack, point(drawing, strand, 0.5), join);
    if (!middle || !place_on_crack(crack, drawing.corners[std::size_t(strand.from)], join) ||
        !place_on_crack(crack, drawing.corners[std::size_t(strand.to)], join) ||
        !place_on_crack(crack, point(drawing, strand, 0.25), join))
      continue;
    const bool along = velocity(drawing, strand, 0.5).dot(direction_at(crack, *middle)) > 0;
    found.emplace_back(*middle, along ? strand : turned(strand));
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Strand> strands;
  for (auto& [place, strand] : found) strands.push_back(std::move(strand));
  return strands;
}

/// Of a shape with its regions alone.
Drawing shared_regions(const Shape& shape, Nesting* nesting = nullptr) {
  Shape plain = shape;
  plain.cracks.clear();
  Drawing drawing = draw(plain, Regions::Apart);
  Sharing(drawing).share();
  const Nesting nested = nest(drawing, shape);
  if (nesting) *nesting = nested;
  unite(drawing, nested);
  return drawing;
}

}  // namespace

/// Points of the crack first, which is cheap and settles most; then the lengths of the sides that it is made of must
/// add up to its own.
std::vector<bool> along_regions(const Shape& shape) {
  std::vector<bool> along(shape.cracks.size(), false);
  if (shape.regions.empty() || shape.cracks.empty()) return along;
  Shape plain = shape;
  plain.cracks.clear();
  const Drawing drawing = draw(plain, Regions::Apart);
  const double join = join_tolerance * drawing.extent;
  const auto far = [&](const Strand& strand, const Vec2& x) {
    if (!strand.arc) return false;
    const double r = (x - strand.arc->center).norm();
    return r > largest_radius(*strand.arc) + join || r < smallest_radius(*strand.arc) - join;
  };
  const BoxTree tree(boxes_of(drawing));
  const auto on_region = [&](const Vec2& x) {
    return std::ranges::any_of(tree.meeting(AxisBox{x, x}.grown(2 * join)), [&](Index k) {
      const Strand& strand = drawing.strands[std::size_t(k)];
      return strand.region != none && !far(strand, x) && nearest(drawing, strand, x).distance <= join;
    });
  };
  for (std::size_t c = 0; c < along.size(); ++c) {
    const Crack& crack = shape.cracks[c];
    std::vector<Vec2> x;
    if (crack.arc) {
      x = points_on(*crack.arc, 8);
    } else {
      for (std::size_t i = 0; i + 1 < crack.points.size(); ++i)
        for (const double s : {0.0, 0.3, 0.5, 1.0})
          x.push_back(crack.points[i] + s * (crack.points[i + 1] - crack.points[i]));
    }
    along[c] = !x.empty() && std::ranges::all_of(x, on_region);
  }
  if (std::ranges::find(along, true) == along.end()) return along;
  const Drawing shared = shared_regions(shape);
  for (std::size_t c = 0; c < along.size(); ++c) {
    if (!along[c]) continue;
    double covered = 0;
    for (const Strand& strand : strands_of(shared, shape.cracks[c])) covered += length(shared, strand);
    along[c] = std::abs(covered - path_length(shape.cracks[c])) <= 1e-4 * covered;
  }
  return along;
}

bool regions_touch(Drawing drawing) {
  return Sharing(drawing).share();
}

bool regions_touch(const Shape& shape) {
  if (shape.regions.empty()) return false;
  Shape plain = shape;
  plain.cracks.clear();
  return std::ranges::any_of(draw(plain).strands, [](const Strand& s) { return s.beyond.has_value(); });
}

Index crack_on_border(const Shape& shape) {
  if (shape.regions.empty() || shape.cracks.empty()) return none;
  const Drawing drawing = draw(shape);
  std::vector<bool> border(drawing.corners.size(), false);
  for (const Strand& s : drawing.strands)
    if (is_border(s)) border[std::size_t(s.from)] = border[std::size_t(s.to)] = true;
  const auto met = std::ranges::find_if(drawing.strands, [&](const Strand& s) {
    return s.crack != none && !is_border(s) && (border[std::size_t(s.from)] || border[std::size_t(s.to)]);
  });
  return met == drawing.strands.end() ? none : met->crack;
}

/// Strands of cracks come before those of regions (Drawing::strands).
void join_regions(Drawing& drawing, const Shape& shape, const std::vector<bool>& along) {
  Sharing(drawing).share();
  unite(drawing, nest(drawing, shape));
  std::vector<Strand> cracks;
  for (std::size_t c = 0; c < along.size(); ++c) {
    if (!along[c]) continue;
    for (Strand strand : strands_of(drawing, shape.cracks[c])) {
      std::erase_if(drawing.strands, [&](const Strand& s) { return s.beyond && coincide(drawing, s, strand); });
      strand.crack = Index(c);
      cracks.push_back(strand);
    }
  }
  const auto regions = std::ranges::find_if(drawing.strands, [](const Strand& s) { return s.beyond.has_value(); });
  drawing.strands.insert(regions, cracks.begin(), cracks.end());
}

std::optional<std::string> find_wrong_interface(const Shape& shape, const std::vector<bool>& along) {
  Nesting nesting;
  const Drawing drawing = shared_regions(shape, &nesting);
  if (nesting.overlap) return nesting.overlap;
  std::vector<Strand> taken;
  for (std::size_t c = 0; c < along.size(); ++c) {
    if (!along[c]) continue;
    const Crack& crack = shape.cracks[c];
    for (const Strand& strand : strands_of(drawing, crack)) {
      if (std::ranges::any_of(taken, [&](const Strand& s) { return coincide(drawing, s, strand); }))
        return fmt::format("crack '{}' overlaps another one along a side of a region, at ({:.6g}, {:.6g})", crack.name,
                           point(drawing, strand, 0.5).x(), point(drawing, strand, 0.5).y());
      taken.push_back(strand);
    }
  }
  return std::nullopt;
}

std::vector<Crack> seams(const Shape& shape, Index region, Index other) {
  const Drawing drawing = shared_regions(shape);
  std::vector<Crack> found;
  for (std::vector<Strand>& path : paths_between(drawing, region, other))
    for (Crack& crack : cracks_along(drawing, std::move(path))) found.push_back(std::move(crack));
  return found;
}

}  // namespace kerf
