#pragma once
// Designs to begin with.

#include "optimize/parametric/constraints.hpp"

#include <optional>

namespace kerf {

struct OptimizeRequest;

/// The least distance that a request asks for: half the mesh size unless it says more.
double least_distance(const Problem& p, const OptimizeRequest& r);
/// The rings of the functionals of a request.
std::vector<Forbidden> forbidden_discs(const Problem& p, const OptimizeRequest& r);

/// Point `number` of a sequence that fills a box evenly, the middle first: the additive recurrence of the inverse
/// powers of the root of g^(n+1) = g + 1 [Roberts 2018].
Eigen::VectorXd place_in(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, int number);

/// The design that is nearest to x (in boxes) among those that keep all constraints on the geometry, as far as a
/// minimization of the distance finds it; x itself where it can be drawn and violates none by more than half. Nothing
/// where none is found, and `obstacle` then says which constraint is in the way. No state is solved for.
std::optional<Eigen::VectorXd> repaired(const Eigen::VectorXd& x, const Problem& p, const OptimizeRequest& r,
                                        std::string* obstacle = nullptr);

}  // namespace kerf
