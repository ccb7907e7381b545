#pragma once
// The two admissible fields of a state, and what bounds of its energy are made of, triangle by triangle [theory: B.2].

#include "kerf/bounds.hpp"
#include "solver/bounds/conforming.hpp"

namespace kerf {

/// Tractions of a triangle on its edges at the Gauss points, in the frames of the edges, outwards.
using Tractions = Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, max_skeleton / 2>;

struct Share {  // of one triangle
  double lower = 0, upper = 0, size = 0, asymmetry = 0, stress = 0;
  double rough = 0;                     // |grad v - polynomials that (f - f_h) does not see|
  double largest = 0;                   // |v| at its nodes
  double divergence = 0, gradient = 0;  // largest: div v where nothing may change its volume
  double below = 0, above = 0;          // what of the eigenstrain the polynomials do not see may move the bounds by
  double square = 0;                    // where an eigenstrain has a rest: the mean of |p - its projection onto P4|^2
  double elastic = 0;                   // the energy of v
  double force = 0;  // where nothing may change its volume: |(f, w)| <= force |grad w| for w in H^1_0(T)
  Tractions tractions;
  // If they are kept, at the points of the rule: the stress p, the strain of v less the eigenstrain, and v.
  Eigen::Matrix4Xd kept_stress, kept_strain;
  Points kept_displacement;
};

/// What the polynomials do not see of body force and tractions on a triangle: the factor of |eps(u - v)|, of the
/// roughness of v, and the error of the quadrature of works, of the largest |v|.
struct Rest {
  double data = 0, body = 0, quadrature = 0;
};

/// What the polynomials do not see of body force and tractions. v a displacement, f_h and g_h the polynomials:
///   (f - f_h, u - v)_T <= (h/pi) |f - f_h| K |eps(u - v)| by Poincare's and Korn's inequalities on the triangle,
///   |w|_e^2 <= |e| h^2/|T| (1/pi^2 + 1/pi) |grad w|_T^2 for w of zero mean over T by the divergence theorem,
/// and (f - f_h, v) is small because f - f_h is orthogonal to the polynomials in v.
struct Oscillation {
  double eta = 0, correction = 0;
  double quadrature = 0;  // work that the data are integrated wrong by, on the displacements of the solution
};

/// What the data that the fields do not see may move the bounds by.
struct Unseen {
  double below, above, displaced;  // `displaced`, a part of `above`, is an estimate
};
Unseen unseen(const Model& m, const Oscillation& o, double mismatch_squared, double gap);

/// What the rest of an eigenstrain acts on in a triangle.
struct MovedField {
  double elastic, largest;  // of the strain e less the polynomial of the eigenstrain: (C e, e)/2, the largest |e|
  double stress, force;     // the largest of p, and Share::force
};
/// At least what the rest R of an eigenstrain, its mean square `rest` and the error of its means, adds to the upper
/// bound: |(C e, R)| + (C R, R)/2, or what is left when v takes up the trace of R [theory: B.28].
double moved_by_eigenstrain(const Material& material, const Triangle& t, double rest, double error,
                            const MovedField& on);

/// A body held by nothing, with piecewise constant displacements: the element and the bounds see the means of f.
bool unseen_couples(const Forces& f);

/// Everything that the bounds of one energy are made of; with the fields at the points of the rules.
struct AdmissiblePair {
  const Model& m;
  Forces f;
  std::vector<EdgeData> data;
  std::vector<std::vector<Index>> edges;  // of the data, per triangle
  Conforming conforming;
  std::vector<Share> shares;
  std::vector<Rest> rests;
  Share sum;
  double rounding = 0, beyond_arcs = 0;
  EnergyBounds bounds;       // not finite: nothing else is there
  TriangleRule plain, rich;  // rich: of triangles with data on their edges
};
/// The model must outlive it. `inside`: the least degree of the polynomials; pairs of states are to have the same.
AdmissiblePair admissible(const Model& m, const Field& s, int inside);
/// What `admissible` takes of itself.
int degree_inside(const Model& m, bool with_body, bool with_eigenstrain);

/// For two states u and w of one body with the same supports and the same loaded edges: -(J(u + k w) - J(u - k w))/(2k)
/// [theory: B.12] lies within `half` of `middle`, at the best k.
struct CrossEnergy {
  double middle = nan, half = nan;
  bool guaranteed = false;
  std::string note;
};
CrossEnergy cross_energy(const AdmissiblePair& u, const AdmissiblePair& w);

}  // namespace kerf
