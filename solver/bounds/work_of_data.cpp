// int t . G and int f . G: the work of the data of a state on the field G of a quantity, which is what is known of it
// without a dual solution [theory: B.11, B.20]. The data are a polynomial P with an enclosed remainder on each piece, G
// is analytic away from its singular place, so that
//   | int f . G - int P . G | <= Delta max |G| + |f - P| max |G - Q|      [theory: D.5],
// Q the part of G in polynomials of degree 7. On edges by Legendre coefficients of G. In the disc where G fades by
// pieces of the polar coordinates (sqrt(r), theta), in which r G is smooth; the worst piece is cut in four until the
// sum of the errors is small. docs/theory/data.md, "Works on singular fields".

#include "solver/bounds/work_of_data.hpp"

#include "base/quadrature.hpp"
#include "solver/data/near_tip.hpp"
#include "solver/data/refined.hpp"
#include "solver/left_out.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace kerf {

/// The polynomial of degree 7 with three derivatives 0 at both ends: 1 - t^4 (35 - 84 t + 70 t^2 - 20 t^3).
double Fade::operator()(double r) const {
  const double t = std::clamp((r - inner) / (outer - inner), 0.0, 1.0), t4 = t * t * t * t;
  return 1 - t4 * (35 + t * (-84 + t * (70 - 20 * t)));
}

double Fade::slope(double r) const {
  const double t = (r - inner) / (outer - inner);
  const double both = t * (1 - t);
  return t <= 0 || t >= 1 ? 0 : -140 * both * both * both / (outer - inner);
}

namespace {

constexpr int fine_points = 24;

/// What polynomials of degree 7 leave of an analytic function on an edge, at most, from its values at Gauss points:
/// Legendre coefficients, which fall at least as fast beyond the last ones as they did before.
/// The orthonormal polynomial of degree k has the largest value sqrt(2 k + 1). Of the coefficients 8 to 15 the last
/// four count twice, for those beyond them.
double left_of_analytic(const EdgeRule& rule, const Eigen::RowVectorXd& values) {
  constexpr int known = 16, last = 12;
  double left = 0;
  for (int k = data_points; k < known; ++k) {
    double c = 0;
    for (Eigen::Index q = 0; q < rule.s.size(); ++q) c += rule.w[q] * values[q] * legendre(k, rule.s[q]);
    left += (k < last ? 1 : 2) * std::abs(c) * std::sqrt(2.0 * k + 1);
  }
  return left;
}

/// int t.G over one edge: t is a polynomial, and a rest that is orthogonal to polynomials.
/// 24 points: the product of a polynomial of degree 7 and of G, whose coefficients beyond the 15th are estimated.
void add_edge(const Model& m, const EdgeValues& t, Index e, const Nucleus& G, Known& known) {
  static const EdgeRule fine = gauss(fine_points), carrier = gauss(data_points);
  static const Eigen::MatrixXd to_fine = [] {
    Eigen::MatrixXd all(data_points, fine_points);
    for (int q = 0; q < fine_points; ++q) all.col(q) = trace_basis(carrier, fine.s[q]);
    return all;
  }();
  Points field(2, fine_points);
  for (int q = 0; q < fine_points; ++q)
    field.col(q) = G.displacement(on_edge(m.mesh, m.inner->skeleton.curvatures, e, fine.s[q]).x);
  const Points load = t.at * to_fine;
  const double l = length(m.mesh, e);
  known.value += l * load.cwiseProduct(field).colwise().sum().dot(fine.w.transpose());
  for (int d = 0; d < 2; ++d) {
    known.error += l * t.error[d] * field.row(d).cwiseAbs().maxCoeff();
    if (t.rest[d] > 0) known.error += l * std::sqrt(t.rest[d]) * left_of_analytic(fine, field.row(d));
  }
  known.sampled = known.sampled || (t.how == Resolution::Sampled && !t.at.isZero(0));
}

}  // namespace

