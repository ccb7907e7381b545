// Pictures of a run: mesh, design with supports and loads, labels of a check, stress on the displaced body, map,
// optimality, what an inverse problem found. Fields are values at the corners of triangles, where the two faces of a
// crack have corners of their own, so that jumps are drawn as such. Displacements are drawn as large as makes the
// largest of them 6 % of the body, rounded down to 1, 2 or 5 times a power of ten. Arrows of loads have the length 0.1
// of the body's size for the largest traction; less than 3 % of it is not drawn. The range of a map's picture is that
// of its extrema, which leave out masked places and those near tips, where T may be infinite.

#include "app/write/draw.hpp"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

namespace kerf {

namespace {

// The corner number that triangle t has at vertex v.
Index corner(const Mesh& mesh, const Corners& corners, Index t, Index v) {
  for (int i = 0; i < 3; ++i)
    if (mesh.triangles[t][i] == v) return corners.of[t][i];
  return none;
}

// Boundary edges, edges between materials and crack faces as lines through the given positions of the corners.
void add_lines(const Mesh& mesh, const Corners& corners, const std::vector<Vec2>& position, Picture& p) {
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e) {
    const bool interface = is_interface(mesh, e);
    if (!interface && mesh.sides[e][0] != none && mesh.sides[e][1] != none) continue;
    const Index t = mesh.sides[e][0] == none ? mesh.sides[e][1] : mesh.sides[e][0];
    (interface ? p.interfaces : p.outlines)
        .push_back({position[corner(mesh, corners, t, mesh.edges[e][0])],
                    position[corner(mesh, corners, t, mesh.edges[e][1])]});
  }
  for (const auto& crack : mesh.cracks)
    for (int side = 0; side < 2; ++side) {
      std::vector<Vec2> line;
      for (const CrackEdge& c : crack) {
        const Index t = mesh.sides[c.edge][c.forward ? side : 1 - side];
        const int from = c.forward ? 0 : 1;
        if (line.empty()) line.push_back(position[corner(mesh, corners, t, mesh.edges[c.edge][from])]);
        line.push_back(position[corner(mesh, corners, t, mesh.edges[c.edge][1 - from])]);
      }
      p.cracks.push_back(std::move(line));
    }
}

Eigen::Matrix3Xd spread(const PlotData& data, const Eigen::VectorXd& at_corners) {
  Eigen::Matrix3Xd values(3, static_cast<Eigen::Index>(data.corners.of.size()));
  for (Eigen::Index t = 0; t < values.cols(); ++t)
    for (int i = 0; i < 3; ++i) values(i, t) = at_corners[data.corners.of[static_cast<std::size_t>(t)][i]];
  return values;
}

// A round factor that makes the largest displacement a few percent of the body.
double exaggeration(const PlotData& data) {
  Vec2 low = data.points.front(), high = low;
  for (const Vec2& x : data.points) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  const double largest = std::sqrt(data.values.displacement.colwise().squaredNorm().maxCoeff());
  if (!(largest > 0)) return 0;
  const double wanted = 0.06 * (high - low).norm() / largest;
  const double power = std::pow(10, std::floor(std::log10(wanted)));
  for (const double round : {5.0, 2.0})
    if (wanted >= round * power) return round * power;
  return power;
}

std::string map_words(const MapTask& task) {
  const Perturbation& p = task.request.perturbation;
  std::string j = task.functional.sum ? "functional" : task.functional.kind;
  std::replace(j.begin(), j.end(), '_', ' ');
  if (!has_series(p))
    return fmt::format("change of the {} by {} of radius {:.3g}", j, description(p), task.request.radius);
  return fmt::format("topological derivative of the {}: {} changes it by \u03c0 \u03b5\u00b2 T", j, description(p));
}

}  // namespace

Picture mesh_picture(const std::string& title, const Mesh& mesh) {
  const Quality q = quality(mesh);
  Picture p{.title = title,
            .subtitle = fmt::format("mesh: {} triangles, edges {:.3g} to {:.3g}, smallest angle {:.1f} degrees",
                                    mesh.triangles.size(), q.h_min, q.h_max, q.min_angle_deg)};
  p.points = mesh.points;
  p.triangles = mesh.triangles;
  p.edges = true;
  add_lines(mesh, {mesh.triangles, {}}, p.points, p);
  return p;
}

