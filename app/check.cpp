#include "app/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace kerf {

namespace {

std::string at(const Vec2& p) {
  // -0 is 0
  return fmt::format("({:.6g}, {:.6g})", p.x() + 0.0, p.y() + 0.0);
}

/// "traction", "roller in y + traction", ...: what the scene says about a label.
std::string condition(const Scene& scene, Index label) {
  std::vector<std::string> parts;
  for (const Support& s : scene.supports) {
    if (s.label != label) continue;
    if (s.first && s.second) {
      parts.push_back("displacement");
    } else {
      parts.push_back(s.normal_frame ? "roller, normal" : s.first ? "roller in x" : "roller in y");
    }
  }
  for (const Traction& t : scene.tractions)
    if (t.label == label) parts.push_back("traction");
  return parts.empty() ? "free" : fmt::format("{}", fmt::join(parts, " + "));
}

const char* law(const CrackLaw& crack) {
  switch (crack.kind) {
    case CrackLaw::Kind::Open:
      return "open";
    case CrackLaw::Kind::Bonded:
      return "bonded";
    default:
      return "unilateral";
  }
}

/// Where the crack's end lies: "interior", or the label of the boundary or the other crack that it meets.
std::string place(const Shape& shape, const Mesh& mesh, std::size_t crack, Index vertex) {
  std::string found = "interior";
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    if (mesh.edges[e][0] != vertex && mesh.edges[e][1] != vertex) continue;
    if (mesh.label[e] != none) return "on " + shape.labels[mesh.label[e]];
    const Index other = mesh.crack[e];
    if (other != none && other != static_cast<Index>(crack)) found = "on crack " + shape.cracks[other].name;
  }
  return found;
}

std::size_t outside(const Mesh& mesh, const std::vector<Vec2>& points) {
  const std::vector<Index> found = locate(mesh, points);
  return static_cast<std::size_t>(std::count(found.begin(), found.end(), none));
}

}  // namespace

std::string check(const Case& c) {
  const Mesh mesh = triangulate(c.shape, c.sizing);
  std::string out;
  std::vector<std::string> notes;
  const auto print = [&out]<class... Arguments>(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(out), format, std::forward<Arguments>(arguments)...);
  };

  double body = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) body += area(mesh, static_cast<Index>(t));
  Vec2 low = mesh.points.at(0), high = low;
  for (const Vec2& p : mesh.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  print("{}\n", c.title);
  print("body      {} to {}, area {:.6g}, {} hole{}\n", at(low), at(high), body, c.shape.holes.size(),
        c.shape.holes.size() == 1 ? "" : "s");
  print("material  young {:g}, poisson {:g}, plane {}\n", c.young, c.poisson, c.plane_strain ? "strain" : "stress");
  for (std::size_t r = 0; r < c.shape.regions.size(); ++r) {
    double size = 0;
    std::size_t count = 0;
    for (std::size_t t = 0; t < mesh.region.size(); ++t)
      if (mesh.region[t] == static_cast<Index>(r)) size += area(mesh, static_cast<Index>(t)), ++count;
    print("region    {}: young {:g}, poisson {:g}, area {:.6g}, {} triangles\n", c.shape.regions[r].name,
          c.regions[r].young, c.regions[r].poisson, size, count);
  }
  const Quality q = quality(mesh);
  print("mesh      {} triangles, {} vertices, edges {:.4g} to {:.4g}, smallest angle {:.3g} degrees\n",
        mesh.triangles.size(), mesh.points.size(), q.h_min, q.h_max, q.min_angle_deg);

  for (std::size_t k = 0; k < c.shape.cracks.size(); ++k) {
    const Crack& crack = c.shape.cracks[k];
    const auto& edges = mesh.cracks.at(k);
    print("crack     {}: {}, length {:.6g}, {} edges", crack.name, law(c.scene.laws[k]), path_length(crack),
          edges.size());
    if (edges.empty()) {
      notes.push_back(fmt::format("crack \"{}\" has no edge in the mesh", crack.name));
    } else {
      const Index start = mesh.edges[edges.front().edge][edges.front().forward ? 0 : 1];
      const Index end = mesh.edges[edges.back().edge][edges.back().forward ? 1 : 0];
      print(", {} {} to {} {}", at(crack.points.front()), place(c.shape, mesh, k, start), at(crack.points.back()),
            place(c.shape, mesh, k, end));
    }
    print("\n");
  }

  print("\n{:<20} {:>6} {:>12}  {}\n", "label", "edges", "length", "condition");
  std::vector<std::size_t> count(c.shape.labels.size(), 0);
  std::vector<double> total(c.shape.labels.size(), 0.0);
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    if (mesh.label[e] == none) continue;
    ++count[mesh.label[e]];
    total[mesh.label[e]] += length(mesh, static_cast<Index>(e));
  }
  for (std::size_t label = 0; label < count.size(); ++label) {
    print("{:<20} {:>6} {:>12.6g}  {}\n", c.shape.labels[label], count[label], total[label],
          condition(c.scene, static_cast<Index>(label)));
    if (count[label] == 0) notes.push_back(fmt::format("label \"{}\" has no edge in the mesh", c.shape.labels[label]));
  }

  for (const Probe& probe : c.probes)
    if (const std::size_t lost = outside(mesh, probe.points))
      notes.push_back(
          fmt::format("probe \"{}\": {} of {} points lie outside the body", probe.name, lost, probe.points.size()));
  if (c.map && !c.map->points.empty())
    if (const std::size_t lost = outside(mesh, c.map->points))
      notes.push_back(fmt::format("map: {} of {} points lie outside the body", lost, c.map->points.size()));
  if (c.validate)
    if (const std::size_t lost = outside(mesh, c.validate->points))
      notes.push_back(fmt::format("validate: {} of {} points lie outside the body", lost, c.validate->points.size()));
  if (c.scene.supports.empty()) notes.push_back("nothing is supported: the loads must be in equilibrium");
  if (c.scene.supports.empty() && c.scene.tractions.empty() && !c.scene.body)
    notes.push_back("nothing acts on the body: the solution is zero");
  if (!notes.empty()) print("\n");
  for (const std::string& note : notes) print("note: {}\n", note);
  return out;
}

}  // namespace kerf
