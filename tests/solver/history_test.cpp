// Loads in steps with friction that remembers: the hysteresis of a sliding block and of a closed crack in closed form,
// steps in proportion, and where the work goes.

#include "solver/history.hpp"

#include "kerf/fracture.hpp"
#include "kerf/mesher.hpp"
#include "kerf/recover.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

namespace kerf::history_test {
namespace {

class History {
 public:
  History(Shape shape, const Sizing& sizing, const Element& e = bdms(1))
      : shape_(std::move(shape)), mesh_(triangulate(shape_, sizing)), element_(e) {}

  const State& step(Scene scene) {
    std::optional<Model> next;
    if (model_)
      next.emplace(continued(*model_, std::move(scene), state_));
    else
      next.emplace(prepare(mesh_, element_, std::move(scene), 1));
    State state = solve(*next);
    EXPECT_TRUE(certified(state));
    work += model_ ? work_between({*model_, state_}, {*next, state}) : work_from_rest({*next, state});
    dissipated +=
        model_ ? dissipation_between({*model_, state_}, {*next, state}) : dissipation_from_rest({*next, state});
    model_.emplace(std::move(*next));
    state_ = std::move(state);
    return state_;
  }
  const Model& model() const {
    return *model_;
  }
  const State& state() const {
    return state_;
  }
  double imbalance() const {
    return work - strain_energy(*model_, state_) - dissipated;
  }
  std::vector<CrackPoint> profile() const {
    return crack_profile(*model_, state_, 0);
  }

  double work = 0, dissipated = 0;

