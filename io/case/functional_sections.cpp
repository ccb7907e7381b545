// [functional] and [[optimize.bound]]: a table with `kind` as a sum of terms with factors. The keys that go with a kind
// come from the table of keys; what is written beside them is refused with the kind's own keys. Fields in a term
// (weight, target, direction) are kept twice: as functions, and as enclosures for what is proved of the integrals of
// the term. A misfit compares with a file of readings (measured.cpp), with two expressions or with synthetic data,
// which are computed later: until then its field throws. An energy release rate needs the geometry of its tip and a
// ring free of everything else (tip.cpp), and a crack whose faces carry neither pressure nor gap, whose work it would
// leave out. docs/theory/topological_derivatives.md has the functionals, docs/theory/inverse.md the misfit.

#include "io/case/formula.hpp"
#include "io/case/measured.hpp"
#include "io/case/table.hpp"
#include "io/case/tip.hpp"
#include "io/words.hpp"
#include "kerf/edge_cracks.hpp"
#include "optimize/stress_zones.hpp"
#include "topo/orthotropic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace kerf {

namespace {

std::vector<std::string> names_of_keys(const std::vector<const Key*>& keys) {
  std::vector<std::string> names;
  for (const Key* key : keys)
    if (name(*key) != "kind") names.emplace_back(name(*key));
  return names;
}

/// The kind, with the keys of the table checked against it.
std::string read_kind(const Value& table) {
  const std::string kind = choice(need(table, "kind"));
  const std::vector<const Key*> keys = keys_in(table.path, kind);
  std::vector<std::string> known = names_of_keys(keys);
  const std::vector<std::string> any = names_of_keys(keys_in(table.path));
  for (const Entry& entry : table.node->entries)
    if (!contains(known, entry.key) && contains(any, entry.key))
      fail(entry.position,
           fmt::format("{} in {} does not go with kind = \"{}\", which takes {}", quote(entry.key), table.name, kind,
                       known.empty() ? "no other key" : fmt::format("{}", fmt::join(known, ", "))));
  known.emplace_back("kind");
  for (const Entry& entry : table.node->entries)
    if (!contains(known, entry.key)) refuse_unknown(entry, table, known);
  for (const Key* key : keys)
    if (key->rules.required && !key->rules.with.empty() && !find(table, std::string(name(*key))))
      fail(table.node->position,
           fmt::format("kind = \"{}\" in {} needs the key {}; add it", kind, table.name, quote(name(*key))));
  return kind;
}

bool is_synthetic(const Value& measured) {
  return measured.node->kind == Node::Kind::String && measured.node->text == "synthetic";
}

struct Reader {
  const std::filesystem::path& folder;
  Definitions& definitions;
  const Case& c;
  std::vector<std::string>* notes;  // nobody's, where none is asked for

  ScalarField scalar(const Value& field) const {
    return [f = formula(field, definitions, false).value](const Vec2& x) { return f(x, Vec2::Zero()); };
  }

  ScalarField weight(const Value& table) const {
    const auto given = find(table, "weight");
    return given ? scalar(*given) : ScalarField{};
  }

  /// What is known of these keys of the table, as far as it has them, for the integrals of a term over body and crack.
  void tell(Term& term, const Value& table, std::initializer_list<const char*> keys) const {
    for (const char* key : keys) {
      const auto given = find(table, key);
      if (!given) continue;
      const bool pair =
          given->node->kind == Node::Kind::Array || (given->node->pair && key == std::string_view("target"));
      const std::array<Formula, 2> parts =
          pair ? formulas(*given, definitions, false) : std::array{formula(*given, definitions, false), nothing()};
      if (term.on_crack)
        term.varies_along.push_back(vector_field(parts[0], parts[1]));
      else
        term.varies.push_back(body_field(parts[0], parts[1]));
    }
  }

  /// A crack with faces, by its name.
  Index crack(const Value& table) const {
    const Value field = need(table, "crack");
    const std::string word = text(field);
    std::vector<std::string> names;
    for (const Crack& crack : c.shape.cracks) names.push_back(crack.name);
    const auto found = std::find(names.begin(), names.end(), word);
    if (found == names.end())
      fail(field.node->position, fmt::format("{}: there is no crack {}; {}", field.name, quote(word),
                                             names.empty() ? "the case has none" : suggest(word, names)));
    const auto number = static_cast<std::size_t>(found - names.begin());
    if (c.scene.laws[number].kind == CrackLaw::Kind::Bonded)
      fail(field.node->position,
           fmt::format("{}: crack {} is bonded and has no faces; choose another or change its contact", field.name,
                       quote(word)));
    return static_cast<Index>(number);
  }