Known work_of_tractions(const Model& m, const Nucleus& G) {
  Known known;
  for (const LoadedEdges& t : m.inner->data.tractions)
    for (std::size_t j = 0; j < t.values.size(); ++j)
      add_edge(m, t.values[j], labeled(m.inner->data, t.label)[j], G, known);
  return known;
}

namespace {

/// The step from 0 to 1 that rests at both ends: what grows there like a logarithm is smooth in t.
double eased(double t) {
  return t * t * t * (10 + t * (6 * t - 15));
}
double easing(double t) {
  return 30 * std::pow(t * (1 - t), 2);
}

/// A coordinate as a function of u from 0 to 1, growing.
/// Root: u is linear in sqrt(r), in which r G is smooth for G like r^-1/2 and like 1/r. Eased: both ends at rest, for
/// fields that grow like a logarithm at the ends of a line or jump there.
struct Along {
  double from, to;
  enum class Kind { Even, Eased, Root } kind;
  double at(double u) const {
    switch (kind) {
      case Kind::Even:
        return from + u * (to - from);
      case Kind::Eased:
        return from + eased(u) * (to - from);
      default:
        return std::pow(root(u), 2);
    }
  }
  double slope(double u) const {
    switch (kind) {
      case Kind::Even:
        return to - from;
      case Kind::Eased:
        return easing(u) * (to - from);
      default:
        return 2 * root(u) * (std::sqrt(to) - std::sqrt(from));
    }
  }

 private:
  double root(double u) const {
    return std::sqrt(from) + u * (std::sqrt(to) - std::sqrt(from));
  }
};

/// All values of the cosine between two angles that are half a turn apart at most.
/// The extremes within are those at whole multiples of pi; `margin` covers the rounding of cos and of the angles.
Interval cosines(double from, double to) {
  constexpr double margin = 1e-14;
  Interval c{std::min(std::cos(from), std::cos(to)) - margin, std::max(std::cos(from), std::cos(to)) + margin};
  for (double k = std::ceil(from / pi - margin); k <= std::floor(to / pi + margin); ++k)
    (std::fmod(k, 2) == 0 ? c.high : c.low) = std::fmod(k, 2) == 0 ? 1 + margin : -1 - margin;
  return c;
}
Interval scaled(double from, double to, const Interval& c, double middle) {
  const double rounding = 1e-14 * (std::abs(middle) + to);
  return {middle + std::min(from * c.low, to * c.low) - rounding,
          middle + std::max(from * c.high, to * c.high) + rounding};
}

/// Eight sectors, each with the parts within the rough radius, where G does not fade, and where it does: G is smooth in
/// each.
class WorkOfBody {
 public:
  WorkOfBody(const VectorField& f, const FadingField& field) : f_(f), field_(field) {
    const Fade& fade = field.fade;
    const bool rough = field.rough > 0;
    const std::vector<double> ends =
        rough ? std::vector{0.0, field.rough, fade.inner, fade.outer} : std::vector{0.0, fade.inner, fade.outer};
    constexpr int arcs = 8;
    for (int arc = 0; arc < arcs; ++arc)
      for (std::size_t part = 0; part + 1 < ends.size(); ++part)
        if (ends[part + 1] > ends[part])
          wholes_.push_back({Along{ends[part], ends[part + 1], rough ? Along::Kind::Eased : Along::Kind::Root},
                             Along{field.start + 2 * pi / arcs * arc, field.start + 2 * pi / arcs * (arc + 1),
                                   rough ? Along::Kind::Eased : Along::Kind::Even}});
  }

  /// Pieces are squares in the two parameters of their whole; the worst one is cut in four, 6,000 pieces at most.
  Known known() const {
    std::vector<IntegrationPiece> pieces(wholes_.size());
    for (std::size_t i = 0; i < pieces.size(); ++i) pieces[i].whole = i;
    constexpr int most = 6000;
    return refined(
        std::move(pieces), most, [this](IntegrationPiece& p) { evaluate(p); },
        [](const IntegrationPiece& p) {
          std::vector<IntegrationPiece> four(4, p);
          for (std::size_t d = 0; d < 2; ++d) {
            const double middle = 0.5 * (p.from[d] + p.to[d]);
            for (std::size_t k = 0; k < 4; ++k) ((k >> d) % 2 == 0 ? four[k].to : four[k].from)[d] = middle;
          }
          return four;
        });
  }

