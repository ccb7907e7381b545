// Which straight pieces cross, touch or overlap: those whose boxes meet, in the order of a sweep by their left ends.
// Pieces of arcs are halved until their chords say what the arcs do: two pieces with sagittas p, q that are further
// apart than p + q + gap do not meet. Pieces that share a point may meet there, but not in a wedge of less than 1e-5.
// Every pair whose boxes meet is compared; of all meetings the one with the lowest pair of strands is told, loops
// before cracks, so that the message does not depend on the order of the sweep.

#include "geometry/shape/drawing.hpp"

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
    // A second end at the same place makes no overlap.
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
  if (const auto part = crossing(a, b, c, d)) return {How::Crosses, a + *part * (b - a)};
  return {};
}

/// Two pieces o-a and o-b: they overlap when the shorter one lies on the other, or makes an angle of less than 1e-5
/// with it while nearer than `near`: no mesher comes to an end in such a wedge.
Meeting meeting(const Vec2& o, const Vec2& a, const Vec2& b, double gap, double near) {
  if ((a - o).dot(b - o) <= 0) return {};
  const auto lies_on = [&](const Vec2& x, const Vec2& y) {
    return distance(x, o, y) <= std::max(gap, std::min(near, 1e-5 * (x - o).norm()));
  };
  if (lies_on(a, b)) return {How::Overlaps, a};
  if (lies_on(b, a)) return {How::Overlaps, b};
  return {};
}

/// Rounded to what the pieces of arcs can say about the place.
std::string place(const Vec2& x, double extent) {
  const double unit = std::pow(10.0, std::floor(std::log10(extent)) - 4);
  return fmt::format("({:.6g}, {:.6g})", std::round(x.x() / unit) * unit + 0.0, std::round(x.y() / unit) * unit + 0.0);
}

/// Of the same loop, crack or region.
bool of_one(const Strand& s, const Strand& t) {
  return s.loop == t.loop && s.crack == t.crack && s.region == t.region;
}

/// The later strand comes second: a crack is told about the loop that it meets, a region about anything.
std::string words(const Shape& shape, const Strand& s, const Strand& t, const Meeting& m, double extent) {
  const std::string at = "at " + place(m.at, extent);
  const char* verb = m.how == How::Crosses ? "crosses" : m.how == How::Touches ? "touches" : "overlaps";
  if (s.crack == none && of_one(s, t))
    return fmt::format("{} {} itself {}; a loop must be simple", name(shape, s), verb, at);
  if (is_border(t) && s.crack != none && !s.beyond)
    return fmt::format(
        "{} {} {} {}; a crack crosses the border of a region, ends on it, or is made of its sides from corner to "
        "corner",
        name(shape, s), verb, name(shape, t), at);
  if (t.region != none)
    return fmt::format("{} {} {} {}; regions must lie inside the body, apart from its sides and from each other",
                       name(shape, t), verb, name(shape, s), at);
  if (s.loop != none && t.loop != none)
    return fmt::format("{} {} {} {}; holes must lie inside the body, apart from its outline and from each other",
                       name(shape, t), verb, name(shape, s), at);
  const std::string crack = name(shape, t);
  if (s.loop != none) {
    if (m.how == How::Overlaps)
      return fmt::format("{} runs along {} {}; it must lie inside the body", crack, name(shape, s), at);
    if (m.how == How::Touches)
      return fmt::format("{} touches {} {} between its ends; only its ends may lie there", crack, name(shape, s), at);
    if (s.loop == 0) return fmt::format("{} leaves the body {}; end it there or inside", crack, at);
    return fmt::format("{} crosses {} {}; end it on the hole's boundary", crack, name(shape, s), at);
  }
  if (s.crack == t.crack) return fmt::format("{} {} itself {}; a crack must be a simple path", crack, verb, at);
  const std::string both = fmt::format("cracks '{}' and '{}'", shape.cracks[std::size_t(s.crack)].name,
                                       shape.cracks[std::size_t(t.crack)].name);
  switch (m.how) {
    case How::Crosses:
      return fmt::format("{} cross {}, too close to another end, kink or crossing", both, at);
    case How::Touches:
      return fmt::format("{} touch {}; let them cross, let one end on the other, or draw them apart", both, at);
    default:
      return fmt::format("{} overlap {}; draw them as one crack or apart", both, at);
  }
}

/// A piece with its end points, for halving.
struct Chord {
  Index strand;
  double from, to;
  Vec2 a, b;
  double sagitta;  // how far its arc may leave it

  Vec2 middle(const Drawing& drawing) const {
    return point(drawing, drawing.strands[std::size_t(strand)], (from + to) / 2);
  }
};

double sagitta(const Strand& strand, double from, double to) {
  if (!strand.arc) return 0;
  const double angle = (to - from) * (strand.arc->to - strand.arc->from);
  return largest_radius(*strand.arc) * angle * angle / 8;
}

