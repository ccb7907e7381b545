#pragma once
// A body ready to be solved, and its solution.

#include "solver/assemble.hpp"
#include "solver/contact.hpp"
#include "solver/rigid.hpp"

namespace kerf {

struct ModelSeconds {
  double assemble = 0, factor = 0;
};

struct Model {
  Mesh mesh;
  Kernel kernel;
  Scene scene;
  Skeleton skeleton;
  Ordering ordering;
  System system;
  Factor factor;                      // empty when not asked for
  std::vector<RigidMotion> floating;  // rigid motions that the supports leave free; the loads balance on them
  std::vector<std::string> notes;     // what the user should know
  int threads = 1;
  ModelSeconds seconds;
};

/// Numbers, assembles and factorises. Throws Error(Numerics) when the supports leave a rigid motion free on which the
/// loads do work, naming the motion, or when a crack cuts off a piece that the supports do not hold.
/// `factorise`: for `solve`; solve_extended (extended.hpp) does without.
/// `kept_edges`: their unknowns come next to last, before the jumps in contact (Factor's kept columns); `plain`: see
/// assemble.
struct Preparation {
  bool factorise = true, plain = false;
  std::vector<Index> kept_edges = {};
};
Model prepare(Mesh mesh, const Element& e, Scene scene, int threads, const Preparation& how = {});

struct Certificate {
  double residual = 0;  // |K x - F| on the unknowns that no contact holds, over |F| (maximum norms)
  double kkt = 0;       // the largest of residual and Contact::kkt, relative
  double rounding = 0;  // eps |K| |x| / |F|: no residual in double precision can be expected to be smaller
};

struct StateSeconds {
  double solve = 0, contact = 0;
};

struct State {
  Eigen::VectorXd skeleton;  // base and jump unknowns, prescribed ones included
  Eigen::MatrixXd interior;  // one column per triangle: stress, displacement, rotation coefficients
  Eigen::VectorXd force;     // per skeleton unknown: force of contact and friction on jumps, 0 elsewhere
  int contact_iterations = 0, linear_solves = 0;
  bool converged = true;  // the active set settled
  Certificate certificate;
  StateSeconds seconds;
};
State solve(const Model& model, ContactMethod method = ContactMethod::DualQp);

/// The contact set settled and the certificate holds: kkt at most 1e-10, or not above what rounding allows.
bool certified(const State& state);

Triangle triangle(const Model& model, Index t);
Fields evaluate(const Model& model, const State& state, Index t, const Points& x);

double strain_energy(const Model& model, const State& state);     // 1/2 (A s, s)
double work_of_loads(const Model& model, const State& state);     // body force and tractions
double potential_energy(const Model& model, const State& state);  // strain energy minus work of the loads
double area(const Model& model);

}  // namespace kerf
