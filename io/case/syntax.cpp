// Syntax trees of expressions: recursive descent over muParser's grammar. From the weakest to the strongest binding
//   c ? a : b,  ||,  &&,  comparisons (all alike, from the left),  + -,  * /,  signs,  ^ (from the right),
// so that -x^2 is -(x^2) and x^-1 is allowed. Nodes are stored after those that they refer to; equal nodes are stored
// once (found by their hash), so that a part that appears twice, or a definition used in many places, is evaluated
// once, and x*x is seen as a square. A comparison becomes one of a difference with 0, min and max of many a chain of
// those of two with their difference beside them, sqrt a power: later stages know few cases. What the parser does not
// know gives no tree at all, and the data are sampled. The nodes are the inputs of enclose.cpp and deviation.cpp; the
// depth of recursion is bounded here, later stages use no recursion. docs/theory/data.md, "Enclosures".

#include "io/case/syntax.hpp"

#include "io/case/functions.hpp"
#include "io/words.hpp"

#include <fmt/format.h>

#include <charconv>
#include <unordered_map>

namespace kerf {

namespace {

using Kind = SyntaxNode::Kind;

/// What the parser meets and does not know: the tree is given up.
struct Unknown {};

struct NodeHash {
  std::size_t operator()(const SyntaxNode& n) const {
    std::size_t sum = static_cast<std::size_t>(n.kind) * 64 + static_cast<std::size_t>(n.argument);
    const auto mix = [&](std::size_t more) { sum = (sum ^ more) * 0x9E3779B97F4A7C15u + (sum >> 29); };
    mix(std::hash<double>()(n.value));
    for (const int k : n.of) mix(static_cast<std::size_t>(k));
    return sum;
  }
};

/// Recursive descent over muParser's grammar: ?: binds least, then ||, &&, comparisons (all alike, from the left), + -,
/// * /, signs, ^ (from the right).
class Descent {
 public:
  Descent(Syntax& out, const ExpressionContext& context) : out_(out), context_(context) {}

  /// From now on the name stands for what the text says.
  void define(const std::string& name, std::string_view text) {
    const int root = parse(text);
    definitions_.try_emplace(name, root);
  }

  int parse(std::string_view text) {
    text_ = text;
    at_ = 0;
    depth_ = 0;
    const int root = choice();
    skip();
    if (at_ != text_.size()) throw Unknown();
    return root;
  }

 private:
  /// What was met before is the same node, which is evaluated once.
  int add(SyntaxNode node) {
    const auto [found, is_new] = known_.try_emplace(node, static_cast<int>(out_.nodes.size()));
    if (is_new) out_.nodes.push_back(std::move(node));
    return found->second;
  }
  /// One level of recursion, which is refused beyond what the stack surely holds.
  class Level {
   public:
    explicit Level(Descent& descent) : depth_(descent.depth_) {
      constexpr int most = 2000;  // 1,000 parentheses: an expression in them, and its first operand
      if (++depth_ > most) descent.refuse_depth();
    }
    Level(const Level&) = delete;
    Level& operator=(const Level&) = delete;
    ~Level() {
      --depth_;
    }

   private:
    int& depth_;
  };
  [[noreturn]] void refuse_depth() const {
    throw Error(Fault::Usage, fmt::format("expression {}, column {}: too many operations lie within each other; name "
                                          "parts of it in [define]",
                                          quote(text_), at_ + 1));
  }
  void skip() {
    while (at_ < text_.size() && std::string_view(" \t\n\r").find(text_[at_]) != std::string_view::npos) ++at_;
  }
  bool take(std::string_view word) {
    skip();
    if (text_.substr(at_, word.size()) != word) return false;
    at_ += word.size();
    return true;
  }

