// Load cases in the order of their names: sums do not depend on the order of the tables in a case file.

#include "optimize/load_cases.hpp"

#include <algorithm>

namespace kerf {

std::vector<LoadCase> by_name(std::vector<LoadCase> cases) {
  std::ranges::stable_sort(cases, {}, &LoadCase::name);
  return cases;
}

const LoadCase& shown(const std::vector<LoadCase>& cases) {
  return *std::ranges::min_element(cases, {}, &LoadCase::name);
}

OptimizeRequest in_order(OptimizeRequest request) {
  request.load_cases = by_name(std::move(request.load_cases));
  return request;
}

}  // namespace kerf
