#pragma once
// What maps and loops ask of an analysis besides kerf/analysis.hpp.

#include "kerf/analysis.hpp"
#include "solver/divided_body.hpp"

#include <span>

namespace kerf {

/// Solves the body with measured displacements.
using MeasuredBody =
    std::function<std::pair<std::shared_ptr<const Model>, std::shared_ptr<const State>>(const Support& measured)>;

/// What an analysis asks of all who have a part of a body, where a model is one part of it.
struct WholeBody {
  std::function<void(std::span<double>)> sum;                             // over all
  std::function<std::vector<double>(const std::vector<double>&)> gather;  // of all, one after the other
  std::function<TangentField(const Sensitivity& dJ)> adjoint;
  std::function<OneSided()> one_sided;
  MeasuredBody measured;  // for a misfit
};
WholeBody whole_body(SharedBody& body, const State& state, Communicator& comm, MeasuredBody measured = {});
/// `analyze` (kerf/analysis.hpp) of a part of a body: fields are those of the part, numbers those of the body.
Analysis analyze(const Functional& j, const Model& model, const Field& state, const WholeBody& body, bool value_only);

/// The recovered stresses of the state, the adjoint and the others, for Analysis::fields: once for several maps.
/// `corners`: those of split_for_stress, where they are known already. `wanted`: as recover_stresses has it.
std::shared_ptr<const MapFields> recover_fields(const Analysis& a, Corners corners = {},
                                                const std::vector<bool>& wanted = {});

/// Throws Error(Usage) where J sees rigid motions that the supports leave free: the solver takes them out of the mean,
/// which a change of the body moves.
void require_supports(const Functional& j, const Model& model);

/// Throws Error(Usage): derivatives by the shape do not know that an eigenstrain stays while the material moves.
void require_no_eigenstrain(const Scene& scene);

/// Throws Error(Usage) where J is infinite: the square of the pressure of a crack whose faces overlap at a tip. analyze
/// asks it.
void require_finite(const Functional& j, const Model& model);

/// Throws Error(Usage) for a functional that does not know what an eigenstrain, a pressure in its crack, an orthotropic
/// material or a support on its sides does to it.
void require_known_loads(const Functional& j, const Model& model);

/// The largest share of the integral of a weight, a target or a direction that the points of the integrals may miss, as
/// far as enclosures are known, and where most of it is.
struct Missed {
  double share = 0;
  Vec2 at = Vec2::Zero();
};
Missed missed(const Term& term, const Model& model);

/// Whether the map takes the fields of a point of its own, so that it is made at listed points only: a clamped hole in
/// a J that is neither an energy nor linear in the state, or that sees contact.
bool needs_points(const Model& model, const Functional& j, const Perturbation& p);

/// No eigenstrain, no friction and no prescribed displacement but 0: then the compliance is -2 times the potential
/// energy.
bool has_self_adjoint_work(const Model& model);

/// Whether the term is a multiple of an energy at the state, so that it needs no adjoint.
bool is_energy(const Model& model, const Term& term);

/// The scene with the measured displacements instead of the tractions on their label.
Scene measured_scene(const Scene& scene, const Support& measured);

}  // namespace kerf
