// `kerf bench proof` as a whole, on coarse meshes.

#include "bench/measure/proof.hpp"
#include "tests/support/folder.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace kerf::proof_test {
namespace {

class ProofBenchTest : public test::InFolder {};

// With a body force singular fields are cut off: the intervals are wider, not wrong.
TEST_F(ProofBenchTest, IntervalsContainWhatIsExactWithAndWithoutACutOff) {
  const ProofBench bench =
      run_proof_bench({.folder = folder, .cases = {"c01_modeI", "c01_with_weight"}, .quick = true});
  EXPECT_EQ(failures(bench), 0u);
  for (const char* problem : {"c01_modeI", "c01_with_weight"}) {
    std::size_t rows = 0, contained = 0, guaranteed = 0;
    for (const ProofRow& r : bench.rows) {
      if (r.problem != problem) continue;
      ++rows;
      contained += r.contained;
      guaranteed += r.guaranteed;
    }
    EXPECT_GE(rows, 3u * 15) << problem;  // 6 of tips and 9 of points on each mesh
    EXPECT_EQ(contained, rows) << problem;
    // On coarse meshes the distance of a cut-off field is an estimate.
    EXPECT_GE(guaranteed, std::string_view(problem) == "c01_modeI" ? rows : 12) << problem;
  }
  const std::string page = text("proof.md");
  EXPECT_NE(page.find("| c01_with_weight | tips | 2 |"), std::string::npos) << page;
  EXPECT_NE(text("proof.csv").find("c01_with_weight"), std::string::npos);
  EXPECT_NE(summary(bench).find("guaranteed intervals contain the exact value"), std::string::npos);
}

}  // namespace
}  // namespace kerf::proof_test
