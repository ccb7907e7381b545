#pragma once
// Histories of load: turning points, cycles by rainflow counting, K at any level of load from a few that were solved,
// and the growth of a crack under a block of loads that repeats [theory: G.16, G.17, G.18].
//
// Loads are factors of the loads of a body, of any sign. Functions throw Error (Usage) for numbers that are not finite.

#include "growth/life.hpp"

#include <span>
#include <vector>

namespace kerf::growth {

/// Peaks and valleys of a history, with its first and its last value: neither repeats what is before it.
std::vector<double> turning_points(std::span<const double> history);

/// Cycles between two levels of load; a half one counts 0.5.
struct LoadCycle {
  double max = 0, min = 0, count = 0;
};

/// Rainflow counting of a history that happens once, in the order in which its cycles close, the halves that are left
/// last [ASTM 1985, 5.4.4].
std::vector<LoadCycle> rainflow(std::span<const double> history);

/// Rainflow counting of a history that repeats: whole cycles only, the largest range last [ASTM 1985, 5.4.5].
std::vector<LoadCycle> rainflow_of_block(std::span<const double> history);

/// Cycles with the same levels as one, larger ranges first, of equal ones the higher first.
std::vector<LoadCycle> merged(std::span<const LoadCycle> cycles);

/// How far the interpolations of K that its levels admit differ, and where most: there one more solution tells most.
/// 0 where K is linear; a bend at a level cannot be told from one beside it, and leaves a doubt.
struct LevelDoubt {
  double level = 0, difference = 0;  // of K_I or K_II
};

/// K_I, K_II, T over the level of load, from at least two levels that were solved. Without contact K is linear in the
/// load; with contact it bends where faces open and close. Between two inner levels it is the parabola through one more
/// level to the left or right that bends less, if it does not turn; at the ends a line [theory: G.16].
class LoadCurve {
 public:
  /// Levels rise.
  LoadCurve(std::vector<double> levels, std::vector<TipLoad> tips);
  /// All levels of a body without gaps and other loads than those that the level multiplies, by what it has at `level`
  /// > 0 and at -level: K grows with the level on either side of 0. Levels up to `level` may be asked, and there is no
  /// doubt.
  static LoadCurve homogeneous(double level, const TipLoad& pushed, const TipLoad& pulled);
  /// Throws (Usage) beyond the levels.
  TipLoad at(double level) const;
  LevelDoubt doubt() const;

 private:
  std::vector<double> levels_;
  std::vector<TipLoad> tips_;
  bool exact_ = false;
};

/// How far a crack of length a grows in a block, sum count da/dN; infinity where it runs [theory: G.17].
double block_growth(const GrowthLaw& law, std::span<const LoadCycle> block, const LoadCurve& curve, Equivalence how,
                    double a);

/// The life in blocks, of a curve per length, all with the levels of the block [theory: G.18].
Life block_life(const GrowthLaw& law, std::span<const LoadCycle> block, std::span<const double> a,
                std::span<const LoadCurve> curves, Equivalence how);

}  // namespace kerf::growth
