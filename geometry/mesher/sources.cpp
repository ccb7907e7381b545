// What asks for short edges.
// Sources of the size field, each with a length and a place: tips (`crack_tip_size`), kinks, junctions, crossings of
// borders and reentrant corners (size/25), corners of regions (size/10), mouths of cracks (size/4), short sides (their
// length), ends of contact, curved sides (32 pieces per turn of the local circle of curvature, also of the images that
// a frame is mapped to), ligaments (size/8) and narrow gaps (gaps.cpp). At a singular point with a reach the size grows
// like the distance to the power .8 (size_field.hpp). With a background (an adaptive mesh) only what keeps the geometry
// counts, since the background knows the singular points.

#include "geometry/mesher/tips.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr double degree = pi / 180;
constexpr double corner_turn = reentrant_angle - pi;

double turn(const Vec2& in, const Vec2& out) {  // to the left, in (-pi, pi]
  return std::atan2(cross(in, out), in.dot(out));
}

/// Curved sides: 32 pieces per turn of a circle with the local radius of curvature, of the side itself and of its
/// images.
void add_curved(const Drawing& drawing, const Strand& strand, const Sizing& sizing, std::vector<Source>& sources) {
  const Arc& arc = *strand.arc;
  const double size = sizing.size;
  const double product = std::abs(determinant(arc));
  // The radius of curvature of the ellipse is v^3/|det|, that of its image under M is |M v|^3/(|det M| |det|), which
  // v/|M v| takes back to lengths of the drawing.
  const auto wanted = [&](double s) {
    const Vec2 along = velocity(arc, arc.from + s * (arc.to - arc.from));
    const double v = along.norm();
    double least = 2 * pi / 32 * v * v * v / product;
    for (const Mat2& image : sizing.images)
      least =
          std::min(least, 2 * pi / 32 * v * (image * along).squaredNorm() / (std::abs(image.determinant()) * product));
    return least;
  };
  // Between the tips and flanks of an ellipse the curvature is monotone: the ends of a stretch know its extremes.
  const double quarter = pi / 2;
  const auto [low, high] = std::minmax(arc.from, arc.to);
  std::vector<double> breaks{0, 1};
  const auto add_breaks = [&](const Mat2& axes) {
    const auto p = axes.col(0), q = axes.col(1);
    const double tip = std::atan2(-2 * p.dot(q), q.squaredNorm() - p.squaredNorm()) / 2;
    for (double t = tip + quarter * std::ceil((low - tip) / quarter); t < high; t += quarter)
      breaks.push_back((t - arc.from) / (arc.to - arc.from));
  };
  add_breaks(arc.axes);
  for (const Mat2& image : sizing.images) add_breaks(image * arc.axes);
  std::sort(breaks.begin(), breaks.end());
  std::vector<std::array<double, 2>> open;
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) open.push_back({breaks[i], breaks[i + 1]});
  while (!open.empty()) {
    const auto [from, to] = open.back();
    open.pop_back();
    const double middle = (from + to) / 2;
    const double least = std::min({wanted(from), wanted(middle), wanted(to)});
    const double length = velocity(drawing, strand, middle).norm() * (to - from);
    const double angle = (to - from) * std::abs(arc.to - arc.from);
    if (angle > pi / 8 || (least < size && length > 2 * least && angle > 1e-6)) {
      open.push_back({middle, to});
      open.push_back({from, middle});
    } else if (least < size) {
      sources.push_back({point(drawing, strand, from), point(drawing, strand, to), least});
    }
  }
}

/// What meets at the corners of a drawing.
struct AtCorners {
  std::vector<bool> on_loop;
  std::vector<bool> junction, crosses;  // where two cracks meet; where one crosses the border of a region
  std::vector<bool> smooth;             // one goes on where the other ends: parts of an interface
  std::vector<double> shortest;         // chord of the sides there
};

