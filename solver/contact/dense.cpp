// The active set on a dense S. With M the moving rows, a set takes
//   S_MM j_M = r_M + p_M,   j = 0 on held rows,   p = S j - r,   S_MM = C C',
// and C is kept from set to set: rows that stay at its beginning stay factorized, new ones are appended in the order of
// falling |jump|, so that those which may soon be held again stand at the end. Forms: `dual_qp` for contact and
// friction, `solve_unilateral` where every row is normal, `OpenRows` for the linear problem with a given closed set.
// The method of [Belhachmi 2008] with S read off the factor of the body [theory: C.7]; docs/theory/contact.md, section
// The small problem.

#include "solver/contact/contact.hpp"

#include "base/dense.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

// S_MM = C C' on the moving rows M. C grows at its end; rows that may soon be held are put there, so that most of C
// stays when they leave.
// At the beginning, without a response, a row's jump alone, r_i/S_ii, stands for its size.
class MovingBlock {
 public:
  MovingBlock(const Eigen::MatrixXd& S, const Eigen::VectorXd& r)
      : S_(S), r_(r), factor_(S.rows(), S.cols()), size_(r.cwiseQuotient(S.diagonal()).cwiseAbs()) {}

  // Forces of all rows, moving ones too: what these miss of their known force is the rounding that the search must
  // allow for.
  Response solve(const std::vector<Motion>& motion, const Eigen::VectorXd& force) {
    factorize(motion);
    Response response{Eigen::VectorXd::Zero(r_.size()), -r_};
    if (rows_.empty()) return response;
    Eigen::VectorXd value = r_(rows_) + force(rows_);
    const auto c = factor_.topLeftCorner(value.size(), value.size()).triangularView<Eigen::Lower>();
    c.solveInPlace(value);
    c.transpose().solveInPlace(value);
    response.jump(rows_) = value;
    response.force.noalias() += S_ * response.jump;
    size_ = response.jump.cwiseAbs();
    return response;
  }

 private:
  // Rows up to the first that is now held stay; C grows by a block, [C 0; B C_2] with B = S_nm C^-T, C_2 C_2' = S_nn -
  // B B'. A block that is not definite becomes NaN, which ends the search as not converged.
  void factorize(const std::vector<Motion>& motion) {
    const auto moves = [&](Index i) { return motion[i] != Motion::Held; };
    rows_.erase(std::find_if_not(rows_.begin(), rows_.end(), moves), rows_.end());
    std::vector<bool> here(motion.size(), false);
    for (const Index i : rows_) here[i] = true;
    std::vector<Index> next;
    for (Index i = 0; i < static_cast<Index>(motion.size()); ++i)
      if (moves(i) && !here[i]) next.push_back(i);
    if (next.empty()) return;
    std::stable_sort(next.begin(), next.end(), [&](Index a, Index b) { return size_[a] > size_[b]; });
    const Eigen::Index kept = static_cast<Eigen::Index>(rows_.size()), added = static_cast<Eigen::Index>(next.size());
    auto corner = factor_.block(kept, kept, added, added);
    corner = S_(next, next);
    if (kept > 0) {
      Eigen::MatrixXd beside = S_(rows_, next);
      factor_.topLeftCorner(kept, kept).triangularView<Eigen::Lower>().solveInPlace(beside);
      corner.selfadjointView<Eigen::Lower>().rankUpdate(beside.transpose(), -1);
      factor_.block(kept, 0, added, kept) = beside.transpose();
    }
    Eigen::Ref<Eigen::MatrixXd> block = corner;
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> in_place(block);
    if (in_place.info() != Eigen::Success) block.setConstant(nan);
    rows_.insert(rows_.end(), next.begin(), next.end());
  }

  const Eigen::MatrixXd& S_;
  const Eigen::VectorXd& r_;
  Eigen::MatrixXd factor_;
  std::vector<Index> rows_;
  Eigen::VectorXd size_;  // |jump| of the last response
};

}  // namespace

Contact dual_qp(const Eigen::MatrixXd& S, const Eigen::VectorXd& r, const std::vector<ContactPoint>& points,
                const std::vector<Motion>& guess) {
  // A set costs up to n^3: a budget in work, so that no contact problem can run for ever.
  constexpr double most_work = 1e13;
  const double n = static_cast<double>(r.size());
  MovingBlock block(S, r);
  const Eliminated system{
      .rows = static_cast<Index>(r.size()),
      .solve = [&](const std::vector<Motion>& motion,
                   const Eigen::VectorXd& force) { return block.solve(motion, force); },
      .most_iterations = static_cast<int>(std::clamp(most_work / (n * n * n), 100.0, 5000.0)),
      .elsewhere = [&](const std::vector<ContactPoint>& with_limits) { return interior_set(S, r, with_limits); }};
  return active_set(system, points, guess);
}

Unilateral solve_unilateral(const Eigen::MatrixXd& S, const Eigen::VectorXd& r, const std::vector<bool>& closed) {
  std::vector<ContactPoint> points(r.size());
  for (std::size_t i = 0; i < points.size(); ++i) points[i].normal = static_cast<Index>(i);
  std::vector<Motion> guess(closed.size());
  for (std::size_t i = 0; i < closed.size(); ++i) guess[i] = closed[i] ? Motion::Held : Motion::Forward;
  Contact c = dual_qp(S, r, points, guess);
  std::vector<bool> held(c.motion.size());
  for (std::size_t i = 0; i < held.size(); ++i) held[i] = c.motion[i] == Motion::Held;
  return {std::move(c.jump), std::move(c.force), std::move(held), c.iterations, c.converged};
}

OpenRows::OpenRows(const Eigen::MatrixXd& S, std::vector<bool> closed) : closed_(std::move(closed)) {
  for (std::size_t i = 0; i < closed_.size(); ++i)
    if (!closed_[i]) open_.push_back(static_cast<Index>(i));
  if (!open_.empty()) factor_ = cholesky(S(open_, open_));
}

Eigen::VectorXd OpenRows::jumps(const Eigen::VectorXd& r) const {
  Eigen::VectorXd jump = Eigen::VectorXd::Zero(r.size());
  if (open_.empty()) return jump;
  const Eigen::VectorXd load = r(open_), value = solve(*factor_, load);
  jump(open_) = value;
  return jump;
}

}  // namespace kerf
