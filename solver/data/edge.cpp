// Data on one edge, tractions, prescribed displacements, pressures: a polynomial P of degree 7 whose moments with
// polynomials of degree 7 are those of the data f, and what is proved of the rest. On a piece of length h (the edge has
// length 1) with |f^(8)|/8! <= c_8 some polynomial of degree 7 is as near as delta, and eight Gauss points integrate
// well:
//   delta = c_8/128 (h/2)^8,   |int f q - sum_i w_i (f q)(s_i)| <= 2 h delta max|q|   [theory: D.2],
//   |f - P|^2 <= sum over pieces (|f - P|_Gauss + 2 delta h^(1/2))^2                  [theory: D.3].
// Next to a power a + b d^e the part b is integrated with the Gauss points of the weight d^e [Golub, Welsch 1969];
// where only the range is known, the error is length times width. The piece with the largest error is split, at a break
// where one is known, until 1e-10 of int |f| is left. Black boxes are compared with P at stratified points instead, and
// hold as sampled. Derived in docs/theory/data.md, sections Edges and Black boxes.

#include "solver/data.hpp"
#include "solver/data/jacobi.hpp"
#include "solver/left_out.hpp"

#include "solver/element/local.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

using Values = Eigen::Matrix<double, 2, data_points>;

const EdgeRule& rule() {
  static const EdgeRule r = gauss(data_points);
  return r;
}

// Orthonormal Legendre polynomials at s.
Eigen::Matrix<double, data_points, 1> legendres(double s) {
  Eigen::Matrix<double, data_points, 1> v;
  for (int k = 0; k < data_points; ++k) v[k] = legendre(k, s);
  return v;
}

// Values at the points -> derivatives there.
// Barycentric differentiation; rows sum to 0, so that constants have no slope.
const Eigen::Matrix<double, data_points, data_points>& differences() {
  static const Eigen::Matrix<double, data_points, data_points> d = [] {
    Eigen::Matrix<double, data_points, data_points> m = decltype(m)::Zero();
    const Eigen::VectorXd& s = rule().s;
    std::array<double, data_points> weight;  // barycentric
    for (int i = 0; i < data_points; ++i) {
      weight[i] = 1;
      for (int j = 0; j < data_points; ++j)
        if (j != i) weight[i] /= s[i] - s[j];
    }
    for (int i = 0; i < data_points; ++i)
      for (int j = 0; j < data_points; ++j)
        if (j != i) {
          m(i, j) = weight[j] / weight[i] / (s[i] - s[j]);
          m(i, i) -= m(i, j);
        }
    return m;
  }();
  return d;
}

// Values at the points -> integrals from 0 to them.
// int_0^s of the interpolant by the rule scaled to [0, s]: exact for degree 7.
const Eigen::Matrix<double, data_points, data_points>& integrals() {
  static const Eigen::Matrix<double, data_points, data_points> d = [] {
    Eigen::Matrix<double, data_points, data_points> m = decltype(m)::Zero();
    const auto& [s, w] = rule();
    for (int i = 0; i < data_points; ++i)
      for (int q = 0; q < data_points; ++q) m.row(i) += s[i] * w[q] * trace_basis(rule(), s[i] * s[q]).transpose();
    return m;
  }();
  return d;
}

struct Part {
  double from, to;
  OnPiece known = {};
  Values at = Values::Zero();    // smooth parts only
  Vec2 distance = Vec2::Zero();  // from a polynomial of degree 7, at most; of the power's factor
  Vec2 error = Vec2::Zero();
  bool smooth = false, last = false;  // last: cannot be split
  double length() const {
    return to - from;
  }
  double total() const {
    return error.sum();
  }
};

