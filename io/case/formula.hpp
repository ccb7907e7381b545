#pragma once
// Values that may vary over the body, and labels: what conditions and functionals have in common.

#include "io/case/sections.hpp"

#include <array>

namespace kerf {

/// A number or an expression, ready to be evaluated; what it throws then names its place in the file. `constant` when
/// it is the same everywhere.
struct Formula {
  Expression value;
  std::optional<double> constant;
};
/// Counts the definitions it refers to as used. `on_boundary`: nx and ny have a meaning.
Formula formula(const Value& field, Definitions& definitions, bool on_boundary = true);
std::array<Formula, 2> formulas(const Value& field, Definitions& definitions, bool on_boundary = true);

BoundaryField vector_field(const Expression& first, const Expression& second);

/// Labels by what the file calls them: "top", "hole:h1", and "h1" for a hole when no side has that name.
Index find_label(const Value& field, const Shape& shape);
/// A label or a list of at least one, each once.
std::vector<Index> find_labels(const Value& field, const Shape& shape);

}  // namespace kerf
