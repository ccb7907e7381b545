#pragma once
// The expansion against the truth: make the change at finite radii, solve, compare.

#include "kerf/map.hpp"
#include "kerf/mesher.hpp"

namespace kerf {

struct ValidationRow {
  double radius = 0, J = 0;  // J(Omega_eps)
  double difference = 0;     // J(Omega_eps) - J(Omega), both on the same mesh
  double predicted = 0;      // f(eps) T with the exact area of the polygon; a clamped hole: renormalized
  double remainder = 0;      // difference - predicted
  double order = 0;          // log2-like slope of |remainder| to the next smaller radius; NaN in the last row
  bool same_contact = true;  // the contact set is that of the unperturbed body
};

enum class Verdict { Holds, Fails, OutOfRange };

struct Validation {
  Vec2 at = Vec2::Zero();
  double coefficient = 0;  // T; of a clamped hole NaN
  double size = 0;         // what |T| could be for stresses of this size in other directions
  double order = 0;        // observed, median over the rows above the plateau
  double intercept = 0;    // of the least squares fit D = T + c2 eps^2 + c3 eps^2 ln eps, D = difference / f(eps)
  double c2 = 0, c3 = 0;   // of that fit: the series to order eps^4
  double plateau = 0;      // relative error of D that the mesh leaves
  Verdict verdict = Verdict::OutOfRange;
  std::string reason;  // in words
  std::vector<ValidationRow> rows;
};

struct ValidationRequest {
  std::vector<Vec2> points;
  std::vector<double> radii;  // decreasing
  Perturbation perturbation;
  int threads = 1;
};

/// One mesh with a ball around every point, factorized once; each radius costs a solve inside its ball and on the
/// ball's boundary together with the cracks' contact rows.
std::vector<Validation> validate(const Meshing& meshing, const Element& e, const Scene& scene, const Functional& j,
                                 const ValidationRequest& request);

}  // namespace kerf
