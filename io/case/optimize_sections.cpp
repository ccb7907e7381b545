// [optimize]: the method, what is bounded and what is moved. A level set takes symmetry, frozen regions, nucleation and
// a start of holes or of another file's body; the methods that move drawn holes, cracks and regions take these (see
// design_sections.cpp), least_squares and defects. Keys of the other methods are refused by name. Volumes are shares of
// the area of the body, lengths are refused where they are not smaller than its diagonal. A start from another case
// file is read with that file's own [optimize] start removed, and must lie inside this body: every point of its
// outline, up to 1e-4 of the extent.

#include "geometry/plane.hpp"
#include "io/case/sections.hpp"
#include "io/document.hpp"
#include "io/words.hpp"
#include "optimize/refuse.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

/// A length of a part of the design.
double length(const Value& field, double size) {
  const double value = positive(field);
  if (!(value < size))
    fail(field.node->position,
         fmt::format("{} = {:g} must be smaller than the body, whose diagonal is {:g}", field.name, value, size));
  return value;
}

void read_volume(const Value& volume, OptimizeRequest& r) {
  if (volume.node->kind != Node::Kind::Table)
    fail(volume.node->position, volume.name +
                                    " must be { at_most = 0.4 } (of the area), { penalty = 100 } (J + penalty "
                                    "times area), or both in one table");
  allow_only(volume);
  const auto at_most = find(volume, "at_most"), penalty = find(volume, "penalty");
  if (!at_most && !penalty) fail(volume.node->position, volume.name + " needs at_most, penalty or both");
  if (at_most) {
    r.volume_at_most = positive(*at_most);
    if (*r.volume_at_most > 1)
      fail(at_most->node->position, fmt::format("{} = {:g} is a share of the body's area; it must not be larger than 1",
                                                at_most->name, *r.volume_at_most));
  }
  if (penalty) r.volume_penalty = in_range(*penalty);
}

void read_nucleate(const Value& field, LevelSetRequest& r) {
  if (field.node->kind == Node::Kind::Boolean) {
    if (!field.node->boolean) r.nucleate_every = 0;
    return;
  }
  if (field.node->kind != Node::Kind::Table)
    fail(field.node->position, field.name + " must be { every = 5, fraction = 0.02 }, true or false");
  allow_only(field);
  take(field, "every", r.nucleate_every);
  if (const auto fraction = find(field, "fraction")) {
    r.nucleate_fraction = positive(*fraction);
    if (!(r.nucleate_fraction <= 0.5))
      fail(fraction->node->position, fmt::format("{} = {:g} is the share of the area that one nucleation may take; it "
                                                 "must not be larger than 0.5",
                                                 fraction->name, r.nucleate_fraction));
  }
}

/// The body of another case file, inside this one.
Shape read_design_file(const Value& field, const std::filesystem::path& folder, const Case& c) {
  const auto refuse = [&](const std::string& why) {
    fail(field.node->position, fmt::format("{} = {}: {}", field.name, quote(text(field)), why));
  };
  const std::filesystem::path path = folder / text(field);
  std::error_code none_there;
  if (std::filesystem::equivalent(path, folder / (c.name + ".toml"), none_there))
    refuse("that is this case itself; name another file, such as the design.toml of an earlier run");
  Shape design;
  try {
    Node document = read_document(path);  // its own start is nothing to this one
    for (Entry& entry : document.entries)
      if (entry.key == "optimize") std::erase_if(entry.value.entries, [](const Entry& e) { return e.key == "start"; });
    design = read_case(std::move(document), {path.stem().string(), path.parent_path(), path.string() + ":1:1"}).shape;
  } catch (const Error& error) {
    refuse(error.what());
  }
  if (const auto problem = find_problem(design)) refuse("no body: " + *problem);
  if (find_problem(c.shape)) return design;  // which is what the user will hear of
  const double size = extent(c.shape), step = 0.005 * size, near = 1e-4 * size;
  const Polygon frame = flatten(c.shape.outline, 0.1 * near, step), body = flatten(design.outline, 0.1 * near, step);
  for (const Vec2& x : body.points) {
    double away = infinity;
    for (std::size_t i = 0; i < frame.points.size(); ++i)
      away = std::min(away, distance(x, frame.points[i], frame.points[(i + 1) % frame.points.size()]));
    if (away > near && !inside(frame.points, x))
      refuse(
          fmt::format("its body reaches out of this one, at ({:.6g}, {:.6g}); a design begins inside", x.x(), x.y()));
  }
  return design;
}

