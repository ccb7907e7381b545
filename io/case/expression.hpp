#pragma once
// "1 + x", "x > 0 ? sin(pi*y) : 0" -> a function of (x, y, nx, ny). muParser lives in expression.cpp and nowhere else.

#include "kerf/types.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace kerf {

using Expression = std::function<double(const Vec2& x, const Vec2& n)>;
/// Both components of a vector at once.
using PairExpression = std::function<Vec2(const Vec2& x, const Vec2& n)>;

/// A named subexpression of [define]; may use the ones before it.
struct Definition {
  std::string name;
  std::string text;
};

/// Variables x, y, nx, ny; constants pi, E, nu; functions as docs/case-files/index.md lists them (log is natural). The
/// result may be called from several threads at once. Throws Error(Usage): what is wrong, the column in the expression,
/// what would be right. The result throws Error(Usage) with the expression and the point where its value is not finite;
/// values of definitions in between may be infinite or NaN, so that a branch not taken does no harm.
struct ExpressionContext {
  std::vector<Definition> definitions;
  double young = 0, poisson = 0;
  bool on_boundary = true;  // else nx and ny are no names: there is no normal
  bool checked = false;     // the definitions, by wrong_definition(), for a boundary
};
Expression parse_expression(std::string_view text, const ExpressionContext& context);

/// The first definition that is wrong by itself, whoever uses it, and why, as parse_expression says it.
struct WrongDefinition {
  std::size_t number;
  std::string what;
};
std::optional<WrongDefinition> wrong_definition(const ExpressionContext& context);

/// The names that an expression refers to (functions left out), each once, in order.
std::vector<std::string> names_in(std::string_view text);

/// The definitions that an expression needs, directly or not, in their order.
std::vector<std::size_t> definitions_under(std::string_view text, const ExpressionContext& context);

}  // namespace kerf
