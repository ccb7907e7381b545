#pragma once
// What is known of changes of an orthotropic body.

#include "kerf/functional.hpp"

#include <optional>
#include <string>

namespace kerf {

/// Whether the body or a region of it is orthotropic.
bool has_orthotropic(const Scene& scene);

/// Why the expansion of J for this change is not known where some of the body is orthotropic, or nothing: only that for
/// free holes is, in J that see the stress by the adjoint alone.
std::optional<std::string> unknown_expansion(const Scene& scene, const Functional& j, const Perturbation& p);

/// Throws Error(Usage) with it.
void require_expansion(const Scene& scene, const Functional& j, const Perturbation& p);

/// Throws Error(Usage) where some of the body is orthotropic; `what`, such as "shape derivatives", is not known there.
void require_isotropic(const Scene& scene, const char* what);

}  // namespace kerf
