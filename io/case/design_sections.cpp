// [[optimize.hole]], [[optimize.crack]], [[optimize.region]]: what is drawn in a design, as vectors of variables with a
// box [low, high] each and a start, the middle of the box unless `start` says otherwise. A number in the place of a box
// fixes the variable (low = high). The order of the variables of each kind is
//   circle: x, y, r;  ellipse: x, y, a, b, angle (radians);  spline: x_1, y_1, ..., x_n, y_n, counter-clockwise;
//   crack: the same of its points;  region: x, y, r, Young's modulus.
// With start = "map" the topological derivative says where the design begins; the start made up here (a circle in the
// boxes, a straight path) then only has to be a valid shape.

#include "io/case/sections.hpp"
#include "io/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

/// The variables of one drawn thing, as they are read.
struct Boxes {
  std::vector<double> lower, upper, start;
};

/// [low, high], or a number: fixed. Not below `least`.
void add_box(const Value& field, double least, Boxes& boxes) {
  const auto check = [&](const Value& value) {
    const double x = number(value);
    if (!(x > least))
      fail(value.node->position, fmt::format("{} must be larger than {:g}, not {:g}", value.name, least, x));
    return x;
  };
  if (field.node->kind == Node::Kind::Array) {
    const std::vector<Value> ends = items(field);
    if (ends.size() != 2)
      fail(field.node->position, fmt::format("{} must be a number, which fixes it, or a box [low, high]", field.name));
    boxes.lower.push_back(check(ends[0]));
    boxes.upper.push_back(check(ends[1]));
    if (!(boxes.lower.back() <= boxes.upper.back()))
      fail(field.node->position, fmt::format("{}: the lower end {:g} of the box is above the upper end {:g}; swap them",
                                             field.name, boxes.lower.back(), boxes.upper.back()));
  } else {
    boxes.lower.push_back(check(field));
    boxes.upper.push_back(boxes.lower.back());
  }
  boxes.start.push_back(boxes.lower.back() + 0.5 * (boxes.upper.back() - boxes.lower.back()));
}

constexpr double anything = -infinity;

/// [x, y], each a number or a box.
void add_place(const Value& field, Boxes& boxes) {
  for (const Value& item : pair(field)) add_box(item, anything, boxes);
}

/// Variable k begins at the value of a field.
void begin_at(const Value& field, double value, std::size_t k, Boxes& boxes, double unit = 1) {
  if (!(value >= boxes.lower[k] && value <= boxes.upper[k]))
    fail(field.node->position, fmt::format("{} = {:g} lies outside its box [{:g}, {:g}]", field.name, value / unit,
                                           boxes.lower[k] / unit, boxes.upper[k] / unit));
  boxes.start[k] = value;
}

void begin_at_place(const Value& field, std::size_t k, Boxes& boxes) {
  const std::vector<Value> xy = pair(field);
  for (std::size_t d = 0; d < 2; ++d) begin_at(xy[d], number(xy[d]), k + d, boxes);
}

Boxes read_circle(const Value& form, const std::optional<Value>& start) {
  allow_only(form);
  Boxes boxes;
  add_place(need(form, "center"), boxes);
  add_box(need(form, "radius"), 0, boxes);
  if (!start) return boxes;
  if (const auto center = find(*start, "center")) begin_at_place(*center, 0, boxes);
  if (const auto radius = find(*start, "radius")) begin_at(*radius, number(*radius), 2, boxes);
  return boxes;
}

Boxes read_ellipse(const Value& form, const std::optional<Value>& start) {
  allow_only(form);
  Boxes boxes;
  add_place(need(form, "center"), boxes);
  for (const Value& axis : pair(need(form, "semi_axes"))) add_box(axis, 0, boxes);
  if (const auto angle = find(form, "angle_deg")) {
    add_box(*angle, anything, boxes);
    for (auto* values : {&boxes.lower, &boxes.upper, &boxes.start}) values->back() *= pi / 180;
  } else {
    for (auto* values : {&boxes.lower, &boxes.upper, &boxes.start}) values->push_back(0);
  }
  if (!start) return boxes;
  allow_only(*start, "ellipse");
  if (const auto center = find(*start, "center")) begin_at_place(*center, 0, boxes);
  if (const auto axes = find(*start, "semi_axes")) begin_at_place(*axes, 2, boxes);
  if (const auto angle = find(*start, "angle_deg")) begin_at(*angle, number(*angle) * pi / 180, 4, boxes, pi / 180);
  return boxes;
}

