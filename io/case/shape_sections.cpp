// The drawn body: [domain] with its outline and the labels of its sides, [[hole]], [[crack]], [[region]], and the
// material of each region. Corners and arcs become loops of sides: side i runs from vertex i to vertex i + 1, straight
// or along the arc that entry i + 1 of the list describes (an arc names where it ends). Labels are numbered in the
// order in which they appear, hole:<name> unless the case gives another; regions that optimize.frozen names and that
// have no material of their own are masks, not regions of the body. A crack with Coulomb friction asks for meshes that
// are mirrored at its tips.

#include "geometry/plane.hpp"
#include "io/case/sections.hpp"
#include "io/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_map>

namespace kerf {

namespace {

Arc read_arc(const Vec2& a, const Vec2& b, const Vec2& given, const Value& field) {
  const double ra = (a - given).norm(), rb = (b - given).norm(), chord = (b - a).norm();
  // Six digits are what a person writes; arc_between takes the exact center from the ends.
  if (!(std::abs(ra - rb) <= 1e-6 * std::max(ra, rb)) || !(ra > 0))
    fail(field.node->position, fmt::format("{}: the center must have the same distance to both ends of the arc, not "
                                           "{:.9g} to ({:.9g}, {:.9g}) and {:.9g} to ({:.9g}, {:.9g})",
                                           field.name, ra, a.x(), a.y(), rb, b.x(), b.y()));
  if (!(chord > 1e-9 * ra))
    fail(field.node->position, fmt::format("{}: the arc begins and ends at the same point; split a full turn into two "
                                           "arcs, or use a [[hole]]",
                                           field.name));
  return arc_between(a, b, given);
}

/// Entry i of an outline is vertex i, or an arc that arrives at vertex i from vertex i - 1 (cyclic): an arc at entry
/// i + 1 makes edge i an arc, and a first entry that is an arc makes the last edge one. The sides have no labels yet.
Loop read_outline(const Value& outline, const std::string& name) {
  std::vector<Vec2> vertices;
  std::vector<std::optional<Vec2>> center;  // of the edge that arrives at the vertex
  const std::vector<Value> entries = items(outline);
  const bool curved = std::any_of(entries.begin(), entries.end(),
                                  [](const Value& entry) { return entry.node->kind == Node::Kind::Table; });
  if (entries.size() < (curved ? 2u : 3u))
    fail(outline.node->position, fmt::format("{} has {} {}; a body needs at least 3, or 2 with an arc", outline.name,
                                             entries.size(), entries.size() == 1 ? "vertex" : "vertices"));
  for (const Value& entry : entries) {
    if (entry.node->kind == Node::Kind::Table) {
      allow_only(entry);
      vertices.push_back(point(need(entry, "arc_to")));
      center.emplace_back(point(need(entry, "center")));
    } else {
      vertices.push_back(point(entry));
      center.emplace_back();
    }
  }
  if (center.back() && !center.front() && (vertices.back() - vertices.front()).norm() <= 1e-9 * vertices.back().norm())
    fail(entries.back().node->position,
         fmt::format("{} ends with an arc to its first point, which it has already; begin the outline with this arc "
                     "instead of that point: a first entry that is an arc comes from the last one",
                     outline.name));
  Loop loop{name, {}};
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const std::size_t next = (i + 1) % vertices.size();
    Side side{vertices[i], none, std::nullopt};
    if (center[next]) side.arc = read_arc(vertices[i], vertices[next], *center[next], entries[next]);
    loop.sides.push_back(std::move(side));
  }
  return loop;
}

/// The labels of a shape, found by their names.
class Labels {
 public:
  explicit Labels(Shape& shape) : shape_(shape) {
    for (std::size_t i = 0; i < shape.labels.size(); ++i) number_.emplace(shape.labels[i], static_cast<Index>(i));
  }
  Index number(const std::string& label) {
    const auto [known, is_new] = number_.emplace(label, static_cast<Index>(shape_.labels.size()));
    if (is_new) shape_.labels.push_back(label);
    return known->second;
  }

