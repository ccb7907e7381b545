#pragma once
// Small inline drawings for the report page.

#include "io/result.hpp"

namespace kerf {

/// One bar per phase that took time, the longest first, with seconds and share of the total.
std::string time_bars(const Seconds& seconds);

/// One quantity along a crack against arc length; stretches where the crack is closed are shaded.
struct CrackCurve {
  std::string label;
  std::string color;  // as CSS writes it
  double (*value)(const CrackRow& row);
};
std::string crack_curve(const CrackResult& crack, const CrackCurve& curve);

}  // namespace kerf
