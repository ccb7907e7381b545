// Conditions on the boundary, body force, eigenstrains, pressures and gaps of cracks, load cases. What the tables say
// is collected per label first, so that contradictions are found whatever table they come from: two loads on a label, a
// load along a component whose displacement is prescribed, a pressure against a prescribed normal displacement. Of a
// load beside a support in one direction the free part alone is kept, t - (t . n) n or t - t_d e_d: the other part does
// no work and would only be added to the reaction. A pressure p is the traction -p n. An eigenstrain is (e_xx, e_yy),
// e_xy and, in plane strain, e_zz, which acts in the plane through nu: e_xx + nu e_zz and e_yy + nu e_zz [theory: H.2].
// With [[load_case]] all loads belong to load cases, which share the supports of [[boundary]].

#include "io/case/formula.hpp"
#include "io/case/interfaces.hpp"
#include "io/words.hpp"
#include "optimize/load_cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace kerf {

namespace {

const std::vector<std::string> loads = {"traction", "pressure"};
const std::vector<std::string> supports = {"displacement", "displacement_x", "displacement_y", "displacement_normal",
                                           "symmetry"};

/// What one label carries: per key where it stands and its one or two components.
struct Condition {
  Position position;
  std::array<Formula, 2> value;
};
using Conditions = std::map<std::string, Condition>;

/// Whether a label cannot have both keys; x and y together are looked at in add().
bool clash(const std::string& a, const std::string& b) {
  if (a == b || a == "symmetry" || b == "symmetry") return true;
  const auto either = [&](const char* p, const char* q) { return (a == p && b == q) || (a == q && b == p); };
  const bool a_loads = a == loads[0] || a == loads[1], b_loads = b == loads[0] || b == loads[1];
  if (a_loads && b_loads) return true;
  if (a == "displacement" || b == "displacement") return true;
  if (a_loads || b_loads) return either("pressure", "displacement_normal");
  return !either("displacement_x", "displacement_y");
}

void add(Conditions& on_label, const std::string& key, const Condition& condition, const std::string& label) {
  const auto conflict = [&](const std::string& what, const Position& other) {
    fail(condition.position,
         fmt::format("label {}: {} (the other is at {}); keep one of them", quote(label), what, to_string(other)));
  };
  for (const auto& [other, present] : on_label)
    if (clash(key, other))
      conflict(key == other ? "two conditions " + key : key + " conflicts with " + other, present.position);
  on_label.emplace(key, condition);
  // x and y together prescribe the whole displacement: nothing is left for a load.
  if (on_label.count("displacement_x") && on_label.count("displacement_y"))
    for (const std::string& load : loads)
      if (const auto found = on_label.find(load); found != on_label.end())
        conflict(load + " conflicts with the displacement, of which both components are prescribed",
                 key == load ? on_label.at("displacement_x").position : found->second.position);
}

/// A load that acts where one component of the displacement is prescribed: only the free component does work, so the
/// other is left out. A traction that is plainly not zero there is an error of the user's.
BoundaryField free_part(const Conditions& on_label, const BoundaryField& load, const std::string& label) {
  if (on_label.count("displacement_normal")) return without_normal_part(load);
  for (const int d : {0, 1}) {
    const std::string key = d == 0 ? "displacement_x" : "displacement_y";
    const auto roller = on_label.find(key);
    if (roller == on_label.end()) continue;
    if (const auto traction = on_label.find("traction"); traction != on_label.end())
      if (traction->second.value[d].constant != 0.0)
        fail(traction->second.position,
             fmt::format("label {}: component {} of the traction must be 0, because {} is prescribed there (at {})",
                         quote(label), d == 0 ? "x" : "y", key, to_string(roller->second.position)));
    return without_component(load, d);
  }
  return load;
}

const Condition* get(const Conditions& on_label, const char* key) {
  const auto found = on_label.find(key);
  return found == on_label.end() ? nullptr : &found->second;
}

void add_support(const Conditions& on_label, Index label, std::vector<Support>& supports) {
  if (get(on_label, "symmetry")) {
    supports.push_back({label, true, true, false, vector_field(nothing(), nothing())});
  } else if (const auto* full = get(on_label, "displacement")) {
    supports.push_back({label, false, true, true, vector_field(full->value[0], full->value[1])});
  } else if (const auto* normal = get(on_label, "displacement_normal")) {
    supports.push_back({label, true, true, false, vector_field(normal->value[0], nothing())});
  } else {
    const auto *x = get(on_label, "displacement_x"), *y = get(on_label, "displacement_y");
    if (x || y)
      supports.push_back({label, false, x != nullptr, y != nullptr,
                          vector_field(x ? x->value[0] : nothing(), y ? y->value[0] : nothing())});
  }
}

void add_load(const Conditions& on_label, Index label, const std::string& name, std::vector<Traction>& tractions) {
  BoundaryField load;
  if (const auto* traction = get(on_label, "traction")) load = vector_field(traction->value[0], traction->value[1]);
  if (const auto* pressure = get(on_label, "pressure")) load = pressure_field(pressure->value[0]);
  if (load) tractions.push_back({label, free_part(on_label, load, name)});
}

std::vector<std::string> together(const std::vector<std::string>& a, const std::vector<std::string>& b) {
  std::vector<std::string> all = a;
  all.insert(all.end(), b.begin(), b.end());
  return all;
}

/// The entries of [[boundary]] tables that have one of the keys, added to what the labels carry. Edges that are drawn
/// around points carry what the sides do that they are pieces of, then what is said of them.
void add_conditions(const std::vector<Value>& tables, const std::vector<std::string>& keys, Definitions& definitions,
                    const Case& c, std::vector<Conditions>& per_label) {
  const Shape& shape = c.shape;
  const auto add_table = [&](const Value& entry, const std::vector<Index>& labels) {
    bool anything = false;
    for (const std::string& key : keys) {
      const auto field = find(entry, key);
      if (!field) continue;
      anything = true;
      if (key == "symmetry") {
        if (!boolean(*field))
          fail(field->node->position, fmt::format("{} = false says nothing; leave it out", field->name));
        for (const Index label : labels)
          add(per_label[label], key, {field->node->position, {nothing(), nothing()}}, shape.labels[label]);
        continue;
      }
      const bool is_vector = key == "traction" || key == "displacement";
      const Condition condition{field->node->position, is_vector ? formulas(*field, definitions)
                                                                 : std::array{formula(*field, definitions), Formula{}}};
      for (const Index label : labels) add(per_label[label], key, condition, shape.labels[label]);
    }
    if (!anything)
      fail(entry.node->position,
           fmt::format("{} prescribes nothing; give {}", entry.name,
                       keys == loads ? fmt::format("{}", fmt::join(loads, " or "))
                                     : fmt::format("{} or {}", fmt::join(loads, ", "), fmt::join(supports, ", "))));
  };
  for (const Value& entry : tables)
    if (!find(entry, "at")) add_table(entry, find_labels(need(entry, "on"), shape));
  for (const PointPatch& patch : c.patches)
    for (const auto& [key, condition] : per_label[patch.beside])
      if (contains(keys, key)) add(per_label[patch.label], key, condition, shape.labels[patch.label]);
  // Those of [[load]] come first among the patches.
  std::size_t number =
      c.patches.size() - static_cast<std::size_t>(std::ranges::count_if(
                             tables, [](const Value& entry) { return find(entry, "at").has_value(); }));
  for (const Value& entry : tables)
    if (find(entry, "at")) add_table(entry, {c.patches[number++].label});
}

/// The force of a [[load]] spread over its edge, which supports must leave free to do work.
void add_force(const Value& table, const PointPatch& patch, const Conditions& on_label, Definitions& definitions,
               Case& c) {
  const auto field = find(table, "force");
  const std::string name = quote(c.shape.labels[patch.label]);
  if (!field)
    fail(table.node->position,
         fmt::format("missing key \"force\" in {}; add it, or give {} a traction in [[load_case.boundary]]", table.name,
                     name));
  const std::array<Formula, 2> force = formulas(*field, definitions, false);
  for (const int d : {0, 1}) {
    const double here = force[d].value(patch.at, Vec2::Zero()),
                 there = force[d].value(patch.at + patch.width * Vec2(1, 1), Vec2::Zero());
    if (here != there)
      fail(field->node->position,
           fmt::format("{}: a force is one number per component; for a load that varies over a side use [[boundary]] "
                       "traction",
                       field->name));
    const char* held = get(on_label, "displacement")               ? "displacement"
                       : d == 0 && get(on_label, "displacement_x") ? "displacement_x"
                       : d == 1 && get(on_label, "displacement_y") ? "displacement_y"
                                                                   : nullptr;
    if (held && here != 0)
      fail(field->node->position,
           fmt::format("{}: component {} must be 0, because {} is prescribed there (at {})", field->name,
                       d == 0 ? "x" : "y", held, to_string(get(on_label, held)->position)));
  }
  if (const Condition* normal = get(on_label, "displacement_normal"))
    fail(field->node->position,
         fmt::format("{}: the side has a support along its normal (at {}); put the load elsewhere", field->name,
                     to_string(normal->position)));
  c.scene.tractions.push_back({patch.label, scaled_load(vector_field(force[0], force[1]),
                                                        1 / (patch.at_plane ? patch.width / 2 : patch.width))});
}

VectorField body_force(const Value& table, Definitions& definitions) {
  allow_only(table);
  const auto force = formulas(need(table, "force"), definitions, false);
  return body_field(force[0], force[1]);
}

/// [xx, yy, xy] and zz, which bends into the plane by nu in plane strain and is nothing in plane stress.
Eigenstrain eigenstrain(const Value& field, double poisson, bool plane_strain, Definitions& definitions) {
  const std::vector<Value> given = items(field);
  if (given.size() != 3 && given.size() != 4)
    fail(field.node->position,
         fmt::format("{} has {} entries; give [xx, yy, xy], in plane strain also [xx, yy, xy, zz]", field.name,
                     given.size()));
  std::vector<Formula> e;
  for (const Value& one : given) e.push_back(formula(one, definitions, false));
  const bool out_of_plane = plane_strain && given.size() == 4 && e[3].constant != 0.0;
  Eigenstrain strain{body_field(e[0], e[1]), body_field(e[2], out_of_plane ? e[3] : nothing()), out_of_plane};
  if (out_of_plane) strain.normal = sum(strain.normal, scaled(poisson, body_field(e[3], e[3])));
  return strain;
}

/// The keys `pressure` of [[crack]], whose expressions may use what [define] names.
void read_pressures(const Value& document, Definitions& definitions, Case& c) {
  for (const Value& entry : find_tables(document, "crack")) {
    const auto field = find(entry, "pressure");
    if (!field) continue;
    const std::string name = text(need(entry, "name"));
    const auto crack = std::ranges::find(c.shape.cracks, name, &Crack::name);
    CrackLaw& law = c.scene.laws[static_cast<std::size_t>(crack - c.shape.cracks.begin())];
    if (law.kind == CrackLaw::Kind::Bonded)
      fail(field->node->position, fmt::format("{}: crack {} is bonded and has no faces for a pressure; change its "
                                              "contact, or leave the pressure out",
                                              field->name, quote(name)));
    law.pressure = vector_field(formula(*field, definitions, false), nothing());
  }
}

/// The keys `gap` of [[crack]].
void read_gaps(const Value& document, Definitions& definitions, Case& c) {
  for (const Value& entry : find_tables(document, "crack")) {
    const auto field = find(entry, "gap");
    if (!field) continue;
    const std::string name = text(need(entry, "name"));
    const auto crack = std::ranges::find(c.shape.cracks, name, &Crack::name);
    CrackLaw& law = c.scene.laws[static_cast<std::size_t>(crack - c.shape.cracks.begin())];
    if (!is_unilateral(law))
      fail(field->node->position, fmt::format("{}: the faces of crack {} never touch; give it contact = "
                                              "\"unilateral\", or leave the gap out",
                                              field->name, quote(name)));
    law.gap = vector_field(formula(*field, definitions, false), nothing());
  }
}

/// The keys `gap` of [[interface]], each for all cracks that the table made.
void read_gaps_of_interfaces(const Value& document, Definitions& definitions, Case& c) {
  const auto place = [&](const Value& entry) {
    const std::string name = text(need(entry, "name"));
    return static_cast<std::size_t>(std::ranges::find(c.shape.cracks, name, &Crack::name) - c.shape.cracks.begin());
  };
  const std::vector<Value> tables = interface_tables(document);
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const auto field = find(tables[i], "gap");
    if (!field) continue;
    const BoundaryField gap = vector_field(formula(*field, definitions, false), nothing());
    const std::size_t end = i + 1 < tables.size() ? place(tables[i + 1]) : c.shape.cracks.size();
    for (std::size_t k = place(tables[i]); k < end; ++k) c.scene.laws[k].gap = gap;
  }
}

}  // namespace

