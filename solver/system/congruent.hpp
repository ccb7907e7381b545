#pragma once
// Triangles of equal shape: the inside of a mesh is a lattice, whose triangles are translations of a few.

#include "solver/element/shared_shape.hpp"
#include "solver/system/skeleton.hpp"

namespace kerf {

/// Straight triangles inside the body that agree in shape and material share one elimination. Equal are edges that
/// differ by less than 2e-13 of the longest: what rounding leaves of a lattice.
class CongruentTriangles {
 public:
  CongruentTriangles() = default;
  /// `penalty`: Penalty::a times mu. Nothing is shared where an eigenstrain acts.
  CongruentTriangles(const Mesh& mesh, const Kernel& k, const Skeleton& s, const Scene& scene, const SceneData& data,
                     double penalty, int threads);

  /// Tells triangle t of its shared shape, if it has one for loads like its own.
  void share(Index t, LocalTriangle& local) const;
  Index shared() const {
    return shared_;
  }

 private:
  struct Place {
    Index shape = none;
    int turn = 0;
  };
  std::vector<Place> of_;  // per triangle; empty when nothing is shared
  std::vector<SharedShape> shapes_;
  Index shared_ = 0;  // triangles
  int moments_ = 0;   // of a force, that the shapes know
};

}  // namespace kerf
