// What is wrong with an optimization before anything is meshed: each thing alone, its key and its words.

#include "optimize/refuse.hpp"
#include "geometry/carve.hpp"
#include "optimize/level_set/starts.hpp"
#include "tests/optimize/designs.hpp"

#include <gtest/gtest.h>

namespace kerf::refuse_test {
namespace {

using namespace scenes;

OptimizeRequest level_set() {
  OptimizeRequest r;
  r.volume_at_most = 0.8;
  return r;
}
OptimizeRequest by_variables(OptimizeMethod method = OptimizeMethod::Mma) {
  OptimizeRequest r = level_set();
  r.method = method;
  r.volume_at_most = 0.95;
  r.design = everything_drawn();
  return r;
}
Problem good() {
  Problem p = everything();
  p.element = element("bdms");
  return p;
}

std::string lines(const std::vector<Wrong>& all) {
  std::string out;
  for (const Wrong& w : all) out += w.key + ": " + w.what + '\n';
  return out;
}

/// One thing is wrong; it is `words`, at `key`.
void expect_wrong(const Problem& p, const OptimizeRequest& r, const std::string& key, const std::string& words) {
  const std::vector<Wrong> all = find_wrong(p, r);
  ASSERT_EQ(all.size(), 1u) << words << '\n' << lines(all);
  EXPECT_EQ(all[0].key, key) << all[0].what;
  EXPECT_NE(all[0].what.find(words), std::string::npos) << all[0].what;
  EXPECT_THROW(refuse_wrong(p, r), Error);
}

/// (0, value), and known to be; or known to lie between two numbers.
class Constant final : public Enclosure {
 public:
  explicit Constant(double value) : Constant(value, value) {}
  Constant(double least, double most) : value_{Interval{0, 0}, Interval{least, most}} {}
  OnPiece along(const EdgeLine&, double, double) const override {
    return {.value = value_, .eighth = {0, 0}};
  }
  std::array<Interval, 2> over(const Interval&, const Interval&) const override {
    return value_;
  }
  int degree() const override {
    return 0;
  }

