// Eigenstrains: per triangle the projection P of e in the mean of squares onto polynomials of degree 4, or of its own
// degree where that is lower, in the coordinates (l1, l2),
//   c = (B W B')^-1 B W e(x_q),   B the monomials at the points of the rule, W its weights,
// a load (e, tau) on the stresses [theory: H.3]; and what P leaves out, R = e - P, as for any data on triangles
// [theory: D.4]. |R|^2 counts 11 and 22 once, 12 twice, 33 not: that is a number for the stress out of the plane.
// Fields that are known polynomials need no looks. Derived in docs/theory/eigenstrain.md, section The state.

#include "solver/data.hpp"
#include "solver/data/all_triangles.hpp"

#include "base/dense.hpp"
#include "base/parallel.hpp"
#include "base/polynomial.hpp"
#include "solver/element/local.hpp"

#include <algorithm>
#include <map>

namespace kerf {

namespace {

constexpr int most = 4;  // degree: that of the stresses that the elements have at most

// In curved triangles a polynomial of the place is none of (l1, l2): degree 4, and a rest.
int degree_of(const Scene& scene, bool curved) {
  int degree = 0;
  for (const Eigenstrain& e : scene.eigenstrain)
    if (e)
      for (const VectorField* f : {&e.normal, &e.shear})
        degree = std::max(degree, is_polynomial(*f) ? f->known()->degree() : most);
  return degree > 0 && curved ? most : std::min(degree, most);
}

// Values at the points of a rule, and what is known of what they leave out.
struct Sampled {
  Eigen::Matrix4Xd at;  // 11, 22, 12, 33
  double rest = 0, error = 0;
  Resolution how = Resolution::Proved;
};

/// The values of all regions' eigenstrains in their triangles.
/// Triangles of one field are looked at together, since looks are shared out among them.
class Sampling {
 public:
  Sampling(const Mesh& mesh, const Scene& scene, const TriangleRule& rule, const EdgeCurvatures& curvatures,
           int threads)
      : mesh_(mesh), rule_(rule), bows_(curvatures), place_(mesh.triangles.size()) {
    double size = 0;
    for (const Eigenstrain& e : scene.eigenstrain)
      size = std::max({size, e ? size_over(e.normal, mesh) : 0, e ? size_over(e.shear, mesh) : 0});
    std::map<const Eigenstrain*, std::vector<Index>> triangles;
    for (Index t = 0; t < static_cast<Index>(mesh.triangles.size()); ++t)
      if (const Eigenstrain* e = eigenstrain_of(mesh, scene, t)) {
        place_[static_cast<std::size_t>(t)] = triangles[e].size();
        triangles[e].push_back(t);
      }
    for (const auto& [e, which] : triangles)
      for (const VectorField* f : {&e->normal, &e->shear})
        if (!is_polynomial(*f))
          known_[f] = triangle_values(
              *f, which, [&](Index t) { return cell_of(mesh, curvatures, t); }, rule, size, "eigenstrain", threads);
  }

  Sampled operator()(const Eigenstrain& e, Index t) const {
    Sampled s{Eigen::Matrix4Xd(4, rule_.w.size())};
    s.at.topRows<2>() = values(e.normal, t, 1, s);
    s.at.bottomRows<2>() = values(e.shear, t, 2, s);
    return s;
  }

 private:
  /// The shear counts twice in |e|.
  Points values(const VectorField& f, Index t, double counted, Sampled& to) const {
    const auto found = known_.find(&f);
    if (found == known_.end()) {
      Points at = rule_points(rule_, cell_of(mesh_, bows_, t));
      for (Eigen::Index q = 0; q < at.cols(); ++q) at.col(q) = f(at.col(q));
      return at;
    }
    const TriangleValues& v = found->second[place_[static_cast<std::size_t>(t)]];
    to.rest += counted * v.rest;
    to.error += counted * v.error;
    if (v.how == Resolution::Open || to.how == Resolution::Open)
      to.how = Resolution::Open;
    else if (v.how == Resolution::Sampled)
      to.how = Resolution::Sampled;
    return v.at;
  }

  const Mesh& mesh_;
  const TriangleRule& rule_;
  const EdgeCurvatures& bows_;
  std::vector<std::size_t> place_;  // of a triangle among those of its region
  std::map<const VectorField*, std::vector<TriangleValues>> known_;
};

// Rows 11, 22, 12, 33 to 11, 12, 21, 22.
Eigen::Matrix4Xd tensors(const Eigen::Matrix4Xd& e) {
  Eigen::Matrix4Xd all(4, e.cols());
  all << e.row(0), e.row(2), e.row(2), e.row(1);
  return all;
}

Eigen::Map<const Eigen::Matrix4Xd> coefficients(const StrainData& data, Index t) {
  return {data.coefficients.col(t).data(), 4, dim(data.degree)};
}

}  // namespace

// Entry 0 is what is outside all regions.
const Eigenstrain* eigenstrain_of(const Mesh& mesh, const Scene& scene, Index t) {
  const std::size_t place = static_cast<std::size_t>(region_of(mesh, t) + 1);  // none is -1
  return place < scene.eigenstrain.size() && scene.eigenstrain[place] ? &scene.eigenstrain[place] : nullptr;
}

StrainData strain_data(const Mesh& mesh, const Scene& scene, const TriangleRule& rule, int threads,
                       const EdgeCurvatures& curvatures) {
  StrainData data;
  if (!has_eigenstrain(scene)) return data;
  const Index triangles = static_cast<Index>(mesh.triangles.size());
  data.degree = degree_of(scene, !curvatures.of.empty());
  data.coefficients.setZero(4 * dim(data.degree), triangles);
  data.rest.setZero(triangles);
  data.error.setZero(triangles);
  data.how.assign(static_cast<std::size_t>(triangles), Resolution::Proved);
  const Eigen::MatrixXd basis = monomials(data.degree, rule.x), weighted = basis * rule.w.asDiagonal();
  const Eigen::MatrixXd project =
      solve_spd(multiply_transposed(weighted, basis), weighted).transpose();  // values -> coefficients
  const Sampling sample(mesh, scene, rule, curvatures, threads);
  parallel_for(triangles, threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) {
      const Eigenstrain* e = eigenstrain_of(mesh, scene, t);
      if (!e) continue;
      const Sampled s = sample(*e, t);
      const Eigen::Matrix4Xd c = s.at * project, left = s.at - c * basis;
      data.coefficients.col(t) = Eigen::Map<const Eigen::VectorXd>(c.data(), c.size());
      const Eigen::RowVector4d counts(1, 1, 2, 0);
      const bool bent = data.degree > 0 && is_curved(cell_of(mesh, curvatures, t));
      if (bent || !is_polynomial(e->normal) || !is_polynomial(e->shear))
        data.rest[t] = s.rest + counts * left.cwiseAbs2() * rule.w;
      data.error[t] = s.error;
      data.how[static_cast<std::size_t>(t)] = s.how;
    }
  });
  return data;
}

Eigen::Matrix4Xd strain_at(const StrainData& data, Index t, const Points& l) {
  return tensors(coefficients(data, t) * monomials(data.degree, l));
}

// By l1 or l2; slopes by the place follow from the map (eigenstrain_slope_at).
Eigen::Matrix4Xd strain_slope_at(const StrainData& data, Index t, const Points& l, int axis) {
  return tensors(coefficients(data, t) * (derivative(data.degree, axis).transpose() * monomials(data.degree, l)));
}

Eigen::RowVectorXd strain_33_at(const StrainData& data, Index t, const Points& l) {
  return coefficients(data, t).row(3) * monomials(data.degree, l);
}

}  // namespace kerf
