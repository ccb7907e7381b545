#pragma once
// Solve, estimate, refine: until the estimated error of the stress is small enough.

#include "kerf/bounds.hpp"
#include "kerf/mesher.hpp"
#include "kerf/state.hpp"

namespace kerf {

/// Residual indicator per triangle, in the norm of the stress [Carstensen, Dolzmann 1998; theory: R.4]:
///   eta^2 = |as s|^2 + (2 mu)^2 (h^2 |curl D|^2 + sum_e w_e |e| |J_e|^2) + h^2 |f + div s|^2,  D = A s + Gamma(omega),
/// h the longest edge, J_e the jump of D tau (w = 1/2; D tau - d_tau u_D on supported components, w = 1; nothing on
/// free boundaries; on a crack less the slope of the discrete jump, its normal part where the faces touch, its
/// tangential part where they stick). What the element does not see of the data adds to it [theory: D.3].
struct Indicator {
  Eigen::VectorXd eta;  // per triangle
  double relative = 0;  // sum over the body, divided by the efficiency index and by |s|: a relative L2 stress error
  // Of a goal:
  double power = 1;              // `relative` falls like this power of the norm of eta
  std::string note = {};         // why `relative` is not to be relied on yet
  double error = 0, stress = 0;  // squares, of which `relative` is the root of the ratio
};
/// The efficiency index is measured on the body itself, against the recovered stress where that is one (theory: R.6):
/// 1.2 to 1.5 of the true error on adapted meshes, 0.8 to 2.5 on coarse ones in random scenes. An estimate, not a
/// bound; not a number for displacement elements.
Indicator error_indicator(const Model& model, const State& state);

/// What refines for a bounded quantity: `eta` are the indicators of its dual solutions. The half width is the product
/// of what the state and a dual solution lack, and falls the most where the sum of both, each relative to its own
/// whole, does. `relative`: half the width over the middle.
Indicator refine_for(const Indicator& state, const Bounded& quantity, const std::vector<Eigen::VectorXd>& eta);

/// Remesh: a new mesh with the sizes that the indicator asks for; few rounds, curved sides stay exact. Bisect: halve
/// the triangles that carry half of the squared error [Doerfler 1996]; more rounds, nested meshes.
enum class Refinement { Remesh, Bisect };

struct Round {
  Index triangles = 0;
  double estimated_error = 0;  // Indicator::relative, of the goal if there is one
  double mesh = 0, assemble = 0, factor = 0, solve = 0, contact = 0, estimate = 0;  // seconds; contact within solve
};

struct Adaptation {
  double error = 1e-2;  // wanted: Indicator::relative
  Index max_triangles = 200000;
  Refinement refinement = Refinement::Remesh;
  ContactMethod contact = ContactMethod::DualQp;
  bool saddle_point = false;  // solve_saddle_point instead of solve
  bool estimate = true;       // solve_graded: else the indicator stays empty
  int threads = 1;
  std::function<bool(const Round&)> go_on = {};  // asked after each round
  std::function<void(const Mesh&)> meshed = {};  // told the mesh of each round
  std::shared_ptr<const Mesh> given = {};        // the first mesh, as it is, instead of one of the shape
  int divisions = 0;  // every triangle of the mesh that is solved on into four, so many times
  /// What to refine for, if not the stress, with the indicator of the state: `relative` is what `error` is asked of.
  std::function<Indicator(const Model&, const State&, const Indicator&)> goal = {};
  Precision precision = Precision::Double;
};

struct Adapted {
  Model model;
  State state;
  Indicator indicator;
  std::vector<Round> rounds;
  std::string stopped = {};  // why, in words; begins with "reached" when the error is
  Sizing sizing = {};        // what was asked for, with the ends of contact that its mesh is graded at
};

/// Where contact on a crack ends (closed to open) and where faces that stick begin to slip, along all cracks; at most
/// 32, those between the longest stretches.
std::vector<Vec2> contact_ends(const Model& model, const Field& state);

/// One solution on the mesh that `sizing` asks for, graded at the ends of contact [theory: C.20]: there the adjoint of
/// every J but an energy is singular as the state is at a tip, and T depends on where the end is. They are found on a
/// coarse mesh (where that is much cheaper), graded, and the mesh is made anew where contact ends elsewhere after all.
/// A body without contact is solved once; so is one whose cracks are all open or all closed, but for the coarse mesh;
/// a given mesh is solved once as it is.
/// Uses `contact`, `saddle_point`, `estimate`, `threads`, `divisions` of the adaptation. Throws as triangulate and
/// prepare do.
Adapted solve_graded(const Shape& shape, const Sizing& sizing, const Element& e, const Scene& scene,
                     const Adaptation& how);

/// From the mesh that `sizing` asks for, which stays the coarsest allowed. Throws as triangulate and prepare do, and
/// Error(Usage) for an element without an error indicator. Asked to stop (kerf/stop.hpp) it returns the round before,
/// without its factor; throws Stopped when there is none.
Adapted solve_adaptively(const Shape& shape, const Sizing& sizing, const Element& e, const Scene& scene,
                         const Adaptation& adaptation);

}  // namespace kerf