void read_eigenstrains(const Value& document, const std::vector<std::optional<Value>>& regions,
                       Definitions& definitions, Case& c) {
  std::vector<Eigenstrain> all(1 + c.scene.regions.size());
  const auto take_from = [&](const Value& table, double poisson, Eigenstrain& to) {
    if (const auto field = find(table, "eigenstrain")) to = eigenstrain(*field, poisson, c.plane_strain, definitions);
  };
  take_from(*find_table(document, "material"), c.poisson, all[0]);
  for (std::size_t r = 0; r < regions.size(); ++r)
    if (regions[r])
      take_from(*regions[r], c.regions[r].poisson, all[r + 1]);
    else
      all[r + 1] = all[0];  // a surface of a file that is what the body is
  if (std::ranges::any_of(all, [](const Eigenstrain& e) { return static_cast<bool>(e); }))
    c.scene.eigenstrain = std::move(all);
}

void read_conditions(const Value& document, Definitions& definitions, Case& c) {
  std::vector<Conditions> per_label(c.shape.labels.size());
  const std::vector<Value> tables = find_tables(document, "boundary");
  const std::vector<std::string> keys = together(loads, supports);
  for (const Value& entry : tables) allow_only(entry, one_of(entry));
  add_conditions(tables, keys, definitions, c, per_label);
  c.planes.clear();
  for (std::size_t label = 0; label < per_label.size(); ++label)
    if (get(per_label[label], "symmetry")) c.planes.push_back(static_cast<Index>(label));
  for (std::size_t label = 0; label < per_label.size(); ++label) {
    add_support(per_label[label], static_cast<Index>(label), c.scene.supports);
    add_load(per_label[label], static_cast<Index>(label), c.shape.labels[label], c.scene.tractions);
  }
  const std::vector<Value> forces = find_tables(document, "load");
  if (find_tables(document, "load_case").empty())
    for (std::size_t i = 0; i < forces.size(); ++i)
      add_force(forces[i], c.patches[i], per_label[c.patches[i].label], definitions, c);
  if (const auto body = find_table(document, "body")) c.scene.body = body_force(*body, definitions);
  for (const Index plane : c.planes)
    require_symmetry(get(per_label[static_cast<std::size_t>(plane)], "symmetry")->position, plane, c.scene.body, c);
  read_pressures(document, definitions, c);
  read_gaps(document, definitions, c);
  read_gaps_of_interfaces(document, definitions, c);
}

