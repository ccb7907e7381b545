#pragma once
// The two admissible fields of a state, and what bounds of its energy are made of, triangle by triangle [theory: B.2].

#include "kerf/bounds.hpp"
#include "solver/bounds/conforming.hpp"

#include <cmath>
#include <functional>
#include <memory>
#include <span>

namespace kerf {

/// Tractions of a triangle on its edges at the Gauss points, in the frames of the edges, outwards.
using Tractions = Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, max_skeleton / 2>;

inline constexpr int strain_degree = 4;  // of the polynomials of eigenstrains that have a rest

/// What the rest of an eigenstrain acts on in one triangle.
struct StrainShare {
  double square = 0, stress = 0;  // the mean of |p - its projection onto P4|^2; the largest |p|
  double elastic = 0;             // the energy of v
  double strain = 0;              // the largest of v, less the polynomial of the eigenstrain
  double force = 0;               // where nothing may change its volume: |(f, w)| <= force |grad w| for w in H^1_0(T)
};
/// Of a displacement's gradient: rotations do no work on an eigenstrain.
inline double largest_strain(const Mat2& gradient) {
  return std::max(
      {std::abs(gradient(0, 0)), std::abs(gradient(1, 1)), 0.5 * std::abs(gradient(0, 1) + gradient(1, 0))});
}
struct Share : StrainShare {  // of one triangle
  double lower = 0, upper = 0, size = 0, asymmetry = 0;
  double rough = 0;             // |grad v - polynomials that (f - f_h) does not see|
  double largest = 0;           // |v| at its nodes
  double gradient = 0;          // largest
  double divergence = 0;        // largest: div v where nothing may change its volume
  double below = 0, above = 0;  // what of the eigenstrain the polynomials do not see may move the bounds by
  double rules = 0;             // on curved cells what of `below` and `above` is between two rules
  Tractions tractions;
  // If they are kept, at the points of the rule: the stress p, the strain of v less the eigenstrain, and v.
  Eigen::Matrix4Xd kept_stress, kept_strain;
  Points kept_displacement;
  // The same on a curved cell, where the points are those of its own rule: J times the weights of two rules (rows).
  Eigen::Matrix2Xd kept_weight;
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
/// bound: |(C e, R)| + (C R, R)/2, or in a straight triangle what is left when v takes up the trace of R [theory:
/// B.28]. The mean is that over the triangle of the chords.
double moved_by_eigenstrain(const Material& material, const Triangle& t, double rest, double error,
                            const MovedField& on);

/// A body held by nothing, with piecewise constant displacements: the element and the bounds see the means of f.
bool unseen_couples(const Forces& f);

/// The tractions of both sides of an edge, those given there, and what the fields do on it.
struct EdgeWork {
  Index edge;
  std::array<Tractions, 2> side;  // at its Gauss points
  const EdgeData* given;          // or null
  SkeletonVector base, jump;      // values of the multiplier; no jump but at cracks that may open
  double penetration = 0;
};
/// What the equilibrium of the tractions and the sign of those of contact lack, times the displacements, and the work
/// of pressure on penetration: rounding.
double imbalance_on(const Model& m, const EdgeWork& at);

/// The interval of an energy from the sums over the triangles.
struct EnergySums {
  Share sum;
  double imbalance = 0;  // of all edges
  Oscillation oscillation;
  double mismatch = 0, beyond_arcs = 0;
  bool couples = false;  // unseen_couples
  bool on_arcs = false;  // of a body of which another process has curved edges
};
EnergyBounds energy_interval(const Model& m, const EnergySums& of);

/// `column`: per triangle that of its forces, or none; empty: its own number.
std::vector<Rest> rests_of(const Model& m, const std::vector<EdgeData>& data, const Forces& f,
                           const std::vector<std::vector<Index>>& edges, std::span<const Index> column = {});

struct References;

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
  double rounding = 0;
  double beyond_arcs = 0;            // estimated, a part of sum.below and sum.above
  EnergyBounds bounds;               // not finite: nothing else is there
  TriangleRule plain, rich;          // rich: of triangles with data on their edges
  Points plain_curved, rich_curved;  // of curved cells
  std::shared_ptr<const References> references;
};
/// Why there are no bounds of the energy, as far as the data tell; empty: there are.
std::string unseen_by_bounds(const Model& m);
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

/// Of the lower and the upper bound as quadratic forms, and the sizes of what they are sums of.
struct Products {
  double lower = 0, upper = 0, size = 0;
  double rules = 0;  // on curved cells, what of both is between two rules

  void add_lower(double term) {
    lower += term;
    size += std::abs(term);
  }
  void add_upper(double term) {
    upper += term;
    size += std::abs(term);
  }
  void add(const Products& p) {
    lower += p.lower;
    upper += p.upper;
    size += p.size;
    rules += p.rules;
  }
};
/// Of kept stresses and strains in one triangle.
Products crossed_fields(const Material& material, double area, const TriangleRule& rule, const Share& a,
                        const Share& b);
/// Loads on the displacement of a data edge, prescribed values on its tractions.
struct EdgeSide {
  const Model& m;
  const EdgeData& data;
  const EdgePolynomial& value;  // of the conforming displacement
  const Tractions& tractions;   // of its triangle
};
Products crossed_on_edge(const EdgeSide& u, const EdgeSide& w);

/// One of two states, and the interval of the crossed energy from the sums over the triangles.
struct CrossSide {
  const EnergyBounds& bounds;
  double gap, rounding, mismatch;  // gap: without rounding and what data leave out
  bool couples;
  double beyond_arcs = 0, rules = 0;  // of curved cells
};
/// `oscillation`, `strain`: Oscillation and what of eigenstrains is unseen, at the step k.
CrossEnergy cross_interval(const Model& m, const CrossSide& u, const CrossSide& w, const Products& p,
                           const std::function<Oscillation(double k)>& oscillation,
                           const std::function<double(double k)>& strain);
/// What the rest of the eigenstrains of u + k w may move the bounds by on a triangle, below and above together.
double eigenstrain_unseen(const Material& material, const Triangle& t, double rest, double error, const StrainShare& u,
                          const StrainShare& w, double k);
/// For squares q(u + k w) <= (q(u)^1/2 + k q(w)^1/2)^2.
double together(double u, double w, double k);

}  // namespace kerf
