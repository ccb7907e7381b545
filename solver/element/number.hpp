#pragma once
// What the local problem computes with: numbers of one triangle, or of four side by side, which the processor treats as
// one. What is written once for both costs a fourth per triangle; a triangle has the same bits in every place.

#include "kerf/types.hpp"

#include <array>
#include <cmath>
#include <type_traits>

// Without AVX a pack is two registers, and passed in another way: within a file that does not matter.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi"
#endif

namespace kerf {

using Pack = double __attribute__((vector_size(32)));
inline constexpr int pack_size = 4;

inline double lane(double x, int) {
  return x;
}
inline double lane(const Pack& x, int i) {
  return x[i];
}

inline double one_over_root(double x) {
  return 1 / std::sqrt(x);
}
inline Pack one_over_root(const Pack& x) {
  Pack root{};
  for (int i = 0; i < pack_size; ++i) root[i] = std::sqrt(x[i]);
  return 1.0 / root;
}

/// Rows of packs, one after the other.
template <int Rows, int Columns>
struct PackGrid {
  std::array<Pack, static_cast<std::size_t>(Rows* Columns)> all;

  static constexpr int size() {
    return Rows * Columns;
  }
  Pack* data() {
    return all.data();
  }
  const Pack* data() const {
    return all.data();
  }
  Pack& operator()(int i, int j) {
    return all[static_cast<std::size_t>(i * Columns + j)];
  }
  const Pack& operator()(int i, int j) const {
    return all[static_cast<std::size_t>(i * Columns + j)];
  }
  Pack& operator[](int i) {
    return all[static_cast<std::size_t>(i)];
  }
  const Pack& operator[](int i) const {
    return all[static_cast<std::size_t>(i)];
  }
};

// Filled by plain loops: each expression of Eigen on each size is some ten classes to compile, and there are eleven
// elements with five sizes each.
template <int Rows, int Columns>
using Rowwise = Eigen::Matrix<double, Rows, Columns, Columns == 1 ? Eigen::ColMajor : Eigen::RowMajor>;
template <class Number, int Rows, int Columns>
using Grid = std::conditional_t<std::is_same_v<Number, double>, Rowwise<Rows, Columns>, PackGrid<Rows, Columns>>;

template <class Array>
void set_zero(Array& a) {
  for (int i = 0; i < static_cast<int>(a.size()); ++i) a.data()[i] = std::remove_reference_t<decltype(a.data()[0])>{};
}

/// A vector in the plane of each of four triangles, with as much of Vec2 as the local problem takes.
class PackVec2 {
 public:
  PackVec2() = default;
  PackVec2(const Pack& x, const Pack& y) : x_(x), y_(y) {}
  const Pack& x() const {
    return x_;
  }
  const Pack& y() const {
    return y_;
  }
  Pack dot(const PackVec2& v) const {
    return x_ * v.x_ + y_ * v.y_;
  }
  void set(int i, const Vec2& v) {
    x_[i] = v.x();
    y_[i] = v.y();
  }
  friend PackVec2 operator+(const PackVec2& a, const PackVec2& b) {
    return {a.x_ + b.x_, a.y_ + b.y_};
  }
  friend PackVec2 operator-(const PackVec2& a, const PackVec2& b) {
    return {a.x_ - b.x_, a.y_ - b.y_};
  }
  friend PackVec2 operator*(const Pack& f, const PackVec2& v) {
    return {f * v.x_, f * v.y_};
  }
  friend PackVec2 operator*(double f, const PackVec2& v) {
    return {f * v.x_, f * v.y_};
  }

 private:
  Pack x_, y_;
};
template <class Number>
using Plane = std::conditional_t<std::is_same_v<Number, double>, Vec2, PackVec2>;

}  // namespace kerf
