// The efficiency index i = |eta|/|s* - s| of the indicator, over the triangles with a recovered stress s* [theory:
// R.6].

#include "solver/post/calibrate.hpp"

#include "base/parallel.hpp"
#include "solver/anisotropic.hpp"
#include "solver/post/shared_corners.hpp"
#include "solver/recover_stress.hpp"
#include "solver/recovery.hpp"
#include "solver/system.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace kerf {

namespace {

/// Integrals over a triangle.
/// Per triangle, to be added up in their order.
struct Share {
  double square = 0;  // of s* - s
  double stress = 0;  // of s, squared
  bool recovered = false;
};

/// The residuals are weighted by mu; in an orthotropic material they may stand for stresses that are larger by this.
double stiffest_over_mean(const Scene& scene) {
  double most = 1;
  for (const Material& m : all_materials(scene)) most = std::max(most, shear_moduli(m).largest / m.mu);
  return most;
}

/// The mean stress of the body, of which this is a part.
double mean_stress_of_body(const Model& m, const State& state, const Sums& sums) {
  const double here = mean_stress(m, state), size = area(m);
  std::array<double, 2> both{here * here * size, size};
  sums.add(both);
  return std::sqrt(both[0] / both[1]);
}

}  // namespace

/// Both sums run over the same triangles, those of which all three corners have a polynomial.
Efficiency efficiency(const Model& m, const State& state, const Eigen::VectorXd& eta, const Sums& sums) {
  const Corners corners = split_for_stress(m.mesh);
  const std::vector<bool> singular = sums.add ? singular_corners(m, state, corners, mean_stress_of_body(m, state, sums))
                                              : singular_corners(m, state, corners);
  const RecoveredStress better = recover_stress(m, state, corners, singular, m.scene.body);
  const Index triangles = static_cast<Index>(m.mesh.triangles.size());
  std::vector<Share> shares(static_cast<std::size_t>(triangles));
  parallel_for(triangles, m.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) {
      Share& share = shares[static_cast<std::size_t>(t)];
      share.recovered = true;
      for (const Index c : corners.of[static_cast<std::size_t>(t)])
        share.recovered = share.recovered && !better.kept[static_cast<std::size_t>(c)];
      if (!share.recovered) continue;
      const Triangle shape = triangle(m, t);
      const TriangleRule& rule = stress_rule(m.inner->kernel, shape);
      const Points x = rule_points(rule, shape);
      const Eigen::VectorXd weight = rule_weights(rule, shape);
      const Eigen::Matrix4Xd s = evaluate(m.inner->kernel, shape, state.interior.col(t), x).stress;
      for (Eigen::Index q = 0; q < x.cols(); ++q) {
        const Eigen::Vector3d r = recovered_at(m, state, corners, better, {t, x.col(q)});
        const double w = area(shape) * weight[q];
        share.square += w * (s.col(q) - Eigen::Vector4d(r[0], r[2], r[2], r[1])).squaredNorm();
        share.stress += w * s.col(q).squaredNorm();
      }
    }
  });
  double indicated = 0, square = 0, stress = 0, count = 0;
  Efficiency result{m.element.efficiency, 0, std::vector<bool>(static_cast<std::size_t>(triangles))};
  for (Index t = 0; t < triangles; ++t) {
    const Share& share = shares[static_cast<std::size_t>(t)];
    result.recovered[static_cast<std::size_t>(t)] = share.recovered;
    if (!share.recovered || t >= own_triangles(m)) continue;
    ++count;
    indicated += eta[t] * eta[t];
    square += share.square;
    stress += share.stress;
  }
  if (sums.add) {
    std::array<double, 4> all{indicated, square, stress, count};
    sums.add(all);
    indicated = all[0], square = all[1], stress = all[2], count = all[3];
  }
  constexpr double few = 20;
  constexpr double exact = 1e-10;  // of the stress: what is left is rounding
  // Where the recovered stress is hardly better than the other one, on coarse meshes, it says too much.
  // The index stays within a factor 2 of that of the element; at_tips: two thirds of it where the stress is singular.
  constexpr double doubt = 2, at_tips = 1.5;
  if (count >= few && square > exact * exact * stress && indicated > 0)
    result.regular =
        std::clamp(std::sqrt(indicated / square), m.element.efficiency / doubt / stiffest_over_mean(m.scene),
                   m.element.efficiency * doubt);
  result.singular = std::min(result.regular, m.element.efficiency / at_tips);
  return result;
}

}  // namespace kerf
