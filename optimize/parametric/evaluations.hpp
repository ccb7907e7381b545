#pragma once
// A design evaluated: drawn, meshed or its mesh moved, solved under every load case, differentiated.

#include "kerf/model.hpp"
#include "kerf/optimize.hpp"
#include "optimize/parametric/constraints.hpp"
#include "optimize/parametric/extend.hpp"
#include "optimize/parametric/minimize.hpp"

#include <memory>
#include <optional>

namespace kerf {

/// What the evaluation of a design leaves behind; all that a replay needs.
struct DesignEvaluation {
  Evaluation evaluation;  // merit and constraints: volume, bounds by load case, those on the geometry
  int round = 0;
  Index base = none;              // which mesh of the round was moved
  bool fresh = false;             // that one was made for this design
  Fault fault = Fault::Geometry;  // of a failure; not part of a replay
  double objective = nan, volume_fraction = 0;
  std::vector<double> bounds;  // of the bounded functionals, the worst load case
  Index triangles = 0;
  int holes = 0, state_solves = 0;
};

/// The body of a design and its state under the first load case.
struct SolvedDesign {
  DrawnBody body;
  Model model;
  State state;
};

/// Evaluates designs in rounds. A round begins with a mesh of its first design; the others move the mesh of the nearest
/// design that was meshed in the round (harmonic extension of the motion of what is drawn), so that J is a smooth
/// function with an exact derivative. Where that would leave angles below 13 degrees, a fresh mesh is made.
class Evaluations {
 public:
  /// Both must outlive it. Throws Error(Usage) as check_design does; what else cannot be optimized, refuse_wrong says.
  Evaluations(const Problem& problem, const OptimizeRequest& request);
  ~Evaluations();

  Eigen::Index constraints() const;
  const std::string& constraint(Eigen::Index i) const;  // what is wrong when it is violated, in words
  /// Why there are no derivatives, or nothing: elements without.
  const std::optional<std::string>& blind() const;
  double frame_area() const;

  void begin_round();
  /// From now on the bounds are these, instead of what the request allows.
  void allow(const std::vector<double>& at_most);
  /// The largest violation of what the request itself asks for, at least 0.
  double violation_of_request(const DesignEvaluation& design) const;
  /// Designs that cannot be drawn, meshed or solved come back with Evaluation::failure, and what is known of them.
  DesignEvaluation evaluate(const Eigen::VectorXd& x, bool gradients);
  /// Numbers read off the state of a design, and derivatives by x of functionals of it, one column each, exact as those
  /// of `evaluate`. Under the loads of the scene. On the mesh of the nearest design of the round, moved: `failure`
  /// where that cannot be, or where the state cannot be solved for; a round's first design is meshed.
  struct Response {
    Eigen::VectorXd values;
    Eigen::MatrixXd gradients;  // variables x functionals
    std::string failure = {};
    Fault fault = Fault::Geometry;
  };
  using Reading = std::function<Eigen::VectorXd(const Model&, const Field&)>;
  using Asked = std::function<std::vector<Functional>(const Model&)>;
  Response respond(const Eigen::VectorXd& x, const Reading& reading, const Asked& asked = {});

  /// Takes note of an evaluation that an earlier run made, instead of making it. Whether it is one of this round, on a
  /// mesh that there is.
  bool replay(const DesignEvaluation& known);
  /// The body of a design of this round or the one before and its state, solved for again unless it was the last one to
  /// be evaluated.
  std::shared_ptr<const SolvedDesign> solved(const DesignEvaluation& design);

  /// Relative errors of derivatives along a direction (in boxes) at a design of this round, against central differences
  /// on its moved mesh; the merit first, then what is constrained and needs the state. `state_solves`: what it took.
  struct Check {
    std::vector<double> error;
    int state_solves = 0;
  };
  Check check_derivatives(const DesignEvaluation& at, const Eigen::VectorXd& direction, double step);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace kerf
