// The topological derivative as a level set: psi turns on the unit sphere of L2 towards lambda - T by a share of the
// angle between them, T carried into the void by a Helmholtz filter [Amstutz, Andrae 2006; theory: L.5].

#include "optimize/level_set/fixed_point.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

FixedPoint fixed_point(const BackgroundMesh& background, const Helmholtz& filter, const TriangleDerivative& derivative,
                       const Eigen::VectorXd& psi, const Turn& turn) {
  const auto& [mesh, T] = derivative;
  std::vector<Vec2> centroids;
  Eigen::VectorXd amount(T.size());
  for (Index t = 0; t < T.size(); ++t) {
    centroids.push_back(centroid(mesh, t));
    amount[t] = area(mesh, t) * T[t];
  }
  // T times the area of its triangle is spread onto vertices as a load: the filter gives it values in the void, too.
  const Eigen::VectorXd gain = filter.solve(spread_onto(background, centroids, amount));
  const auto towards = [&](double multiplier) { return constrained(background, (multiplier - gain.array()).matrix()); };
  FixedPoint f;
  if (turn.price) {
    f.multiplier = *turn.price;
  } else {
    double low = gain.minCoeff(), high = gain.maxCoeff();
    for (int i = 0; i < 60; ++i) {
      f.multiplier = 0.5 * (low + high);
      (negative_area(background.mesh, towards(f.multiplier)) > turn.area ? low : high) = f.multiplier;
    }
  }
  const auto norm = [&](const Eigen::VectorXd& v) { return std::sqrt(background.lumped.dot(v.cwiseAbs2())); };
  // What is frozen has no say in the angle: its values are distances.
  const Eigen::VectorXd target = (f.multiplier - gain.array()).matrix();
  const Eigen::VectorXd unit = target / norm(target);
  f.psi = psi / norm(psi);
  f.angle = std::acos(std::clamp(background.lumped.dot(unit.cwiseProduct(f.psi)), -1.0, 1.0));
  if (const double s = std::sin(f.angle); s > 1e-9)
    f.psi = (std::sin((1 - turn.share) * f.angle) * f.psi + std::sin(turn.share * f.angle) * unit) / s;
  f.psi /= norm(f.psi);
  return f;
}

}  // namespace kerf
