// The negative set, step by step: signs, pieces, contours, sides; then less smoothing until the shape can be meshed.
// 1. signs of phi at the vertices; thin necks, slits and near misses are cleaned away by turning signs (clean.cpp);
// 2. one connected body with its loads and supports, small holes filled (choose_pieces.cpp);
// 3. closed contours of the zero line and the frame, cracks cut to what is inside (contours.cpp, cut_cracks.cpp);
// 4. zero lines as few, smooth sides within the tolerance, without a change of area (simplify.cpp).
// If the shape cannot be meshed, step 4 is repeated with less smoothing, with polygons for cut arcs, and without
// smoothing; then phi is shifted by up to .75 of the tolerance times its mean slope, both ways. Notes say what was
// done. "Drawn designs" in docs/theory/level_set.md says how designs are used further.

#include "geometry/carve.hpp"

#include "geometry/carve/contours.hpp"
#include "geometry/carve/simplify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace kerf {

namespace {

/// The first value of t for x that comes after `after` on the way of the arc.
double parameter(const Arc& arc, const Vec2& x, double after) {
  const double turn = 2 * pi, sign = arc.to < arc.from ? -1 : 1;
  const double ahead = sign * (parameter(arc, x) - after) / turn;
  return after + sign * turn * (ahead - std::floor(ahead));
}

/// What a function has cut out of the block.
struct Cut {
  const Block& block;
  Signs signs;
  std::vector<Contour> contours;
  std::vector<CrackPart> cracks;

