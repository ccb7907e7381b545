#pragma once
// A validation and an optimization as curves.

#include "io/result.hpp"
#include "plot/chart.hpp"
#include "plot/curves.hpp"

namespace kerf {

/// |remainder| (and, for a few points, |difference|) against the radius.
Chart validation_chart(const ValidationResult& result, const std::string& title);

/// Objective, bounded functionals and volume fraction against the iteration, state solves along the upper edge.
Curves history_curves(const OptimizeResult& result, const OptimizeNames& names, const std::string& title);

}  // namespace kerf
