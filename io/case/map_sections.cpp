// [map], [inspect] and [validate]: the change that the topological derivative is taken for (a hole, a clamped hole, an
// inclusion, an ellipse of an aspect, a crack), the points or the whole body, and the radii of validations, sorted from
// the largest on. Radii are r_k = largest ratio^k where a table says so. The radius of the map itself is map.radius, or
// the smallest of the validation, or 0.005 of the extent. docs/theory/topological_derivatives.md,
// docs/theory/validation.md.

#include "io/case/sections.hpp"
#include "io/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace kerf {

namespace {

const char* const perturbations =
    "\"hole\", \"clamped_hole\", \"crack\", { young = ..., poisson = ... } or { aspect = ... }";

// What a hole or an inclusion could carry, and the derivatives do not know.
void refuse_loads(const Value& field) {
  for (const auto& [key, why] :
       {std::pair{"eigenstrain", "an inclusion has the eigenstrain of its place, none of its own"},
        std::pair{"pressure", "the rim of a hole is free of loads"}})
    if (const auto given = find(field, key))
      fail(given->node->position, fmt::format("{}: {}; it may be {}", field.name, why, perturbations));
}

Perturbation read_perturbation(const Value& field, const Case& c) {
  using Kind = Perturbation::Kind;
  Perturbation p;
  if (field.node->kind == Node::Kind::Table) {
    refuse_loads(field);
    allow_only(field);
    const std::string kind = one_of(field);
    allow_only(field, kind);
    if (kind == "aspect") {
      p.kind = Kind::Ellipse;
      p.aspect = in_range(need(field, "aspect"));
      return p;
    }
    p.kind = Kind::Inclusion;
    const double young = in_range(need(field, "young"));
    p.inclusion = elastic(field, {young, in_range(need(field, "poisson"))}, c.plane_strain);
    return p;
  }
  if (field.node->kind != Node::Kind::String)
    fail(field.node->position, fmt::format("{} must be {}", field.name, perturbations));
  p.kind = perturbation_kind(choice(field));
  return p;
}

/// A radius of what is put into the body.
double radius(const Value& field, const Case& c) {
  const double value = positive(field);
  const double size = extent(c.shape);
  if (!(value < size))
    fail(field.node->position,
         fmt::format("{} = {:g} must be smaller than the body, whose diagonal is {:g}", field.name, value, size));
  return value;
}

std::vector<double> read_radii(const Value& field, const Case& c) {
  std::vector<double> radii;
  if (field.node->kind == Node::Kind::Table) {
    allow_only(field);
    const double largest = radius(need(field, "largest"), c);
    const Value share = need(field, "ratio"), many = need(field, "count");
    const double ratio = number(share);
    if (!(ratio > 0 && ratio < 1))
      fail(share.node->position, fmt::format("{} must lie between 0 and 1, not {:g}", share.name, ratio));
    const int count = whole_number(many);
    for (int k = 0; k < count; ++k) radii.push_back(largest * std::pow(ratio, k));
    constexpr double least = 1e-9;  // of the extent; no mesh has shorter edges
    if (!(radii.back() > least * extent(c.shape)))
      fail(
          many.node->position,
          fmt::format("{}: the last of {} radii is {:.3g}, too small to mesh; choose a smaller count or a larger ratio",
                      many.name, count, radii.back()));
    return radii;
  }
  if (field.node->kind != Node::Kind::Array)
    fail(field.node->position, field.name + " must be a list of radii or { largest = ..., ratio = ..., count = ... }");
  for (const Value& item : items(field, 1)) {
    radii.push_back(radius(item, c));
    if (std::count(radii.begin(), radii.end(), radii.back()) > 1)
      fail(item.node->position, fmt::format("{}: the radius {:g} appears twice", item.name, radii.back()));
  }
  std::sort(radii.begin(), radii.end(), std::greater<>());
  return radii;
}

/// [map] of edge cracks.
void read_edge_cracks(const Value& map, Case& c) {
  for (const char* key : {"bounds", "second", "radius"})
    if (const auto given = find(map, key))
      fail(given->node->position,
           fmt::format("{} is not for perturbation = \"edge_crack\", whose size is length", given->name));
  inspect::EdgeCrackRequest& to = c.edge_cracks.emplace();
  to.length = radius(need(map, "length"), c);
  if (const auto angle = find(map, "angle"); angle && angle->node->kind == Node::Kind::String) {
    if (text(*angle) != "worst")
      fail(angle->node->position, fmt::format("{} is \"worst\" or degrees, not {}", angle->name, quote(text(*angle))));
  } else if (angle) {
    to.angle = in_range(*angle) * pi / 180;
  }
  take(map, "friction", to.friction);
  take(map, "pressurized", to.pressurized);
  if (const auto at = find(map, "points")) to.points = points(*at, 1);
}

void read_inspect(const Value& document, Case& c) {
  const auto table = find_table(document, "inspect");
  if (!table) return;
  allow_only(*table);
  if (!c.edge_cracks)
    fail(table->node->position,
         "[inspect] goes with perturbation = \"edge_crack\" in [map], whose length is that of "
         "the crack that an inspection misses");
  growth::GrowRequest law;
  read_growth_law(need(*table, "law"), law);
  inspect::ToleranceRequest& to = c.tolerance.emplace();
  to.toughness = law.toughness;
  to.law = law.law;
  if (const auto cycle = find(*table, "cycle")) {
    allow_only(*cycle);
    take(*cycle, "max", to.max);
    take(*cycle, "min", to.min);
    if (!(to.min < to.max)) fail(cycle->node->position, cycle->name + ": min must be below max");
  }
  take(*table, "factor", to.factor);
}

}  // namespace