 private:
  std::array<Interval, 2> value_;
};

TEST(Refuse, NothingOfWhatIsGood) {
  EXPECT_EQ(lines(find_wrong(good(), level_set())), "");
  EXPECT_EQ(lines(find_wrong(good(), by_variables())), "");
  EXPECT_NO_THROW(refuse_wrong(good(), level_set()));
}

TEST(Refuse, Counts) {
  OptimizeRequest r = level_set();
  r.max_iterations = 0;
  expect_wrong(good(), r, "optimize.max_iterations", "max_iterations in [optimize] must be at least 1");
  r = level_set();
  r.starts = -1;
  expect_wrong(good(), r, "optimize.starts", "starts in [optimize] must be at least 1");
}

TEST(Refuse, BodiesWhoseDerivativesAreNotKnown) {
  Problem gap = good();
  gap.scene.laws[0].gap = [](const Vec2&, const Vec2&) { return Vec2(0.01, 0); };
  EXPECT_EQ(lines(find_wrong(gap, level_set())), "");
  Problem warm = good();
  warm.scene.eigenstrain = {
      {.normal = [](const Vec2&) { return Vec2(1e-3, 0); }, .shear = [](const Vec2&) { return Vec2(0, 0); }}};
  expect_wrong(warm, level_set(), "material.eigenstrain", "does not know what an eigenstrain does");
  warm.frame.regions = {circle("r", {-1, -1}, 0.2, none)};
  warm.scene.regions = {plane_strain(2, 0.3)};
  warm.scene.eigenstrain.insert(warm.scene.eigenstrain.begin(), Eigenstrain{});
  expect_wrong(warm, level_set(), "region[0].eigenstrain", "does not know what an eigenstrain does");
  Problem wood = good();
  wood.scene.material = orthotropic({.young = {1, 5}, .poisson = 0.1, .shear = 0.3});
  expect_wrong(wood, level_set(), "material.young", "the body is orthotropic");
  wood = good();
  wood.frame.regions = {circle("r", {-1, -1}, 0.2, none)};
  wood.scene.regions = {orthotropic({.young = {1, 5}, .poisson = 0.1, .shear = 0.3})};
  expect_wrong(wood, level_set(), "region", "a region is orthotropic");
}

TEST(Refuse, CracksWithPressureOrFriction) {
  Problem pressed = good();
  pressed.scene.laws[0].pressure = [](const Vec2&, const Vec2&) { return Vec2(1, 0); };
  expect_wrong(pressed, level_set(), "crack[0].pressure", "a level set would cut it away");
  EXPECT_EQ(lines(find_wrong(pressed, by_variables())), "");
  Problem rough = good();
  rough.scene.laws[0].friction = 0.3;
  EXPECT_EQ(lines(find_wrong(rough, level_set())), "");
  EXPECT_EQ(lines(find_wrong(rough, by_variables())), "");
  // Neither of the two states of a misfit minimizes an energy then.
  rough.objective = {"misfit", {misfit(1, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); })}};
  expect_wrong(rough, by_variables(), "crack[0].friction", "the derivative of a misfit needs cracks without");
  EXPECT_EQ(lines(find_wrong(rough, by_variables(OptimizeMethod::Cobyla))), "");
  rough.scene.laws[0] = {.slip_bound = 0.1};
  expect_wrong(rough, by_variables(OptimizeMethod::Slsqp), "crack[0].tresca", "or track the displacements");
  OptimizeRequest drawn_rough = by_variables();
  drawn_rough.design.drawn[3].law.friction = 0.3;
  EXPECT_EQ(lines(find_wrong(good(), drawn_rough)), "");
  // Where a map is asked where to begin, whatever the functional.
  rough = good();
  rough.scene.laws[0].friction = 0.3;
  drawn_rough.design.drawn[0].from_map = true;
  expect_wrong(rough, drawn_rough, "crack[0].friction",
               "what begins where a map finds it needs cracks without; remove friction and tresca, or say where");
  drawn_rough.design.drawn[0].from_map = false;
  drawn_rough.design.drawn[3].law.gap = [](const Vec2&, const Vec2&) { return Vec2(0.01, 0); };
  expect_wrong(good(), drawn_rough, "optimize.crack[0]",
               "crack 'crack' has a gap, and method = \"mma\" needs derivatives");
}

TEST(Refuse, LoadsAndSupports) {
  Problem idle = good();
  idle.scene.tractions.clear();
  idle.scene.body = {};
  const BoundaryField nowhere([](const Vec2&, const Vec2&) { return Vec2(0, 0); }, std::make_shared<Constant>(0));
  EXPECT_EQ(lines(find_wrong(idle, level_set())), "");  // the support may move: nothing is known of it
  idle.scene.supports[0].value = nowhere;
  expect_wrong(idle, level_set(), "optimize", "nothing acts on the body");
  // A load that is known to be zero acts as little, on straight sides and on a round one.
  Problem zero = good();
  zero.scene.body = {};
  zero.scene.supports[0].value = nowhere;
  zero.frame.labels.push_back("hole");
  zero.frame.holes = {circle("h", {-1, 0.5}, 0.2, 4)};
  for (const double value : {0., 1.}) {
    const BoundaryField known([value](const Vec2&, const Vec2&) { return Vec2(0, value); },
                              std::make_shared<Constant>(value));
    zero.scene.tractions = {{2, known}, {4, known}};
    if (value == 0) {
      expect_wrong(zero, level_set(), "boundary", "nothing acts on the body");
    } else {
      EXPECT_EQ(lines(find_wrong(zero, level_set())), "");
    }
  }
  // What lies between 0 and 1 need not vanish.
  const BoundaryField unknown([](const Vec2&, const Vec2&) { return Vec2(0, 0); }, std::make_shared<Constant>(0, 1));
  zero.scene.tractions = {{2, unknown}};
  EXPECT_EQ(lines(find_wrong(zero, level_set())), "");
  Problem floating = good();
  floating.scene.supports.clear();
  floating.objective = {"volume", {volume()}};
  OptimizeRequest r = level_set();
  FunctionalBound b;
  b.functional = {"displacement", {displacement_tracking({}, {})}};
  b.at_most = 1;
  r.bounds = {b};
  const std::vector<Wrong> all = find_wrong(floating, r);
  EXPECT_NE(lines(all).find("optimize.bound[0]: [[optimize.bound]]: \"displacement_tracking\" sees rigid motions"),
            std::string::npos)
      << lines(all);
}

