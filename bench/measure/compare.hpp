#pragma once
// How long it takes to reach an error, read off a sequence of runs.

#include <optional>
#include <span>
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

/// The fastest sequence to an error.
struct Fastest {
  std::string problem;
  double poisson = 0, error = 0;
  std::string name;  // "bdms 3, graded"; a peer's name
  TimeTo time;
};

/// Runs of named sequences, per problem and Poisson's ratio, in the order in which they come.
class Sequences {
 public:
  void add(const std::string& problem, double poisson, const std::string& name, const WorkPoint& run);
  /// Per problem and error to reach.
  std::vector<Fastest> fastest(std::span<const double> errors) const;

 private:
  struct Sequence {
    std::string name;
    std::vector<WorkPoint> runs;
  };
  struct Race {
    std::string problem;
    double poisson;
    std::vector<Sequence> sequences;
  };
  std::vector<Race> races_;
};

/// The one for the same problem, Poisson's ratio and error; null without one.
const Fastest* find(const std::vector<Fastest>& all, const Fastest& like);

/// Time of `peer` over that of `own`: "12", "<=12", "~12", "-".
std::string ratio(const TimeTo& peer, const TimeTo& own);

/// "0.012", "<=0.06", "~5.8", ">1.8 (1e-03)", "-".
std::string text(const std::optional<TimeTo>& time);

}  // namespace kerf
