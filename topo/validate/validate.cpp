#include "kerf/validate.hpp"

#include "topo/map/green.hpp"
#include "topo/map/point.hpp"
#include "topo/validate/condense.hpp"
#include "topo/validate/differences.hpp"
#include "topo/validate/sites.hpp"
#include "topo/validate/verdict.hpp"

#include <fmt/core.h>
#include <Eigen/Cholesky>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

namespace kerf {

namespace {

constexpr int around = 64;  // edges around a ball and a hole
// Relative error of D that the polygon and the mesh around it leave, whatever the radius; measured.
double plateau_of(const Element& e, const Perturbation& p) {
  const double round = e.order == 1 ? 4e-3 : 3e-4;
  return p.kind == Perturbation::Kind::Ellipse ? round * p.aspect : round;
}

// Stress and displacement of a state at the center of a ball: polynomials of degree 4 in the mean of squares over its
// inner half, which keep the order of the element and average its noise.
class Center {
 public:
  Center(const Model& m, Index first, Index end, const Vec2& at, double radius) : m_(m) {
    for (Index t = first; t < end; ++t)
      if ((centroid(m.mesh, t) - at).norm() < radius) use_.push_back(t);
    constexpr int degree = 4, count = 15;
    const Eigen::Index rows = static_cast<Eigen::Index>(use_.size());
    Eigen::MatrixXd a(rows, count);
    weight_.resize(rows);
    for (Eigen::Index i = 0; i < rows; ++i) {
      const Vec2 x = (centroid(m.mesh, use_[static_cast<std::size_t>(i)]) - at) / radius;
      weight_[i] = std::sqrt(area(m.mesh, use_[static_cast<std::size_t>(i)]));
      int column = 0;
      for (int n = 0; n <= degree; ++n)
        for (int k = 0; k <= n; ++k) a(i, column++) = weight_[i] * std::pow(x.x(), n - k) * std::pow(x.y(), k);
    }
    fit_.compute(a);
  }
  Eigen::Vector3d stress(const Field& s) const {
    Eigen::Matrix<double, Eigen::Dynamic, 3> v(weight_.size(), 3);
    for (Eigen::Index i = 0; i < v.rows(); ++i) {
      const Index t = use_[static_cast<std::size_t>(i)];
      v.row(i) =
          weight_[i] *
          components(stress_at(m_.inner->kernel, triangle(m_, t), s.interior.col(t), centroid(m_.mesh, t))).transpose();
    }
    return fit_.solve(v).row(0).transpose();
  }
  Vec2 displacement(const Field& s, bool recovered) const {
    Eigen::Matrix<double, Eigen::Dynamic, 2> v(weight_.size(), 2);
    for (Eigen::Index i = 0; i < v.rows(); ++i) {
      const Index t = use_[static_cast<std::size_t>(i)];
      const Vec2 x = centroid(m_.mesh, t);
      v.row(i) = weight_[i] * (recovered ? Vec2(recovered_displacement(m_, s, t, x).col(0))
                                         : Vec2(evaluate(m_, s, t, x).displacement.col(0)))
                                  .transpose();
    }
    return fit_.solve(v).row(0).transpose();
  }