  /// One term per label, made by boundary_tracking or boundary_displacement of the pair under `key`.
  std::vector<Term> boundary_terms(const Value& table, const char* key, decltype(boundary_tracking)& made) const {
    const std::vector<Index> labels = find_labels(need(table, "on"), c.shape);
    const auto pair = formulas(need(table, key), definitions);
    const BoundaryField field = vector_field(pair[0], pair[1]);
    std::vector<BoundaryField> varies{field};
    BoundaryWeight weight;
    if (const auto given = find(table, "weight")) {
      const Formula factor = formula(*given, definitions);
      weight = factor.value;
      varies.push_back(vector_field(factor, nothing()));
    }
    std::vector<Term> terms;
    for (const Index label : labels) {
      terms.push_back(made(label, field, weight));
      terms.back().varies_along = varies;
    }
    return terms;
  }

  Term edge_crack_term(const Value& table) const {
    const Value on = need(table, "on");
    const std::vector<Index> labels = find_labels(on, c.shape);
    for (const Support& support : c.scene.supports)
      if (std::ranges::find(labels, support.label) != labels.end())
        fail(on.node->position, fmt::format("{}: a displacement is prescribed on label {}, where no crack counts; "
                                            "name other sides",
                                            on.name, quote(c.shape.labels[support.label])));
    return inspect::worst_edge_crack(labels, in_range(need(table, "length")), in_range(need(table, "p")));
  }

  Term misfit_term(const Value& table) const {
    const Value on = need(table, "on");
    const std::vector<Index> labels = find_labels(on, c.shape);
    if (labels.size() > 1)
      fail(on.node->position,
           fmt::format("{}: a misfit compares along one label; give the sides measured on the same label", on.name));
    for (const Support& support : c.scene.supports)
      if (support.label == labels[0])
        fail(on.node->position, fmt::format("{}: a displacement is prescribed on label {} already; measure where the "
                                            "body is loaded or free",
                                            on.name, quote(c.shape.labels[labels[0]])));
    const Value measured = need(table, "measured");
    if (is_synthetic(measured))
      return misfit(labels[0], [](const Vec2&, const Vec2&) -> Vec2 {
        throw std::logic_error("the synthetic data have not been computed yet");
      });
    if (measured.node->kind == Node::Kind::String) {
      MeasuredField read = read_measured(folder / text(measured), measured, c.shape, labels[0]);
      if (notes) notes->insert(notes->end(), read.notes.begin(), read.notes.end());
      return misfit(labels[0], std::move(read.value));
    }
    if (measured.node->kind != Node::Kind::Array && measured.node->kind != Node::Kind::Function)
      fail(
          measured.node->position,
          measured.name + " must be a file with the columns x,y,u_x,u_y, two expressions [u_x, u_y], or \"synthetic\"");
    const auto u = formulas(measured, definitions);
    return misfit(labels[0], vector_field(u[0], u[1]));
  }

  /// Faces do work that the integrals over a ring leave out, or the fields of a straight tip are none of this one.
  void refuse_faces(const Value& table, const std::string& kind, Index number) const {
    const CrackLaw& law = c.scene.laws[static_cast<std::size_t>(number)];
    const Crack& crack = c.shape.cracks[static_cast<std::size_t>(number)];
    const auto refuse = [&](const std::string& why) {
      fail(table.node->position,
           fmt::format("{}: {}; kerf solve gives K and G of its tips, or use another functional", table.name, why));
    };
    const std::string faces = "the faces of crack " + quote(crack.name);
    if (has_pressure(law)) refuse(fmt::format("{} carry a pressure, whose work {} does not count", faces, kind));
    if (has_gap(law)) refuse(fmt::format("{} have a gap, whose contact does work that {} does not count", faces, kind));
    if (kind != "stress_intensity") return;
    if (has_friction(law)) refuse(fmt::format("{} have friction, whose work {} does not count", faces, kind));
    if (crack.arc) refuse(fmt::format("crack {} is an arc, and {} takes a straight one", quote(crack.name), kind));
    if (has_orthotropic(c.scene)) refuse(fmt::format("the body is orthotropic, and {} takes isotropic ones", kind));
  }