/// `smooth`: exactly two strands, both of interfaces, leave the corner in opposite directions up to 5 degrees.
AtCorners look_at_corners(const Drawing& drawing) {
  const std::size_t n = drawing.corners.size();
  AtCorners corners{std::vector<bool>(n, false), std::vector<bool>(n, false), std::vector<bool>(n, false),
                    std::vector<bool>(n, false), std::vector<double>(n, drawing.extent)};
  std::vector<bool> border(n, false);
  std::vector<int> of_cracks(n, 0);
  std::vector<Index> crack(n, none);  // the last one that was seen there
  for (const Strand& s : drawing.strands) {
    const double chord = (drawing.corners[std::size_t(s.to)] - drawing.corners[std::size_t(s.from)]).norm();
    for (const std::size_t v : {std::size_t(s.from), std::size_t(s.to)}) {
      if (s.crack == none) corners.shortest[v] = std::min(corners.shortest[v], chord);
      if (s.loop != none) corners.on_loop[v] = true;
      if (is_border(s)) border[v] = true;
      if (s.crack != none && !s.beyond) ++of_cracks[v];
      if (s.crack == none) continue;
      if (crack[v] != none && crack[v] != s.crack) corners.junction[v] = true;
      crack[v] = s.crack;
    }
  }
  std::vector<int> count(n, 0), interfaces(n, 0);
  std::vector<Vec2> away(n, Vec2::Zero());  // sum of their directions
  for (const Strand& s : drawing.strands)
    for (const bool start : {true, false}) {
      const auto v = std::size_t(start ? s.from : s.to);
      ++count[v];
      if (s.crack == none || !s.beyond) continue;
      ++interfaces[v];
      away[v] += (start ? 1 : -1) * velocity(drawing, s, start ? 0 : 1).normalized();
    }
  for (std::size_t v = 0; v < n; ++v) corners.crosses[v] = border[v] && of_cracks[v] > 1;
  for (std::size_t v = 0; v < n; ++v)
    corners.smooth[v] = count[v] == 2 && interfaces[v] == 2 && away[v].norm() < 5 * degree;
  return corners;
}

std::vector<double> crack_lengths(const Shape& shape, const Drawing& drawing) {
  std::vector<double> lengths(shape.cracks.size(), 0);
  for (const Strand& s : drawing.strands)
    if (s.crack != none) lengths[std::size_t(s.crack)] += length(drawing, s);
  return lengths;
}

struct Finder {
  const Drawing& drawing;
  const Sizing& sizing;
  const bool singular_points;
  const AtCorners corners;
  const std::vector<double> crack_length;
  const double corner = sizing.size / 25;  // kinks, junctions and reentrant corners are singular too, if less than tips
  const double mild = sizing.size / 10;    // and corners between materials
  std::vector<bool> asked = std::vector<bool>(drawing.corners.size(), false);  // junctions
  std::vector<bool> closes = std::vector<bool>(crack_length.size(), false);    // cracks without ends
  std::vector<Source> sources = {};

  void ask(Index v, double wanted, double reach = 0) {
    if (!singular_points) return;
    const Vec2& x = drawing.corners[std::size_t(v)];
    sources.push_back({x, x, wanted, std::min(reach, drawing.extent / 8)});
  }

  /// A tip, or a mouth.
  void ask_at_end(Index end, double reach) {
    if (corners.on_loop[std::size_t(end)])
      ask(end, sizing.size / 4);
    else if (!corners.junction[std::size_t(end)])
      ask(end, sizing.crack_tip_size, reach);
  }

  /// Tips that others or their own crack's other end are so near to that no ring of elements would fit between. Given a
  /// background it decides how much finer the mesh is.
  void ask_at_crowded_tips() {
    for (const TipEnd& tip : free_ends(drawing)) {
      const Vec2& x = drawing.corners[std::size_t(tip.corner)];
      const double size = singular_points ? size_in_room(tip.room, sizing.crack_tip_size) : largest_in_room(tip.room);
      if (size < (singular_points ? sizing.crack_tip_size : sizing.size)) sources.push_back({x, x, size});
    }
  }

  /// The last strand of a crack that begins with strand i, if it ends where that begins: then neither is an end.
  std::optional<std::size_t> closing(std::size_t i) {
    const Index crack = drawing.strands[i].crack;
    std::size_t last = i;
    while (last + 1 < drawing.strands.size() && drawing.strands[last + 1].crack == crack) ++last;
    if (drawing.strands[last].to != drawing.strands[i].from || corners.on_loop[std::size_t(drawing.strands[i].from)])
      return std::nullopt;
    closes[std::size_t(crack)] = true;
    return last;
  }

  /// A crack's own end asks with a reach of a quarter of its length: beyond that its field is no longer that of a tip.
  void ask_along_crack(std::size_t i) {
    const Strand& strand = drawing.strands[i];
    const double reach = crack_length[std::size_t(strand.crack)] / 4;
    const bool follows = i > 0 && drawing.strands[i - 1].crack == strand.crack;
    const bool last = i + 1 == drawing.strands.size() || drawing.strands[i + 1].crack != strand.crack;
    const std::optional<std::size_t> before = follows ? i - 1 : closing(i);
    const bool kink = before && std::abs(turn(velocity(drawing, drawing.strands[*before], 1),
                                              velocity(drawing, strand, 0))) > 5 * degree;
    for (const Index end : {strand.from, strand.to})
      if ((corners.junction[std::size_t(end)] || corners.crosses[std::size_t(end)]) &&
          !corners.smooth[std::size_t(end)] && !corners.on_loop[std::size_t(end)] && !asked[std::size_t(end)]) {
        asked[std::size_t(end)] = true;
        ask(end, corner, reach / 2);
      }
    if (kink && !corners.junction[std::size_t(strand.from)] && !corners.crosses[std::size_t(strand.from)])
      ask(strand.from, corner, reach / 2);  // milder than a tip
    if (!follows && !before) ask_at_end(strand.from, reach);
    if (last && !closes[std::size_t(strand.crack)]) ask_at_end(strand.to, reach);
    // The two ends of an arc that nearly closes.
    const Vec2 &a = drawing.corners[std::size_t(strand.from)], &b = drawing.corners[std::size_t(strand.to)];
    if (strand.arc && strand.from != strand.to && (b - a).norm() < std::min(sizing.size, length(drawing, strand) / 2))
      sources.push_back({a, b, (b - a).norm() / 2});
  }

