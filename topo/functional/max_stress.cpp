// The largest von Mises or principal stress of a body outside of zones, M. On a mesh it is the largest of the element's
// own values at the points of the quadrature of densities and in the middles of boundary edges: corners of chords that
// stand for curves have peaks that no curve has. It has no derivative; that of
//   M N'/N,   N = (int w s^p)^(1/p),   p = 12,   w = 0 in zones and 1 elsewhere
// stands for it [Le, Norato, Bruns, Ha, Tortorelli 2010; theory: K.6], s the stress: exact where s is the same all
// along the largest values. For s the von Mises stress density and local term are those of stress_power.cpp. The larger
// principal stress without its sign is |m| + r, m the mean and r half the difference of the two; maps of it are
// refused.

#include "topo/max_stress.hpp"

#include "base/parallel.hpp"
#include "geometry/plane.hpp"
#include "solver/stress.hpp"
#include "solver/system.hpp"
#include "topo/functional/integrate.hpp"
#include "topo/functional/places.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

bool StressZone::holds(const Vec2& x) const {
  return distance(x, a, b) < radius;
}

bool LargestStress::leaves_out(const Vec2& x) const {
  return std::ranges::any_of(zones, [&](const StressZone& zone) { return zone.holds(x); });
}

namespace {

/// |m| + r to the power p, and its derivative by the stress.
Density principal_power(double p, const Mat2& stress) {
  const double mean = 0.5 * (stress(0, 0) + stress(1, 1)), half = 0.5 * (stress(0, 0) - stress(1, 1)),
               shear = 0.5 * (stress(0, 1) + stress(1, 0)), radius = std::hypot(half, shear);
  const double value = std::abs(mean) + radius;
  Density d{.value = std::pow(value, p)};
  const double by_value = p * std::pow(value, p - 1), sign = mean < 0 ? -1 : 1;
  const double by_half = radius > 0 ? half / radius : 0, by_shear = radius > 0 ? shear / radius : 0;
  d.by_stress << sign + by_half, by_shear, by_shear, sign - by_half;
  d.by_stress *= 0.5 * by_value;
  return d;
}

Term norm_where(const LargestStress& what, const ScalarField& weight) {
  constexpr double p = largest_stress_power;
  Term term;
  if (what.of == LargestStress::Of::VonMises) {
    term = stress_pnorm(p, weight, what.plane_strain);
  } else {
    term.stress_power = p;
    term.power = 1 / p;
    term.uses_stress = true;
    term.density = [weight](const FieldPoint& at) {
      if (weight(at.x) == 0) return Density{};
      return principal_power(p, at.stress);
    };
    term.local = [](const Perturbation&, const FieldPoint&) -> double {
      throw Error(Fault::Usage,
                  "the largest principal stress has no map; of = \"von_mises\" has one, or use stress_pnorm");
    };
  }
  term.kind = "max_stress";
  // Zones do not depend on the design, and lie where little of it moves.
  term.uses_place = false;
  return term;
}

double value_of(const LargestStress& what, const Material& material, const Eigen::Vector4d& stress) {
  if (what.of == LargestStress::Of::VonMises) return von_mises(material, what.plane_strain, stress);
  const PrincipalStresses s = principal_stresses(stress);
  return std::max(std::abs(s.first), std::abs(s.second));
}

}  // namespace

Term max_stress(const LargestStress& what) {
  auto shared = std::make_shared<const LargestStress>(what);
  Term term = norm_where(what, [shared](const Vec2& x) { return shared->leaves_out(x) ? 0.0 : 1.0; });
  term.largest = shared;
  return term;
}

Term norm_in_box(const LargestStress& what, const Vec2& low, const Vec2& high) {
  auto shared = std::make_shared<const LargestStress>(what);
  Term term = norm_where(what, [=](const Vec2& x) {
    const bool in = x.x() >= low.x() && x.x() < high.x() && x.y() >= low.y() && x.y() < high.y();
    return in && !shared->leaves_out(x) ? 1.0 : 0.0;
  });
  term.somewhere = [low, high](const Vec2& center, double radius) {
    return (center - center.cwiseMax(low).cwiseMin(high)).squaredNorm() <= radius * radius;
  };
  return term;
}

std::vector<StressAt> stresses_outside(const LargestStress& what, const Model& m, const Field& s) {
  const TriangleRule rule = domain_rule(m);
  const auto own = own_triangles(m);
  std::vector<std::vector<StressAt>> of(static_cast<std::size_t>(own));
  parallel_for(own, m.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) {
      const Triangle shape = triangle(m, t);
      const Material& material = material_of(m.mesh, m.scene, t);
      const Points x = rule_points(rule, shape);
      const Fields f = evaluate(m.inner->kernel, shape, s.interior.col(t), x);
      for (Eigen::Index q = 0; q < x.cols(); ++q)
        if (!what.leaves_out(x.col(q)))
          of[static_cast<std::size_t>(t)].push_back({value_of(what, material, f.stress.col(q)), x.col(q)});
    }
  });
  std::vector<StressAt> all;
  for (const auto& part : of) all.insert(all.end(), part.begin(), part.end());
  for (const EdgeStress& at : boundary_stresses(what, m, s)) all.push_back(at);
  return all;
}

std::vector<EdgeStress> boundary_stresses(const LargestStress& what, const Model& m, const Field& s) {
  std::vector<EdgeStress> all;
  for (Index e = 0; e < static_cast<Index>(m.mesh.edges.size()); ++e) {
    const auto& [left, right] = m.mesh.sides[e];
    const Index t = left == none ? right : left;
    if ((left != none && right != none) || t >= own_triangles(m)) continue;
    const Vec2 x = on_edge(m.mesh, m.inner->skeleton.curvatures, e, 0.5).x;
    if (what.leaves_out(x)) continue;
    const Eigen::Vector4d stress = stress_at(m.inner->kernel, triangle(m, t), s.interior.col(t), x);
    all.push_back({{value_of(what, material_of(m.mesh, m.scene, t), stress), x}, e});
  }
  return all;
}

StressAt largest_stress(const LargestStress& what, const Model& model, const Field& state) {
  StressAt largest;
  for (const StressAt& s : stresses_outside(what, model, state))
    if (s.value > largest.value) largest = s;
  return largest;
}

}  // namespace kerf
