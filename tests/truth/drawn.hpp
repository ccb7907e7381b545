#pragma once
// Changes of the body that are really drawn, meshed and solved for anew, beside what the expansion says: every
// functional under every load. The contact is free, the mesh another one.

#include "kerf/analysis.hpp"
#include "kerf/map.hpp"
#include "kerf/mesher.hpp"

#include <memory>
#include <string>
#include <vector>

namespace kerf::drawn {

/// A square [0, 2]^2 with a crack, on rollers left and below, tractions right and on top; and what else acts.
struct Load {
  std::string name;
  bool body = false;        // force per area
  bool prescribed = false;  // the rollers move
  bool contact = false;     // the crack is partly closed
  bool regions = false;     // around the point lies another material
  bool fluid = false;       // a pressure in the crack
};
const std::vector<Load>& loads();

struct Change {
  std::string name;
  Perturbation p;
};
const std::vector<Change>& changes();

struct Named {
  std::string name;
  Functional j;
};
std::vector<Named> functionals(const Load& load);

/// The body with its mesh made fine at tips, corners and ends of contact.
struct Solved {
  std::shared_ptr<const Model> model;
  std::shared_ptr<const State> state;
};
Solved solve_body(const Load& load);
/// With a change of radius eps at the angle, or (filled) with its lines in the mesh and nothing changed.
Solved solve_drawn(const Load& load, const Change& change, double eps, double angle, bool filled);

/// The label of the sides of what is drawn.
inline constexpr Index rim = 4;

/// Where the changes are made, and how large they are drawn.
Vec2 place();
const std::vector<double>& radii();

struct Comparison {
  double predicted = 0, drawn = 0;  // T; of a clamped hole the ratio of the differences of J, and 1
  double unsure = 0;                // by how much `drawn` depends on the way it is extrapolated
  double angle = 0;
  std::vector<double> quotients;  // per radius
  std::string refused;            // why there is no prediction
};
/// Per functional, all from the same solutions; radii from the largest to the least.
std::vector<Comparison> compare(const Load& load, const Change& change, const std::vector<Named>& functionals,
                                const std::vector<double>& radii);

/// The value at 0 of the polynomial in eps^2 of this many terms nearest to the quotients.
double extrapolated(const std::vector<double>& eps, const std::vector<double>& quotients, int terms);

}  // namespace kerf::drawn
