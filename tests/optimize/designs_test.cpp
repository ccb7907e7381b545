// Designs for optimizers that are not kerf's: values are those of a body drawn and solved by itself, gradients those of
// the values, and what cannot be asked is said.

#include "optimize/designs.hpp"

#include "kerf/design.hpp"
#include "kerf/mesher.hpp"
#include "kerf/model.hpp"
#include "tests/optimize/designs.hpp"

#include <gtest/gtest.h>

namespace kerf::designs_test {
namespace {

using Eigen::VectorXd;

OptimizeRequest request() {
  OptimizeRequest r{.method = OptimizeMethod::Mma, .volume_at_most = 0.98};
  r.design = scenes::everything_drawn();
  r.bounds = {{"compliance", {"compliance", {compliance()}}, 40}};
  return r;
}

std::string refused(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, Fault::Usage);
    return e.what();
  }
  return "nothing";
}

TEST(DesignSpace, ValuesAreThoseOfTheBody) {
  const Problem p = scenes::everything();
  const OptimizeRequest r = request();
  DesignSpace designs(p, r);
  const VectorXd x = designs.start();
  ASSERT_EQ(static_cast<std::size_t>(x.size()), designs.names().size());
  EXPECT_EQ(designs.names().front(), "circle.x");
  const DesignValues v = designs.evaluate(x, true);
  ASSERT_EQ(v.failure, "");
  const DrawnBody body = body_of(r.design, x, p);
  const Model model = prepare(triangulate(body.shape, p.sizing), p.element, body.scene, 1);
  EXPECT_NEAR(v.value, work_of_loads(model, solve(model)), 1e-9 * v.value);
  EXPECT_EQ(v.value, v.objective);
  EXPECT_EQ(static_cast<std::size_t>(v.constraints.size()), designs.constraints().size());
  EXPECT_NEAR(v.constraints[0], v.volume_fraction / 0.98 - 1, 1e-14);
  EXPECT_NEAR(v.constraints[1], (v.bounds[0] - 40) / 40, 1e-14);
  EXPECT_EQ(v.jacobian.rows(), v.constraints.size());
  EXPECT_LT((v.jacobian.row(1).transpose() - v.gradient / 40).norm(), 1e-12 * v.gradient.norm());
}

TEST(DesignSpace, GradientsAreThoseOfTheValues) {
  DesignSpace designs(scenes::everything(), request());
  const VectorXd x = designs.start(), width = designs.upper() - designs.lower();
  const VectorXd g = designs.evaluate(x, true).gradient.cwiseProduct(width);
  constexpr double step = 2e-4;
  for (Eigen::Index i = 0; i < x.size(); i += 15) {
    const VectorXd d = step * width[i] * VectorXd::Unit(x.size(), i);
    const double slope = (designs.evaluate(x + d, false).value - designs.evaluate(x - d, false).value) / (2 * step);
    EXPECT_NEAR(g[i], slope, 2e-6 * g.cwiseAbs().maxCoeff()) << designs.names()[static_cast<std::size_t>(i)];
  }
}

TEST(DesignSpace, SaysWhatCannotBeAsked) {
  const Problem p = scenes::everything();
  OptimizeRequest r = request();
  DesignSpace designs(p, r);
  VectorXd x = designs.start();
  EXPECT_EQ(refused([&] { designs.evaluate(x.head(2), false); }), "a design has 30 numbers here, not 2");
  x[0] = -2;
  EXPECT_EQ(refused([&] { designs.evaluate(x, false); }), "circle.x = -2 lies outside of its bounds, -1.4 to -1");
  x[0] = nan;
  EXPECT_NE(refused([&] { designs.evaluate(x, false); }), "nothing");
  r.design.drawn[0].from_map = true;
  EXPECT_NE(refused([&] { DesignSpace(p, r); }).find("the start of hole 'circle' is read off a map"),
            std::string::npos);
  r.method = OptimizeMethod::LevelSet;
  EXPECT_NE(refused([&] { DesignSpace(p, r); }).find("a level set has no variables"), std::string::npos);
}

}  // namespace
}  // namespace kerf::designs_test
