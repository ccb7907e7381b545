#pragma once
// Forces and moments that act on the body as a whole.

#include "solver/system.hpp"

namespace kerf {

/// A force and its moment about the origin.
struct Resultant {
  Vec2 force = Vec2::Zero();
  double moment = 0;
  void add(const Vec2& at, const Vec2& f) {
    force += f;
    moment += cross(at, f);
  }
  void add(const Resultant& other) {
    force += other.force;
    moment += other.moment;
  }
};

/// Of the tractions, per label of the scene that has any: by the data, not by what an element sees of them.
struct LabelResultant {
  Index label;
  Resultant of;
};
std::vector<LabelResultant> traction_resultants(const Mesh& mesh, const EdgeCurvatures& curvatures, const Scene& scene,
                                                const SceneData& data);
Resultant body_resultant(const Mesh& mesh, const EdgeCurvatures& curvatures, const Scene& scene, const SceneData& data,
                         const TriangleRule& rule);

/// What the supports exert on the body, per label of a support: the tractions of the solution less the loads that act
/// there, on the components that are held. In displacement elements the forces on nodes; those of a corner count to
/// the first of its labels.
std::vector<LabelResultant> reactions(const Model& model, const Field& state);

}  // namespace kerf
