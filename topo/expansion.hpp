#pragma once
// J(Omega_eps) - J(Omega) = f(eps) g(x) + o(f(eps)): f and g for one small change at x. Pure formulas, no mesh.

#include "solver/scene.hpp"

namespace kerf {

/// H(s, t) = (1/E') (4 s:t - tr s tr t) for symmetric s, t: finite up to nu = 1/2 [topological_derivatives.md, section
/// 1; Garreau, Guillaume, Masmoudi 2001]. s, t are symmetrised here.
double hole_form(const Material& m, const Mat2& s, const Mat2& t);

/// g(x) of a free circular hole for the potential energy, f(eps) = pi eps^2: -1/2 H(s, s) + b.u, with the contact
/// solution on cracks (Danskin), body force b removed in the hole.
double hole_energy(const Material& m, const Mat2& s, const Vec2& body, const Vec2& u);

}  // namespace kerf
