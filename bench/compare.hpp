#pragma once
// How long it takes to reach an error, read off a sequence of runs.

#include <optional>
#include <string>
#include <vector>

namespace kerf {

struct WorkPoint {
  double error, seconds;
};

struct TimeTo {
  enum class Kind {
    Interpolated,  // between two runs, on logarithmic axes
    AtMost,        // the coarsest run is good enough already
    Extrapolated,  // beyond the finest run, by less than a factor of 12 in the error
    Missed,        // no run comes near it: `seconds` and `error` are those of the finest
  } kind = Kind::Missed;
  double seconds = 0, error = 0;
};

/// Points in any order; those that are not positive and finite are left out. Nothing without points.
std::optional<TimeTo> time_to(std::vector<WorkPoint> points, double error);

/// Reached beats extrapolated beats missed; then the shorter time.
bool faster(const TimeTo& a, const TimeTo& b);

/// "0.012", "<=0.06", "~5.8", ">1.8 (1e-03)", "-".
std::string text(const std::optional<TimeTo>& time);

}  // namespace kerf
