#pragma once
// Factors of K with rows in contact held, for contact too large for a dense matrix [theory: C.31].

#include "solver/contact/contact.hpp"
#include "solver/factor.hpp"
#include "solver/system/ordering.hpp"

#include <memory>
#include <mutex>
#include <vector>

namespace kerf {

/// Where each row of K is eliminated when none has to come last: the jumps in contact with their edges, as those of
/// open cracks.
std::vector<Index> sequence_within(const Mesh& mesh, const Skeleton& s, const Ordering& o);

/// Which rows a set of motions holds; all where there are no motions.
std::vector<bool> held_by(const std::vector<Motion>& motion, Index contact_rows);

/// K with rows in contact held: their rows and columns are those of a diagonal matrix, so that the pattern, and with it
/// the analysis of the factor, is that of every set.
class HeldFactors {
 public:
  HeldFactors(std::vector<Index> sequence, Index contact_rows, int threads)
      : sequence_(std::move(sequence)), contact_rows_(contact_rows), threads_(threads) {}

  /// The factor for a set, which is made anew, in the same memory where nobody else has it, unless it was the last one.
  /// Throws as Factor does.
  std::shared_ptr<const Factor> of(const LowerTriangle& K, const std::vector<bool>& held);
  int made() const {
    return made_;
  }

 private:
  std::shared_ptr<Factor> factorize(const LowerTriangle& K);

  std::mutex one_at_a_time_;
  std::vector<Index> sequence_;
  Index contact_rows_;
  int threads_;
  int made_ = 0;
  std::vector<bool> held_;
  std::shared_ptr<Factor> last_;
};

}  // namespace kerf
