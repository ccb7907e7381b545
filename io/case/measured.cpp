// Displacements measured at points on the boundary, as a field along one label. The boundary is cut into stretches on
// which displacements are smooth: at corners (turns of more than 0.3 at an end of a side) and at mouths of cracks. Each
// reading goes to the nearest stretch (at a corner to both), at the arc length s of its foot, and the field is
//   u(s) = (1 - t) u_i + t u_{i+1},   t = (s - s_i)/(s_{i+1} - s_i)   between neighboring readings,
// and periodic along a closed stretch. Beyond the outer reading of an open one the straight line goes on through that
// reading and the nearest that is at least as far from it as the point: an error of one reading is at most doubled. A
// stretch with less than two readings is joined with its neighbor, around the corner. Tolerances are relative to the
// extent of the body: readings may be 1 % of it off the boundary. docs/theory/inverse.md has what the field is compared
// with.

#include "io/case/measured.hpp"

#include "geometry/boxes.hpp"
#include "geometry/plane.hpp"
#include "io/case/table.hpp"
#include "io/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <tuple>

namespace kerf {

namespace {

constexpr double reach = 0.01;         // of the extent
constexpr double chord = 1e-5;         // of the extent, of arcs
constexpr double same_place = 1e-6;    // of the extent: a reading at a corner belongs to both sides
constexpr double corner_turn = 0.3;    // as reentrant_angle
constexpr double worth_saying = 1e-6;  // of the length of the label

/// A stretch of the boundary on which displacements are smooth: from one corner or mouth of a crack to the next, or all
/// of a loop.
struct Stretch {
  std::vector<Vec2> points;
  std::vector<double> s;        // arc length at the points, from 0
  std::vector<bool> labelled;   // per piece, from a point to the next: of the measured label
  bool closed = false;          // the last point is the first
  bool joins = false;           // begins where the one before it ends
  bool bends = false;           // around a corner: nothing goes on straight there
  std::vector<double> at = {};  // of the readings, rising
  std::vector<Vec2> u = {};

  double length() const {
    return s.back();
  }
  bool is_measured() const {
    return std::ranges::find(labelled, true) != labelled.end();
  }
};

struct Foot {
  double distance = infinity, s = 0;
};

/// The pieces of stretches, found by what they are near to.
class NearPieces {
 public:
  explicit NearPieces(const std::vector<Stretch>& stretches, bool on_label) {
    std::vector<AxisBox> boxes;
    for (std::size_t k = 0; k < stretches.size(); ++k)
      for (std::size_t i = 0; i + 1 < stretches[k].points.size(); ++i) {
        if (on_label && !stretches[k].labelled[i]) continue;
        pieces_.push_back({k, stretches[k].points[i], stretches[k].points[i + 1], stretches[k].s[i],
                           stretches[k].s[i + 1] - stretches[k].s[i]});
        boxes.push_back(box_around(pieces_.back().a, pieces_.back().b));
      }
    tree_ = BoxTree(boxes);
  }

  struct OnStretch {
    std::size_t stretch;
    Foot foot;
  };
  /// On every stretch that is as near to x as the nearest one, or further by `slack` at most; in their order.
  std::vector<OnStretch> feet(const Vec2& x, double slack) const {
    const auto anywhere = [](const AxisBox&) { return true; };
    double reach = infinity;
    tree_.each_near(x, reach, anywhere, [&](Index i) { reach = std::min(reach, on_piece(i, x).distance); });
    std::vector<Index> near;
    reach += slack;
    tree_.each_near(x, reach, anywhere, [&](Index i) { near.push_back(i); });
    std::ranges::sort(near);
    std::vector<OnStretch> found;
    for (const Index i : near) {
      const Foot here = on_piece(i, x);
      if (here.distance > reach) continue;
      const std::size_t stretch = pieces_[static_cast<std::size_t>(i)].stretch;
      if (found.empty() || found.back().stretch != stretch)
        found.push_back({stretch, here});
      else if (here.distance < found.back().foot.distance)
        found.back().foot = here;
    }
    return found;
  }

