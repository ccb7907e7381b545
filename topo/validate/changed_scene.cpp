// The scene with a change in it: by the caller's tables, or by the library's rule (a region, a clamp, a crack in
// contact).

#include "topo/validate/changed_scene.hpp"

#include "topo/formulas/kind.hpp"
#include "topo/own_strain.hpp"

namespace kerf {

namespace {

// A new region, the last, has the eigenstrain of the place where it lies.
void add_inclusion(Index around, const Material& inside, Scene& scene) {
  const std::size_t place = static_cast<std::size_t>(around + 1);  // none is -1
  std::optional<Eigenstrain> own;
  if (place < scene.eigenstrain.size())
    own = seen_in(scene.eigenstrain[place], place == 0 ? scene.material : scene.regions[place - 1], inside);
  scene.regions.push_back(inside);
  if (!own) return;
  scene.eigenstrain.resize(scene.regions.size() + 1);
  scene.eigenstrain.back() = *own;
}

}  // namespace

// A clamp is a support on `rim`, a label that the mesh gets for it; a hole changes no scene.
Scene changed_scene(const Scene& scene, Index rim, const Perturbation& p, const ScenesOfChanges& drawn,
                    const DrawnChangeAt& at) {
  if (drawn) return drawn(p, at);
  Scene changed = scene;
  switch (row(p).becomes) {
    case Becomes::Nothing:
      break;
    case Becomes::Material:
      add_inclusion(at.region, p.inclusion, changed);
      break;
    case Becomes::Clamp:
      changed.supports.push_back(
          {.label = rim, .value = [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }});
      break;
    case Becomes::Slit:
      changed.laws.push_back({.kind = CrackLaw::Kind::Unilateral});
  }
  return changed;
}

}  // namespace kerf
