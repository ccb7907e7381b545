// Growth of cracks in a run: the steps are written as they come, so that what is done stays when the next one fails or
// the run is stopped; the body at the end is a case file of its own, from which growth goes on. docs/theory/growth.md.

#include "app/run/grow.hpp"

#include "app/run/checkpoints.hpp"
#include "app/write/draw.hpp"
#include "app/write/files.hpp"
#include "app/write/page_data.hpp"
#include "base/stopwatch.hpp"
#include "geometry/plane.hpp"
#include "growth/rates.hpp"
#include "io/design.hpp"
#include "io/files.hpp"
#include "io/history.hpp"
#include "kerf/mesher.hpp"
#include "kerf/stop.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace kerf {

namespace {

std::string in_words(const growth::GrowthStep& s, bool fatigue) {
  double most = 0, longest = 0;
  for (const growth::GrownTip& tip : s.tips) most = std::max(most, tip.dK), longest = std::max(longest, tip.a);
  return fmt::format("grow: step {}, {}, longest crack {:.4g}, {} {:.4g}", s.number,
                     fatigue ? fmt::format("{:.5g} cycles", s.cycles) : fmt::format("load {:.4g}", s.load), longest,
                     fatigue ? "dK" : "K", most);
}

/// Lines of what is drawn: arcs by chords.
Contours contours(const Shape& shape) {
  const double size = extent(shape), chord = 1e-3 * size;
  Contours out;
  out.boundary.push_back(flatten(shape.outline, chord, size).points);
  for (const Loop& hole : shape.holes) out.boundary.push_back(flatten(hole, chord, size).points);
  constexpr int pieces = 48;
  for (const Crack& crack : shape.cracks)
    out.cracks.push_back(crack.arc ? points_on(*crack.arc, pieces) : crack.points);
  return out;
}

/// What speaks against the units of the law where growth begins; of tips in regions with laws of their own nothing.
std::string doubt_units(const growth::GrowRequest& request, const growth::Grown& grown) {
  if (!request.law || grown.steps.empty()) return {};
  for (const growth::GrownTip& t : grown.steps.front().tips)
    if (t.region == none && std::isfinite(t.K_max) && t.dK > 0)
      if (std::string doubt = growth::doubt(*request.law, t.K_max, t.K_max - t.dK, t.a); !doubt.empty()) return doubt;
  return {};
}

std::string file_of(int step) {
  return fmt::format("growth_{:04}.vtu", step);
}

/// What growth has found, but for its steps' files.
void take_grown(growth::Grown& grown, GrowthResult& result) {
  result.ended = std::move(grown.ended);
  result.notes = std::move(grown.notes);
  result.solves = grown.solves;
  result.step = grown.step;
  result.path_error = grown.path_error;
  result.cycles_error = grown.cycles_error;
  result.energy_balance = grown.energy_balance;
  result.bounds = std::move(grown.bounds);
  result.unstable_from = grown.unstable_from;
  result.snaps_back_from = grown.snaps_back_from;
  result.steps = std::move(grown.steps);
}

/// Tables of the tips, the steps in their order, and the body as a case and a picture.
void write_grown(const Case& c, const Shape& shape, const GrowthResult& result, Journal& journal) {
  for (const std::string& tip : tips_of(result)) {
    std::string name = tip;
    std::ranges::replace(name, ':', '_');
    write_beta_csv(journal.file(fmt::format("beta_{}.csv", name)), result, tip, c.grow->stress);
  }
  if (journal.vtk) {
    std::vector<std::pair<int, std::string>> files;
    for (const growth::GrowthStep& s : result.steps) files.emplace_back(s.number, file_of(s.number));
    journal.later([path = journal.file("growth.pvd"), files = std::move(files)] { write_collection(path, files); });
  }
  const DesignFile file{
      shape,
      c.scene.laws,
      c.regions,
      {fmt::format("The body into which the cracks of \"{}\" have grown: {}.", c.title, result.ended)}};
  write_text(journal, "grown.toml", design_case(c, file, journal.options.folder));
  journal.picture("growth.png",
                  [&] { return design_picture(c.title, triangulate(shape, c.sizing), c.scene, {}, extent(shape)); });
}

}  // namespace

GrowthResult grow_cracks(const Case& c, const Adaptation& how, Journal& journal) {
  const growth::GrowRequest& request = *c.grow;
  GrowthResult result{.law = request.law ? growth::name(*request.law) : "quasi-static",
                      .criterion = std::string(growth::criterion_words[static_cast<std::size_t>(request.criterion)]),
                      .ended = {}};
  journal.begin("grow");
  Stopwatch clock;
  Adaptation each = how;
  each.meshed = {};
  each.given.reset();
  const std::filesystem::path checkpoint = growth_checkpoint_file(journal.options.folder);
  Snapshots bodies;
  const auto watch = [&](const growth::GrowthStep& step, const Shape& shape, const Adapted* body,
                         const growth::GrowthRecord& record) {
    if (step.number == 0) {  // again, with half the step
      result.steps.clear();
      bodies = {};
    }
    result.steps.push_back(step);
    add(bodies, {step.number, request.law ? step.cycles : step.load, nan, contours(shape)});
    journal.later([path = journal.file("growth.csv"), result] { write_growth_csv(path, result); });
    if (body && journal.vtk) {
      const PlotData data = plot_data(body->model, body->state, c.plane_strain);
      write_fields(journal, file_of(step.number), body->model.mesh, data,
                   state_fields(body->model, body->state, data, {}));
    }
    if (body)
      keep({checkpoint, c.fingerprint, true,
            [&](std::function<void()> write) {
              journal.writer->put_last({std::move(write), 0, checkpoint.filename().string()});
            }},
           as_checkpoint(record));
    if (journal.options.on_step) journal.options.on_step(step);
    if (stop_requested()) return false;
    journal.begin(in_words(step, request.law.has_value()));
    return true;
  };
  growth::GrowthRecord before;
  if (journal.options.resume)
    if (const auto found = read_checkpoint(checkpoint)) before = growth_record(*found);
  growth::Grown grown = growth::grow(c.shape, c.sizing, c.element, c.scene, request, each, watch, std::move(before));
  const std::string doubt = doubt_units(request, grown);
  take_grown(grown, result);
  if (!doubt.empty()) result.notes.push_back(doubt);
  journal.lap();
  journal.seconds.grow = clock.lap();
  journal.begin("write the grown body");
  constexpr std::size_t most_shots = 64;
  if (journal.html) add_shots(journal.arrays, "growth", pick(bodies, most_shots));
  write_grown(c, grown.shape, result, journal);
  journal.seconds.output += journal.lap();
  if (stop_requested())
    throw Error(Fault::Numerics, fmt::format("stopped after step {}; --resume goes on from there",
                                             result.steps.empty() ? 0 : result.steps.back().number));
  return result;
}

}  // namespace kerf
