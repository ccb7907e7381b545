// A carved design as curves of the same area: chains within 0.2 of the mesh size, with knots at least three apart, and
// closer in up to three more attempts where what is drawn is no shape.

#include "optimize/curves/fit.hpp"

#include "geometry/plane.hpp"
#include "kerf/mesher.hpp"
#include "optimize/loop/evaluate.hpp"

#include <fmt/core.h>

namespace kerf {

namespace {

constexpr double fit_tolerance = 0.2, knot_spacing = 3;  // mesh sizes

// Boundaries that bear loads or that a functional is taken over.
std::vector<Index> solid_labels(const Problem& p, const OptimizeRequest& r) {
  std::vector<Index> solid;
  for (const Scene& scene : scenes_of(p, r))
    for (const Traction& t : scene.tractions) solid.push_back(t.label);
  std::vector<const Functional*> all{&p.objective};
  for (const FunctionalBound& b : r.bounds) all.push_back(&b.functional);
  for (const Functional* j : all)
    for (const Term& term : j->terms) {
      if (term.label != none) solid.push_back(term.label);
      if (term.measured) solid.push_back(term.measured->label);
    }
  return solid;
}

std::vector<Index> held_labels(const Problem& p, const OptimizeRequest& r) {
  std::vector<Index> held;
  for (const Scene& scene : scenes_of(p, r))
    for (const Support& support : scene.supports) held.push_back(support.label);
  return held;
}

}  // namespace

// Functionals taken over a ring around a feature need its material.
std::vector<Loop> solid_loops(const Problem& p, const OptimizeRequest& r) {
  std::vector<Loop> all = r.level_set.frozen;
  const auto add = [&](const Functional& j) {
    for (const Term& term : j.terms)
      if (term.feature_radius > 0) all.push_back(circle("ring", term.feature, term.feature_radius, none));
  };
  add(p.objective);
  for (const FunctionalBound& b : r.bounds) add(b.functional);
  return all;
}

double curve_size(const Problem& p, const CurvesRequest& how) {
  return how.size > 0 ? how.size : target_size(p.sizing, p.frame);
}

DesignCurves fitted_curves(const Problem& p, const OptimizeRequest& r, const Carved& carved, const CurvesRequest& how,
                           std::vector<std::string>& notes) {
  const double size = curve_size(p, how);
  double tolerance = how.tolerance > 0 ? how.tolerance : fit_tolerance * size, spacing = knot_spacing * size;
  std::string problem;
  for (int attempt = 0; attempt < 4; ++attempt, tolerance *= 0.6, spacing *= 0.6) {
    const double gap = how.min_feature > 0 ? how.min_feature : size;
    DesignCurves d = design_curves(
        p.frame, carved, {size, tolerance, spacing, gap, solid_labels(p, r), held_labels(p, r), r.level_set.mirror});
    // Where the offset finds no way the first step makes up for the area.
    if (DesignCurves exact = d; offset_to_area(exact, carved.area)) d = std::move(exact);
    const auto found = find_problem(shape_of(d));
    if (!found) {
      if (attempt > 0)
        notes.push_back(fmt::format("curves closer to the zero line, within {:.2g} ({})", tolerance, problem));
      return d;
    }
    if (problem.empty()) problem = *found;
  }
  throw Error(Fault::Geometry, fmt::format("the zero line does not become smooth curves: {}", problem));
}

}  // namespace kerf
