#include "kerf/validate.hpp"

#include "topo/analysis.hpp"
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
#include <tuple>

namespace kerf {

namespace {

constexpr int around = 64;  // edges around a ball and a hole
// Relative error of D that the polygon and the mesh around it leave, whatever the radius; measured.
double plateau_of(const Element& e, const Perturbation& p) {
  const double round = e.order == 1 ? 4e-3 : 3e-4;
  return round * aspect(p);
}
// The part of a ball that the fields at its center are fitted in.
constexpr double inner_part = 0.5;

// Stress and displacement of a state at the center of a ball: polynomials of degree 4 in the mean of squares over its
// inner half, which keep the order of the element and average its noise.
class Center {
 public:
  Center(const Model& m, Index first, Index end, const Vec2& at, double radius) : m_(m), at_(at), last_(end - 1) {
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
  // T and what |T| could be (size_of).
  std::pair<double, double> coefficient(const Expansion& e) const {
    PointValues v = point_values(
        e, [&](const FieldOf& of) { return stress(of.field); },
        [&](const FieldOf& of, bool recovered) { return displacement(of.field, recovered); });
    v.x = at_;
    v.material = material_of(m_.mesh, m_.scene, last_);
    std::vector<bool> closed = no_row_closed(e.a);
    return {expand(e, v, closed).value, size_of(e, v)};
  }

 private:
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

  const Model& m_;
  Vec2 at_;
  Index last_;  // triangle of the ball
  std::vector<Index> use_;
  Eigen::VectorXd weight_;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> fit_;
};

// The body with balls around sites, each with the contours of its radii; the mesh outside them is that of a user.
struct Batch {
  Filled filled;
  std::vector<BallMesh> balls;
};

Shape with_balls(const Shape& shape, const std::vector<Site>& sites, int sides) {
  Shape outside = shape;
  outside.labels.emplace_back("balls of the validation");
  const Index label = static_cast<Index>(outside.labels.size()) - 1;
  for (const Site& s : sites)
    outside.holes.push_back(ball_hole(fmt::format("ball {}", s.number + 1), {s.at, s.ball, sides}, label));
  return outside;
}

std::vector<Index> interface_edges(const Filled& f) {
  std::vector<Index> edges;
  for (const auto& contours : f.contour) edges.insert(edges.end(), contours[0].begin(), contours[0].end());
  return edges;
}

ValidationRequest checked(ValidationRequest r, double size) {
  std::sort(r.radii.begin(), r.radii.end(), std::greater<>());
  r.radii.erase(std::unique(r.radii.begin(), r.radii.end()), r.radii.end());
  if (r.radii.empty() || !(r.radii.back() > 0))
    throw Error(Fault::Usage, "validation needs positive radii; give radii in [validate]");
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
  if (aspect(r.perturbation) > longest)
    throw Error(Fault::Usage,
                fmt::format("validation resolves ellipses of aspect {} at most, not {:g}; the map goes further",
                            longest, r.perturbation.aspect));
  return r;
}

// Nothing computed yet.
Validation blank(const Vec2& at, const std::vector<double>& radii) {
  Validation v;
  v.at = at;
  for (const double radius : radii)
    v.rows.push_back({.radius = radius, .J = nan, .difference = nan, .predicted = nan, .remainder = nan, .order = nan});
  return v;
}

void no_radius_fits(const Site& s, Validation& v) {
  v.coefficient = v.order = v.intercept = v.c2 = v.c3 = nan;
  v.verdict = Verdict::OutOfRange;
  v.reason = s.clear > 0 ? fmt::format(
                               "no radius fits: the nearest boundary, crack or other feature is {:.3g} away; use "
                               "radii below {:.3g}",
                               s.clear, 0.25 * s.clear)
             : s.inside ? "the point lies on a boundary or a crack, or in the ring of the functional"
                        : "the point lies outside the body";
}

class Validating {
 public:
  Validating(const Meshing& meshing, const Element& e, const Scene& scene, const Functional& j,
             const ValidationRequest& request)
      : shape_(meshing.shape),
        sizing_(meshing.sizing),
        element_(e),
        scene_(scene),
        j_(j),
        r_(checked(request, extent(meshing.shape))) {}

  std::vector<Validation> run() {
    for (const Vec2& at : r_.points) results_.push_back(blank(at, r_.radii));
    find_angles();
    for (const std::vector<Site>& batch : place(shape_, j_, r_)) {
      std::vector<Site> usable;
      for (const Site& s : batch)
        if (s.radii.empty())
          no_radius_fits(s, results_[s.number]);
        else
          usable.push_back(s);
      if (usable.empty()) continue;
      if (row(r_.perturbation).becomes == Becomes::Slit)
        for (const Site& s : usable) validate_slit(s);
      else
        validate_batch(usable);
    }
    return std::move(results_);
  }

 private:
  // What orients a perturbation must be known before it is meshed: from a mesh without balls.
  void find_angles() {
    angle_.assign(r_.points.size(), 0);
    if (!is_directed(r_.perturbation)) return;
    const Model m = prepare(triangulate(shape_, sizing_), element_, scene_, r_.threads);
    const State s = solve(m);
    const std::vector<MapPoint> map = map_at(analyze(j_, m, s), j_, {.perturbation = r_.perturbation}, r_.points);
    for (std::size_t i = 0; i < angle_.size(); ++i) angle_[i] = map[i].angle;
  }