 private:
  struct StretchPiece {
    std::size_t stretch;
    Vec2 a, b;
    double s, length;
  };
  Foot on_piece(Index i, const Vec2& x) const {
    const StretchPiece& p = pieces_[static_cast<std::size_t>(i)];
    const double t = foot(x, p.a, p.b), d = (x - p.a - t * (p.b - p.a)).norm();
    return {d, p.s + t * p.length};
  }

  std::vector<StretchPiece> pieces_;
  BoxTree tree_;
};

Vec2 point_at(const Stretch& stretch, double s) {
  const auto above = std::ranges::upper_bound(stretch.s, s);
  const std::size_t i =
      std::clamp<std::size_t>(static_cast<std::size_t>(above - stretch.s.begin()), 1, stretch.s.size() - 1) - 1;
  const double t = (s - stretch.s[i]) / (stretch.s[i + 1] - stretch.s[i]);
  return (1 - t) * stretch.points[i] + t * stretch.points[i + 1];
}

// The boundary, cut.

/// Where two sides of a loop meet that do not stand for one curve.
class EndsOfSides {
 public:
  explicit EndsOfSides(const Loop& loop) {
    for (std::size_t i = 0; i < loop.sides.size(); ++i) {
      const Side &before = loop.sides[(i + loop.sides.size() - 1) % loop.sides.size()], &after = loop.sides[i];
      if (!(before.smooth && after.smooth)) ends_.push_back({after.start, after.start});
    }
    tree_ = BoxTree(ends_);
  }
  bool near(const Vec2& x, double tolerance) const {
    return std::ranges::any_of(tree_.meeting(AxisBox{x, x}.grown(tolerance)), [&](Index i) {
      return (ends_[static_cast<std::size_t>(i)].low - x).norm() <= tolerance;
    });
  }