StartHoles read_start_holes(const Value& field, double size) {
  StartHoles start;
  const std::string kind = one_of(field);
  if (kind == "holes") {
    const Value holes = need(field, "holes");
    if (holes.node->kind != Node::Kind::Array || holes.node->items.size() != 2)
      fail(holes.node->position, holes.name + " must be [columns, rows]");
    const std::vector<Value> counts = items(holes);
    start.columns = whole_number(counts[0]);
    start.rows = whole_number(counts[1]);
  } else {
    start.random = whole_number(need(field, "random"));
    take(field, "seed", start.seed);
  }
  start.radius = length(need(field, "radius"), size);
  return start;
}

Mirror read_mirror(const Value& field, const Case& c) {
  Mirror mirror;
  const std::string kind = one_of(field);
  allow_only(field, kind);
  if (kind == "point") {
    mirror.point = point(need(field, "point"));
    const Value direction = need(field, "direction");
    const Vec2 d = point(direction);
    if (!(d.norm() > 0) || !std::isfinite(d.norm()))
      fail(direction.node->position, direction.name + " must not be zero; [1, 0] is along x");
    mirror.direction = d.normalized();
  } else {
    const double at = number(need(field, kind));
    mirror.point = kind == "x" ? Vec2(at, 0) : Vec2(0, at);
    mirror.direction = kind == "x" ? Vec2::UnitY() : Vec2::UnitX();
  }
  if (find_problem(c.shape)) return mirror;  // which is what the user will hear of
  if (const auto why = wrong_mirror(c.shape, mirror)) fail(field.node->position, field.name + ": " + *why);
  return mirror;
}

void read_level_set(const Value& table, const std::filesystem::path& folder, std::vector<Loop> frozen, const Case& c,
                    OptimizeRequest& request) {
  LevelSetRequest& r = request.level_set;
  const double size = extent(c.shape);
  if (const auto field = find(table, "nucleate")) read_nucleate(*field, r);
  take(table, "move", r.move);
  take(table, "inner_product", r.product);
  if (const auto field = find(table, "smoothing")) r.smoothing = length(*field, size);
  if (const auto field = find(table, "min_feature")) r.min_feature = length(*field, size);
  if (const auto field = find(table, "min_gap")) r.min_gap = length(*field, size);
  if (const auto field = find(table, "symmetry")) r.mirror = read_mirror(*field, c);
  if (const auto field = find(table, "min_radius")) r.min_radius = length(*field, size);
  if (const auto field = find(table, "start")) {
    const std::string kind = one_of(*field);
    allow_only(*field, kind);
    if (kind == "design")
      r.start_design = read_design_file(need(*field, kind), folder, c);
    else
      r.start = read_start_holes(*field, size);
  }
  take(table, "ersatz", r.ersatz);
  if (const auto field = find(table, "frozen")) {
    std::vector<std::string> seen;
    for (const Value& item : items(*field)) {
      const std::string name = text(item);
      if (std::find(seen.begin(), seen.end(), name) != seen.end())
        fail(item.node->position, fmt::format("{}: region {} appears twice", item.name, quote(name)));
      seen.push_back(name);
      r.frozen.push_back(*std::find_if(frozen.begin(), frozen.end(), [&](const Loop& l) { return l.name == name; }));
      if (const auto why = wrong_mask(c.shape, r.frozen.back())) fail(item.node->position, item.name + ": " + *why);
    }
  }
}

