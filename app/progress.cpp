#include "app/progress.hpp"

#include <spdlog/logger.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>

namespace kerf {

using Clock = std::chrono::steady_clock;

struct Progress::State {
  spdlog::logger log{"kerf", std::make_shared<spdlog::sinks::stderr_color_sink_mt>()};
  bool one_line = false;
  bool shown = false;  // the line is on the screen
  std::string phase;
  Clock::time_point start = Clock::now(), phase_start = start;

  void wipe() {
    if (shown) std::fputs("\r\033[K", stderr);
    shown = false;
  }
};

namespace {

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

const std::vector<std::string>& log_levels() {
  static const std::vector<std::string> names = {"trace", "debug", "info", "warn", "error", "off"};
  return names;
}

Progress::Progress(const std::string& level) : state_(std::make_unique<State>()) {
  state_->log.set_pattern("[%T.%e] [%^%l%$] %v");
  state_->log.set_level(spdlog::level::from_str(level));
  state_->one_line = level == "info" && isatty(STDERR_FILENO) == 1;
}

Progress::~Progress() {
  state_->wipe();
}

void Progress::phase(const std::string& name) {
  State& s = *state_;
  if (!s.phase.empty()) s.log.debug("{} took {:.3f} s", s.phase, seconds_since(s.phase_start));
  s.phase = name;
  s.phase_start = Clock::now();
  if (s.one_line) {
    std::fprintf(stderr, "\r\033[Kkerf: %s (%.1f s)", name.c_str(), seconds_since(s.start));
    std::fflush(stderr);
    s.shown = true;
  } else {
    s.log.info("{}", name);
  }
}

void Progress::finish() {
  State& s = *state_;
  s.wipe();
  if (!s.phase.empty()) s.log.debug("{} took {:.3f} s", s.phase, seconds_since(s.phase_start));
  s.phase.clear();
  if (!s.one_line) s.log.info("done in {:.3f} s", seconds_since(s.start));
}

}  // namespace kerf
