#pragma once
// What keeps every design meshable: distances between what is drawn, what is there already, and the outline.

#include "kerf/design.hpp"

#include <functional>
#include <string>
#include <vector>

namespace kerf {

/// A constraint on the variables: value(x) <= 0, relative to the length or the shape that it asks for, so that 1 is a
/// large violation: distance 0 instead of the least one, for distances.
struct Constraint {
  std::string name;  // "hole 'a' and crack 'c' are less than 0.05 apart"
  std::function<double(const Eigen::VectorXd& x, Eigen::VectorXd* gradient)> value;
};

/// A disc that nothing drawn may enter.
struct Forbidden {
  std::string name;
  Vec2 center;
  double radius;
};

/// Least distances: between drawn things, from them to holes, cracks (the crack-free ligament), regions and the outline
/// of the frame, on the side of a region on which they start, and to forbidden discs; and what the shapes must be in
/// themselves: splines counter-clockwise, as thick as the distance, without loops and cusps; paths of cracks without
/// folds, their edges as long as the distance. Pairs that their bounds keep apart are left out. Cracks may end on the
/// boundary, on holes and on other cracks where that end is fixed.
///
/// Circles are exact. Other boundaries are sampled, and their distance is a soft minimum that is smooth and never
/// larger than the distance of the samples: -d/40 log sum exp(-40 d_i/d), d the least distance asked for.
std::vector<Constraint> constraints(const Design& d, const Problem& p, double least,
                                    const std::vector<Forbidden>& forbidden);

}  // namespace kerf