double signed_area(const std::vector<double>& xy) {
  double twice = 0;
  const std::size_t n = xy.size() / 2;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t j = (i + 1) % n;
    twice += xy[2 * i] * xy[2 * j + 1] - xy[2 * j] * xy[2 * i + 1];
  }
  return 0.5 * twice;
}

/// The table `start` of a hole, a crack or a region. "map": none, and the start is to be read off the topological
/// derivative.
std::optional<Value> read_start_of_crack(const Value& table, bool& from_map) {
  const auto start = find(table, "start");
  // What is counted is begun from the map in every number.
  from_map = (start && start->node->kind == Node::Kind::String) || find(table, "count");
  if (!from_map) return start;
  if (!start || start->node->kind != Node::Kind::String) return {};
  choice(*start);
  return std::nullopt;
}

Boxes read_spline(const Value& form, const std::optional<Value>& start, double size, bool from_map) {
  allow_only(form);
  const Value points = need(form, "points");
  const std::vector<Value> entries = items(points, 4);
  Boxes boxes;
  for (const Value& entry : entries) add_place(entry, boxes);
  if (from_map && !(signed_area(boxes.start) > 1e-12 * size * size))  // only its shape counts: a circle
    for (std::size_t i = 0; i < boxes.start.size(); ++i) {
      const double angle = 2 * pi * static_cast<double>(i / 2) / static_cast<double>(entries.size());
      boxes.start[i] += 0.25 * (boxes.upper[i] - boxes.lower[i]) * (i % 2 == 0 ? std::cos(angle) : std::sin(angle));
    }
  const std::string begin = start ? one_of(*start, {"points", "center"}) : "";
  if (start) allow_only(*start, begin);
  if (begin == "points") {
    const Value given = need(*start, "points");
    const std::vector<Value> places = items(given);
    if (places.size() != entries.size())
      fail(given.node->position,
           fmt::format("{} has {} points; the spline has {}", given.name, places.size(), entries.size()));
    for (std::size_t i = 0; i < places.size(); ++i) begin_at_place(places[i], 2 * i, boxes);
  } else if (start) {
    const Vec2 center = point(need(*start, "center"));
    const Value radius = need(*start, "radius");
    const double r = positive(radius);
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const double angle = 2 * pi * static_cast<double>(i) / static_cast<double>(entries.size());
      const Vec2 x = center + r * Vec2(std::cos(angle), std::sin(angle));
      for (std::size_t d = 0; d < 2; ++d) {
        const Value where{start->node,
                          fmt::format("{}: {} of control point {}", start->name, d == 0 ? "x" : "y", i + 1)};
        begin_at(where, x[static_cast<Eigen::Index>(d)], 2 * i + d, boxes);
      }
    }
  }
  if (!(signed_area(boxes.start) > 1e-12 * size * size))
    fail((start ? *start : points).node->position,
         fmt::format("{}: the control points {} counter-clockwise around a hole; {}", (start ? *start : points).name,
                     start ? "must run" : "begin in the middle of their boxes and do not run",
                     start ? "turn their order round" : "add start = { center = [x, y], radius = r }"));
  return boxes;
}

Boxes read_path_boxes(const Value& path, const std::optional<Value>& start, bool from_map) {
  Boxes boxes;
  const std::vector<Value> entries = items(path, 2);
  for (const Value& entry : entries) add_place(entry, boxes);
  if (from_map)  // anything that is a path
    for (std::size_t i = 0; i < boxes.start.size(); ++i)
      boxes.start[i] += (static_cast<double>(i / 2) / static_cast<double>(entries.size() - 1) - 0.5) * 0.5 *
                        (boxes.upper[i] - boxes.lower[i]);
  if (start) {
    allow_only(*start);
    const Value given = need(*start, "path");
    const std::vector<Value> places = items(given);
    if (places.size() != entries.size())
      fail(given.node->position,
           fmt::format("{} has {} points; the path has {}", given.name, places.size(), entries.size()));
    for (std::size_t i = 0; i < places.size(); ++i) begin_at_place(places[i], 2 * i, boxes);
  }
  for (std::size_t i = 0; i + 3 < boxes.start.size(); i += 2)
    if (boxes.start[i] == boxes.start[i + 2] && boxes.start[i + 1] == boxes.start[i + 3])
      fail((start ? *start : path).node->position,
           fmt::format("{}: points {} and {} begin at the same place{}", (start ? *start : path).name, i / 2 + 1,
                       i / 2 + 2, start ? "" : ", the middle of their boxes; add start = { path = [[x, y], ...] }"));
  return boxes;
}