  int choice() {
    const Level level(*this);
    const int condition = disjunction();
    if (!take("?")) return condition;
    const int yes = choice();
    if (!take(":")) throw Unknown();
    const int no = choice();
    return add({.kind = Kind::Choice, .of = {condition, yes, no}});
  }
  int disjunction() {
    int left = conjunction();
    while (take("||")) {
      const int right = conjunction();
      left = add({.kind = Kind::Or, .of = {left, right}});
    }
    return left;
  }
  int conjunction() {
    int left = comparison();
    while (take("&&")) {
      const int right = comparison();
      left = add({.kind = Kind::And, .of = {left, right}});
    }
    return left;
  }
  int comparison() {
    static const std::vector<std::pair<std::string_view, Kind>> signs = {
        {"<=", Kind::LessEqual}, {">=", Kind::GreaterEqual}, {"==", Kind::Equal},
        {"!=", Kind::NotEqual},  {"<", Kind::Less},          {">", Kind::Greater}};
    int left = sum();
    for (bool more = true; more;) {
      more = false;
      for (const auto& [sign, kind] : signs) {
        if (!take(sign)) continue;
        const int right = sum();
        left = add({.kind = kind, .of = {add({.kind = Kind::Subtract, .of = {left, right}})}});
        more = true;
        break;
      }
    }
    return left;
  }
  int sum() {
    int left = product();
    while (true) {
      const Kind kind = take("+") ? Kind::Add : take("-") ? Kind::Subtract : Kind::Constant;
      if (kind == Kind::Constant) return left;
      const int right = product();
      left = add({.kind = kind, .of = {left, right}});
    }
  }
  int product() {
    int left = sign();
    while (true) {
      const Kind kind = take("*") ? Kind::Multiply : take("/") ? Kind::Divide : Kind::Constant;
      if (kind == Kind::Constant) return left;
      const int right = sign();
      left = add({.kind = kind, .of = {left, right}});
    }
  }
  int sign() {
    const Level level(*this);
    if (take("+")) return sign();
    if (take("-")) return add({.kind = Kind::Negate, .of = {sign()}});
    return power();
  }
  int power() {
    const int base = primary();
    if (!take("^")) return base;
    const int exponent = sign();
    return add({.kind = Kind::Power, .of = {base, exponent}});
  }
  int primary() {
    if (take("(")) {
      const int inside = choice();
      if (!take(")")) throw Unknown();
      return inside;
    }
    skip();
    double value = 0;
    const char first = at_ < text_.size() ? text_[at_] : '\0';
    const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (error == std::errc() && ((first >= '0' && first <= '9') || first == '.')) {
      at_ = static_cast<std::size_t>(end - text_.data());
      return add({.kind = Kind::Constant, .value = value});
    }
    return name();
  }
  int name() {
    const std::size_t start = at_;
    const auto letter = [&](std::size_t k) {
      const char c = k < text_.size() ? text_[k] : '\0';
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || (c >= '0' && c <= '9');
    };
    while (letter(at_)) ++at_;
    const std::string word(text_.substr(start, at_ - start));
    if (take("(")) return call(word);
    static const std::vector<std::string> variables = {"x", "y", "nx", "ny"};
    for (std::size_t k = 0; k < variables.size(); ++k)
      if (word == variables[k]) return add({.kind = Kind::Variable, .argument = static_cast<int>(k)});
    if (word == "pi") return add({.kind = Kind::Constant, .value = pi});
    if (word == "E") return add({.kind = Kind::Constant, .value = context_.young});
    if (word == "nu") return add({.kind = Kind::Constant, .value = context_.poisson});
    return definition(word);
  }
  int call(const std::string& word) {
    std::vector<int> arguments;
    do arguments.push_back(choice());
    while (take(","));
    if (!take(")")) throw Unknown();
    if (word == "sqrt" && arguments.size() == 1)
      return add({.kind = Kind::Power, .of = {arguments[0], add({.kind = Kind::Constant, .value = 0.5})}});
    const int function = function_called(word);
    if (function < 0) throw Unknown();
    if (!takes_arguments(function, arguments.size())) throw Unknown();
    if (breaking(function) == Breaking::Min || breaking(function) == Breaking::Max) {
      int least = arguments[0];
      for (std::size_t k = 1; k < arguments.size(); ++k) {
        const int difference = add({.kind = Kind::Subtract, .of = {least, arguments[k]}});
        least = add({.kind = Kind::Call, .argument = function, .of = {least, arguments[k], difference}});
      }
      return least;
    }
    return add({.kind = Kind::Call, .argument = function, .of = std::move(arguments)});
  }
  int definition(const std::string& word) const {
    const auto found = definitions_.find(word);
    if (found == definitions_.end()) throw Unknown();
    return found->second;
  }

  Syntax& out_;
  const ExpressionContext& context_;
  std::unordered_map<std::string, int> definitions_;
  std::unordered_map<SyntaxNode, int, NodeHash> known_;
  std::string_view text_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

/// The degree in x and y as far as the form of the tree shows it; -1: no polynomial. Terms that cancel are not seen.
int degree_of(const SyntaxNode& n, const std::vector<int>& degrees, const Syntax& s) {
  const auto degree = [&](int k) { return degrees[n.of[k]]; };
  switch (n.kind) {
    case Kind::Constant:
      return 0;
    case Kind::Variable:
      return n.argument < 2 ? 1 : 0;
    case Kind::Negate:
      return degree(0);
    case Kind::Add:
    case Kind::Subtract:
      return degree(0) < 0 || degree(1) < 0 ? -1 : std::max(degree(0), degree(1));
    case Kind::Multiply:
      return degree(0) < 0 || degree(1) < 0 ? -1 : degree(0) + degree(1);
    case Kind::Divide:
      return degree(0) < 0 || degree(1) != 0 ? -1 : degree(0);
    case Kind::Power: {
      const SyntaxNode& exponent = s.nodes[n.of[1]];
      if (degree(0) == 0 && degree(1) == 0) return 0;
      if (degree(0) < 0 || exponent.kind != Kind::Constant || exponent.value < 0 || exponent.value > 16 ||
          exponent.value != std::floor(exponent.value))
        return -1;
      return degree(0) * static_cast<int>(exponent.value);
    }
    default:
      for (const int k : n.of)
        if (degrees[k] != 0) return -1;
      return 0;
  }
}

}  // namespace

std::shared_ptr<const Syntax> syntax_of(std::string_view text, const ExpressionContext& context) {
  auto syntax = std::make_shared<Syntax>();
  try {
    Descent descent(*syntax, context);
    // In their order: a definition uses those before it.
    for (const std::size_t k : definitions_under(text, context))
      descent.define(context.definitions[k].name, context.definitions[k].text);
    const int root = descent.parse(text);
    // Of a name alone the node may lie anywhere.
    if (root + 1 != static_cast<int>(syntax->nodes.size()))
      syntax->nodes.push_back({.kind = Kind::Call, .argument = function_called("sum"), .of = {root}});
  } catch (const Unknown&) {
    return nullptr;
  }
  return syntax;
}

int degree_of(const Syntax& s) {
  std::vector<int> degrees;
  for (const SyntaxNode& n : s.nodes) {
    degrees.push_back(degree_of(n, degrees, s));
    // Repeated squaring of definitions would overflow an int.
    if (degrees.back() > 1000) degrees.back() = -1;
  }
  return degrees.back();
}

}  // namespace kerf