 private:
  Shape& shape_;
  std::unordered_map<std::string, Index> number_;
};

/// That of a hole, which another loop may have in part, or a name.
Index label_of(const Value& field, Labels& known) {
  constexpr std::string_view hole = "hole:";
  const std::string label = text(field);
  const bool of_hole = label.starts_with(hole) && is_safe_name(label.substr(hole.size()));
  return known.number(of_hole ? label : safe_name(field));
}

/// A label per side.
void read_sides(const Value& sides, Loop& loop, Labels& known) {
  const std::vector<Value> labels = items(sides);
  if (labels.size() != loop.sides.size())
    fail(sides.node->position, fmt::format("{} has {} labels for the {} edges of the outline; give one per edge",
                                           sides.name, labels.size(), loop.sides.size()));
  for (std::size_t i = 0; i < labels.size(); ++i) loop.sides[i].label = label_of(labels[i], known);
}

void read_domain(const Value& domain, Shape& shape) {
  shape.outline = read_outline(need(domain, "outline"), "outline");
  Labels known(shape);
  read_sides(need(domain, "sides"), shape.outline, known);
}

/// The entries of `frozen` in [optimize].
std::vector<Value> frozen_names(const Value& document) {
  const auto optimize = find_table(document, "optimize");
  const auto frozen = optimize ? find(*optimize, "frozen") : std::nullopt;
  return frozen ? items(*frozen, 1) : std::vector<Value>{};
}

bool is_drawn(const Value& region) {
  return find(region, "circle") || find(region, "ellipse") || find(region, "polygon") || find(region, "outline");
}

bool has_material(const Value& region) {
  return find(region, "young") || find(region, "poisson") || find(region, "eigenstrain");
}

/// One that has an eigenstrain may be made of what the body is made of.
Elastic read_elastic(const Value& region, const Elastic& body) {
  if (find(region, "eigenstrain") && !find(region, "young") && !find(region, "poisson")) return body;
  return read_elastic(region);
}

/// Regions of a file, in their order: with the material of the [[region]] of their surface, or that of the body.
void add_regions_of_file(const std::vector<Value>& tables, const MeshFile& file, Case& c, ReadRegions& read) {
  std::vector<Value> named;
  for (const Value& region : tables)
    if (!is_drawn(region)) named.push_back(region);
  for (const Index m : file.material) {
    if (m == none) {
      c.regions.push_back({c.young, c.poisson, c.orthotropy});
      c.scene.regions.push_back(c.scene.material);
      read.tables.emplace_back();
      continue;
    }
    const Value& region = named[static_cast<std::size_t>(m)];
    const Elastic e = read_elastic(region, {c.young, c.poisson, c.orthotropy});
    read.tables.emplace_back(region);
    c.regions.push_back(e);
    c.scene.regions.push_back(elastic(region, e, c.plane_strain));
  }
}

bool lies_before(const Vec2& a, const Vec2& b) {
  return std::pair(a.x(), a.y()) < std::pair(b.x(), b.y());
}

}  // namespace

bool begins_before(const Loop& a, const Loop& b) {
  return lies_before(a.sides.front().start, b.sides.front().start);
}

namespace {

bool begins_before(const Crack& a, const Crack& b) {
  return std::ranges::lexicographical_compare(a.points, b.points, lies_before);
}

}  // namespace

Loop read_loop(const Value& hole, const std::string& name, Index label) {
  const std::string kind = one_of(hole);
  const Value form = need(hole, kind);
  if (kind == "circle") {
    allow_only(form);
    return circle(name, point(need(form, "center")), in_range(need(form, "radius")), label);
  }
  if (kind == "ellipse") {
    allow_only(form);
    const std::vector<Value> axes = pair(need(form, "semi_axes"));
    const auto angle = find(form, "angle_deg");
    return ellipse(name, point(need(form, "center")), {in_range(axes[0]), in_range(axes[1])},
                   (angle ? number(*angle) : 0.0) * pi / 180, label);
  }
  if (kind == "polygon") return polygon(name, points(form, 3), label);
  Loop loop = read_outline(form, name);
  for (Side& side : loop.sides) side.label = label;
  return loop;
}

