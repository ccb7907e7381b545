#pragma once
// Pieces of a body that contact alone holds: what they may do, and what it takes to factorize and to search [theory:
// C.24, C.25].

#include "solver/contact/contact.hpp"
#include "solver/system/ordering.hpp"
#include "solver/system/rigid.hpp"
#include "solver/system/sparse.hpp"

namespace kerf {

struct PieceMotion {
  Index piece;
  Vec2 inside;  // a point of the piece
  RigidMotion motion;
};

/// Empty for bodies whose pieces are held by supports.
struct Semicoercive {
  std::vector<PieceMotion> motions;
  std::vector<Index> piece;  // per triangle
  Eigen::MatrixXd free;      // combinations of motions that no law resists, a column each
  Eigen::VectorXd springs;   // per row in contact: on the diagonal of the matrix that is factorized
  Eigen::MatrixXd slides;    // rows in contact: orthonormal jumps of `free`
  Eigen::MatrixXd others;    // and of what else the pieces may do
  bool in_pieces = false;    // cracks cut the body, held by supports or not
  bool empty() const {
    return motions.empty();
  }
  /// Of S onto the rows in contact, as the factor has it: takes the springs out. What slides without resistance stays
  /// where it slides least.
  void release(Eigen::Ref<Eigen::MatrixXd> S) const;
};

/// Per triangle: the piece that open and closed cracks leave it in.
std::vector<Index> pieces_of(const Mesh& mesh, const Scene& scene);
/// The pieces that cracks leave and supports do not hold. Marks tangential jumps that are to be rows in contact of no
/// law, so that a piece that slides freely is held by its rows (Skeleton::sliding). Throws Error(Numerics) that names a
/// motion that no contact can resist.
Semicoercive semicoercive_pieces(const Mesh& mesh, const Kernel& k, const Scene& scene, Skeleton& s);

/// What is numbered and assembled.
struct Numbered {
  const Mesh& mesh;
  const Kernel& kernel;
  const Scene& scene;
  const Skeleton& skeleton;
  const Ordering& ordering;
};
/// That contact holds the body, but not by pressures at the points that the mesh has: `triangles` at the ends of the
/// feet are to be smaller.
struct CoarseFeet : Error {
  CoarseFeet(const std::string& what, std::vector<Index> of) : Error(Fault::Numerics, what), triangles(std::move(of)) {}
  std::vector<Index> triangles;
};
/// Fills springs, slides and others, and takes out of the loads F what rounding pushes the pieces by. Throws
/// Error(Numerics) that names how the pieces begin to move where no forces of contact, which may act up to the ends of
/// edges, balance F [theory: C.37]: with Coulomb's friction a necessary condition alone. Throws CoarseFeet.
void hold(const Numbered& of, const LowerTriangle& K, Eigen::VectorXd& F, Semicoercive& semicoercive,
          std::vector<std::string>& notes);

/// S j - r = p on rows in contact, S without resistance to Semicoercive::others.
struct SmallProblem {
  const Eigen::MatrixXd& S;
  const Eigen::VectorXd& r;
  const std::vector<ContactPoint>& points;
  const Semicoercive& semicoercive;
};
/// By proximal steps on the motions [theory: C.26], then with the set that they find by S alone.
Contact semicoercive(const SmallProblem& problem, const std::vector<Motion>& guess);

}  // namespace kerf