TEST(Refuse, LevelSets) {
  OptimizeRequest r = level_set();
  r.level_set.ersatz = 1e-3;
  expect_wrong(good(), r, "optimize.ersatz", "a weak phase is moved by the fixed point only");
  Problem region = good();
  region.frame.regions = {circle("r", {-1, -1}, 0.2, none)};
  region.scene.regions = {plane_strain(2, 0.3)};
  r.level_set.move = LevelSetRequest::Move::FixedPoint;
  expect_wrong(region, r, "optimize.ersatz", "does not go with [[region]]");
  for (const double share : {0., -1., 0.6}) {
    r = level_set();
    r.level_set.nucleate_fraction = share;
    expect_wrong(good(), r, "optimize.nucleate.fraction", "it must be positive and not larger than 0.5");
  }
  r = level_set();
  r.level_set.smoothing = 6;
  expect_wrong(good(), r, "optimize.smoothing", "must be smaller than the body, whose diagonal is 5.65685");
  r = level_set();
  r.level_set.min_feature = 5;
  expect_wrong(good(), r, "optimize.min_feature", "no design has such members; use less");
  r = level_set();
  r.level_set.mirror = Mirror{};
  Problem aside = good();
  aside.frame = rectangle({0, 0}, {2, 1});
  aside.frame.outline.sides[1].start = {2.5, 0};
  aside.scene.laws.clear();
  EXPECT_NE(lines(find_wrong(aside, r)).find("optimize.symmetry: symmetry in [optimize]: "), std::string::npos)
      << lines(find_wrong(aside, r));
  r = level_set();
  r.level_set.frozen = {circle("mask", {9, 9}, 0.5, none)};
  EXPECT_NE(lines(find_wrong(good(), r)).find("optimize.frozen[0]: entry 1 of frozen in [optimize]: "),
            std::string::npos)
      << lines(find_wrong(good(), r));
  // Every side is loaded or held, and no hole may appear.
  r = level_set();
  r.level_set.nucleate_every = 0;
  Problem all = good();
  for (const Index label : {0, 1, 3}) all.scene.tractions.push_back({label, all.scene.tractions[0].value});
  expect_wrong(all, r, "optimize.nucleate", "no side of the body is free of loads");
  // What is looked at stays, too; the fixed point makes holes everywhere.
  all.scene.tractions.pop_back();
  EXPECT_EQ(lines(find_wrong(all, r)), "");
  all.objective.terms.push_back(boundary_tracking(3, [](const Vec2&, const Vec2&) { return Vec2(0, 0); }, {}));
  expect_wrong(all, r, "optimize.nucleate", "no side of the body is free of loads");
  r.level_set.move = LevelSetRequest::Move::FixedPoint;
  EXPECT_EQ(lines(find_wrong(all, r)), "");
}

TEST(Refuse, StartsThatLeaveNoBody) {
  const auto with = [](int columns, double radius) {
    OptimizeRequest r = level_set();
    r.level_set.start = StartHoles{.columns = columns, .rows = 1, .radius = radius};
    return r;
  };
  expect_wrong(good(), with(1, 4), "optimize.start", "the holes leave no body to begin with");
  // Holes in the middle and along bottom and top: in eight columns they take all of the bottom, in nine its corners
  // stay, but what hangs on them is cut off at half height.
  expect_wrong(good(), with(8, 0.8), "optimize.start", "the holes take away all that the supports hold");
  expect_wrong(good(), with(9, 0.5), "optimize.start", "the holes cut the loads off from the supports");
  EXPECT_EQ(lines(find_wrong(good(), with(9, 0.3))), "");
  // A mesh without a size is one of a fortieth of the body: what stays beside loads holds the plate together.
  Problem by_itself = good();
  by_itself.sizing.size = 0;
  EXPECT_EQ(lines(find_wrong(by_itself, with(9, 0.3))), "");
  expect_wrong(by_itself, with(9, 0.5), "optimize.start", "the holes cut the loads off from the supports");
  Problem floating = good();  // nothing has to hang on supports
  floating.scene.supports.clear();
  floating.objective = {"energy", {energy()}};
  EXPECT_EQ(lines(find_wrong(floating, with(9, 0.5))), "");
  // What is frozen stays between.
  OptimizeRequest held = with(9, 0.5);
  held.level_set.frozen = {polygon("post", {{-0.3, -1.9}, {0.3, -1.9}, {0.3, 1.9}, {-0.3, 1.9}}, none)};
  EXPECT_EQ(lines(find_wrong(good(), held)), "");
}

