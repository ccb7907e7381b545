#pragma once
// Displacements of points of the boundary, read off a state and differentiated.

#include "kerf/inverse.hpp"
#include "kerf/model.hpp"

namespace kerf {

/// Where sensors lie on the edges of a mesh. Between two edges: half of each.
class Sensors {
 public:
  /// Throws Error(Usage) when the mesh has no edge with the label.
  Sensors(const Mesh& mesh, const Readings& readings);

  /// u of all sensors, x and y in turn: 2 sensors. From the traces on the edges, whose polynomials are evaluated.
  Eigen::VectorXd read(const Model& m, const Field& s) const;

  /// sum_i weights_i u_i as an integral over the label: point values are integrals with polynomials of the same degree
  /// (Riesz). For meshes of this topology alone, whose outline may not move.
  Term weighted(const Model& m, const Eigen::VectorXd& weights) const;

 private:
  struct Spot {
    Index edge;
    double at, share;  // from the first vertex (0) to the second (1)
  };
  struct Line {
    Index edge;
    Vec2 a, b;
  };
  Index label_;
  std::vector<Line> lines_;               // edges of the label
  std::vector<std::vector<Spot>> spots_;  // per sensor
};

}  // namespace kerf