Eigen::VectorXd vector(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

/// Names of holes, cracks or regions that are drawn.
struct Names {
  std::string kind;                // "hole"
  std::vector<std::string> taken;  // by the body, and so far
  std::vector<std::string> given;  // in the tables, so that no made-up name takes one of them

  /// The key `name`, or the first of hole_1, hole_2, ... that is free.
  std::string next(const Value& table) {
    const auto in = [](const std::vector<std::string>& words, const std::string& word) {
      return std::find(words.begin(), words.end(), word) != words.end();
    };
    std::string name;
    if (const auto field = find(table, "name")) {
      name = safe_name(*field);
      if (in(taken, name)) refuse_taken(*field, name);
    } else {
      for (int k = 1; name.empty() || in(taken, name) || in(given, name); ++k) name = fmt::format("{}_{}", kind, k);
    }
    taken.push_back(name);
    return name;
  }
};

template <typename Named>
Names names(const std::string& kind, const std::vector<Value>& tables, const std::vector<Named>& present) {
  Names out{kind, {}, {}};
  for (const Named& thing : present) out.taken.push_back(thing.name);
  for (const Value& table : tables)
    if (const auto name = find(table, "name"); name && name->node->kind == Node::Kind::String)
      out.given.push_back(name->node->text);
  return out;
}

Drawn drawn(Drawn::Kind kind, const std::string& name, const Boxes& boxes, bool from_map) {
  Drawn out{.kind = kind, .name = name};
  out.lower = vector(boxes.lower);
  out.upper = vector(boxes.upper);
  out.start = vector(boxes.start);
  out.from_map = from_map;
  return out;
}

void draw_holes(const Value& optimize, const Shape& shape, Design& design) {
  const std::vector<Value> tables = find_tables(optimize, "hole");
  Names given = names("hole", tables, shape.holes);
  for (const Value& table : tables) {
    allow_only(table);
    const std::string kind = one_of(table);
    const Value form = need(table, kind);
    bool from_map = false;
    const auto start = read_start_of_crack(table, from_map);
    const std::string name = given.next(table);
    if (kind == "circle") {
      if (start) allow_only(*start, "circle");
      design.drawn.push_back(drawn(Drawn::Kind::Circle, name, read_circle(form, start), from_map));
    } else if (kind == "ellipse") {
      design.drawn.push_back(drawn(Drawn::Kind::Ellipse, name, read_ellipse(form, start), from_map));
    } else {
      const Boxes boxes = read_spline(form, start, extent(shape), from_map);
      design.drawn.push_back(drawn(Drawn::Kind::Spline, name, boxes, from_map));
    }
  }
}

void draw_cracks(const Value& optimize, const Shape& shape, Design& design) {
  const std::vector<Value> tables = find_tables(optimize, "crack");
  Names given = names("crack", tables, shape.cracks);
  for (const Value& table : tables) {
    allow_only(table);
    const std::string name = given.next(table);
    bool from_map = false;
    const auto start = read_start_of_crack(table, from_map);
    design.drawn.push_back(
        drawn(Drawn::Kind::Crack, name, read_path_boxes(need(table, "path"), start, from_map), from_map));
    take(table, "contact", design.drawn.back().law.kind);
  }
}

void draw_regions(const Value& optimize, const Case& c, Design& design) {
  const std::vector<Value> tables = find_tables(optimize, "region");
  Names given = names("region", tables, c.shape.regions);
  for (const Value& table : tables) {
    allow_only(table);
    const std::string name = given.next(table);
    bool from_map = false;
    const auto start = read_start_of_crack(table, from_map);
    if (start) allow_only(*start);
    Boxes boxes = read_circle(need(table, "circle"), start);
    add_box(need(table, "young"), 0, boxes);
    if (start)
      if (const auto young = find(*start, "young")) begin_at(*young, number(*young), 3, boxes);
    const double poisson = in_range(need(table, "poisson"));
    for (const double young : {boxes.lower[3], boxes.upper[3]}) elastic(table, {young, poisson}, c.plane_strain);
    design.drawn.push_back(drawn(Drawn::Kind::Inclusion, name, boxes, from_map));
    design.drawn.back().poisson = poisson;
  }
}

}  // namespace

Design read_design(const Value& optimize, const Case& c) {
  Design design;
  draw_holes(optimize, c.shape, design);
  draw_cracks(optimize, c.shape, design);
  draw_regions(optimize, c, design);
  return design;
}

}  // namespace kerf
