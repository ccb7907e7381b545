// The state of a body in a run: solved once or with refinement, described, written, and the notes on it. tell_state()
// makes the section of the result of what one process or several have found (findings.cpp), with its notes. failure()
// says in words why a state is not certified: the contact set did not settle, the residual (kkt), or the work of the
// loads, which must be twice the energy.

#include "app/run/solve.hpp"

#include "app/run/findings.hpp"
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
#include <utility>

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

AdaptResult adapt_result(const std::vector<Round>& rounds, const std::string& stopped) {
  AdaptResult r{.stopped = stopped};
  for (const Round& round : rounds) r.rounds.emplace_back(round.triangles, round.estimated_error);
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

void draw_chords(Case& c, const FoldedTriangle& why) {
  if (c.curved.value_or(false)) throw why;
  c.sizing.curved = false;
  if (c.mesh) c.mesh = std::make_shared<const Mesh>(with_chords(*c.mesh));
  c.why_chords = why.what();
}

void tell_state(const Case& c, const Model& body, Findings& found, const Journal& journal, Result& r) {
  const std::vector<std::string> on_margins = std::exchange(found.state.notes, body.notes);
  StateResult& s = r.state.emplace(std::move(found.state));
  r.cracks = std::move(found.cracks);
  r.solver = found.solver;
  if (const std::string note = lost_digits(found.solved); !note.empty()) s.notes.push_back(note);
  if (found.energy) {
    if (const std::string sampled = sampled_note(body); found.energy->guaranteed && !sampled.empty())
      found.energy->note = sampled;
    add_energy_bounds(*found.energy, s);
  }
  add_resultants(body, found.reactions, c.shape, s);
  s.notes.insert(s.notes.end(), found.notes.begin(), found.notes.end());
  add_notes(c, body, found, journal.options.in_single && r.solver, r);  // else it did not serve, which a note says
  if (has_contact(body.scene)) r.contact = contact_result(found.solved, found.method, r.cracks);
  require_energy(s.energy, found.has_stress);
  for (std::string& note : notes_on_size(found.strain, s.displacement, extent(c.shape)))
    s.notes.push_back(std::move(note));
  s.notes.insert(s.notes.end(), on_margins.begin(), on_margins.end());
  add_notes_on_chords(c, body.mesh, found.beside_chords, r);
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
