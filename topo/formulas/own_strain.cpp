// The plane problem sees e33 of plane strain as nu e33 along both axes, so that an inclusion of another Poisson's ratio
// strains by (nu* - nu) e33 beyond what surrounds it [theory: H.2, H.8].

#include "topo/own_strain.hpp"
#include "solver/data.hpp"
#include "solver/system.hpp"

namespace kerf {

// e33 enters the plane with (nu* - nu) more along both axes.
Eigenstrain seen_in(const Eigenstrain& here, const Material& around, const Material& inside) {
  Eigenstrain there = here;
  if (!here.out_of_plane) return there;
  const double share = out_of_plane_share(around, inside);
  // Component 1 of `shear` is e33.
  const VectorField across = here.shear;
  there.normal =
      sum(here.normal, VectorField([=](const Vec2& x) -> Vec2 { return Vec2::Constant(share * across(x)[1]); }));
  return there;
}

double strain_beyond(const Mesh& mesh, const Scene& scene, const Material& inclusion, Index t, const Vec2& x) {
  const Eigenstrain* here = eigenstrain_of(mesh, scene, t);
  if (!here || !here->out_of_plane) return 0;
  return out_of_plane_share(material_of(mesh, scene, t), inclusion) * here->shear(x)[1];
}

}  // namespace kerf
