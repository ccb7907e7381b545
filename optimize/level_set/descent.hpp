#pragma once
// One design on its way down: steps that predict, refused ones halved, holes nucleated on trial [theory: L.7, L.12].

#include "optimize/level_set/ground.hpp"
#include "optimize/level_set/hole_terms.hpp"
#include "optimize/level_set/progress.hpp"
#include "optimize/level_set/speed.hpp"

namespace kerf {

struct DescentRules {
  double coarse = 1;          // mesh size against the one asked for
  int iterations = 100;       // at most
  double residual = 0.1;      // of the shape: the descent has done its part
  std::string from = {};      // the start, in words
  int solves = 0;             // made before
  bool explore = false;       // a start without holes: they appear on the way
  int trials = 1;             // nucleations tried at the end
  bool try_holes = true;      // nucleated ones, alone: what they do to J is looked at
  std::vector<double> tight;  // share of every bound that this mesh may use
  std::string ended = {};     // why it is over with its start, in words; empty: it is not
};

/// What the state of a descent on that ground has to fit.
StateSizes sizes_of_state(const Ground& g);

class Descent {
 public:
  /// From a function on the canvas. Throws Error(Geometry | Numerics) where its design cannot be drawn or solved.
  Descent(const Ground& g, DescentRules rules, const Eigen::VectorXd& start);
  /// Goes on.
  Descent(const Ground& g, DescentRules rules, DescentState progress);

  /// One step; false: the descent is over, and the present design is the best one.
  bool advance();

  const DescentState& progress() const {
    return s_;
  }
  const Evaluated& design() const {
    return *design_;
  }
  /// The present design and its row, for those who watch.
  Iterate iterate() const;
  bool settled() const;
  bool keeps_bounds(const Evaluated& e) const;
  /// What bounds and area leave of J: less is better.
  double merit() const;
  /// T of the merit at the centroids of the first load case's mesh, less the price of area in J; a weak phase: minus
  /// that of becoming solid.
  Eigen::VectorXd derivative() const;
  /// Shape residual of the present design as it is, without a step.
  double residual() const;

 private:
  using Design = std::shared_ptr<const Evaluated>;
  struct Rates {
    BoundaryRate objective;
    std::vector<BoundaryRate> bounded;
    std::vector<std::pair<std::size_t, Index>> of;  // bound and load case
  };
  struct Tried {
    Eigen::VectorXd phi, psi;
    DrawnLevelSet drawing;
    BoundaryStep step;
    std::vector<std::string> notes;
    double allowed = 0;
    bool nucleated = false;
    std::vector<Disc> discs;               // that were cut then
    std::unique_ptr<HoleExpansion> holes;  // of the design before
    std::string failure;                   // no drawing then
  };

  void begin(const Eigen::VectorXd& start);
  const Rates& rates() const;
  const Eigen::VectorXd& distance() const;
  MovingDesign moving() const;
  StepLimits limits(double radius, double allowed) const;
  Tried attempt();
  void drop_idle(Eigen::VectorXd& phi) const;
  void move_boundary(Tried& t);
  void turn(Tried& t) const;
  std::vector<WeightedAnalysis> binding_bounds() const;
  void nucleate(Tried& t, const Eigen::VectorXd& distance);
  void log_nucleated(Tried& t, const std::string& how);
  void judge(Tried& t);
  void take(Tried& t);
  void refuse(const Tried& t, double rise);
  void adapt_radius(const Tried& t, double before, double after);
  void keep_if_best();
  void go_back(const KeptDesign& to, const std::string& why);
  void close_trial(bool worth);
  bool try_nucleation();
  std::string reason_to_end() const;
  bool follow_up();
  void step();
  void decide();
  bool appearing() const;
  double own_residual() const;
  void show(Design design, std::vector<std::string> notes);
  double value(double J, double area, const Eigen::VectorXd& bounds) const;
  double value(const Evaluated& e) const;
  double value(const KeptDesign& k) const;
  Eigen::VectorXd relative(const Eigen::VectorXd& bounds) const;
  double noise() const;

  const Ground& g_;
  DescentRules rules_;
  DescentState s_;
  Design design_, best_, anchored_;
  // Of the present design, once asked for.
  mutable std::optional<Rates> rates_;
  mutable std::optional<Eigen::VectorXd> distance_;  // signed, to its boundary
};

}  // namespace kerf