// P, and what it leaves out, from the parts of an edge.
// All moments are summed before anything is left out: f - P is known only then.
class Collected {
 public:
  /// `size`: of the largest values.
  Collected(const std::vector<Part>& parts, double size) : parts_(parts), size_(size) {
    for (const Part& p : parts) add(p);
  }
  // `worst` for messages: the piece with the largest error; where a square is not integrable, the end at which the
  // power begins.
  EdgeValues result() {
    EdgeValues v;
    for (int q = 0; q < data_points; ++q) v.at.col(q) = moment_ * legendres(rule().s[q]);
    double largest = -1;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const Part& p = parts_[i];
      const Vec2 before = v.rest;
      const Values left = leave_out(i, v);
      follow_primitive(p, left, v.rest - before, v);
      v.error += p.error;
      if (!(p.total() <= largest)) largest = p.total(), v.worst = 0.5 * (p.from + p.to);
    }
    for (const Part& p : parts_)
      if (!v.rest.allFinite() && p.known.power) v.worst = p.known.power->at_low_end ? p.from : p.to;
    return v;
  }

 private:
  void add(const Part& p) {
    const double h = p.length();
    if (p.smooth)
      for (int q = 0; q < data_points; ++q)
        moment_ += h * rule().w[q] * p.at.col(q) * legendres(p.from + h * rule().s[q]).transpose();
    else if (p.known.power)
      add_power(p, *p.known.power);
    else
      for (int q = 0; q < data_points; ++q)
        moment_ += h * rule().w[q] * middle(p) * legendres(p.from + h * rule().s[q]).transpose();
  }
  // A range without end has no middle: such a piece counts as 0, with an infinite error.
  static Vec2 middle(const Part& p) {
    Vec2 m;
    for (int d = 0; d < 2; ++d) m[d] = 0.5 * p.known.value[d].low + 0.5 * p.known.value[d].high;
    return m.allFinite() ? m : Vec2::Zero();
  }
  static double place(const Part& p, const Power& power, double distance) {
    return power.at_low_end ? p.from + distance : p.to - distance;
  }
  // int d^e b q = h^(1 + e) times the rule of the weight s^e on [0, 1].
  void add_power(const Part& p, const Power& power) {
    const double h = p.length();
    for (int q = 0; q < data_points; ++q) {
      const double s = p.from + h * rule().s[q];
      moment_ += h * rule().w[q] * power.parts(s).first * legendres(s).transpose();
    }
    const EdgeRule jacobi = gauss_jacobi(power.exponent, data_points);
    for (int q = 0; q < data_points; ++q) {
      const double s = place(p, power, h * jacobi.s[q]);
      moment_ += std::pow(h, 1 + power.exponent) * jacobi.w[q] * power.parts(s).second * legendres(s).transpose();
    }
  }

  // The primitive of f - P goes on over a part, of which the values at the points are known, or the square.
  void follow_primitive(const Part& p, const Values& left, const Vec2& square, EdgeValues& v) {
    const double h = p.length();
    for (int d = 0; d < 2; ++d) {
      margin_[d] += p.error[d];
      if (!p.smooth) {
        // Of an infinite square the integral of |f - P|, from the largest factor at a few points.
        margin_[d] += square[d] < infinity || !p.known.power ? std::sqrt(h * square[d]) : integral_at_power(p, d);
        v.primitive[d] += h * std::pow(std::abs(primitive_[d]) + margin_[d], 2);
        continue;
      }
      const Eigen::Matrix<double, data_points, 1> along =
          h * integrals() * left.row(d).transpose() + primitive_[d] * Eigen::Matrix<double, data_points, 1>::Ones();
      v.primitive[d] += h * std::pow(std::sqrt(along.cwiseAbs2().dot(rule().w)) + margin_[d], 2);
      primitive_[d] += h * left.row(d).dot(rule().w.transpose());
    }
  }

  // Twice the largest values at the points, times int d^e = h^(1 + e)/(1 + e).
  double integral_at_power(const Part& p, int d) const {
    const Power& power = *p.known.power;
    const double h = p.length();
    double regular = 0, factor = 0;
    for (int q = 0; q < data_points; ++q) {
      const double s = p.from + h * rule().s[q];
      const auto [a, b] = power.parts(s);
      regular = std::max(regular, std::abs(a[d] - moment_.row(d).dot(legendres(s))));
      factor = std::max(factor, std::abs(b[d]));
    }
    return 2 * (h * regular + factor * std::pow(h, 1 + power.exponent) / (1 + power.exponent));
  }

  // Adds the squares of f - P and of its derivative; f - P at the points where that is smooth.
  Values leave_out(std::size_t i, EdgeValues& v) const {
    const Part& p = parts_[i];
    const double h = p.length();
    Values rest = p.at;
    if (p.smooth) {
      for (int q = 0; q < data_points; ++q) rest.col(q) -= moment_ * legendres(p.from + h * rule().s[q]);
      const Values slope = rest * differences().transpose() / h;
      for (int d = 0; d < 2; ++d) {
        const double seen = std::sqrt(h * rest.row(d).cwiseAbs2().dot(rule().w.transpose()));
        v.rest[d] += std::pow(seen + 2 * p.distance[d] * std::sqrt(h), 2);
        v.rough[d] += h * slope.row(d).cwiseAbs2().dot(rule().w.transpose());
      }
    } else if (p.known.power) {
      leave_out_power(p, *p.known.power, v);
    } else {
      const Vec2 here = moment_ * legendres(0.5 * (p.from + p.to));
      const Vec2 change = change_over(i);
      for (int d = 0; d < 2; ++d) {
        const auto& [low, high] = p.known.value[d];
        v.rest[d] += h * std::pow(std::max(std::abs(low - here[d]), std::abs(high - here[d])), 2);
        v.rough[d] += change[d] * change[d] / h;
      }
      constexpr double step = 1e-9;
      if (change.maxCoeff() > step * size_) v.jumps = true;
    }
    return rest;
  }
  // How much f changes over a part of which only the range is known: over a cut between two smooth parts, by what their
  // polynomials have at it. Both branches of a function may turn over there, and their sum be continuous.
  Vec2 change_over(std::size_t i) const {
    const Part& p = parts_[i];
    constexpr double cut = 1e-12;
    if (p.last && p.length() < cut && i > 0 && i + 1 < parts_.size() && parts_[i - 1].smooth && parts_[i + 1].smooth)
      return (parts_[i + 1].at * trace_basis(rule(), 0) - parts_[i - 1].at * trace_basis(rule(), 1)).cwiseAbs();
    Vec2 change;
    for (int d = 0; d < 2; ++d) change[d] = p.known.value[d].high - p.known.value[d].low;
    return change;
  }
  // (A - P + C d^p)^2.
  // d^(2 e) is integrable for 2 e > -1 alone. The square is (A - P)^2 + 2 (A - P) C d^e + C^2 d^(2 e), each term with
  // the rule of its own weight.
  void leave_out_power(const Part& p, const Power& power, EdgeValues& v) const {
    const double h = p.length(), e = power.exponent;
    v.rough.setConstant(infinity);
    if (2 * e <= -1) {
      for (int d = 0; d < 2; ++d)
        if (power.factor_eighth[d] != 0 || power.parts(0.5 * (p.from + p.to)).second[d] != 0) v.rest[d] = infinity;
      return;
    }
    Vec2 square = Vec2::Zero();
    const auto integrate = [&](double exponent, auto&& term) {
      const EdgeRule jacobi = exponent == 0 ? rule() : gauss_jacobi(exponent, data_points);
      for (int q = 0; q < data_points; ++q) {
        const double s = place(p, power, h * jacobi.s[q]);
        const auto [regular, factor] = power.parts(s);
        const Vec2 rest = regular - moment_ * legendres(s);
        square += std::pow(h, 1 + exponent) * jacobi.w[q] * term(rest, factor);
      }
    };
    integrate(0, [](const Vec2& rest, const Vec2&) -> Vec2 { return rest.cwiseAbs2(); });
    integrate(e, [](const Vec2& rest, const Vec2& factor) -> Vec2 { return 2 * rest.cwiseProduct(factor); });
    integrate(2 * e, [](const Vec2&, const Vec2& factor) -> Vec2 { return factor.cwiseAbs2(); });
    for (int d = 0; d < 2; ++d)
      v.rest[d] += std::pow(
          std::sqrt(std::max(0.0, square[d])) + 2 * p.distance[d] * std::sqrt(std::pow(h, 1 + 2 * e) / (1 + 2 * e)), 2);
  }

  const std::vector<Part>& parts_;  // in their order along the edge
  double size_;
  Eigen::Matrix<double, 2, data_points> moment_ = decltype(moment_)::Zero();  // with the Legendre polynomials
  Vec2 primitive_ = Vec2::Zero(), margin_ = Vec2::Zero();                     // so far, and its error
};

