// Refusals: which expansions are not known where some of the body is orthotropic (docs/theory/orthotropic.md, "Free
// holes").

#include "topo/orthotropic.hpp"

#include "topo/formulas/kind.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace kerf {

bool has_orthotropic(const Scene& scene) {
  return std::ranges::any_of(all_materials(scene), [](const Material& m) { return !isotropic(m); });
}

// Free holes are known for all functionals but those of the stress itself.
std::optional<std::string> unknown_expansion(const Scene& scene, const Functional& j, const Perturbation& p) {
  if (!has_orthotropic(scene)) return std::nullopt;
  if (row(p).becomes != Becomes::Nothing)
    return fmt::format(
        "the perturbation \"{}\" in an orthotropic body: its expansion is known for isotropic materials only; use a "
        "free hole, circular or elliptic, or give young one number",
        row(p).word);
  for (const Term& term : j.terms)
    if (term.stress_power > 0)
      return fmt::format(
          "functional \"{}\" in an orthotropic body: what the stress around a hole does to it is known for isotropic "
          "materials only; use another functional, or give young one number",
          term.kind);
  return std::nullopt;
}

void require_expansion(const Scene& scene, const Functional& j, const Perturbation& p) {
  if (const auto why = unknown_expansion(scene, j, p)) throw Error(Fault::Usage, *why);
}

void require_isotropic(const Scene& scene, const char* what) {
  if (has_orthotropic(scene))
    throw Error(Fault::Usage,
                fmt::format("{} in an orthotropic body are not known; they are for isotropic materials only", what));
}

}  // namespace kerf