  Term tip_term(const Value& table, const std::string& kind) const {
    const Index number = crack(table);
    refuse_faces(table, kind, number);
    const Value which = need(table, "tip");
    const bool at_start = choice(which) == "start";
    const TipPlace tip = crack_tip(c.shape, number, at_start);
    const std::string name = fmt::format("the {} of crack {}", at_start ? "start" : "end",
                                         quote(c.shape.cracks[static_cast<std::size_t>(number)].name));
    if (tip.clearance <= 1e-6 * extent(c.shape))
      fail(which.node->position, fmt::format("{}: {} lies on {}: there is no tip", which.name, name, tip.nearest));
    std::array<double, 2> ring = tip.ring;
    if (const auto given = find(table, "ring")) {
      const std::vector<Value> radii = items(*given);
      if (radii.size() != 2) fail(given->node->position, given->name + " must be two radii [inner, outer]");
      ring = {in_range(radii[0]), in_range(radii[1])};
      if (!(ring[0] < ring[1]))
        fail(given->node->position, fmt::format("{}: the outer radius {:g} must be larger than the inner one {:g}",
                                                given->name, ring[1], ring[0]));
      if (!(ring[1] < tip.clearance))
        fail(given->node->position, fmt::format("{}: {} is only {:.6g} from {}; the outer radius must be smaller",
                                                given->name, tip.nearest, tip.clearance, name));
    }
    if (kind == "energy_release_rate") return energy_release_rate(tip.at, tip.direction, ring, c.scene.body);
    OfTip of{TipQuantity::OpeningMode, tip.direction};
    if (const auto mode = find(table, "mode"))
      of.quantity = choice(*mode) == "II"  ? TipQuantity::SlidingMode
                    : choice(*mode) == "I" ? TipQuantity::OpeningMode
                                           : TipQuantity::Equivalent;
    const bool may_touch = is_unilateral(c.scene.laws[static_cast<std::size_t>(number)]);
    return stress_intensity(of, tip.at, ring, c.scene.body, may_touch ? number : none);
  }

  /// Its zones come with `leave_out_zones`, when all loads are known.
  Term largest_stress_term(const Value& table) const {
    LargestStress what{.plane_strain = c.plane_strain};
    take(table, "of", what.of);
    if (const auto except = find(table, "except")) {
      if (except->node->kind != Node::Kind::Table)
        fail(except->node->position, except->name + " must be { ends = 0.01, supports = 0.014 }");
      allow_only(*except);
      if (const auto ends = find(*except, "ends")) what.ends = in_range(*ends);
      if (const auto supports = find(*except, "supports")) what.supports = in_range(*supports);
    }
    return max_stress(what);
  }

  std::vector<Term> terms(const Value& table, const std::string& kind) const {
    std::vector<Term> made = bare_terms(table, kind);
    for (Term& term : made)
      if (term.density || term.on_crack) tell(term, table, {"weight", "target"});
    return made;
  }

  std::vector<Term> bare_terms(const Value& table, const std::string& kind) const {
    if (kind == "energy") return {energy()};
    if (kind == "compliance") return {compliance()};
    if (kind == "volume") return {volume()};
    if (kind == "displacement_tracking") {
      const auto target = formulas(need(table, "target"), definitions, false);
      const BoundaryField field = vector_field(target[0], target[1]);
      return {displacement_tracking([field](const Vec2& x) { return field(x, Vec2::Zero()); }, weight(table))};
    }
    if (kind == "boundary_tracking") return boundary_terms(table, "target", boundary_tracking);
    if (kind == "displacement") return boundary_terms(table, "direction", boundary_displacement);
    if (kind == "stress_power" || kind == "stress_pnorm") {
      const double p = in_range(need(table, "p"));
      return {kind == "stress_power" ? stress_power(p, weight(table), c.plane_strain)
                                     : stress_pnorm(p, weight(table), c.plane_strain)};
    }
    if (kind == "worst_edge_crack") return {edge_crack_term(table)};
    if (kind == "max_stress") return {largest_stress_term(table)};
    if (kind == "misfit") return {misfit_term(table)};
    if (kind == "energy_release_rate" || kind == "stress_intensity") return {tip_term(table, kind)};
    if (kind == "crack_opening") return {crack_opening(crack(table), weight(table))};
    const Index number = crack(table);
    if (!is_unilateral(c.scene.laws[static_cast<std::size_t>(number)])) {
      const Value field = need(table, "crack");
      fail(field.node->position, fmt::format("{}: crack {} has contact = \"open\" and no pressure; contact = "
                                             "\"unilateral\" has",
                                             field.name, quote(text(field))));
    }
    return {crack_pressure(number, scalar(need(table, "target")), weight(table))};
  }
};

}  // namespace

Functional read_functional_table(const Value& table, const std::filesystem::path& folder, Definitions& definitions,
                                 const Case& c, std::vector<std::string>* notes) {
  const Reader reader{folder, definitions, c, notes};
  const std::string kind = read_kind(table);
  Functional functional{.kind = kind, .terms = {}, .sum = kind == "sum"};
  if (kind != "sum") {
    functional.terms = reader.terms(table, kind);
    return functional;
  }
  const Value* measured = nullptr;
  const std::vector<Value> entries = items(need(table, "terms"), 1);
  for (const Value& entry : entries) {
    const std::string part = read_kind(entry);
    if (part == "sum") fail(entry.node->position, entry.name + ": a sum cannot hold a sum; list its terms here");
    if (part == "misfit") {
      if (measured)
        fail(entry.node->position, fmt::format("{}: there is room for one misfit (the other is at {})", entry.name,
                                               to_string(measured->node->position)));
      measured = &entry;
    }
    double factor = 1;
    if (const auto given = find(entry, "factor")) {
      factor = number(*given);
      if (factor == 0) fail(given->node->position, given->name + " is 0; leave the term out");
    }
    for (Term& term : reader.terms(entry, part)) {
      term.factor = factor;
      functional.terms.push_back(std::move(term));
    }
  }
  return functional;
}