// `size`: the largest value of the data anywhere, so that an edge where they are next to nothing is not refined to its
// own rounding.
class EdgeIntegration {
 public:
  EdgeIntegration(const BoundaryField& f, const EdgeLine& edge, const char* what, double size)
      : f_(f), edge_(edge), what_(what), size_(std::max(size, size_on(f, edge))) {}
  /// `at`: of a curved edge its value at s.
  EdgeIntegration(const BoundaryField& f, const EdgeLine& edge, const char* what, double size,
                  std::function<Vec2(double)> at)
      : f_(f), edge_(edge), what_(what), size_(std::max(size, size_on(f, edge))), at_(std::move(at)) {}

  EdgeValues run() {
    if (f_.known()) {
      EdgeValues v = enclosed();
      if (!contradicted_) return v;
      parts_.clear();
    }
    return sampled();
  }

 private:
  // By `at_` on curved edges, along the chord on straight ones.
  Vec2 value(double s) const {
    const Vec2 x = edge_.a + s * (edge_.b - edge_.a), v = at_ ? at_(s) : f_(x, edge_.n);
    if (!v.allFinite())
      throw Error(Fault::Numerics, fmt::format("the {} is not finite at ({:.6g}, {:.6g})", what_, x.x(), x.y()));
    return v;
  }
  Values values(double from, double to) const {
    Values v;
    for (int q = 0; q < data_points; ++q) v.col(q) = value(from + (to - from) * rule().s[q]);
    return v;
  }
  // One smooth piece: P takes the values of f at the points, and leaves out 2 delta at most (D.3).
  EdgeValues collect() {
    EdgeValues v;
    if (parts_.size() == 1 && parts_[0].smooth) {
      v.at = parts_[0].at;
      v.error = parts_[0].error;
      v.rest = 4 * parts_[0].distance.cwiseAbs2();
      v.primitive = v.rest;
      constexpr double inverse = 100;  // the derivative of a polynomial of degree 8 is at most 2 * 8^2 times as large
      v.rough = inverse * inverse * v.rest;
      return v;
    }
    std::sort(parts_.begin(), parts_.end(), [](const Part& a, const Part& b) { return a.from < b.from; });
    return Collected(parts_, std::max(size_, scale_)).result();
  }

