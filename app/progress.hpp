#pragma once
// What the user sees while a job runs: a line that changes on a terminal, a log otherwise. spdlog lives in progress.cpp
// and nowhere else.

#include <memory>
#include <string>
#include <vector>

namespace kerf {

/// trace, debug, info, warn, error, off
const std::vector<std::string>& log_levels();

/// Goes to stderr. On a terminal, level info is one line that is wiped in the end; every other level, and a stderr that
/// is no terminal, get plain lines.
class Progress {
 public:
  explicit Progress(const std::string& level);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void phase(const std::string& name);  // begins
  void finish();                        // the last phase has ended

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kerf
