// The negative set, step by step: signs, pieces, contours, sides; then less smoothing until the shape can be meshed.

#include "geometry/carve.hpp"

#include "geometry/carve/contour.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

namespace kerf {

namespace {

/// The first value of t for x that comes after `after` on the way of the arc.
double parameter(const Arc& arc, const Vec2& x, double after) {
  const double turn = 2 * std::numbers::pi, sign = arc.to < arc.from ? -1 : 1;
  const double ahead = sign * (parameter(arc, x) - after) / turn;
  return after + sign * turn * (ahead - std::floor(ahead));
}

struct Sources {
  const Shape& frame;
  const Mesh& mesh;
  const Signs& signs;
  const Rim& rim;

  Vec2 at(const ContourNode& node) const {
    return node.vertex == none ? place(frame, mesh, signs, rim, node.edge) : mesh.points[std::size_t(node.vertex)];
  }
};

bool touched(const Contour& contour) {
  return std::ranges::find(contour.strand, none) != contour.strand.end();
}

/// Part of a contour: along one strand of the frame, or a piece of zero line.
struct Run {
  std::size_t begin, end;  // nodes, the end beyond the number of nodes where it wraps around
  Index strand = none;
  std::size_t chain = 0;  // of those of all contours
};

/// The contours in runs, and the zero lines among them before and after sampling, with their room.
struct Lines {
  std::vector<std::vector<Run>> runs;  // per contour
  std::vector<Chain> chains, fine;
  std::vector<std::vector<Room>> room;
};

Lines lines_of(const Sources& from, const std::vector<Contour>& contours, const std::vector<CrackPart>& parts,
               const Carving& how) {
  Lines lines;
  std::vector<Obstacle> obstacles;
  Index group = 0;
  std::map<Index, Index> at_mouth;  // cut edge -> the group of the crack that is cut there
  for (const CrackPart& part : parts) {
    for (const Index e : {part.from.edge, part.to.edge})
      if (e != none) at_mouth[e] = group;
    const int pieces = part.shape.arc ? 32 : 1;
    for (std::size_t i = 0; i + 1 < part.shape.points.size(); ++i) {
      Vec2 before = part.shape.points[i];
      for (int k = 1; k <= pieces; ++k) {
        Vec2 x = part.shape.points[i + 1];
        if (k < pieces)
          x = at(*part.shape.arc, part.shape.arc->from + (part.shape.arc->to - part.shape.arc->from) * k / pieces);
        obstacles.push_back({before, x, group});
        before = x;
      }
    }
    ++group;
  }
  for (const Contour& contour : contours) {
    const std::size_t n = contour.nodes.size();
    const auto link = [&](std::size_t i) { return contour.strand[i % n]; };
    std::size_t first = 0;  // start where the kind of boundary changes
    while (first < n && link(first) == link(first + n - 1)) ++first;
    const bool whole = first == n;
    std::vector<Run> runs;
    for (std::size_t begin = first % n; begin < first % n + n;) {
      std::size_t end = whole ? begin + n : begin + 1;
      while (end < first % n + n && link(end) == link(begin)) ++end;
      runs.push_back({begin, end, link(begin), lines.chains.size()});
      if (link(begin) == none) lines.chains.emplace_back();
      begin = end;
    }
    for (std::size_t r = 0; r < runs.size(); ++r) {  // run r is group `group` + r
      const auto& [begin, end, strand, number] = runs[r];
      if (strand != none) {
        for (std::size_t i = begin; i < end; ++i)
          obstacles.push_back({from.at(contour.nodes[i % n]), from.at(contour.nodes[(i + 1) % n]), group + Index(r)});
        continue;
      }
      Chain& chain = lines.chains[number];
      chain.closed = whole;
      for (std::size_t i = begin; i < end + (whole ? 0 : 1); ++i) {
        const ContourNode& node = contour.nodes[i % n];
        const auto mouth = at_mouth.find(node.edge);
        Index meets = mouth == at_mouth.end() ? none : mouth->second;
        if (!whole && i == begin) meets = group + Index((r + runs.size() - 1) % runs.size());
        if (!whole && i == end) meets = group + Index((r + 1) % runs.size());
        chain.points.push_back(from.at(node));
        chain.fixed.push_back(meets != none);
        chain.meets.push_back(meets);
      }
    }
    group += Index(runs.size());
    lines.runs.push_back(std::move(runs));
  }
  for (std::size_t e = 0; e < from.mesh.edges.size() && !from.frame.regions.empty(); ++e)
    if (is_interface(from.mesh, Index(e)))
      obstacles.push_back({from.mesh.points[std::size_t(from.mesh.edges[e][0])],
                           from.mesh.points[std::size_t(from.mesh.edges[e][1])], group});
  for (const Chain& chain : lines.chains) lines.fine.push_back(sample(chain, how.spacing));
  lines.room = room(lines.fine, obstacles, 2 * how.tolerance);
  return lines;
}

/// How closely the sides follow what the background says.
struct Style {
  double part;  // of the tolerance for smoothing; 0: not at all
  bool arcs;    // curved sides stay curved where the zero line cuts them
};

Side along_strand(const Sources& from, const Contour& contour, const Run& run) {
  const std::size_t n = contour.nodes.size();
  const ContourNode &first = contour.nodes[run.begin % n], &last = contour.nodes[run.end % n];
  const Strand& strand = from.rim.drawing.strands[std::size_t(run.strand)];
  Side side{from.at(first), strand.label, std::nullopt};
  if (!strand.arc) {
    side.keep = strand.keep && first.vertex != none && last.vertex != none;
    return side;
  }
  Arc arc = *strand.arc;
  const auto corner = [&](const ContourNode& node, Index c) {
    return strand.from != strand.to && node.vertex != none &&
           (from.mesh.points[std::size_t(node.vertex)] - from.rim.drawing.corners[std::size_t(c)]).norm() <=
               join_tolerance * from.rim.drawing.extent;
  };
  const double hair = arc.to < arc.from ? -1e-7 : 1e-7;  // corners may lie that far before the arc's own start
  arc.from = corner(first, strand.from) ? strand.arc->from : parameter(arc, side.start, arc.from - hair);
  arc.to = corner(last, strand.to) ? strand.arc->to : parameter(arc, from.at(last), arc.from);
  side.arc = arc;
  return side;
}

/// The contour as sides: runs along one strand become one side, runs of zero line are simplified.
Loop loop_of(const Sources& from, const Lines& lines, const Contour& contour, const std::vector<Run>& runs,
             const Simplifying& how, const Style& style) {
  const std::size_t n = contour.nodes.size(), design = from.frame.labels.size();
  Loop loop;
  for (const Run& run : runs) {
    if (run.strand == none) {
      const std::size_t c = run.chain;
      const Chain chain =
          style.part > 0 ? simplify(lines.chains[c], lines.fine[c], lines.room[c], how) : lines.chains[c];
      const std::size_t count = chain.points.size() - (chain.closed ? 0 : 1);
      for (std::size_t i = 0; i < count; ++i)
        loop.sides.push_back({chain.points[i], Index(design), std::nullopt, false, true});
    } else if (const Strand& strand = from.rim.drawing.strands[std::size_t(run.strand)]; strand.arc && !style.arcs) {
      for (std::size_t i = run.begin; i < run.end; ++i)
        loop.sides.push_back({from.at(contour.nodes[i % n]), strand.label, std::nullopt, false, true});
    } else {
      loop.sides.push_back(along_strand(from, contour, run));
    }
  }
  return loop;
}

/// Frame loops whose boundary a contour follows, as numbers of Strand::loop.
std::set<Index> follows(const Rim& rim, const Contour& contour) {
  std::set<Index> loops;
  for (const Index s : contour.strand)
    if (s != none) loops.insert(rim.drawing.strands[std::size_t(s)].loop);
  return loops;
}

double area_of(const Sources& from, const Contour& contour) {
  double twice = 0;
  const Vec2 origin = from.at(contour.nodes.front());
  Vec2 before = Vec2::Zero();
  for (std::size_t i = 1; i < contour.nodes.size(); ++i) {
    const Vec2 x = from.at(contour.nodes[i]) - origin;
    twice += cross(before, x);
    before = x;
  }
  return twice / 2;
}

std::string unused(const std::string& wanted, const char* separator, std::set<std::string>& used) {
  std::string name = wanted;
  for (int i = 2; used.contains(name); ++i) name = fmt::format("{}{}{}", wanted, separator, i);
  used.insert(name);
  return name;
}

Shape assemble(const Sources& from, const std::vector<Contour>& loops, const Lines& lines,
               const std::vector<CrackPart>& parts, const Simplifying& how, const Style& style) {
  const Shape& frame = from.frame;
  Shape shape;
  shape.labels = frame.labels;
  std::set<std::string> labels(frame.labels.begin(), frame.labels.end());
  shape.labels.push_back(unused("design", ".", labels));
  shape.regions = frame.regions;

  std::size_t outer = 0;
  double largest = 0;
  for (std::size_t l = 0; l < loops.size(); ++l)
    if (const double area = area_of(from, loops[l]); area > largest) outer = l, largest = area;
  std::set<std::string> used;
  for (const Loop& hole : frame.holes) used.insert(hole.name);
  std::set<Index> named;
  for (std::size_t l = 0; l < loops.size(); ++l) {
    const std::set<Index> of = follows(from.rim, loops[l]);
    Loop loop;
    if (!touched(loops[l])) {
      loop = *of.begin() == 0 ? frame.outline : frame.holes[std::size_t(*of.begin()) - 1];
    } else {
      loop = loop_of(from, lines, loops[l], lines.runs[l], how, style);
      loop.name = frame.outline.name;
    }
    if (l == outer) {
      shape.outline = std::move(loop);
      continue;
    }
    if (touched(loops[l])) {
      const auto own = std::ranges::find_if(of, [&](Index i) { return i > 0 && !named.contains(i); });
      if (own != of.end()) named.insert(*own);
      loop.name = own != of.end() ? frame.holes[std::size_t(*own) - 1].name : unused("design", " ", used);
    }
    shape.holes.push_back(std::move(loop));
  }
  std::set<std::string> cracks, first;
  for (const Crack& crack : frame.cracks) cracks.insert(crack.name);
  for (const CrackPart& part : parts) {
    const std::string& name = frame.cracks[std::size_t(part.crack)].name;
    shape.cracks.push_back(part.shape);
    shape.cracks.back().name = first.insert(name).second ? name : unused(name, ".", cracks);
  }
  return shape;
}

/// What keeping crossings clear of vertices took from the area, per length of the zero line.
double offset(const Sources& from, const std::vector<Contour>& loops) {
  Signs exact = from.signs;
  std::fill(exact.clear.begin(), exact.clear.end(), 0.0);
  double area = 0, length = 0;
  for (std::size_t t = 0; t < from.mesh.triangles.size(); ++t)
    area += inside_area(from.mesh, exact, Index(t)) - inside_area(from.mesh, from.signs, Index(t));
  for (const Contour& loop : loops)
    for (std::size_t i = 0; i < loop.nodes.size(); ++i)
      if (loop.strand[i] == none)
        length += (from.at(loop.nodes[i]) - from.at(loop.nodes[(i + 1) % loop.nodes.size()])).norm();
  return length > 0 ? area / length : 0;
}

double shape_area(const Shape& shape) {
  double sum = std::abs(signed_area(shape.outline));
  for (const Loop& hole : shape.holes) sum -= std::abs(signed_area(hole));
  return sum;
}

/// How much of the frame's boundary is left, where that is not all of it.
void note_labels(const Shape& frame, const Shape& shape, const Carving& how, std::vector<std::string>& notes) {
  const auto lengths = [&](const Shape& s) {
    std::vector<double> length(frame.labels.size() + 1, 0);
    const auto add = [&](const Loop& loop) {
      for (std::size_t i = 0; i < loop.sides.size(); ++i) {
        const Side& side = loop.sides[i];
        if (side.label == none) continue;
        length[std::size_t(side.label)] +=
            side.arc ? kerf::length(*side.arc) : (loop.sides[(i + 1) % loop.sides.size()].start - side.start).norm();
      }
    };
    add(s.outline);
    for (const Loop& hole : s.holes) add(hole);
    return length;
  };
  const std::vector<double> before = lengths(frame), after = lengths(shape);
  for (std::size_t l = 0; l < frame.labels.size(); ++l) {
    if (!(before[l] > 0) || after[l] >= before[l] * (1 - 1e-3)) continue;
    const bool kept = std::ranges::find(how.keep, Index(l)) != how.keep.end();
    if (after[l] == 0)
      notes.push_back(fmt::format("nothing is left of the boundary '{}'", frame.labels[l]));
    else if (kept)
      notes.push_back(
          fmt::format("{:.3g} of {:.3g} is left of the boundary '{}'", after[l], before[l], frame.labels[l]));
  }
}

Carving checked(const Shape& frame, const Mesh& mesh, Carving how) {
  const auto usable = [](double x) { return std::isfinite(x) && x >= 0; };
  if (!usable(how.tolerance) || !usable(how.spacing) || !usable(how.least_area) || !usable(how.least_width))
    throw std::invalid_argument("tolerance, spacing, least area and width of a carving must be 0 or positive");
  for (const std::vector<Index>* labels : {&how.keep, &how.holding})
    for (const Index l : *labels)
      if (l < 0 || l >= Index(frame.labels.size()))
        throw std::invalid_argument(fmt::format("label {} to keep of a frame with {}", l, frame.labels.size()));
  if (mesh.triangles.empty()) throw std::invalid_argument("an empty background");
  if (how.spacing == 0) {
    double sum = 0;
    for (std::size_t e = 0; e < mesh.edges.size(); ++e) sum += length(mesh, Index(e));
    how.spacing = sum / double(mesh.edges.size());
  }
  if (how.tolerance == 0) how.tolerance = how.spacing / 10;
  how.tolerance = std::max(how.tolerance, 32 * join_tolerance * extent(frame));  // cracks join what is nearer
  how.least_width = std::clamp(how.least_width, how.tolerance, std::max(how.tolerance, how.spacing / 2));
  return how;
}

/// The shape of a function as it is; or what keeps it from being one.
struct Attempt {
  Carved carved;
  std::string problem;  // of the smoothest shape; empty if that is good
  bool good = false;
};

Attempt attempt(const Shape& frame, const Mesh& mesh, const Rim& rim, const Eigen::VectorXd& phi, const Carving& how) {
  Attempt result;
  Carved& carved = result.carved;
  Signs signs = signs_of(mesh, phi);
  clean(frame, mesh, rim, how, signs, carved.notes);
  choose_pieces(frame, mesh, how, signs, carved.notes);
  const std::vector<Contour> loops = contours(mesh, signs, rim);
  const std::vector<CrackPart> parts = cut_cracks(frame, mesh, signs, rim, 4 * how.tolerance, carved.notes);
  const Sources sources{frame, mesh, signs, rim};
  const double missing = offset(sources, loops);
  const Lines lines = lines_of(sources, loops, parts, how);
  for (const Style style : {Style{1, true}, Style{1, false}, Style{0.25, true}, Style{0, true}, Style{0, false}}) {
    const double within = 0.4 * style.part * how.tolerance;
    carved.shape = assemble(sources, loops, lines, parts, {how.spacing, within, within, missing}, style);
    const auto found = find_problem(carved.shape);
    if (found) {
      if (result.problem.empty()) result.problem = *found;
      continue;
    }
    result.good = true;
    if (style.part < 1)
      carved.notes.push_back(
          fmt::format("{} ({})", style.part > 0 ? "smoothed less" : "did not smooth", result.problem));
    if (!style.arcs) carved.notes.push_back(fmt::format("drew curved sides as polygons ({})", result.problem));
    note_labels(frame, carved.shape, how, carved.notes);
    carved.design_label = Index(frame.labels.size());
    carved.area = shape_area(carved.shape);
    for (const CrackPart& p : parts) carved.crack_of.push_back(p.crack);
    return result;
  }
  return result;
}

/// How much phi changes over a length along its zero line, in the mean.
double slope(const Mesh& mesh, const Eigen::VectorXd& phi) {
  double sum = 0, length = 0;
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    const auto& [a, b] = mesh.edges[e];
    if ((phi[a] < 0) == (phi[b] < 0)) continue;
    sum += std::abs(phi[b] - phi[a]);
    length += kerf::length(mesh, Index(e));
  }
  return length > 0 ? sum / length : 0;
}

}  // namespace

Carved carve(const Shape& frame, const Mesh& mesh, const Eigen::VectorXd& phi, const Carving& given) {
  const Carving how = checked(frame, mesh, given);
  const Rim rim = find_rim(frame, mesh);
  Attempt first = attempt(frame, mesh, rim, phi, how);
  if (first.good) return std::move(first.carved);
  const double unit = slope(mesh, phi) * how.tolerance;
  for (const double part : {-0.25, 0.25, -0.75, 0.75}) {
    try {
      Attempt next = attempt(frame, mesh, rim, (phi.array() + part * unit).matrix(), how);
      if (!next.good) continue;
      next.carved.notes.push_back(fmt::format("shifted the function by {:.3g}, {} the body ({})", part * unit,
                                              part < 0 ? "thickening" : "thinning", first.problem));
      return std::move(next.carved);
    } catch (const Error&) {
      // The shift has cut something off: the next one.
    }
  }
  throw Error(Fault::Geometry, fmt::format("the zero line makes no shape that can be meshed: {}", first.problem));
}

}  // namespace kerf
