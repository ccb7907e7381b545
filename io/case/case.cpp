// A case file as a Case: each section of the document is read in turn, by this file or by one of *_sections.cpp. The
// order is fixed by what refers to what: the shape before its materials (labels, cracks and regions have their numbers
// then), [define] before everything that may hold an expression, conditions and functional before [optimize], and
// elements before the choice of curved edges, since not every element can have them. [[step]] is read before the
// eigenstrains and conditions of the case itself: a step reads both once more with its own numbers in [define], and the
// definitions are left with the values of the last step. Whatever is refused is refused with its place in the file;
// keys that no section knows are refused by the table of keys (keys.cpp). Also here: [units], [material], [mesh],
// [solver], [output].

#include "kerf/case_file.hpp"

#include "geometry/curved.hpp"
#include "io/case/fingerprint.hpp"
#include "io/case/interfaces.hpp"
#include "io/case/sections.hpp"
#include "io/document.hpp"
#include "kerf/element.hpp"
#include "solver/anisotropic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <sstream>

namespace kerf {

namespace {

void read_units(const Value& document, Case& c) {
  const auto units = find_table(document, "units");
  if (!units) return;
  allow_only(*units);
  c.units = {.length = choice(need(*units, "length")), .stress = choice(need(*units, "stress"))};
}

void read_material(const Value& document, Case& c) {
  need(document, "material");
  const Value material = *find_table(document, "material");
  allow_only(material);
  const auto state = find(material, "state");
  c.plane_strain = !state || choice(*state) == "plane strain";
  const Elastic constants = read_elastic(material);
  c.young = constants.young;
  c.poisson = constants.poisson;
  c.orthotropy = constants.orthotropy;
  if (const auto thickness = find(material, "thickness")) {
    if (c.plane_strain)
      fail(thickness->node->position,
           "material.thickness is that of a plate in plane stress; write state = \"plane stress\", or leave it out");
    c.thickness = in_range(*thickness);
  }
  c.scene.material = elastic(material, constants, c.plane_strain);
}

/// The yield stress and the toughness of [material] and of the regions.
void read_strength(const Value& document, const std::vector<std::optional<Value>>& regions, Case& c) {
  const auto read = [](const Value& table) {
    Strength s;
    for (const auto& [key, value] : {std::pair{"yield", &s.yield}, std::pair{"toughness", &s.toughness},
                                     std::pair{"release_rate", &s.release_rate}})
      if (const auto given = find(table, key)) *value = in_range(*given);
    if (s.toughness && s.release_rate)
      fail(need(table, "release_rate").node->position,
           fmt::format("{0}.release_rate and {0}.toughness say the same: give one of them", table.name));
    return s;
  };
  const auto says_something = [](const Strength& s) { return s.yield || s.toughness || s.release_rate; };
  std::vector<Strength> all{read(*find_table(document, "material"))};
  for (std::size_t k = 0; k < std::min(regions.size(), c.shape.regions.size()); ++k) {
    all.push_back(regions[k] ? read(*regions[k]) : all.front());
    all.back().region = c.shape.regions[k].name;
  }
  if (std::ranges::any_of(all, says_something)) c.strength = std::move(all);
}

/// Why the edges of a body with curved sides are chords where mesh.curved = "auto"; empty: they follow the curves.
std::string why_chords(const Case& c) {
  if (const auto why = refusal(c.element, can_be_curved)) return *why;
  if (c.backend == Backend::Umfpack) return "solver.backend = \"umfpack\" takes straight edges";
  return "";
}

void read_curved(const Value& document, Case& c) {
  const auto mesh = find_table(document, "mesh");
  const auto curved = mesh ? find(*mesh, "curved") : std::nullopt;
  if (curved && curved->node->kind == Node::Kind::String) {
    if (text(*curved) != "auto")
      fail(curved->node->position,
           fmt::format("{} is true, false or \"auto\", not \"{}\"", curved->name, text(*curved)));
  } else if (curved) {
    c.curved = boolean(*curved);
  }
  if (c.curved.value_or(false)) {
    if (const auto why = refusal(c.element, can_be_curved))
      fail(curved->node->position, fmt::format("{}: {}", curved->name, *why));
    if (c.mesh && c.mesh->arc.empty())
      fail(curved->node->position, curved->name +
                                       ": the mesh in domain.file has straight edges; save it with second order (gmsh: "
                                       "Mesh.ElementOrder = 2), or leave this out");
  }
  choose_edges(c);
}

void read_mesh(const Value& document, Case& c) {
  const auto mesh = find_table(document, "mesh");
  if (!mesh) return;
  allow_only(*mesh);
  take(*mesh, "size", c.sizing.size);
  take(*mesh, "crack_tip_size", c.sizing.crack_tip_size);
  take(*mesh, "min_angle", c.sizing.min_angle_deg);
  take(*mesh, "refine", c.divisions);
  if (const auto mesher = find(*mesh, "mesher"); mesher && !find(need(document, "domain"), "file"))
    fail(mesher->node->position, mesher->name + " goes with a geometry in domain.file");
  if (const auto adapt = find_table(*mesh, "adapt")) {
    allow_only(*adapt);
    c.adapt.emplace();
    c.adapt->error = in_range(need(*adapt, "error"));
    take(*adapt, "max_triangles", c.adapt->max_triangles);
    c.adapt->of = read_goal(*adapt, c);
  }
}

/// Of PETSc's options those of solvers, with plain values: others name files, sockets, libraries.
void require_plain_options(const Value& blamed, const std::string& options) {
  constexpr std::array<std::string_view, 8> beginnings{
      "ksp_", "pc_", "sub_ksp_", "sub_pc_", "mg_levels_", "mg_coarse_", "mat_mumps_icntl_", "mat_mumps_cntl_"};
  constexpr std::array<std::string_view, 2> alone{"log_view", "options_left"};
  const auto refuse = [&](const std::string& word) {
    fail(blamed.node->position,
         fmt::format("{}: \"{}\" is no option that a case may give; they are -ksp_*, -pc_*, -sub_*, -mg_levels_*, "
                     "-mg_coarse_*, -mat_mumps_icntl_* and -mat_mumps_cntl_* with numbers and names, and -log_view, "
                     "-options_left; what views or monitors takes no value",
                     blamed.name, word));
  };
  bool takes_value = false;
  std::istringstream words(options);
  for (std::string word; words >> word;) {
    const bool is_name = word.size() > 1 && word[0] == '-' && std::isalpha(static_cast<unsigned char>(word[1]));
    const std::string_view name = std::string_view(word).substr(is_name ? 1 : 0);
    const bool plain = std::ranges::all_of(name, [&](unsigned char c) {
      return std::isalnum(c) || c == '_' || (!is_name && (c == '.' || c == '+' || c == '-'));
    });
    if (!plain || (!is_name && !takes_value)) refuse(word);
    if (!is_name) {
      takes_value = false;
      continue;
    }
    const bool own = std::ranges::find(alone, name) != alone.end();
    if (!own && std::ranges::none_of(beginnings, [&](std::string_view b) { return name.starts_with(b); })) refuse(word);
    takes_value = !own && name.find("view") == name.npos && name.find("monitor") == name.npos;
  }
}

void read_solver(const Value& document, Case& c) {
  const auto solver = find_table(document, "solver");
  if (!solver) return;
  allow_only(*solver);
  const auto degree = find(*solver, "degree");
  c.element = read_element(*solver, degree ? *degree : *solver, c.element);
  c.optimize_element = read_element(*solver, degree ? *degree : *solver, c.optimize_element);
  take(*solver, "contact", c.contact);
  take(*solver, "backend", c.backend);
  take(*solver, "precision", c.precision);
  if (c.precision == FactorPrecision::Single && c.backend == Backend::Umfpack)
    fail(find(*solver, "precision")->node->position,
         "solver.precision = \"single\" goes with backend = \"cholmod\" or \"petsc\"");
  if (const auto options = find(*solver, "petsc")) {
    c.petsc = text(*options);
    if (c.backend != Backend::Petsc) fail(options->node->position, options->name + " goes with backend = \"petsc\"");
    require_plain_options(*options, c.petsc);
  }
}

void read_output(const Value& document, Case& c) {
  const auto output = find_table(document, "output");
  if (!output) return;
  allow_only(*output);
  take(*output, "vtk", c.output.vtk);
  take(*output, "png", c.output.png);
  take(*output, "html", c.output.html);
  take(*output, "estimate", c.output.estimate);
  take(*output, "energy_bounds", c.output.energy_bounds);
  take(*output, "tips", c.output.tips);
  take(*output, "peaks", c.output.peaks);
  if (const auto margins = find(*output, "margins")) c.output.margins = boolean(*margins);
  if (const auto estimate = find(*output, "estimate"); !c.output.estimate && c.adapt)
    fail(estimate->node->position,
         estimate->name + " = false does not go with mesh.adapt, which refines by the estimate; leave one of them out");
}

/// Of keys, and of the entries of lists that are no numbers.
void note_places(const Node& node, const std::string& path, std::map<std::string, std::string>& places) {
  const auto note = [&places](const std::string& at, const Node& value) {
    places[at] = to_string(value.position);
    note_places(value, at, places);
  };
  for (const Entry& entry : node.entries) note(path.empty() ? entry.key : path + "." + entry.key, entry.value);
  for (std::size_t i = 0; i < node.items.size(); ++i)
    if (const Node::Kind kind = node.items[i].kind; kind != Node::Kind::Integer && kind != Node::Kind::Float)
      note(fmt::format("{}[{}]", path, i), node.items[i]);
}

}  // namespace

Elastic read_elastic(const Value& table) {
  const Value young = need(table, "young"), poisson = need(table, "poisson");
  if (young.node->kind != Node::Kind::Array) {
    for (const char* key : {"shear", "angle"})
      if (const auto field = find(table, key))
        fail(field->node->position,
             fmt::format("{} goes with an orthotropic material, young = [E1, E2]; leave it out", field->name));
    return {in_range(young), in_range(poisson)};
  }
  const std::vector<Value> both = pair(young);
  Orthotropy o{.young = {in_range(both[0]), in_range(both[1])},
               .poisson = number(poisson),
               .shear = in_range(need(table, "shear"))};
  double degrees = 0;
  take(table, "angle", degrees);
  o.angle = degrees * pi / 180;
  return {o.young[0], o.poisson, o};
}

namespace {

Material orthotropic_material(const Value& table, const Orthotropy& constants, bool in_plane_strain) {
  const Position& where = find(table, "young")->node->position;
  if (in_plane_strain)
    fail(where, fmt::format("{}: young = [E1, E2] are constants in the plane, and plane strain needs those across it, "
                            "for which there are no keys; write state = \"plane stress\" in [material]",
                            table.name));
  try {
    return orthotropic(constants);
  } catch (const Error& e) {
    fail(where, fmt::format("{}: {}", table.name, e.what()));
  }
}

}  // namespace

Material elastic(const Value& table, const Elastic& constants, bool in_plane_strain) {
  const double young = constants.young, poisson = constants.poisson;
  const Material m = constants.orthotropy ? orthotropic_material(table, *constants.orthotropy, in_plane_strain)
                     : in_plane_strain    ? plane_strain(young, poisson)
                                          : plane_stress(young, poisson);
  if (!std::isnormal(m.mu) || !std::isfinite(m.c) || !std::isnormal(plane_modulus(m)) || !std::isfinite(m.coupling) ||
      !std::isfinite(m.split))
    fail(table.node->position, fmt::format("{}: young = {} is out of range; choose other units", table.name, young));
  return m;
}

Element read_element(const Value& table, const Value& blamed, const Element& otherwise) {
  const auto name = find(table, "element"), degree = find(table, "degree");
  if (!name && !degree) return otherwise;
  const std::string word = name ? choice(*name) : std::string(otherwise.name);
  // Which degrees an element has, it says itself.
  const int number = degree ? whole_number(*degree, {1, 9}) : has_degree(word, otherwise.degree) ? otherwise.degree : 1;
  try {
    return element(word, number);
  } catch (const Error& e) {
    fail(blamed.node->position, e.what());
  }
}

Case read_case(const std::filesystem::path& path, std::span<const std::string> overrides) {
  return read_case(read_document(path), {path.stem().string(), path.parent_path(), path.string() + ":1:1"}, overrides);
}

Case read_case(Node root, const Origin& origin, std::span<const std::string> overrides) {
  for (const std::string& assignment : overrides) override_value(root, assignment);
  const Value document{&root, ""};
  allow_only(document);

  Case c;
  c.name = origin.name;
  const auto title = find(document, "title");
  c.title = title ? text(*title) : c.name;
  read_units(document, c);
  const std::optional<MeshFile> file = read_shape(document, origin.folder, c);
  read_material(document, c);
  const ReadRegions regions = read_regions(document, file, c);
  const std::vector<Loop>& frozen = regions.frozen;
  read_strength(document, regions.tables, c);
  read_interfaces(document, c);
  read_patches(document, c);
  Definitions definitions = read_definitions(document, c);
  read_steps(document, regions.tables, definitions, c);
  read_eigenstrains(document, regions.tables, definitions, c);
  read_conditions(document, definitions, c);
  read_functional(document, origin.folder, definitions, c);
  read_mesh(document, c);
  draw_half_tips(c);
  read_solver(document, c);
  read_synthetic(document, c);
  read_optimize(document, origin.folder, frozen, definitions, c);
  leave_out_zones(frozen, c);
  read_curved(document, c);
  c.sizing.long_ligaments = c.element.order >= 2;
  c.sizing.images = smooth_images(all_materials(c.scene));
  check_all_used(definitions);
  read_map(document, c);
  read_probes(document, origin.folder, c);
  read_bounds(document, c);
  read_grow(document, origin.folder, c);
  read_output(document, c);
  c.folder = origin.folder;
  if (c.optimize) c.fingerprint = fingerprint(root, c.folder);
  c.places[""] = origin.place;
  note_places(root, "", c.places);
  c.document = std::make_shared<const Node>(std::move(root));
  return c;
}

bool has_functions(const Node& document) {
  return document.kind == Node::Kind::Function || std::ranges::any_of(document.items, has_functions) ||
         std::ranges::any_of(document.entries, [](const Entry& entry) { return has_functions(entry.value); });
}

// The place of the key or, where it is not in the file, of the innermost table around it that is.
std::string place_of(const Case& c, std::string key) {
  while (true) {
    if (const auto found = c.places.find(key); found != c.places.end()) return found->second;
    const std::size_t last = key.find_last_of(".[");
    key.erase(last == std::string::npos ? 0 : last);
  }
}

void choose_edges(Case& c) {
  const bool has_arcs = c.mesh ? !c.mesh->arc.empty() : !arcs_of(c.shape).empty();
  c.why_chords = !c.curved && has_arcs ? why_chords(c) : "";
  c.sizing.curved = c.curved.value_or(has_arcs && c.why_chords.empty());
  if (c.mesh && has_arcs && !c.sizing.curved) c.mesh = std::make_shared<const Mesh>(with_chords(*c.mesh));
}

// What a mesh of one state gets on top (one layer of triangles in ligaments, images of curved sides) is left out:
// designs are meshed anew at each step.
Problem problem_of(const Case& c, int threads) {
  Sizing sizing = c.sizing;
  sizing.curved = c.curved.value_or(false);
  sizing.long_ligaments = false;
  sizing.images.clear();
  Shape frame = c.shape;
  if (c.optimize && !find_problem(c.shape))
    for (const Loop& keep_out : c.optimize->keep_out) frame = without(frame, keep_out);
  return {.frame = std::move(frame),
          .scene = c.scene,
          .sizing = sizing,
          .element = c.optimize_element,
          .objective = c.functional,
          .contact = c.contact,
          .plane_strain = c.plane_strain,
          .threads = threads,
          .follow_curves = c.curved.value_or(true)};
}

}  // namespace kerf
