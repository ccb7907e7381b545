// Elements that cannot be optimized: both loops refuse them in the words of the table of elements.

#include "kerf/element.hpp"
#include "tests/optimize/designs.hpp"

#include <gtest/gtest.h>

namespace kerf::elements_test {
namespace {

std::string refused(const Problem& p, const OptimizeRequest& r) {
  try {
    const auto go_on = [](const Iterate&) { return false; };
    if (r.method == OptimizeMethod::LevelSet)
      optimize_level_set(p, r, go_on, {});
    else
      optimize_parameters(p, r, go_on, {});
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, Fault::Usage);
    return e.what();
  }
  return "";
}

TEST(ElementsOfOptimization, BothLoopsRefuseTheSameInTheSameWords) {
  Problem p = scenes::everything();
  OptimizeRequest level_set{.method = OptimizeMethod::LevelSet, .volume_at_most = 0.9},
      drawn{.method = OptimizeMethod::Mma};
  drawn.design = scenes::everything_drawn();
  for (const Element& e : elements) {
    if (can_optimize(e)) continue;
    p.element = e;
    const std::string why = refusal(e, can_optimize).value();
    EXPECT_EQ(refused(p, level_set), why);
    EXPECT_EQ(refused(p, drawn), "method \"mma\" needs derivatives: " + why + "; or use method = \"cobyla\"");
  }
}

}  // namespace
}  // namespace kerf::elements_test
