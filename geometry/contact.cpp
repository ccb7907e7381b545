// Which straight pieces cross, touch or overlap: a sweep over the pieces sorted by their left ends.

#include "geometry/drawing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace kerf {

namespace {

enum class How { Apart, Crosses, Touches, Overlaps };

struct Meeting {
  How how = How::Apart;
  Vec2 at = Vec2::Zero();
};

/// Two pieces that share no point.
Meeting meeting(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d, double gap) {
  int near = 0;
  Meeting result;
  const auto look = [&](const Vec2& x, const Vec2& p, const Vec2& q) {
    if (!(distance(x, p, q) <= gap)) return;
    // A second contact at the same place makes no overlap.
    if (near > 0 && (x - result.at).norm() <= 4 * gap) return;
    if (near++ == 0) result.at = x;
  };
  look(a, c, d);
  look(b, c, d);
  look(c, a, b);
  look(d, a, b);
  if (near > 0) {
    result.how = near > 1 ? How::Overlaps : How::Touches;
    return result;
  }
  const double ca = cross(d - c, a - c), cb = cross(d - c, b - c);
  const double ac = cross(b - a, c - a), ad = cross(b - a, d - a);
  if ((ca > 0) == (cb > 0) || (ac > 0) == (ad > 0)) return {};
  return {How::Crosses, a + ca / (ca - cb) * (b - a)};
}

/// Two pieces o-a and o-b: they overlap when the shorter one lies on the other, or makes an angle of less than 1e-5 with
/// it while nearer than `near`: no mesher comes to an end in such a wedge.
Meeting meeting(const Vec2& o, const Vec2& a, const Vec2& b, double gap, double near) {
  if ((a - o).dot(b - o) <= 0) return {};
  const auto lies_on = [&](const Vec2& x, const Vec2& y) {
    return distance(x, o, y) <= std::max(gap, std::min(near, 1e-5 * (x - o).norm()));
  };
  if (lies_on(a, b)) return {How::Overlaps, a};
  if (lies_on(b, a)) return {How::Overlaps, b};
  return {};
}

std::string name(const Shape& shape, Index loop) {
  return loop == 0 ? "the outline" : fmt::format("hole '{}'", shape.holes[std::size_t(loop) - 1].name);
}

/// Rounded to what the pieces of arcs can say about the place.
std::string place(const Vec2& x, double extent) {
  const double unit = std::pow(10.0, std::floor(std::log10(extent)) - 4);
  return fmt::format("({:.6g}, {:.6g})", std::round(x.x() / unit) * unit + 0.0, std::round(x.y() / unit) * unit + 0.0);
}

std::string words(const Shape& shape, const Strand& s, const Strand& t, const Meeting& m, double extent) {
  const std::string at = "at " + place(m.at, extent);
  const char* verb = m.how == How::Crosses ? "crosses" : m.how == How::Touches ? "touches" : "overlaps";
  if (s.loop != none && s.loop == t.loop)
    return fmt::format("{} {} itself {}; a loop must be simple", name(shape, s.loop), verb, at);
  if (s.loop != none && t.loop != none)
    return fmt::format("{} {} {} {}; holes must lie inside the body, apart from its outline and from each other",
                       name(shape, t.loop), verb, name(shape, s.loop), at);
  const std::string crack = fmt::format("crack '{}'", shape.cracks[std::size_t(t.crack)].name);
  if (s.loop != none) {
    if (m.how == How::Overlaps)
      return fmt::format("{} runs along {} {}; it must lie inside the body", crack, name(shape, s.loop), at);
    if (m.how == How::Touches)
      return fmt::format("{} touches {} {} between its ends; only its ends may lie there", crack, name(shape, s.loop),
                         at);
    if (s.loop == 0) return fmt::format("{} leaves the body {}; end it there or inside", crack, at);
    return fmt::format("{} crosses {} {}; end it on the hole's boundary", crack, name(shape, s.loop), at);
  }
  if (s.crack == t.crack) return fmt::format("{} {} itself {}; a crack must be a simple path", crack, verb, at);
  const std::string both = fmt::format("cracks '{}' and '{}'", shape.cracks[std::size_t(s.crack)].name,
                                       shape.cracks[std::size_t(t.crack)].name);
  switch (m.how) {
    case How::Crosses: return fmt::format("{} cross {}; crossing cracks are not supported yet", both, at);
    case How::Touches: return fmt::format("{} touch {}; branching cracks are not supported yet", both, at);
    default: return fmt::format("{} overlap {}; draw them as one crack or apart", both, at);
  }
}

}  // namespace

std::optional<std::string> find_contact(const Shape& shape, const Drawing& drawing, const Pieces& pieces,
                                        double loop_gap, double crack_gap) {
  struct Box {
    Vec2 low, high;
    Index piece;
  };
  const double margin = std::max(loop_gap, crack_gap);
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < pieces.pieces.size(); ++i) {
    const Vec2 &a = pieces.points[std::size_t(pieces.pieces[i].a)], &b = pieces.points[std::size_t(pieces.pieces[i].b)];
    boxes.push_back({a.cwiseMin(b), a.cwiseMax(b).array() + margin, Index(i)});
  }
  std::sort(boxes.begin(), boxes.end(), [](const Box& a, const Box& b) {
    return std::tuple(a.low.x(), a.low.y(), a.piece) < std::tuple(b.low.x(), b.low.y(), b.piece);
  });

  // Loops before cracks, in the order of the drawing; of one pair of strands the first meeting in the sweep.
  Meeting first;
  std::pair<Index, Index> where{Index(drawing.strands.size()), none};
  const auto compare = [&](Index i, Index j) {
    const Piece& p = pieces.pieces[std::size_t(std::min(i, j))];
    const Piece& q = pieces.pieces[std::size_t(std::max(i, j))];
    // The later strand decides the order: what is wrong with the loops is said before what is wrong with the cracks.
    if (first.how != How::Apart && std::pair(where.second, where.first) <= std::pair(q.strand, p.strand)) return;
    const Strand &s = drawing.strands[std::size_t(p.strand)], &t = drawing.strands[std::size_t(q.strand)];
    const bool same = s.loop == t.loop && s.crack == t.crack;
    const double gap = same || t.crack == none ? loop_gap : crack_gap;
    const auto x = [&](Index v) -> const Vec2& { return pieces.points[std::size_t(v)]; };
    const bool aa = p.a == q.a, ab = p.a == q.b, ba = p.b == q.a, bb = p.b == q.b;
    Meeting m;
    if ((aa && bb) || (ab && ba))
      m = {How::Overlaps, x(p.a)};
    else if (aa || ab)
      m = meeting(x(p.a), x(p.b), x(aa ? q.b : q.a), gap, crack_gap);
    else if (ba || bb)
      m = meeting(x(p.b), x(p.a), x(ba ? q.b : q.a), gap, crack_gap);
    else
      m = meeting(x(p.a), x(p.b), x(q.a), x(q.b), gap);
    if (m.how == How::Apart) return;
    first = m;
    where = {p.strand, q.strand};
  };
  std::vector<Box> active;
  for (const Box& box : boxes) {
    std::size_t kept = 0;
    for (const Box& other : active) {
      if (other.high.x() < box.low.x()) continue;
      active[kept++] = other;
      if (other.low.y() <= box.high.y() && box.low.y() <= other.high.y()) compare(other.piece, box.piece);
    }
    active.resize(kept);
    active.push_back(box);
  }
  if (first.how == How::Apart) return std::nullopt;
  return words(shape, drawing.strands[std::size_t(where.first)], drawing.strands[std::size_t(where.second)], first,
               drawing.extent);
}

}  // namespace kerf
