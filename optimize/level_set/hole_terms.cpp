// J of a hole of radius r by two terms of the expansion, pi r^2 (T + c2 r^2), and the radius that gains most at a price
// of area [theory: Q.1, L.14].

#include "optimize/level_set/hole_terms.hpp"

#include "kerf/perturbation.hpp"
#include "topo/map_at_centroids.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

double HoleTerms::change(double radius) const {
  const double square = radius * radius;
  return pi * square * (std::isnan(c2) ? T : T + c2 * square);
}

// d/dr of r^2 (gain - c2 r^2) = 0 at r^2 = gain/(2 c2); a c2 that is not positive, or not known, sets no limit.
double best_radius(const HoleTerms& of, double price, double most) {
  const double gain = price - of.T, c2 = std::isnan(of.c2) ? 0 : of.c2;
  const double radius = c2 > 0 ? std::min(most, std::sqrt(std::max(gain, 0.0) / (2 * c2))) : most;
  return gain - c2 * radius * radius > 0 ? radius : 0;
}

HoleExpansion::HoleExpansion(std::vector<WeightedAnalysis> objective, std::vector<WeightedAnalysis> bounds) {
  const Mesh& mesh = objective.front().analysis.model->mesh;
  sum_.setZero(static_cast<Eigen::Index>(mesh.triangles.size()));
  locator_ = make_locator(mesh);
  for (WeightedAnalysis& of : objective) add(std::move(of), false);
  for (WeightedAnalysis& of : bounds) add(std::move(of), true);
}

// T at centroids ranks places, c2 at points tells radii.
void HoleExpansion::add(WeightedAnalysis of, bool bound) {
  static const Perturbation hole;
  auto part = std::make_unique<Part>(Part{std::move(of), {}, nullptr, bound});
  const WeightedAnalysis& w = part->of;
  part->T = map_at_centroids(w.analysis, *w.functional, [](Index) -> const Perturbation& { return hole; });
  part->second = std::make_unique<SecondOrders>(w.analysis, *w.functional, hole);
  sum_ += w.weight * part->T;
  parts_.push_back(std::move(part));
}

HoleTerms HoleExpansion::merit(const Vec2& x) {
  return terms(x, true);
}
HoleTerms HoleExpansion::objective(const Vec2& x) {
  return terms(x, false);
}

// A bound whose c2 is not known adds T alone.
HoleTerms HoleExpansion::terms(const Vec2& x, bool bounds) {
  const Index t = nearest_triangle(parts_.front()->of.analysis.model->mesh, locator_, x);
  HoleTerms sum{.T = 0, .c2 = 0};
  for (const auto& part : parts_) {
    if (part->bound && !bounds) continue;
    SecondOrder found;
    // Where a reply cannot be solved for, T alone counts.
    try {
      found = part->second->at(x);
    } catch (const Error& error) {
      found.note = error.what();
    }
    sum.T += part->of.weight * (found.available ? found.T : part->T[t]);
    if (found.available) {
      sum.c2 += part->of.weight * found.c2;
    } else if (!part->bound) {
      sum.c2 = nan;
      sum.note = found.note;
      sum.resolved = sum.resolved && !part->second->unknown().empty();
    }
  }
  return sum;
}

}  // namespace kerf
