#pragma once
// A body that several processes solve together, each on its own part of the mesh: none ever has the whole.

#include "base/sums.hpp"
#include "geometry/mesh_part.hpp"
#include "kerf/adjoint.hpp"
#include "solver/effort.hpp"
#include "solver/part_matrix.hpp"

#include <cstring>
#include <functional>
#include <memory>
#include <span>

namespace kerf {

struct Floating;  // solver/system.hpp

/// Triangles that a part has at least: with fewer of them per process parts are not worth it.
inline constexpr std::size_t least_of_part = 8;

/// What solves cost, and how many of them ended before they were as exact as asked; why, of the last of these.
struct SharedEffort : SolverEffort {
  int unfinished = 0;
  std::string ended = {};
};

/// Solves K z = b, of which a process has the unknowns that are its own, in order.
class SharedSolver {
 public:
  virtual ~SharedSolver() = default;
  virtual Eigen::VectorXd solve(const Eigen::VectorXd& own) = 0;  // throws Error(Numerics) when it does not converge
  virtual SharedEffort effort() const = 0;
  /// The largest diagonal entry of what this process has of K.
  virtual double stiffest() const = 0;
};

/// What several processes share of a system: symmetric and positive definite. Vectors are those of the rows here, the
/// same on all who have them.
struct SharedSystem {
  using Map = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;
  Eigen::VectorXd counted;  // per row 1, or 0 where another process counts it
  Map multiply, precondition;
  Index primal = 0;  // unknowns of the small problem of the preconditioner
};
struct SharedSolved {
  Eigen::VectorXd x;
  int iterations = 0;
  double condition = 1;  // of the preconditioned matrix, as the iteration shows it; 0: it does not
  double left = 0;       // of the energy of the solution, its root, that of the error as the preconditioner has it
  bool failed = false;
  std::string ended = {};  // why it failed, in words of PETSc
};
/// Iterates on it, for many right-hand sides.
class SharedIteration {
 public:
  static constexpr double tolerance = 1e-10, enough = 1e-4;  // the rounds of the state go on from what is enough
  static constexpr int most = 500;
  virtual ~SharedIteration() = default;
  /// Until no more than `tolerance` is left, or no more than `enough` and rounding does not let it shrink.
  virtual SharedSolved solve(const Eigen::VectorXd& b) = 0;
};

/// What processes log the time of.
enum class PartsWork { Assembly, SetUp, Apply, Contact };

/// The processes. All of them call the same functions, in the same order.
class Communicator {
 public:
  virtual ~Communicator() = default;
  virtual Index here() const = 0;
  virtual Index count() const = 0;
  virtual void sum(std::span<double> values) = 0;  // over processes: the same bits on all
  virtual void largest(std::span<double> values) = 0;
  /// `to[p]` goes to process p; returns what came from each.
  virtual std::vector<std::string> exchange(const std::vector<std::string>& to) = 0;
  /// `packed`: solver/system/parted.hpp, what this process has of K; `total`: unknowns of all. By BDDC of our own
  /// (E.36) unless processes have been given another one.
  /// `precision`: of the factors of the insides.
  virtual std::unique_ptr<SharedSolver> solver(std::string packed, Index total, int threads, Precision precision);
  /// What iterates in it: conjugate gradients (solver/system/gradients.hpp), or what processes have instead.
  virtual std::unique_ptr<SharedIteration> iteration(SharedSystem system);
  virtual void log(PartsWork, bool /*begins*/) {}
};

/// One process, which has the whole.
class Alone : public Communicator {
 public:
  Index here() const override {
    return 0;
  }
  Index count() const override {
    return 1;
  }
  void sum(std::span<double> /*values*/) override {}
  void largest(std::span<double> /*values*/) override {}
  std::vector<std::string> exchange(const std::vector<std::string>& to) override {
    return to;
  }
};

/// Logs the time that it lives.
class LoggedWork {
 public:
  LoggedWork(Communicator& comm, PartsWork work) : peers_(comm), work_(work) {
    peers_.log(work_, true);
  }
  LoggedWork(const LoggedWork&) = delete;
  LoggedWork& operator=(const LoggedWork&) = delete;
  ~LoggedWork() {
    peers_.log(work_, false);
  }

