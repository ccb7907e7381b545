#pragma once
// Numbers with derivatives by six variables.

#include <Eigen/Core>
#include <cmath>

namespace kerf {

/// A value and its row of derivatives; rules of the chain for what biarcs need, no more.
struct Dual {
  using By = Eigen::Matrix<double, 1, 6>;
  double value = 0;
  By by = By::Zero();

  Dual() = default;
  Dual(double v) : value(v) {}
  Dual(double v, By d) : value(v), by(std::move(d)) {}
  static Dual variable(double v, int k) {
    Dual x(v);
    x.by[k] = 1;
    return x;
  }
};

inline Dual operator+(const Dual& a, const Dual& b) {
  return {a.value + b.value, a.by + b.by};
}
inline Dual operator-(const Dual& a, const Dual& b) {
  return {a.value - b.value, a.by - b.by};
}
inline Dual operator-(const Dual& a) {
  return {-a.value, -a.by};
}
inline Dual operator*(const Dual& a, const Dual& b) {
  return {a.value * b.value, a.value * b.by + b.value * a.by};
}
inline Dual operator/(const Dual& a, const Dual& b) {
  return {a.value / b.value, (a.by - a.value / b.value * b.by) / b.value};
}
inline Dual sqrt(const Dual& a) {
  const double root = std::sqrt(a.value);
  return {root, a.by / (2 * root)};
}
inline Dual sin(const Dual& a) {
  return {std::sin(a.value), std::cos(a.value) * a.by};
}
inline Dual cos(const Dual& a) {
  return {std::cos(a.value), -std::sin(a.value) * a.by};
}
inline Dual atan2(const Dual& y, const Dual& x) {
  const double squared = x.value * x.value + y.value * y.value;
  return {std::atan2(y.value, x.value), (x.value * y.by - y.value * x.by) / squared};
}

}  // namespace kerf
