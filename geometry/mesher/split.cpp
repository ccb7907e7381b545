// Strands into pieces of the target length.
// A strand of length l gets round(int ds/h) pieces at equal steps of that integral, which is summed over parts no
// longer than h/2. Arcs of a body that are not followed become polygons with the area of the arcs: whole ellipses by
// factors that move their points outwards in proportion to the squares of the steps beside them, chains of arcs without
// corners by moving the points between them, so that stiffness and area are those of the curve to higher order. Cracks'
// own arcs and arcs that stand alone keep their points. Ligaments are divided at the same places on both sides, so that
// one layer of triangles fills them.

#include "geometry/mesher/size_field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace kerf {

namespace {

constexpr double max_pieces = 4e6;  // per strand
constexpr double widest = pi / 4;   // piece of an arc that an edge follows

/// Parameters that split a strand, or a part of a straight one, into pieces of about the target length: equal steps of
/// the integral of ds / h.
std::vector<double> spaced(const Drawing& drawing, const Strand& strand, const SizeField& field, int finer, bool curved,
                           std::array<double, 2> part = {0, 1}) {
  std::vector<double> s{part[0]}, steps{0};
  std::vector<std::array<double, 2>> open{part};
  const double longest = strand.arc ? 1.0 / 8 : 1;
  while (!open.empty()) {
    const auto [from, to] = open.back();
    open.pop_back();
    const double middle = (from + to) / 2, length = velocity(drawing, strand, middle).norm() * (to - from);
    const double h = size_at(field, point(drawing, strand, middle));
    if ((length > 0.5 * h || to - from > longest) && to - from > 1e-14) {
      open.push_back({middle, to});
      open.push_back({from, middle});
      continue;
    }
    s.push_back(to);
    steps.push_back(steps.back() + length / h);
    if (steps.back() > max_pieces)
      throw Error(Fault::Geometry,
                  fmt::format("the mesh would need more than {:g} edges along one side; raise mesh.size", max_pieces));
  }
  const bool whole = strand.arc && strand.from == strand.to;
  int count = std::max(whole ? 8 : 1, int(std::lround(steps.back())));
  if (strand.arc && curved)
    count = std::max(count, int(std::ceil(std::abs(strand.arc->to - strand.arc->from) / widest)));
  if (strand.arc) count *= finer;
  std::vector<double> at{part[0]};
  std::size_t k = 1;
  for (int i = 1; i < count; ++i) {
    const double target = steps.back() * i / count;
    while (steps[k] < target) ++k;
    at.push_back(s[k - 1] + (s[k] - s[k - 1]) * (target - steps[k - 1]) / (steps[k] - steps[k - 1]));
  }
  at.push_back(part[1]);
  return at;
}

/// Stretches of ligaments whose pieces are not shorter than half the width, per strand: the points that divide them,
/// the same on both sides. Elsewhere, as where contact ends, a ligament is filled as any narrow gap.
using Stretches = std::vector<std::vector<double>>;

/// At least four pieces: shorter ligaments are meshed like gaps. The other side gets the points straight across.
std::vector<Stretches> stretches_of(const Drawing& drawing, const SizeField& field) {
  std::vector<Stretches> all(drawing.strands.size());
  if (!field.long_ligaments) return all;
  for (const Ligament& l : find_ligaments(drawing)) {
    const Strand& crack = drawing.strands[std::size_t(l.crack)];
    const std::vector<double> s = spaced(drawing, crack, field, 1, false);
    const double whole = length(drawing, crack);
    const auto is_long = [&](std::size_t i) {
      return s[i] >= l.from && s[i + 1] <= l.to && 2 * whole * (s[i + 1] - s[i]) >= width(l, (s[i] + s[i + 1]) / 2);
    };
    for (std::size_t i = 0, end = 0; i + 1 < s.size(); i = std::max(end, i + 1)) {
      for (end = i; end + 1 < s.size() && is_long(end);) ++end;
      constexpr std::size_t fewest = 4;
      if (end < i + fewest) continue;
      std::vector<double> here(s.begin() + Index(i), s.begin() + Index(end) + 1), there;
      for (const double at : here) there.push_back(facing(l, at));
      if (there.front() > there.back()) std::ranges::reverse(there);
      all[std::size_t(l.crack)].push_back(std::move(here));
      all[std::size_t(l.other)].push_back(std::move(there));
    }
  }
  for (Stretches& stretches : all) std::ranges::sort(stretches);
  return all;
}

/// The points of a strand, and per piece whether it is one edge of the mesh.
struct Division {
  std::vector<double> s{0};
  std::vector<bool> keep;
};

Division divided(const Drawing& drawing, const Strand& strand, const SizeField& field, const Stretches& stretches) {
  Division d;
  const auto add = [&](const std::vector<double>& s, bool keep) {
    d.s.insert(d.s.end(), s.begin() + 1, s.end());
    d.keep.insert(d.keep.end(), s.size() - 1, keep);
  };
  for (const std::vector<double>& stretch : stretches) {
    add(spaced(drawing, strand, field, 1, false, {d.s.back(), stretch.front()}), false);
    add(stretch, true);
  }
  add(spaced(drawing, strand, field, 1, false, {d.s.back(), 1}), false);
  return d;
}

/// Factors that move the points of a whole ellipse away from its center, so that the polygon through them has its area.
/// In proportion to the squares of the steps beside them: where the steps are short the points hardly move.
/// m solves constant + m linear + m^2 quadratic = 0, the root near 0 written without cancellation.
std::vector<double> area_factors(const Arc& arc, const std::vector<double>& s) {
  const std::size_t n = s.size() - 1;
  std::vector<double> step(n), factor(n);
  for (std::size_t i = 0; i < n; ++i) step[i] = (s[i + 1] - s[i]) * std::abs(arc.to - arc.from);
  for (std::size_t i = 0; i < n; ++i) {
    const double before = step[(i + n - 1) % n];
    factor[i] = (before * before + step[i] * step[i]) / 24;
  }
  // Twice the area is sum (1 + m f_i) (1 + m f_j) sin(step): solve for m.
  double constant = -2 * pi, linear = 0, quadratic = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double sine = std::sin(step[i]), other = factor[(i + 1) % n];
    constant += sine;
    linear += sine * (factor[i] + other);
    quadratic += sine * factor[i] * other;
  }
  const double m = -2 * constant / (linear + std::sqrt(linear * linear - 4 * quadratic * constant));
  for (double& f : factor) f = 1 + m * f;
  return factor;
}

