// Changes of a case file as a tree: what a hasty, a confused and a hostile user would write.

#include "io/case/keys.hpp"
#include "tests/fuzz/input.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace kerf::fuzz {

namespace {

using Kind = Value::Kind;

bool is_number(const Value& v, double& x) {
  if (v.kind != Kind::Token) return false;
  const auto [end, error] = std::from_chars(v.text.data(), v.text.data() + v.text.size(), x);
  return error == std::errc() && end == v.text.data() + v.text.size() && std::isfinite(x);
}

bool is_point(const Value& v) {
  double x = 0;
  return v.kind == Kind::Array && v.items.size() == 2 && is_number(v.items[0].second, x) &&
         is_number(v.items[1].second, x);
}

/// Of the outline, where it has one.
struct Box {
  double x0 = 0, y0 = 0, x1 = 1, y1 = 1;
  std::vector<std::pair<std::string, std::string>> corners;
  double extent() const {
    return std::max(x1 - x0, y1 - y0);
  }
};

Box box_of(Value& document) {
  Box box;
  Value* domain = member(document, "domain");
  Value* outline = domain ? member(*domain, "outline") : nullptr;
  if (!outline) return box;
  for (auto& [none, p] : outline->items) {
    Value* end = &p;
    if (p.kind == Kind::Table) end = member(p, "arc_to");
    if (!end || !is_point(*end)) continue;
    double x = 0, y = 0;
    is_number(end->items[0].second, x), is_number(end->items[1].second, y);
    if (box.corners.empty()) box = {x, y, x, y, {}};
    box.x0 = std::min(box.x0, x), box.x1 = std::max(box.x1, x);
    box.y0 = std::min(box.y0, y), box.y1 = std::max(box.y1, y);
    box.corners.emplace_back(end->items[0].second.text, end->items[1].second.text);
  }
  return box;
}

/// Mostly inside, sometimes a corner, on the rim, or outside.
Value a_point(Dice& dice, const Box& box) {
  if (!box.corners.empty() && dice.chance(0.12)) {
    const auto& [x, y] = dice.one_of(box.corners);
    return pair(x, y);
  }
  const double wide = dice.chance(0.1) ? 0.5 : 0;
  double x = dice.between(box.x0 - wide * (box.x1 - box.x0), box.x1 + wide * (box.x1 - box.x0)),
         y = dice.between(box.y0 - wide * (box.y1 - box.y0), box.y1 + wide * (box.y1 - box.y0));
  if (dice.chance(0.1)) x = dice.chance(0.5) ? box.x0 : box.x1;
  if (dice.chance(0.1)) y = dice.chance(0.5) ? box.y0 : 0.5 * (box.y0 + box.y1);
  const int digits = dice.chance(0.5) ? 3 : 17;
  return pair(fmt::format("{:.{}g}", x, digits), fmt::format("{:.{}g}", y, digits));
}

std::string a_name(Dice& dice, const char* base) {
  static const std::vector<std::string> odd = {"",           " ",    "a b",      "hole:h1", "top",
                                               "bottom",     "left", "\xc3\xa9", "../up",   "a/b",
                                               "nul\\u0000", "-",    "c",        "c1",      "h1"};
  return dice.chance(0.04) ? dice.one_of(odd) : fmt::format("{}{}", base, dice.below(1000));
}

Value points(Dice& dice, const Box& box, std::size_t count) {
  Value out{.kind = Kind::Array};
  for (std::size_t i = 0; i < count; ++i) out.items.emplace_back("", a_point(dice, box));
  return out;
}

std::string a_length(Dice& dice, const Box& box) {
  return fmt::format("{:.4g}", box.extent() * std::pow(10, dice.between(dice.chance(0.15) ? -6 : -1.5, -0.3)));
}

Value a_circle(Dice& dice, const Box& box) {
  Value circle{.kind = Kind::Table};
  circle.items.emplace_back("center", a_point(dice, box));
  circle.items.emplace_back("radius", token(a_length(dice, box)));
  return circle;
}

Value a_form(Dice& dice, const Box& box, std::string& key) {
  switch (dice.below(3)) {
    case 0: {
      key = "ellipse";
      Value ellipse{.kind = Kind::Table};
      ellipse.items.emplace_back("center", a_point(dice, box));
      const std::string a = a_length(dice, box);
      ellipse.items.emplace_back("semi_axes", pair(a, a_length(dice, box)));
      ellipse.items.emplace_back("angle_deg", token(fmt::format("{:.3g}", dice.between(-400, 400))));
      return ellipse;
    }
    case 1:
      key = "polygon";
      return points(dice, box, 3 + dice.below(3));
    default:
      key = "circle";
      return a_circle(dice, box);
  }
}

Value& list_of_tables(Value& document, const std::string& key) {
  Value& list = member_or_new(document, key);
  if (list.kind != Kind::Array) list = Value{.kind = Kind::Array};
  return list;
}

void add_crack(Dice& dice, Value& document, const Box& box) {
  static const std::vector<std::string> laws = {"unilateral", "unilateral", "open", "bonded", "closed"};
  Value crack{.kind = Kind::Table};
  crack.items.emplace_back("name", text(a_name(dice, "k")));
  if (dice.chance(0.75)) {
    crack.items.emplace_back("path", points(dice, box, dice.chance(0.8) ? 2 : 1 + dice.below(5)));
  } else {
    Value arc = a_circle(dice, box);
    arc.items.emplace_back("from_deg", token(fmt::format("{:.4g}", dice.between(-360, 360))));
    arc.items.emplace_back("to_deg", token(fmt::format("{:.4g}", dice.between(-360, 720))));
    crack.items.emplace_back("arc", std::move(arc));
  }
  if (dice.chance(0.4)) crack.items.emplace_back("contact", text(dice.one_of(laws)));
  if (dice.chance(0.2))
    crack.items.emplace_back(dice.chance(0.7) ? "friction" : "tresca", token(odd_number(dice, "0.3")));
  if (dice.chance(0.15)) crack.items.emplace_back("pressure", text(odd_expression(dice, 2)));
  list_of_tables(document, "crack").items.emplace_back("", std::move(crack));
}

void add_hole_or_region(Dice& dice, Value& document, const Box& box) {
  const bool hole = dice.chance(0.6);
  Value one{.kind = Kind::Table};
  one.items.emplace_back("name", text(a_name(dice, hole ? "o" : "r")));
  std::string key;
  Value form = a_form(dice, box, key);
  one.items.emplace_back(key, std::move(form));
  if (!hole) {
    one.items.emplace_back("young", token(odd_number(dice, "10")));
    one.items.emplace_back("poisson", token(odd_number(dice, "0.3")));
  }
  list_of_tables(document, hole ? "hole" : "region").items.emplace_back("", std::move(one));
}

void add_condition(Dice& dice, Value& document) {
  static const std::vector<std::string> kinds = {"traction",       "pressure",       "displacement",
                                                 "displacement_x", "displacement_y", "displacement_normal"};
  Value* domain = member(document, "domain");
  Value* sides = domain ? member(*domain, "sides") : nullptr;
  std::string on = "top";
  if (sides && !sides->items.empty()) on = sides->items[dice.below(sides->items.size())].second.text;
  const std::string kind = dice.one_of(kinds);
  const auto formula = [&] {
    return dice.chance(0.4) ? token(odd_number(dice, "0.5")) : text(odd_expression(dice, 3));
  };
  Value value = formula();
  if (kind == "traction" || kind == "displacement") {
    Value both{.kind = Kind::Array};
    both.items.emplace_back("", std::move(value));
    both.items.emplace_back("", formula());
    value = std::move(both);
  }
  Value condition{.kind = Kind::Table};
  condition.items.emplace_back("on", text(on));
  condition.items.emplace_back(kind, std::move(value));
  list_of_tables(document, "boundary").items.emplace_back("", std::move(condition));
}

Place any(Dice& dice, Value& document) {
  const std::vector<Place> all = places(document);
  return all.empty() ? Place{} : all[dice.below(all.size())];
}

void change_scalar(Dice& dice, Value& document) {
  std::vector<Place> all = places(document);
  std::erase_if(all, [](const Place& p) { return p.value().kind == Kind::Array || p.value().kind == Kind::Table; });
  if (all.empty()) return;
  const Place place = dice.one_of(all);
  Value& v = place.value();
  if (v.kind == Kind::Token) {
    v.text = odd_number(dice, v.text);
    if (dice.chance(0.04)) v.kind = Kind::Text;
    return;
  }
  const Key* key = find_key(place.path);
  if (key && !key->rules.words.empty() && dice.chance(0.8)) {
    v.text = std::string(key->rules.words[dice.below(key->rules.words.size())]);
  } else if (key && has(key->type, KeyType::Vector | KeyType::Formula | KeyType::Formulas) && dice.chance(0.7)) {
    v.text = odd_expression(dice, 3);
  } else if (dice.chance(0.5)) {
    v.text = a_name(dice, "n");
  } else if (dice.chance(0.5)) {
    damage(dice, v.text);
  } else {
    const Place other = dice.one_of(all);  // a label, a name, an expression from elsewhere
    v = Value(other.value());
  }
}

void change_members(Dice& dice, Value& document) {
  const Place place = any(dice, document);
  if (!place.parent) return;
  auto& items = place.parent->items;
  const auto at = items.begin() + static_cast<std::ptrdiff_t>(place.index);
  switch (dice.below(8)) {
    case 0:
    case 1:
      items.erase(at);
      break;
    case 2: {
      auto copy = *at;  // a key twice, a point twice
      items.insert(at, std::move(copy));
      break;
    }
    case 3:
      std::swap(at->second, items[dice.below(items.size())].second);
      break;
    case 4:
      if (!at->first.empty()) {
        std::string& key = at->first;
        const std::size_t i = dice.below(key.size());
        dice.chance(0.5) ? key.erase(i, 1) : key.insert(i, 1, "aeiou_"[dice.below(6)]);
      }
      break;
    case 5: {
      Value wrapped{.kind = Kind::Array};
      const std::size_t deep = dice.chance(0.2) ? dice.below(400) : 1;
      for (std::size_t i = 0; i < deep; ++i) {
        wrapped = Value{.kind = Kind::Array};
        wrapped.items.emplace_back("", std::move(at->second));
        at->second = std::move(wrapped);
      }
      break;
    }
    case 6:
      if (!items[place.index].second.items.empty()) std::reverse(at->second.items.begin(), at->second.items.end());
      break;
    default: {
      const std::size_t more = dice.below(dice.chance(0.1) ? 60 : 4);
      const auto copy = *at;
      if (place.parent->kind == Kind::Array) items.insert(at, more, copy);
    }
  }
}

/// A table, a value or a whole section from another file.
void splice(Dice& dice, Value& document, const Corpus& corpus) {
  Value other = dice.one_of(corpus).document;
  const std::vector<Place> theirs = places(other);
  if (theirs.empty()) return;
  const Place from = dice.one_of(theirs);
  for (const Place& mine : places(document)) {
    if (mine.path != from.path || !dice.chance(0.5)) continue;
    mine.value() = from.value();
    return;
  }
  if (from.path.find('.') == std::string::npos && from.parent == &other)
    document.items.push_back(other.items[from.index]);
  else if (const Place at = any(dice, document); at.parent)
    at.value() = Value(from.value());
}

/// The table of that path, made where it is missing; of a list any entry. nullptr: something else is there.
Value* table_at(Dice& dice, Value& document, std::string path) {
  Value* here = &document;
  while (!path.empty()) {
    const std::size_t dot = std::min(path.find('.'), path.size());
    std::string part = path.substr(0, dot);
    path.erase(0, dot + 1);
    const bool list = part.ends_with("[]");
    if (list) part.resize(part.size() - 2);
    if (here->kind != Kind::Table) return nullptr;
    Value& next = member_or_new(*here, part);
    if (next.kind == Kind::Token && next.text.empty()) next.kind = list ? Kind::Array : Kind::Table;
    here = &next;
    if (!list) continue;
    if (next.kind != Kind::Array) return nullptr;
    if (next.items.empty()) next.items.emplace_back("", Value{.kind = Kind::Table});
    here = &next.items[dice.below(next.items.size())].second;
  }
  return here->kind == Kind::Table ? here : nullptr;
}

/// What a key goes with: the word of the table's `kind` or `method`, or a key that it has.
std::string variant_of(Value& table) {
  for (const char* key : {"kind", "method"})
    if (const Value* v = member(table, key)) return v->text;
  return table.items.empty() ? "" : table.items.back().first;
}

/// A key that the table of keys has and this file lacks, mostly in a table that it has; or one that nobody has.
void add_key(Dice& dice, Value& document) {
  const auto keys = all_keys();
  const Key* key = &keys[dice.below(keys.size())];
  if (dice.chance(0.8)) {
    std::vector<Place> all = places(document);
    std::erase_if(all, [](const Place& p) { return p.value().kind != Kind::Table || p.value().items.empty(); });
    if (!all.empty()) {
      const Place place = dice.one_of(all);
      const auto fitting = keys_in(place.path, variant_of(place.value()));
      if (!fitting.empty()) key = fitting[dice.below(fitting.size())];
    }
  }
  const std::string path(key->path);
  const std::size_t dot = path.rfind('.');
  Value* here = dot == std::string::npos ? &document : table_at(dice, document, path.substr(0, dot));
  std::string last(name(*key));
  if (!here || last.empty()) return;
  if (dice.chance(0.03)) last += "x";
  Value value = value_for(dice, key->path);
  if (has(key->type, KeyType::Tables) && value.kind == Kind::Token && !value.text.starts_with("[")) {
    value = Value{.kind = Kind::Array};
    value.items.emplace_back("", Value{.kind = Kind::Table});
  }
  if (has(key->type, KeyType::Table) && key->example.empty()) value = Value{.kind = Kind::Table};
  member_or_new(*here, last) = std::move(value);
}

/// Points a little or far off, on top of each other, or bent into an arc.
void move_points(Dice& dice, Value& document, const Box& box) {
  std::vector<Place> all = places(document);
  std::erase_if(all, [](const Place& p) { return !is_point(p.value()); });
  if (all.empty()) return;
  const Place place = dice.one_of(all);
  Value& point = place.value();
  switch (dice.below(5)) {
    case 0:
      point = a_point(dice, box);
      break;
    case 1: {
      const double by = box.extent() * std::pow(10, dice.between(-16, -0.5));
      for (auto& [none, c] : point.items) {
        double x = 0;
        is_number(c, x);
        c.text = fmt::format("{}", x + dice.between(-by, by));
      }
      break;
    }
    case 2:
      point = Value(dice.one_of(all).value());
      break;
    case 3: {  // an arc of an outline
      Value arc{.kind = Kind::Table};
      arc.items.emplace_back("arc_to", point);
      arc.items.emplace_back("center", a_point(dice, box));
      point = std::move(arc);
      break;
    }
    default: {
      const double by = std::pow(10, std::round(dice.between(-9, 9)));  // everything, in other units
      const bool shift = dice.chance(0.3);
      for (const Place& p : all)
        for (auto& [none, c] : p.value().items) {
          double x = 0;
          is_number(c, x);
          c.text = fmt::format("{}", shift ? x + by : x * by);
        }
    }
  }
}

void limit(Value& document, std::string_view table, const std::string& key, double least, double most,
           const char* otherwise) {
  Value* t = member(document, table);
  if (!t || t->kind != Kind::Table) return;
  Value* v = member(*t, key);
  if (!v) {
    if (otherwise) t->items.emplace_back(key, token(otherwise));
    return;
  }
  double x = 0;
  if (!is_number(*v, x) || x <= 0) return;
  if (x < least) v->text = fmt::format("{:.4g}", least);
  if (x > most) v->text = fmt::format("{:.4g}", most);
}

}  // namespace

