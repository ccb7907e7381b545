// A history of loads: each step continues from the state of the one before, with its energies, work of loads and
// supports, dissipation and what these leave. docs/theory/contact.md, "Steps of loading".

#include "app/run/history.hpp"

#include "app/run/findings.hpp"
#include "app/run/solve.hpp"
#include "solver/history.hpp"

#include <fmt/format.h>

#include <optional>

namespace kerf {

namespace {

struct SolvedStep {
  Model model;
  State state;
};

std::string step_in_words(const LoadStep& step) {
  return step.parts > 1 ? fmt::format("step \"{}\", part {} of {}", step.name, step.part, step.parts)
                        : fmt::format("step \"{}\"", step.name);
}

StepResult result_of(const LoadStep& step, const SolvedStep& now, const SolvedStep* before, const StepResult* last,
                     const Case& c) {
  StepResult r{.name = step.name, .part = step.part, .parts = step.parts, .values = step.values};
  const InHistory here{now.model, now.state};
  r.energy = potential_energy(now.model, now.state);
  r.strain_energy = strain_energy(now.model, now.state);
  r.work = before ? last->work + work_between({before->model, before->state}, here) : work_from_rest(here);
  r.dissipation = before ? last->dissipation + dissipation_between({before->model, before->state}, here)
                         : dissipation_from_rest(here);
  r.imbalance = has_eigenstrain(now.model.scene) ? nan : r.work - r.strain_energy - r.dissipation;
  r.kkt = now.state.certificate.kkt;
  const SlipLengths lengths = slip_lengths(now.model, now.state);
  r.stick_length = lengths.stick;
  r.slip_length = lengths.slip;
  Findings found;
  for (const CrackResult& crack : find_cracks(c, whole(c, now.model, now.state), c.output.tips, found)) {
    r.open_length += crack.open_length;
    r.closed_length += crack.closed_length;
    for (const TipResult& tip : crack.tips) r.tips.push_back({crack.name, tip.at, tip.K_I, tip.K_II});
  }
  return r;
}

}  // namespace

void refuse_with_steps(const Case& c, const char* job) {
  throw Error(Fault::Usage,
              fmt::format("{}: [[step]] goes with kerf solve: {} is not known for a history of loads; leave "
                          "one of the two out",
                          place_of(c, "step[0]"), job));
}

void refuse_steps(const Case& c) {
  if (c.adapt) refuse_with_steps(c, "an adapted mesh ([mesh] adapt)");
  if (c.backend == Backend::Umfpack) refuse_with_steps(c, "backend = \"umfpack\"");
  if (c.synthetic) refuse_with_steps(c, "a made up measurement ([synthetic])");
  if (!is_mixed(c.element)) refuse_with_steps(c, fmt::format("element = \"{}\"", c.element.name).c_str());
}

Adapted solve_steps(const Case& c, const Adaptation& how, Journal& journal, std::vector<StepResult>& out) {
  journal.begin("mesh");
  Mesh mesh = c.mesh ? *c.mesh : triangulate(c.shape, c.sizing);
  journal.seconds.mesh += journal.lap();
  if (how.meshed) how.meshed(mesh);
  std::optional<SolvedStep> now;
  for (const LoadStep& step : c.steps) {
    journal.begin(step_in_words(step));
    Model model =
        now ? continued(now->model, step.scene, now->state)
            : prepare(std::move(mesh), c.element, step.scene, journal.options.threads, {.precision = how.precision});
    State state = solve(model, c.contact);
    if (!certified(state))
      throw Error(Fault::Numerics,
                  fmt::format("{} could not be solved: {}", step_in_words(step), failure(model, state)));
    SolvedStep next{std::move(model), std::move(state)};
    out.push_back(result_of(step, next, now ? &*now : nullptr, out.empty() ? nullptr : &out.back(), c));
    // What is done stays when the next one fails.
    journal.later([path = journal.file("steps.csv"), out] { write_steps_csv(path, out); });
    now = std::move(next);
    journal.seconds.solve += journal.lap();
  }
  Indicator indicator;
  if (c.output.estimate) indicator = error_indicator(now->model, now->state);
  journal.seconds.estimate += journal.lap();
  Adapted last{.model = std::move(now->model), .state = std::move(now->state), .indicator = std::move(indicator)};
  last.sizing = c.sizing;
  return last;
}

}  // namespace kerf