 private:
  struct Sum {
    double value = 0, size = 0;
    Vec2 field = Vec2::Zero();  // of |G|
  };
  /// A product rule in (u, v): dx = r dr dtheta with the slopes of both coordinates.
  Sum by(const EdgeRule& rule, const IntegrationPiece& p) const {
    const auto& [radius, angle] = wholes_[p.whole];
    Sum sum;
    const double du = p.to[0] - p.from[0], dv = p.to[1] - p.from[1];
    for (Eigen::Index j = 0; j < rule.s.size(); ++j) {
      const double v = p.from[1] + rule.s[j] * dv, theta = angle.at(v);
      const Vec2 way(std::cos(theta), std::sin(theta));
      for (Eigen::Index i = 0; i < rule.s.size(); ++i) {
        const double u = p.from[0] + rule.s[i] * du, r = radius.at(u);
        const Vec2 x = field_.middle + r * way;
        const double weight = rule.w[i] * rule.w[j] * du * dv * radius.slope(u) * angle.slope(v) * r * field_.fade(r);
        const Vec2 G = weight * field_.G.displacement(x);
        const double work = G.dot(f_(x));
        sum.value += work;
        sum.size += std::abs(work);
        sum.field += G.cwiseAbs();
      }
    }
    return sum;
  }
  /// The error of the rule for G by two rules; that of the data by a Taylor model over the box about the piece [theory:
  /// D.4], times int |G|.
  void evaluate(IntegrationPiece& p) const {
    static const EdgeRule coarse = gauss(8), fine = gauss(12);
    const Sum sum = by(fine, p);
    p.value = sum.value;
    p.size = sum.size;
    p.error = std::abs(sum.value - by(coarse, p).value);
    p.sampled = !f_.known();
    if (!f_.known()) return;
    const auto& [radius, angle] = wholes_[p.whole];
    const double r0 = radius.at(p.from[0]), r1 = radius.at(p.to[0]), a0 = angle.at(p.from[1]), a1 = angle.at(p.to[1]);
    const Interval x = scaled(r0, r1, cosines(a0, a1), field_.middle.x()),
                   y = scaled(r0, r1, cosines(a0 - pi / 2, a1 - pi / 2), field_.middle.y());
    const std::array<Interval, 2> range = f_.known()->over(x, y);
    constexpr double narrow = 1e-12;
    double largest = 0;
    for (const Interval& of : range) largest = std::max({largest, std::abs(of.low), std::abs(of.high)});
    const Vec2 left = left_by_polynomial(*f_.known(), x, y, range, narrow * largest).of;
    for (int d = 0; d < 2; ++d)
      if (sum.field[d] > 0) p.error += sum.field[d] * left[d];
  }

  const VectorField& f_;
  const FadingField& field_;
  std::vector<std::array<Along, 2>> wholes_;  // radius and angle
};

}  // namespace

Known work_of_body(const VectorField& f, const FadingField& field) {
  return WorkOfBody(f, field).known();
}

/// G opens the crack like r^(-1/2): times sqrt(r) it is smooth, and over_face has the power in its weight.
Known work_of_pressure(const BoundaryField& p, const FadingField& field, const Vec2& along) {
  const Vec2 up(-along.y(), along.x());
  const auto opening = [&](double r) {
    constexpr double side = 1e-9;  // of the distance: the faces are the same points
    const Vec2 x = field.middle - r * along;
    const Vec2 jump = field.G.displacement(x + side * r * up) - field.G.displacement(x - side * r * up);
    return field.fade(r) * up.dot(jump) * std::sqrt(r);
  };
  return over_face(p, {field.middle, field.middle - field.fade.outer * along, up}, {field.fade.inner}, opening);
}

}  // namespace kerf