 private:
  const Model& m_;
  std::vector<Index> use_;
  Eigen::VectorXd weight_;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> fit_;
};

// T and what |T| could be (size_of).
std::pair<double, double> coefficient(const Analysis& a, const Functional& j, const Perturbation& p, const Vec2& at,
                                      const Center& c, Index inside_triangle) {
  const Needs need = needs(a, j, p);
  PointValues v{
      .x = at, .material = material_of(a.model->mesh, a.model->scene, inside_triangle), .stress = c.stress(*a.state)};
  if (need.displacement) v.u = c.displacement(*a.state, true);
  if (a.adjoint) v.dual = c.stress(*a.adjoint);
  if (need.dual_displacement) v.p = c.displacement(*a.adjoint, need.recover_dual);
  if (a.measured) {
    v.measured = c.stress(*a.measured);
    if (need.displacement) v.measured_u = c.displacement(*a.measured, true);
  }
  if (a.biactive) {
    const Eigen::Index n = static_cast<Eigen::Index>(a.biactive->response.size());
    v.openings.resize(3, n);
    v.opening_u = Points::Zero(2, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Field& y = a.biactive->response[static_cast<std::size_t>(i)];
      v.openings.col(i) = c.stress(y);
      if (need.displacement) v.opening_u.col(i) = c.displacement(y, true);
    }
  }
  std::vector<bool> closed = no_row_closed(a);
  return {expand(a, j, p, v, closed).value, size_of(a, p, v)};
}

struct Batch {
  Filled filled;
  std::vector<BallMesh> balls;
};

// The body with balls around the sites, each with the contours of its radii; the mesh outside them is that of a user.
Batch mesh_batch(const Shape& shape, const Sizing& sizing, const std::vector<Site>& sites, const Perturbation& p,
                 const std::vector<double>& angle) {
  Shape outside = shape;
  outside.labels.emplace_back("balls of the validation");
  const Index label = static_cast<Index>(outside.labels.size()) - 1;
  Batch b;
  for (const Site& s : sites) {
    outside.holes.push_back(ball_hole(fmt::format("ball {}", s.number + 1), {s.at, s.ball, around}, label));
    b.balls.push_back(ball_mesh({s.at, s.ball, around}, s.radii, p.aspect, angle[s.number]));
  }
  b.filled = fill(triangulate(outside, sizing), b.balls);
  return b;
}

std::vector<Index> kept_edges(const Filled& f) {
  std::vector<Index> edges;
  for (const auto& contours : f.contour) edges.insert(edges.end(), contours[0].begin(), contours[0].end());
  return edges;
}

// What orients an ellipse must be known before it is meshed: from a mesh without balls.
std::vector<double> orientations(const Shape& shape, const Sizing& sizing, const Element& e, const Scene& scene,
                                 const Functional& j, const ValidationRequest& r) {
  std::vector<double> angle(r.points.size(), 0);
  if (r.perturbation.kind != Perturbation::Kind::Ellipse && r.perturbation.kind != Perturbation::Kind::Crack)
    return angle;
  const Model m = prepare(triangulate(shape, sizing), e, scene, r.threads);
  const State s = solve(m);
  const std::vector<MapPoint> map = map_at(analyze(j, m, s), j, {.perturbation = r.perturbation}, r.points);
  for (std::size_t i = 0; i < angle.size(); ++i) angle[i] = map[i].angle;
  return angle;
}

void validate_batch(const Shape& shape, const Sizing& sizing, const Element& e, const Scene& scene, const Functional& j,
                    const ValidationRequest& r, const std::vector<Site>& sites, const std::vector<double>& angle,
                    std::vector<Validation>& results) {
  const Batch batch = mesh_batch(shape, sizing, sites, r.perturbation, angle);
  const Filled& f = batch.filled;
  const Preparation how{.kept_edges = kept_edges(f)};
  const Model model = prepare(f.mesh, e, scene, r.threads, how);
  require_supports(j, model);
  const State state = solve(model);
  if (!certified(state)) throw Error(Fault::Numerics, "the body with the balls of the validation could not be solved");
  const bool clamped = r.perturbation.kind == Perturbation::Kind::ClampedHole;
  const Analysis a = analyze(j, model, state);
  const std::vector<std::vector<Difference>> differences = Differences(a, j, r.perturbation, f, how).all(batch.balls);
  for (std::size_t s = 0; s < sites.size(); ++s) {
    const Site& site = sites[s];
    Validation& v = results[site.number];
    const Index first = f.first_triangle[s], end = f.first_triangle[s + 1];
    constexpr double share = 0.5;
    v.coefficient = nan;
    if (!clamped)
      std::tie(v.coefficient, v.size) =
          coefficient(a, j, r.perturbation, site.at, Center(model, first, end, site.at, share * site.ball), end - 1);
    const std::vector<Difference>& found = differences[s];
    std::vector<double> scales(v.rows.size(), nan);
    for (std::size_t k = 0, row = 0; k < site.radii.size(); ++k) {
      while (v.rows[row].radius != site.radii[k]) ++row;
      ValidationRow& to = v.rows[row];
      scales[row] = batch.balls[s].enclosed_area[k + 1];
      to.difference = found[k].value;
      to.J = a.value + found[k].value;
      to.same_contact = found[k].same_contact;
      to.predicted = clamped ? nan : scales[row] * v.coefficient;
    }
    if (clamped)
      for (ValidationRow& row : v.rows)
        if (std::isfinite(row.difference)) row.predicted = clamped_at(a, j, row.radius, std::span(&site.at, 1))[0];
    v.plateau = plateau_of(e, r.perturbation);
    judge(v, r.perturbation, scales, site.clear);
  }
}

// A crack changes the mesh inside the ball with its length: two whole solves per radius, the crack bonded and in
// contact, on the same mesh.
void validate_crack(const Shape& shape, const Sizing& sizing, const Element& e, const Scene& scene, const Functional& j,
                    const ValidationRequest& r, const Site& site, double angle, Validation& v) {
  Shape outside = shape;
  outside.labels.emplace_back("ball of the validation");
  outside.holes.push_back(
      ball_hole("ball", {site.at, site.ball, 2 * around}, static_cast<Index>(outside.labels.size()) - 1));
  const Mesh mesh = triangulate(outside, sizing);
  Scene bonded = scene, cracked = scene;
  bonded.laws.push_back({.kind = CrackLaw::Kind::Bonded});
  cracked.laws.push_back({.kind = CrackLaw::Kind::Unilateral});
  std::vector<double> scales(v.rows.size(), nan);
  const auto solved = [&](const Model& m) {
    State s = solve(m);
    if (!certified(s)) throw Error(Fault::Numerics, "the body with the small crack could not be solved");
    return s;
  };
  for (std::size_t row = 0; row < v.rows.size(); ++row) {
    ValidationRow& to = v.rows[row];
    if (std::find(site.radii.begin(), site.radii.end(), to.radius) == site.radii.end()) continue;
    const Filled f = fill(mesh, {slit_mesh({site.at, site.ball, 2 * around}, to.radius, angle)});
    const Model whole = prepare(f.mesh, e, bonded, r.threads), broken = prepare(f.mesh, e, cracked, r.threads);
    const Field before = solved(whole), after = solved(broken);
    const Analysis a = analyze(j, whole, before);
    constexpr double share = 0.5;
    std::tie(v.coefficient, v.size) = coefficient(
        a, j, r.perturbation, site.at,
        Center(whole, f.first_triangle[0], f.first_triangle[1], site.at, share * site.ball), f.first_triangle[0]);
    to.J = analyze(j, broken, after, true).value;
    to.difference = to.J - a.value;
    scales[row] = scale(r.perturbation, to.radius);
    to.same_contact = true;
  }
  for (std::size_t row = 0; row < v.rows.size(); ++row) v.rows[row].predicted = scales[row] * v.coefficient;
  v.plateau = 2e-3;
  judge(v, r.perturbation, scales, site.clear);
}

}  // namespace

std::vector<Validation> validate(const Shape& shape, const Sizing& sizing, const Element& e, const Scene& scene,
                                 const Functional& j, const ValidationRequest& request) {
  ValidationRequest r = request;
  std::sort(r.radii.begin(), r.radii.end(), std::greater<>());
  r.radii.erase(std::unique(r.radii.begin(), r.radii.end()), r.radii.end());
  if (r.radii.empty() || !(r.radii.back() > 0))
    throw Error(Fault::Usage, "validation needs positive radii; give radii in [validate]");
  const double size = extent(shape);
  constexpr double least = 1e-6, apart = 1.05;
  if (r.radii.back() < least * size)
    throw Error(Fault::Usage, fmt::format("radius {:.3g} of the validation is too small for a mesh: use {:.2g} or more",
                                          r.radii.back(), least * size));
  for (std::size_t i = 0; i + 1 < r.radii.size(); ++i)
    if (r.radii[i] < apart * r.radii[i + 1])
      throw Error(
          Fault::Usage,
          fmt::format("radii {:.6g} and {:.6g} of the validation lie too close together: each should be {} times "
                      "the next or more",
                      r.radii[i], r.radii[i + 1], apart));
  constexpr double longest = 10;
  if (r.perturbation.kind == Perturbation::Kind::Ellipse && r.perturbation.aspect > longest)
    throw Error(Fault::Usage,
                fmt::format("validation resolves ellipses of aspect {} at most, not {:g}; the map goes further",
                            longest, r.perturbation.aspect));
  std::vector<Validation> results(r.points.size());
  for (std::size_t i = 0; i < results.size(); ++i) {
    results[i].at = r.points[i];
    for (const double radius : r.radii)
      results[i].rows.push_back(
          {.radius = radius, .J = nan, .difference = nan, .predicted = nan, .remainder = nan, .order = nan});
  }
  const std::vector<double> angle = orientations(shape, sizing, e, scene, j, r);
  for (const std::vector<Site>& batch : place(shape, j, r)) {
    std::vector<Site> usable;
    for (const Site& s : batch) {
      if (!s.radii.empty()) {
        usable.push_back(s);
        continue;
      }
      Validation& v = results[s.number];
      v.coefficient = v.order = v.intercept = v.c2 = v.c3 = nan;
      v.verdict = Verdict::OutOfRange;
      v.reason = s.clear > 0 ? fmt::format(
                                   "no radius fits: the nearest boundary, crack or other feature is {:.3g} away; use "
                                   "radii below {:.3g}",
                                   s.clear, 0.25 * s.clear)
                 : s.inside ? "the point lies on a boundary or a crack, or in the ring of the functional"
                            : "the point lies outside the body";
    }
    if (usable.empty()) continue;
    if (r.perturbation.kind == Perturbation::Kind::Crack)
      for (const Site& s : usable) validate_crack(shape, sizing, e, scene, j, r, s, angle[s.number], results[s.number]);
    else
      validate_batch(shape, sizing, e, scene, j, r, usable, angle, results);
  }
  return results;
}

}  // namespace kerf
