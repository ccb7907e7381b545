// Bounds of int sigma_vM^2 from the energy's [theory: B.25, B.26]; docs/theory/bounds.md, "The square of the stress".
// With m = (p + C eps(v))/2 of the admissible fields,
//   |sigma - m|_A^2 <= gap - |p - C eps(v)|_A^2/4 = rho^2,   sigma_vM^2 <= 3 mu A sigma : sigma,
// so that the root N of the integral obeys |N(sigma) - N(m)| <= sqrt(3 mu) (sqrt(rho^2 + r) + sqrt(2 r)), r the
// widening of the gap by data. mu is the largest of all materials. On curved cells both integrals have the error of two
// rules. None for orthotropic or incompressible materials and with eigenstrains.

#include "solver/stress_norm.hpp"

#include "solver/bounds/admissible.hpp"
#include "solver/bounds/bounded.hpp"
#include "solver/bounds/curved.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

/// (B.26) is for isotropic materials, and C eps(v) does not exist at c = 0.
std::string no_stress_norm_because(const Scene& scene) {
  const auto orthotropic = [](const Material& m) { return !isotropic(m); };
  if (orthotropic(scene.material) || std::ranges::any_of(scene.regions, orthotropic))
    return "no bound: a material is orthotropic";
  const auto incompressible = [](const Material& m) { return m.c == 0; };
  if (incompressible(scene.material) || std::ranges::any_of(scene.regions, incompressible))
    return "no bound: a material is incompressible";
  return {};
}

Mat2 symmetric(const Eigen::Vector4d& p) {
  Mat2 s;
  s << p[0], 0.5 * (p[1] + p[2]), 0.5 * (p[1] + p[2]), p[3];
  return s;
}

/// C eps of a displacement gradient.
Mat2 stress_of(const Material& material, const Eigen::Vector4d& gradient) {
  const double half_trace = (gradient[0] + gradient[3]) / (4 * material.c);
  Mat2 s = material.mu * symmetric(gradient) * 2;
  return s + (half_trace - 0.5 * s.trace()) * Mat2::Identity();
}

/// A s : s.
double work(const Material& material, const Mat2& s) {
  const double trace = s.trace();
  return (s.squaredNorm() - 0.5 * trace * trace) / (2 * material.mu) + material.c * trace * trace;
}

/// The share of a curved cell, by its two rules.
struct OnCurved {
  double integral, rules, apart;
};
/// `apart` enters with a minus sign and is taken small, by what the two rules leave open.
OnCurved on_curved(const Material& material, const Share& share, const SquaredVonMises& square) {
  Vec2 sum = Vec2::Zero(), difference = Vec2::Zero();
  for (Eigen::Index q = 0; q < share.kept_weight.cols(); ++q) {
    const Mat2 p = symmetric(share.kept_stress.col(q)), m = 0.5 * (p + stress_of(material, share.kept_strain.col(q)));
    sum += square(material, m) * share.kept_weight.col(q);
    difference += 4 * work(material, p - m) * share.kept_weight.col(q);
  }
  return {sum[0], doubt_of_rules * std::abs(sum[0] - sum[1]),
          std::max(difference[0] - doubt_of_rules * std::abs(difference[0] - difference[1]), 0.0)};
}

}  // namespace

/// `apart` enters with a minus sign and is taken from below, `integral` on both sides.
Bounded squared_stress_bounds(const Model& model, const Field& state, const SquaredVonMises& square) {
  if (const std::string why = no_stress_norm_because(model.scene); !why.empty()) return lost(why);
  if (!model.inner->data.strain.empty()) return lost("no bound: the body has an eigenstrain");
  const AdmissiblePair pair = admissible(model, state, 0);
  if (!std::isfinite(pair.bounds.upper - pair.bounds.lower)) return lost(pair.bounds.note);
  double integral = 0, apart = 0, stiffest = 0;  // apart: the square of |p - C eps(v)|, at least
  double rules = 0;                              // what of the integral is between two rules
  for (std::size_t i = 0; i < pair.shares.size(); ++i) {
    const auto t = static_cast<Index>(i);
    const Share& share = pair.shares[i];
    const TriangleRule& rule = pair.edges[i].empty() ? pair.plain : pair.rich;
    const Material& material = material_of(model.mesh, model.scene, t);
    stiffest = std::max(stiffest, material.mu);
    if (share.kept_weight.cols() > 0) {
      const OnCurved c = on_curved(material, share, square);
      integral += c.integral;
      rules += c.rules;
      apart += c.apart;
      continue;
    }
    double sum = 0, difference = 0;
    for (Eigen::Index q = 0; q < rule.w.size(); ++q) {
      const Mat2 p = symmetric(share.kept_stress.col(q)), m = 0.5 * (p + stress_of(material, share.kept_strain.col(q)));
      sum += rule.w[q] * square(material, m);
      difference += rule.w[q] * 4 * work(material, p - m);
    }
    integral += area(triangle(model, t)) * sum;
    apart += area(triangle(model, t)) * difference;
  }
  const double gap = std::max(pair.sum.upper - pair.sum.lower, 0.0),
               rest = std::max(pair.bounds.upper - pair.bounds.lower - gap, 0.0);
  const double away = std::sqrt(2 * rest) + std::sqrt(std::max(gap - 0.25 * apart, 0.0) + rest);
  const double norm = std::sqrt(integral), off = std::sqrt(3 * stiffest) * away + std::sqrt(integral + rules) - norm;
  Bounded b;
  b.value = integral;
  b.lower = std::pow(std::max(norm - off, 0.0), 2);
  b.upper = std::pow(norm + off, 2);
  b.guaranteed = pair.bounds.guaranteed;
  b.note = pair.bounds.note;
  return b;
}

}  // namespace kerf
