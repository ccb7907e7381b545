// Expressions in x, y, nx, ny by muParser, and nothing else of muParser. A text is scanned before muParser sees it:
// assignments, strings and operators that muParser has and kerf does not are refused with their column, and so are
// names that nobody defined. What is accepted is evaluated with the definitions of [define] that it needs, directly or
// not, each once per point and in their order. A parser keeps its variables by address and its stack within: an
// evaluator serves one caller at a time. A pool holds those at rest, in 64 slots of a cache line each; taking one out
// is one atomic exchange, and a lock is needed only to make a new one. A value that is not finite at the end is an
// error with the point; in a definition it is none, since the branch that has it may not be taken. An expression
// without x, y, nx, ny is evaluated once. docs/case-files/index.md lists the functions.

#include "io/case/expression.hpp"

#include "io/words.hpp"

#include <fmt/format.h>
#include <muParser.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <span>
#include <thread>
#include <unordered_map>
#include <unordered_set>

namespace kerf {

namespace {

[[noreturn]] void fail(std::string_view text, std::size_t column, const std::string& what) {
  throw Error(Fault::Usage, fmt::format("expression {}, column {}: {}", quote(text), column, what));
}

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

struct Name {
  std::string text;
  std::size_t column;  // from 1
  bool called;         // an opening parenthesis follows
};

/// The names of an expression. Refuses what muParser would take in another sense than the user's: assignments, strings,
/// postfix and infix operators of its own, numbers beyond the range of double.
std::vector<Name> scan(std::string_view text) {
  std::vector<Name> names;
  const auto at = [&](std::size_t k) { return k < text.size() ? text[k] : '\0'; };
  for (std::size_t k = 0; k < text.size();) {
    const char c = text[k];
    if (is_letter(c)) {
      std::size_t end = k;
      while (is_letter(at(end)) || is_digit(at(end))) ++end;
      std::size_t next = end;
      while (is_space(at(next))) ++next;
      names.push_back({std::string(text.substr(k, end - k)), k + 1, at(next) == '('});
      k = end;
    } else if (is_digit(c) || (c == '.' && is_digit(at(k + 1)))) {
      double value = 0;
      const auto [end, error] = std::from_chars(text.data() + k, text.data() + text.size(), value);
      if (error != std::errc()) fail(text, k + 1, "the number does not fit a double");
      k = static_cast<std::size_t>(end - text.data());
    } else if (std::string_view("=<>!&|").find(c) != std::string_view::npos) {
      const char next = at(k + 1);
      const bool pair = ((c == '&' || c == '|') && next == c) || (c != '&' && c != '|' && next == '=');
      if (!pair && c == '=') fail(text, k + 1, "an expression cannot assign; write == to compare");
      if (!pair && c != '<' && c != '>')
        fail(text, k + 1, fmt::format("unexpected {}; write && || != == < > <= >=", quote({&c, 1})));
      k += pair ? 2 : 1;
    } else if (is_space(c) || std::string_view("+-*/^(),?:").find(c) != std::string_view::npos) {
      ++k;
    } else {
      std::size_t end = k + 1;  // the whole character, if it is not ASCII
      while ((static_cast<unsigned char>(at(end)) & 0xC0) == 0x80) ++end;
      fail(text, k + 1, fmt::format("unexpected character {}", quote(text.substr(k, end - k))));
    }
  }
  return names;
}

std::string explain(const mu::ParserError& e) {
  const std::string token = quote(e.GetToken());
  switch (e.GetCode()) {
    case mu::ecUNEXPECTED_EOF:
      return "the expression ends too early; a value is missing";
    case mu::ecMISSING_PARENS:
      return "a closing parenthesis is missing";
    case mu::ecUNEXPECTED_PARENS:
      return fmt::format("unexpected parenthesis {}", token);
    case mu::ecUNEXPECTED_OPERATOR:
      if (e.GetExpr().find("**") != std::string::npos) return "** is no operator; write powers as x^2";
      return fmt::format("unexpected operator {}; a value is missing before it", token);
    case mu::ecUNEXPECTED_VAR:
    case mu::ecUNEXPECTED_VAL:
    case mu::ecUNEXPECTED_FUN:
      return fmt::format("unexpected {}; an operator such as * is missing before it", token);
    case mu::ecUNEXPECTED_ARG_SEP:
    case mu::ecUNEXPECTED_ARG:
      return "unexpected comma; numbers are written with a point";
    case mu::ecTOO_MANY_PARAMS:
      return fmt::format("too many arguments for {}", token);
    case mu::ecTOO_FEW_PARAMS:
      return fmt::format("too few arguments for {}", token);
    case mu::ecMISSING_ELSE_CLAUSE:
      return "a condition lacks its other branch; write c ? a : b";
    case mu::ecUNEXPECTED_CONDITIONAL:
    case mu::ecMISPLACED_COLON:
      return "misplaced ? or :; write c ? a : b";
    case mu::ecEXPRESSION_TOO_LONG:
      return "the expression is too long; name its parts in [define]";
    default:
      return e.GetMsg();
  }
}

// muParser's own min, max and sign turn NaN into a number.
double smallest(const double* values, int count) {
  double out = values[0];
  for (int k = 1; k < count; ++k) out = std::isnan(values[k]) || values[k] < out ? values[k] : out;
  return out;
}
double largest(const double* values, int count) {
  double out = values[0];
  for (int k = 1; k < count; ++k) out = std::isnan(values[k]) || values[k] > out ? values[k] : out;
  return out;
}
double sign(double value) {
  return std::isnan(value) ? value : (value > 0) - (value < 0);
}

/// What an expression needs to be evaluated: itself and the definitions under it, in order.
struct Program {
  std::string text;
  std::vector<Definition> definitions;
  double young, poisson;
};

/// muParser reads variables through pointers and keeps its stack in the parser: an evaluator serves one caller at a
/// time and stays where it is.
struct Evaluator {
  double x = 0, y = 0, nx = 0, ny = 0;
  std::map<std::string, double> values;  // of the definitions
  std::vector<std::pair<double*, mu::Parser>> steps;
  mu::Parser last;

