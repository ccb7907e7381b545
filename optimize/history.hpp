#pragma once
// What an optimisation reports while it runs and when it ends.

#include "optimize/request.hpp"
#include "solver/model.hpp"

namespace kerf {

/// A row of history.csv. No times: a resumed run writes the same file bit for bit.
struct Iteration {
  int number = 0;        // 0: the start
  double objective = 0;  // J, volume penalty left out
  double merit = 0;      // what is minimised: J + penalty * area
  double volume_fraction = 0;
  std::vector<double> bounds;  // values of the bounded functionals
  double violation = 0;        // largest relative violation of a constraint
  double step = 0;             // level set: largest move of the boundary; NLopt: largest relative change
  double optimality = 0;       // level set: angle (radians) or relative gradient; NLopt: KKT residual; NaN unknown
  int holes = 0;
  Index triangles = 0;
  int state_solves = 0;            // so far, line searches included
  std::string note;                // why the objective rose, what was nucleated, dropped, ...; empty mostly
  Eigen::VectorXd variables = {};  // NLopt methods
};

/// An accepted iterate; model and state are those of the first load case.
struct Iterate {
  const Iteration& row;
  const Shape& shape;
  const Model& model;
  const State& state;
};
/// Called after every accepted iterate, `at_end` once more with the last one. false: stop here.
using Observer = std::function<bool(const Iterate&)>;

struct OptimizeResult {
  std::string method;
  int iterations = 0, state_solves = 0;
  double objective = 0, volume_fraction = 0, optimality = 0;
  bool feasible = true;
  bool converged = false;
  std::string stopped;  // "converged", or why, in words
  std::vector<std::string> notes;
  std::vector<Iteration> history;
  Shape shape;                     // the last one
  Scene scene;                     // of it: laws and regions may be fewer or more than those of the case
  Eigen::VectorXd variables = {};  // NLopt methods
};

}  // namespace kerf
