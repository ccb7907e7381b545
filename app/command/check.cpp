// `kerf check`: what a case says, without solving anything. The body with its area, materials, the mesh, each crack
// with its length and where its ends lie, each label with the edges that it selected and its condition, resultants of
// the loads, and notes on what may be a mistake; a picture with the labels. Everything that a run would refuse before
// it solves is refused here, too: each scene of the run (load cases, steps) is prepared without a factor. Areas are
// those of the triangles as they will be solved, with curved edges or chords.

#include "app/command/refuse.hpp"
#include "app/run.hpp"
#include "app/run/load_cases.hpp"
#include "app/run/notes.hpp"
#include "app/run/optimize.hpp"
#include "app/run/solve.hpp"
#include "app/write/draw.hpp"
#include "geometry/interfaces.hpp"
#include "io/text.hpp"
#include "kerf/folded.hpp"
#include "solver/resultants.hpp"
#include "solver/system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <unordered_map>

namespace kerf {

namespace {

std::string at(const Vec2& p) {
  // -0 is 0
  return fmt::format("({:.6g}, {:.6g})", p.x() + 0.0, p.y() + 0.0);
}

/// "traction", "roller in y + traction", ...: what the scene says about a label.
std::string condition(const Case& c, Index label) {
  const Scene& scene = c.scene;
  if (std::ranges::find(c.planes, label) != c.planes.end()) return "symmetry";
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

/// The edges of boundary and cracks at every vertex that has some, in their order.
using EdgesAt = std::unordered_map<Index, std::vector<std::size_t>>;
EdgesAt edges_at(const Mesh& mesh) {
  EdgesAt at;
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    if (mesh.label[e] != none || mesh.crack[e] != none)
      for (const Index v : mesh.edges[e]) at[v].push_back(e);
  return at;
}

/// Where the crack's end lies: "interior", or the label of the boundary or the other crack that it meets.
std::string place(const Shape& shape, const Mesh& mesh, const EdgesAt& edges, std::size_t crack, Index vertex) {
  std::string found = "interior";
  for (const std::size_t e : edges.at(vertex)) {
    if (mesh.label[e] != none) return "on " + shape.labels[mesh.label[e]];
    const Index other = mesh.crack[e];
    if (other != none && other != static_cast<Index>(crack)) found = "on crack " + shape.cracks[other].name;
  }
  return found;
}

/// Lines of text, one after the other.
class Lines {
 public:
  template <typename... Arguments>
  void print(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
  }
  const std::string& text() const {
    return text_;
  }

 private:
  std::string text_;
};

using Notes = std::vector<std::string>;

void print_body(Lines& out, const Shape& shape, const Mesh& mesh, const EdgeCurvatures& curvatures) {
  double body = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    body += cell_area(cell_of(mesh, curvatures, static_cast<Index>(t)));
  Vec2 low = mesh.points.at(0), high = low;
  for (const Vec2& p : mesh.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  out.print("body      {} to {}, area {:.6g}, {} hole{}\n", at(low), at(high), body, shape.holes.size(),
            shape.holes.size() == 1 ? "" : "s");
}

std::string elastic_in_words(const Elastic& e) {
  if (!e.orthotropy) return fmt::format("young {:g}, poisson {:g}", e.young, e.poisson);
  const Orthotropy& o = *e.orthotropy;
  return fmt::format("young [{:g}, {:g}], poisson {:g}, shear {:g}, angle {:g}", o.young[0], o.young[1], o.poisson,
                     o.shear, o.angle * 180 / pi);
}

/// Of region r, or of the body around them.
const char* with_eigenstrain(const Scene& scene, Index r) {
  const std::size_t place = static_cast<std::size_t>(r + 1);
  return place < scene.eigenstrain.size() && scene.eigenstrain[place] ? ", with an eigenstrain" : "";
}

void print_regions(Lines& out, const Case& c, const Mesh& mesh, const EdgeCurvatures& curvatures) {
  const Shape& shape = c.shape;
  std::vector<double> sizes(shape.regions.size(), 0.0);
  std::vector<std::size_t> counts(shape.regions.size(), 0);
  for (std::size_t t = 0; t < mesh.region.size(); ++t)
    if (const Index r = mesh.region[t]; r != none) {
      sizes[static_cast<std::size_t>(r)] += cell_area(cell_of(mesh, curvatures, static_cast<Index>(t)));
      ++counts[static_cast<std::size_t>(r)];
    }
  for (std::size_t r = 0; r < shape.regions.size(); ++r)
    out.print("region    {}: {}, area {:.6g}, {} triangles{}\n", shape.regions[r].name, elastic_in_words(c.regions[r]),
              sizes[r], counts[r], with_eigenstrain(c.scene, static_cast<Index>(r)));
}

void print_mesh(Lines& out, const Mesh& mesh) {
  const Quality q = quality(mesh);
  out.print("mesh      {} triangles, {} vertices, edges {:.4g} to {:.4g}, smallest angle {:.3g} degrees\n",
            mesh.triangles.size(), mesh.points.size(), q.h_min, q.h_max, q.min_angle_deg);
}

/// ", pressure 2 MPa" or ", gap 0 to 2 mm", by its values in the middle of the edges; nothing for an empty field.
std::string on_faces(const char* what, const BoundaryField& of, const std::string& unit, const Mesh& mesh,
                     std::span<const CrackEdge> edges) {
  if (!of || edges.empty()) return {};
  double low = infinity, high = -infinity;
  for (const CrackEdge& c : edges) {
    const EdgeLine line = edge_line(mesh, c.edge);
    const double p = of(0.5 * (line.a + line.b), line.n)[0];
    low = std::min(low, p);
    high = std::max(high, p);
  }
  const std::string name = with_blank(unit);
  constexpr double same = 1e-12;
  return high - low <= same * std::abs(high) ? fmt::format(", {} {:.6g}{}", what, high, name)
                                             : fmt::format(", {} {:.6g} to {:.6g}{}", what, low, high, name);
}

void print_cracks(Lines& out, Notes& notes, const Case& c, const Mesh& mesh) {
  const Shape& shape = c.shape;
  const std::vector<bool> along = c.mesh ? std::vector<bool>(shape.cracks.size(), false) : along_regions(shape);
  const EdgesAt at_vertex = edges_at(mesh);
  for (std::size_t k = 0; k < shape.cracks.size(); ++k) {
    const Crack& crack = shape.cracks[k];
    const auto& edges = mesh.cracks.at(k);
    const CrackLaw& faces = c.scene.laws[k];
    out.print("{:<9} {}: {}{}{}, length {:.6g}, {} edges", along[k] ? "interface" : "crack", crack.name, law(faces),
              on_faces("pressure", faces.pressure, unit(c.units, dimension::stress), mesh, edges),
              on_faces("gap", faces.gap, unit(c.units, dimension::length), mesh, edges), path_length(crack),
              edges.size());
    if (edges.empty()) {
      notes.push_back(fmt::format("crack \"{}\" has no edge in the mesh", crack.name));
    } else if (crack.points.front() == crack.points.back()) {
      out.print(", closed");
    } else {
      const Index start = mesh.edges[edges.front().edge][edges.front().forward ? 0 : 1];
      const Index end = mesh.edges[edges.back().edge][edges.back().forward ? 1 : 0];
      out.print(", {} {} to {} {}", at(crack.points.front()), place(shape, mesh, at_vertex, k, start),
                at(crack.points.back()), place(shape, mesh, at_vertex, k, end));
    }
    out.print("\n");
  }
  for (const Vec2& tip : c.half_tips)
    out.print("tip       {}, of a crack in a plane of symmetry, of which one face is drawn\n", at(tip));
}

void print_labels(Lines& out, Notes& notes, const Case& c, const Mesh& mesh) {
  const Shape& shape = c.shape;
  out.print("\n{:<20} {:>6} {:>12}  {}\n", "label", "edges", "length", "condition");
  std::vector<std::size_t> count(shape.labels.size(), 0);
  std::vector<double> total(shape.labels.size(), 0.0);
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    if (mesh.label[e] == none) continue;
    ++count[mesh.label[e]];
    total[mesh.label[e]] += length(mesh, static_cast<Index>(e));
  }
  for (std::size_t label = 0; label < count.size(); ++label) {
    out.print("{:<20} {:>6} {:>12.6g}  {}\n", shape.labels[label], count[label], total[label],
              condition(c, static_cast<Index>(label)));
    if (count[label] == 0) notes.push_back(fmt::format("label \"{}\" has no edge in the mesh", shape.labels[label]));
  }
}

/// What the labels are called in the picture, with the resultants of the loads on them.
using Names = std::vector<Named>;

void print_resultants(Lines& out, Notes& notes, const Case& c, const Mesh& mesh, const EdgeCurvatures& curvatures,
                      Names& names) {
  const TriangleRule rule = triangle_rule(8);
  const SceneData data = scene_data(mesh, c.scene, rule, 1, curvatures);
  const auto line = [&](const std::string& what, const Resultant& r) {
    out.print("{:<20} force {}{}, moment {:.6g}{} about (0, 0)\n", what, at(r.force),
              with_blank(unit(c.units, dimension::force)), r.moment + 0.0,
              with_blank(unit(c.units, dimension::moment)));
  };
  const std::vector<LabelResultant> tractions = traction_resultants(mesh, curvatures, c.scene, data);
  if (!tractions.empty() || c.scene.body) out.print("\nloads\n");
  Resultant sum;
  for (const LabelResultant& r : tractions) {
    line(c.shape.labels[r.label], r.of);
    names[static_cast<std::size_t>(r.label)].text +=
        fmt::format(": force {}{}", at(r.of.force), with_blank(unit(c.units, dimension::force)));
    sum.add(r.of);
  }
  if (c.scene.body) {
    const Resultant body = body_resultant(mesh, curvatures, c.scene, data, rule);
    line("body", body);
    sum.add(body);
  }
  if (tractions.size() + (c.scene.body ? 1 : 0) > 1) line("together", sum);
  for (std::string& note : notes_on_data(mesh, c.scene, data, c.shape)) notes.push_back(std::move(note));
}

void note_lost(Notes& notes, const Case& c, const Mesh& mesh) {
  const Locator locator = make_locator(mesh);
  for (std::string& note : notes_on_points(c, mesh, locator, true)) notes.push_back(std::move(note));
  if (!c.validate) return;
  if (std::string note = note_on_points("validate", mesh, locator, c.validate->points); !note.empty())
    notes.push_back(std::move(note));
}

/// What acts in one of the solutions of a run, and how messages call it: the loads of the scene, of each load case, of
/// each step.
std::vector<std::pair<std::string, Scene>> scenes_of_run(const Case& c) {
  std::vector<std::pair<std::string, Scene>> all;
  if (c.optimize)
    for (const LoadCase& load_case : c.optimize->load_cases)
      all.emplace_back(fmt::format("load case \"{}\": ", load_case.name), under(c, load_case).scene);
  for (const LoadStep& step : c.steps) all.emplace_back(fmt::format("step \"{}\": ", step.name), step.scene);
  if (all.empty()) all.emplace_back("", c.scene);
  return all;
}

void note_loads(Notes& notes, const Case& c) {
  if (c.scene.supports.empty()) notes.push_back("nothing is supported: the loads must be in equilibrium");
  for (const auto& [whose, scene] : scenes_of_run(c))
    if (const std::string note = note_on_loads(scene, c.shape); !note.empty()) notes.push_back(whose + note);
}

/// Throws what a run would throw before it solves: loads that nothing holds, too much contact.
void prepare_as_solved(const Case& c, const Mesh& mesh) {
  for (const auto& [whose, scene] : scenes_of_run(c)) try {
      prepare(mesh, c.element, scene, 1, {.factorize = false});
    } catch (const FoldedTriangle&) {
      if (c.curved.value_or(false)) throw;
    } catch (const Error& e) {
      throw Error(e.fault, whose + e.what());
    }
}

/// The design to begin with, where it takes more of the body than is allowed.
void note_start(Notes& notes, const Case& c) {
  if (!c.optimize || !c.optimize->volume_at_most || !c.optimize->level_set.start_design) return;
  const double share = area(*c.optimize->level_set.start_design) / area(c.shape);
  if (std::string note = note_on_start(share, *c.optimize->volume_at_most); !note.empty())
    notes.push_back(std::move(note));
}

/// As a run would have them: no curved edges where one of them would fold its triangle.
EdgeCurvatures bows_as_solved(const Case& c, const Mesh& mesh) {
  try {
    return curvatures_of(mesh, c.element);
  } catch (const FoldedTriangle&) {
    if (c.curved.value_or(false)) throw;
    return {};
  }
}

}  // namespace

std::string check(const Case& c, const std::filesystem::path& folder) {
  if (c.optimize) refuse_optimization(c);
  const Mesh mesh = c.mesh ? *c.mesh : triangulate(c.shape, c.sizing);
  const EdgeCurvatures curvatures = bows_as_solved(c, mesh);
  Lines out;
  Notes notes = notes_on_files(c);
  if (c.mesh)
    if (const auto problem = find_problem(c.shape))
      notes.push_back(
          fmt::format("{}: kerf cannot mesh this body anew, for validation, error bars of maps, adaptive "
                      "meshes and optimization",
                      *problem));
  out.print("{}\n", c.title);
  print_body(out, c.shape, mesh, curvatures);
  out.print("material  {}, plane {}{}\n", elastic_in_words({c.young, c.poisson, c.orthotropy}),
            c.plane_strain ? "strain" : "stress", with_eigenstrain(c.scene, none));
  print_regions(out, c, mesh, curvatures);
  print_mesh(out, mesh);
  print_cracks(out, notes, c, mesh);
  print_labels(out, notes, c, mesh);
  Names names;
  for (std::size_t k = 0; k < c.shape.labels.size(); ++k) names.push_back({static_cast<Index>(k), c.shape.labels[k]});
  print_resultants(out, notes, c, mesh, curvatures, names);
  note_lost(notes, c, mesh);
  note_loads(notes, c);
  note_start(notes, c);
  if (std::string note = note_on_size(c, mesh.triangles.size()); !note.empty()) notes.push_back(std::move(note));
  if (!folder.empty() && c.output.png) {
    const std::filesystem::path file = folder / "check.png";
    try {
      std::filesystem::create_directories(folder);
      Picture picture = check_picture(c.title, mesh, c.scene, c.shape, names);
      picture.units = c.units;
      draw(file, picture);
      out.print("\npicture in {}\n", file.string());
    } catch (const std::exception& e) {  // what is said above is worth more
      notes.push_back(fmt::format("no picture: {}", e.what()));
    }
  }
  prepare_as_solved(c, mesh);
  if (!notes.empty()) out.print("\n");
  for (const std::string& note : notes) out.print("note: {}\n", note);
  return out.text();
}

}  // namespace kerf
