#pragma once
// Data of a scene as functions of the place: callables, and what may be known of them beyond their values at points.

#include "kerf/types.hpp"

#include <array>
#include <concepts>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

namespace kerf {

/// All numbers from low to high.
struct Interval {
  double low = -infinity, high = infinity;
};

/// x(s) = a + s (b - a) + s (1 - s) (curvature[0] + curvature[1] s + curvature[2] s^2) for 0 <= s <= 1: an edge of the
/// boundary, with the outward unit normal n of its chord. Where it is curved, data are given the normal of the curve.
struct EdgeLine {
  Vec2 a, b, n;
  std::array<Vec2, 3> curvature = {Vec2::Zero(), Vec2::Zero(), Vec2::Zero()};
  bool density = false;  // data count per length of the chord: times |dx/ds| / |b - a|
  bool is_straight() const {
    return curvature[0].isZero(0) && curvature[1].isZero(0) && curvature[2].isZero(0);
  }
};

/// f = regular + factor d^exponent next to an end of a piece, d the distance from it in s, both parts smooth.
struct Power {
  bool at_low_end = true;
  double exponent = 0;
  std::array<double, 2> regular_eighth{0, 0}, factor_eighth{0, 0};  // as OnPiece::eighth
  std::function<std::pair<Vec2, Vec2>(double s)> parts;             // regular, factor
};

/// What is proved of the two components of a field on a piece from <= s <= to of a segment.
struct OnPiece {
  std::array<Interval, 2> value{};                      // holds every value
  std::array<double, 2> eighth = {infinity, infinity};  // at least |d^8 f/ds^8|/8!; infinite where that is not known
  /// Within it lies a break that splits the piece; as narrow as the numbers allow, so that both sides can be known.
  std::optional<Interval> cut;
  std::optional<Power> power;  // where eighth is infinite because of it
};

/// Enclosures of a field. Never wrong: what cannot be enclosed is the whole line. Safe to call from several threads.
class Enclosure {
 public:
  Enclosure() = default;
  Enclosure(const Enclosure&) = delete;
  Enclosure& operator=(const Enclosure&) = delete;
  virtual ~Enclosure() = default;
  virtual OnPiece along(const EdgeLine& edge, double from, double to) const = 0;
  /// Over the box x * y, away from boundaries: where a normal is asked for, the whole line.
  virtual std::array<Interval, 2> over(const Interval& x, const Interval& y) const = 0;
  /// At least the distance of each component from some polynomial of this degree, over the box x * y. `degree` up to 7;
  /// infinite where it is not known.
  virtual std::array<double, 2> remainder(const Interval&, const Interval&, int) const {
    return {infinity, infinity};
  }
  /// Degree of the polynomial in x and y that the field is, or -1.
  virtual int degree() const = 0;
};

/// A vector as a function of the place. Whatever can be called so converts to it, and it is as light as a function;
/// one that comes from an expression carries enclosures, without which data are sampled at points.
template <typename... Place>
class DataField {
 public:
  DataField() = default;
  template <typename Callable>
  requires(!std::same_as<std::remove_cvref_t<Callable>, DataField> &&
           std::constructible_from<std::function<Vec2(Place...)>, Callable>)
      DataField(Callable&& value, std::shared_ptr<const Enclosure> known = nullptr)
      : value_(std::forward<Callable>(value)), known_(std::move(known)) {}
  Vec2 operator()(Place... place) const {
    return value_(place...);
  }
  explicit operator bool() const {
    return static_cast<bool>(value_);
  }
  /// Null for a black box.
  const std::shared_ptr<const Enclosure>& known() const {
    return known_;
  }

 private:
  std::function<Vec2(Place...)> value_;
  std::shared_ptr<const Enclosure> known_;
};

/// Data on the boundary as a function of the point and the outward unit normal.
using BoundaryField = DataField<const Vec2&, const Vec2&>;
using VectorField = DataField<const Vec2&>;

/// a + b, with what is known of both.
VectorField sum(const VectorField& a, const VectorField& b);

/// factor a, with what is known of a.
VectorField scaled(double factor, const VectorField& a);

/// A field that is linear in the place, and known to be.
VectorField linear_field(std::function<Vec2(const Vec2& x)> f);

}  // namespace kerf
