// The case with one table more, read again: the scene of a body with a hole, an inclusion, an ellipse or a crack drawn
// at a place, for validations at finite radii. Its labels and cracks are put in the order of the case without the
// change, so that both scenes fit meshes whose labels have the old numbers. An ellipse of aspect a at radius r has the
// semi-axes r sqrt(a) and r / sqrt(a), the area of the circle. Bodies from files cannot be drawn again: no scenes.
// docs/theory/validation.md, "The bodies are drawn by the user's tables".

#include "io/drawn_change.hpp"
#include "io/document.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr const char* drawn_name = "kerf-validation-change";

Node drawn_number(double x) {
  return {.kind = Node::Kind::Float, .number = x};
}
Node drawn_text(std::string s) {
  return {.kind = Node::Kind::String, .text = std::move(s)};
}
Node drawn_list(std::vector<Node> items) {
  return {.kind = Node::Kind::Array, .items = std::move(items)};
}
Node drawn_point(const Vec2& x) {
  return drawn_list({drawn_number(x.x()), drawn_number(x.y())});
}
Node drawn_table(std::vector<std::pair<std::string, Node>> entries) {
  Node table{.kind = Node::Kind::Table};
  for (auto& [key, value] : entries) table.entries.push_back({key, {}, std::move(value)});
  return table;
}

const Node* entry(const Node& table, const std::string& key) {
  const auto found = std::ranges::find(table.entries, key, &Entry::key);
  return found == table.entries.end() ? nullptr : &found->value;
}

// [[key]] once more at the end of the document.
void append(Node& document, const std::string& key, Node table) {
  const auto found = std::ranges::find(document.entries, key, &Entry::key);
  if (found == document.entries.end())
    document.entries.push_back({key, {}, drawn_list({std::move(table)})});
  else
    found->value.items.push_back(std::move(table));
}

// The table that the region of the scene comes from, or [material].
const Node* table_of(const Case& c, Index region) {
  if (region == none) return entry(*c.document, "material");
  const std::string& name = c.shape.regions[static_cast<std::size_t>(region)].name;
  if (const Node* regions = entry(*c.document, "region"))
    for (const Node& table : regions->items)
      if (const Node* own = entry(table, "name"); own && own->text == name) return &table;
  return nullptr;
}

Node round_region(const Case& c, const DrawnChangeAt& at) {
  Node region =
      drawn_table({{"name", drawn_text(drawn_name)},
                   {"circle", drawn_table({{"center", drawn_point(at.center)}, {"radius", drawn_number(at.radius)}})}});
  const Node& made_of = *entry(*entry(*c.document, "map"), "perturbation");
  region.entries.insert(region.entries.end(), made_of.entries.begin(), made_of.entries.end());
  if (const Node* around = table_of(c, at.region))
    if (const Node* strain = entry(*around, "eigenstrain")) region.entries.push_back({"eigenstrain", {}, *strain});
  return region;
}

Node with_table(const Case& c, const Perturbation& p, const DrawnChangeAt& at) {
  Node document = *c.document;
  using Kind = Perturbation::Kind;
  switch (p.kind) {
    case Kind::Inclusion:
      append(document, "region", round_region(c, at));
      break;
    case Kind::Crack: {
      const Vec2 half = at.radius * Vec2(std::cos(at.angle), std::sin(at.angle));
      append(document, "crack",
             drawn_table({{"name", drawn_text(drawn_name)},
                          {"path", drawn_list({drawn_point(at.center - half), drawn_point(at.center + half)})}}));
      break;
    }
    case Kind::Ellipse: {
      const double longer = std::sqrt(p.aspect);
      append(document, "hole",
             drawn_table({{"name", drawn_text(drawn_name)},
                          {"ellipse", drawn_table({{"center", drawn_point(at.center)},
                                                   {"semi_axes", drawn_point(at.radius * Vec2(longer, 1 / longer))},
                                                   {"angle_deg", drawn_number(at.angle * 180 / pi)}})}}));
      break;
    }
    case Kind::Hole:
    case Kind::ClampedHole:
      append(document, "hole",
             drawn_table(
                 {{"name", drawn_text(drawn_name)},
                  {"circle", drawn_table({{"center", drawn_point(at.center)}, {"radius", drawn_number(at.radius)}})}}));
      if (p.kind == Kind::ClampedHole)
        append(document, "boundary",
               drawn_table({{"on", drawn_text(std::string("hole:") + drawn_name)},
                            {"displacement", drawn_point(Vec2::Zero())}}));
  }
  return document;
}

// The scene of the case with the table, in the numbers of the one without it.
Scene renumbered(const Case& c, const Case& with) {
  Scene scene = loaded_scene(with);
  const std::vector<std::string>& labels = c.shape.labels;
  const auto number = [&](Index label) {
    return static_cast<Index>(std::ranges::find(labels, with.shape.labels[static_cast<std::size_t>(label)]) -
                              labels.begin());
  };
  for (Support& s : scene.supports) s.label = number(s.label);
  for (Traction& t : scene.tractions) t.label = number(t.label);
  const auto place = [&](const Crack& crack) {
    return std::ranges::find(c.shape.cracks, crack.name, &Crack::name) - c.shape.cracks.begin();
  };
  std::vector<CrackLaw> laws(scene.laws.size());
  for (std::size_t k = 0; k < laws.size(); ++k)
    laws[static_cast<std::size_t>(place(with.shape.cracks[k]))] = scene.laws[k];
  scene.laws = std::move(laws);
  return scene;
}

}  // namespace

ScenesOfChanges scenes_of_changes(const Case& c) {
  if (c.mesh || entry(*entry(*c.document, "domain"), "file")) return {};
  return [&c](const Perturbation& p, const DrawnChangeAt& at) {
    return renumbered(c, read_case(with_table(c, p, at), {c.name, c.folder, place_of(c, "")}));
  };
}

}  // namespace kerf