  explicit Evaluator(const Program& program) {
    steps.reserve(program.definitions.size());
    for (const Definition& d : program.definitions) {
      double* value = &values[d.name];
      steps.emplace_back(value, prepare(d.text, program));
      *value = steps.back().second.Eval();
    }
    last = prepare(program.text, program);
    last.Eval();  // compiles
  }
  Evaluator(const Evaluator&) = delete;
  Evaluator& operator=(const Evaluator&) = delete;

  mu::Parser prepare(const std::string& text, const Program& program) {
    mu::Parser parser;
    parser.ClearConst();
    parser.DefineFun("min", smallest);
    parser.DefineFun("max", largest);
    parser.DefineFun("sign", sign);
    parser.DefineConst("pi", 3.14159265358979323846);
    parser.DefineConst("E", program.young);
    parser.DefineConst("nu", program.poisson);
    parser.DefineVar("x", &x);
    parser.DefineVar("y", &y);
    parser.DefineVar("nx", &nx);
    parser.DefineVar("ny", &ny);
    for (const std::string& name : names_in(text))
      if (const auto found = values.find(name); found != values.end()) parser.DefineVar(name, &found->second);
    std::string line = text;
    std::replace_if(line.begin(), line.end(), is_space, ' ');
    parser.SetExpr(line);
    return parser;
  }

  double operator()(const Vec2& at, const Vec2& normal) {
    x = at.x();
    y = at.y();
    nx = normal.x();
    ny = normal.y();
    for (auto& [value, parser] : steps) *value = parser.Eval();
    return last.Eval();
  }
};

/// Evaluators at rest. A caller takes one out, or makes one when all are taken, and puts it back.
class Pool {
 public:
  explicit Pool(Program program) : program_(std::move(program)) {}
  Pool(const Pool&) = delete;
  Pool& operator=(const Pool&) = delete;
  ~Pool() {
    for (Slot& slot : slots_) delete slot.idle.load();
  }

  const Program& program() const {
    return program_;
  }

  double evaluate(const Vec2& x, const Vec2& n) {
    // Threads start looking at different slots, so that each finds its own evaluator and no two share a cache line.
    const std::size_t home = std::hash<std::thread::id>()(std::this_thread::get_id());
    std::unique_ptr<Evaluator> evaluator = take(home);
    const double value = (*evaluator)(x, n);
    put_back(home, std::move(evaluator));
    return value;
  }

 private:
  struct alignas(64) Slot {
    std::atomic<Evaluator*> idle = nullptr;
  };

  std::unique_ptr<Evaluator> take(std::size_t home) {
    for (std::size_t k = 0; k < slots_.size(); ++k) {
      std::atomic<Evaluator*>& idle = slots_[(home + k) % slots_.size()].idle;
      if (idle.load(std::memory_order_relaxed) == nullptr) continue;
      if (Evaluator* found = idle.exchange(nullptr, std::memory_order_acquire))
        return std::unique_ptr<Evaluator>(found);
    }
    const std::lock_guard lock(making_);
    return std::make_unique<Evaluator>(program_);
  }

