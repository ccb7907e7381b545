#pragma once
// Small inline drawings for the report page.

#include "io/result.hpp"

namespace kerf {

/// One bar per phase that took time, the longest first, with seconds and share of the total.
std::string time_bars(const Seconds& seconds);

}  // namespace kerf
