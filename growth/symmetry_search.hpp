#pragma once
// The turn of the next piece at which k_2 = 0 in the body that has it: a search that asks for turns, so that whoever
// solves bodies owns the solutions [theory: G.21].

#include "growth/kink.hpp"

#include <optional>
#include <vector>

namespace kerf::growth {

struct SymmetryOptions {
  double tolerance = 1e-3;       // of |k_2|/k_1
  int solves = 6;                // at most
  double largest_turn = pi / 2;  // on either side
  double slope = 0.5;            // of k_2/k_1 per radian, as expected: 1/2, and what T adds along the piece
};

/// while (search.turn()) search.answer(K of the body with a piece that turns by *search.turn());
/// then search.found() or not, and search.best().
class SymmetrySearch {
 public:
  struct Answer {
    double turn = 0;
    KinkLoad k;
  };
  /// `first`: from the series, or from the curvature of the last piece.
  explicit SymmetrySearch(double first, const SymmetryOptions& options = {});
  /// What is to be solved next; nothing when the search has ended.
  std::optional<double> turn() const;
  /// K at the end of the piece with that turn, in the direction in which it ends.
  void answer(const KinkLoad& k);

  bool found() const;
  /// The answer with the least |k_2|/k_1 among those that are open, of all if none is. Asked after one answer at least.
  const Answer& best() const;
  /// How far the turn of the best answer may be from that of k_2 = 0: |2 k_2/k_1|; infinity where none is open.
  double turn_error() const;
  const std::vector<Answer>& answers() const;

 private:
  SymmetryOptions options_;
  std::vector<Answer> answers_;
  std::optional<double> next_;
  std::size_t best_ = 0;
  std::optional<Answer> below_, above_;  // the nearest turns with k_2 < 0 and with k_2 > 0
};

}  // namespace kerf::growth