  void put_back(std::size_t home, std::unique_ptr<Evaluator> evaluator) {
    for (std::size_t k = 0; k < slots_.size(); ++k) {
      Evaluator* expected = nullptr;
      if (slots_[(home + k) % slots_.size()].idle.compare_exchange_strong(
              expected, evaluator.get(), std::memory_order_release, std::memory_order_relaxed)) {
        evaluator.release();
        return;
      }
    }
  }

  Program program_;
  std::array<Slot, 64> slots_;
  std::mutex making_;
};

const std::vector<std::string>& variables() {
  static const std::vector<std::string> names = {"x", "y", "nx", "ny"};
  return names;
}
const std::vector<std::string>& constants() {
  static const std::vector<std::string> names = {"pi", "E", "nu"};
  return names;
}
const std::vector<std::string>& functions() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> found;
    const mu::Parser parser;
    for (const auto& [name, callback] : parser.GetFunDef()) found.push_back(name);
    return found;
  }();
  return names;
}
/// The definitions of a context by their names.
using ByName = std::unordered_map<std::string_view, std::size_t>;
ByName by_name(const ExpressionContext& context) {
  ByName out;
  for (std::size_t k = 0; k < context.definitions.size(); ++k) out.try_emplace(context.definitions[k].name, k);
  return out;
}

/// Checks every name of `text`; `definitions[0 .. count)` are the ones it may use.
void check_names(std::string_view text, const ExpressionContext& context, const ByName& defined, std::size_t count) {
  std::vector<std::string> known = variables();
  if (!context.on_boundary) known.resize(2);
  known.insert(known.end(), constants().begin(), constants().end());
  const auto is_known = [&](const std::string& name) {
    const auto found = defined.find(name);
    return (found != defined.end() && found->second < count) || contains(known, name);
  };
  for (const Name& name : scan(text)) {
    if (name.called) {
      if (contains(functions(), name.text)) continue;
      if (is_known(name.text)) fail(text, name.column, fmt::format("{} is not a function", quote(name.text)));
      fail(text, name.column,
           fmt::format("unknown function {}; {}", quote(name.text), suggest(name.text, functions())));
    }
    if (is_known(name.text)) continue;
    if (contains(functions(), name.text))
      fail(text, name.column, fmt::format("the function {0} needs an argument, {0}(...)", name.text));
    if (contains(variables(), name.text))
      fail(text, name.column,
           fmt::format("{} has no meaning here: there is no normal inside the body", quote(name.text)));
    if (defined.contains(name.text))
      fail(text, name.column,
           fmt::format("{} is defined here or later; a definition may use only those before it", quote(name.text)));
    for (std::size_t k = 0; k < count; ++k) known.push_back(context.definitions[k].name);
    fail(text, name.column, fmt::format("unknown name {}; {}", quote(name.text), suggest(name.text, known)));
  }
}

void check_syntax(const std::string& text, const ExpressionContext& context) {
  if (std::all_of(text.begin(), text.end(), is_space))
    throw Error(Fault::Usage, "the expression is empty; write a number or a formula in x, y");
  constexpr std::size_t longest = 10000;  // muParser's own limits give no usable message
  if (text.size() > longest)
    throw Error(Fault::Usage,
                fmt::format("the expression has {} characters; at most {} are read: split it with [define]",
                            text.size(), longest));
  Evaluator probe({"0", {}, context.young, context.poisson});
  for (const std::string& name : names_in(text))
    if (!contains(variables(), name) && !contains(constants(), name)) probe.values[name] = 1;
  mu::Parser parser = probe.prepare(text, {text, {}, context.young, context.poisson});
  try {
    int results = 0;
    parser.Eval(results);
    if (results != 1) fail(text, text.find(',') + 1, "more than one value; numbers are written with a point");
  } catch (const mu::ParserError& e) {
    const int after = e.GetCode() == mu::ecMISPLACED_COLON ? 0 : 1;  // that of a colon is where muParser goes on
    const auto column = static_cast<std::size_t>(std::max(e.GetPos() + after, 1));
    fail(text, std::min(column, text.size() + 1), explain(e));
  }
}

