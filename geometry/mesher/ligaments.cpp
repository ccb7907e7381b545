// Thin ligaments: where a straight crack runs along a straight side or another crack.
// A ligament is at least 40 times longer than it is wide, its two sides straight and parallel up to a tenth, nothing
// between them. It is meshed with one layer of triangles, long ones: beams are right with that to the order (k h)^2/12
// of their bending [theory: C.35]. Its ends, twice its width long, are meshed as any gap. Of candidates the narrowest
// are taken first; a strand is divided by one crack at a time. See "Beneath a side" in docs/theory/contact.md.

#include "geometry/mesher/size_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace kerf {

namespace {

constexpr double slender = 40;    // length over width from which triangles may be longer than the ligament is wide
constexpr double end_zone = 2;    // widths at either end that are meshed as any narrow gap
constexpr double steepest = 0.1;  // sine of the angle between the two

bool is_straight(const Strand& s) {
  return !s.arc && !s.keep && s.from != s.to;
}

struct Ends {
  Vec2 a, b;
};
Ends ends_of(const Drawing& drawing, const Strand& s) {
  return {drawing.corners[std::size_t(s.from)], drawing.corners[std::size_t(s.to)]};
}

/// Along and away from the crack, the first in its lengths.
Vec2 seen_from(const Ends& crack, const Vec2& x) {
  const Vec2 d = crack.b - crack.a;
  const double length = d.norm();
  return {(x - crack.a).dot(d) / (length * length), cross(d, x - crack.a) / length};
}

/// The width at s of a ligament, signed: positive to the left of the crack.
double width_at(const Ligament& l, double s) {
  return l.width[0] + (s - l.from) / (l.to - l.from) * (l.width[1] - l.width[0]);
}

/// Whether a segment, seen from the crack, comes between the two.
bool between(const Ligament& l, Vec2 a, Vec2 b) {
  if (a.x() > b.x()) std::swap(a, b);
  if (b.x() < l.from || a.x() > l.to) return false;
  const double sign = l.width[0] > 0 ? 1 : -1;
  const auto at = [&](double s) -> Vec2 {
    return b.x() > a.x() ? Vec2(a + std::clamp((s - a.x()) / (b.x() - a.x()), 0.0, 1.0) * (b - a)) : a;
  };
  const std::array<Vec2, 3> seen{at(l.from), at(l.to), b};  // b: where the segment stands upright
  const auto count = std::size_t(b.x() > a.x() ? 2 : 3);
  bool all_below = true, all_above = true;
  for (std::size_t i = 0; i < count; ++i) {
    all_below = all_below && sign * seen[i].y() <= 0;
    all_above = all_above && sign * (seen[i].y() - width_at(l, seen[i].x())) >= 0;
  }
  return !all_below && !all_above;
}

bool is_clear(const Drawing& drawing, const Ends& crack, const Ligament& l) {
  for (std::size_t k = 0; k < drawing.strands.size(); ++k) {
    if (Index(k) == l.crack || Index(k) == l.other) continue;
    const Strand& strand = drawing.strands[k];
    const int count = strand.arc ? 64 : 1;
    for (int i = 0; i < count; ++i)
      if (between(l, seen_from(crack, point(drawing, strand, double(i) / count)),
                  seen_from(crack, point(drawing, strand, double(i + 1) / count))))
        return false;
  }
  return true;
}

/// Between a crack's strand and another strand, as if nothing else were there.
std::optional<Ligament> ligament_of(const Drawing& drawing, Index k, Index o) {
  const Strand &crack = drawing.strands[std::size_t(k)], &other = drawing.strands[std::size_t(o)];
  if (crack.from == other.from || crack.from == other.to || crack.to == other.from || crack.to == other.to)
    return std::nullopt;
  const Ends here = ends_of(drawing, crack), there = ends_of(drawing, other);
  const Vec2 d = here.b - here.a, along = there.b - there.a;
  if (std::abs(cross(d, along)) > steepest * d.norm() * along.norm()) return std::nullopt;
  const Vec2 a = seen_from(here, there.a), b = seen_from(here, there.b);
  const double turn = b.x() - a.x();
  // Feet lie on the other strand where the way straight across from the crack meets it.
  const auto away = [&](double s) { return a.y() + (s - a.x()) / turn * (b.y() - a.y()); };
  Ligament l{.crack = k,
             .other = o,
             .from = std::max(0.0, std::min(a.x(), b.x())),
             .to = std::min(1.0, std::max(a.x(), b.x()))};
  if (!(l.from < l.to)) return std::nullopt;
  const double zone = end_zone / d.norm();
  const double from = l.from + zone * std::abs(away(l.from)), to = l.to - zone * std::abs(away(l.to));
  l.from = from;
  l.to = to;
  if (!(from < to)) return std::nullopt;
  l.width = {away(from), away(to)};
  const double widest = std::max(std::abs(l.width[0]), std::abs(l.width[1]));
  if (!(l.width[0] * l.width[1] > 0) || slender * widest > (to - from) * d.norm()) return std::nullopt;
  if (std::min(std::abs(l.width[0]), std::abs(l.width[1])) < touch_tolerance * drawing.extent) return std::nullopt;
  // A side has the body on its left alone.
  if (other.loop != none && (turn > 0) == (l.width[0] > 0)) return std::nullopt;
  l.other_from = (from - a.x()) / turn;
  l.other_to = (to - a.x()) / turn;
  return l;
}

bool overlap(double a, double b, double c, double d) {
  return std::max(std::min(a, b), std::min(c, d)) < std::min(std::max(a, b), std::max(c, d));
}

}  // namespace