  // ---- with enclosures
  // A value outside of what is said to enclose it, beyond rounding, means that the enclosure is of another function:
  // then the data are sampled. Pieces of 2^-52 of the edge cannot be split.
  void enclose(double from, double to, bool last) {
    if (!(to > from)) return;
    Part p{.from = from, .to = to, .known = f_.known()->along(edge_, from, to), .last = last};
    const double h = to - from;
    ++evaluations_;
    if (std::isfinite(p.known.eighth[0]) && std::isfinite(p.known.eighth[1])) {
      p.smooth = true;
      p.at = values(from, to);
      for (int d = 0; d < 2; ++d) {
        p.distance[d] = left_by_interpolation(p.known.eighth[d], h);
        const auto& [low, high] = p.known.value[d];
        constexpr double slack = 1e-9;
        const double allowed = slack * (std::abs(low) + std::abs(high)) + std::numeric_limits<double>::min();
        if (p.at.row(d).minCoeff() < low - allowed || p.at.row(d).maxCoeff() > high + allowed) contradicted_ = true;
      }
      p.error = 2 * h * p.distance;
    } else if (p.known.power && p.known.power->exponent > -1) {
      const Power& power = *p.known.power;
      const double mass = std::pow(h, 1 + power.exponent) / (1 + power.exponent);
      for (int d = 0; d < 2; ++d) {
        p.distance[d] = left_by_interpolation(power.factor_eighth[d], h);
        p.error[d] = 2 * mass * p.distance[d] + 2 * h * left_by_interpolation(power.regular_eighth[d], h);
      }
    } else {
      p.known.power.reset();
      for (int d = 0; d < 2; ++d) p.error[d] = h * (p.known.value[d].high - p.known.value[d].low);
    }
    constexpr double finest = 0x1p-52;
    if (h <= finest || p.total() == 0) p.last = true;
    parts_.push_back(std::move(p));
  }
  // int |f| over a smooth piece. The others count as nothing: the tolerance is of what is known.
  double size(const Part& p) const {
    return p.smooth ? p.length() * (p.at.cwiseAbs() * rule().w).sum() : 0;
  }
  // At a break three pieces: before, after, and the break itself, as narrow as the numbers of places allow.
  void split(std::size_t worst) {
    const Part p = parts_[worst];
    parts_.erase(parts_.begin() + static_cast<std::ptrdiff_t>(worst));
    if (p.known.cut) {
      enclose(p.from, p.known.cut->low, false);
      enclose(p.known.cut->low, p.known.cut->high, true);
      enclose(p.known.cut->high, p.to, false);
      return;
    }
    const double middle = 0.5 * (p.from + p.to);
    enclose(p.from, middle, false);
    enclose(middle, p.to, false);
  }
  // Pieces that cannot be split leave errors that no further splitting undoes: then 1e-3 of these is little. 3000 looks
  // are the budget of an edge.
  EdgeValues enclosed() {
    constexpr int most = 3000;
    constexpr double tolerance = 1e-10, negligible = 1e-3;
    enclose(0, 1, false);
    if (!parts_[0].smooth) values(0, 1);  // refuses what has no value
    while (!contradicted_ && evaluations_ < most) {
      double whole = 0, open = 0, stays = 0, largest = -1;
      std::size_t worst = 0;
      for (std::size_t i = 0; i < parts_.size(); ++i) {
        whole += size(parts_[i]);
        if (!parts_[i].last) open += parts_[i].total();
        if (parts_[i].last && std::isfinite(parts_[i].total())) stays += parts_[i].total();
        if (!parts_[i].last && !(parts_[i].total() <= largest)) largest = parts_[i].total(), worst = i;
      }
      const double floor = std::numeric_limits<double>::epsilon() * size_ + std::numeric_limits<double>::min();
      if (largest < 0 || open <= std::max({tolerance * whole, negligible * stays, floor})) break;
      split(worst);
    }
    EdgeValues v = collect();
    // Of the mean, or of what the numbers of the places can resolve of the largest value.
    constexpr double resolved = 1e-6, of_largest = 1e-13;
    const double whole = v.at.cwiseAbs().sum() / data_points;
    if (!(v.error.sum() <= std::max(resolved * whole, of_largest * size_))) v.how = Resolution::Open;
    return v;
  }