/// The definitions that an expression needs, directly or not, in order, and whether anything depends on the point.
struct Reach {
  std::vector<std::size_t> definitions;
  bool varies = false;
};
Reach reach_of(std::string_view text, const ExpressionContext& context, std::size_t count) {
  Reach reach;
  std::unordered_set<std::string> names;
  const auto add = [&](std::string_view more) {
    for (std::string& name : names_in(more)) names.insert(std::move(name));
  };
  add(text);
  for (std::size_t k = count; k-- > 0;) {
    if (!names.contains(context.definitions[k].name)) continue;
    reach.definitions.push_back(k);
    add(context.definitions[k].text);
  }
  std::ranges::reverse(reach.definitions);
  reach.varies = std::ranges::any_of(variables(), [&](const std::string& name) { return names.contains(name); });
  return reach;
}

Program program_of(const std::string& text, const ExpressionContext& context, const Reach& reach) {
  Program program{text, {}, context.young, context.poisson};
  for (const std::size_t k : reach.definitions) program.definitions.push_back(context.definitions[k]);
  return program;
}

void check_definition_name(const ExpressionContext& context, const ByName& defined, std::size_t k) {
  const std::string& name = context.definitions[k].name;
  const auto refuse = [&](const std::string& why) {
    throw Error(Fault::Usage, fmt::format("definition {}: {}", quote(name), why));
  };
  if (name.empty() || name.size() > 100 || !is_letter(name[0]) ||
      !std::all_of(name.begin(), name.end(), [](char c) { return is_letter(c) || is_digit(c); }))
    refuse("a name is made of letters, digits and _, and does not begin with a digit");
  if (contains(variables(), name) || contains(constants(), name) || contains(functions(), name))
    refuse("the name is taken; choose another");
  if (defined.at(name) < k) refuse("defined twice");
}

/// Looks at definitions by themselves, in their order; those that they use are among them. Constants are finite.
std::optional<WrongDefinition> wrong_among(const ExpressionContext& context, std::span<const std::size_t> which,
                                           const ByName& defined) {
  std::unordered_set<std::string_view> varying(variables().begin(), variables().end());
  Evaluator constants({"0", {}, context.young, context.poisson});
  for (const std::size_t k : which) try {
      const Definition& d = context.definitions[k];
      check_definition_name(context, defined, k);
      check_names(d.text, context, defined, k);
      check_syntax(d.text, context);
      if (std::ranges::any_of(names_in(d.text), [&](const std::string& name) { return varying.contains(name); })) {
        varying.insert(d.name);
        continue;
      }
      const double value = constants.prepare(d.text, {"", {}, context.young, context.poisson}).Eval();
      if (!std::isfinite(value)) fail(d.text, 1, fmt::format("the value is not finite ({})", value));
      constants.values[d.name] = value;
    } catch (const Error& error) {
      return WrongDefinition{k, error.what()};
    }
  return std::nullopt;
}

}  // namespace

std::vector<std::string> names_in(std::string_view text) {
  std::vector<std::string> names;
  std::unordered_set<std::string> met;
  for (Name& name : scan(text))
    if (!name.called && met.insert(name.text).second) names.push_back(std::move(name.text));
  return names;
}

std::vector<std::size_t> definitions_under(std::string_view text, const ExpressionContext& context) {
  return reach_of(text, context, context.definitions.size()).definitions;
}

std::optional<WrongDefinition> wrong_definition(const ExpressionContext& context) {
  std::vector<std::size_t> all(context.definitions.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return wrong_among(context, all, by_name(context));
}

Expression parse_expression(std::string_view view, const ExpressionContext& context) {
  const std::string text(view);
  const ByName defined = by_name(context);
  check_names(text, context, defined, context.definitions.size());
  check_syntax(text, context);
  const Reach reach = reach_of(text, context, context.definitions.size());
  if (context.checked)
    for (const std::size_t k : reach.definitions) check_names(context.definitions[k].text, context, defined, k);
  else if (const auto wrong = wrong_among(context, reach.definitions, defined))
    throw Error(Fault::Usage, wrong->what);
  const auto pool = std::make_shared<Pool>(program_of(text, context, reach));
  if (!reach.varies) {
    const double value = pool->evaluate(Vec2::Zero(), Vec2::Zero());
    if (!std::isfinite(value))
      fail(text, 1, fmt::format("the value is not finite ({}); a constant must be a number", value));
    return [value](const Vec2&, const Vec2&) { return value; };
  }
  return [pool](const Vec2& x, const Vec2& n) {
    const double value = pool->evaluate(x, n);
    if (!std::isfinite(value))
      throw Error(Fault::Usage,
                  fmt::format("expression {} is not finite ({}) at ({:.6g}, {:.6g}); it must have a value "
                              "wherever it is applied",
                              quote(pool->program().text), value, x.x(), x.y()));
    return value;
  };
}

}  // namespace kerf
