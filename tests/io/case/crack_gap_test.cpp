// The key `gap` of [[crack]].
#include "tests/io/case/case_files.hpp"

namespace kerf::crack_gap_test {
namespace {

const std::string cracked = square + R"([[crack]]
name = "c"
path = [[0.5, 0.5], [1, 0.5]]
)";

TEST(CrackGap, IsANumberOrAnExpression) {
  const Case overlap = read(cracked + "gap = -0.01\n");
  ASSERT_TRUE(has_gap(overlap.scene.laws[0]));
  EXPECT_EQ(overlap.scene.laws[0].gap({0.7, 0.5}, {0, 1}), Vec2(-0.01, 0));
  const Case formula = read(cracked + "gap = \"far * x^2\"\nfriction = 0.3\n[define]\nfar = \"0.1 * y\"\n");
  EXPECT_NEAR(formula.scene.laws[0].gap({0.4, 0.5}, {0, 1}).x(), 0.008, 1e-15);
  EXPECT_FALSE(has_gap(read(cracked).scene.laws[0]));
}

TEST(CrackGap, IsRefusedByNameWhereItHasNoMeaning) {
  for (const char* contact : {"open", "bonded"})
    EXPECT_EQ(
        error(cracked + "contact = \"" + contact + "\"\ngap = 1\n"),
        "a.toml:11:7: gap in [[crack]]: the faces of crack \"c\" never touch; give it contact = \"unilateral\", or "
        "leave the gap out");
  EXPECT_NE(error(cracked + "gap = \"ny\"\n").find("a.toml:10:7: gap in [[crack]]: "), std::string::npos);
  EXPECT_NE(error(cracked + R"(gap = 1
[functional]
kind = "energy_release_rate"
crack = "c"
tip = "end"
)")
                .find("the faces of crack \"c\" have a gap"),
            std::string::npos);
}

}  // namespace
}  // namespace kerf::crack_gap_test
