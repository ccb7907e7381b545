#pragma once
// J(Omega_eps) - J(Omega) = f(eps) T(x) + o(f(eps)): f and T for one small change at x. Pure formulas, no mesh.
// Mixed sign throughout: T = form(sigma, zeta) - b.p + local, with the adjoint (zeta, p) of kerf/adjoint.hpp.

#include "kerf/scene.hpp"

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace kerf {

/// A small change of the body at a point. Lengths are multiples of the radius eps.
struct Perturbation {
  enum class Kind {
    Hole,         // free circular hole of radius eps
    ClampedHole,  // u = 0 on the circle: J changes like 1/ln(1/eps), no expansion in powers
    Inclusion,    // another material in the circle
    Ellipse,      // free elliptic hole, semi-axes eps sqrt(aspect) and eps/sqrt(aspect): the area is pi eps^2
    Crack,        // frictionless crack of length 2 eps, faces in unilateral contact
  } kind = Kind::Hole;
  Material inclusion = {};
  double aspect = 1;                 // at least 1
  std::optional<double> angle = {};  // radians, of an ellipse or a crack; empty: the one that `oriented` finds
};

/// As in case files and results: "hole", "clamped_hole", "inclusion", "ellipse", "crack".
std::string_view word(Perturbation::Kind kind);
/// The kind of that word. Throws Error(Usage) naming the known ones.
Perturbation::Kind perturbation_kind(std::string_view word);
/// For titles, in UTF-8: "a hole of radius ε".
std::string description(const Perturbation& p);
/// Whether the expansion above holds: for all but the clamped hole.
bool has_series(const Perturbation& p);

/// f(eps): pi eps^2 for all kinds but the clamped hole (NaN).
double scale(const Perturbation& p, double eps);

/// H(s, t) = (1/E') (4 s:t - tr s tr t) for symmetric s, t: finite up to nu = 1/2 [theory: T.3; Garreau, Guillaume,
/// Masmoudi 2001]. s, t are symmetrized here.
double hole_form(const Material& m, const Mat2& s, const Mat2& t);

/// T of the potential energy 1/2 a - l for a free hole, -1/2 H(s, s) + b.u: s, body force b and u at the center.
double hole_energy(const Material& m, const Mat2& s, const Vec2& body, const Vec2& u);

/// -P(s, t), P = Ph tr s tr t + Pd dev s : dev t, of a circular inclusion [Ammari, Kang 2007; theory: T.10]. Any
/// contrast; c = 0 in either material, mu = 0 or infinite c inside are limits that are finite.
double inclusion_form(const Material& matrix, const Material& inside, const Mat2& s, const Mat2& t);

/// H of an elliptic hole whose longer axis has the angle (radians) [Kachanov 1993; theory: T.12]. Throws (Usage) where
/// aspect < 1.
double ellipse_form(const Material& m, double aspect, double angle, const Mat2& s, const Mat2& t);

/// (2/E') (s n).(t n) with n normal to the crack at the angle (radians), per pi eps^2; without its normal part where
/// n.s n <= 0: the crack stays closed there.
double crack_form(const Material& m, double angle, const Mat2& s, const Mat2& t);

/// form(s, t) of a perturbation; `angle` of the longer axis or the crack. Throws (Usage) for a clamped hole.
double form(const Perturbation& p, const Material& m, double angle, const Mat2& s, const Mat2& t);

/// Multipliers of the hydrostatic and deviatoric part of the background stress: inside the perturbation, and of the
/// field that it adds outside (q = 1 - inside). A hole has inside = 0. Throws (Usage) for what is not a free circle.
struct Transmission {
  double hydrostatic = 0, deviatoric = 0;
};
Transmission inside(const Perturbation& p, const Material& m);

/// sum_i factor_i form(s_i, t_i): what depends on the orientation.
struct Product {
  double factor;
  Mat2 s, t;
};
struct Oriented {
  double value = 0, angle = 0;  // radians in [0, pi); 0 for what has no orientation
};
/// At the angle that the perturbation has; without one the least value over the orientations for an ellipse (the best
/// hole for a J that is minimized), the largest in magnitude for a crack (the worst). Closed form: a crack's extremes
/// are those of the open and of the closed form, or lie where it closes, where with several products the value may
/// jump and the larger side counts. Products of different s (misfits) open by themselves: searched.
Oriented oriented(const Perturbation& p, const Material& m, std::span<const Product> products);

}  // namespace kerf
