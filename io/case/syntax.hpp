#pragma once
// The syntax tree of an expression, and what it encloses. muParser is the judge of what an expression means; the tree
// says what can be proved of it.

#include "io/case/expression.hpp"
#include "io/case/taylor.hpp"

namespace kerf {

/// One operation; a node comes after those that it refers to.
struct SyntaxNode {
  enum class Kind {
    Constant,
    Variable,  // x, y, nx, ny by `argument`
    Negate,
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Less,  // of a difference, which is compared with 0
    LessEqual,
    Greater,
    GreaterEqual,
    Equal,
    NotEqual,
    And,
    Or,
    Choice,  // first ? second : third
    Call     // function `argument` of the table; min and max of two, and their difference
  } kind = Kind::Constant;
  double value = 0;
  int argument = 0;
  std::vector<int> of;
  bool operator==(const SyntaxNode&) const = default;
};

struct Syntax {
  std::vector<SyntaxNode> nodes;  // the last one is the expression
};

/// Names of definitions are replaced by what they stand for. Of an expression that parse_expression accepts; null
/// where it has something that the tree does not know.
std::shared_ptr<const Syntax> syntax_of(std::string_view text, const ExpressionContext& context);

/// One expression on a piece of an edge: as OnPiece, of a scalar.
struct ScalarOnPiece {
  Interval value = whole_line;
  double eighth = infinity;
  std::optional<Interval> cut;
  struct Parts {
    bool at_low_end;
    double exponent, regular_eighth, factor_eighth;
    std::function<std::pair<double, double>(double s)> at;
  };
  std::optional<Parts> power;
};
ScalarOnPiece enclose(const std::shared_ptr<const Syntax>& syntax, const EdgeLine& edge, double from, double to);
Interval enclose(const Syntax& syntax, const Interval& x, const Interval& y);
/// As Enclosure::deviation, of a scalar.
double deviation(const Syntax& syntax, const Interval& x, const Interval& y, int degree);
/// Degree of a polynomial in x and y (with normals as constants), or -1.
int degree_of(const Syntax& syntax);

}  // namespace kerf
