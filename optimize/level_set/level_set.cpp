#include "optimize/level_set/descent.hpp"
#include "optimize/level_set/end.hpp"
#include "optimize/level_set/starts.hpp"

#include <fmt/core.h>

namespace kerf {

namespace {

class LevelSetRun {
 public:
  LevelSetRun(const Problem& p, const OptimizeRequest& r, const Observer& see, const CheckpointPlace& place)
      : see_(see), place_(place), ground_(make_ground(p, r)) {}
  OptimizeResult run();

 private:
  void begin();
  bool restore();
  bool show_new();
  void save() const;

  const Observer& see_;
  const CheckpointPlace& place_;
  Ground ground_;
  std::unique_ptr<Descent> descent_;
  std::size_t shown_ = 0;  // rows
};

DescentRules rules_of(const Ground& g) {
  return {.iterations = g.r.max_iterations};
}

void LevelSetRun::begin() {
  const LevelSetStart start = best_start(ground_);
  DescentRules rules = rules_of(ground_);
  rules.explore = start.explore;
  if (!start.explore) rules.radius = 0.25;
  descent_ = std::make_unique<Descent>(ground_, rules, start.phi);
}

/// Rows that are new, those of steps that were taken with their design. Whether to go on.
bool LevelSetRun::show_new() {
  bool go_on = true;
  const std::vector<Iteration>& rows = descent_->progress().rows;
  // A step that was refused leaves the design; nothing but the last row has one.
  if (shown_ < rows.size() && rows.back().accepted && see_) go_on = see_(descent_->iterate());
  shown_ = rows.size();
  return go_on;
}

OptimizeResult LevelSetRun::run() {
  bool go_on = true;
  if (!restore()) {
    begin();
    go_on = show_new();
    save();
  }
  while (go_on && descent_->advance()) {
    go_on = show_new();
    save();
  }
  if (go_on) go_on = show_new();
  save();
  return result_of(ground_, *descent_, go_on);
}

void LevelSetRun::save() const {
  if (place_.path.empty()) return;
  Checkpoint c = packed(descent_->progress());
  c.fingerprint = place_.fingerprint;
  write_checkpoint(place_.path, c);
}

bool LevelSetRun::restore() {
  if (!place_.resume || place_.path.empty()) return false;
  const std::optional<Checkpoint> c = read_checkpoint(place_.path);
  if (!c) return false;
  if (c->fingerprint != place_.fingerprint)
    throw Error(Fault::Usage, fmt::format("{} belongs to another case: run without --resume, or restore the case file",
                                          place_.path.string()));
  descent_ = std::make_unique<Descent>(ground_, rules_of(ground_), unpacked(*c));
  shown_ = descent_->progress().rows.size();
  return true;
}

}  // namespace

OptimizeResult optimize_level_set(const Problem& p, const OptimizeRequest& r, const Observer& see,
                                  const CheckpointPlace& place) {
  return LevelSetRun(p, r, see, place).run();
}

}  // namespace kerf