Picture edge_crack_picture(const std::string& title, const Mesh& mesh, const inspect::EdgeCrackMap& map,
                           const std::vector<inspect::InteriorCrack>& interior, const Units& units) {
  Picture p = mesh_picture(title, mesh);
  p.edges = false;
  p.subtitle = fmt::format(
      "K of a crack of length {:.3g} that begins at the boundary (band), or lies inside; gray: masked", map.length);
  p.value_label = "K";
  p.dimension = dimension::stress_intensity;
  p.units = units;
  Vec2 low = mesh.points.front(), high = low;
  for (const Vec2& x : mesh.points) low = low.cwiseMin(x), high = high.cwiseMax(x);
  const double width = 0.015 * (high - low).norm();  // of the ribbon along the boundary
  const auto inside = static_cast<Eigen::Index>(interior.size());
  p.values.resize(3, inside + 2 * static_cast<Eigen::Index>(map.places.size()));
  double most = 0;
  for (Eigen::Index t = 0; t < inside; ++t) {
    const inspect::InteriorCrack& crack = interior[static_cast<std::size_t>(t)];
    p.values.col(t).setConstant(crack.masked ? nan : crack.K);
    if (!crack.masked) most = std::max(most, crack.K);
  }
  for (std::size_t i = 0; i < map.places.size(); ++i) {
    const inspect::EdgeCrack& crack = map.places[i];
    const Vec2 half = 0.5 * crack.along * Vec2(crack.inward.y(), -crack.inward.x());
    const auto first = static_cast<Index>(p.points.size());
    for (const Vec2& x : {Vec2(crack.at - half), Vec2(crack.at + half), Vec2(crack.at + half + width * crack.inward),
                          Vec2(crack.at - half + width * crack.inward)})
      p.points.push_back(x);
    p.triangles.push_back({first, first + 1, first + 2});
    p.triangles.push_back({first, first + 2, first + 3});
    const bool shown = crack.masked == inspect::Masked::No;
    p.values.middleCols(inside + 2 * static_cast<Eigen::Index>(i), 2).setConstant(shown ? crack.K : nan);
    if (shown) most = std::max(most, crack.K);
  }
  p.range = {0, most > 0 ? most : 1};
  for (std::size_t i = 0; i < map.worst.size(); ++i)
    p.marks.emplace_back(map.places[map.worst[i]].at, std::to_string(i + 1));
  return p;
}

namespace {

/// The edges of every label, so that one look at the mesh is enough for all of them.
class LabelledEdges {
 public:
  explicit LabelledEdges(const Mesh& mesh) : mesh(mesh) {
    for (std::size_t e = 0; e < mesh.edges.size(); ++e)
      if (mesh.label[e] != none) of_[mesh.label[e]].push_back(e);
  }
  std::span<const std::size_t> of(Index label) const {
    const auto found = of_.find(label);
    return found == of_.end() ? std::span<const std::size_t>() : found->second;
  }

  const Mesh& mesh;

