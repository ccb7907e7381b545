// What is wrong with a design of numbers before anything is meshed: boxes that leave no room in the body, ranges,
// volumes that the largest holes cannot reach, tips that leave the ring of their functional, elements that cannot do
// what is asked, and a start that cannot be drawn and has no neighbor that can. What is refused is proved: a box
// without room by the depth of the body, which changes by no more than the way between two points (extent_of_body.cpp),
// an area by the largest ones of the boxes. Each rule names the key of the case file. The rules are listed in
// optimize/refuse.hpp; docs/limits.md says what is not supported.

#include "geometry/plane.hpp"
#include "optimize/parametric/followers.hpp"
#include "optimize/parametric/start.hpp"
#include "optimize/refuse/methods.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

using Eigen::VectorXd;

/// Where drawn[k] and the box of its places stand in a case file.
struct Written {
  std::string table, place, words;  // "optimize.hole[0]", ".circle.center", "center in circle in [[optimize.hole]]"
};
// Things of one table are counted as the case file lists them.
Written written(const Design& d, std::size_t k) {
  const auto part = [](const Drawn& one) { return shape_of(one).part; };
  const auto number = std::count_if(d.drawn.begin(), d.drawn.begin() + static_cast<std::ptrdiff_t>(k),
                                    [&](const Drawn& one) { return part(one) == part(d.drawn[k]); });
  const auto entry = [number](const char* table, const char* place, const char* words) {
    return Written{fmt::format("optimize.{}[{}]", table, number), place,
                   fmt::format("{} in [[optimize.{}]]", words, table)};
  };
  switch (d.drawn[k].kind) {
    case Drawn::Kind::Circle:
      return entry("hole", ".circle.center", "center in circle");
    case Drawn::Kind::Ellipse:
      return entry("hole", ".ellipse.center", "center in ellipse");
    case Drawn::Kind::Spline:
      return entry("hole", ".spline.points", "points in spline");
    case Drawn::Kind::Crack:
      return entry("crack", ".path", "path");
    case Drawn::Kind::Inclusion:
      break;
  }
  return entry("region", ".circle.center", "center in circle");
}

/// Boxes that surely leave no room in the body, whatever the other variables are.
std::optional<std::string> out_of_body(const Drawn& d, const Depth& depth) {
  const VectorXd &l = d.lower, &u = d.upper;
  const auto no_room = [](double radius) {
    return fmt::format(
        "nowhere in its box is there room in the body for a radius of {:g}; move the box, or allow it "
        "to be smaller",
        radius);
  };
  switch (d.kind) {
    case Drawn::Kind::Circle:
    case Drawn::Kind::Inclusion:
      // A disc fits where some center is as deep as its smallest radius.
      if (depth.most(l.head<2>(), u.head<2>()) < l[2]) return no_room(l[2]);
      break;
    case Drawn::Kind::Ellipse: {
      // An ellipse holds the disc of its smaller semi-axis.
      const double least = l.segment<2>(2).minCoeff();
      if (depth.most(l.head<2>(), u.head<2>()) < least) return no_room(least);
      break;
    }
    // The convex hull of the control points holds the curve, and the box of the boxes holds that.
    case Drawn::Kind::Spline: {  // lies among its control points
      Vec2 low = l.head<2>(), high = u.head<2>();
      for (Eigen::Index i = 2; i < l.size(); i += 2)
        low = low.cwiseMin(l.segment<2>(i)), high = high.cwiseMax(u.segment<2>(i));
      if (depth.most(low, high) < 0) return "no box reaches into the body; move them";
      break;
    }
    case Drawn::Kind::Crack:
      for (Eigen::Index i = 0; i < l.size(); i += 2)
        // A vertex may lie on the boundary, where cracks end: the error of chords and rounding are allowed.
        if (depth.most(l.segment<2>(i), u.segment<2>(i)) < -1e-9 * (u - l).norm() - depth.chord())
          return fmt::format("the box of point {} lies outside the body; move it", i / 2 + 1);
      break;
  }
  return std::nullopt;
}