TEST(Refuse, MoreFrozenThanAllowed) {
  OptimizeRequest r = level_set();
  r.level_set.frozen = {polygon("lower", {{-3, -3}, {3, -3}, {3, 0.5}, {-3, 0.5}}, none)};
  r.volume_at_most = 0.5;
  expect_wrong(good(), r, "optimize.volume.at_most", "less than the share of the body that is frozen, at least 0.6");
  r.volume_at_most = 0.65;
  EXPECT_EQ(lines(find_wrong(good(), r)), "");
  r.level_set.frozen.push_back(polygon("upper", {{-3, 0.3}, {3, 0.3}, {3, 3}, {-3, 3}}, none));
  expect_wrong(good(), r, "optimize.frozen", "the regions together cover the whole body");
  // Of a body that is not all of its box what lies in it counts: 7 of 12.
  Problem bent = good();
  bent.frame.cracks.clear();
  bent.scene.laws.clear();
  bent.frame.outline = polygon("outline", {{-2, -2}, {2, -2}, {2, 0}, {0, 0}, {0, 2}, {-2, 2}}, 2);
  bent.frame.outline.sides[0].label = 0;
  r.level_set.frozen = {polygon("most", {{-3, -3}, {3, -3}, {3, -0.25}, {-3, -0.25}}, none)};
  r.volume_at_most = 0.56;
  expect_wrong(bent, r, "optimize.volume.at_most", "less than the share of the body that is frozen, at least 0.568");
  r.volume_at_most = 7.0 / 12 + 1e-3;
  EXPECT_EQ(lines(find_wrong(bent, r)), "");
}

TEST(Refuse, VolumesThatDecideNothing) {
  const auto why = [](const Functional& j, const std::function<void(OptimizeRequest&)>& change) {
    OptimizeRequest r;
    change(r);
    return wrong_volume(j, r).value_or("");
  };
  const Functional stiff{"compliance", {compliance()}}, light{"volume", {volume()}};
  const auto nothing = [](OptimizeRequest&) {};
  EXPECT_EQ(why(stiff, [](OptimizeRequest& r) { r.volume_at_most = 0.5; }), "");
  EXPECT_EQ(why(stiff, [](OptimizeRequest& r) { r.volume_penalty = 1; }), "");
  EXPECT_EQ(why(stiff, [](OptimizeRequest& r) { r.method = OptimizeMethod::Mma; }), "");
  EXPECT_NE(
      why(stiff, [](OptimizeRequest& r) { r.volume_at_most = 1; }).find("volume.at_most = 1 leaves the full body"),
      std::string::npos);
  EXPECT_NE(why(stiff, nothing).find("without volume = { at_most = ... } or { penalty = ... } the full body"),
            std::string::npos);
  EXPECT_NE(why(light, nothing).find("the least volume is no body at all"), std::string::npos);
  EXPECT_EQ(why(light, [](OptimizeRequest& r) { r.bounds.resize(1); }), "");
  const Functional weak{"sum", {compliance(), volume()}, true};
  EXPECT_EQ(why(weak, nothing), "");
  Functional harmful = weak;
  harmful.terms[1].factor = -1;
  EXPECT_NE(why(harmful, nothing).find("a level set needs something that says how much material"), std::string::npos);
  Functional soft = stiff;
  soft.terms[0].factor = -1;
  EXPECT_NE(why(soft, nothing).find("a level set needs something that says how much material"), std::string::npos);
  EXPECT_EQ(why(soft, [](OptimizeRequest& r) { r.volume_at_most = 1; }), "");
}