 private:
  std::map<Index, std::vector<std::size_t>> of_;
};

/// Boundary edges of one label, joined where they follow one another; the body lies to their left.
std::vector<std::vector<Vec2>> chains(const LabelledEdges& edges, Index label) {
  const Mesh& mesh = edges.mesh;
  std::map<Index, Index> next;  // vertex to vertex
  for (const std::size_t e : edges.of(label)) {
    const bool forward = mesh.sides[e][1] == none;
    next[mesh.edges[e][forward ? 0 : 1]] = mesh.edges[e][forward ? 1 : 0];
  }
  std::map<Index, bool> arrived;
  for (const auto& [from, to] : next) arrived[to] = true;
  std::vector<std::vector<Vec2>> out;
  const auto walk = [&](Index at) {
    std::vector<Vec2> line{mesh.points[static_cast<std::size_t>(at)]};
    for (auto step = next.find(at); step != next.end(); step = next.find(at)) {
      at = step->second;
      next.erase(step);
      line.push_back(mesh.points[static_cast<std::size_t>(at)]);
    }
    out.push_back(std::move(line));
  };
  std::vector<Index> starts;
  for (const auto& [from, to] : next)
    if (arrived.count(from) == 0) starts.push_back(from);
  for (const Index start : starts) walk(start);
  while (!next.empty()) walk(next.begin()->first);  // closed ones
  return out;
}

/// Arrows along a chain: pushing ones end on it, pulling ones begin there, those along it lie beside it.
void add_arrows(const std::vector<Vec2>& chain, const BoundaryField& load, double largest, double size, Picture& p) {
  double total = 0;
  for (std::size_t i = 1; i < chain.size(); ++i) total += (chain[i] - chain[i - 1]).norm();
  const int count = std::clamp(static_cast<int>(std::lround(total / (0.045 * size))), 1, 40);
  double done = 0;
  int k = 0;
  for (std::size_t i = 1; i < chain.size(); ++i) {
    const Vec2 edge = chain[i] - chain[i - 1];
    const double length = edge.norm();
    for (; k < count && (k + 0.5) / count * total <= done + length; ++k) {
      const Vec2 x = chain[i - 1] + edge / length * ((k + 0.5) / count * total - done);
      const Vec2 n = Vec2(edge.y(), -edge.x()) / length;  // outwards
      const Vec2 t = load(x, n);
      if (!t.allFinite() || !(t.norm() > 0.03 * largest)) continue;
      const Vec2 arrow = 0.1 * size / largest * t;
      const double normal = t.dot(n) / t.norm();
      if (std::abs(normal) < 0.3) {
        const Vec2 middle = x + 0.02 * size * n;
        p.arrows.push_back({middle - 0.5 * arrow, middle + 0.5 * arrow});
        k += static_cast<int>(std::ceil(1.4 * arrow.norm() / (total / count)));  // they follow one another
      } else {
        p.arrows.push_back(normal < 0 ? std::array{Vec2(x - arrow), x} : std::array{x, Vec2(x + arrow)});
      }
    }
    done += length;
  }
}

/// All loaded parts of boundary and cracks with what acts on them, and the largest traction at the middle of an edge.
struct LoadedSides {
  std::vector<std::pair<std::vector<Vec2>, BoundaryField>> chains;
  double largest = 0;

  void add(std::vector<Vec2> chain, const BoundaryField& load) {
    for (std::size_t i = 1; i < chain.size(); ++i) {
      const Vec2 edge = chain[i] - chain[i - 1];
      const double size = load(0.5 * (chain[i] + chain[i - 1]), Vec2(edge.y(), -edge.x()).normalized()).norm();
      if (std::isfinite(size)) largest = std::max(largest, size);
    }
    chains.emplace_back(std::move(chain), load);
  }
};

LoadedSides loaded_chains(const LabelledEdges& edges, std::span<const Traction> tractions) {
  LoadedSides out;
  for (const Traction& t : tractions)
    for (auto& chain : chains(edges, t.label)) out.add(std::move(chain), t.value);
  return out;
}

/// A pressure in a crack pushes both faces away from it.
void add_pressures(const Mesh& mesh, const Scene& scene, LoadedSides& loaded) {
  for (std::size_t c = 0; c < std::min(mesh.cracks.size(), scene.laws.size()); ++c) {
    const BoundaryField& pressure = scene.laws[c].pressure;
    if (!pressure) continue;
    std::vector<Vec2> chain;
    for (const CrackEdge& e : mesh.cracks[c]) {
      const auto& [from, to] = mesh.edges[e.edge];
      if (chain.empty()) chain.push_back(mesh.points[e.forward ? from : to]);
      chain.push_back(mesh.points[e.forward ? to : from]);
    }
    const BoundaryField away = [pressure](const Vec2& x, const Vec2& n) -> Vec2 { return pressure(x, n)[0] * n; };
    loaded.add(chain, away);
    std::reverse(chain.begin(), chain.end());
    loaded.add(std::move(chain), away);
  }
}

}  // namespace

