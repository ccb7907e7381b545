// c2 of the second term over the whole body [theory: Q.8, Q.13]. Its local parts (gradients of the stress, curvature)
// are fitted at every place. The reply of the body is a quadratic form of the dipoles (r1 a1, q Re b1, q Im b1) with a
// symmetric matrix M(x) that knows the body alone: three solves per sample. M grows like 1/d^2 towards a straight side
// at distance d, and
//   M(x) / (1/2 int ds/|x - y|^3)   over boundary and cracks that move
// is smooth up to them: this is interpolated from at most 250 samples. What is not known of c2: the local parts once
// more on discs of two thirds of the radius, and of the reply what the other samples miss each of the four nearest ones
// by. Their sum is told with c2, as is the sum of its parts without signs, which (Q.14) turns into a radius.
// docs/theory/second_order.md, section "Everywhere".

#include "topo/map/second_map.hpp"

#include "base/parallel.hpp"
#include "solver/system.hpp"
#include "topo/map/green_samples.hpp"
#include "topo/map/mask.hpp"
#include "topo/map/reply.hpp"
#include "topo/map/second_known.hpp"
#include "topo/map/taylor.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

// Half of int ds/r^3 over all that the body ends at: the sum of 1/d^2 over straight sides at the distances d. The reply
// grows like that.
// 2/d^2 is int ds/r^3 beside a long straight side: half of it is 1/d^2.
class Walls {
 public:
  explicit Walls(const Model& m) {
    for (Index e = 0; e < static_cast<Index>(m.mesh.edges.size()); ++e) {
      const bool boundary = m.mesh.sides[e][0] == none || m.mesh.sides[e][1] == none;
      const bool moves = m.mesh.crack[e] != none && m.scene.laws[m.mesh.crack[e]].kind != CrackLaw::Kind::Bonded;
      if (boundary || moves) edges.emplace_back(m.mesh.points[m.mesh.edges[e][0]], m.mesh.points[m.mesh.edges[e][1]]);
    }
  }
  double operator()(const Vec2& x) const {
    double sum = 0;
    for (const auto& [a, b] : edges) sum += inverse_cubes(a, b, x);
    return 0.5 * sum;
  }

  std::vector<std::pair<Vec2, Vec2>> edges;
};

using Form = Eigen::Matrix3d;  // from (a_1, Re b_1, Im b_1) to (2 Re alpha, Re beta, Im beta), symmetric

Eigen::RowVectorXd entries(const Form& f) {
  return (Eigen::RowVectorXd(6) << f(0, 0), f(1, 1), f(2, 2), f(0, 1), f(0, 2), f(1, 2)).finished();
}
Form form_of(const Eigen::RowVectorXd& v) {
  return (Form() << v[0], v[3], v[4], v[3], v[1], v[5], v[4], v[5], v[2]).finished();
}

// Where a point may be looked at: its triangle, and the radius of the disc without features.
struct Place {
  Vec2 x;
  Index in;
  double clear;
};

// Column i is the reply to a unit of dipole i. The exact form is symmetric (reciprocity): what is not is the error of
// the fit, and the mean with the transpose takes it out.
Form sampled_form(BodyReply& body, const Model& m, const Place& at, const TaylorFit& fit) {
  const Material& material = material_of(m.mesh, m.scene, at.in);
  std::array<Nucleus, 3> unit{dipole_field(material, at.x, {1, 0}), dipole_field(material, at.x, {0, 1}),
                              dipole_field(material, at.x, {0, std::complex<double>(0, 1)})};
  constexpr double residual = 1e-7;
  const std::vector<TangentField> replies = body.to(at.x, unit, fit.triangles(), residual);
  Form f;
  for (int i = 0; i < 3; ++i) {
    const TaylorField w = fit.of(replies[static_cast<std::size_t>(i)]);
    f.col(i) << 2 * w.a1, w.b1.real(), w.b1.imag();
  }
  return 0.5 * (f + f.transpose());
}

// Samples of the form less its growth towards walls.
struct Samples {
  const Walls* walls;
  std::vector<Vec2> x = {};
  std::vector<Eigen::RowVectorXd> rest = {};  // over walls(x)
  double error = 0;
  std::vector<double> left = {};  // per sample: how far the others miss it, relative

