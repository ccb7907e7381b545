#pragma once
// Values that may vary over the body, and labels: what conditions and functionals have in common.

#include "io/case/sections.hpp"
#include "io/case/syntax.hpp"

#include <array>

namespace kerf {

/// A number or an expression, ready to be evaluated; what it throws then names its place in the file. `constant` when
/// it is the same everywhere.
struct Formula {
  Expression value;
  std::optional<double> constant;
  std::shared_ptr<const Syntax> syntax;             // what can be proved of it, if anything
  std::shared_ptr<const PairExpression> pair = {};  // of a component: what gives both at once
};
/// Counts the definitions it refers to as used. `on_boundary`: nx and ny have a meaning.
Formula formula(const Value& field, Definitions& definitions, bool on_boundary = true);
std::array<Formula, 2> formulas(const Value& field, Definitions& definitions, bool on_boundary = true);

/// The formula 0.
Formula nothing();

/// Fields of formulas, with what is proved of them.
BoundaryField vector_field(const Formula& first, const Formula& second);
VectorField body_field(const Formula& first, const Formula& second);
BoundaryField pressure_field(const Formula& pressure);          // -p n
BoundaryField without_normal_part(const BoundaryField& field);  // t - (t.n) n
BoundaryField without_component(const BoundaryField& field, int component);
BoundaryField scaled_load(const BoundaryField& field, double factor);

/// Labels by what the file calls them: "top", "hole:h1", and "h1" for a hole when no side has that name.
Index find_label(const Value& field, const Shape& shape);
/// A label or a list of at least one, each once.
std::vector<Index> find_labels(const Value& field, const Shape& shape);

}  // namespace kerf