  void ask_along_strands() {
    for (std::size_t i = 0; i < drawing.strands.size(); ++i) {
      const Strand& strand = drawing.strands[i];
      if (strand.arc) add_curved(drawing, strand, sizing, sources);
      // A short side is an edge of the mesh as it is: its neighbors grow from its length.
      const double side = length(drawing, strand);
      if (side < sizing.size && strand.from != strand.to)
        sources.push_back({drawing.corners[std::size_t(strand.from)], drawing.corners[std::size_t(strand.to)], side});
      if (strand.crack != none) ask_along_crack(i);
    }
  }

  /// At a corner of a region the stress is singular, but weaker than at a reentrant corner of the body.
  void ask_at_regions() {
    std::vector<Index> arriving(drawing.corners.size(), none);
    for (std::size_t i = 0; i < drawing.strands.size(); ++i)
      if (drawing.strands[i].region != none) arriving[std::size_t(drawing.strands[i].to)] = Index(i);
    for (const Strand& s : drawing.strands) {
      if (s.region == none || s.crack != none || arriving[std::size_t(s.from)] == none) continue;
      const Strand& before = drawing.strands[std::size_t(arriving[std::size_t(s.from)])];
      if (before.region != s.region) continue;  // where it shares its sides
      if (std::abs(turn(velocity(drawing, before, 1), velocity(drawing, s, 0))) > corner_turn)
        ask(s.from, mild, corners.shortest[std::size_t(s.from)] / 2);
    }
  }

  // A background knows nothing of them either.
  void ask_at_ends_of_contact() {
    for (const Vec2& x : sizing.ends) sources.push_back({x, x, end_size(sizing.size), 0});
  }

  void ask_at_reentrant_corners() {
    std::vector<bool> reentrant = reentrant_corners(drawing);
    for (const Strand& s : drawing.strands)
      if (s.keep) reentrant[std::size_t(s.from)] = reentrant[std::size_t(s.to)] = false;
    for (std::size_t v = 0; v < reentrant.size(); ++v)
      if (reentrant[v]) ask(Index(v), corner, corners.shortest[v] / 2);
  }
};

}  // namespace

std::vector<bool> reentrant_corners(const Drawing& drawing) {
  std::vector<Index> arriving(drawing.corners.size(), none);
  for (std::size_t i = 0; i < drawing.strands.size(); ++i)
    if (drawing.strands[i].loop != none) arriving[std::size_t(drawing.strands[i].to)] = Index(i);
  std::vector<bool> reentrant(drawing.corners.size(), false);
  for (const Strand& strand : drawing.strands)
    if (strand.loop != none) {
      // The body lies to the left of its loops: a turn to the right is a reentrant corner.
      const Strand& before = drawing.strands[std::size_t(arriving[std::size_t(strand.from)])];
      if (before.smooth && strand.smooth) continue;
      reentrant[std::size_t(strand.from)] =
          turn(velocity(drawing, before, 1), velocity(drawing, strand, 0)) < -corner_turn;
    }
  return reentrant;
}

std::vector<Source> find_sources(const Shape& shape, const Drawing& drawing, const Sizing& sizing,
                                 bool singular_points) {
  Finder find{drawing, sizing, singular_points, look_at_corners(drawing), crack_lengths(shape, drawing)};
  find.ask_along_strands();
  find.ask_at_crowded_tips();
  find.ask_at_regions();
  find.ask_at_reentrant_corners();
  find.ask_at_ends_of_contact();
  std::vector<Ligament> ligaments;
  if (sizing.long_ligaments) ligaments = find_ligaments(drawing);
  add_ligaments(drawing, ligaments, sizing.size, find.sources);
  add_gaps(shape, drawing, ligaments, sizing.size, sizing.across, find.sources);
  return std::move(find.sources);
}

}  // namespace kerf
