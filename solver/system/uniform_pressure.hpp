#pragma once
// Uniform pressures of pieces of one material: what the penalty iteration hardly shrinks.

#include "base/sums.hpp"
#include "solver/system.hpp"
#include "solver/system/elementwise.hpp"

#include <functional>
#include <span>

namespace kerf {

struct Loads;  // solver/system/penalty.hpp

/// A body as uniform pressures see it, of one process or of several.
struct PressedBody {
  const Model& model;
  const Loads& loads;
  /// x, in numbers of the body's own, under what these theta alone do, with all that is held at 0.
  std::function<Eigen::VectorXd(const Eigen::VectorXd& theta)> respond;
  /// All skeleton unknowns of such an x.
  std::function<Eigen::VectorXd(const Eigen::VectorXd& x)> skeleton;
  Sums over_all = sums_of_one();
  bool symmetric = true;  // not with sliding points
};

/// The iterations shrink every error fast but one: a uniform pressure where there is no volume to change, in a body
/// that its supports enclose, in a soft region that a stiff one encloses, falls only by a/(a + c) or a/(a + 1/mu) with
/// the mu of what encloses it. So the uniform pressures, one per connected piece of a material, are taken out exactly:
/// theta + a delta_k on piece k, x + sum_k delta_k response_k, with delta such that the means over the pieces of
/// theta - a mean(tr s) vanish [theory: E.23]. With c = 0 everywhere an enclosed body has no level of pressure at all,
/// and no solution when its boundary is asked to change the volume: the mean pressure is then zero.
class UniformPressure {
 public:
  /// `piece`: per triangle; none: those of the body, 200 at most.
  explicit UniformPressure(std::vector<Index> piece) : piece_(std::move(piece)) {}
  UniformPressure() = default;
  /// Whether `correct` throws Error(Numerics) where the boundary asks for more change of volume than rounding.
  bool must_fit = false;

  /// delta for what x (its skeleton) and theta miss, with these rows held; theta takes it. x moves by `response()`
  /// delta.
  Eigen::VectorXd correct(const PressedBody& body, const std::vector<bool>& held, const DoubleDouble& skeleton,
                          Eigen::VectorXd& theta);
  /// Takes the mean pressure out of theta where nothing answers it.
  void take_out_level(const PressedBody& body, const DoubleDouble& skeleton, Eigen::VectorXd& theta) const;

  /// Per piece the x of theta = a on it.
  const Eigen::MatrixXd& response() const {
    return response_;
  }
  /// Whether the last solution leaves the level of pressure free.
  bool level_open() const {
    return level_open_;
  }
  int solves() const {
    return solves_;
  }

 private:
  void prepare(const PressedBody& body);
  Eigen::VectorXd over_pieces(const PressedBody& body, const Eigen::VectorXd& values) const;

  bool level_open_ = false;
  std::vector<bool> held_;     // that the responses were found with
  std::vector<Index> piece_;   // per triangle
  Eigen::MatrixXd response_;   // a column per piece
  Eigen::MatrixXd stiffness_;  // sum_T |T| (a - a d mean(tr s)/d delta), per piece
  Eigen::VectorXd size_;       // sum_T |T| a of each piece
  int solves_ = 0;
};

/// Connected triangles of one material; all are one piece without regions. No more than `most`: those that are left
/// share the last.
std::vector<Index> material_pieces(const Mesh& mesh, const Scene& scene, Index most);

}  // namespace kerf