  Batch mesh_batch(const std::vector<Site>& sites) const {
    Batch b;
    for (const Site& s : sites)
      b.balls.push_back(ball_mesh({s.at, s.ball, around}, s.radii, aspect(r_.perturbation), angle_[s.number]));
    b.filled = fill(triangulate(with_balls(shape_, sites, around), sizing_), b.balls);
    return b;
  }

  void validate_batch(const std::vector<Site>& sites) {
    const Batch batch = mesh_batch(sites);
    const Filled& f = batch.filled;
    const Preparation how{.interface_edges = interface_edges(f)};
    const Model model = prepare(f.mesh, element_, scene_, r_.threads, how);
    require_supports(j_, model);
    const State state = solve(model);
    if (!certified(state))
      throw Error(Fault::Numerics, "the body with the balls of the validation could not be solved");
    const Analysis a = analyze(j_, model, state);
    const std::vector<std::vector<Difference>> differences =
        Differences({a, j_, f}, r_.perturbation, how).all(batch.balls);
    for (std::size_t s = 0; s < sites.size(); ++s) {
      const Site& site = sites[s];
      Validation& v = results_[site.number];
      v.coefficient = nan;
      if (has_series(r_.perturbation))
        std::tie(v.coefficient, v.size) =
            Center(model, f.first_triangle[s], f.first_triangle[s + 1], site.at, inner_part * site.ball)
                .coefficient({a, j_, r_.perturbation});
      v.plateau = plateau_of(element_, r_.perturbation);
      judge(v, r_.perturbation, fill_rows(a, site, batch.balls[s], differences[s], v), site.clear);
    }
  }

  // Returns f(eps) of the rows, with the exact areas of the polygons.
  std::vector<double> fill_rows(const Analysis& a, const Site& site, const BallMesh& ball,
                                const std::vector<Difference>& found, Validation& v) const {
    std::vector<double> scales(v.rows.size(), nan);
    for (std::size_t k = 0, row = 0; k < site.radii.size(); ++k) {
      while (v.rows[row].radius != site.radii[k]) ++row;
      ValidationRow& to = v.rows[row];
      scales[row] = ball.enclosed_area[k + 1];
      to.difference = found[k].value;
      to.J = a.value + found[k].value;
      to.same_contact = found[k].same_contact;
      to.predicted = has_series(r_.perturbation) ? scales[row] * v.coefficient
                                                 : clamped_at(a, j_, to.radius, std::span(&site.at, 1))[0];
    }
    return scales;
  }

  // A slit changes the mesh inside the ball with its length: two whole solves per radius, the crack bonded and in
  // contact, on the same mesh.
  void validate_slit(const Site& site) {
    Validation& v = results_[site.number];
    const Mesh mesh = triangulate(with_balls(shape_, {site}, 2 * around), sizing_);
    std::vector<double> scales(v.rows.size(), nan);
    for (std::size_t row = 0; row < v.rows.size(); ++row) {
      if (std::find(site.radii.begin(), site.radii.end(), v.rows[row].radius) == site.radii.end()) continue;
      solve_slit(site, mesh, v, v.rows[row]);
      scales[row] = scale(r_.perturbation, v.rows[row].radius);
    }
    for (std::size_t row = 0; row < v.rows.size(); ++row) v.rows[row].predicted = scales[row] * v.coefficient;
    v.plateau = 2e-3;
    judge(v, r_.perturbation, scales, site.clear);
  }

  void solve_slit(const Site& site, const Mesh& outside, Validation& v, ValidationRow& to) const {
    const Filled f = fill(outside, {slit_mesh({site.at, site.ball, 2 * around}, to.radius, angle_[site.number])});
    const auto prepared = [&](CrackLaw::Kind kind) {
      Scene scene = scene_;
      scene.laws.push_back({.kind = kind});
      return prepare(f.mesh, element_, std::move(scene), r_.threads);
    };
    const auto solved = [](const Model& m) {
      State s = solve(m);
      if (!certified(s)) throw Error(Fault::Numerics, "the body with the small crack could not be solved");
      return s;
    };
    const Model whole = prepared(CrackLaw::Kind::Bonded), broken = prepared(CrackLaw::Kind::Unilateral);
    const Field before = solved(whole), after = solved(broken);
    const Analysis a = analyze(j_, whole, before);
    std::tie(v.coefficient, v.size) =
        Center(whole, f.first_triangle[0], f.first_triangle[1], site.at, inner_part * site.ball)
            .coefficient({a, j_, r_.perturbation});
    to.J = analyze(j_, broken, after, true).value;
    to.difference = to.J - a.value;
    to.same_contact = true;
  }

  const Shape& shape_;
  const Sizing& sizing_;
  const Element& element_;
  const Scene& scene_;
  const Functional& j_;
  const ValidationRequest r_;
  std::vector<double> angle_;  // per point
  std::vector<Validation> results_;
};

}  // namespace

std::vector<Validation> validate(const Meshing& meshing, const Element& e, const Scene& scene, const Functional& j,
                                 const ValidationRequest& request) {
  return Validating(meshing, e, scene, j, request).run();
}

}  // namespace kerf
