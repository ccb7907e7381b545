// int_0^l p(r) w(r) dr/r^(1/2) along a crack's face from its tip on, p the pressure in the crack, w analytic in
// r^(1/2): the work of a pressure on the singular fields of a tip. In t = r^(1/2), dr/r^(1/2) = 2 dt, the integrand is
// smooth where p is; a pressure that begins like a power, p = a + b (r/l)^e with e > -1/2, has its part b integrated
// with the Gauss points of the weight t^(2 e). On a piece of which |p^(8)|/8! is known the error is at most 2 delta int
// |w| dr/r^(1/2) (D.2), else twice the width of its range; what two rules, of 12 and 16 points, differ by is added. The
// worst pieces are cut, at breaks where these are known [theory: D.5]. Derived in docs/theory/data.md, section Works on
// singular fields.

#include "solver/data/near_tip.hpp"

#include "base/quadrature.hpp"
#include "solver/data/jacobi.hpp"
#include "solver/data/refined.hpp"
#include "solver/left_out.hpp"

#include <cmath>
#include <optional>

namespace kerf {

namespace {

/// Pieces of the face from its end a on, in shares of its length.
class OverFace {
 public:
  OverFace(const BoundaryField& p, const EdgeLine& face, std::vector<double> breaks,
           const std::function<double(double)>& w)
      : p_(p), face_(face), length_((face.b - face.a).norm()), breaks_(std::move(breaks)), w_(w) {}

  Known known() const {
    std::vector<double> ends{0};
    for (const double at : breaks_)
      if (at > 0 && at < length_) ends.push_back(at / length_);
    ends.push_back(1);
    std::sort(ends.begin(), ends.end());
    constexpr int most = 4000;
    return refined(
        parts(IntegrationPiece(), ends), most, [this](IntegrationPiece& p) { evaluate(p); },
        [this](const IntegrationPiece& p) { return cut(p); });
  }

 private:
  Vec2 at(double r) const {
    return face_.a + r / length_ * (face_.b - face_.a);
  }
  double radius(double s) const {
    return s * length_;
  }
  // The integral, and those of |p w| and |w|: the size that errors are relative to, and what an error of p is
  // multiplied by.
  struct Sum {
    double value = 0, size = 0, field = 0;
    void add(double weight, double pressure) {
      value += weight * pressure;
      size += std::abs(weight * pressure);
      field += std::abs(weight);
    }
  };
  /// dr/sqrt(r) = 2 d sqrt(r).
  Sum by(const EdgeRule& rule, const IntegrationPiece& p) const {
    Sum sum;
    const double low = std::sqrt(radius(p.from[0])), high = std::sqrt(radius(p.to[0]));
    for (Eigen::Index q = 0; q < rule.s.size(); ++q) {
      const double r = std::pow(low + rule.s[q] * (high - low), 2);
      sum.add(2 * rule.w[q] * (high - low) * w_(r), p_(at(r), face_.n).x());
    }
    return sum;
  }
  // A piece of unknown range has an infinite error until it is cut.
  void evaluate(IntegrationPiece& p) const {
    static const EdgeRule coarse = gauss(12), fine = gauss(16);
    p.sampled = !p_.known();
    if (!p_.known()) return take(p, by(coarse, p), by(fine, p), 0);
    const OnPiece known = p_.known()->along(face_, p.from[0], p.to[0]);
    const double length = p.to[0] - p.from[0];
    if (std::isfinite(known.eighth[0]))
      return take(p, by(coarse, p), by(fine, p), 2 * left_by_interpolation(known.eighth[0], length));
    if (known.power && known.power->at_low_end && p.from[0] == 0) return take_power(p, *known.power);
    const double width = known.value[0].high - known.value[0].low;
    if (!std::isfinite(width)) {
      p.error = infinity;
      return;
    }
    take(p, by(coarse, p), by(fine, p), 2 * width);
  }
  static void take(IntegrationPiece& p, const Sum& coarse, const Sum& fine, double left) {
    p.value = fine.value;
    p.size = fine.size;
    p.error = std::abs(fine.value - coarse.value) + left * fine.field;
  }
  /// p = A + B s^e from the tip on: A as it is, B with the weight s^(e - 1/2).
  void take_power(IntegrationPiece& p, const Power& power) const {
    const double e = power.exponent, to = radius(p.to[0]);
    if (!(e > -0.5)) {
      p.error = infinity;
      return;
    }
    // Of one of them, in the root of r/to, with the power of it that is the weight.
    const auto sum = [&](double exponent, double scale, const auto& part) {
      return [=, this](int points) {
        Sum all;
        const EdgeRule rule = gauss_jacobi(exponent, points);
        for (int q = 0; q < points; ++q) {
          const double r = std::pow(rule.s[q], 2) * to;
          all.add(2 * rule.w[q] * std::sqrt(to) * scale * w_(r), part(r / length_));
        }
        return all;
      };
    };
    const auto regulars = sum(0, 1, [&power](double at) { return power.parts(at).first.x(); });
    const auto powers = sum(2 * e, std::pow(p.to[0], e), [&power](double at) { return power.parts(at).second.x(); });
    constexpr int coarse = 12, fine = 16;
    IntegrationPiece regular = p, singular = p;
    take(regular, regulars(coarse), regulars(fine), 2 * left_by_interpolation(power.regular_eighth[0], p.to[0]));
    take(singular, powers(coarse), powers(fine), 2 * left_by_interpolation(power.factor_eighth[0], p.to[0]));
    p.value = regular.value + singular.value;
    p.size = regular.size + singular.size;
    p.error = regular.error + singular.error;
  }
  /// At a break where one is known, which is passed over in a piece of its own; else in the middle.
  std::vector<IntegrationPiece> cut(const IntegrationPiece& p) const {
    std::vector<double> ends{p.from[0], p.to[0]};
    std::optional<Interval> at;
    if (p_.known()) at = p_.known()->along(face_, p.from[0], p.to[0]).cut;
    if (at)
      ends.insert(ends.begin() + 1, {at->low, at->high});
    else
      ends.insert(ends.begin() + 1, 0.5 * (p.from[0] + p.to[0]));
    return parts(p, ends);
  }
  static std::vector<IntegrationPiece> parts(const IntegrationPiece& of, const std::vector<double>& ends) {
    std::vector<IntegrationPiece> parts;
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      if (!(ends[i + 1] > ends[i])) continue;
      IntegrationPiece part = of;
      part.from[0] = ends[i];
      part.to[0] = ends[i + 1];
      parts.push_back(part);
    }
    return parts;
  }

  const BoundaryField& p_;
  const EdgeLine& face_;
  double length_;
  std::vector<double> breaks_;
  const std::function<double(double)>& w_;
};

}  // namespace

Known over_face(const BoundaryField& p, const EdgeLine& face, std::vector<double> breaks,
                const std::function<double(double r)>& w) {
  return OverFace(p, face, std::move(breaks), w).known();
}

}  // namespace kerf
