#include "solver/post/calibrate.hpp"

#include "solver/parallel.hpp"
#include "solver/recover_stress.hpp"
#include "solver/system.hpp"

#include <cmath>

namespace kerf {

namespace {

/// Integrals over a triangle.
struct Share {
  double square = 0;  // of s* - s
  double stress = 0;  // of s, squared
  bool recovered = false;
};

}  // namespace

double efficiency(const Model& m, const State& state, const Eigen::VectorXd& eta) {
  const Corners corners = split_for_stress(m.mesh);
  const RecoveredStress better = recover_stress(m, state, corners, singular_corners(m, state, corners), m.scene.body);
  const Index triangles = static_cast<Index>(m.mesh.triangles.size());
  const TriangleRule& rule = m.inner->kernel.rule;
  std::vector<Share> shares(static_cast<std::size_t>(triangles));
  parallel_for(triangles, m.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) {
      Share& share = shares[static_cast<std::size_t>(t)];
      share.recovered = true;
      for (const Index c : corners.of[static_cast<std::size_t>(t)])
        share.recovered = share.recovered && !better.kept[static_cast<std::size_t>(c)];
      if (!share.recovered) continue;
      const Triangle shape = triangle(m, t);
      const Points x = rule_points(rule, shape);
      const Eigen::Matrix4Xd s = evaluate(m.inner->kernel, shape, state.interior.col(t), x).stress;
      for (Eigen::Index q = 0; q < x.cols(); ++q) {
        const Eigen::Vector3d r = recovered_at(m, state, corners, better, {t, x.col(q)});
        const double w = area(shape) * rule.w[q];
        share.square += w * (s.col(q) - Eigen::Vector4d(r[0], r[2], r[2], r[1])).squaredNorm();
        share.stress += w * s.col(q).squaredNorm();
      }
    }
  });
  double indicated = 0, square = 0, stress = 0;
  Index count = 0;
  for (Index t = 0; t < triangles; ++t) {
    const Share& share = shares[static_cast<std::size_t>(t)];
    if (!share.recovered) continue;
    ++count;
    indicated += eta[t] * eta[t];
    square += share.square;
    stress += share.stress;
  }
  constexpr Index few = 20;
  constexpr double exact = 1e-10;  // of the stress: what is left is rounding
  if (count < few || !(square > exact * exact * stress) || !(indicated > 0)) return m.element.efficiency;
  return std::sqrt(indicated / square);
}

}  // namespace kerf
