#pragma once
// The expansion against the truth: make the change at finite radii, solve, compare.

#include "kerf/map.hpp"
#include "kerf/mesher.hpp"
#include "kerf/second_order.hpp"

#include <string>
#include <string_view>

namespace kerf {

struct ValidationRow {
  double radius = 0, J = 0;  // J(Omega_eps)
  double difference = 0;     // J(Omega_eps) - J(Omega), both on the same mesh
  double predicted = 0;      // f(eps) T with the exact area of the polygon; a clamped hole: renormalized
  double remainder = 0;      // difference - predicted
  double order = 0;          // log2-like slope of |remainder| to the next smaller radius; NaN in the last row
  bool same_contact = true;  // the contact set is that of the unperturbed body
  // The same with the second term, f(eps) (T + c2 eps^2), where that is known; NaN elsewhere.
  double predicted_second = nan, remainder_second = nan, order_second = nan;
  double size = nan;  // of a clamped hole: the parts of the prediction, without their signs
};

/// Holds: the coefficient is that of the series of differences on its mesh, and of a change drawn on another, better
/// mesh with contact free to change. Fails: the series says another number, and so does that change. Vanishes: neither
/// sees anything at this point. OutOfRange: the radii are too large, too few, or contact moves with them. NothingSaid:
/// parts of the formula cancel, rounding or the mesh leaves too much, J is infinite.
enum class Verdict { Holds, Fails, Vanishes, OutOfRange, NothingSaid };
/// As in result.json: "holds" | "fails" | "vanishes" | "out of range" | "nothing can be said".
std::string_view word(Verdict verdict);

/// What one part of the formula gives to T: trace and deviator of the stresses (of shapes with a direction also what
/// the two give together; of a crack its normal and tangential tractions), displacement under a body force, local (the
/// change of the density itself).
struct Mode {
  std::string name;
  double value = 0;
};

/// One radius drawn on a mesh of its own, of one degree more, the contact free.
struct DrawnChange {
  double radius = nan, difference = nan;
  double apart = nan;        // where it fails: the limit of the series less T (of a clamped hole less the prediction)
  double rest = nan;         // what the series says beyond T at that radius (of a clamped hole beyond the prediction)
  double predicted = nan;    // of a clamped hole, by the series' mesh
  double coefficient = nan;  // T of the formula on the drawn mesh; of a clamped hole the prediction
  double intercept = nan;    // the difference less what the series says beyond T: T of the body
};

struct Validation {
  Vec2 at = Vec2::Zero();
  double coefficient = 0;     // T; of a clamped hole NaN
  double size = 0;            // what |T| could be for stresses of this size in other directions, and its rounding
  double order = 0;           // observed, median over the rows above the plateau
  double intercept = 0;       // of the least squares fit D = T + c2 eps^2 + c4 eps^4, D = difference / f(eps)
  double c2 = 0, c3 = 0;      // of that fit; c3 of eps^2 ln eps: known, or fitted in place of c4 where nothing is known
  double c4 = nan;            // of that fit
  double c2_predicted = nan;  // by second_order.hpp on the mesh of the series, where it is available
  double c2_on_mesh = nan;    // the same on the mesh of the body alone
  Logarithm logarithm = Logarithm::Unknown;
  double order_second = nan;  // observed order of what the second term leaves, as `order`
  double plateau = 0;         // relative error of D that the mesh leaves
  double on_mesh = nan;       // the map's value on the mesh of the body alone (of a clamped hole at the drawn radius)
  double bar = nan;           // the largest distance from it to what other meshes say, 1.5 times
  DrawnChange drawn = {};     // where the series allows a verdict
  std::vector<Mode> modes = {};
  Verdict verdict = Verdict::OutOfRange;
  std::string reason;  // in words
  std::vector<ValidationRow> rows;
};

/// Where a change is drawn: in that region (none: outside of all), angle (radians) of what has one.
struct DrawnChangeAt {
  Index region = none;
  Vec2 center = Vec2::Zero();
  double radius = 0, angle = 0;
};
/// What acts on the body with a change drawn into it. What is new is the last of its kind: the material and the
/// eigenstrain of an inclusion, the law of a crack, the support of a clamped rim, whose label comes after all others.
using ScenesOfChanges = std::function<Scene(const Perturbation& change, const DrawnChangeAt& at)>;

struct ValidationRequest {
  std::vector<Vec2> points;   // none: two that see every mode, far from features
  std::vector<double> radii;  // decreasing
  Perturbation perturbation;
  int threads = 1;
  ScenesOfChanges scenes = {};  // where bodies are drawn otherwise than by the library: by the tables of a case file
};

/// One mesh with a ball around every point, factorized once; each radius costs a solve inside its ball and on the
/// ball's boundary together with the cracks' contact rows. Where the series agrees with T, one radius is solved again
/// as a body with a change drawn into it, on another mesh with one degree more.
/// All meshes are graded at the ends of contact.
std::vector<Validation> validate(const Meshing& meshing, const Element& e, const Scene& scene, const Functional& j,
                                 const ValidationRequest& request);

}  // namespace kerf
