#pragma once
// The bodies that the bench solves. Geometry, material, loads and the measure of the error are those of the scripts
// s1.edp to s4.edp that other programs run, so that times at equal error can be compared.

#include "kerf/adaptive.hpp"
#include "kerf/mesher.hpp"
#include "tests/support/exact_field.hpp"

#include <optional>

namespace kerf {

/// A very fine solution at the points of a quadrature rule: what stands in where no closed form is known.
struct Reference {
  std::vector<Vec2> x;
  Eigen::VectorXd weight;
  Eigen::Matrix4Xd stress;
  Points displacement;
  double strain_energy = 0;
  double error = 0;  // estimate of its own relative L2 stress error
};

/// A corner where the stress is singular or jumps: the error of an element of length d there falls like d^exponent.
struct SharpCorner {
  std::size_t side;  // of the outline; the corner is its start
  double exponent;
};

struct BenchProblem {
  std::string name, title;
  double poisson = 0.3;
  Shape shape;
  Scene scene;
  double coarsest = 1;  // mesh size at level 0
  std::vector<SharpCorner> corners;
  std::optional<exact::ExactField> exact;
  std::optional<Reference> reference;
  double known_energy = 0;  // strain energy where it is known to ten digits, else 0
};

/// "smooth": manufactured solution on the unit square, zero displacement on its boundary. "cook-stress", "cook-strain":
/// Cook's membrane. "open-crack": displacements prescribed around. "closing-crack": partly closed by contact, held by
/// its tractions alone.
struct ProblemKind {
  std::string name, title;
  std::vector<double> poisson;
};
const std::vector<ProblemKind>& problem_kinds();
BenchProblem problem(const std::string& name, double poisson);  // throws std::invalid_argument for an unknown name

/// Adaptive: refined from level 0 until the estimated error is small.
enum class Grading { Uniform, Graded, Adaptive };
/// Level l has edges 2^(l/2) times shorter than level 0. Graded: towards crack tips and sharp corners, so that an
/// element of the given degree (stress errors h^(degree + 1)) is as accurate there as elsewhere.
struct MeshPlan {
  Shape shape;
  Sizing sizing;
};
MeshPlan bench_plan(const BenchProblem& problem, Grading grading, int degree, double level);
Mesh bench_mesh(const BenchProblem& problem, Grading grading, int degree, double level);
/// Adaptive level l asks for an estimated error of 0.1 / 2^l.
Adapted adapt(const BenchProblem& problem, const Element& e, double level);

/// Degree 3 on a graded mesh of the given level; `error` is its distance from the one two levels coarser.
Reference overkill(const BenchProblem& problem, double level);

/// Relative, in L2 over the body: of the stress tensor, and of u* up to a rigid motion where nothing else is fixed.
struct Errors {
  double stress = 0, displacement = 0;
};
Errors errors(const BenchProblem& problem, const Model& model, const State& state);

}  // namespace kerf