TEST(Refuse, LoadCasesOfFunctionalsThatKnowOne) {
  OptimizeRequest r;
  const Functional gap{"misfit", {misfit(1, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); })}},
      tip{"G", {energy_release_rate({0, 0}, {1, 0}, {0.1, 0.2}, {})}}, stiff{"compliance", {compliance()}};
  EXPECT_FALSE(wrong_load_cases(gap, r));
  r.load_cases = {{"a", 1, {}, {}}, {"b", 1, {}, {}}};
  EXPECT_FALSE(wrong_load_cases(stiff, r));
  EXPECT_FALSE(wrong_load_cases(tip, r));
  EXPECT_NE(wrong_load_cases(gap, r).value_or("").find("a misfit belongs to one set of loads"), std::string::npos);
  r.load_cases[1].body = [](const Vec2&) { return Vec2(0, -1); };
  EXPECT_NE(wrong_load_cases(tip, r).value_or("").find("takes no body forces of load cases"), std::string::npos);
  r.bounds.resize(1);
  r.bounds[0].functional = tip;
  EXPECT_NE(wrong_load_cases(stiff, r).value_or("").find("takes no body forces of load cases"), std::string::npos);
  r.bounds[0].functional = stiff;
  EXPECT_FALSE(wrong_load_cases(stiff, r));
}

/// Mirrors and masks against the body as drawn.
TEST(Refuse, MirrorsAndMasks) {
  Shape body = rectangle({-1, -1}, {1, 1});
  const Mirror upright{{0, 0}, {0, 1}};
  EXPECT_FALSE(wrong_mirror(body, upright));
  EXPECT_EQ(wrong_mirror(body, {{0, 0}, {0, 2}}), "the direction of the mirror line must have length 1");
  body.cracks = {arc_crack("c", {0, 0}, 0.5, 0.2, pi - 0.2)};
  EXPECT_FALSE(wrong_mirror(body, upright));
  EXPECT_TRUE(wrong_mirror(body, {{0, 0}, {1, 0}}));
  body.cracks = {{"c", {Vec2(-0.5, 0.3), Vec2(0, 0.1), Vec2(0.5, 0.3)}, {}}};
  EXPECT_FALSE(wrong_mirror(body, upright));
  body.cracks[0].points.pop_back();
  EXPECT_TRUE(wrong_mirror(body, upright));
  body.cracks.clear();
  body.holes = {circle("h", {0.5, 0}, 0.2, 0)};
  EXPECT_TRUE(wrong_mirror(body, upright));
  body.regions = {circle("r", {0, -0.5}, 0.1, none)};
  EXPECT_FALSE(wrong_mirror(rectangle({-1, -1}, {1, 1}), upright));
  body = rectangle({-1, -1}, {1, 1});
  EXPECT_FALSE(wrong_mask(body, circle("m", {0.9, 0}, 0.3, none)));  // it may leave the body
  EXPECT_FALSE(wrong_mask(body, circle("m", {0, 0}, 0.3, none)));
  EXPECT_EQ(wrong_mask(body, circle("m", {5, 0}, 0.3, none)),
            "region \"m\" lies outside the body: there is nothing to freeze");
  EXPECT_EQ(wrong_mask(body, circle("m", {0, 0}, 3, none)),
            "region \"m\" covers the whole body: nothing is left to design");
  const std::string torn = wrong_mask(body, polygon("m", {{0, 0}, {0.5, 0.5}, {0.5, 0}, {0, 0.5}}, none)).value_or("");
  EXPECT_EQ(torn.rfind("region \"m\": its border", 0), 0u) << torn;
}