Picture design_picture(const std::string& title, const Mesh& mesh, const Scene& scene,
                       std::span<const LoadCase> further, double size) {
  Picture p = mesh_picture(title, mesh);
  p.edges = false;
  p.solid = true;
  p.subtitle.clear();
  const auto mention = [&p](const char* words) { p.subtitle += (p.subtitle.empty() ? "" : ", ") + std::string(words); };
  const LabelledEdges edges(mesh);
  for (const Support& support : scene.supports)
    for (auto& chain : chains(edges, support.label))
      (support.first && support.second ? p.supports : p.rollers).push_back(std::move(chain));
  std::vector<Traction> tractions = scene.tractions;
  for (const LoadCase& loads : further)
    tractions.insert(tractions.end(), loads.tractions.begin(), loads.tractions.end());
  LoadedSides loaded = loaded_chains(edges, tractions);
  add_pressures(mesh, scene, loaded);
  if (loaded.largest > 0)
    for (const auto& [chain, load] : loaded.chains) add_arrows(chain, load, loaded.largest, size, p);
  if (!p.supports.empty() || !p.rollers.empty()) mention("blue: supports");
  if (!p.arrows.empty()) mention("orange: loads");
  if (!p.cracks.empty()) mention("red: cracks");
  return p;
}

namespace {

/// Half way along the longest of the lines.
Vec2 middle_of(const std::vector<std::vector<Vec2>>& lines) {
  Vec2 found = Vec2::Constant(nan);
  double longest = 0;
  for (const std::vector<Vec2>& line : lines) {
    double length = 0;
    for (std::size_t i = 1; i < line.size(); ++i) length += (line[i] - line[i - 1]).norm();
    if (length <= longest) continue;
    longest = length;
    double left = 0.5 * length;
    for (std::size_t i = 1; i < line.size(); ++i) {
      const double piece = (line[i] - line[i - 1]).norm();
      if (left <= piece) {
        found = line[i - 1] + left / piece * (line[i] - line[i - 1]);
        break;
      }
      left -= piece;
    }
  }
  return found;
}

}  // namespace

Picture check_picture(const std::string& title, const Mesh& mesh, const Scene& scene, const Shape& shape,
                      std::span<const Named> labels) {
  Picture p = design_picture(title, mesh, scene, {}, extent(shape));
  constexpr std::uint32_t pale = 0xdde6ee;
  p.color = pale;
  const LabelledEdges edges(mesh);
  for (const Named& label : labels) p.names.emplace_back(middle_of(chains(edges, label.label)), label.text);
  for (const Crack& crack : shape.cracks) p.names.emplace_back(middle_of({crack.points}), "crack " + crack.name);
  for (const Loop& region : shape.regions) {
    const Polygon outline = flatten(region, 1e-3 * extent(shape), extent(shape));
    Vec2 middle = Vec2::Zero();
    for (const Vec2& x : outline.points) middle += x / static_cast<double>(outline.points.size());
    p.names.emplace_back(middle, "region " + region.name);
  }
  return p;
}

Picture optimality_picture(const std::string& title, const HoleMargin& holes) {
  Picture p = mesh_picture(title, *holes.mesh);
  p.edges = false;
  p.subtitle = "a small hole against what its area is worth; blue: it pays, gray: not looked at";
  p.value_label = "(T - price of area) / price";
  p.scale = Scale::Diverging;
  p.values.resize(3, static_cast<Eigen::Index>(holes.margin.size()));
  for (Eigen::Index t = 0; t < p.values.cols(); ++t)
    p.values.col(t).setConstant(holes.margin[static_cast<std::size_t>(t)]);
  p.clip = 0;
  p.range = {-2, 2};  // a bar of even stress has T of three prices
  p.marks.emplace_back(holes.at, fmt::format("least, {:.2g}", holes.least));
  return p;
}