std::vector<FunctionalBound> read_bounds(const Value& table, const std::filesystem::path& folder,
                                         Definitions& definitions, const Case& c) {
  std::vector<FunctionalBound> bounds;
  for (const Value& entry : find_tables(table, "bound")) {
    FunctionalBound bound;
    bound.functional = read_functional_table(entry, folder, definitions, c);
    for (const Term& term : bound.functional.terms)
      if (term.measured)
        fail(entry.node->position, entry.name + ": a misfit cannot be bounded; minimize it in [functional]");
    const auto is_taken = [&](const std::string& name) {
      return std::any_of(bounds.begin(), bounds.end(), [&](const FunctionalBound& b) { return b.name == name; });
    };
    if (const auto name = find(entry, "name")) {
      bound.name = new_name(*name, bounds);
    } else {
      bound.name = bound.functional.kind;
      for (int k = 2; is_taken(bound.name); ++k) bound.name = fmt::format("{}_{}", bound.functional.kind, k);
    }
    const Value at_most = need(entry, "at_most");
    bound.at_most = number(at_most);
    const std::string& kind = bound.functional.kind;
    // A violation is (J - at_most) / |at_most|: it has no scale where at_most is 0.
    const bool any_sign = kind == "energy" || kind == "displacement" || kind == "crack_opening" || kind == "sum";
    if (any_sign ? bound.at_most == 0 : !(bound.at_most > 0))
      fail(at_most.node->position, fmt::format("{} must {}: violations are measured relative to it", at_most.name,
                                               any_sign ? "not be 0" : "be positive"));
    bounds.push_back(std::move(bound));
  }
  return bounds;
}

/// Regions that stay void, in the order of their places.
std::vector<Loop> read_keep_out(const Value& table, const std::vector<LoadCase>& load_cases, const Case& c) {
  std::vector<Loop> read;
  Scene all = c.scene;
  for (const LoadCase& one : load_cases)
    all.tractions.insert(all.tractions.end(), one.tractions.begin(), one.tractions.end());
  for (const Value& entry : find_tables(table, "keep_out")) {
    allow_only(entry);
    const auto given = find(entry, "name");
    read.push_back(
        read_loop(entry, given ? new_name(*given, read) : fmt::format("keep_out_{}", read.size() + 1), none));
    if (const auto why = wrong_keep_out(c.shape, all, read.back())) fail(entry.node->position, *why);
  }
  std::ranges::stable_sort(read, [](const Loop& a, const Loop& b) { return begins_before(a, b); });
  return read;
}

/// The first key count = "auto" of what is drawn, which all of it has or nothing.
std::optional<Value> read_counts(const Value& optimize) {
  std::optional<Value> first, without;
  for (const char* kind : {"hole", "crack", "region"})
    for (const Value& table : find_tables(optimize, kind)) {
      const auto count = find(table, "count");
      if (!count) {
        without = table;
        continue;
      }
      choice(*count);
      const auto start = find(table, "start");
      if (start && start->node->kind != Node::Kind::String)
        fail(start->node->position,
             start->name + " does not go with count = \"auto\", where every number of things is begun from the map");
      if (!first) first = count;
    }
  if (first && without)
    fail(without->node->position, without->name +
                                      " needs count = \"auto\", too: things that are counted are looked for in every "
                                      "mixture; what is known to be there, draw in the body");
  return first;
}

