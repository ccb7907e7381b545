#pragma once
// Plane vectors, indices, and the one exception type.

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

namespace kerf {

using Index = std::int32_t;
using Vec2 = Eigen::Vector2d;
using Mat2 = Eigen::Matrix2d;
using Points = Eigen::Matrix2Xd;  // one column per point

inline constexpr Index none = -1;
using std::numbers::pi;
inline constexpr double nan = std::numeric_limits<double>::quiet_NaN(),
                        infinity = std::numeric_limits<double>::infinity();

/// Thrown at the borders only (case file, geometry, unsolvable system, file system). The value is the exit code.
enum class Fault { Usage = 2, Geometry = 3, Numerics = 4, Files = 5 };
struct Error : std::runtime_error {
  Error(Fault fault, const std::string& what) : std::runtime_error(what), fault(fault) {}
  Fault fault;
};
/// Whether one body is at fault, which cannot be meshed or solved: a loop goes on with another one.
inline bool of_one_body(const Error& error) {
  return error.fault == Fault::Geometry || error.fault == Fault::Numerics;
}

inline double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace kerf
