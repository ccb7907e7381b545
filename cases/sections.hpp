#pragma once
// The sections of a case file, each read by one function. Which keys exist is said here and nowhere else.

#include "cases/case.hpp"
#include "cases/expression.hpp"
#include "cases/fields.hpp"

namespace kerf {

/// [domain], [[hole]], [[crack]]. Labels: those of the sides in order of appearance, then "hole:<name>" per hole.
void read_shape(const Field& document, Case& c);

/// [[region]], in the plane state that [material] has.
void read_regions(const Field& document, Case& c);

/// [define]: the named subexpressions, each checked, and which of them have been used.
struct Definitions {
  ExpressionContext context;
  std::vector<Position> positions;
  std::vector<bool> used;
};
Definitions read_definitions(const Field& document, const Case& c);
void check_all_used(const Definitions& definitions);

/// [[boundary]] and [body].
void read_conditions(const Field& document, Definitions& definitions, Case& c);

/// [functional]: the energy when there is no table. Files lie relative to `folder`. After the conditions.
void read_functional(const Field& document, const std::filesystem::path& folder, Definitions& definitions, Case& c);

/// [map] and [validate].
void read_map(const Field& document, Case& c);

/// The material of a table with young and poisson, which fails there when it is out of the range of numbers.
Material elastic(const Field& table, double young, double poisson, bool in_plane_strain);

/// [[probe]]; files lie relative to `folder`.
void read_probes(const Field& document, const std::filesystem::path& folder, Case& c);

}  // namespace kerf
