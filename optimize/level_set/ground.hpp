#pragma once
// What never changes while a level set moves: the canvas, what stays solid, what area costs and may be used.

#include "optimize/level_set/regularize.hpp"
#include "optimize/loop/evaluate.hpp"

namespace kerf {

struct Ground {
  const Problem& p;
  const OptimizeRequest& r;
  BackgroundMesh background;
  double size = 0;             // smallest length of designs: of the mesh size, or finer
  double mesh_size = 0;        // of the mesh of the body
  double whole = 0;            // area of the frame
  double target = 0;           // largest area
  double price = 0;            // per area: of volume in J, and the penalty
  bool limited = false;        // the area has a bound
  std::vector<Index> loaded;   // labels of loads and of what functionals look at
  std::vector<Index> holding;  // labels of supports
  std::vector<std::string> notes;
  std::unique_ptr<Helmholtz> filter;        // of the fixed point
  std::unique_ptr<ElasticProduct> elastic;  // of velocities, where it is asked for

  bool weak() const {
    return r.level_set.ersatz > 0;
  }
  bool turns() const {
    return r.level_set.move == LevelSetRequest::Move::FixedPoint;
  }
  /// Labels of a design from this one on are not the frame's.
  Index free_label() const {
    return static_cast<Index>(p.frame.labels.size());
  }
};

/// Throws Error(Usage) for a request or an element that does not fit, Error(Geometry) for a frame without a mesh.
Ground make_ground(const Problem& p, const OptimizeRequest& r);

/// A design drawn from a function on the canvas, meshed with edges `coarse` times the size, and solved.
struct DrawnLevelSet {
  Eigen::VectorXd phi;             // what was drawn: what carving dropped or filled is out of it
  std::vector<std::string> notes;  // of carving
  std::shared_ptr<const Evaluated> design;
};
/// `wanted`: phi is shifted until the shape has this area, to 1e-5 of the frame; nothing: as it is. Throws
/// Error(Geometry | Numerics).
DrawnLevelSet draw(const Ground& g, Eigen::VectorXd phi, std::optional<double> wanted, double coarse);

/// The problem as designs are meshed on the way: one edge across thin members.
Problem fitted(const Ground& g, double coarse);

/// Whether stresses themselves count, not only the energy that they store.
bool counts_stress(const Functional& j);

/// The shape of a function that was drawn.
Carved carved_again(const Ground& g, const Eigen::VectorXd& phi);

}  // namespace kerf
