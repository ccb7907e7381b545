#pragma once
// --max-memory and --max-seconds while a run goes on: a forecast may be wrong, and a case file may come from a
// stranger.

#include "app/forecast.hpp"

#include <memory>
#include <optional>
#include <string>

namespace kerf {

/// Looks twenty times a second. What goes beyond a limit is asked to stop (kerf/stop.hpp); what does not stop within
/// ten seconds, or takes half as much memory again, is ended with exit code 4 and one sentence; files that wait for
/// quick_exit go. Without limits it does nothing. The resident memory of this process counts, and that of its children.
class Watchdog {
 public:
  explicit Watchdog(const Allowed& limits);
  ~Watchdog();
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;
  /// A forecast refuses in words of its own, for which it may take a little more memory than there is to be; its time
  /// counts.
  void allow_forecast();
  void end_forecast();
  /// Why it asked the run to stop, if it did.
  std::optional<std::string> why() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kerf
