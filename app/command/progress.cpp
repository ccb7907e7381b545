// Progress on stderr: on a terminal one line that is drawn anew twice a second while a phase lasts, elsewhere a line
// per phase. A line is as long as the terminal is wide, less one column; a terminal that was made narrower has broken
// the last line into rows, which are wiped, too. Widths count characters, not bytes. Times left come from the forecast
// and are not shown once they are used up.

#include "app/progress.hpp"

#include <fmt/format.h>
#include <spdlog/logger.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <thread>

namespace kerf {

using Clock = std::chrono::steady_clock;

namespace {

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Of the terminal now: it may have been resized since the last line.
std::size_t columns() {
  winsize size{};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
  return 80;
}

bool is_terminal() {
  const char* kind = std::getenv("TERM");
  return isatty(STDERR_FILENO) == 1 && kind && std::string_view(kind) != "dumb";
}

bool continues(char c) {
  return (static_cast<unsigned char>(c) & 0xc0) == 0x80;
}

std::size_t length(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) { return !continues(c); }));
}

}  // namespace

std::string duration(double seconds) {
  const auto s = static_cast<long long>(std::ceil(std::clamp(seconds, 0.0, 1e9)));
  if (s >= 3600) return fmt::format("{} h {:02} min", s / 3600, s % 3600 / 60);
  if (s >= 60) return fmt::format("{} min {:02} s", s / 60, s % 60);
  return fmt::format("{} s", s);
}

std::string status_line(const std::string& phase, double elapsed, double expected, std::size_t columns) {
  std::string clock = fmt::format(" ({}", duration(std::floor(elapsed)));
  if (expected > elapsed) clock += fmt::format(", about {} left", duration(expected - elapsed));
  clock += ")";
  // The last column stays free: a cursor behind it would already be on the next line.
  const std::size_t room = columns > 0 ? columns - 1 : 0;
  std::string text = "kerf: " + phase;
  if (length(text) + length(clock) > room) {
    const std::size_t kept = room > length(clock) + 1 ? room - length(clock) - 1 : 0;
    std::size_t end = 0;
    for (std::size_t count = 0; end < text.size() && (count < kept || continues(text[end])); ++end)
      if (!continues(text[end])) ++count;
    while (end < text.size() && continues(text[end])) ++end;
    text = text.substr(0, end) + "\u2026";
  }
  text += clock;
  return length(text) > room ? "" : text;  // too narrow for anything
}

struct Progress::State {
  spdlog::logger log{"kerf", std::make_shared<spdlog::sinks::stderr_color_sink_mt>()};
  bool one_line = false;
  std::size_t shown = 0;  // characters of the line that is on the screen
  std::string phase;
  double expected = 0;  // seconds in all
  Clock::time_point start = Clock::now(), phase_start = start;
  std::mutex mutex;
  std::condition_variable_any wake;
  std::jthread clock;  // draws the line anew while a phase lasts

  ~State() {
    if (clock.joinable()) clock.request_stop(), wake.notify_all();
  }

  /// A line that the terminal has broken since, because it was made narrower, is several rows now.
  void wipe() {
    if (shown == 0) return;
    for (std::size_t rows = (shown - 1) / columns(); rows > 0; --rows) std::fputs("\r\033[K\033[A", stderr);
    std::fputs("\r\033[K", stderr);
    shown = 0;
  }
  void draw() {
    if (phase.empty()) return;
    wipe();
    const std::string line = status_line(phase, seconds_since(start), expected, columns());
    std::fputs(line.c_str(), stderr);
    std::fflush(stderr);
    shown = length(line);
  }
  void tick(const std::stop_token& end) {
    std::unique_lock lock(mutex);
    while (!end.stop_requested()) {
      wake.wait_for(lock, end, std::chrono::milliseconds(500), [] { return false; });
      if (!end.stop_requested()) draw();
    }
  }
};

const std::vector<std::string>& log_levels() {
  static const std::vector<std::string> names = {"trace", "debug", "info", "warn", "error", "off"};
  return names;
}

Progress::Progress(const std::string& level) : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.log.set_pattern("[%T.%e] [%^%l%$] %v");
  s.log.set_level(spdlog::level::from_str(level));
  s.one_line = level == "info" && is_terminal();
  if (s.one_line) s.clock = std::jthread([&s](const std::stop_token& end) { s.tick(end); });
}

Progress::~Progress() {
  const std::scoped_lock lock(state_->mutex);
  state_->wipe();
  state_->phase.clear();
}

void Progress::expect(double seconds) {
  const std::scoped_lock lock(state_->mutex);
  state_->expected = seconds;
}

void Progress::phase(const std::string& name) {
  State& s = *state_;
  const std::scoped_lock lock(s.mutex);
  if (!s.phase.empty()) s.log.debug("{} took {:.3f} s", s.phase, seconds_since(s.phase_start));
  s.phase = name;
  s.phase_start = Clock::now();
  if (s.one_line)
    s.draw();
  else
    s.log.info("{}", name);
}

void Progress::finish() {
  State& s = *state_;
  const std::scoped_lock lock(s.mutex);
  s.wipe();
  if (!s.phase.empty()) s.log.debug("{} took {:.3f} s", s.phase, seconds_since(s.phase_start));
  s.phase.clear();
  if (!s.one_line) s.log.info("done in {:.3f} s", seconds_since(s.start));
}

}  // namespace kerf