/// At least the largest area that a drawn thing takes away.
double largest_area(const Drawn& d) {
  const VectorXd& u = d.upper;
  switch (d.kind) {
    case Drawn::Kind::Circle:
      return pi * u[2] * u[2];
    case Drawn::Kind::Ellipse:
      return pi * u[2] * u[3];
    case Drawn::Kind::Spline: {
      const CoordinateBox box = shape_of(d).box(d);
      return (box.high - box.low).prod();
    }
    default:
      return 0;
  }
}

// Overlaps only leave more: the sum of the largest areas bounds what holes can take. Rounding has 1e-9.
void look_at_volume(const Problem& p, const OptimizeRequest& r, std::vector<Wrong>& all) {
  const double frame = area(p.frame);
  double holes = 0;
  for (const Drawn& d : r.design.drawn) holes += largest_area(d);
  const double least = 1 - holes / frame;
  if (r.volume_at_most && *r.volume_at_most < least * (1 - 1e-9))
    all.push_back({"optimize.volume.at_most",
                   fmt::format("at_most in volume in [optimize] = {:g}: the largest holes that the boxes allow leave "
                               "{:.4g} of the area; allow more volume, or larger holes",
                               *r.volume_at_most, least)});
  for (std::size_t b = 0; b < r.bounds.size(); ++b) {
    const auto& terms = r.bounds[b].functional.terms;
    if (terms.size() != 1 || !terms[0].volume || !(terms[0].factor > 0)) continue;
    if (r.bounds[b].at_most < terms[0].factor * least * frame * (1 - 1e-9))
      all.push_back({fmt::format("optimize.bound[{}].at_most", b),
                     fmt::format("at_most in [[optimize.bound]] = {:g}: the largest holes that the boxes allow leave "
                                 "an area of {:.4g}; allow more volume, or larger holes",
                                 r.bounds[b].at_most, least * frame)});
  }
}

/// A tip that moves leaves the ring of its functional behind.
void look_at_tips(const Problem& p, const OptimizeRequest& r, std::vector<Wrong>& all) {
  const auto look = [&](const Functional& j) {
    for (const Term& term : j.terms) {
      if (!(term.feature_radius > 0)) continue;
      for (std::size_t k = 0; k < r.design.drawn.size(); ++k) {
        const Drawn& one = r.design.drawn[k];
        if (shape_of(one).part != BodyPart::Crack) continue;
        for (Eigen::Index i = 0; i < one.start.size(); i += 2)
          if ((one.start.segment<2>(i) - term.feature).norm() < term.feature_radius &&
              one.lower.segment<2>(i) != one.upper.segment<2>(i))
            all.push_back({written(r.design, k).table + ".path",
                           fmt::format("{} moves with the design, and the ring of \"{}\" around its tip does not: fix "
                                       "that point of the crack, or take the tip of another crack",
                                       name(one), term.kind)});
      }
    }
  };
  look(p.objective);
  for (const FunctionalBound& bound : r.bounds) look(bound.functional);
}

// Cobyla needs no derivatives, but what the design draws has to be known to the element, and a map its adjoint.
void look_at_element(const Problem& p, const OptimizeRequest& r, std::vector<Wrong>& all) {
  const auto refuse = [&](Ability can, const std::string& what) {
    if (const auto why = refusal(p.element, can)) all.push_back({"solver.element", what + *why});
  };
  if (r.method != OptimizeMethod::Cobyla) {
    if (const auto why = refusal(p.element, can_optimize))
      all.push_back({"solver.element", fmt::format("method \"{}\" needs derivatives: {}; or use method = \"cobyla\"",
                                                   word(r.method), *why)});
    return;
  }
  if (wants_map(r.design)) refuse(can_adjoint, "start = \"map\": ");
  for (std::size_t k = 0; k < r.design.drawn.size(); ++k) {
    const Drawn& one = r.design.drawn[k];
    if (shape_of(one).part == BodyPart::Crack)
      refuse(is_unilateral(one.law) ? can_contact : can_open, "[[optimize.crack]]: ");
    if (shape_of(one).part == BodyPart::Region) {
      refuse(can_have_regions, "[[optimize.region]]: ");
      if (one.poisson == 0.5 && p.plane_strain) refuse(can_be_incompressible, "[[optimize.region]]: ");
    }
  }
}