void read_map(const Value& document, Case& c) {
  double default_radius = 0.005 * extent(c.shape);
  const auto map = find_table(document, "map"), validate = find_table(document, "validate");
  if (map) allow_only(*map);
  const auto given = map ? find(*map, "perturbation") : std::nullopt;
  if (given && given->node->kind == Node::Kind::String && text(*given) == "edge_crack") {
    read_edge_cracks(*map, c);
  } else if (map) {
    for (const char* key : {"length", "angle", "friction", "pressurized"})
      if (const auto of_edges = find(*map, key))
        fail(of_edges->node->position, of_edges->name + " goes with perturbation = \"edge_crack\"");
    if (given) c.map_request.perturbation = read_perturbation(*given, c);
    c.map.emplace();
    if (const auto at = find(*map, "points")) {
      if (at->node->kind == Node::Kind::Array && at->node->items.empty())
        fail(at->node->position, at->name + " is empty; leave it out for a map everywhere in the body");
      c.map->points = points(*at, 1);
    }
    take(*map, "bounds", c.map_request.bounds);
    take(*map, "second", c.map_request.second);
    if (const auto given = find(*map, "radius")) c.map_request.radius = radius(*given, c);
  }
  read_inspect(document, c);
  if (validate && c.edge_cracks) {
    allow_only(*validate);
    if (const auto at = find(*validate, "points")) c.drawn_at = points(*at, 1);
    c.drawn_lengths = read_radii(need(*validate, "radii"), c);
  } else if (validate) {
    allow_only(*validate);
    c.validate.emplace();
    if (const auto at = find(*validate, "points"))
      for (const Value& item : items(*at, 1)) {
        c.validate->points.push_back(point(item));
        if (std::count(c.validate->points.begin(), c.validate->points.end(), c.validate->points.back()) > 1)
          fail(item.node->position, item.name + " appears twice");
      }
    c.validate->radii = read_radii(need(*validate, "radii"), c);
    c.validate->perturbation = c.map_request.perturbation;
    default_radius = c.validate->radii.back();
  }
  if (c.map_request.radius == 0) c.map_request.radius = default_radius;
}

}  // namespace kerf