double separation(const Chord& p, const Chord& q) {
  if (crossing(p.a, p.b, q.a, q.b)) return 0;
  return std::min({distance(p.a, q.a, q.b), distance(p.b, q.a, q.b), distance(q.a, p.a, p.b), distance(q.b, p.a, p.b)});
}

/// Which end of p is which end of q: the corner or point of the polygon that they share.
struct Shared {
  bool aa = false, ab = false, ba = false, bb = false;
  bool any() const {
    return aa || ab || ba || bb;
  }
};

/// What nearer than `gap` touches; below `near` wedges are too narrow.
struct Tolerance {
  double gap, near;
};

/// The chord with the larger sagitta is halved; which of its ends is shared goes with the halves.
Meeting meeting(const Drawing& drawing, const Chord& p, const Chord& q, const Shared& shared,
                const Tolerance& tolerance) {
  const auto& [gap, near] = tolerance;
  if (p.sagitta + q.sagitta > 0.1 * gap) {
    if (!shared.any() && separation(p, q) > p.sagitta + q.sagitta + gap) return {};
    const bool first = p.sagitta >= q.sagitta;
    const Chord& whole = first ? p : q;
    const Strand& strand = drawing.strands[std::size_t(whole.strand)];
    const double half = (whole.from + whole.to) / 2;
    const Vec2 x = whole.middle(drawing);
    const Chord head{whole.strand, whole.from, half, whole.a, x, sagitta(strand, whole.from, half)};
    const Chord tail{whole.strand, half, whole.to, x, whole.b, sagitta(strand, half, whole.to)};
    const Shared at_head =
        first ? Shared{shared.aa, shared.ab, false, false} : Shared{shared.aa, false, shared.ba, false};
    const Shared at_tail =
        first ? Shared{false, false, shared.ba, shared.bb} : Shared{false, shared.ab, false, shared.bb};
    const Meeting m =
        first ? meeting(drawing, head, q, at_head, tolerance) : meeting(drawing, p, head, at_head, tolerance);
    if (m.how != How::Apart) return m;
    return first ? meeting(drawing, tail, q, at_tail, tolerance) : meeting(drawing, p, tail, at_tail, tolerance);
  }
  if ((shared.aa && shared.bb) || (shared.ab && shared.ba)) return {How::Overlaps, p.a};
  if (shared.aa || shared.ab) return meeting(p.a, p.b, shared.aa ? q.b : q.a, gap, near);
  if (shared.ba || shared.bb) return meeting(p.b, p.a, shared.ba ? q.b : q.a, gap, near);
  return meeting(p.a, p.b, q.a, q.b, gap);
}

/// Chords in the order of a sweep, each with the margin of its box, found by the boxes that meet. Long chords askew
/// have boxes that meet half of all others, teeth of a comb or a star: they are compared in that of eight frames in
/// which their own boxes are thin.
class Frames {
 public:
  Frames(const std::vector<Chord>& chords, const std::vector<double>& margin, const std::vector<Index>& order,
         double extent)
      : chords_(chords), margin_(margin), order_(order), extent_(extent) {}

  template <class Visit>
  void each_near(std::size_t k, Visit&& visit) {
    const std::size_t f = frame_of(chords_[std::size_t(order_[k])]);
    if (frames_[f].boxes.empty()) make(f);
    const auto& [boxes, tree] = frames_[f];
    tree.each([&own = boxes[k]](const AxisBox& box) { return box.meets(own); }, visit);
  }

 private:
  static constexpr std::size_t count = 8;
  static double angle(std::size_t frame) {
    return pi / 2 * double(frame) / count;
  }

  std::size_t frame_of(const Chord& chord) const {
    const Vec2 d = (chord.b - chord.a).cwiseAbs();
    if (d.minCoeff() <= extent_ / std::sqrt(double(order_.size()))) return 0;
    const Vec2 along = chord.b - chord.a;
    const double turn = std::atan2(along.y(), along.x()) / (pi / 2) + 2;  // in quarters of a turn
    return std::size_t(std::lround((turn - std::floor(turn)) * count)) % count;
  }

  void make(std::size_t f) {
    const double c = std::cos(angle(f)), s = std::sin(angle(f)), rounding = f == 0 ? 0 : 1e-12 * extent_;
    const auto turned = [&](const Vec2& x) { return Vec2(c * x.x() + s * x.y(), c * x.y() - s * x.x()); };
    for (const Index i : order_) {
      const Chord& chord = chords_[std::size_t(i)];
      frames_[f].boxes.push_back(
          box_around(turned(chord.a), turned(chord.b)).grown(margin_[std::size_t(i)] + rounding));
    }
    frames_[f].tree = BoxTree(frames_[f].boxes);
  }

