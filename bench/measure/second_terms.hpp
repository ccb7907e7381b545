#pragma once
// Of `kerf bench proof`: the second term of the expansion against discs whose series are exact.

#include "bench/measure/proof.hpp"

namespace kerf {

/// "disc": the unit disc under loads of degree 4, a hole or an inclusion at three places, on coarse to fine meshes.
std::vector<SecondTermRow> measure_second_terms(const BenchOptions& options);

/// As a table, the worst of all places per mesh and change.
std::string second_term_table(const std::vector<SecondTermRow>& rows);

}  // namespace kerf