/// least_squares, defects and count: how an inverse problem ends.
void read_fit(const Value& document, const Value& table, const std::filesystem::path& folder, const OptimizeRequest& r,
              Case& c) {
  constexpr int usual_most = 5;  // things that are tried
  const auto squares = find(table, "least_squares"), defects = find(table, "defects"), counts = read_counts(table);
  FitRequest fit;
  if (counts) fit.defects_at_most = usual_most;
  if (defects) {
    if (defects->node->kind != Node::Kind::Table)
      fail(defects->node->position, defects->name + " must be { at_most = 5 }");
    allow_only(*defects);
    fit.defects_at_most = whole_number(need(*defects, "at_most"));
    const bool from_map = std::ranges::all_of(r.design.drawn, &Drawn::from_map);
    if (!counts && (r.design.drawn.empty() || !from_map))
      fail(defects->node->position,
           defects->name +
               " goes with [[optimize.hole]], [[optimize.crack]] or [[optimize.region]] with start = \"map\", of which "
               "it makes copies");
  }
  const std::optional<Value>& counted = defects ? defects : counts;
  bool wanted = counted.has_value();
  if (squares && squares->node->kind == Node::Kind::Table) {
    allow_only(*squares);
    take(*squares, "noise", fit.noise);
    wanted = true;
  } else if (squares && squares->node->kind == Node::Kind::Boolean) {
    if (!squares->node->boolean && counted)
      fail(squares->node->position, fmt::format("{} = false does not go with {}, which are counted by it",
                                                squares->name, defects ? "defects" : "count = \"auto\""));
    wanted = wanted || squares->node->boolean;
  } else if (squares) {
    fail(squares->node->position, squares->name + " must be true, false or { noise = 1e-4 }");
  }
  if (!wanted) return;
  c.readings = read_readings(document, folder, counted ? *counted : *squares, c);
  c.readings.noise = fit.noise;
  c.fit = fit;
}

void refuse_keys_of_other_methods(const Value& table, OptimizeMethod method) {
  const std::vector<const Key*> own = keys_in(table.path, word(method));
  for (const Key* key : keys_in(table.path)) {
    if (std::find(own.begin(), own.end(), key) != own.end()) continue;
    const auto other = find(table, std::string(name(*key)));
    if (!other) continue;
    fail(other->node->position,
         method == OptimizeMethod::LevelSet
             ? fmt::format("{} goes with method = \"mma\", \"ccsaq\", \"slsqp\" or \"cobyla\", which move drawn "
                           "holes, cracks and regions, not with \"level-set\"{}",
                           other->name, name(*key) == "min_distance" ? "; use min_feature" : "")
             : fmt::format("{} goes with method = \"level-set\", not with \"{}\"", other->name, word(method)));
  }
}

}  // namespace

void read_optimize(const Value& document, const std::filesystem::path& folder, const std::vector<Loop>& frozen,
                   Definitions& definitions, Case& c) {
  std::vector<LoadCase> load_cases = read_load_cases(document, definitions, c);
  const auto found = find_table(document, "optimize");
  if (!found) {
    if (!load_cases.empty())
      fail(find_tables(document, "load_case").front().node->position,
           "[[load_case]] goes with [optimize]; without it write the loads as [[boundary]] and [body]");
    return;
  }
  const Value& table = *found;
  allow_only(table);

  OptimizeRequest r;
  take(table, "method", r.method);
  const bool level_set = r.method == OptimizeMethod::LevelSet;
  refuse_keys_of_other_methods(table, r.method);
  if (!find_table(document, "functional"))
    fail(table.node->position,
         "[optimize] needs [functional]: what is to be made small; kind = \"compliance\" gives a stiff "
         "body");
  if (const auto volume = find(table, "volume")) read_volume(*volume, r);
  take(table, "max_iterations", r.max_iterations);
  take(table, "tolerance", r.tolerance);
  take(table, "starts", r.starts);
  r.bounds = read_bounds(table, folder, definitions, c);
  r.load_cases = std::move(load_cases);
  if (const auto why = wrong_load_cases(c.functional, r))
    fail(find_tables(document, "load_case").front().node->position, *why);
  r.keep_out = read_keep_out(table, r.load_cases, c);
  if (level_set) {
    read_level_set(table, folder, frozen, c, r);
  } else {
    if (const auto distance = find(table, "min_distance")) r.min_distance = length(*distance, extent(c.shape));
    r.design = read_design(table, c);
    read_fit(document, table, folder, r, c);
  }
  for (const auto& why : {wrong_volume(c.functional, r), wrong_design(r)})
    if (why) fail(table.node->position, *why);
  c.optimize = std::move(r);
}

}  // namespace kerf
