#pragma once
// One triangle's shares in the bounds of an energy [theory: B.4, B.5, B.6].

#include "solver/bounds/admissible.hpp"
#include "solver/bounds/curved.hpp"
#include "solver/bounds/right_inverse.hpp"

#include <memory>
#include <optional>

namespace kerf {

/// Everything that does not depend on the triangle. Stresses, divergences and forces are polynomials of degree n by
/// their values on lattice(n), displacements of degree n + 1 by theirs on lattice(n + 1).
struct TriangleReference {
  int n;
  TriangleRule rule;
  Points nodes, field_nodes;
  Eigen::MatrixXd at_rule, field_at_rule;                                  // values
  std::array<Eigen::MatrixXd, 2> slope, field_slope, field_slope_at_rule;  // derivatives
  Eigen::MatrixXd raise;                                                   // conforming displacement -> lattice(n + 1)
  Eigen::MatrixXd force, mean_force;                                       // body force, what the element sees of it
  RightInverse inverse;
  Eigen::MatrixXd normal_free;
  Eigen::MatrixXd to_strains, of_strains;                 // from the rule to lattice(strain_degree), and back
  std::array<std::array<Eigen::MatrixXd, 2>, 3> at_edge;  // values at the Gauss points, edges backward and forward
  std::shared_ptr<const CurvedReference> curved;          // where there are curved triangles
};

/// The points of a rule along an edge, on the triangle of reference; `forward`: from its first vertex to its second.
Points points_on_side(const EdgeRule& rule, int side, bool forward);

struct References {
  TriangleReference plain, rich;  // rich: boundary data are of higher degree than the fields inside
};
References references(const Element& e, int inside, const Forces& f, bool curved);

/// What is known of the solution in one triangle: coefficients of a stress in balance, of the fields, and nodal values
/// of the conforming displacement.
struct CellFields {
  Eigen::Ref<const Eigen::VectorXd> statics, interior, nodal;
};

/// J(v + alpha w) = e + alpha b + alpha^2 a.
struct Parabola {
  double e = 0, b = 0, a = 0;
  double at(double alpha) const {
    return e + alpha * (b + alpha * a);
  }
};

struct Bounding {
  const Model& m;
  const Forces& f;
  const std::vector<EdgeData>& data;
  const Conforming& conforming;  // its values on the edges of the data
  bool keep = false;             // the fields
  /// Of a triangle whose body force and eigenstrain are not in the column of its number.
  struct Elsewhere {
    const StrainData& strain;
    Index column;
  };
  std::optional<Elsewhere> loads = std::nullopt;
  EdgeRule carrier = gauss(data_carriers);

  const StrainData& strain() const {
    return loads ? loads->strain : m.inner->data.strain;
  }
  Index column(Index t) const {
    return loads ? loads->column : t;
  }

  /// The coordinate (1 + l_b - l_a)/2 along a boundary edge and l_a l_b, at a point (l1, l2).
  struct Along {
    double s, bump;
  };
  Along along(const EdgeData& d, const Vec2& l) const;
  /// Symmetric stress in equilibrium: its complementary energy and the work of the supports.
  void lower(const TriangleReference& r, Index t, const CellFields& at, const std::vector<Index>& edges,
             Share& share) const;
  /// The mean of |p - its projection|^2: the rest of an eigenstrain, also of the other state of a pair, works on no
  /// polynomial of its degree.
  static double beyond_strains(const TriangleReference& r, const Eigen::Matrix4Xd& stress);
  Points nodes(const TriangleReference& r, const Triangle& shape) const;
  /// Rows with the rest of the tractions as normal trace and the rest of the body force as divergence.
  void add_loads_unseen(const TriangleReference& r, Index t, const std::vector<Index>& edges,
                        Eigen::Matrix4Xd& stress) const;
  /// At the points of the rule; no columns without one.
  Eigen::Matrix4Xd eigenstrain(const TriangleReference& r, Index t) const;
  /// That of a curved triangle, and whether its polynomial leaves something of it.
  CurvedStrain curved_strain(const CurvedReference& r, Index t) const;
  bool leaves_strain(Index t) const;
  /// <u_D, t n> on the prescribed components, less the work of tractions that act there.
  void work_of_supports(const Tractions& tractions, const std::vector<Index>& edges, Share& share) const;
  Tractions tractions(const TriangleReference& r, const Triangle& shape, const Eigen::Matrix4Xd& stress) const;
  /// Of the loads on an edge with data, at one of its points and in all.
  double work_at(Index i, int g) const;
  double work_on_edge(Index i) const;
  /// J times the body force at the points of the rule of a curved cell; no columns without one.
  Points load_on(const CurvedReference& r, Index t) const;
  /// The trace of A s, in isotropic bodies 2 c tr s, and that of the eigenstrain.
  Eigen::RowVectorXd wanted_divergence(const TriangleReference& r, Index t, const CellFields& at) const;
  /// The conforming displacement v at the nodes of fields, on held edges with the bubbles of what is prescribed there.
  Points conforming_values(const TriangleReference& r, const CellFields& at, const std::vector<Index>& edges) const;
  /// The work of body forces and loads, off the energy; how large that and its parts are. `own`: the correction at the
  /// rule.
  double add_works(const TriangleReference& r, Index t, const std::vector<Index>& edges, const Points& v,
                   const Eigen::VectorXd& own, Parabola& along, Share& share) const;
  void upper_curved(const TriangleReference& r, Index t, const CellFields& at, const std::vector<Index>& edges,
                    const Points& v, Share& share) const;
  /// The least energy of v + alpha w over alpha, w a field that vanishes on the boundary of the triangle and whose
  /// divergence is what that of v lacks of that of the stress.
  void upper(const TriangleReference& r, Index t, const CellFields& at, const std::vector<Index>& edges,
             Share& share) const;
};

}  // namespace kerf