 private:
  Shape shape_;
  Mesh mesh_;
  Element element_;
  std::optional<Model> model_;
  State state_;
};

// Two halves of a square, pressed together by p and sheared by moving the top by d. With poisson = 0, p and the shear
// are uniform: a spring mu in series with a block that slides at f p.
constexpr double young = 1, mu = young / 2, pressure = 0.1, friction = 0.3, limit = friction * pressure;

struct Block {
  double friction = history_test::friction, slip_bound = 0;
  Scene at(double d) const {
    Scene s{.material = plane_strain(young, 0)};
    const auto squeezed = [](double x, const Vec2& at) { return Vec2(x, -pressure / young * at.y()); };
    s.supports = {{0, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }},
                  {1, false, false, true, [squeezed](const Vec2& x, const Vec2&) { return squeezed(0, x); }},
                  {2, false, true, true, [squeezed, d](const Vec2& x, const Vec2&) { return squeezed(d, x); }}};
    s.laws = {{.friction = friction, .slip_bound = slip_bound}};
    return s;
  }
  static Shape shape() {
    Shape shape{.outline = polygon("outline", {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 1),
                .labels = {"bottom", "side", "top"}};
    shape.outline.sides[0].label = 0;
    shape.outline.sides[2].label = 2;
    shape.cracks = {{"joint", {Vec2(0, 0.5), Vec2(1, 0.5)}}};
    return shape;
  }
};

// The spring and the block.
struct Slider {
  double slip = 0, dissipated = 0;
  double shear(double d) {
    const double trial = mu * (d - slip), tau = std::clamp(trial, -limit, limit), moved = (trial - tau) / mu;
    slip += moved;
    dissipated += limit * std::abs(moved);
    return tau;
  }
};

class SlidingBlock : public testing::TestWithParam<Block> {};

TEST_P(SlidingBlock, FollowsSpringAndSlider) {
  constexpr double far = 0.1;
  History h(Block::shape(), {.size = 0.3});
  Slider exact;
  for (const double d : {0.0, 0.05, far, 0.0, -far, far, 0.07, -0.02}) {
    h.step(GetParam().at(d));
    const double tau = exact.shear(d);
    for (const CrackPoint& p : h.profile()) {
      EXPECT_NEAR(std::abs(p.jump_t), std::abs(exact.slip), 1e-12) << d;
      EXPECT_NEAR(std::abs(p.sigma_t), std::abs(tau), 1e-12) << d;
      EXPECT_NEAR(p.contact_pressure(), pressure, 1e-12) << d;
    }
    EXPECT_NEAR(h.dissipated, exact.dissipated, 1e-12) << d;
  }
}

// The area of the hysteresis loop, per cycle, and the work of the supports around it. Steps that end where the block
// begins to slide have uniform slip rates within: no work is lost on the straight lines between them.
TEST_P(SlidingBlock, DissipatesTheAreaOfItsLoop) {
  constexpr double far = 0.1, sticks = limit / mu, loop = 4 * limit * (far - sticks);
  History h(Block::shape(), {.size = 0.3});
  for (const double d : {0.0, sticks, far}) h.step(GetParam().at(d));
  EXPECT_NEAR(h.imbalance(), 0, 1e-14);
  const double work = h.work, dissipated = h.dissipated;
  for (const double d : {far - 2 * sticks, -far, -far + 2 * sticks, far}) {
    h.step(GetParam().at(d));
    EXPECT_NEAR(h.imbalance(), 0, 1e-14) << d;
  }
  EXPECT_NEAR(h.dissipated - dissipated, loop, 1e-12 * loop);
  EXPECT_NEAR(h.work - work, loop, 1e-10 * loop);
}

// Where sliding begins at the share z of a step of length h the work on its straight line is short by mu z (1 - z)
// h^2/2.
TEST_P(SlidingBlock, ShorterStepsLoseLessWork) {
  constexpr double far = 0.1, sticks = limit / mu;
  for (const int parts : {4, 7, 21}) {
    History h(Block::shape(), {.size = 0.3});
    h.step(GetParam().at(0));
    for (int k = 1; k <= parts; ++k) h.step(GetParam().at(far * k / parts));
    const double step = far / parts, z = sticks / step - std::floor(sticks / step);
    EXPECT_NEAR(h.imbalance(), -0.5 * mu * z * (1 - z) * step * step, 1e-14) << parts;
    EXPECT_NEAR(h.dissipated, limit * (far - sticks), 1e-13);
  }
}

INSTANTIATE_TEST_SUITE_P(Laws, SlidingBlock, testing::Values(Block{}, Block{0, limit}, Block{0.1, 2 * limit / 3}));

/// A crack at 30 degrees in a plate, under the stress that makes it slip all along in part of the loads.
Shape plate(double size) {
  Shape s{.outline = polygon("outline", {{-size, -size}, {size, -size}, {size, size}, {-size, size}}, 0),
          .labels = {"outer"}};
  const Vec2 half(std::cos(pi / 6), 0.5);
  s.cracks = {{"c", {-half, half}}};
  return s;
}
Scene under(const Mat2& stress, const Mat2& slope = Mat2::Zero()) {
  Scene s{.material = plane_strain(1000, 0.3)};
  s.tractions = {{0, [=](const Vec2& x, const Vec2& n) { return Vec2((stress + x.x() * slope) * n); }}};
  s.laws = {{.friction = 0.3}};
  return s;
}

// Stick beside slip: loads in proportion, in steps and at once.
TEST(ProportionalSteps, AreOneStep) {
  Scene whole = under(Mat2::Zero());
  whole.supports = {{0, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }}};
  Shape shape = plate(2);
  shape.labels = {"outer", "top"};
  shape.outline.sides[2].label = 1;
  const auto loaded = [&](double share) {
    Scene s = whole;
    s.tractions = {{1, [share](const Vec2& x, const Vec2&) { return Vec2(share * (0.1 + 0.4 * x.x()), -share); }}};
    return s;
  };
  const Sizing sizing{.size = 0.3, .mirrored_tips = true};
  History once(shape, sizing), steps(shape, sizing);
  const State all = once.step(loaded(1));
  const SlipLengths lengths = slip_lengths(once.model(), all);
  EXPECT_GT(lengths.stick, 0.2);
  EXPECT_GT(lengths.slip, 0.2);
  for (const double share : {0.2, 0.5, 0.55, 0.9}) steps.step(loaded(share));
  const State last = steps.step(loaded(1));
  EXPECT_LT((last.skeleton - all.skeleton).cwiseAbs().maxCoeff(), 1e-10 * all.skeleton.cwiseAbs().maxCoeff());
  EXPECT_LT((last.interior - all.interior).cwiseAbs().maxCoeff(), 1e-10 * all.interior.cwiseAbs().maxCoeff());
  EXPECT_NEAR(steps.imbalance(), 0, 1e-10 * steps.work);
  EXPECT_NEAR(once.imbalance(), 0, 1e-10 * once.work);
  EXPECT_NEAR(steps.dissipated, once.dissipated, 1e-10 * once.work);
}

// Partial slip under a constant limit: what unloading by F changes is twice what loading by F/2 does, as its limit is
// twice that of loading (the rule of Masing). Of any body, on any mesh; a cycle closes.
TEST(PartialSlip, FollowsMasingsRule) {
  Shape shape = plate(1);
  shape.cracks[0].points = {{-0.5, 0}, {0.5, 0}};
  // In balance by itself, without pressure on the crack: it stays closed under the other one.
  const auto loaded = [](double load) {
    Scene s{.material = plane_strain(1, 0.3)};
    s.tractions = {{0, [load](const Vec2& x, const Vec2& n) {
                      const double shear = load * (0.2 + 0.3 * x.x()), beside = load * -0.3 * x.y();
                      return Vec2(shear * n.y(), shear * n.x() + (beside - 1) * n.y());
                    }}};
    s.laws = {{.slip_bound = 0.25}};
    return s;
  };
  const Sizing sizing{.size = 0.15};
  struct Faces {
    Eigen::VectorXd slip, shear;
  };
  const auto faces = [](const History& h) {
    const std::vector<CrackPoint> profile = h.profile();
    Faces f{Eigen::VectorXd(profile.size()), Eigen::VectorXd(profile.size())};
    for (std::size_t i = 0; i < profile.size(); ++i) {
      f.slip[static_cast<Eigen::Index>(i)] = profile[i].jump_t;
      f.shear[static_cast<Eigen::Index>(i)] = profile[i].sigma_t;
    }
    return f;
  };
  const auto once = [&](double load) {
    History h(shape, sizing);
    h.step(loaded(load));
    return faces(h);
  };
  History h(shape, sizing);
  h.step(loaded(1));
  const Faces most = faces(h);
  const double size = most.slip.cwiseAbs().maxCoeff();
  ASSERT_GT(size, 0);
  ASSERT_GT((most.slip.array() == 0).count(), 10);
  for (const double load : {0.5, 0.0, -1.0}) {
    h.step(loaded(load));
    const Faces now = faces(h), half = once(0.5 * (1 - load));
    EXPECT_LT((now.slip - (most.slip - 2 * half.slip)).cwiseAbs().maxCoeff(), 1e-10 * size) << load;
    EXPECT_LT((now.shear - (most.shear - 2 * half.shear)).cwiseAbs().maxCoeff(), 1e-10) << load;
  }
  EXPECT_GT(slip_lengths(h.model(), h.state()).slip, 0.1);
  const double before = h.dissipated;
  for (const double load : {0.3, 1.0}) h.step(loaded(load));
  EXPECT_LT((faces(h).slip - most.slip).cwiseAbs().maxCoeff(), 1e-10 * size);
  EXPECT_GT(h.dissipated, before);
}

// Without loads nothing presses the faces: no friction, no stress, no slip.
// Nothing slides: the body is linear, and all work is stored. Some traces of a body without supports are held to solve
// it, and the loads act there as elsewhere.
TEST(Work, OfABodyThatNothingHoldsIsStored) {
  const Shape shape{.outline = polygon("outline", {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, 0),
                    .cracks = {{"c", {{-0.6, 0}, {0.6, 0}}}},
                    .labels = {"outer"}};
  for (const Element& e : {bdms(1), afw(2)}) {
    History h(shape, {.size = 0.4}, e);
    const auto at = [](double pressure, double shear) {
      Scene s{.material = plane_strain(1, 0.3)};
      s.tractions = {
          {0, [=](const Vec2&, const Vec2& n) { return Vec2(shear * n.y(), shear * n.x() - pressure * n.y()); }}};
      s.laws = {{.friction = 10}};
      return s;
    };
    for (const auto& [pressure, shear] : {std::pair(1.0, 0.0), std::pair(1.0, 0.3), std::pair(1.0, -0.2)}) {
      h.step(at(pressure, shear));
      EXPECT_NEAR(h.work, strain_energy(h.model(), h.state()), 1e-12) << shear;
    }
    EXPECT_EQ(h.dissipated, 0);
  }
}

TEST(Release, LeavesNothing) {
  const auto loaded = [](double load) {
    Scene s{.material = plane_strain(1, 0.3)};
    s.supports = {{0, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }}};
    s.tractions = {{1, [load](const Vec2& x, const Vec2&) { return Vec2(load * (0.1 + 0.3 * x.x()), -load); }}};
    s.laws = {{.friction = 0.2}};
    return s;
  };
  Shape shape = plate(2);
  shape.labels = {"outer", "top"};
  shape.outline.sides[0].label = 0;
  shape.outline.sides[2].label = 1;
  shape.labels.push_back("free");
  shape.outline.sides[1].label = shape.outline.sides[3].label = 2;
  History h(shape, {.size = 0.4, .mirrored_tips = true});
  const double size = h.step(loaded(1)).skeleton.cwiseAbs().maxCoeff();
  h.step(loaded(0.3));
  EXPECT_GT(h.profile()[h.profile().size() / 2].jump_t * h.profile()[h.profile().size() / 2].jump_t, 0);
  EXPECT_LT(h.step(loaded(0)).skeleton.cwiseAbs().maxCoeff(), 1e-11 * size);
}

// Uniform tractions on a crack in an infinite plate: pressure p, shear q. It slides at f p; unloaded in proportion, it
// sticks down to (q - f p)/(q + f p), keeping K_II, and slides back from there. A plate 16 cracks wide is 0.4 %
// stiffer.
TEST(ClosedCrack, KeepsItsSlipUntilItSlidesBack) {
  const double p = 0.75, q = std::sqrt(3) / 4, f = 0.3, back = (q - f * p) / (q + f * p), root = std::sqrt(pi);
  const Mat2 stress = (Mat2() << 0, 0, 0, -1).finished();
  History h(plate(16), {.size = 2.5, .crack_tip_size = 0.01, .mirrored_tips = true}, bdms(2));
  const auto K = [&](double share) {
    const State& s = h.step(under(share * stress));
    return std::abs(crack_tips(h.model(), s)[0].K_II);
  };
  EXPECT_NEAR(K(1), (q - f * p) * root, 0.01 * root * q);
  EXPECT_NEAR(K(0.5 * (1 + back)), (q - f * p) * root, 0.01 * root * q);
  const double slid = h.profile()[h.profile().size() / 2].jump_t;
  EXPECT_NEAR(K(1.02 * back), (q - f * p) * root, 0.01 * root * q);
  EXPECT_NEAR(h.profile()[h.profile().size() / 2].jump_t, slid, 1e-10 * std::abs(slid));
  for (const double share : {0.9 * back, 0.5 * back, 0.1 * back})
    EXPECT_NEAR(K(share), share * (q + f * p) * root, 0.01 * root * q) << share;
}

}  // namespace
}  // namespace kerf::history_test
