// What a job cannot do for a case, said with the place in its file before anything is solved.

#include "app/command/refuse.hpp"

#include "optimize/refuse.hpp"
#include "topo/orthotropic.hpp"

#include <fmt/format.h>

namespace kerf {

void refuse_optimization(const Case& c) {
  std::vector<std::string> lines;
  for (const Wrong& wrong : find_wrong(problem_of(c), *c.optimize))
    lines.push_back(fmt::format("{}: {}", place_of(c, wrong.key), wrong.what));
  if (!lines.empty()) throw Error(Fault::Usage, fmt::format("{}", fmt::join(lines, "\n")));
  if (!c.mesh) require_drawable(c.shape);
}

void refuse_map(const Element& e, const MapRequest& request) {
  if (request.bounds && has_series(request.perturbation)) require(e, can_be_bettered);
}

void refuse_orthotropic(const Case& c) {
  const auto why = unknown_expansion(c.scene, c.functional, c.map_request.perturbation);
  if (why)
    throw Error(Fault::Usage, fmt::format("{}: {}", place_of(c, c.orthotropy ? "material.young" : "region"), *why));
}

void refuse_validation(const Element& e) {
  require(e, can_validate);
}

}  // namespace kerf
