#pragma once
// Where the second term is known, and what is known of a logarithm in the series.

#include "kerf/second_order.hpp"
#include "topo/formulas/second_term.hpp"
#include "topo/map/point.hpp"

#include <utility>

namespace kerf {

/// Free holes and inclusions.
bool has_circle(const Perturbation& p);

/// Why what the body answers to a change cannot be solved for, or nothing.
std::string cannot_reply(const Model& m);

/// Why c2 is not known for this change of this J, or nothing.
std::string unknown_second_term(const Analysis& a, const Functional& j, const Perturbation& p);

/// The coefficient of eps^2 ln eps; `s` the state around the point, of circles. NaN where it is not known.
std::pair<Logarithm, double> logarithm(const Expansion& e, const PointValues& v, const TaylorField& s);

}  // namespace kerf
