#pragma once
// A function through points, a cubic between any two of them, that rises and falls only where the points do.

#include <cstddef>
#include <span>
#include <vector>

namespace kerf::growth {

/// Slopes of the polynomial through the five nearest points, cut where the cubic would turn between two points
/// [Fritsch, Carlson 1980; Hyman 1983]: fourth order where the points are smooth. x rises; one point is a constant.
class MonotoneCubic {
 public:
  MonotoneCubic() = default;
  MonotoneCubic(std::span<const double> x, std::span<const double> y);
  /// Beyond the ends it is the value there.
  double operator()(double x) const;

 private:
  std::vector<double> x_, y_, slope_;
};

/// The points of half the resolution of n >= 2: every second one and the last, the step to which is never the shortest.
std::vector<std::size_t> every_second(std::size_t n);

}  // namespace kerf::growth
