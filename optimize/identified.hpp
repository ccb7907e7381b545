#pragma once
// What was found beside what is true.

#include "optimize/design.hpp"
#include "optimize/problem.hpp"
#include "optimize/synthetic.hpp"

#include <span>

namespace kerf {

/// One thing of the design and the nearest true one of its kind (each true one once).
struct Identified {
  std::string name, truth;       // "hole 'a'", "hole 'true'"; truth empty: there are more in the design than in truth
  Eigen::VectorXd found, exact;  // center and radius (of a circle of the same area; inclusions: and Young's modulus);
                                 // of a crack its ends, the true ones in the order that is nearer
  double position_error = 0;     // of the center; of a crack the larger of its ends
  double size_error = 0;         // radius, length: found less exact
};

/// `x`: variables of the design. What the true body has and the frame has not: the last ones of its holes, cracks,
/// regions.
std::vector<Identified> identified(const Design& design, const Eigen::VectorXd& x, const Problem& problem,
                                   const Synthetic& truth);

/// "hole 'a': center (0.621, 0.569), radius 0.0801; true: ..., off by 0.0012 and +0.0001".
std::string in_words(const Identified& i);

}  // namespace kerf