TEST(Refuse, DesignsThatCannotMove) {
  OptimizeRequest fixed = by_variables();
  for (Drawn& d : fixed.design.drawn) d.lower = d.upper = d.start;
  expect_wrong(good(), fixed, "optimize", "every variable of the design is fixed");
  OptimizeRequest nothing = by_variables();
  nothing.design.drawn.clear();
  EXPECT_EQ(find_wrong(good(), nothing).size(), 1u);
}

TEST(Refuse, BoxesOutsideTheBody) {
  const OptimizeRequest good_one = by_variables();
  const std::array<std::pair<std::size_t, const char*>, 5> all{{{0, "optimize.hole[0].circle.center"},
                                                                {1, "optimize.hole[1].ellipse.center"},
                                                                {2, "optimize.hole[2].spline.points"},
                                                                {3, "optimize.crack[0].path"},
                                                                {4, "optimize.region[0].circle.center"}}};
  for (const auto& [k, key] : all) {
    OptimizeRequest r = good_one;
    Drawn& d = r.design.drawn[k];
    const bool points = d.kind == Drawn::Kind::Spline || d.kind == Drawn::Kind::Crack;
    for (Eigen::Index i = 0; i < (points ? d.start.size() : 2); ++i)
      for (auto* v : {&d.lower, &d.upper, &d.start}) (*v)[i] += 9;
    const std::vector<Wrong> wrong = find_wrong(good(), r);
    ASSERT_EQ(wrong.size(), 1u) << lines(wrong);
    EXPECT_EQ(wrong[0].key, key) << wrong[0].what;
  }
}

TEST(Refuse, LessVolumeThanTheBoxesAllow) {
  OptimizeRequest r = by_variables();
  r.volume_at_most = 0.3;
  expect_wrong(good(), r, "optimize.volume.at_most", "the largest holes that the boxes allow leave");
  r = by_variables();
  r.volume_at_most.reset();
  FunctionalBound area;
  area.functional = {"volume", {volume()}};
  area.at_most = 5;  // of 16
  r.bounds = {area};
  expect_wrong(good(), r, "optimize.bound[0].at_most", "the largest holes that the boxes allow leave an area of");
  r.bounds[0].at_most = 15.5;
  EXPECT_EQ(lines(find_wrong(good(), r)), "");
  r.bounds[0].functional.terms[0].factor = -1;  // at least so much
  r.bounds[0].at_most = -1;
  EXPECT_EQ(lines(find_wrong(good(), r)), "");
}

TEST(Refuse, TipsThatLeaveTheirRing) {
  OptimizeRequest r = by_variables();
  Problem p = good();
  p.objective = {"G", {energy_release_rate({0.9, 0.1}, {-1, 0.3}, {0.02, 0.05}, p.scene.body)}};
  const std::string said = lines(find_wrong(p, r));
  EXPECT_NE(said.find("optimize.crack[0].path: crack 'crack' moves with the design, and the ring of"),
            std::string::npos)
      << said;
  Drawn& crack = r.design.drawn[3];
  crack.lower.head<2>() = crack.upper.head<2>() = crack.start.head<2>();
  EXPECT_EQ(lines(find_wrong(p, r)).find("moves with the design, and the ring of"), std::string::npos);
}

TEST(Refuse, WhatHasNoVariables) {
  OptimizeRequest r = by_variables(OptimizeMethod::Cobyla);
  r.design.drawn[4].poisson = 0.5;  // for which the element has to be made
  Problem p = good();
  p.element = element("p1");
  EXPECT_NE(lines(find_wrong(p, r)).find("[[optimize.region]]: "), std::string::npos) << lines(find_wrong(p, r));
  p.element = element("p2");  // can do both, but not what is incompressible
  r.design.drawn[3].law.kind = CrackLaw::Kind::Open;
  const std::string strain = lines(find_wrong(p, r));
  EXPECT_NE(strain.find("cannot do an incompressible material"), std::string::npos) << strain;
  p.plane_strain = false;
  p.scene.material = plane_stress(1, 0.3);
  const std::string stress = lines(find_wrong(p, r));
  EXPECT_EQ(stress.find("cannot do an incompressible material"), std::string::npos) << stress;
  r.method = OptimizeMethod::LevelSet;
  EXPECT_FALSE(wrong_design(r));
}

