#include "app/solve.hpp"

#include "app/draw.hpp"
#include "app/files.hpp"
#include "kerf/bounds.hpp"
#include "solver/saddle_point.hpp"
#include "solver/system.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace kerf {

namespace {

bool may_touch(const Scene& scene) {
  return std::any_of(scene.laws.begin(), scene.laws.end(),
                     [](const CrackLaw& law) { return law.kind == CrackLaw::Kind::Unilateral; });
}

}  // namespace

namespace {

void add_seconds(const Adapted& adapted, Seconds& seconds) {
  for (const Round& round : adapted.rounds) {
    seconds.mesh += round.mesh;
    seconds.assemble += round.assemble;
    seconds.factor += round.factor;
    seconds.solve += round.solve - round.contact + round.estimate;
    seconds.contact += round.contact;
  }
}

}  // namespace

Adapted solve_once(const Body& body, const Adaptation& how, Journal& journal) {
  journal.begin("mesh");
  Adapted adapted = solve_graded(body.shape, body.sizing, body.element, body.scene, how);
  add_seconds(adapted, journal.seconds);
  return adapted;
}

Adapted solve_refined(const Body& body, Adaptation how, Journal& journal) {
  journal.begin("solve and refine");
  int number = 0;
  how.go_on = [&](const Round& round) {
    journal.begin(fmt::format("refine: round {}, {} triangles, estimated error {:.3g}", ++number, round.triangles,
                              round.estimated_error));
    return true;
  };
  Adapted adapted = solve_adaptively(body.shape, body.sizing, body.element, body.scene, how);
  add_seconds(adapted, journal.seconds);
  return adapted;
}

AdaptResult adapt_result(const Adapted& adapted) {
  AdaptResult r{.stopped = adapted.stopped};
  for (const Round& round : adapted.rounds) r.rounds.emplace_back(round.triangles, round.estimated_error);
  return r;
}

StateSection describe_state(const Adapted& adapted, const Shape& shape, ContactMethod method) {
  const Model& model = adapted.model;
  const State& state = adapted.state;
  StateSection s{state_result(model, state, adapted.indicator, energy_bounds(model, state)),
                 crack_results(model, state, shape),
                 {}};
  for (const CrackResult& crack : s.cracks)
    if (crack.penetration > 1e-6 * crack.max_opening && crack.penetration > 0)
      s.state.notes.push_back(
          fmt::format("the faces of crack \"{}\" (contact = \"open\") penetrate by up to {:.3g}; "
                      "contact = \"unilateral\" prevents it",
                      crack.name, crack.penetration));
  if (may_touch(model.scene)) s.contact = contact_result(state, method, s.cracks);
  return s;
}

void write_state(const Adapted& adapted, const PlotData& data, const std::vector<CrackResult>& cracks,
                 Journal& journal) {
  journal.begin("write the state");
  write_state_files(journal, adapted, data, cracks);
  journal.picture("mesh.png", "Mesh", [&] { return mesh_picture(journal.title, adapted.model.mesh); });
  journal.picture("von_mises.png", "Von Mises stress",
                  [&] { return stress_picture(journal.title, adapted.model, data); });
  journal.seconds.output += journal.lap();
}

std::string failure(const Model& model, const State& state) {
  const Certificate& c = state.certificate;
  std::string reason =
      !state.converged ? "the contact set did not settle"
      : c.kkt > no_digits
          ? fmt::format("the {} hold only to {:.2g} of the load",
                        may_touch(model.scene) ? "conditions of equilibrium and contact" : "equations of equilibrium",
                        c.kkt)
          : fmt::format("the work of the loads is twice the strain energy only to {:.2g}", c.work);
  if (!model.inner->skeleton.unseen.empty())
    reason +=
        "; the traces of \"arnold-winther\" at vertices whose edges lie on two lines bear only loads that fit "
        "one symmetric stress there: use \"bdms\" with degree = 3";
  return reason;
}

}  // namespace kerf
