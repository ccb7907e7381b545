#pragma once
// One radius again, on a mesh that shares nothing with that of the series: the change drawn into the body, one degree
// more, contact free. One change of each mesh is solved for as any body is.

#include "topo/validate/sites.hpp"

namespace kerf {

/// Where a change is drawn.
struct Change {
  Site site;
  double radius, angle;
};

/// The body with the changes to be drawn.
struct Sketch {
  const Shape& shape;
  const Sizing& sizing;
  const Model& own;  // the case's mesh: the sizes of the other come from its
  const Field& state;
  const Functional& j;
  const Perturbation& p;
  double longer;                 // edges of the other mesh, where nothing is singular, in multiples of the own mesh's
  const ScenesOfChanges& drawn;  // if not by the library's rule
};

/// What `longer` may be, the cheapest first: with a quarter of the unknowns, for which one degree more makes up, and 1.
std::vector<double> drawn_lengths(const Element& own);

struct Redrawn {
  double J0, J, area;  // without and with the change; of the polygon (of a crack pi eps^2)
  double coefficient;  // T by the formula on this mesh; of a clamped hole the predicted difference
};

/// For sites whose balls keep apart. Throws Error as triangulate and prepare do, and Error(Numerics) where a body
/// cannot be solved.
std::vector<Redrawn> draw_changes(const Sketch& sketch, const std::vector<Change>& changes);

}  // namespace kerf