/// Where things overlap whatever they do no start can be drawn.
TEST(Refuse, StartsThatNothingMends) {
  OptimizeRequest r = by_variables();
  r.design.drawn = {drawn(Drawn::Kind::Circle, "a", Eigen::Vector3d(0.5, 0.8, 0.4), 0.01),
                    drawn(Drawn::Kind::Circle, "b", Eigen::Vector3d(0.7, 0.8, 0.4), 0.01)};
  expect_wrong(good(), r, "optimize", "the design cannot be drawn where it starts, and nowhere near");
}

TEST(Refuse, BodiesAndLoadsOfOtherKinds) {
  Problem curved = good();
  curved.sizing.curved = true;
  expect_wrong(curved, level_set(), "mesh.curved", "an optimization moves straight edges");
  Problem torn = good();
  torn.frame.outline = polygon("outline", {{-2, -2}, {2, 2}, {2, -2}, {-2, 2}}, 0);
  EXPECT_EQ(lines(find_wrong(torn, level_set())), "");  // said by whoever draws it
  EXPECT_EQ(lines(find_wrong(torn, by_variables())), "");
  try {
    refuse_wrong(torn, level_set());
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, Fault::Geometry) << e.what();
  }
  // A load case without a load, by its name.
  Problem idle = good();
  idle.scene.body = {};
  idle.scene.supports[0].value =
      BoundaryField([](const Vec2&, const Vec2&) { return Vec2(0, 0); }, std::make_shared<Constant>(0));
  OptimizeRequest r = level_set();
  r.load_cases = {{"full", 1, idle.scene.tractions, {}}, {"empty", 1, {}, {}}};
  idle.scene.tractions.clear();
  expect_wrong(idle, r, "load_case[1]", "[[load_case]] \"empty\": nothing acts on the body");
  Problem measured = good();
  measured.objective = {"misfit", {misfit(2, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); })}};
  r = level_set();
  r.load_cases = {{"a", 1, {}, {}}};
  const std::string said = lines(find_wrong(measured, r));
  EXPECT_NE(said.find("load_case[0]: [[load_case]]: a misfit belongs to one set of loads"), std::string::npos) << said;
}

/// A given design becomes a function that is negative in it: its area is that of the design.
TEST(GivenStart, IsTheDesign) {
  Problem p = good();
  p.frame.cracks.clear();
  p.scene.laws.clear();
  p.sizing.size = 0.2;
  OptimizeRequest r = level_set();
  r.volume_at_most = 0.9;
  Shape design = p.frame;
  design.holes = {circle("h", {0.3, 0.1}, 0.8, none)};
  r.level_set.start_design = design;
  const Ground g = make_ground(p, r);
  const LevelSetStart start = given_start(g);
  EXPECT_EQ(start.name, "the design given");
  EXPECT_FALSE(start.explore);
  EXPECT_NEAR(negative_area(g.background.mesh, start.phi), 16 - pi * 0.64, 0.02);
  for (std::size_t v = 0; v < g.background.mesh.points.size(); ++v) {
    const Vec2& x = g.background.mesh.points[v];
    const double to_hole = 0.8 - (x - Vec2(0.3, 0.1)).norm(), to_side = 2 - x.cwiseAbs().maxCoeff();
    if (to_hole > 0) {  // in the hole: positive, and its distance to the rim
      EXPECT_NEAR(start.phi[Eigen::Index(v)], to_hole, 0.01);
    } else if (to_side > 0.01) {
      EXPECT_NEAR(start.phi[Eigen::Index(v)], -std::max(std::min(-to_hole, to_side), 2e-4), 0.01);
    }
  }
  r.level_set.start_design.reset();
  EXPECT_EQ(given_start(make_ground(p, r)).name, "the full body");
  r.level_set.start = StartHoles{.columns = 3, .rows = 3, .radius = 0.2};
  EXPECT_EQ(given_start(make_ground(p, r)).name, "the holes given");
}

}  // namespace
}  // namespace kerf::refuse_test
