#pragma once
// What acts on a body with a change in it: as tables of a case say, or by the library's own rule.

#include "kerf/validate.hpp"

namespace kerf {

/// The scene with the change at a place: by `drawn`, if there is one. The region, the law or the support of the change
/// is the last one, of the label `rim`. Throws what `drawn` throws.
Scene changed_scene(const Scene& scene, Index rim, const Perturbation& p, const ScenesOfChanges& drawn,
                    const DrawnChangeAt& at);

}  // namespace kerf
