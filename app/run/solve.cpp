// The state of a body in a run: solved once or with refinement, described, written, and the notes on it. Notes say what
// a user should know beside the numbers: data that the rules do not resolve, faces that penetrate, chords in the place
// of curves, a mesh as coarse as the body, points outside. describe_state() makes the section of the result as far as
// the case asks for it (energy bounds, tips), and times each part. failure() says in words why a state is not
// certified: the contact set did not settle, the residual (kkt), or the work of the loads, which must be twice the
// energy.

#include "app/run/solve.hpp"

#include "app/run/notes.hpp"
#include "app/write/draw.hpp"
#include "app/write/files.hpp"
#include "geometry/curved.hpp"
#include "geometry/plane.hpp"
#include "kerf/bounds.hpp"
#include "kerf/stop.hpp"
#include "optimize/refuse.hpp"
#include "solver/resultants.hpp"
#include "solver/saddle_point.hpp"
#include "solver/system.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace kerf {

void require_energy(double energy, bool has_stress) {
  const bool underflow = energy == 0 && has_stress;
  if (std::isfinite(energy) && !underflow) return;
  throw Error(Fault::Numerics, fmt::format("the strain energy is too {} for the numbers of a computer; check the units "
                                           "of young, of the loads and of the prescribed displacements",
                                           underflow ? "small" : "large"));
}

bool has_stress(const Model& model, const State& state) {
  const auto stress = state.interior.topRows(stress_count(model.element));
  return stress.size() > 0 && stress.cwiseAbs().maxCoeff() > 0;
}

namespace {

void add_seconds(const Adapted& adapted, Seconds& seconds) {
  for (const Round& round : adapted.rounds) {
    seconds.mesh += round.mesh;
    seconds.assemble += round.assemble;
    seconds.factor += round.factor;
    seconds.solve += round.solve - round.contact;
    seconds.contact += round.contact;
    seconds.estimate += round.estimate;
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
    if (stop_requested()) return false;
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

void add_resultants(const Model& model, const std::vector<LabelResultant>& reactions, const Shape& shape,
                    StateResult& out) {
  Resultant sum;
  const auto named = [&](const std::vector<LabelResultant>& all) {
    std::vector<ResultantResult> result;
    for (const LabelResultant& r : all) {
      result.push_back({shape.labels[r.label], r.of.force, r.of.moment});
      sum.add(r.of);
    }
    return result;
  };
  const EdgeCurvatures& curvatures = model.inner->skeleton.curvatures;
  out.loads = named(traction_resultants(model.mesh, curvatures, model.scene, model.inner->data));
  out.reactions = named(reactions);
  if (model.scene.body) {
    const Resultant body =
        body_resultant(model.mesh, curvatures, model.scene, model.inner->data, model.inner->kernel.load);
    out.body = ResultantResult{"", body.force, body.moment};
    sum.add(body);
  }
  out.balance = ResultantResult{"", sum.force, sum.moment};
}

void draw_chords(Case& c, const std::string& why) {
  c.sizing.curved = false;
  if (c.mesh) c.mesh = std::make_shared<const Mesh>(with_chords(*c.mesh));
  c.why_chords = why;
}

StateSection describe_state(const Adapted& adapted, const Case& c, Journal& journal) {
  const Model& model = adapted.model;
  const State& state = adapted.state;
  const Shape& shape = c.shape;
  StateSection s{state_result(model, state, adapted.indicator), {}, {}};
  journal.seconds.recover += journal.lap();
  if (c.output.energy_bounds) {
    EnergyBounds bounds = energy_bounds(model, state);
    if (const std::string sampled = sampled_note(model); bounds.guaranteed && !sampled.empty())
      bounds.guaranteed = false, bounds.note = sampled;
    add_energy_bounds(bounds, s.state);
    journal.seconds.energy_bounds += journal.lap();
  }
  s.cracks = crack_results(model, state, shape, c.planes, c.output.tips);
  (c.output.tips && !s.cracks.empty() ? journal.seconds.tips : journal.seconds.recover) += journal.lap();
  s.state.of_polygon = is_of_polygon(shape, model.mesh);
  add_resultants(model, reactions(model, state), shape, s.state);
  // Pieces that contact alone holds are settled in one way, whatever was asked for, and so is large contact.
  const bool by_rows = has_large_contact(model) || c.backend == Backend::Umfpack;
  const ContactMethod used = by_rows                             ? ContactMethod::ActiveSet
                             : model.inner->semicoercive.empty() ? c.contact
                                                                 : ContactMethod::DualQp;
  if (has_contact(model.scene)) s.contact = contact_result(state, used, s.cracks);
  return s;
}

void write_state(const Adapted& adapted, const PlotData& data, const std::vector<CrackResult>& cracks,
                 Journal& journal) {
  if (!stop_requested()) journal.begin("write the state");
  write_state_files(journal, adapted, data, cracks);
  journal.picture("mesh.png", [&] { return mesh_picture(journal.title, adapted.model.mesh); });
  journal.picture("von_mises.png", [&] { return stress_picture(journal.title_of_state(), adapted.model, data); });
  journal.seconds.output += journal.lap();
}

std::string failure(const Model& model, const State& state) {
  const Certificate& c = state.certificate;
  std::string reason =
      !state.converged ? "the contact set did not settle"
      : c.kkt > no_digits
          ? fmt::format("the {} hold only to {:.2g} of the load",
                        has_contact(model.scene) ? "conditions of equilibrium and contact" : "equations of equilibrium",
                        c.kkt)
          : fmt::format("the work of the loads is twice the strain energy only to {:.2g}", c.work);
  if (!model.inner->skeleton.unseen.empty())
    reason +=
        "; the traces of \"arnold-winther\" at vertices whose edges lie on two lines bear only loads that fit "
        "one symmetric stress there: use \"bdms\" with degree = 3";
  return reason;
}

}  // namespace kerf
