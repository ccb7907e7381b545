#pragma once
// Scripts for other programs that are kerf's own, and scenarios as case files; the text of the files in bench/peers and
// bench/scenarios.

#include <string>
#include <string_view>
#include <vector>

namespace kerf {

extern const std::string_view map_crack_script;
extern const std::string_view simp_scenario_script;

struct ScenarioText {
  std::string name;
  std::string_view text;
};
/// By name.
const std::vector<ScenarioText>& scenario_texts();

}  // namespace kerf
