#pragma once
// The expansion at one point from the values of all its fields there.

#include "kerf/analysis.hpp"
#include "topo/formulas/kind.hpp"

namespace kerf {

Mat2 symmetric(const Eigen::Vector3d& s);              // from s11, s22, s12
Eigen::Vector3d components(const Eigen::Vector4d& s);  // of the symmetric part

/// Which displacements the expansion asks for.
struct Needs {
  bool displacement = false;  // of the state
  bool dual_displacement = false;
  bool recover_dual = true;  // the adjoint's displacement may be recovered from its stress
};
Needs needs(const Analysis& a, const Functional& j, const Perturbation& p);

/// What is expanded, for which change: the same at all points. The parts must outlive it.
struct Expansion {
  Expansion(const Analysis& a, const Functional& j, const Perturbation& p) : a(a), j(j), p(p), need(needs(a, j, p)) {}
  const Analysis& a;
  const Functional& j;
  const Perturbation& p;
  Needs need;
};

/// At one point of every field: stresses s11, s22, s12.
struct PointValues {
  Vec2 x = Vec2::Zero();
  Material material = {};
  double misfit = 0;  // of an inclusion: what it strains along both axes beyond what surrounds it
  Eigen::Vector3d stress = Eigen::Vector3d::Zero(), dual = stress, measured = stress;
  Vec2 u = Vec2::Zero(), p = Vec2::Zero(), measured_u = Vec2::Zero();
  Eigen::Matrix3Xd openings = {};  // of the responses to openings
  Points opening_u = {};
};

/// Where they are, in triangle t, and what depends on the place alone.
void set_place(const Expansion& e, Index t, const Vec2& x, PointValues& v);

/// One field of an analysis, and the body that it lives in.
struct FieldOf {
  enum Number : std::size_t { Primal, Adjoint, Measured, Opening };
  const Model& model;
  const Field& field;
  std::size_t number;  // Opening + k for the response to the opening k
};

/// What the expansion needs of its fields, from `stress(FieldOf)` and `displacement(FieldOf, recovered)` at the point.
template <class Stress, class Displacement>
PointValues point_values(const Expansion& e, const Stress& stress, const Displacement& displacement) {
  const Analysis& a = e.a;
  PointValues v;
  const FieldOf state{*a.model, *a.state, FieldOf::Primal};
  v.stress = stress(state);
  if (e.need.displacement) v.u = displacement(state, true);
  if (a.adjoint) {
    const FieldOf dual{*a.model, *a.adjoint, FieldOf::Adjoint};
    v.dual = stress(dual);
    if (e.need.dual_displacement) v.p = displacement(dual, e.need.recover_dual);
  }
  if (a.measured) {
    const FieldOf measured{*a.measured_model, *a.measured, FieldOf::Measured};
    v.measured = stress(measured);
    if (e.need.displacement) v.measured_u = displacement(measured, true);
  }
  if (a.biactive) {
    const std::size_t n = a.biactive->response.size();
    v.openings.resize(3, static_cast<Eigen::Index>(n));
    v.opening_u = Points::Zero(2, static_cast<Eigen::Index>(n));
    for (std::size_t k = 0; k < n; ++k) {
      const FieldOf opening{*a.model, a.biactive->response[k], FieldOf::Opening + k};
      v.openings.col(static_cast<Eigen::Index>(k)) = stress(opening);
      if (e.need.displacement) v.opening_u.col(static_cast<Eigen::Index>(k)) = displacement(opening, true);
    }
  }
  return v;
}

/// T, and the angle of what has one. `closed`, one entry per biactive row, is a guess of which stay closed, and the
/// answer afterwards.
Oriented expand(const Expansion& e, const PointValues& v, std::vector<bool>& closed);
std::vector<bool> no_row_closed(const Analysis& a);
/// What |T| could be for stresses of this size in other directions.
double size_of(const Expansion& e, const PointValues& v);

}  // namespace kerf