 private:
  Communicator& peers_;
  PartsWork work_;
};

/// Plain values that came as bytes.
template <typename T>
std::vector<T> concatenated(const std::vector<std::string>& parts) {
  std::vector<T> all;
  for (const std::string& from : parts) {
    const std::size_t begin = all.size();
    all.resize(begin + from.size() / sizeof(T));
    if (!from.empty()) std::memcpy(static_cast<void*>(all.data() + begin), from.data(), from.size());
  }
  return all;
}
/// Plain values of each process, one after the other; the same on all.
template <typename T>
std::vector<T> gathered(Communicator& comm, const std::vector<T>& own) {
  const std::string bytes(reinterpret_cast<const char*>(own.data()), own.size() * sizeof(T));
  return concatenated<T>(comm.exchange(std::vector<std::string>(static_cast<std::size_t>(comm.count()), bytes)));
}

/// The same on the first process alone; nothing on the others.
template <typename T>
std::vector<T> gathered_by_first(Communicator& comm, const std::vector<T>& own) {
  std::vector<std::string> to(static_cast<std::size_t>(comm.count()));
  to[0].assign(reinterpret_cast<const char*>(own.data()), own.size() * sizeof(T));
  return concatenated<T>(comm.exchange(to));
}

double sum(Communicator& comm, double value);
Sums sums_over(Communicator& comm);

/// Per row in contact with neither gap nor pressure the response to a unit pair of forces that opens the crack there,
/// closed rows tied, and the openings of all of them (kerf/analysis.hpp Biactive).
struct OneSided {
  std::vector<Field> response;
  Eigen::MatrixXd opening;
};

/// The part of the body that this process has. Integrals over its model run over own triangles alone (solver/system.hpp
/// OwnShare): their sum over the processes is that of the body.
class SharedBody {
 public:
  /// `part` of a body that its supports hold, but for the motions that are floating. Throws Error(Usage) for an element
  /// that is not solved in parts. `piece`: of each triangle before it was divided, the connected part of its material
  /// (pieces_for_pressure). `whole`: the mesh before it was divided, for maps (OwnShare::whole). `precision`: in which
  /// the factors of the insides are kept, most of the memory; rounds then go on until the residual is the same.
  SharedBody(MeshPart part, const Element& e, Scene scene, int threads, const Floating& floating,
             const std::vector<Index>& piece, Communicator& comm, std::shared_ptr<const Mesh> whole = nullptr,
             Precision precision = Precision::Double);
  SharedBody(SharedBody&&) noexcept;
  ~SharedBody();

  const Model& model() const;
  Index unknowns() const;  // of the body: condensed, those in contact included
  /// The state of own triangles and of the neighbors that are here; certificate and counts are those of the body.
  /// Contact is settled by systems of the whole, one for each set of points that touch, beginning with `guess`.
  /// `keep_factor`: for what follows from the state.
  State solve(const ContactGuess& guess = {}, bool keep_factor = false);
  /// As kerf/adjoint.hpp has it, about the last state, and solver/tangent_cone.hpp with friction: `dJ` by all triangles
  /// and unknowns that are here, the field on them.
  TangentField solve_adjoint(const Field& state, const Sensitivity& dJ);
  /// Throws Error(Numerics) where there are too many such rows.
  OneSided one_sided(const Field& state);
  /// OpenSolve (base/sums.hpp).
  Eigen::VectorXd solve_open(const Eigen::VectorXd& forces);
  void drop_factor();
  SharedEffort effort() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// What SharedBody is to know of the materials of a mesh that is not divided yet.
std::vector<Index> pieces_for_pressure(const Mesh& mesh, const Scene& scene);

/// Throws Error(Usage) for an element whose unknowns do not live on edges alone: it is not solved in parts.
void require_edges_alone(const Element& e);

/// A part for each node of a graph, so that parts are of one size and few edges are cut: `start` and `neighbors` as
/// `dissection` has them.
using Partitioner =
    std::function<std::vector<Index>(const std::vector<Index>& start, const std::vector<Index>& neighbors)>;

/// The process of each triangle, so that their parts are of one size and few edges are cut.
std::vector<Index> shares(const Model& model, const Partitioner& partitioner);

}  // namespace kerf
