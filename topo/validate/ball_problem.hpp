#pragma once
// The difference problem of a ball: a disc in it changes, the body around is condensed onto the ball's boundary and the
// rows of the cracks in contact.

#include "kerf/analysis.hpp"
#include "topo/formulas/kind.hpp"
#include "topo/validate/condense.hpp"

namespace kerf {

/// What the problems of all balls and radii share.
struct DifferenceSetting {
  /// `filling`: the scene of what fills the discs, of an inclusion.
  DifferenceSetting(const Model& model, const Perturbation& p, const Scene& filling);
  const Mesh& whole;
  const Kernel& kernel;
  Scene scene, inner_scene;  // compliances floored; of what fills the disc
  Becomes becomes;
  bool body;  // whether a force or an eigenstrain acts in it
};

/// A ball in the mesh of the whole.
struct BallInMesh {
  std::size_t number;
  const BallMesh& mesh;
  const std::vector<std::vector<Index>>& contours;  // edges of the whole; the ball's boundary first
  Index first, end;                                 // its triangles in the whole
  std::size_t triangles;                            // of the whole
  Eigen::Index unknowns;                            // on its boundary, and on any contour

  Index all_shells() const {
    return static_cast<Index>(contours.size());
  }
  /// Triangles of the ball with from <= shell < to.
  std::vector<bool> shells(Index from, Index to) const;
};

/// One body (that of a misfit is another) and the operator of its difference problem.
struct BodyOperator {
  /// `how`: the model's own preparation.
  BodyOperator(const Model& m, const Field& s, const Preparation& how);

  const Model& operators() const {
    return plain ? *plain : *model;
  }
  /// The other balls eliminated, this one cut out; K is its own condensed matrix.
  void focus(const BallInMesh& ball, const Eigen::MatrixXd& K);

  const Model* model;
  const Field* state;
  std::unique_ptr<const Model> plain;  // where the model itself is penalized
  Eigen::MatrixXd W;                   // Schur complement on kept and contact rows
  std::vector<ContactPoint> points;
  Eigen::VectorXd jump, force;  // on the contact rows, of the state
  std::vector<ContactStatus> status;
  std::vector<Motion> motion;  // of the state
  Eigen::MatrixXd S;           // on (ball, contact)
  /// The other balls' boundaries from what is on (ball, contact).
  Eigen::VectorXd others(const Eigen::VectorXd& mine) const;

 private:
  Eigen::MatrixXd rest_;  // the lower factor of the other balls' block of W
  Eigen::MatrixXd half_;  // the inverse of its factor times what couples it with (ball, contact)
};

/// What changes in one body.
struct BallChange {
  Eigen::VectorXd ball, contact, contour, load;  // load: on the contour
  Eigen::VectorXd push;                          // of the contact forces
  bool same = true;                              // the contact set
};

/// What a radius leaves.
struct ChangedBall {
  std::vector<bool> disc;  // triangles inside the contour
  std::vector<Index> contour;
  std::optional<CondensedPiece> annulus, inner;  // inner: what fills the disc
  std::vector<BallChange> changes;               // per body
  std::vector<double> energy;                    // change of the potential energy, per body
  bool same_contact = true;
  Eigen::VectorXd others;   // on the boundaries of the other balls
  Eigen::Index column = 0;  // in FarField::rows
  Eigen::VectorXd far;      // per term: change of its domain integral outside the ball
};

/// Focuses the bodies on the ball and solves for every radius.
std::vector<ChangedBall> solve_ball(const DifferenceSetting& setting, const BallInMesh& ball,
                                    std::vector<BodyOperator>& bodies);

}  // namespace kerf
