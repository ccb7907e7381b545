#pragma once
// All that an iteration of a level set leaves to the next one.

#include "optimize/checkpoint.hpp"
#include "optimize/loop/evaluate.hpp"

namespace kerf {

/// A design to come back to.
struct KeptDesign {
  Eigen::VectorXd phi;  // empty: none yet
  double J = infinity, area = 0;
  Eigen::VectorXd bounds;
  int iteration = 0;
};

/// What the next call of Descent::advance begins with.
enum class Next { Step, BackToBest, CloseTrial, End, Nucleate };

struct DescentState {
  int iteration = 0, solves = 0;
  double allowed = 0;              // area
  double radius = 0;               // largest move of the boundary, a length
  double turn = 0;                 // of the fixed point: share of the angle
  Eigen::VectorXd phi;             // of the present design, as it was drawn
  Eigen::VectorXd psi;             // of the fixed point: on the unit sphere of L2
  double price = 0;                // of area
  Eigen::VectorXd weight;          // of violations of the bounds in the merit, in units of J
  Eigen::VectorXd faith;           // per bound: what came of falls that were predicted, 0.1 to 1
  KeptDesign best;                 // at the area wanted
  KeptDesign anchor;               // what a trial nucleation has to beat; empty: no trial
  int since = 0;                   // steps since the best, or of the trial
  int trials = 0;                  // nucleations tried
  int settled = 0;                 // iterations since the area is the one wanted
  bool explore = false;            // a start without holes: they appear on the way
  double residual = nan;           // of the present design, once a step from it was thought of
  int next = 0;                    // a Next
  std::string why;                 // of it, in words
  std::vector<double> track;       // merit of the best after every step at the final area
  std::string ended;               // why the loop is over; empty while it is not
  bool spent = false;              // that is because the iterations asked for are done
  std::vector<std::string> drawn;  // what carving the present design said
  std::vector<Iteration> rows;
  std::vector<NucleatedHole> nucleated;
};

/// Bit for bit. Throws Error(Files) where the checkpoint holds something else.
Checkpoint packed(const DescentState& s);
DescentState unpacked(const Checkpoint& c);

/// What a state must fit: vertices of the canvas, bounded functionals, the largest move and share of the angle.
struct StateSizes {
  Eigen::Index vertices = 0, bounds = 0;
  double radius = infinity, turn = infinity;
};
/// Throws Error(Files) for a state that no descent of these sizes keeps, so that the next step can count on it.
void check_state(const DescentState& s, const StateSizes& of);

}  // namespace kerf
