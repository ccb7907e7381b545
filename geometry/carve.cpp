// The negative set, step by step: signs, pieces, contours, sides; then less smoothing until the shape can be meshed.

#include "geometry/carve.hpp"

#include "geometry/contour.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

namespace kerf {

namespace {

double parameter(const Arc& arc, const Vec2& x, double after) {
  const Vec2 d = x - arc.center, p = arc.axes.col(0), q = arc.axes.col(1);
  const double whole = cross(p, q), t = std::atan2(cross(p, d) / whole, cross(d, q) / whole);
  const double turn = 2 * std::numbers::pi, sign = arc.to < arc.from ? -1 : 1;
  // The first value of t that comes after `after` on the way of the arc.
  const double ahead = sign * (t - after) / turn;
  return after + sign * turn * (ahead - std::floor(ahead));
}

struct Sources {
  const Shape& frame;
  const Mesh& mesh;
  const Signs& signs;
  const Rim& rim;
  const std::set<Index>& mouths;  // edges where cracks are cut

  Vec2 at(const Node& node) const {
    return node.vertex == none ? place(frame, mesh, signs, rim, node.edge) : mesh.points[std::size_t(node.vertex)];
  }
};

bool touched(const Contour& contour) {
  return std::ranges::find(contour.strand, none) != contour.strand.end();
}

/// The contour as sides: runs along one strand become one side, runs of zero line are simplified.
Loop loop_of(const Sources& from, const Contour& contour, Index design, const Simplifying& how, bool raw) {
  const std::size_t n = contour.nodes.size();
  const auto link = [&](std::size_t i) { return contour.strand[i % n]; };
  std::size_t first = 0;  // start where the kind of boundary changes
  while (first < n && link(first) == link(first + n - 1)) ++first;
  Loop loop;
  const auto add_chain = [&](Chain chain) {
    if (!raw) chain = simplify(chain, how);
    const std::size_t count = chain.points.size() - (chain.closed ? 0 : 1);
    for (std::size_t i = 0; i < count; ++i) loop.sides.push_back({chain.points[i], design, std::nullopt, false, true});
  };
  const auto chain_of = [&](std::size_t begin, std::size_t end) {  // links begin to end - 1
    Chain chain;
    for (std::size_t i = begin; i <= end; ++i) {
      const Node& node = contour.nodes[i % n];
      chain.points.push_back(from.at(node));
      chain.fixed.push_back(i == begin || i == end || from.mouths.contains(node.edge));
    }
    return chain;
  };
  if (first == n) {
    Chain chain = chain_of(0, n - 1);
    chain.fixed.front() = from.mouths.contains(contour.nodes.front().edge);
    chain.fixed.back() = from.mouths.contains(contour.nodes.back().edge);
    chain.closed = true;
    add_chain(std::move(chain));
    return loop;
  }
  for (std::size_t begin = first; begin < first + n;) {
    std::size_t end = begin + 1;
    while (end < first + n && link(end) == link(begin)) ++end;
    const Index s = link(begin);
    if (s == none) {
      add_chain(chain_of(begin, end));
    } else {
      const Strand& strand = from.rim.drawing.strands[std::size_t(s)];
      const Vec2 start = from.at(contour.nodes[begin % n]), finish = from.at(contour.nodes[end % n]);
      Side side{start, strand.label, std::nullopt};
      if (strand.arc) {
        Arc arc = *strand.arc;
        const double sign = arc.to < arc.from ? -1 : 1;
        const bool whole = strand.from == strand.to;
        const auto corner = [&](const Node& node, Index c) {
          return !whole && node.vertex != none &&
                 (from.mesh.points[std::size_t(node.vertex)] - from.rim.drawing.corners[std::size_t(c)]).norm() <=
                     join_tolerance * from.rim.drawing.extent;
        };
        const double hair = 1e-7 * sign;  // corners may lie that far before the arc's own start
        arc.from =
            corner(contour.nodes[begin % n], strand.from) ? strand.arc->from : parameter(arc, start, arc.from - hair);
        arc.to = corner(contour.nodes[end % n], strand.to) ? strand.arc->to : parameter(arc, finish, arc.from);
        side.arc = arc;
      } else {
        side.keep = strand.keep && contour.nodes[begin % n].vertex != none && contour.nodes[end % n].vertex != none;
      }
      loop.sides.push_back(side);
    }
    begin = end;
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

Shape assemble(const Sources& from, const std::vector<Contour>& loops, const std::vector<CrackPart>& parts,
               const Simplifying& how, bool raw) {
  const Shape& frame = from.frame;
  Shape shape;
  shape.labels = frame.labels;
  std::set<std::string> labels(frame.labels.begin(), frame.labels.end());
  const Index design = Index(shape.labels.size());
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
      loop = loop_of(from, loops[l], design, how, raw);
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
  exact.clear = 0;
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

Carving checked(const Mesh& mesh, Carving how) {
  const auto usable = [](double x) { return std::isfinite(x) && x >= 0; };
  if (!usable(how.tolerance) || !usable(how.spacing) || !usable(how.least_area))
    throw std::invalid_argument("tolerance, spacing and least area of a carving must be 0 or positive");
  if (mesh.triangles.empty()) throw std::invalid_argument("an empty background");
  if (how.spacing == 0) {
    double sum = 0;
    for (std::size_t e = 0; e < mesh.edges.size(); ++e) sum += length(mesh, Index(e));
    how.spacing = sum / double(mesh.edges.size());
  }
  if (how.tolerance == 0) how.tolerance = how.spacing / 10;
  return how;
}

}  // namespace

Carved carve(const Shape& frame, const Mesh& mesh, const Eigen::VectorXd& phi, const Carving& given) {
  const Carving how = checked(mesh, given);
  const Rim rim = find_rim(frame, mesh);
  Carved carved;
  Signs signs = signs_of(mesh, phi);
  signs.clear = how.tolerance / 4;
  clean(frame, mesh, rim, how, signs, carved.notes);
  choose_pieces(frame, mesh, how, signs, carved.notes);
  const std::vector<Contour> loops = contours(mesh, signs, rim);
  const std::vector<CrackPart> parts = cut_cracks(frame, mesh, signs, 4 * how.tolerance, carved.notes);
  std::set<Index> mouths;
  for (const CrackPart& part : parts)
    for (const Index e : {part.from.edge, part.to.edge})
      if (e != none) mouths.insert(e);
  const Sources sources{frame, mesh, signs, rim, mouths};

  const double missing = offset(sources, loops);
  std::string problem;
  for (const double part : {1.0, 0.25, 0.0}) {
    const Simplifying simplifying{how.spacing, 0.4 * part * how.tolerance, 0.4 * part * how.tolerance, missing};
    carved.shape = assemble(sources, loops, parts, simplifying, part == 0);
    const auto found = find_problem(carved.shape);
    if (!found) {
      if (part < 1)
        carved.notes.push_back(fmt::format("{} ({})", part > 0 ? "smoothed less" : "did not smooth", problem));
      carved.design_label = Index(frame.labels.size());
      carved.area = shape_area(carved.shape);
      for (const CrackPart& p : parts) carved.crack_of.push_back(p.crack);
      return carved;
    }
    if (problem.empty()) problem = *found;
  }
  throw Error(Fault::Geometry, fmt::format("the zero line makes no shape that can be meshed: {}", problem));
}

}  // namespace kerf