namespace {

/// Whether a functional of edge cracks, alone or in a sum, is on that label.
bool names_label(const Value& functional, const std::string& label) {
  if (const auto terms = find(functional, "terms"))
    for (const Value& term : items(*terms))
      if (names_label(term, label)) return true;
  const auto kind = find(functional, "kind"), on = find(functional, "on");
  if (!kind || !on || kind->node->kind != Node::Kind::String || text(*kind) != "worst_edge_crack") return false;
  const std::vector<Value> names = on->node->kind == Node::Kind::Array ? items(*on) : std::vector<Value>{*on};
  return std::ranges::any_of(
      names, [&](const Value& name) { return name.node->kind == Node::Kind::String && text(name) == label; });
}

/// Rims of holes that [optimize] draws have labels, where cracks may begin on them.
void add_drawn_rims(const Value& document, Shape& shape) {
  const auto optimize = find_table(document, "optimize");
  if (!optimize) return;
  std::vector<Value> functionals = find_tables(*optimize, "bound");
  if (const auto own = find_table(document, "functional")) functionals.push_back(*own);
  for (const Value& hole : find_tables(*optimize, "hole")) {
    const auto name = find(hole, "name");
    if (!name || name->node->kind != Node::Kind::String) continue;
    const std::string label = "hole:" + text(*name);
    if (std::ranges::find(shape.labels, label) == shape.labels.end() &&
        std::ranges::any_of(functionals, [&](const Value& f) { return names_label(f, label); }))
      shape.labels.push_back(label);
  }
}

}  // namespace

void read_functional(const Value& document, const std::filesystem::path& folder, Definitions& definitions, Case& c) {
  add_drawn_rims(document, c.shape);
  const auto table = find_table(document, "functional");
  c.functional =
      table ? read_functional_table(*table, folder, definitions, c, &c.file_notes) : Functional{.terms = {energy()}};
}

void leave_out_zones(const std::vector<Loop>& frozen, Case& c) {
  if (find_problem(c.shape)) return;  // which is what the user will hear of
  std::vector<Index> loaded;
  for (const Traction& t : c.scene.tractions) loaded.push_back(t.label);
  if (c.optimize)
    for (const LoadCase& load : c.optimize->load_cases)
      for (const Traction& t : load.tractions) loaded.push_back(t.label);
  const StressedBody body{.shape = c.shape, .supports = c.scene.supports, .loaded = loaded, .frozen = frozen};
  c.functional = with_zones(std::move(c.functional), body);
  if (c.optimize)
    for (FunctionalBound& bound : c.optimize->bounds) bound.functional = with_zones(std::move(bound.functional), body);
}

namespace {

/// All keys `measured` of [functional].
std::vector<Value> all_measured(const Value& document) {
  const auto table = find_table(document, "functional");
  if (!table) return {};
  std::vector<Value> tables = {*table}, out;
  if (const auto terms = find(*table, "terms")) tables = items(*terms);
  for (const Value& part : tables)
    if (const auto measured = find(part, "measured")) out.push_back(*measured);
  return out;
}

}  // namespace

std::optional<Value> synthetic_misfit(const Value& document) {
  for (const Value& measured : all_measured(document))
    if (is_synthetic(measured)) return measured;
  return std::nullopt;
}

Readings read_readings(const Value& document, const std::filesystem::path& folder, const Value& blamed, const Case& c) {
  Readings out;
  for (const Term& term : c.functional.terms)
    if (term.measured) out.label = term.measured->label;
  const std::vector<Value> all = all_measured(document);
  if (all.empty())
    fail(blamed.node->position,
         fmt::format("{} goes with measured displacements: kind = \"misfit\" in [functional]", blamed.name));
  const Value& measured = all.front();
  if (is_synthetic(measured)) return out;
  if (measured.node->kind != Node::Kind::String)
    fail(blamed.node->position, fmt::format("{} needs readings at points: measured = \"file.csv\" (columns "
                                            "x,y,u_x,u_y) or \"synthetic\" in [functional]",
                                            blamed.name));
  for (const std::vector<double>& row : read_table(folder / text(measured), measured, {"x", "y", "u_x", "u_y"})) {
    out.at.emplace_back(row[0], row[1]);
    out.displacement.emplace_back(row[2], row[3]);
  }
  return out;
}

}  // namespace kerf
