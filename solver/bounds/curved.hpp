#pragma once
// The shares of triangles with curved edges in the bounds of the energy [theory: B.29].

#include "solver/bounds/admissible.hpp"
#include "solver/bounds/right_inverse.hpp"
#include "solver/nucleus.hpp"

namespace kerf {

/// Everything that does not depend on the triangle. Stresses of the triangle of the chords are polynomials of degree n
/// by their values on lattice(n), displacements of degree n + 1; their divergences and asymmetries times J are of
/// degree n + k. Two rules on each third, of which the difference is what is known of the error of either.
struct CurvedReference {
  Points nodes;                       // lattice(n + k)
  TriangleRule rule;                  // points of both; the weights of the better one, 0 at those of the other
  Eigen::VectorXd coarse;             // the weights of the other
  Eigen::MatrixXd at_nodes, at_rule;  // from lattice(n)
  std::array<Eigen::MatrixXd, 2> slope, slope_at_rule;  // from lattice(n + 1)
  Eigen::MatrixXd value_at_rule;
  RightInverse inverse;
  Eigen::MatrixXd to_strains, of_strains;  // from the rule to lattice(strain_degree), and back
};
CurvedReference curved_reference(int n, int k);

/// How many times the difference between the two rules stands for the error of the better one.
inline constexpr double doubt_of_rules = 2;

/// The eigenstrain as a polynomial of the triangle of the chords, at the nodes and at the points of the rule.
struct CurvedStrain {
  Eigen::Matrix4Xd at_nodes, at_rule;
};

/// `stress`: on lattice(n) that of the chords' triangle, in equilibrium with the loads. Adds minus the complementary
/// energy of a symmetric one. With `rest`, where the polynomial leaves something of the eigenstrain,
/// StrainShare::square and stress are those of J p: of what the work of that rest is the integral over the chords'
/// triangle.
void add_complementary_energy(const CurvedReference& r, const Triangle& cell, const Material& material,
                              const Eigen::Matrix4Xd& stress, const CurvedStrain& free, Share& share, bool keep,
                              bool rest);
/// The elastic energy of the displacement v (on lattice(n + 1)) with its divergence moved towards that of `stress`,
/// less the work of `load`: J f at the points of the rule, or no columns. Sets Share::elastic and Share::upper.
void add_elastic_energy(const CurvedReference& r, const Triangle& cell, const Material& material,
                        const Eigen::Matrix4Xd& stress, const CurvedStrain& free, const Points& load, const Points& v,
                        Share& share, bool keep);

/// What the body has beyond the polynomials that its edges are: the area between an arc and its polynomial times the
/// density of the work of stress and strain there, several times. An estimate.
double beyond_arcs(const Model& m, const Field& s);
/// The same of the works between a state and a singular field that leaves the arc of a crack free, but not the
/// polynomials.
double beyond_crack(const Model& m, const Field& s, Index crack, const Nucleus& G);

}  // namespace kerf
