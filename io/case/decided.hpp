#pragma once
// What ranges settle of conditions.

#include "io/case/syntax.hpp"

#include <optional>

namespace kerf {

/// Whether a number is not 0.
enum class Truth { No, Yes, Open };
inline Truth truth(const Interval& a) {
  if (is(a, 0)) return Truth::No;
  return contains(a, 0) ? Truth::Open : Truth::Yes;
}

/// Of a comparison of g with 0; nothing where some g of the range holds and some do not.
inline std::optional<bool> decided(SyntaxNode::Kind comparison, const Interval& g) {
  using Kind = SyntaxNode::Kind;
  switch (comparison) {
    case Kind::Less:
      if (g.high < 0 || g.low >= 0) return g.high < 0;
      break;
    case Kind::LessEqual:
      if (g.high <= 0 || g.low > 0) return g.high <= 0;
      break;
    case Kind::Greater:
      if (g.low > 0 || g.high <= 0) return g.low > 0;
      break;
    case Kind::GreaterEqual:
      if (g.low >= 0 || g.high < 0) return g.low >= 0;
      break;
    default:
      if (is(g, 0) || !contains(g, 0)) return is(g, 0) == (comparison == Kind::Equal);
  }
  return std::nullopt;
}

/// Of `first && second` or `first || second`; `second` is asked for where it is wanted.
template <typename Second>
Truth connected(bool both, Truth first, Second&& second) {
  const Truth settles = both ? Truth::No : Truth::Yes;
  if (first == settles) return settles;
  const Truth then = second();
  if (then == settles) return settles;
  return first == Truth::Open || then == Truth::Open ? Truth::Open : both ? Truth::Yes : Truth::No;
}

/// Powers that are products.
inline bool is_product(double exponent) {
  constexpr double most = 64;
  return exponent == std::floor(exponent) && std::abs(exponent) <= most;
}

}  // namespace kerf
