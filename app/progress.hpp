#pragma once
// What the user sees while a job runs: a line that changes on a terminal, a log otherwise. spdlog lives in progress.cpp
// and nowhere else.

#include <memory>
#include <string>
#include <vector>

namespace kerf {

/// trace, debug, info, warn, error, off
const std::vector<std::string>& log_levels();

/// "1 h 05 min", "3 min 20 s", "12 s".
std::string duration(double seconds);

/// The line while a phase lasts, no longer than the terminal is wide: what is too long ends with an ellipsis, before
/// the seconds so far and, where more of them are expected in all, those that are left.
std::string status_line(const std::string& phase, double elapsed, double expected, std::size_t columns);

/// Goes to stderr. On a terminal, level info is one line, drawn twice a second and wiped in the end; every other level,
/// and a stderr that is no terminal, get plain lines.
class Progress {
 public:
  explicit Progress(const std::string& level);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void phase(const std::string& name);  // begins
  void expect(double seconds);          // that all phases take together
  void finish();                        // the last phase has ended

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kerf