constexpr double same_direction = 1e-6;  // sine of the angle between tangents

/// Points of smooth curves that may leave them, where two pieces of arcs follow each other without a corner.
/// `mouth`: corners on cracks.
std::vector<bool> free_points(const Drawing& drawing, const Pieces& all, const std::vector<bool>& mouth) {
  struct Ends {
    int count = 0;
    bool arcs = true;
    std::array<Vec2, 2> tangent;
  };
  std::vector<Ends> at(all.points.size());
  for (const Piece& piece : all.pieces) {
    const Strand& strand = drawing.strands[std::size_t(piece.strand)];
    const bool of_factors = strand.from == strand.to && (strand.loop != none || !mouth[std::size_t(strand.from)]),
               arc = strand.arc && !of_factors && strand.crack == none && !strand.beyond;
    for (const auto& [v, s] : {std::pair{piece.a, piece.from}, std::pair{piece.b, piece.to}}) {
      Ends& ends = at[std::size_t(v)];
      ends.arcs = ends.arcs && arc;
      if (arc && ends.count < 2) ends.tangent[std::size_t(ends.count)] = velocity(drawing, strand, s).normalized();
      ++ends.count;
    }
  }
  std::vector<bool> free(at.size());
  for (std::size_t v = 0; v < free.size(); ++v)
    free[v] = at[v].arcs && at[v].count == 2 && std::abs(cross(at[v].tangent[0], at[v].tangent[1])) < same_direction &&
              at[v].tangent[0].dot(at[v].tangent[1]) > 0;
  // An arc of its own stays as drawn, unless it is the border of a region.
  std::vector<bool> joined(drawing.strands.size(), false);
  for (std::size_t k = 0; k < joined.size(); ++k)
    joined[k] = free[std::size_t(drawing.strands[k].from)] || free[std::size_t(drawing.strands[k].to)] ||
                drawing.strands[k].region != none;
  for (const Piece& piece : all.pieces)
    for (const Index v : {piece.a, piece.b})
      if (!joined[std::size_t(piece.strand)]) free[std::size_t(v)] = false;
  return free;
}