double width(const Ligament& l, double s) {
  return std::abs(width_at(l, s));
}

double facing(const Ligament& l, double s) {
  return l.other_from + (s - l.from) / (l.to - l.from) * (l.other_to - l.other_from);
}

std::vector<Ligament> find_ligaments(const Drawing& drawing) {
  std::vector<Ligament> found;
  for (std::size_t k = 0; k < drawing.strands.size(); ++k) {
    if (drawing.strands[k].crack == none || !is_straight(drawing.strands[k])) continue;
    for (std::size_t o = 0; o < drawing.strands.size(); ++o) {
      const Strand& other = drawing.strands[o];
      if (o == k || (other.crack == none && other.loop == none) || !is_straight(other)) continue;
      if (const auto l = ligament_of(drawing, Index(k), Index(o))) found.push_back(*l);
    }
  }
  std::ranges::stable_sort(found, {}, [](const Ligament& l) { return std::abs(l.width[0]); });
  // A strand is divided by one crack along each of its parts, or divides another.
  std::vector<Ligament> taken;
  for (const Ligament& l : found) {
    const bool free = std::ranges::none_of(taken, [&](const Ligament& t) {
      return t.crack == l.crack || t.other == l.crack || t.crack == l.other ||
             (t.other == l.other && overlap(t.other_from, t.other_to, l.other_from, l.other_to));
    });
    if (free && is_clear(drawing, ends_of(drawing, drawing.strands[std::size_t(l.crack)]), l)) taken.push_back(l);
  }
  return taken;
}

void add_ligaments(const Drawing& drawing, const std::vector<Ligament>& ligaments, double size,
                   std::vector<Source>& sources) {
  constexpr double share =
      1.0 / 8;  // bending is right to the first order there, elsewhere to the second [theory: C.35]
  for (const Ligament& l : ligaments) {
    const Strand& crack = drawing.strands[std::size_t(l.crack)];
    sources.push_back({point(drawing, crack, l.from), point(drawing, crack, l.to), share * size});
  }
}

bool in_ligament(const std::vector<Ligament>& ligaments, Index strand, Index other, double from, double to) {
  return std::ranges::any_of(ligaments, [&](const Ligament& l) {
    if (l.crack == strand && l.other == other) return l.from <= from && to <= l.to;
    if (l.other != strand || l.crack != other) return false;
    return std::min(l.other_from, l.other_to) <= from && to <= std::max(l.other_from, l.other_to);
  });
}

}  // namespace kerf