namespace {

Crack read_path(const Value& crack, const std::string& name) {
  if (one_of(crack) == "path") return {name, points(need(crack, "path"), 2), {}};
  const Value form = need(crack, "arc");
  allow_only(form);
  const double from = number(need(form, "from_deg")), to = number(need(form, "to_deg"));
  if (from == to || std::abs(to - from) >= 360)
    fail(form.node->position,
         fmt::format("{} runs from {:g} to {:g} degrees; an arc turns by more than 0 and less than 360", form.name,
                     from, to));
  return arc_crack(name, point(need(form, "center")), in_range(need(form, "radius")), from * pi / 180, to * pi / 180);
}

/// Tables of regions, each with its loop.
void sort_by_place(std::vector<Value>& tables) {
  std::vector<std::pair<Loop, Value>> drawn;
  for (const Value& table : tables) drawn.emplace_back(read_loop(table, "", none), table);
  std::ranges::stable_sort(drawn, [](const auto& a, const auto& b) { return begins_before(a.first, b.first); });
  for (std::size_t i = 0; i < tables.size(); ++i) tables[i] = drawn[i].second;
}

}  // namespace

std::optional<MeshFile> read_shape(const Value& document, const std::filesystem::path& folder, Case& c) {
  need(document, "domain");
  const Value domain = *find_table(document, "domain");
  const std::string kind = one_of(domain);
  allow_only(domain, kind);
  std::optional<MeshFile> file;
  std::vector<Value> holes = find_tables(document, "hole"), cracks = find_tables(document, "crack");
  if (kind == "file") {
    file = read_body_file(document, domain, folder, c);
    cracks = read_laws_of_file(cracks, c);
    if (c.mesh && !holes.empty())
      fail(holes.front().node->position, "[[hole]]: the mesh of domain.file is taken as it is; mesh the hole there");
  } else {
    read_domain(domain, c.shape);
  }
  add_holes(holes, c.shape);
  add_cracks(cracks, c.shape, c.scene.laws);
  for (const Value& crack : cracks) c.crack_names.push_back(text(need(crack, "name")));
  for (const CrackLaw& law : c.scene.laws)
    if (has_friction(law) && law.friction > 0) c.sizing.mirrored_tips = true;
  return file;
}

bool is_frozen(const Value& document, const std::string& name) {
  const std::vector<Value> wanted = frozen_names(document);
  return std::any_of(wanted.begin(), wanted.end(), [&](const Value& field) { return text(field) == name; });
}

CrackLaw read_law(const Value& crack) {
  CrackLaw law;
  take(crack, "contact", law.kind);
  for (const auto& [key, value] : {std::pair{"friction", &law.friction}, std::pair{"tresca", &law.slip_bound}})
    if (const auto given = find(crack, key)) {
      *value = number(*given);
      if (*value < 0) fail(given->node->position, given->name + " must not be negative");
      if (*value > 0 && !is_unilateral(law))
        fail(given->node->position,
             fmt::format("{} needs contact = \"unilateral\", not \"{}\"", given->name, word(law.kind)));
    }
  return law;
}

void add_holes(const std::vector<Value>& tables, Shape& shape) {
  const Index before = std::ssize(shape.holes);
  Labels known(shape);
  for (const Value& hole : tables) {
    allow_only(hole);
    const std::string name = new_name(need(hole, "name"), shape.holes);
    const auto sides = find(hole, "sides");
    if (!sides) {
      shape.holes.push_back(read_loop(hole, name, known.number("hole:" + name)));
      continue;
    }
    Loop loop = read_loop(hole, name, none);
    if (sides->node->kind == Node::Kind::Array) {
      read_sides(*sides, loop, known);
    } else {
      const Index label = label_of(*sides, known);
      for (Side& side : loop.sides) side.label = label;
    }
    shape.holes.push_back(std::move(loop));
  }
  std::stable_sort(shape.holes.begin() + before, shape.holes.end(),
                   [](const Loop& a, const Loop& b) { return begins_before(a, b); });
}

