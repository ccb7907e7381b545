#pragma once
// A mesh that follows curves.

#include "optimize/curves/design_curves.hpp"
#include "optimize/parametric/extend.hpp"

namespace kerf {

/// A vertex of the mesh on a chain, or on a side of the frame beside one, at a share of its way.
struct CurveFollower {
  Index vertex;
  Index chain = none;
  ChainPlace place = {};
  Index loop = none, piece = none;  // of a side
  double part = 0;
};

struct CurveMesh {
  Mesh mesh;
  std::vector<CurveFollower> followers;
  Extension extension;
  std::vector<double> angles;
  Points start;  // of the followers
};
/// Throws as triangulate does.
CurveMesh curve_mesh(const DesignCurves& d, const Sizing& sizing);

/// The mesh moved to curves that have the same knots, or nothing when it suffers.
std::optional<Mesh> moved(const CurveMesh& m, const DesignCurves& d);

/// Derivatives by the variables of the curves from those by the vertices of the mesh moved there.
Eigen::VectorXd pull_back(const CurveMesh& m, const DesignCurves& d, const Points& force);

}  // namespace kerf
