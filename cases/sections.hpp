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

/// young and poisson of a table; refuses what no finite number describes.
Elastic read_elastic(const Field& table);
Material material(const Elastic& elastic, bool plane_strain, const Field& table);

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

/// [[probe]]; files lie relative to `folder`.
void read_probes(const Field& document, const std::filesystem::path& folder, Case& c);

}  // namespace kerf
