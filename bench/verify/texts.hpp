#pragma once
// The files of bench/verify/cases.

#include "bench/measure/peer_scripts.hpp"

namespace kerf {

/// By name.
const std::vector<ScenarioText>& manual_texts();

}  // namespace kerf