  // How well the others tell each sample: what the interpolation leaves around it.
  void leave_one_out() {
    for (std::size_t k = 0; k < x.size(); ++k) {
      std::vector<Vec2> others = x;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
      const auto value = [&](std::size_t i) { return rest[i < k ? i : i + 1]; };
      const Form exact = form_of(rest[k]);
      left.push_back((form_of(interpolate_rows(others, walls->edges, value, x[k])) - exact).norm() / exact.norm());
    }
  }
  // The largest at the samples nearest by.
  double left_at(const Vec2& here) const {
    constexpr std::size_t nearest = 4;
    std::vector<std::pair<double, double>> by_distance;
    for (std::size_t k = 0; k < x.size(); ++k) by_distance.emplace_back((x[k] - here).norm(), left[k]);
    const std::size_t n = std::min(nearest, by_distance.size());
    std::partial_sort(by_distance.begin(), by_distance.begin() + static_cast<std::ptrdiff_t>(n), by_distance.end());
    double most = 0;
    for (std::size_t k = 0; k < n; ++k) most = std::max(most, by_distance[k].second);
    return most;
  }

  Form at(const Vec2& here) const {
    const auto value = [&](std::size_t k) { return rest[k]; };
    return (*walls)(here)*form_of(interpolate_rows(x, walls->edges, value, here));
  }
};

// Each next one where the spacing against the distance to the walls is the widest, until the form at the next ones is
// predicted well enough.
Samples sample(const Model& m, const Field& s, const Walls& walls, std::span<const Place> places) {
  // `accurate` is of the norm of the form. The disc of a fit fills 0.7 of the way to the next feature.
  constexpr double part = 0.7, accurate = 0.02;
  constexpr int most = 250, batch = 20, least = 60;
  Samples all{&walls};
  BodyReply body(m, tangent_cone(m, s));
  std::vector<double> wide(places.size(), infinity), scale(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) scale[i] = 1 / std::sqrt(walls(places[i].x));
  double worst = 0;
  for (int count = 0; count < most; ++count) {
    const std::size_t next = static_cast<std::size_t>(std::ranges::max_element(wide) - wide.begin());
    if (places.empty() || wide[next] == 0) break;
    const Place& at = places[next];
    for (std::size_t i = 0; i < places.size(); ++i) wide[i] = std::min(wide[i], (places[i].x - at.x).norm() / scale[i]);
    // A candidate with too coarse a mesh around it counts as taken, but is no sample.
    const TaylorFit fit(m, at.x, at.in, part * at.clear);
    if (fit.coarse()) continue;
    const Form exact = sampled_form(body, m, at, fit);
    if (count >= least) worst = std::max(worst, (exact - all.at(at.x)).norm() / exact.norm());
    all.x.push_back(at.x);
    all.rest.push_back(entries(exact) / walls(at.x));
    if (count < least || (count - least) % batch != batch - 1) continue;
    all.error = std::exchange(worst, 0);
    if (all.error < accurate) break;
  }
  if (all.x.size() > 1) all.leave_one_out();
  return all;
}

constexpr double narrower = 1.5;  // of two discs

// A disc large enough to tell the coefficients and small enough to be cheap, without features in it; 0 where there is
// none.
double radius_at(const Model& m, const Place& at) {
  // About 120 triangles in the narrower disc are enough to average over, and keep the cost of a fit at every corner
  // bounded.
  constexpr double part = 0.7, many = 120 * narrower * narrower;
  const double size = area(m.mesh, at.in);
  return std::min(part * at.clear, std::sqrt(many * size / pi));
}

// What the reply counts at most where it is off by `left` of its form, relative: its parts may cancel.
// The norm of the form times `left` bounds what its entries are off by; three unit replies give the gradient of c2 by
// them.
double reply_unsure(double left, const Form& form, const Perturbation& p, const Material& m, const TaylorField& s,
                    const TaylorField& t) {
  const Dipoles sent = dipoles(p, m, s);
  double square = 0;
  for (const TaylorField& w : {TaylorField{.a1 = 0.5}, TaylorField{.b1 = {1, 0}}, TaylorField{.b1 = {0, 1}}})
    square += std::pow(second_form(p, m, s, t, w).reply, 2);
  return left * form.norm() * std::hypot(sent.a1, std::abs(sent.b1)) * std::sqrt(square);
}

// alpha and beta of (Q.4) from the form times the dipoles sent out; gradients of the reply do not enter.
TaylorField reply_in(const Form& form, const Perturbation& p, const Material& m, const TaylorField& s) {
  const Dipoles sent = dipoles(p, m, s);
  const Eigen::Vector3d w = form * Eigen::Vector3d(sent.a1, sent.b1.real(), sent.b1.imag());
  return {.a1 = 0.5 * w[0], .a2 = 0, .a3 = 0, .b1 = {w[1], w[2]}, .b2 = 0};
}

