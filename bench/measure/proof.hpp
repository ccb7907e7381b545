#pragma once
// `kerf bench proof`: how wide the guaranteed intervals of K, G, stresses and T are, whether they contain the exact
// value, and what they cost; how good the second term of the expansion is.

#include "bench/command/bench.hpp"
#include "kerf/types.hpp"

namespace kerf {

struct ProofRow {
  std::string problem, mesh;  // "uniform" | "tips" | "goal"
  int degree = 1;
  Index triangles = 0;
  std::string quantity;
  double exact = nan, lower = nan, upper = nan;
  double relative = nan;  // half the width, over the size of the quantity (of stresses the norm of the exact one)
  bool guaranteed = false, contained = false;
  double cost = nan;  // processor time of this quantity over that of the state
};

/// c2 at a point of a disc, beside that of its exact series.
struct SecondTermRow {
  std::string change;
  int degree = 1;
  Index triangles = 0;
  Vec2 at = Vec2::Zero();
  double T_exact = nan, c2_exact = nan, T = nan, c2 = nan;
  double error = nan;                                // of c2, over the sum of the sizes of its parts
  double radius = nan;                               // of a change that is made
  double left_by_first = nan, left_by_second = nan;  // of its change of J, relative
};

struct ProofBench {
  std::vector<ProofRow> rows;
  std::vector<SecondTermRow> second;
  bool quick = false, stopped = false;
};

/// Straight open cracks under exact tractions, on uniform meshes, on meshes graded to the tips, and on meshes refined
/// for K_I; the second term in a disc. Writes proof.csv, second_terms.csv, proof.json, proof.md and proof.png. Quick:
/// the coarsest meshes. Throws Error(Files).
ProofBench run_proof_bench(const BenchOptions& options);

/// Rows that are guaranteed and do not contain the exact value.
std::size_t failures(const ProofBench& bench);

std::string summary(const ProofBench& bench);

/// Names that --case takes.
std::vector<std::string> proof_case_names();

}  // namespace kerf