  // ---- without
  // The largest difference from the polynomial through the values, at one point in each of `strata`.
  // Shifts within the strata follow multiples of the golden ratio: a feature that repeats with the strata does not stay
  // between the points.
  Vec2 deviation(const Part& p, int strata) const {
    Vec2 largest = Vec2::Zero();
    constexpr double golden = 0.6180339887498949;
    for (int i = 0; i < strata; ++i) {
      const double shift = std::fmod(golden * (i + 1) + 7.3 * p.from + 0.5, 1.0), at = (i + shift) / strata;
      const Vec2 here = value(p.from + p.length() * at), seen = p.at * trace_basis(rule(), at);
      largest = largest.cwiseMax((here - seen).cwiseAbs());
    }
    return largest;
  }
  void sample(double from, double to, int strata) {
    Part p{.from = from, .to = to, .smooth = true};
    p.at = values(from, to);
    p.distance = deviation(p, strata);
    scale_ = std::max(scale_, p.at.cwiseAbs().maxCoeff());
    // Gauss points square the relative error of interpolation where the data are smooth.
    const double share = scale_ > 0 ? std::min(1.0, p.distance.maxCoeff() / scale_) : 0;
    p.error = p.length() * share * p.distance;
    constexpr double finest = 0x1p-20;
    p.last = p.length() <= finest;
    parts_.push_back(p);
  }
  // Each half of a piece that deviates is looked at again, in order along the edge, down to 2^-20 or 400 pieces.
  EdgeValues sampled() {
    constexpr int coarse = 24, fine = 8;
    constexpr std::size_t most = 400;
    constexpr double tolerance = 1e-8;
    scale_ = 0;
    sample(0, 1, coarse);
    for (std::size_t i = 0; i < parts_.size() && parts_.size() < most;) {
      scale_ = std::max(scale_, parts_[i].distance.maxCoeff());
      if (parts_[i].last || parts_[i].distance.maxCoeff() <= tolerance * scale_) {
        ++i;
        continue;
      }
      const Part p = parts_[i];
      parts_.erase(parts_.begin() + static_cast<std::ptrdiff_t>(i));
      const double middle = 0.5 * (p.from + p.to);
      sample(p.from, middle, fine);
      sample(middle, p.to, fine);
    }
    EdgeValues v = collect();
    constexpr double step = 1e-3;
    for (const Part& p : parts_)
      if (p.last && p.distance.maxCoeff() > step * scale_) v.jumps = true;
    if (v.jumps) v.rough.setConstant(infinity);
    v.how = parts_.size() < most ? Resolution::Sampled : Resolution::Open;
    return v;
  }

