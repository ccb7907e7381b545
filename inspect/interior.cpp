// The worst direction of a small crack in closed form. With principal stresses m +- r, on a crack whose normal is at
// the angle phi to the first axis the normal stress is m + r cos 2 phi and the shear r |sin 2 phi|. Candidates for the
// largest K [theory: M.7]: normal to the first axis, open; where the normal stress is 0; and closed, where shear less
// friction is largest, cos 2 phi = mu/sqrt(1 + mu^2).

#include "inspect/interior.hpp"

#include "base/parallel.hpp"
#include "geometry/plane.hpp"
#include "inspect/recovered.hpp"
#include "inspect/tops.hpp"
#include "solver/stress.hpp"
#include "topo/near.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf::inspect {

WorstCrack worst_crack(const Eigen::Vector3d& s, double friction) {
  const double m = 0.5 * (s[0] + s[1]), r = std::hypot(0.5 * (s[0] - s[1]), s[2]);
  const double axis = 0.5 * std::atan2(s[2], 0.5 * (s[0] - s[1]));
  WorstCrack worst;
  const auto take = [&](double phi, double K_I, double K_II, bool closed) {
    if (!(K_I * K_I + K_II * K_II > worst.K_I * worst.K_I + worst.K_II * worst.K_II)) return;
    double direction = std::fmod(axis + phi + pi / 2, pi);
    if (direction < 0) direction += pi;
    worst = {K_I, K_II, direction, closed};
  };
  take(0, std::max(m + r, 0.), 0, false);
  // In the frame of the crack, x along it, the shear is -r sin 2 phi of the normal's turn.
  if (r > std::abs(m)) {
    const double phi = 0.5 * std::acos(-m / r);
    take(phi, 0, r * std::sin(2 * phi), false);
  }
  const double root = std::sqrt(1 + friction * friction), normal = m + r * friction / root,
               driven = r * root + friction * m;  // else friction holds it
  if (normal <= 0 && driven > 0) take(0.5 * std::atan2(1, friction), 0, driven, true);
  return worst;
}

std::vector<InteriorCrack> interior_cracks(const RecoveredState& state, double length, double friction) {
  if (!(length > 0 && std::isfinite(length) && friction >= 0 && std::isfinite(friction)))
    throw Error(Fault::Usage,
                fmt::format("a crack of length {} with friction {}: a positive length and a friction of 0 "
                            "or more are wanted",
                            length, friction));
  const Mesh& mesh = state.model.mesh;
  std::vector<Vec2> middles(mesh.triangles.size());
  for (std::size_t t = 0; t < middles.size(); ++t) middles[t] = centroid(mesh, static_cast<Index>(t));
  const std::vector<Near> beside = nearest(state.model, {}, middles, 2 * length, 0);
  const std::vector<Vec2> singular = singular_points(state.model);
  std::vector<InteriorCrack> cracks(mesh.triangles.size());
  const double root = std::sqrt(pi * length / 2);
  parallel_for(static_cast<Index>(cracks.size()), state.model.threads, [&](Index first, Index last) {
    for (Index t = first; t < last; ++t) {
      InteriorCrack& crack = cracks[static_cast<std::size_t>(t)];
      crack.at = middles[static_cast<std::size_t>(t)];
      const WorstCrack worst = worst_crack(state.stress.at_centroids.col(t), friction);
      crack.K_I = root * worst.K_I;
      crack.K_II = root * worst.K_II;
      crack.K = std::hypot(crack.K_I, crack.K_II);
      crack.direction = worst.direction;
      crack.closed = worst.closed;
      crack.masked = beside[static_cast<std::size_t>(t)] != Near::Nothing ||
                     std::ranges::any_of(singular, [&](const Vec2& x) { return (x - crack.at).norm() < 5 * length; });
    }
  });
  return cracks;
}

std::vector<InteriorCrack> worst_inside(const std::vector<InteriorCrack>& cracks, double length) {
  std::vector<double> K;
  for (const InteriorCrack& crack : cracks) K.push_back(crack.masked ? 0 : crack.K);
  std::vector<InteriorCrack> worst;
  for (const std::size_t i :
       tops_of(K, [&](std::size_t a, std::size_t b) { return (cracks[a].at - cracks[b].at).norm() < 4 * length; }))
    worst.push_back(cracks[i]);
  return worst;
}

}  // namespace kerf::inspect