  struct Frame {
    std::vector<AxisBox> boxes;
    BoxTree tree;
  };
  const std::vector<Chord>& chords_;
  const std::vector<double>& margin_;
  const std::vector<Index>& order_;
  const double extent_;
  std::array<Frame, count> frames_;  // made when first asked for
};

/// Whether what touches a loop at a corner or at the end of a piece passes through it: some of it lies on either side.
bool passes(const Drawing& drawing, const Pieces& pieces, const Strand& loop, const Strand& other,
            const Vec2& meeting) {
  std::vector<std::array<Vec2, 2>> sides;
  for (const Piece& piece : pieces.pieces)
    if (of_one(drawing.strands[std::size_t(piece.strand)], loop))
      sides.push_back({pieces.points[std::size_t(piece.a)], pieces.points[std::size_t(piece.b)]});
  int within = 0, beyond = 0;
  for (const Strand& strand : drawing.strands) {
    if (!of_one(strand, other)) continue;
    for (int i = 0; i < 8; ++i) {
      const Vec2 x = point(drawing, strand, (i + 0.5) / 8);
      if ((x - meeting).norm() > 1e-3 * drawing.extent) ++(inside(sides, x) ? within : beyond);
    }
  }
  return within > 0 && beyond > 0;
}

}  // namespace

std::optional<std::string> find_crossing(const Shape& shape, const Drawing& drawing, const Pieces& pieces,
                                         const Gaps& gaps, bool curved) {
  std::vector<Chord> chords;
  std::vector<double> margin;
  for (const Piece& piece : pieces.pieces) {
    const Vec2 &a = pieces.points[std::size_t(piece.a)], &b = pieces.points[std::size_t(piece.b)];
    const Strand& strand = drawing.strands[std::size_t(piece.strand)];
    chords.push_back({piece.strand, piece.from, piece.to, a, b, curved ? sagitta(strand, piece.from, piece.to) : 0});
    margin.push_back(chords.back().sagitta + std::max(gaps.loop, gaps.crack));
  }
  std::vector<Index> order(chords.size());  // of the sweep
  std::iota(order.begin(), order.end(), Index(0));
  const auto corner = [&](Index i) -> Vec2 {
    const Chord& chord = chords[std::size_t(i)];
    return chord.a.cwiseMin(chord.b).array() - margin[std::size_t(i)];
  };
  std::sort(order.begin(), order.end(), [&](Index i, Index j) {
    const Vec2 a = corner(i), b = corner(j);
    return std::tuple(a.x(), a.y(), i) < std::tuple(b.x(), b.y(), j);
  });
  Frames frames(chords, margin, order, drawing.extent);

  // What is wrong with the loops is said before what is wrong with the cracks: the later strand decides the order. Of
  // one pair of strands the first meeting in the sweep.
  Meeting first;
  std::pair<Index, Index> where{none, none};
  const auto compare = [&](Index i, Index j) {
    if (j < i) std::swap(i, j);
    const Piece &p = pieces.pieces[std::size_t(i)], &q = pieces.pieces[std::size_t(j)];
    if (first.how != How::Apart && where <= std::pair(q.strand, p.strand)) return;
    const Shared shared{p.a == q.a, p.a == q.b, p.b == q.a, p.b == q.b};
    const Strand &s = drawing.strands[std::size_t(p.strand)], &t = drawing.strands[std::size_t(q.strand)];
    if (p.strand == q.strand && shared.any()) return;  // neighbors on a smooth strand
    const bool same = of_one(s, t);
    const double gap = same || (s.crack == none && t.crack == none) ? gaps.loop : gaps.crack;
    const Meeting m = meeting(drawing, chords[std::size_t(i)], chords[std::size_t(j)], shared, {gap, gaps.crack});
    if (m.how == How::Apart) return;
    first = m;
    where = {q.strand, p.strand};
  };
  std::vector<Index> met;
  for (std::size_t k = 0; k < order.size(); ++k) {
    // What lies beyond the first meeting that is known is no matter any more.
    const auto matters = [&](Index piece) {
      return first.how == How::Apart || pieces.pieces[std::size_t(piece)].strand <= where.first;
    };
    if (!matters(order[k])) continue;
    met.clear();
    frames.each_near(k, [&](Index other) {
      if (std::size_t(other) < k && matters(order[std::size_t(other)])) met.push_back(other);
    });
    std::ranges::sort(met);
    for (const Index other : met) compare(order[std::size_t(other)], order[k]);
  }
  if (first.how == How::Apart) return std::nullopt;
  const Strand &s = drawing.strands[std::size_t(where.second)], &t = drawing.strands[std::size_t(where.first)];
  if (first.how == How::Touches && !of_one(s, t) &&
      ((s.loop != none && passes(drawing, pieces, s, t, first.at)) ||
       (t.region != none && passes(drawing, pieces, t, s, first.at))))
    first.how = How::Crosses;
  return words(shape, s, t, first, drawing.extent);
}

}  // namespace kerf
