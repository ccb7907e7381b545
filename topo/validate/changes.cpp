// What small changes do to J, each alone and contact free, by condensation onto balls [theory: V.2].

#include "topo/changes.hpp"

#include "topo/analysis.hpp"
#include "topo/formulas/kind.hpp"
#include "topo/validate/batch.hpp"

namespace kerf {

// Changes without room keep NaN. A mesh per batch serves all scenes.
ChangesMade changes_at(const ChangingBody& body, const Perturbation& p, std::span<const SmallChange> changes) {
  constexpr int sides = 32;
  if (!can_validate(body.element))
    throw Error(Fault::Usage, "the element has unknowns at vertices: changes cannot be made in it");
  if (row(p).becomes == Becomes::Slit) throw Error(Fault::Usage, "a small crack is no change of a disc");
  ChangesMade made;
  made.difference.setConstant(static_cast<Eigen::Index>(changes.size()), static_cast<Eigen::Index>(body.scenes.size()),
                              nan);
  std::vector<Site> sites;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    Site s = site_at(body.meshing.shape, body.j, changes[i].at, i);
    const double reach = kerf::reach(p) * changes[i].radius;
    if (!s.inside || !fits(s, reach)) continue;
    s.radii = {changes[i].radius};
    s.ball = ball_of_one(s, reach);
    sites.push_back(std::move(s));
  }
  for (const std::vector<Site>& batch : in_batches(sites, together)) {
    ++made.meshes;
    const Batch meshed = mesh_batch(body.meshing, batch, sides, {aspect(p), {}});
    for (std::size_t k = 0; k < body.scenes.size(); ++k) {
      const SolvedBatch solved(meshed, {body.element, body.scenes[k], body.threads}, body.j, p);
      for (std::size_t i = 0; i < batch.size(); ++i)
        made.difference(static_cast<Eigen::Index>(batch[i].number), static_cast<Eigen::Index>(k)) =
            solved.differences[i].front().value;
    }
  }
  return made;
}

}  // namespace kerf
