// [[interface]]: where two regions of a drawn body meet, as cracks in contact. The border of the two is found by the
// geometry (seams), and may consist of several curves, which become cracks name, name.2, ...; their faces are those of
// the two regions. "body" stands for what lies outside all regions. A bonded interface (contact = false) is a crack
// without faces: edges of the mesh lie along it, and nothing jumps. docs/theory/contact.md, "Borders of regions".

#include "io/case/interfaces.hpp"

#include "geometry/interfaces.hpp"
#include "io/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace kerf {

namespace {

constexpr std::string_view rest_of_body = "body";  // in `between`, and of meshes that are written

/// The region that an entry of `between` names, or none for the rest of the body.
Index region_named(const Value& field, const Shape& shape) {
  const std::string wanted = text(field);
  const auto found = std::ranges::find(shape.regions, wanted, &Loop::name);
  if (wanted == rest_of_body) {
    if (found != shape.regions.end())
      fail(field.node->position, fmt::format("{}: \"body\" is what lies outside all regions, and a [[region]] has that "
                                             "name, too; give the region another one",
                                             field.name));
    return none;
  }
  if (found != shape.regions.end()) return Index(found - shape.regions.begin());
  std::vector<std::string> names{std::string(rest_of_body)};
  for (const Loop& region : shape.regions) names.push_back(region.name);
  fail(field.node->position, fmt::format("{}: there is no [[region]] {}; {}", field.name, quote(wanted),
                                         shape.regions.empty() ? "the case has none" : suggest(wanted, names)));
}

std::string name_of(const Shape& shape, Index region) {
  return quote(region == none ? rest_of_body : std::string_view(shape.regions[std::size_t(region)].name));
}

/// A region first.
std::array<Index, 2> read_between(const Value& field, const Shape& shape) {
  const std::vector<Value> names = items(field);
  if (names.size() != 2)
    fail(field.node->position, fmt::format("{} has {} entries; an interface lies between two regions, or a region and "
                                           "\"body\"",
                                           field.name, names.size()));
  std::array<Index, 2> both{region_named(names[0], shape), region_named(names[1], shape)};
  if (both[0] == both[1])
    fail(field.node->position,
         fmt::format("{} names {} twice; an interface lies between two", field.name, name_of(shape, both[0])));
  if (both[0] == none) std::swap(both[0], both[1]);
  return both;
}

/// Interfaces so far.
using Known = std::vector<std::pair<std::array<Index, 2>, std::string>>;

void refuse_second(const Value& field, const std::array<Index, 2>& both, const Shape& shape, const Known& known) {
  for (const auto& [between, name] : known)
    if (between == both || between == std::array{both[1], both[0]})
      fail(field.node->position,
           fmt::format("{}: interface {} lies between {} and {} already; keep one of them", field.name, quote(name),
                       name_of(shape, both[0]), name_of(shape, both[1])));
}

[[noreturn]] void refuse_apart(const Value& field, const std::array<Index, 2>& both, const Shape& shape) {
  std::vector<std::string> met;
  for (Index other = none; other < Index(shape.regions.size()); ++other)
    if (other != both[0] && !seams(shape, both[0], other).empty()) met.push_back(name_of(shape, other));
  fail(field.node->position,
       fmt::format("{}: {} and {} have no border in common inside the body; {} meets {}", field.name,
                   name_of(shape, both[0]), name_of(shape, both[1]), name_of(shape, both[0]),
                   met.empty() ? std::string("nothing else") : fmt::format("{}", fmt::join(met, ", "))));
}

CrackLaw read_interface_law(const Value& table) {
  CrackLaw law;
  bool contact = true;
  take(table, "contact", contact);
  if (!contact) law.kind = CrackLaw::Kind::Bonded;
  if (const auto friction = find(table, "friction")) {
    law.friction = in_range(*friction);
    if (law.friction > 0 && !contact)
      fail(friction->node->position,
           fmt::format("{} needs contact = true: a bonded interface does not slide", friction->name));
  }
  if (const auto gap = find(table, "gap"); gap && !contact)
    fail(gap->node->position,
         fmt::format("{} needs contact = true: the faces of a bonded interface are one", gap->name));
  return law;
}

/// The name itself for a single curve; with numbers for more.
std::vector<std::string> region_names(const Value& field, std::size_t parts, const Shape& shape) {
  std::vector<std::string> names{new_name(field, shape.cracks)};
  for (std::size_t k = 2; k <= parts; ++k) names.push_back(fmt::format("{}.{}", names[0], k));
  for (const std::string& name : names)
    if (std::ranges::find(shape.cracks, name, &Crack::name) != shape.cracks.end()) refuse_taken(field, name);
  return names;
}

}  // namespace

std::vector<Value> interface_tables(const Value& document) {
  std::vector<Value> tables = find_tables(document, "interface");
  std::ranges::stable_sort(tables, {}, [](const Value& table) { return text(need(table, "name")); });
  return tables;
}

void read_interfaces(const Value& document, Case& c) {
  const std::vector<Value> tables = find_tables(document, "interface");
  if (tables.empty()) return;
  if (find(*find_table(document, "domain"), "file"))
    fail(tables.front().node->position,
         "[[interface]] goes with a body that is drawn in the case; in a file name the curve between the two surfaces "
         "crack:<name>, and give it a [[crack]]");
  const Shape shape = c.shape;
  Known known;
  std::map<std::string, std::vector<std::pair<Crack, CrackLaw>>> runs;
  for (const Value& table : tables) {
    allow_only(table);
    const Value name = need(table, "name"), between = need(table, "between");
    const std::array<Index, 2> both = read_between(between, shape);
    refuse_second(between, both, shape, known);
    known.emplace_back(both, text(name));
    const CrackLaw law = read_interface_law(table);
    std::vector<Crack> parts = seams(shape, both[0], both[1]);
    if (parts.empty()) refuse_apart(between, both, shape);
    const std::vector<std::string> names = region_names(name, parts.size(), c.shape);
    for (std::size_t k = 0; k < parts.size(); ++k) {
      parts[k].name = names[k];
      c.shape.cracks.push_back(parts[k]);
      runs[names[0]].emplace_back(parts[k], law).second.normal = normal_of(parts[k]);
    }
    if (law.friction > 0) c.sizing.mirrored_tips = true;
  }
  c.shape.cracks.resize(shape.cracks.size());
  for (auto& [name, run] : runs)
    for (auto& [crack, law] : run) {
      c.shape.cracks.push_back(std::move(crack));
      c.scene.laws.push_back(std::move(law));
    }
}

}  // namespace kerf