/// The second term at one place, summed over pairs of fields. What two discs say of the derivatives of the stress
/// differs by what the mesh leaves of them.
class SecondAt {
 public:
  SecondAt(const Model& m, const Perturbation& p, const Place& at)
      : p_(p),
        x_(at.x),
        material_(material_of(m.mesh, m.scene, at.in)),
        fit_(m, at.x, at.in, radius_at(m, at)),
        narrow_(m, at.x, at.in, radius_at(m, at) / narrower) {}
  bool coarse() const {
    return fit_.coarse();
  }
  void add(double factor, const Samples& from, const Field& state, const Field& other) {
    const TaylorField s = fit_.of(state), t = fit_.of(other);
    const Form form = from.at(x_);
    const SecondForm of = factor * second_form(p_, material_, s, t, reply_in(form, p_, material_, s)),
                     less = narrow_.coarse()
                                ? SecondForm{}
                                : factor * second_form(p_, material_, narrow_.of(state), narrow_.of(other), {});
    sum_ = sum_ + of;
    unsure_ +=
        std::abs(of.mean_gradient - less.mean_gradient) + std::abs(of.deviator_gradient - less.deviator_gradient) +
        std::abs(of.curvature - less.curvature) +
        (from.left.empty() ? infinity : std::abs(factor) * reply_unsure(from.left_at(x_), form, p_, material_, s, t));
  }
  const SecondForm& sum() const {
    return sum_;
  }
  double unsure() const {
    return unsure_;
  }

 private:
  const Perturbation& p_;
  Vec2 x_;
  const Material& material_;
  TaylorFit fit_, narrow_;
  SecondForm sum_;
  double unsure_ = 0;
};

}  // namespace

// Places with at least 24 triangles in 0.7 of their clear disc; everywhere else c2 stays NaN.
SecondMap second_everywhere(const Analysis& a, const Functional& j, const Perturbation& p, const Candidates& points) {
  const Model& m = *a.model;
  SecondMap map{.c2 = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(points.x.size()), nan),
                .parts = {},
                .unsure = {},
                .clear = {},
                .note = unknown_second_term(a, j, p)};
  map.parts = map.unsure = map.clear = map.c2;
  if (!map.note.empty()) return map;
  Vec2 low = m.mesh.points[0], high = low;
  for (const Vec2& v : m.mesh.points) low = low.cwiseMin(v), high = high.cwiseMax(v);
  const double size = (high - low).norm();
  const std::vector<double> clear = margins(m, j, points.x, {0, 0, size});
  std::vector<Place> places;
  std::vector<std::size_t> wanted;
  map.clear = Eigen::Map<const Eigen::VectorXd>(clear.data(), map.c2.size());
  for (std::size_t i = 0; i < points.x.size(); ++i) {
    constexpr double part = 0.7, least = 24;
    if (points.skip[i] || pi * std::pow(part * clear[i], 2) < least * area(m.mesh, points.in[i])) continue;
    places.push_back({points.x[i], points.in[i], clear[i]});
    wanted.push_back(i);
  }
  const Walls walls(m);
  std::optional<Samples> own, measured;
  if (a.energy_share != 0 || a.adjoint) own = sample(m, *a.state, walls, places);
  if (a.measured) measured = sample(*a.measured_model, *a.measured, walls, places);
  for (const auto* of : {&own, &measured})
    if (*of) {
      map.error = std::max(map.error, (*of)->error);
      map.samples += static_cast<Index>((*of)->x.size());
      if ((*of)->x.empty()) return map;
    }
  parallel_for(static_cast<Index>(places.size()), m.threads, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      SecondAt second(m, p, places[static_cast<std::size_t>(i)]);
      if (second.coarse()) continue;
      if (own && a.energy_share != 0) second.add(-0.5 * a.energy_share, *own, *a.state, *a.state);
      if (own && a.adjoint) second.add(1, *own, *a.state, *a.adjoint);
      if (measured) second.add(-0.5 * a.measured_share, *measured, *a.measured, *a.measured);
      const auto k = static_cast<Eigen::Index>(wanted[static_cast<std::size_t>(i)]);
      const SecondForm& sum = second.sum();
      map.unsure[k] = second.unsure();
      map.parts[k] =
          std::abs(sum.mean_gradient) + std::abs(sum.deviator_gradient) + std::abs(sum.curvature) + std::abs(sum.reply);
      map.c2[k] = sum.value();
    }
  });
  return map;
}

}  // namespace kerf
