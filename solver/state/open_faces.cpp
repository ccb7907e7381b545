// Whether faces that may touch are open everywhere, and the same body with cracks that never touch.

#include "solver/open_faces.hpp"

#include "kerf/recover.hpp"

namespace kerf {

bool open_everywhere(const Model& m, const State& s) {
  bool some = false;
  for (Index c = 0; c < static_cast<Index>(m.mesh.cracks.size()); ++c) {
    if (!is_unilateral(m.scene.laws[c])) continue;
    some = true;
    for (const CrackPoint& p : crack_profile(m, s, c))
      if (p.status != CrackPoint::Status::Open) return false;
  }
  return some;
}

Opened opened(const Model& m, int threads) {
  Scene scene = m.scene;
  for (CrackLaw& law : scene.laws)
    if (is_unilateral(law)) law.kind = CrackLaw::Kind::Open;
  Opened o{prepare(m.mesh, m.element, std::move(scene), threads), {}};
  o.state = solve(o.model);
  return o;
}

}  // namespace kerf