std::function<Vec2(const Vec2& x)> normal_of(const Crack& crack) {
  if (!crack.arc) return {};
  const Mat2& axes = crack.arc->axes;
  const Mat2 inverse = axes.inverse();
  if ((axes.transpose() * axes - axes.col(0).squaredNorm() * Mat2::Identity()).norm() <= 1e-9 * axes.squaredNorm())
    return [center = crack.arc->center](const Vec2& x) { return (x - center).normalized().eval(); };
  // Of an ellipse: the gradient of |axes^-1 (x - center)|^2.
  return [center = crack.arc->center, inverse](const Vec2& x) -> Vec2 {
    return (inverse.transpose() * (inverse * (x - center))).normalized();
  };
}

void add_cracks(const std::vector<Value>& tables, Shape& shape, std::vector<CrackLaw>& laws) {
  std::vector<std::pair<Crack, CrackLaw>> read;
  std::set<std::string> names;
  for (const Value& crack : tables) {
    allow_only(crack);
    const std::string name = new_name(need(crack, "name"), shape.cracks);
    if (!names.insert(name).second) refuse_taken(need(crack, "name"), name);
    CrackLaw crack_law = read_law(crack);
    Crack path = read_path(crack, name);
    crack_law.normal = normal_of(path);
    read.emplace_back(std::move(path), std::move(crack_law));
  }
  std::ranges::stable_sort(read, [](const auto& a, const auto& b) { return begins_before(a.first, b.first); });
  for (auto& [crack, law] : read) {
    shape.cracks.push_back(std::move(crack));
    laws.push_back(std::move(law));
  }
}

std::vector<Elastic> add_regions(const std::vector<Value>& tables, const BodyMaterial& body, Shape& shape,
                                 std::vector<Material>& materials) {
  std::vector<Elastic> elastics;
  for (const Value& region : tables) {
    allow_only(region);
    const std::string name = new_name(need(region, "name"), shape.regions);
    shape.regions.push_back(read_loop(region, name, none));
    const Elastic e = read_elastic(region, body.elastic);
    elastics.push_back(e);
    materials.push_back(elastic(region, e, body.plane_strain));
  }
  return elastics;
}

ReadRegions read_regions(const Value& document, const std::optional<MeshFile>& file, Case& c) {
  std::vector<Value> materials;
  std::vector<std::string> names;
  ReadRegions read;
  std::vector<Loop>& frozen = read.frozen;
  const std::vector<Value> tables = find_tables(document, "region"), wanted = frozen_names(document);
  for (const Value& region : tables) {
    allow_only(region);
    const Value field = need(region, "name");
    const std::string name = safe_name(field);
    if (std::find(names.begin(), names.end(), name) != names.end()) refuse_taken(field, name);
    names.push_back(name);
    const bool mask = is_frozen(document, name);
    if (file && !is_drawn(region)) {
      for (const Loop& loop : file->masks)
        if (mask && loop.name == name) frozen.push_back(loop);
      continue;
    }
    if (mask) frozen.push_back(read_loop(region, name, none));
    if (!mask || has_material(region)) materials.push_back(region);
  }
  for (const Value& field : wanted)
    if (std::find(names.begin(), names.end(), text(field)) == names.end())
      fail(field.node->position, fmt::format("{}: there is no [[region]] {}; {}", field.name, quote(text(field)),
                                             names.empty() ? "the case has none" : suggest(text(field), names)));
  if (file) add_regions_of_file(tables, *file, c, read);
  sort_by_place(materials);
  const BodyMaterial body{{c.young, c.poisson, c.orthotropy}, c.plane_strain};
  for (const Elastic& e : add_regions(materials, body, c.shape, c.scene.regions)) c.regions.push_back(e);
  read.tables.insert(read.tables.end(), materials.begin(), materials.end());
  return read;
}

}  // namespace kerf
