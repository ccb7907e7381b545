// Values of conditions and functionals from a case file: a number, an expression in a string, or a function handed over
// by a program (a black box, of which nothing is proved). Each carries its value at a point, its constant where it has
// one, and its syntax tree for what can be proved. Errors get the line of the file and the name of the key in front.
// Here too: [define], read and checked as a whole, each definition with those before it, so that a wrong one is refused
// where it stands and one that nothing uses is refused as a mistake; and labels, by name, by hole or both.

#include "io/case/formula.hpp"

#include "io/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

void require_finite(double value, const std::string& where, const Vec2& x) {
  if (!std::isfinite(value))
    throw Error(Fault::Usage, fmt::format("{}the function is not finite ({}) at ({:.6g}, {:.6g}); it must have a value "
                                          "wherever it is applied",
                                          where, value, x.x(), x.y()));
}

/// A black box as it is called: with the place of its key before what it throws, and every component finite.
template <typename Value>
auto guarded(std::function<Value(const Vec2&, const Vec2&)> f, const std::string& where) {
  return [f = std::move(f), where](const Vec2& x, const Vec2& n) {
    Value value;
    try {
      value = f(x, n);
    } catch (const Error& e) {
      throw Error(e.fault, where + e.what());
    }
    if constexpr (std::is_same_v<Value, double>)
      require_finite(value, where, x);
    else
      for (const double one : value) require_finite(one, where, x);
    return value;
  };
}

std::string words_before(const Value& field) {
  return to_string(field.node->position) + ": " + field.name + ": ";
}

/// A black box: nothing is proved of it, data are sampled.
Formula of_function(const Value& field) {
  return {guarded(field.node->function, words_before(field)), std::nullopt, nullptr};
}

/// The same for both components at once.
std::array<Formula, 2> of_pair(const Value& field) {
  const auto pair = std::make_shared<const PairExpression>(guarded(field.node->pair, words_before(field)));
  const auto component = [&](int d) {
    return Formula{[pair, d](const Vec2& x, const Vec2& n) { return (*pair)(x, n)[d]; }, std::nullopt, nullptr, pair};
  };
  return {component(0), component(1)};
}

}  // namespace

Formula formula(const Value& field, Definitions& definitions, bool on_boundary) {
  const auto fixed = [](double value) {
    const auto syntax = std::make_shared<Syntax>();
    syntax->nodes.push_back({.kind = SyntaxNode::Kind::Constant, .value = value});
    return Formula{[value](const Vec2&, const Vec2&) { return value; }, value, syntax};
  };
  if (field.node->kind == Node::Kind::Integer || field.node->kind == Node::Kind::Float) return fixed(number(field));
  if (field.node->kind == Node::Kind::Function) return of_function(field);
  if (field.node->kind != Node::Kind::String)
    fail(field.node->position, field.name + " must be a number or an expression in a string, \"1 + x\"");
  const std::string where = words_before(field);
  try {
    definitions.context.on_boundary = on_boundary;
    const Expression parsed = parse_expression(field.node->text, definitions.context);
    for (const std::size_t k : definitions_under(field.node->text, definitions.context)) definitions.used[k] = true;
    if (names_in(field.node->text).empty()) return fixed(parsed(Vec2::Zero(), Vec2::Zero()));
    const auto placed = [parsed, where](const Vec2& x, const Vec2& n) {
      try {
        return parsed(x, n);
      } catch (const Error& e) {
        throw Error(e.fault, where + e.what());
      }
    };
    return {placed, std::nullopt, syntax_of(field.node->text, definitions.context)};
  } catch (const Error& e) {
    throw Error(e.fault, where + e.what());
  }
}

std::array<Formula, 2> formulas(const Value& field, Definitions& definitions, bool on_boundary) {
  if (field.node->kind == Node::Kind::Function && field.node->pair) return of_pair(field);
  const std::vector<Value> xy = pair(field);
  return {formula(xy[0], definitions, on_boundary), formula(xy[1], definitions, on_boundary)};
}

Index find_label(const Value& field, const Shape& shape) {
  const std::string word = text(field);
  for (const std::string& label : {word, "hole:" + word})
    if (const auto found = std::ranges::find(shape.labels, label); found != shape.labels.end())
      return static_cast<Index>(found - shape.labels.begin());
  // A hole whose sides have a label of their own.
  if (const auto hole = std::ranges::find(shape.holes, word, &Loop::name); hole != shape.holes.end())
    return hole->sides[0].label;
  fail(field.node->position,
       fmt::format("{}: there is no label {}; {}", field.name, quote(word), suggest(word, shape.labels)));
}

std::vector<Index> find_labels(const Value& field, const Shape& shape) {
  const std::vector<Value> names = field.node->kind == Node::Kind::Array ? items(field, 1) : std::vector<Value>{field};
  std::vector<Index> labels;
  for (const Value& name : names) {
    labels.push_back(find_label(name, shape));
    if (std::count(labels.begin(), labels.end(), labels.back()) > 1)
      fail(name.node->position, fmt::format("{}: label {} appears twice", name.name, quote(text(name))));
  }
  return labels;
}

Definitions read_definitions(const Value& document, const Case& c) {
  Definitions out;
  out.context.young = c.young;
  out.context.poisson = c.poisson;
  const auto table = find_table(document, "define");
  if (!table) return out;
  constexpr std::size_t most = 1000;  // every evaluation may need them all
  if (table->node->entries.size() > most)
    fail(table->node->position, fmt::format("[define] holds at most {} names", most));
  for (const Entry& entry : table->node->entries) {
    const Value field = *find(*table, entry.key);
    // A number is a definition too.
    const bool is_number = field.node->kind == Node::Kind::Integer || field.node->kind == Node::Kind::Float;
    if (!is_number && field.node->kind != Node::Kind::String)
      fail(field.node->position, field.name + " must be a number or an expression in a string, \"1 + x\"");
    out.context.definitions.push_back({entry.key, is_number ? fmt::format("({})", number(field)) : text(field)});
    out.positions.push_back(entry.position);
    out.used.push_back(false);
  }
  // Each by itself, so that an error is found where it stands, whoever uses it.
  if (const auto wrong = wrong_definition(out.context))
    fail(out.positions[wrong->number],
         fmt::format("{} in [define]: {}", out.context.definitions[wrong->number].name, wrong->what));
  out.context.checked = true;
  return out;
}

void check_all_used(const Definitions& definitions) {
  for (std::size_t k = 0; k < definitions.used.size(); ++k)
    if (!definitions.used[k])
      fail(definitions.positions[k], fmt::format("unused key {} in [define]; use it in an expression or remove it",
                                                 quote(definitions.context.definitions[k].name)));
}

}  // namespace kerf
