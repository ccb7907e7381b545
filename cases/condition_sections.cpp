#include "cases/formula.hpp"
#include "cases/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace kerf {

namespace {

const std::vector<std::string> loads = {"traction", "pressure"};
const std::vector<std::string> supports = {"displacement", "displacement_x", "displacement_y", "displacement_normal"};

/// What one label carries: per key where it stands and its one or two components.
struct Condition {
  Position position;
  std::array<Formula, 2> value;
};
using Conditions = std::map<std::string, Condition>;

bool clash(const std::string& a, const std::string& b) {
  if (a == b) return true;
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
  if (on_label.count("displacement_normal"))
    return [load](const Vec2& x, const Vec2& n) {
      const Vec2 t = load(x, n);
      return Vec2(t - t.dot(n) * n);
    };
  for (const int d : {0, 1}) {
    const std::string key = d == 0 ? "displacement_x" : "displacement_y";
    const auto roller = on_label.find(key);
    if (roller == on_label.end()) continue;
    if (const auto traction = on_label.find("traction"); traction != on_label.end())
      if (traction->second.value[d].constant != 0.0)
        fail(traction->second.position,
             fmt::format("label {}: component {} of the traction must be 0, because {} is prescribed there (at {})",
                         quote(label), d == 0 ? "x" : "y", key, to_string(roller->second.position)));
    return [load, d](const Vec2& x, const Vec2& n) {
      Vec2 t = load(x, n);
      t[d] = 0;
      return t;
    };
  }
  return load;
}

void apply(const Conditions& on_label, Index label, const std::string& name, Scene& scene) {
  const auto get = [&](const char* key) -> const Condition* {
    const auto found = on_label.find(key);
    return found == on_label.end() ? nullptr : &found->second;
  };
  const Expression zero = [](const Vec2&, const Vec2&) { return 0.0; };
  if (const auto* full = get("displacement")) {
    scene.supports.push_back({label, false, true, true, vector_field(full->value[0].value, full->value[1].value)});
  } else if (const auto* normal = get("displacement_normal")) {
    scene.supports.push_back({label, true, true, false, vector_field(normal->value[0].value, zero)});
  } else {
    const auto *x = get("displacement_x"), *y = get("displacement_y");
    if (x || y)
      scene.supports.push_back({label, false, x != nullptr, y != nullptr,
                                vector_field(x ? x->value[0].value : zero, y ? y->value[0].value : zero)});
  }
  BoundaryField load;
  if (const auto* traction = get("traction")) load = vector_field(traction->value[0].value, traction->value[1].value);
  if (const auto* pressure = get("pressure"))
    load = [p = pressure->value[0].value](const Vec2& x, const Vec2& n) { return Vec2(-p(x, n) * n); };
  if (load) scene.tractions.push_back({label, free_part(on_label, load, name)});
}

}  // namespace

void read_conditions(const Field& document, Definitions& definitions, Case& c) {
  std::vector<Conditions> per_label(c.shape.labels.size());
  for (const Field& entry : find_tables(document, "boundary")) {
    std::vector<std::string> keys = {"on"};
    keys.insert(keys.end(), loads.begin(), loads.end());
    keys.insert(keys.end(), supports.begin(), supports.end());
    allow_only(entry, keys);
    const Field on = need(entry, "on");
    const std::vector<Index> labels = find_labels(on, c.shape);
    bool anything = false;
    for (std::size_t k = 1; k < keys.size(); ++k) {
      const auto field = find(entry, keys[k]);
      if (!field) continue;
      anything = true;
      const bool is_vector = keys[k] == "traction" || keys[k] == "displacement";
      const Condition condition{field->node->position, is_vector ? formulas(*field, definitions)
                                                                 : std::array{formula(*field, definitions), Formula{}}};
      for (const Index label : labels) add(per_label[label], keys[k], condition, c.shape.labels[label]);
    }
    if (!anything)
      fail(entry.node->position, fmt::format("{} prescribes nothing; give {} or {}", entry.name, fmt::join(loads, ", "),
                                             fmt::join(supports, ", ")));
  }
  for (std::size_t label = 0; label < per_label.size(); ++label)
    apply(per_label[label], static_cast<Index>(label), c.shape.labels[label], c.scene);

  if (const auto body = find_table(document, "body")) {
    allow_only(*body, {"force"});
    const auto force = formulas(need(*body, "force"), definitions, false);
    c.scene.body = [fx = force[0].value, fy = force[1].value](const Vec2& x) {
      return Vec2(fx(x, Vec2::Zero()), fy(x, Vec2::Zero()));
    };
  }
}

}  // namespace kerf
