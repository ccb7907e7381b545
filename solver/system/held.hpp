#pragma once
// Factors of K with rows in contact held, for contact too large for a dense matrix [theory: C.31].

#include "solver/contact/contact.hpp"
#include "solver/factor.hpp"
#include "solver/system/ordering.hpp"
#include "solver/system/partial_forward.hpp"

#include <memory>
#include <mutex>
#include <optional>
#include <vector>

namespace kerf {

/// Where each row of K is eliminated when none has to come last: the jumps in contact with their edges, as those of
/// open cracks.
std::vector<Index> sequence_within(const Mesh& mesh, const Skeleton& s, const Ordering& o);

/// Which rows a set of motions holds; all where there are no motions.
std::vector<bool> held_by(const std::vector<Motion>& motion, Index contact_rows);

/// K with rows in contact held: their rows and columns are those of a diagonal matrix, so that the pattern, and with it
/// the analysis of the factor, is that of every set. One thread at a time.
class HeldFactors {
 public:
  HeldFactors(std::vector<Index> sequence, Index contact_rows, int threads)
      : sequence_(std::move(sequence)), contact_rows_(contact_rows), threads_(threads) {}

  /// Where a solution is wanted: everywhere, or on the rows in contact and those that K couples with them (what stands
  /// elsewhere has no meaning then).
  enum class On { All, Contact };
  /// K x = b on the rows that move, x = 0 on those held: by the last factor, bordered where the set differs from its
  /// own in a few rows [theory: C.32], else by a new one. Throws as Factor does.
  Eigen::VectorXd solve(const LowerTriangle& K, const std::vector<bool>& held, const Eigen::VectorXd& b,
                        On on = On::All);

  /// The factor for a set, which is made anew, in the memory of the last one, unless that is it.
  std::shared_ptr<const Factor> of(const LowerTriangle& K, const std::vector<bool>& held);

 private:
  std::vector<Index> changes(const std::vector<bool>& held) const;
  bool worth_bordering(const std::vector<Index>& changed) const;
  void border(const LowerTriangle& K, const std::vector<Index>& changed);
  std::vector<PartialForward::Column> read_columns(const LowerTriangle& K, const std::vector<Index>& fresh);
  /// Jumps of released rows, less the forces on rows that are held now.
  Eigen::VectorXd multipliers(const std::vector<Index>& changed, const Eigen::VectorXd& y,
                              const Eigen::VectorXd& b) const;
  void factorize(const LowerTriangle& K);
  const Eigen::VectorXd& partial_forward(Eigen::VectorXd right);
  const std::vector<EntryPlace>& couplings(const LowerTriangle& K);
  Eigen::VectorXd backward(const LowerTriangle& K, const Eigen::VectorXd& y, On on);

  std::mutex one_at_a_time_;
  std::vector<Index> sequence_;
  Index contact_rows_;
  int threads_;
  std::vector<bool> held_;  // in the factor
  std::shared_ptr<Factor> last_;
  std::vector<EntryPlace> couplings_;  // entries of K on rows in contact
  std::vector<bool> fronts_;           // that On::Contact goes through
  Eigen::VectorXd right_, y_;  // the last right-hand side, and L^-1 P of it: sets that follow each other share it
  // Of rows that are held in the factor and move, or the other way round: a column of K, without rows held in the
  // factor, or a unit vector.
  std::optional<PartialForward> columns_;
  std::vector<Index> number_;  // per row in contact that of its column, or none
  std::vector<Index> bordered_;
  Eigen::MatrixXd small_;  // products of all columns, less the entries of K where both rows are released
};

}  // namespace kerf
