// A design of numbers: its variables in order, their names and boxes, what is wrong with them, and the body that they
// draw. The variables of drawn things stand one after the other in the order of the design; each kind of thing is a row
// of the table in shapes/shape.hpp, which says how many it has, what they are called, and what they draw. Drawn holes,
// cracks and regions come behind those of the frame, in the same order, which followers.cpp and evaluations.cpp count
// on. Names are unique within their kind. docs/theory/level_set.md, section "Drawn designs".

#include "kerf/design.hpp"

#include "optimize/parametric/followers.hpp"
#include "optimize/parametric/shapes/shape.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

using Eigen::VectorXd;

const char* word(BodyPart part) {
  return part == BodyPart::Crack ? "crack" : part == BodyPart::Region ? "region" : "hole";
}

// Lower bounds, upper ones or starts of all things, one after the other.
VectorXd joined(const Design& d, VectorXd Drawn::*member) {
  VectorXd all(variable_count(d));
  Eigen::Index first = 0;
  for (const Drawn& one : d.drawn) {
    all.segment(first, (one.*member).size()) = one.*member;
    first += one.lower.size();
  }
  return all;
}

/// Finite, in order, with the start between.
void check_bounds(const Drawn& d) {
  for (Eigen::Index i = 0; i < d.lower.size(); ++i) {
    require(std::isfinite(d.lower[i]) && std::isfinite(d.upper[i]) && d.lower[i] <= d.upper[i], d,
            fmt::format("the bounds {:g} and {:g} of variable {} have to be finite, the lower one first", d.lower[i],
                        d.upper[i], i + 1));
    require(d.start[i] >= d.lower[i] && d.start[i] <= d.upper[i], d,
            fmt::format("the start {:g} of variable {} has to lie between {:g} and {:g}", d.start[i], i + 1, d.lower[i],
                        d.upper[i]));
  }
}

template <typename Named>
std::vector<std::string> names_of(const std::vector<Named>& things) {
  std::vector<std::string> names;
  for (const Named& thing : things) names.push_back(thing.name);
  return names;
}

}  // namespace

std::string name(const Drawn& d) {
  return fmt::format("{} '{}'", word(shape_of(d).part), d.name);
}

std::vector<std::string> variable_names(const Design& d) {
  std::vector<std::string> names;
  for (const Drawn& one : d.drawn)
    for (const std::string& variable : shape_of(one).names(one.start.size()))
      names.push_back(fmt::format("{}.{}", one.name, variable));
  return names;
}

VectorXd lower_bounds(const Design& d) {
  return joined(d, &Drawn::lower);
}

VectorXd upper_bounds(const Design& d) {
  return joined(d, &Drawn::upper);
}

VectorXd start_of(const Design& d) {
  return joined(d, &Drawn::start);
}

void check_design(const Design& d, const Problem& p) {
  if (d.drawn.empty()) throw Error(Fault::Usage, "the design draws nothing; give it holes, cracks or inclusions");
  // By BodyPart.
  std::array taken{names_of(p.frame.holes), names_of(p.frame.cracks), names_of(p.frame.regions)};
  for (const Drawn& one : d.drawn) {
    const DrawnShape& shape = shape_of(one);
    const Eigen::Index count = one.lower.size();
    require(one.upper.size() == count && one.start.size() == count, one, "every variable needs two bounds and a start");
    require(shape.fits(count), one, shape.asks);
    check_bounds(one);
    shape.check(one, p);
    std::vector<std::string>& names = taken[static_cast<std::size_t>(shape.part)];
    require(std::find(names.begin(), names.end(), one.name) == names.end(), one, "that name is taken; use another one");
    names.push_back(one.name);
  }
}

// Each thing adds itself to the frame and its scene, in the order of the design.
DrawnBody body_of(const Design& d, const VectorXd& x, const Problem& p) {
  DrawnBody body{p.frame, p.scene};
  const std::vector<VectorXd> part = parts(d, x);
  for (std::size_t k = 0; k < d.drawn.size(); ++k) shape_of(d.drawn[k]).draw(d.drawn[k], part[k], p, body);
  return body;
}

}  // namespace kerf