void mutate(Dice& dice, Value& document, const Corpus& corpus) {
  const Box box = box_of(document);
  switch (dice.below(13)) {
    case 0:
    case 1:
    case 2:
    case 3:
      return change_scalar(dice, document);
    case 4:
      return change_members(dice, document);
    case 5:
      return splice(dice, document, corpus);
    case 6:
    case 7:
      return add_key(dice, document);
    case 8:
      return move_points(dice, document, box);
    case 9:
    case 10:
      return add_crack(dice, document, box);
    case 11:
      return add_hole_or_region(dice, document, box);
    default:
      return add_condition(dice, document);
  }
}

void tame(Dice& dice, Value& document) {
  const double extent = box_of(document).extent();
  const bool fine = dice.chance(0.02);
  if (!fine && extent > 0 && std::isfinite(extent)) {
    const std::string size = fmt::format("{:.4g}", extent / 6);
    if (Value& mesh = member_or_new(document, "mesh"); mesh.kind == Kind::Token && mesh.text.empty())
      mesh.kind = Kind::Table;
    limit(document, "mesh", "size", extent / 7, infinity, dice.chance(0.95) ? size.c_str() : nullptr);
    limit(document, "mesh", "crack_tip_size", extent / 40, infinity, nullptr);
    limit(document, "synthetic", "size", extent / 8, infinity, nullptr);
    limit(document, "synthetic", "crack_tip_size", extent / 40, infinity, nullptr);
  }
  limit(document, "optimize", "max_iterations", 0, 2, "1");
  limit(document, "optimize", "starts", 0, 2, nullptr);
  if (Value* mesh = member(document, "mesh")) limit(*mesh, "adapt", "max_triangles", 0, 500, "400");
  if (Value* validate = member(document, "validate")) limit(*validate, "radii", "count", 0, 3, nullptr);
  if (Value* optimize = member(document, "optimize")) limit(*optimize, "defects", "at_most", 0, 2, nullptr);
  if (dice.chance(0.93)) {
    Value& output = member_or_new(document, "output");
    if (output.kind == Kind::Token && output.text.empty()) output.kind = Kind::Table;
    for (const char* what : {"vtk", "png", "html"})
      if (output.kind == Kind::Table && !member(output, what)) output.items.emplace_back(what, token("false"));
  }
}

}  // namespace kerf::fuzz
