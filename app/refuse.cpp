#include "app/refuse.hpp"

#include "solver/error_bars.hpp"
#include "solver/system.hpp"

#include <fmt/core.h>

namespace kerf {

void refuse_friction(const Shape& shape, const Scene& scene, const char* job, const char* table) {
  for (std::size_t k = 0; k < scene.laws.size(); ++k)
    if (has_friction(scene.laws[k]))
      throw Error(
          Fault::Usage,
          fmt::format("the {} needs cracks without friction: crack \"{}\" slides against it, and the state does not "
                      "minimize the energy; remove friction and tresca, or [{}] (kerf solve)",
                      job, shape.cracks[k].name, table));
}

void refuse_optimization(const Problem& problem, const std::string& method) {
  if (method != "level-set") return;
  refuse_friction(problem.frame, problem.scene, "level set", "optimize");
  for (const char* without : {"p1", "p2", "arnold-winther-c"})
    if (problem.element == without)
      throw Error(Fault::Usage, fmt::format("the level set needs derivatives, which element \"{}\" does not have; use "
                                            "\"bdms\" (default), or \"afw\"",
                                            problem.element));
}

void refuse_map(const Element& e, const MapRequest& request) {
  if (request.bounds && request.perturbation.kind != Perturbation::Kind::ClampedHole) better_element(e);
}

void refuse_validation(const Element& e) {
  const bool unseen = e.cut == Cut::LinearDivergence;  // some traces of its cubic edges are seen by no triangle
  if (!is_mixed(e) || per_vertex(e) > 0 || unseen)
    throw Error(
        Fault::Usage,
        fmt::format("validation condenses the body onto edges, which element \"{}\" does not allow; use \"bdms\" "
                    "(any degree), \"afw\" or \"arnold-winther-nc\"",
                    e.name));
}

}  // namespace kerf
