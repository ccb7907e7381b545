#pragma once
// A quantity of a state as the work of its loads with a singular field, and the loads that are left [theory: B.11,
// B.12].

#include "kerf/bounds.hpp"
#include "solver/bounds/nucleus.hpp"

#include <vector>

namespace kerf {

/// Every edge of the boundary has a label, so that it can be loaded.
Mesh labelled(Mesh mesh);

/// The loads of w: what makes G + w free of tractions, and at rest on supports. `own` is the crack whose faces G leaves
/// free, or none.
Scene counter(const Model& m, const Nucleus& G, Index own);

/// The scene of u + k w.
Scene superposed(const Scene& u, const Scene& w, double k);

/// A number and what it may be off by.
struct Known {
  double value = 0, error = 0;
};
/// int t.G over the tractions t of u; the error by halved edges.
Known work_on(const Model& m, const Nucleus& G);

/// Where the tractions of G are not resolved by the edges, in words; else empty.
std::string unresolved(const Model& m, const std::vector<Vec2>& singular, Index own);

Bounded lost(std::string why);

/// fa a + fb b.
Bounded combined(const Bounded& a, double fa, const Bounded& b, double fb);

}  // namespace kerf