std::vector<LoadCase> read_load_cases(const Value& document, Definitions& definitions, const Case& c) {
  std::vector<LoadCase> out;
  const std::vector<Value> tables = find_tables(document, "load_case");
  if (tables.empty()) return out;
  const std::vector<Value> boundary = find_tables(document, "boundary");
  for (const Value& entry : boundary)
    for (const std::string& key : loads)
      if (const auto load = find(entry, key))
        fail(load->node->position, fmt::format("{}: with [[load_case]] all loads belong to load cases; move it to each "
                                               "load case in which it acts",
                                               load->name));
  for (const Value& entry : find_tables(document, "load"))
    if (const auto force = find(entry, "force"))
      fail(force->node->position,
           fmt::format("{}: with [[load_case]] all loads belong to load cases; leave it out, and "
                       "give the edge a name and, in each load case in which it acts, a traction",
                       force->name));
  if (const auto body = find_table(document, "body"))
    fail(body->node->position,
         "[body]: with [[load_case]] all loads belong to load cases; write body = { force = ... } "
         "in each load case in which it acts");
  for (const Value& entry : find_tables(document, "crack"))
    if (const auto field = find(entry, "pressure"))
      fail(field->node->position, fmt::format("{}: with [[load_case]] all loads belong to load cases, which have no "
                                              "pressures in cracks; use [[boundary]] loads instead of load cases",
                                              field->name));
  std::vector<Conditions> supported(c.shape.labels.size());
  add_conditions(boundary, supports, definitions, c, supported);
  for (const Value& table : tables) {
    allow_only(table);
    LoadCase load_case;
    load_case.name = new_name(need(table, "name"), out);
    take(table, "weight", load_case.weight);
    const std::vector<Value> entries = find_tables(table, "boundary");
    for (const Value& entry : entries) {
      for (const std::string& key : supports)
        if (const auto field = find(entry, key))
          fail(field->node->position,
               fmt::format("{}: all load cases have the supports of [[boundary]]; move it there", field->name));
      allow_only(entry);
    }
    std::vector<Conditions> per_label = supported;
    add_conditions(entries, loads, definitions, c, per_label);
    for (std::size_t label = 0; label < per_label.size(); ++label)
      add_load(per_label[label], static_cast<Index>(label), c.shape.labels[label], load_case.tractions);
    if (const auto body = find(table, "body")) load_case.body = body_force(*body, definitions);
    for (const Index plane : c.planes)
      require_symmetry(get(supported[static_cast<std::size_t>(plane)], "symmetry")->position, plane, load_case.body, c);
    if (load_case.tractions.empty() && !load_case.body)
      fail(table.node->position,
           fmt::format("{} {} has no load; add [[load_case.boundary]] with {}, or body = {{ force = ... }}", table.name,
                       quote(load_case.name), fmt::join(loads, " or ")));
    out.push_back(std::move(load_case));
  }
  return out;
}

Scene loaded_scene(const Case& c) {
  Scene scene = c.scene;
  if (!c.optimize || c.optimize->load_cases.empty()) return scene;
  const LoadCase& first = shown(c.optimize->load_cases);
  scene.tractions.insert(scene.tractions.end(), first.tractions.begin(), first.tractions.end());
  if (first.body) scene.body = first.body;
  return scene;
}

}  // namespace kerf