  Vec2 at(const ContourNode& node) const {
    return node.vertex == none ? place(block, signs, node.edge) : block.mesh.points[std::size_t(node.vertex)];
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

/// The contours in runs, and the zero lines among them before and after sampling, with their clearance.
struct Lines {
  std::vector<std::vector<Run>> runs;  // per contour
  std::vector<Chain> chains, fine;
  std::vector<std::vector<Clearance>> clearance;
};

/// What the zero lines must not meet, in groups: cracks, runs along the frame, regions.
struct Obstacles {
  std::vector<Obstacle> all;
  Index group = 0;                  // the next one
  std::map<Index, Index> at_mouth;  // cut edge -> the group of the crack that is cut there
};

/// A crack that is cut at the zero line is met there and nowhere else: the group tells the line's point that may touch
/// it.
void add_cracks(const std::vector<CrackPart>& parts, Obstacles& obstacles) {
  for (const CrackPart& part : parts) {
    for (const Index e : {part.from.edge, part.to.edge})
      if (e != none) obstacles.at_mouth[e] = obstacles.group;
    std::vector<Vec2> path = part.shape.points;
    if (part.shape.arc) {
      path = points_on(*part.shape.arc, 32);
      path.front() = part.shape.points.front();
      path.back() = part.shape.points.back();
    }
    for (std::size_t i = 0; i + 1 < path.size(); ++i) obstacles.all.push_back({path[i], path[i + 1], obstacles.group});
    ++obstacles.group;
  }
}

void add_regions(const Block& block, Obstacles& obstacles) {
  for (std::size_t e = 0; e < block.mesh.edges.size() && !block.frame.regions.empty(); ++e)
    if (is_interface(block.mesh, Index(e)))
      obstacles.all.push_back({block.mesh.points[std::size_t(block.mesh.edges[e][0])],
                               block.mesh.points[std::size_t(block.mesh.edges[e][1])], obstacles.group});
}

/// Pieces of zero line are numbered from `chains` on.
std::vector<Run> runs_of(const Contour& contour, std::size_t chains) {
  const std::size_t n = contour.nodes.size();
  const auto link = [&](std::size_t i) { return contour.strand[i % n]; };
  std::size_t first = 0;  // start where the kind of boundary changes
  while (first < n && link(first) == link(first + n - 1)) ++first;
  const bool whole = first == n;
  std::vector<Run> runs;
  for (std::size_t begin = first % n; begin < first % n + n;) {
    std::size_t end = whole ? begin + n : begin + 1;
    while (end < first % n + n && link(end) == link(begin)) ++end;
    runs.push_back({begin, end, link(begin), chains});
    if (link(begin) == none) ++chains;
    begin = end;
  }
  return runs;
}

void add_along_frame(const Cut& cut, const Contour& contour, const Run& run, Index group, Obstacles& obstacles) {
  const std::size_t n = contour.nodes.size();
  for (std::size_t i = run.begin; i < run.end; ++i)
    obstacles.all.push_back({cut.at(contour.nodes[i % n]), cut.at(contour.nodes[(i + 1) % n]), group});
}

/// Run r as a chain. Run k of the contour is group `group` + k of the obstacles.
Chain chain_of(const Cut& cut, const Contour& contour, const std::vector<Run>& runs, std::size_t r,
               const Obstacles& obstacles) {
  const std::size_t n = contour.nodes.size();
  const Run& run = runs[r];
  Chain chain;
  chain.closed = runs.size() == 1;
  for (std::size_t i = run.begin; i < run.end + (chain.closed ? 0 : 1); ++i) {
    const ContourNode& node = contour.nodes[i % n];
    const auto mouth = obstacles.at_mouth.find(node.edge);
    Index meets = mouth == obstacles.at_mouth.end() ? none : mouth->second;
    if (!chain.closed && i == run.begin) meets = obstacles.group + Index((r + runs.size() - 1) % runs.size());
    if (!chain.closed && i == run.end) meets = obstacles.group + Index((r + 1) % runs.size());
    chain.points.push_back(cut.at(node));
    chain.fixed.push_back(meets != none);
    chain.meets.push_back(meets);
  }
  return chain;
}

/// Obstacles of all contours are known before clearances are measured.
Lines lines_of(const Cut& cut) {
  Lines lines;
  Obstacles obstacles;
  add_cracks(cut.cracks, obstacles);
  for (const Contour& contour : cut.contours) {
    std::vector<Run> runs = runs_of(contour, lines.chains.size());
    for (std::size_t r = 0; r < runs.size(); ++r)
      if (runs[r].strand == none)
        lines.chains.push_back(chain_of(cut, contour, runs, r, obstacles));
      else
        add_along_frame(cut, contour, runs[r], obstacles.group + Index(r), obstacles);
    obstacles.group += Index(runs.size());
    lines.runs.push_back(std::move(runs));
  }
  add_regions(cut.block, obstacles);
  for (const Chain& chain : lines.chains) lines.fine.push_back(sample(chain, cut.block.how.spacing));
  lines.clearance = clearances(lines.fine, obstacles.all, 2 * cut.block.how.tolerance);
  return lines;
}

/// How closely the sides follow what the background says.
struct Style {
  double part;  // of the tolerance for smoothing; 0: not at all
  bool arcs;    // curved sides stay curved where the zero line cuts them
};

/// Where the strand is cut its arc is cut at the angle of the crossing; at its corners it keeps its own ends to the
/// bit.
Side along_strand(const Cut& cut, const Contour& contour, const Run& run) {
  const Mesh& mesh = cut.block.mesh;
  const Drawing& drawing = cut.block.rim.drawing;
  const std::size_t n = contour.nodes.size();
  const ContourNode &first = contour.nodes[run.begin % n], &last = contour.nodes[run.end % n];
  const Strand& strand = drawing.strands[std::size_t(run.strand)];
  Side side{cut.at(first), strand.label, std::nullopt};
  if (!strand.arc) {
    side.keep = strand.keep && first.vertex != none && last.vertex != none;
    return side;
  }
  Arc arc = *strand.arc;
  const auto corner = [&](const ContourNode& node, Index c) {
    return strand.from != strand.to && node.vertex != none &&
           (mesh.points[std::size_t(node.vertex)] - drawing.corners[std::size_t(c)]).norm() <=
               join_tolerance * drawing.extent;
  };
  const double hair = arc.to < arc.from ? -1e-7 : 1e-7;  // corners may lie that far before the arc's own start
  arc.from = corner(first, strand.from) ? strand.arc->from : parameter(arc, side.start, arc.from - hair);
  arc.to = corner(last, strand.to) ? strand.arc->to : parameter(arc, cut.at(last), arc.from);
  side.arc = arc;
  return side;
}

/// Contour l as sides: runs along one strand become one side, runs of zero line are simplified.
Loop loop_of(const Cut& cut, const Lines& lines, std::size_t l, const Simplifying& how, const Style& style) {
  const Contour& contour = cut.contours[l];
  const std::size_t n = contour.nodes.size(), design = cut.block.frame.labels.size();
  Loop loop;
  loop.name = cut.block.frame.outline.name;
  for (const Run& run : lines.runs[l]) {
    if (run.strand == none) {
      const std::size_t c = run.chain;
      const Chain chain =
          style.part > 0 ? simplify(lines.chains[c], lines.fine[c], lines.clearance[c], how) : lines.chains[c];
      const std::size_t count = chain.points.size() - (chain.closed ? 0 : 1);
      for (std::size_t i = 0; i < count; ++i)
        loop.sides.push_back({chain.points[i], Index(design), std::nullopt, false, true});
    } else if (const Strand& strand = cut.block.rim.drawing.strands[std::size_t(run.strand)];
               strand.arc && !style.arcs) {
      for (std::size_t i = run.begin; i < run.end; ++i)
        loop.sides.push_back({cut.at(contour.nodes[i % n]), strand.label, std::nullopt, false, true});
    } else {
      loop.sides.push_back(along_strand(cut, contour, run));
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

double area_of(const Cut& cut, const Contour& contour) {
  double twice = 0;
  const Vec2 origin = cut.at(contour.nodes.front());
  Vec2 before = Vec2::Zero();
  for (std::size_t i = 1; i < contour.nodes.size(); ++i) {
    const Vec2 x = cut.at(contour.nodes[i]) - origin;
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

/// The outline is the contour of largest area; a hole that the zero line has changed keeps its name if it is the first
/// to ask.
void add_loops(const Cut& cut, const Lines& lines, const Simplifying& how, const Style& style, Shape& shape) {
  const Shape& frame = cut.block.frame;
  std::size_t outer = 0;
  double largest = 0;
  for (std::size_t l = 0; l < cut.contours.size(); ++l)
    if (const double area = area_of(cut, cut.contours[l]); area > largest) outer = l, largest = area;
  std::set<std::string> used;
  for (const Loop& hole : frame.holes) used.insert(hole.name);
  std::set<Index> named;
  for (std::size_t l = 0; l < cut.contours.size(); ++l) {
    const std::set<Index> of = follows(cut.block.rim, cut.contours[l]);
    const bool drawn = touched(cut.contours[l]);
    Loop loop;
    if (drawn)
      loop = loop_of(cut, lines, l, how, style);
    else
      loop = *of.begin() == 0 ? frame.outline : frame.holes[std::size_t(*of.begin()) - 1];
    if (l == outer) {
      shape.outline = std::move(loop);
      continue;
    }
    if (drawn) {
      const auto own = std::ranges::find_if(of, [&](Index i) { return i > 0 && !named.contains(i); });
      if (own != of.end()) named.insert(*own);
      loop.name = own != of.end() ? frame.holes[std::size_t(*own) - 1].name : unused("design", " ", used);
    }
    shape.holes.push_back(std::move(loop));
  }
}

Shape assemble(const Cut& cut, const Lines& lines, const Simplifying& how, const Style& style) {
  const Shape& frame = cut.block.frame;
  Shape shape;
  shape.labels = frame.labels;
  std::set<std::string> labels(frame.labels.begin(), frame.labels.end());
  shape.labels.push_back(unused("design", ".", labels));
  shape.regions = frame.regions;
  add_loops(cut, lines, how, style, shape);
  std::set<std::string> cracks, first;
  for (const Crack& crack : frame.cracks) cracks.insert(crack.name);
  for (const CrackPart& part : cut.cracks) {
    const std::string& name = frame.cracks[std::size_t(part.crack)].name;
    shape.cracks.push_back(part.shape);
    shape.cracks.back().name = first.insert(name).second ? name : unused(name, ".", cracks);
  }
  return shape;
}

/// What keeping crossings clear of vertices took from the area, per length of the zero line.
/// Crossings that keep clear of vertices enclose less or more than the exact ones; simplify gives it back.
double offset(const Cut& cut) {
  const Mesh& mesh = cut.block.mesh;
  Signs exact = cut.signs;
  std::fill(exact.clear.begin(), exact.clear.end(), 0.0);
  double area = 0, length = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    area += inside_area(mesh, exact, Index(t)) - inside_area(mesh, cut.signs, Index(t));
  for (const Contour& loop : cut.contours)
    for (std::size_t i = 0; i < loop.nodes.size(); ++i)
      if (loop.strand[i] == none)
        length += (cut.at(loop.nodes[i]) - cut.at(loop.nodes[(i + 1) % loop.nodes.size()])).norm();
  return length > 0 ? area / length : 0;
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

Cut cut_out(const Block& block, const Eigen::VectorXd& phi, std::vector<std::string>& notes) {
  Signs signs = signs_of(block.mesh, phi);
  clean(block, signs, notes);
  choose_pieces(block, signs, notes);
  std::vector<Contour> loops = contours(block.mesh, signs, block.rim);
  std::vector<CrackPart> parts = cut_cracks(block, signs, 4 * block.how.tolerance, notes);
  return {block, std::move(signs), std::move(loops), std::move(parts)};
}

/// The five styles in this order; the problem told is that of the smoothest one.
Attempt attempt(const Block& block, const Eigen::VectorXd& phi) {
  const Carving& how = block.how;
  Attempt result;
  Carved& carved = result.carved;
  const Cut cut = cut_out(block, phi, carved.notes);
  const double missing = offset(cut);
  const Lines lines = lines_of(cut);
  for (const Style style : {Style{1, true}, Style{1, false}, Style{0.25, true}, Style{0, true}, Style{0, false}}) {
    const double within = 0.4 * style.part * how.tolerance;
    carved.shape = assemble(cut, lines, {how.spacing, within, within, missing}, style);
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
    note_labels(block.frame, carved.shape, how, carved.notes);
    carved.design_label = Index(block.frame.labels.size());
    carved.area = area(carved.shape);
    carved.inside = cut.signs.inside;
    for (const CrackPart& p : cut.cracks) carved.crack_of.push_back(p.crack);
    return result;
  }
  return result;
}

/// How much phi changes over a length along its zero line, in the mean.
/// Sum of |jump of phi| over the sum of lengths, on crossed edges.
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
  const Block block{frame, mesh, rim, how};
  Attempt first = attempt(block, phi);
  if (first.good) return std::move(first.carved);
  const double unit = slope(mesh, phi) * how.tolerance;
  for (const double part : {-0.25, 0.25, -0.75, 0.75}) {
    try {
      Attempt next = attempt(block, (phi.array() + part * unit).matrix());
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