Picture found_picture(const std::string& title, const Found& found) {
  Picture p{.title = title, .subtitle = "blue: found, gray: start"};
  const double size = extent(found.frame), chord = 1e-4 * size;
  const auto closed = [&](const Loop& loop) {
    std::vector<Vec2> line = flatten(loop, chord, size).points;
    line.push_back(line.front());
    return line;
  };
  const auto add = [&](const Shape& shape, std::uint32_t rgb, double width, bool dashed) {
    for (std::size_t i = found.frame.holes.size(); i < shape.holes.size(); ++i)
      p.traces.push_back({closed(shape.holes[i]), rgb, width, dashed});
    for (std::size_t i = found.frame.regions.size(); i < shape.regions.size(); ++i)
      p.traces.push_back({closed(shape.regions[i]), rgb, width, dashed});
    for (std::size_t i = found.frame.cracks.size(); i < shape.cracks.size(); ++i)
      p.traces.push_back({shape.cracks[i].points, rgb, width, dashed});
  };
  p.outlines.push_back(closed(found.frame.outline));
  p.points = p.outlines.back();
  for (const Loop& hole : found.frame.holes) p.outlines.push_back(closed(hole));
  for (const Crack& crack : found.frame.cracks) p.cracks.push_back(crack.points);
  constexpr std::uint32_t gray = 0x9aa4ae, orange = 0xd55e00;
  add(found.start, gray, 2.5, true);
  if (found.truth) {
    add(*found.truth, true_color, 7, false);
    p.subtitle += ", green: true";
  }
  add(found.found, found_color, 3, false);
  if (!found.ellipses.empty()) p.subtitle += ", orange: 95 % of the uncertainty of centers and points";
  for (const UncertaintyEllipse& e : found.ellipses) {
    const Mat2 turn = Eigen::Rotation2Dd(e.angle).toRotationMatrix();
    std::vector<Vec2> line;
    constexpr int pieces = 48;
    for (int i = 0; i <= pieces; ++i) {
      const double t = 2 * pi * i / pieces;
      line.push_back(e.at + turn * Vec2(e.semi_axes.x() * std::cos(t), e.semi_axes.y() * std::sin(t)));
    }
    p.traces.push_back({std::move(line), orange, 2.5, false});
  }
  return p;
}

namespace {

/// A press fit: what the displacements close is not in the drawing, and drawn large they would open it.
bool overlaps(const Model& model) {
  for (std::size_t c = 0; c < model.mesh.cracks.size(); ++c) {
    const CrackLaw& law = model.scene.laws[c];
    if (!has_gap(law)) continue;
    for (const CrackEdge& e : model.mesh.cracks[c]) {
      const auto& [a, b] = model.mesh.edges[e.edge];
      if (law.gap(0.5 * (model.mesh.points[a] + model.mesh.points[b]), normal(model.mesh, e.edge))[0] < 0) return true;
    }
  }
  return false;
}

}  // namespace

Picture stress_picture(const std::string& title, const Model& model, const PlotData& data) {
  const bool overlap = overlaps(model);
  const double factor = overlap ? 0 : exaggeration(data);
  Picture p{.title = title,
            .subtitle = overlap ? "von Mises stress; no displacements, as faces overlap before loading"
                                : fmt::format("von Mises stress; displacements drawn {:g} times", factor)};
  p.points = data.points;
  for (std::size_t i = 0; i < p.points.size(); ++i)
    p.points[i] += factor * data.values.displacement.col(static_cast<Eigen::Index>(i));
  p.triangles = data.corners.of;
  p.values = spread(data, data.von_mises);
  p.value_label = "von Mises stress";
  p.dimension = dimension::stress;
  add_lines(model.mesh, data.corners, p.points, p);
  return p;
}

Picture map_picture(const std::string& title, const MapTask& task, const Model& model, const PlotData& data,
                    const Mapped& mapped) {
  const FullMap& map = mapped.full;
  Picture p{.title = title, .subtitle = map_words(task)};
  p.points = data.points;
  p.triangles = data.corners.of;
  p.values = spread(data, map.at_corners);
  p.margin = spread(data, map.margin);
  bool gray = false, negative = false, positive = false;
  for (Eigen::Index t = 0; t < p.values.cols(); ++t) {
    auto values = p.values.col(t);
    gray = gray || p.margin.col(t).minCoeff() < 0;
    if (p.margin.col(t).maxCoeff() < 0 || !values.allFinite()) {
      values.setConstant(nan);
      gray = true;
    } else {
      negative = negative || values.minCoeff() < 0;
      positive = positive || values.maxCoeff() > 0;
    }
  }
  if (gray) p.subtitle += fmt::format("; gray: too near to something else for a radius of {:.3g}", task.request.radius);
  p.value_label = has_series(task.request.perturbation) ? "topological derivative T" : "predicted change of J";
  if (const auto of = dimension_of(task.functional))
    p.dimension = has_series(task.request.perturbation) ? per_area(*of) : *of;
  p.scale = negative && positive ? Scale::Diverging : Scale::Linear;
  p.clip = 0;
  p.range = {mapped.result.min.value, mapped.result.max.value};  // it may be infinite at tips
  add_lines(model.mesh, data.corners, p.points, p);
  for (std::size_t i = 0; i < task.points.size() && i < 20; ++i)
    p.marks.emplace_back(task.points[i], std::to_string(i + 1));
  return p;
}

}  // namespace kerf
