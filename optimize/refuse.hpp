#pragma once
// What is wrong with an optimization and can be known before anything is meshed or solved. The only home of these
// rules: kerf check, the reader of case files and the loops ask here.

#include "kerf/optimize.hpp"

#include <optional>
#include <string>
#include <vector>

namespace kerf {

/// `key`: where it would be written in a case file: "optimize.ersatz", "optimize.hole[0].circle.center",
/// "crack[1].friction"; numbers count from 0 in the order of the problem and the request.
struct Wrong {
  std::string key, what;
};

/// Everything that is wrong: empty where nothing is. Of a body that cannot be drawn (find_problem), only what does not
/// depend on its shape. Nothing is refused on a sample alone: what is said of shapes, boxes and loads holds.
std::vector<Wrong> find_wrong(const Problem& p, const OptimizeRequest& r);
/// Throws Error(Geometry) with find_problem's words: before anything is made as fine as its curves.
void require_drawable(const Shape& body);
/// Throws Error(Usage) with all of it, a line each, or what require_drawable throws.
void refuse_wrong(const Problem& p, const OptimizeRequest& r);

// Some of the rules by themselves: what is wrong, or nothing.

/// The body must be its own mirror image.
std::optional<std::string> wrong_mirror(const Shape& body, const Mirror& mirror);
/// A frozen part may leave the body, but it must have an inside, some of the body in it and some outside.
std::optional<std::string> wrong_mask(const Shape& body, const Loop& mask);
/// A region that stays void must leave one piece of the body, and no load, no support and no crack in it.
std::optional<std::string> wrong_keep_out(const Shape& body, const Scene& scene, const Loop& keep_out);
/// Without anything that holds the volume down, the full body is best for what only loses by holes, and a level set has
/// nothing to stop at.
std::optional<std::string> wrong_volume(const Functional& objective, const OptimizeRequest& r);
/// Functionals that know one set of loads only.
std::optional<std::string> wrong_load_cases(const Functional& objective, const OptimizeRequest& r);
/// Whether no traction, body force, pressure in a crack and prescribed displacement is anything but 0: false where that
/// is not known for certain.
bool nothing_acts(const Scene& scene, const Shape& body);
/// There must be something that can move.
std::optional<std::string> wrong_design(const OptimizeRequest& r);

}  // namespace kerf