 private:
  std::vector<AxisBox> ends_;
  BoxTree tree_;
};

/// Puts the mouths of cracks on the loop among its points.
// Displacements jump at a mouth: the two faces of the crack end there.
void add_mouths(Polygon& p, const Shape& shape, double tolerance, std::vector<Vec2>& mouths) {
  for (const Crack& crack : shape.cracks)
    for (const Vec2& end : {crack.points.front(), crack.points.back()})
      for (std::size_t i = 0; i < p.points.size(); ++i) {
        const Vec2 a = p.points[i], b = p.points[(i + 1) % p.points.size()];
        if (distance(end, a, b) > tolerance) continue;
        const Vec2 at = a + foot(end, a, b) * (b - a);
        mouths.push_back(at);
        if ((at - a).norm() <= tolerance || (at - b).norm() <= tolerance) break;
        p.points.insert(p.points.begin() + static_cast<std::ptrdiff_t>(i) + 1, at);
        p.label.insert(p.label.begin() + static_cast<std::ptrdiff_t>(i) + 1, p.label[i]);
        break;
      }
}

void cut(const Loop& loop, const Shape& shape, double size, Index label, std::vector<Stretch>& out) {
  const double tolerance = 2 * chord * size;
  const EndsOfSides ends(loop);
  Polygon p = flatten(loop, chord * size, size / 50);
  std::vector<Vec2> mouths;
  add_mouths(p, shape, tolerance, mouths);
  const std::size_t n = p.points.size();
  const auto begins = [&](std::size_t i) {
    const Vec2& x = p.points[i];
    if (std::ranges::any_of(mouths, [&](const Vec2& m) { return (m - x).norm() <= tolerance; })) return true;
    const Vec2 before = x - p.points[(i + n - 1) % n], after = p.points[(i + 1) % n] - x;
    const double turn = std::abs(std::atan2(before.x() * after.y() - before.y() * after.x(), before.dot(after)));
    return turn > corner_turn && ends.near(x, same_place * size);
  };
  std::size_t first = 0;
  while (first < n && !begins(first)) ++first;
  const bool closed = first == n;
  if (closed) first = 0;
  bool joins = false;
  for (std::size_t k = 0; k < n;) {
    Stretch stretch{.points = {p.points[(first + k) % n]}, .s = {0}, .labelled = {}, .closed = closed, .joins = joins};
    do {
      stretch.labelled.push_back(p.label[(first + k) % n] == label);
      const Vec2& next = p.points[(first + ++k) % n];
      stretch.s.push_back(stretch.s.back() + (next - stretch.points.back()).norm());
      stretch.points.push_back(next);
    } while (k < n && (closed || !begins((first + k) % n)));
    out.push_back(std::move(stretch));
    joins = true;
  }
}

// Readings on it.

struct Reading {
  Vec2 x, u;
};

/// How many are left out.
struct LeftReadings {
  std::size_t far = 0, elsewhere = 0;  // near no side; near other sides than the measured ones
};

/// To every stretch that is as near as the nearest one.
LeftReadings hand_out(const std::vector<Reading>& readings, double size, std::vector<Stretch>& stretches) {
  LeftReadings left;
  const NearPieces pieces(stretches, false);
  std::vector<bool> measured;
  for (const Stretch& stretch : stretches) measured.push_back(stretch.is_measured());
  for (const Reading& r : readings) {
    const auto feet = pieces.feet(r.x, same_place * size);
    const auto near = [&](const NearPieces::OnStretch& on) { return on.foot.distance <= reach * size; };
    if (std::ranges::none_of(feet, near)) {
      ++left.far;
      continue;
    }
    bool used = false;
    for (const auto& [i, foot] : feet) {
      stretches[i].at.push_back(foot.s);
      stretches[i].u.push_back(r.u);
      used = used || measured[i];
    }
    if (!used) ++left.elsewhere;
  }
  return left;
}

/// By arc length; those at one place are averaged.
void sort_readings(Stretch& stretch, double tolerance) {
  std::vector<std::size_t> order(stretch.at.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto key = [&](std::size_t i) {
    return std::tuple(stretch.at[i], stretch.u[i].x(), stretch.u[i].y());  // whatever the order of the file
  };
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  std::vector<double> at;
  std::vector<Vec2> u;
  for (std::size_t i = 0; i < order.size();) {
    Vec2 sum = Vec2::Zero();
    std::size_t count = 0;
    const double here = stretch.at[order[i]];
    for (; i < order.size() && stretch.at[order[i]] - here <= tolerance; ++i, ++count) sum += stretch.u[order[i]];
    at.push_back(here);
    u.push_back(sum / static_cast<double>(count));
  }
  stretch.at = std::move(at);
  stretch.u = std::move(u);
}

/// One after the other.
Stretch joined(Stretch a, const Stretch& b) {
  const double shift = a.length();
  a.points.insert(a.points.end(), b.points.begin() + 1, b.points.end());
  for (std::size_t i = 1; i < b.s.size(); ++i) a.s.push_back(shift + b.s[i]);
  a.labelled.insert(a.labelled.end(), b.labelled.begin(), b.labelled.end());
  for (const double s : b.at) a.at.push_back(shift + s);
  a.u.insert(a.u.end(), b.u.begin(), b.u.end());
  a.bends = true;
  return a;
}

/// Joins measured stretches that have less than two readings with the one before or after that has more of them.
void join_bare(std::vector<Stretch>& all, double tolerance) {
  for (std::size_t i = 0; i < all.size();) {
    if (!all[i].is_measured() || all[i].at.size() >= 2) {
      ++i;
      continue;
    }
    const std::size_t before = i > 0 && all[i].joins ? all[i - 1].at.size() : 0,
                      after = i + 1 < all.size() && all[i + 1].joins ? all[i + 1].at.size() : 0;
    if (std::max(before, after) == 0) {
      ++i;
      continue;
    }
    const std::size_t first = before >= after ? i - 1 : i;
    all[first] = joined(std::move(all[first]), all[first + 1]);
    all.erase(all.begin() + static_cast<std::ptrdiff_t>(first) + 1);
    sort_readings(all[first], tolerance);
    i = first;
  }
}

/// Linear in the arc length; beyond the outer readings of one that is not closed as between the outer one and the next
/// that is at least as far from it: an error of a reading is at most doubled.
Vec2 value_at(const Stretch& stretch, double s) {
  const std::vector<double>& at = stretch.at;
  const auto between = [&](std::size_t i, std::size_t j, double start, double end) {
    const double t = (s - start) / (end - start);
    return Vec2((1 - t) * stretch.u[i] + t * stretch.u[j]);
  };
  const std::size_t last = at.size() - 1;
  if (stretch.closed) {
    if (s < at.front()) return between(last, 0, at.back() - stretch.length(), at.front());
    if (s > at.back()) return between(last, 0, at.back(), at.front() + stretch.length());
  } else if (s < at.front()) {
    std::size_t j = 1;
    while (j < last && at[j] - at.front() < at.front() - s) ++j;
    return between(0, j, at.front(), at[j]);
  } else if (s > at.back()) {
    std::size_t j = last - 1;
    while (j > 0 && at.back() - at[j] < s - at.back()) --j;
    return between(j, last, at[j], at.back());
  }
  const auto above = std::ranges::upper_bound(at, s);
  const std::size_t i = std::clamp<std::size_t>(static_cast<std::size_t>(above - at.begin()), 1, last) - 1;
  return between(i, i + 1, at[i], at[i + 1]);
}

// What is wrong with them, and what is to be said.

struct Measured {
  std::vector<Stretch> stretches;  // with the label on them
  double size;
  std::string where;  // beginning of messages
  std::string label;
  std::optional<NearPieces> pieces = {};  // with the label on them
};

std::string at_point(const Vec2& x) {
  return fmt::format("({:.6g}, {:.6g})", x.x(), x.y());
}

[[noreturn]] void refuse(const Measured& m, const std::string& what) {
  throw Error(Fault::Usage, fmt::format("{}: {}", m.where, what));
}

void require_readings(const Measured& m, const Stretch& stretch) {
  if (stretch.at.size() >= 2) return;
  refuse(m, fmt::format("{} on \"{}\" from {} to {}; measure along the whole label, at 2 points at least between "
                        "its corners or around them",
                        stretch.at.empty() ? "there is no reading" : "there is only one reading", m.label,
                        at_point(stretch.points.front()), at_point(stretch.points.back())));
}

/// The boundary between two readings must be near the straight line between them.
void require_close(const Measured& m, const Stretch& stretch) {
  std::size_t k = 0;  // the interval of readings
  for (std::size_t i = 0; i < stretch.points.size(); ++i) {
    const bool on_label = (i > 0 && stretch.labelled[i - 1]) || (i < stretch.labelled.size() && stretch.labelled[i]);
    while (k + 1 < stretch.at.size() && stretch.at[k + 1] <= stretch.s[i]) ++k;
    if (!on_label || k + 1 >= stretch.at.size() || stretch.s[i] < stretch.at[k]) continue;
    const Vec2 a = point_at(stretch, stretch.at[k]), b = point_at(stretch, stretch.at[k + 1]);
    const double off = distance(stretch.points[i], a, b);
    if (off > reach * m.size)
      refuse(m,
             fmt::format("between the readings at {} and {} \"{}\" leaves the straight line by {:.4g} at {}; measure "
                         "more closely there, so that it leaves it by no more than {:.4g} (1 % of the body's size)",
                         at_point(a), at_point(b), m.label, off, at_point(stretch.points[i]), reach * m.size));
  }
}

/// Parts of the label beyond the outer readings: their length, and the longest, with where it ends.
struct Uncovered {
  double length = 0, longest = 0;
  Vec2 at = Vec2::Zero();
};

void find_uncovered(const Measured& m, const Stretch& stretch, Uncovered& out) {
  if (stretch.closed) return;
  double spacing = 0;
  for (std::size_t i = 1; i < stretch.at.size() && !stretch.bends; ++i)
    spacing = std::max(spacing, stretch.at[i] - stretch.at[i - 1]);
  for (std::size_t i = 0; i < stretch.labelled.size(); ++i) {
    if (!stretch.labelled[i]) continue;
    const double from = stretch.s[i], to = stretch.s[i + 1], before = stretch.at.front() - from,
                 after = to - stretch.at.back();
    out.length += std::clamp(before, 0.0, to - from) + std::clamp(after, 0.0, to - from);
    for (const auto& [beyond, end] : {std::pair(before, i), std::pair(after, i + 1)}) {
      if (beyond <= out.longest) continue;
      out.longest = beyond;
      out.at = stretch.points[end];
      if (beyond > std::max(reach * m.size, spacing))
        refuse(m, fmt::format("the data end {:.4g} before the boundary point {}; measure along the whole label \"{}\", "
                              "to its ends and corners or as near to them as the readings are apart",
                              beyond, at_point(out.at), m.label));
    }
  }
}

std::vector<std::string> checked(const Measured& m, const LeftReadings& left) {
  std::vector<std::string> notes;
  double length = 0;
  Uncovered uncovered;
  for (const Stretch& stretch : m.stretches) {
    require_readings(m, stretch);
    require_close(m, stretch);
    find_uncovered(m, stretch, uncovered);
    for (std::size_t i = 0; i < stretch.labelled.size(); ++i)
      if (stretch.labelled[i]) length += stretch.s[i + 1] - stretch.s[i];
  }
  if (uncovered.length > worth_saying * length)
    notes.push_back(fmt::format(
        "{}: {:.2g} % of \"{}\" lies beyond the outer readings, up to {:.3g} at {}: there displacements go on straight",
        m.where, 100 * uncovered.length / length, m.label, uncovered.longest, at_point(uncovered.at)));
  if (const std::size_t count = left.far + left.elsewhere; count > 0)
    notes.push_back(
        fmt::format("{}: {} reading{} left out: {} on other sides, {} further than {:.3g} from the boundary", m.where,
                    count, count == 1 ? " is" : "s are", left.elsewhere, left.far, reach * m.size));
  return notes;
}

Vec2 interpolate(const Measured& m, const Vec2& x, const Vec2& n) {
  const Stretch* best = nullptr;
  Foot nearest;
  double along = 0;  // of the normal, on the stretch: none where it is its own
  for (const auto& [k, f] : m.pieces->feet(x, same_place * m.size)) {
    const Stretch& stretch = m.stretches[k];
    if (f.distance > nearest.distance + same_place * m.size) continue;
    const auto piece = static_cast<std::size_t>(std::ranges::upper_bound(stretch.s, f.s) - stretch.s.begin());
    const std::size_t i = std::clamp<std::size_t>(piece, 1, stretch.s.size() - 1);
    const double here = std::abs(n.dot((stretch.points[i] - stretch.points[i - 1]).normalized()));
    if (f.distance < nearest.distance - same_place * m.size || here < along || !best)
      best = &stretch, nearest = f, along = here;
  }
  if (!best || !(nearest.distance <= reach * m.size))
    refuse(m, fmt::format("the boundary point {} is {:.4g} from \"{}\", along which the data are; no more than {:.4g} "
                          "(1 % of the body's size) would do",
                          at_point(x), nearest.distance, m.label, reach * m.size));
  return value_at(*best, nearest.s);
}

}  // namespace

MeasuredField read_measured(const std::filesystem::path& path, const Value& field, const Shape& shape, Index label) {
  std::vector<Reading> readings;
  for (const std::vector<double>& row : read_table(path, field, {"x", "y", "u_x", "u_y"}))
    readings.push_back({{row[0], row[1]}, {row[2], row[3]}});
  if (readings.size() < 2)
    fail(field.node->position,
         fmt::format("{}: {} has one point; give at least 2 along the boundary", field.name, quote(text(field))));
  const auto m = std::make_shared<Measured>(
      Measured{.stretches = {},
               .size = extent(shape),
               .where = fmt::format("{}: {} = {}", to_string(field.node->position), field.name, quote(text(field))),
               .label = shape.labels[static_cast<std::size_t>(label)]});
  std::vector<Stretch> all;
  cut(shape.outline, shape, m->size, label, all);
  for (const Loop& hole : shape.holes) cut(hole, shape, m->size, label, all);
  const LeftReadings left = hand_out(readings, m->size, all);
  for (Stretch& stretch : all) sort_readings(stretch, 1e-9 * m->size);
  join_bare(all, 1e-9 * m->size);
  for (Stretch& stretch : all)
    if (stretch.is_measured()) m->stretches.push_back(std::move(stretch));
  std::vector<std::string> notes = checked(*m, left);
  m->pieces.emplace(m->stretches, true);
  return {[m](const Vec2& x, const Vec2& n) { return interpolate(*m, x, n); }, std::move(notes)};
}

}  // namespace kerf
