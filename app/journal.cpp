#include "app/journal.hpp"

#include "kerf/stop.hpp"

#include <algorithm>

namespace kerf {

void Journal::begin(const std::string& name) {
  check_stop();
  phase = name;
  if (options.on_phase) options.on_phase(phase);
  lap();
}

void Journal::show_last_first() {
  if (png) std::rotate(pictures.begin(), pictures.end() - 1, pictures.end());
}

void Journal::list(const std::string& name, const std::string& caption) {
  std::erase_if(pictures, [&](const auto& earlier) { return earlier.second == file(name); });
  pictures.emplace_back(caption, file(name));
}

}  // namespace kerf