/// Moves points of smooth curves off their arcs, so that the polygon has the area that the arcs enclose, up to the
/// fourth power of the turn of a piece: the area between each chord and its arc goes to the ends that may move.
void keep_area(const Drawing& drawing, Pieces& all, const std::vector<bool>& mouth) {
  const std::vector<bool> free = free_points(drawing, all, mouth);
  std::vector<double> lacking(all.points.size(), 0.0);
  std::vector<Vec2> across(all.points.size(), Vec2::Zero());  // from the point before to the one after
  for (const Piece& piece : all.pieces) {
    const Strand& strand = drawing.strands[std::size_t(piece.strand)];
    const auto a = std::size_t(piece.a), b = std::size_t(piece.b);
    if (!free[a] && !free[b]) continue;
    const Vec2 chord = all.points[b] - all.points[a];
    across[a] += chord;
    across[b] += chord;
    const Arc& arc = *strand.arc;
    const double between =
        (cross(arc.center - all.points[a], chord) + determinant(arc) * (arc.to - arc.from) * (piece.to - piece.from)) /
        2;
    for (const auto end : {a, b})
      if (free[end]) lacking[end] += free[a] && free[b] ? between / 2 : between;
  }
  for (std::size_t v = 0; v < free.size(); ++v)
    if (free[v] && lacking[v] != 0)
      all.points[v] += 2 * lacking[v] / across[v].squaredNorm() * Vec2(across[v].y(), -across[v].x());
}

}  // namespace

/// Corners stay where they are, but for the seam of a whole circle, which is a point like the others.
Pieces split_to_size(const Drawing& drawing, const SizeField& field, int finer, bool curved) {
  Pieces all{drawing.corners, {}};
  std::vector<bool> mouth(drawing.corners.size(), false);
  for (const Strand& strand : drawing.strands)
    if (strand.crack != none) mouth[std::size_t(strand.from)] = mouth[std::size_t(strand.to)] = true;
  const std::vector<Stretches> stretches = stretches_of(drawing, field);
  for (std::size_t k = 0; k < drawing.strands.size(); ++k) {
    const Strand& strand = drawing.strands[k];
    Division division;
    if (strand.keep)
      division = {{0, 1}, {true}};
    else if (!stretches[k].empty())
      division = divided(drawing, strand, field, stretches[k]);
    else
      division.s = spaced(drawing, strand, field, finer, curved);
    const std::vector<double>& s = division.s;
    division.keep.resize(s.size() - 1, false);
    std::vector<double> factor(s.size() - 1, 1.0);
    if (!curved && strand.arc && strand.from == strand.to && !mouth[std::size_t(strand.from)])
      factor = area_factors(*strand.arc, s);
    const auto moved = [&](const Vec2& x, std::size_t i) -> Vec2 {
      return factor[i] == 1 ? x : strand.arc->center + factor[i] * (x - strand.arc->center);
    };
    all.points[std::size_t(strand.from)] = moved(all.points[std::size_t(strand.from)], 0);
    Index previous = strand.from;
    for (std::size_t i = 1; i < s.size(); ++i) {
      Index next = strand.to;
      if (i + 1 < s.size()) {
        next = Index(all.points.size());
        all.points.push_back(moved(point(drawing, strand, s[i]), i));
      }
      all.pieces.push_back({previous, next, Index(k), s[i - 1], s[i], division.keep[i - 1]});
      previous = next;
    }
  }
  if (!curved) keep_area(drawing, all, mouth);
  return all;
}

}  // namespace kerf
