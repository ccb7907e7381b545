// The beginning of a phase: a stop is looked for, the phase is announced, the clock is set.

#include "app/run/journal.hpp"

#include "kerf/stop.hpp"

namespace kerf {

void Journal::begin(const std::string& name) {
  check_stop();
  phase = name;
  if (options.on_phase) options.on_phase(phase);
  lap();
}

}  // namespace kerf
