// A weak phase instead of void, for comparison: stiffness mixed by the share of each triangle in the material, in 16
// steps, a region each (docs/theory/level_set.md, "Weak phase, for comparison").

#include "optimize/ersatz.hpp"

#include <cmath>
#include <numeric>

namespace kerf {

double strong_share(Index region) {
  return region == none ? 1 : static_cast<double>(region) / mixed_phases;
}

Material weak_material(const Material& solid, double share) {
  return stiffened(solid, share);
}

Evaluated evaluate_ersatz(const Problem& p, const OptimizeRequest& r, const BackgroundMesh& background,
                          const Eigen::VectorXd& phi) {
  Mesh mesh = background.mesh;
  mesh.region.assign(mesh.triangles.size(), none);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& v = mesh.triangles[t];
    const double share = negative_part(1, {phi[v[0]], phi[v[1]], phi[v[2]]});
    const Index level = static_cast<Index>(std::lround(share * mixed_phases));
    if (level < mixed_phases) mesh.region[t] = level;
  }
  Problem weak = p;
  for (Index k = 0; k < mixed_phases; ++k)
    weak.scene.regions.push_back(
        weak_material(p.scene.material, r.level_set.ersatz + (1 - r.level_set.ersatz) * strong_share(k)));
  std::vector<Index> cracks(p.frame.cracks.size());
  std::iota(cracks.begin(), cracks.end(), Index{0});
  Evaluated e = evaluate_mesh(weak, r, p.frame, std::move(mesh), cracks);
  e.area = negative_area(background.mesh, phi);
  return e;
}

}  // namespace kerf