  const BoundaryField& f_;
  const EdgeLine& edge_;
  const char* what_;
  double size_;
  std::vector<Part> parts_;
  int evaluations_ = 0;
  bool contradicted_ = false;  // a value lies outside of what encloses it
  double scale_ = 0;
  std::function<Vec2(double)> at_;
};

}  // namespace

EdgeLine edge_line(const EdgeOf& of) {
  EdgeLine line = edge_line(of.mesh, of.edge);
  if (const EdgeCurvature* curvature = curvature_at(of.curvatures, of.edge)) line.curvature = curvature->q;
  return line;
}

// On a curved edge the data are functions of s along its polynomial, with its normal; enclosures take the same line.
EdgeValues edge_values(const BoundaryField& f, const EdgeOf& of, const char* what, bool density, double size) {
  EdgeLine line = edge_line(of);
  if (line.is_straight()) return edge_values(f, line, what, size);
  line.density = density;
  const double chord = (line.b - line.a).norm();
  const auto at = [&](double s) -> Vec2 {
    const OnEdge p = on_edge(of.mesh, of.curvatures, of.edge, s);
    const double speed = p.slope.norm();
    return (density ? speed / chord : 1) * f(p.x, normal_at(p, line.n) / speed);
  };
  return EdgeIntegration(f, line, what, size, at).run();
}

EdgeValues edge_values(const BoundaryField& f, const EdgeLine& edge, const char* what, double size) {
  return EdgeIntegration(f, edge, what, size).run();
}

// From the enclosure of the whole edge, which is often too wide: a scale, not a maximum.
double size_on(const BoundaryField& f, const EdgeLine& edge) {
  if (!f.known()) return 0;
  double size = 0;
  for (const Interval& v : f.known()->along(edge, 0, 1).value)
    size = std::max({size, std::abs(v.low), std::abs(v.high)});
  return std::isfinite(size) ? size : 0;
}

}  // namespace kerf
