#include "optimize/ersatz.hpp"

#include <numeric>

namespace kerf {

Material weak_material(const Material& solid, double share) {
  return {solid.mu * share, solid.c / share};
}

Evaluated evaluate_ersatz(const Problem& p, const OptimizeRequest& r, const Canvas& canvas,
                          const Eigen::VectorXd& phi) {
  if (!p.frame.regions.empty())
    throw Error(Fault::Usage, "a weak phase (optimize.ersatz) does not go with [[region]]: remove one of them");
  Mesh mesh = canvas.mesh;
  mesh.region.assign(mesh.triangles.size(), none);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& v = mesh.triangles[t];
    if (phi[v[0]] + phi[v[1]] + phi[v[2]] >= 0) mesh.region[t] = 0;
  }
  Problem weak = p;
  weak.scene.regions = {weak_material(p.scene.material, r.level_set.ersatz)};
  std::vector<Index> cracks(p.frame.cracks.size());
  std::iota(cracks.begin(), cracks.end(), Index{0});
  Evaluated e = evaluate_mesh(weak, r, p.frame, std::move(mesh), cracks);
  e.area = 0;
  const Mesh& solved = e.cases.front().model.mesh;
  for (Index t = 0; t < static_cast<Index>(solved.triangles.size()); ++t)
    if (region_of(solved, t) == none) e.area += area(solved, t);
  return e;
}

}  // namespace kerf
