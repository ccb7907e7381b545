#pragma once
// K, G and T at the tips of a body that several processes have in parts: the integrals of kerf/fracture.hpp, each
// process summing over its own triangles.

#include "base/sums.hpp"
#include "kerf/fracture.hpp"
#include "kerf/recover.hpp"

#include <memory>
#include <vector>

namespace kerf {

/// The tips of a mesh as they are once every edge is divided, and what their cracks are beside them.
class SharedTips {
 public:
  /// `mesh`, `scene`: before the division.
  SharedTips(const Mesh& mesh, const Scene& scene, int divisions);
  ~SharedTips();
  /// `profiles`: per crack all of its points. All processes call it together. NaN where no domain fits, at
  /// the tips of curved cracks with straight edges, and of those with a pressure.
  std::vector<TipIntensity> intensities(const Model& part, const Field& state,
                                        const std::vector<std::vector<CrackPoint>>& profiles, const Sums& sums) const;

 private:
  struct Tip;
  std::vector<Tip> tips_;
};

}  // namespace kerf