/// Each drawn thing by itself; whether all of them are well.
bool look_at_each(const Problem& p, const OptimizeRequest& r, bool drawable, std::vector<Wrong>& all) {
  const std::size_t before = all.size();
  for (std::size_t k = 0; k < r.design.drawn.size(); ++k) {
    const Drawn& one = r.design.drawn[k];
    try {
      check_design({{one}}, p);
    } catch (const Error& error) {
      all.push_back({written(r.design, k).table, error.what()});
    }
  }
  if (all.size() > before) return false;
  // Names and the design as a whole, once each thing is well.
  try {
    check_design(r.design, p);
  } catch (const Error& error) {
    all.push_back({"optimize", error.what()});
    return false;
  }
  if (!drawable) return false;
  const Depth depth(p.frame, 1e-5 * extent(p.frame));
  for (std::size_t k = 0; k < r.design.drawn.size(); ++k)
    if (const auto why = out_of_body(r.design.drawn[k], depth)) {
      const Written at = written(r.design, k);
      all.push_back({at.table + at.place, fmt::format("{}: {}", at.words, *why)});
    }
  return all.size() == before;
}

}  // namespace

std::optional<std::string> wrong_design(const OptimizeRequest& r) {
  if (r.method == OptimizeMethod::LevelSet) return std::nullopt;
  if (r.design.drawn.empty())
    return fmt::format(
        "[optimize]: method = \"{}\" needs something that it can move: add [[optimize.hole]], "
        "[[optimize.crack]] or [[optimize.region]], or use method = \"level-set\"",
        word(r.method));
  if (std::ranges::none_of(r.design.drawn, [](const Drawn& d) { return (d.lower.array() < d.upper.array()).any(); }))
    return "[optimize]: every variable of the design is fixed; give at least one a box [low, high]";
  return std::nullopt;
}

void look_at_design(const Problem& p, const OptimizeRequest& r, bool drawable, std::vector<Wrong>& all) {
  if (const auto why = wrong_design(r)) {
    all.push_back({"optimize", *why});
    return;
  }
  look_at_element(p, r, all);
  const std::size_t before = all.size();
  look_at_tips(p, r, all);
  for (std::size_t k = 0; k < r.design.drawn.size(); ++k)
    if (r.method != OptimizeMethod::Cobyla && shape_of(r.design.drawn[k]).part == BodyPart::Crack &&
        has_gap(r.design.drawn[k].law))
      all.push_back(
          {written(r.design, k).table,
           fmt::format("{} has a gap, and method = \"{}\" needs derivatives, which are not known of a gap that "
                       "stays while the crack moves; use method = \"cobyla\"",
                       name(r.design.drawn[k]), word(r.method))});
  const bool moving_tips = all.size() > before;
  if (!look_at_each(p, r, drawable, all)) return;
  look_at_volume(p, r, all);
  if (wants_map(r.design) || moving_tips) return;  // where it begins is not known yet, or does not matter
  std::string obstacle;
  if (!repaired(start_of(r.design), p, r, &obstacle))
    all.push_back({"optimize", fmt::format("[optimize]: the design cannot be drawn where it starts, and nowhere near "
                                           "is one that can: {}; move or widen the boxes, or ask for a smaller "
                                           "min_distance",
                                           obstacle)});
}

}  // namespace kerf
