// The rows of load cases: each solved on the mesh of the state, in the order of names. Without contact and without an
// adapted mesh all of them share the factor of the state, and a row costs a solve; otherwise each is a solution of its
// own. The state, the files and the pictures of a run are those of the first by name, independent of the order in the
// file. A load case that cannot be solved is an error with its name.

#include "app/run/load_cases.hpp"

#include "app/run/findings.hpp"
#include "app/run/margins.hpp"
#include "app/run/notes.hpp"
#include "app/run/peaks.hpp"
#include "optimize/load_cases.hpp"
#include "solver/resultants.hpp"
#include "solver/system.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace kerf {

void add_largest(const Case& c, const Adapted& adapted, const PlotData& data, Findings& found, Journal& journal) {
  if (!c.output.peaks) return;
  const SingularZones zones = singular_zones(adapted.model, extent(c.shape));
  find_peaks(c, whole(c, adapted.model, adapted.state), data, zones, found);
  journal.seconds.recover += journal.lap();
  add_margins(c, adapted, data, found.state, found.cracks);
  journal.seconds.margins += journal.lap();
}

Case under(const Case& c, const LoadCase& load_case) {
  Case out = c;
  out.scene.tractions = load_case.tractions;  // all loads belong to load cases
  out.scene.body = load_case.body;
  return out;
}

namespace {

LoadCaseResult row_of(const LoadCase& load_case, const StateResult& s) {
  return {load_case.name, load_case.weight, s.energy,    s.compliance,
          s.von_mises,    s.displacement,   s.reactions, s.reserves};
}

/// Whether the mesh of one load case is that of all, and a solution of one is by the factor of any.
bool shares_factor(const Case& c) {
  return !has_contact(c.scene) && !c.adapt && c.backend == Backend::Cholmod;
}

/// `alone`: as in add_load_cases.
Adapted solved(Case& c, const Adapted& shown, const std::function<Adapted(Case&, Result&)>& alone, Journal& journal) {
  Result unseen;
  if (!shares_factor(c)) return alone(c, unseen);
  Adapted out{.model = with_loads(shown.model, c.scene), .state = {}, .indicator = {}, .rounds = {}, .sizing = {}};
  out.state = solve(out.model, c.contact);
  journal.seconds.solve += journal.lap();
  return out;
}

/// Energies, reactions and largest values.
StateResult measured(const Case& c, const Adapted& adapted, Journal& journal) {
  Findings found;
  find_numbers(c, whole(c, adapted.model, adapted.state), found);
  require_energy(found.state.energy, found.has_stress);
  add_resultants(adapted.model, found.reactions, c.shape, found.state);
  if (c.output.peaks) add_largest(c, adapted, plot_data(adapted.model, adapted.state, c.plane_strain), found, journal);
  std::vector<std::string> notes = notes_on_size(found.strain, found.state.displacement, extent(c.shape));
  notes.insert(notes.end(), found.state.notes.begin(), found.state.notes.end());
  found.state.notes = std::move(notes);
  return std::move(found.state);
}

std::string whose(const std::vector<LoadCase>& all, const std::string& shown) {
  std::string others;
  for (const LoadCase& l : all)
    if (l.name != shown) others += fmt::format("{}\"{}\"", others.empty() ? "" : ", ", l.name);
  return fmt::format(
      "state, cracks, contact, files and pictures are those of load case \"{}\", the first by name; load_cases has the "
      "largest values and the reactions under {}, too",
      shown, others);
}

}  // namespace

void add_load_cases(const Case& c, const Adapted& shown_state,
                    const std::function<Adapted(Case&, Result&)>& solve_alone, Journal& journal, Result& r) {
  if (!c.optimize || c.optimize->load_cases.empty()) return;
  const std::vector<LoadCase> all = by_name(c.optimize->load_cases);
  const std::string& name = shown(all).name;
  r.state->load_case = name;
  if (all.size() > 1) r.state->notes.insert(r.state->notes.begin(), whose(all, name));
  for (const LoadCase& load_case : all) {
    if (load_case.name == name) {
      r.load_cases.push_back(row_of(load_case, *r.state));
      continue;
    }
    journal.begin(fmt::format("load case \"{}\"", load_case.name));
    try {
      Case other = under(c, load_case);
      const Adapted adapted = solved(other, shown_state, solve_alone, journal);
      if (!certified(adapted.state)) throw Error(Fault::Numerics, failure(adapted.model, adapted.state));
      const StateResult s = measured(other, adapted, journal);
      for (const std::string& note : s.notes)
        if (std::ranges::find(r.state->notes, note) == r.state->notes.end())
          r.state->notes.push_back(fmt::format("load case \"{}\": {}", load_case.name, note));
      r.load_cases.push_back(row_of(load_case, s));
    } catch (const Error& e) {
      if (e.fault != Fault::Numerics) throw;
      throw Error(e.fault, fmt::format("load case \"{}\": {}", load_case.name, e.what()));
    }
  }
}

}  // namespace kerf
