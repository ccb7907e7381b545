// Sections [optimize], [[load_case]] and [synthetic] against the requests they stand for; mistakes against the whole
// message, with line and column; what the fingerprint depends on.

#include "kerf/max_stress.hpp"
#include "tests/io/case/case_files.hpp"

namespace kerf::optimize_test {
namespace {

// Lines 7 to 14 after the square: supported on the left, pulled on the right, as stiff as can be.
const std::string plate = square + R"([[boundary]]
on = "left"
displacement = [0, 0]
[functional]
kind = "compliance"
)";
const std::string pull = R"([[boundary]]
on = "right"
traction = [1, 0]
)";

TEST(Optimize, IsAbsentUnlessAskedFor) {
  const Case c = read(plate + pull);
  EXPECT_FALSE(c.optimize);
  EXPECT_FALSE(c.synthetic);
  EXPECT_EQ(c.fingerprint, "");
}

TEST(Optimize, DefaultsOfTheLevelSet) {
  const Case c = read(plate + pull + "[optimize]\nvolume = { at_most = 0.4 }\n");
  ASSERT_TRUE(c.optimize);
  const OptimizeRequest& r = *c.optimize;
  EXPECT_EQ(r.method, OptimizeMethod::LevelSet);
  EXPECT_EQ(r.volume_at_most, 0.4);
  EXPECT_EQ(r.volume_penalty, 0);
  EXPECT_EQ(r.max_iterations, 100);
  EXPECT_EQ(r.tolerance, 1e-3);
  EXPECT_TRUE(r.bounds.empty());
  EXPECT_TRUE(r.load_cases.empty());
  EXPECT_EQ(r.level_set.move, LevelSetRequest::Move::ShapeGradient);
  EXPECT_EQ(r.level_set.product, LevelSetRequest::Product::H1);
  EXPECT_EQ(r.level_set.nucleate_every, 5);
  EXPECT_EQ(r.level_set.nucleate_fraction, 0.02);
  EXPECT_FALSE(r.level_set.mirror);
  EXPECT_FALSE(r.level_set.start);
  EXPECT_EQ(r.level_set.ersatz, 0);
  EXPECT_EQ(c.fingerprint.size(), 16u);
}

TEST(Optimize, EveryKeyOfTheLevelSetArrives) {
  const Case c = read(plate + pull + R"([[region]]
name = "pad"
polygon = [[1.9, 0.3], [2.1, 0.3], [2.1, 0.7], [1.9, 0.7]]
[[region]]
name = "insert"
circle = { center = [1, 0.5], radius = 0.1 }
young = 20
poisson = 0.3
[optimize]
method = "level-set"
volume = { at_most = 0.5, penalty = 10 }
max_iterations = 7
tolerance = 0.01
nucleate = { every = 3, fraction = 0.05 }
frozen = ["pad", "insert"]
move = "fixed-point"
inner_product = "elasticity"
smoothing = 0.1
min_feature = 0.05
symmetry = { y = 0.5 }
start = { holes = [6, 3], radius = 0.07 }
ersatz = 1e-3
[[optimize.bound]]
kind = "stress_pnorm"
p = 8
at_most = 3
[[optimize.bound]]
kind = "stress_pnorm"
p = 4
at_most = 2
[[optimize.bound]]
kind = "volume"
name = "area"
at_most = 1
)");
  ASSERT_TRUE(c.optimize);
  const OptimizeRequest& r = *c.optimize;
  EXPECT_EQ(r.volume_at_most, 0.5);
  EXPECT_EQ(r.volume_penalty, 10);
  EXPECT_EQ(r.max_iterations, 7);
  EXPECT_EQ(r.tolerance, 0.01);
  const LevelSetRequest& l = r.level_set;
  EXPECT_EQ(l.move, LevelSetRequest::Move::FixedPoint);
  EXPECT_EQ(l.product, LevelSetRequest::Product::Elasticity);
  EXPECT_EQ(l.smoothing, 0.1);
  EXPECT_EQ(l.min_feature, 0.05);
  EXPECT_EQ(l.nucleate_every, 3);
  EXPECT_EQ(l.nucleate_fraction, 0.05);
  EXPECT_EQ(l.ersatz, 1e-3);
  ASSERT_TRUE(l.mirror);
  EXPECT_EQ(l.mirror->point.y(), 0.5);
  EXPECT_EQ(l.mirror->direction, Vec2::UnitX());
  ASSERT_TRUE(l.start);
  EXPECT_EQ(l.start->columns, 6);
  EXPECT_EQ(l.start->rows, 3);
  EXPECT_EQ(l.start->random, 0);
  EXPECT_EQ(l.start->radius, 0.07);
  // The pad is a mask alone and may leave the body; the insert is a mask and another material.
  ASSERT_EQ(l.frozen.size(), 2u);
  EXPECT_EQ(l.frozen[0].name, "pad");
  EXPECT_EQ(l.frozen[0].sides.size(), 4u);
  EXPECT_EQ(l.frozen[1].name, "insert");
  ASSERT_EQ(c.shape.regions.size(), 1u);
  EXPECT_EQ(c.shape.regions[0].name, "insert");
  ASSERT_EQ(c.scene.regions.size(), 1u);
  ASSERT_EQ(r.bounds.size(), 3u);
  EXPECT_EQ(r.bounds[0].name, "stress_pnorm");
  EXPECT_EQ(r.bounds[0].at_most, 3);
  EXPECT_EQ(r.bounds[1].name, "stress_pnorm_2");
  EXPECT_EQ(r.bounds[1].functional.terms.at(0).stress_power, 4);
  EXPECT_EQ(r.bounds[2].name, "area");
  EXPECT_EQ(r.bounds[2].functional.kind, "volume");
}

TEST(Optimize, LargestStressesLeaveZonesOut) {
  const Case c = read(plate + pull + R"([optimize]
volume = { at_most = 0.5 }
[[optimize.bound]]
kind = "max_stress"
at_most = 3
[[optimize.bound]]
kind = "max_stress"
of = "principal"
except = { ends = 0.1, supports = 0 }
at_most = 2
)");
  ASSERT_TRUE(c.optimize);
  ASSERT_EQ(c.optimize->bounds.size(), 2u);
  const Term &mises = c.optimize->bounds[0].functional.terms.at(0),
             &principal = c.optimize->bounds[1].functional.terms.at(0);
  ASSERT_TRUE(mises.largest && principal.largest);
  EXPECT_EQ(mises.largest->of, LargestStress::Of::VonMises);
  EXPECT_EQ(mises.largest->ends, 0.01);
  EXPECT_EQ(mises.largest->supports, 0.014);
  EXPECT_EQ(principal.largest->of, LargestStress::Of::Principal);
  EXPECT_EQ(principal.largest->ends, 0.1);
  EXPECT_EQ(principal.largest->supports, 0);
  // The left side is clamped, the right one loaded.
  const double size = extent(c.shape);
  EXPECT_TRUE(mises.largest->leaves_out({0.013 * size, 0.5}));
  EXPECT_FALSE(principal.largest->leaves_out({0.013 * size, 0.5}));
  EXPECT_FALSE(mises.largest->leaves_out({2 - 0.02 * size, 0}));
  EXPECT_TRUE(principal.largest->leaves_out({2 - 0.02 * size, 0}));
}

TEST(Optimize, OtherSpellings) {
  const std::string head = plate + pull + "[optimize]\nvolume = { penalty = 3 }\n";
  EXPECT_EQ(read(head + "nucleate = false").optimize->level_set.nucleate_every, 0);
  EXPECT_EQ(read(head + "nucleate = true").optimize->level_set.nucleate_every, 5);
  const StartHoles random = *read(head + "start = { random = 10, seed = 4, radius = 0.1 }").optimize->level_set.start;
  EXPECT_EQ(random.random, 10);
  EXPECT_EQ(random.seed, 4u);
  EXPECT_EQ(random.columns, 0);
  const Mirror upright = *read(head + "symmetry = { x = 1 }").optimize->level_set.mirror;
  EXPECT_EQ(upright.point.x(), 1);
  EXPECT_EQ(upright.direction, Vec2::UnitY());
  const Mirror given = *read(head + "symmetry = { point = [0, 0.5], direction = [-3, 0] }").optimize->level_set.mirror;
  EXPECT_EQ(given.direction, -Vec2::UnitX());
}

TEST(Optimize, AVolumeIsNotNeededWhereSomethingElseHoldsItDown) {
  const std::string body = square + "[[boundary]]\non = 'left'\ndisplacement = [0, 0]\n" + pull;
  EXPECT_TRUE(
      read(body + "[functional]\nkind = 'volume'\n[[optimize.bound]]\nkind = 'compliance'\nat_most = 1").optimize);
  EXPECT_TRUE(read(body + "[functional]\nkind = 'sum'\nterms = [{ kind = 'compliance' }, { kind = 'volume', factor = 9 "
                          "}]\n[optimize]")
                  .optimize);
  EXPECT_TRUE(read(body + "[functional]\nkind = 'displacement_tracking'\ntarget = [0, 0]\n[optimize]\nvolume = { "
                          "penalty = 1 }")
                  .optimize);
  // The loop has always refused this, after the meshing.
  EXPECT_NE(error(body + "[functional]\nkind = 'displacement_tracking'\ntarget = [0, 0]\n[optimize]")
                .find("a level set needs something that says how much material"),
            std::string::npos);
}

TEST(Optimize, DesignVariablesInTheirOrder) {
  const Case c = read(plate + pull + R"([[hole]]
name = "hole_1"
circle = { center = [0.2, 0.2], radius = 0.05 }
[optimize]
method = "mma"
volume = { at_most = 0.9 }
min_distance = 0.02
[[optimize.hole]]
circle = { center = [[0.5, 1.5], 0.5], radius = [0.02, 0.1] }
[[optimize.hole]]
name = "egg"
ellipse = { center = [1, [0.4, 0.6]], semi_axes = [[0.1, 0.3], 0.1], angle_deg = [-90, 90] }
start = { semi_axes = [0.2, 0.1], angle_deg = 45 }
[[optimize.hole]]
spline = { points = [[[1.0, 1.4], [0.3, 0.7]], [[1.0, 1.4], [0.3, 0.7]], [[1.0, 1.4], [0.3, 0.7]], [[1.0, 1.4], [0.3, 0.7]]] }
start = { center = [1.2, 0.5], radius = 0.1 }
[[optimize.crack]]
path = [[0, [0.4, 0.6]], [[0.1, 0.5], [0.4, 0.8]]]
contact = "open"
[[optimize.region]]
name = "soft"
circle = { center = [[0.5, 1.5], [0.3, 0.7]], radius = 0.1 }
young = [1, 9]
poisson = 0.4
start = { young = 2, center = [0.6, 0.4] }
)");
  const OptimizeRequest& r = *c.optimize;
  EXPECT_EQ(r.method, OptimizeMethod::Mma);
  EXPECT_EQ(r.min_distance, 0.02);
  const std::vector<Drawn>& d = r.design.drawn;
  ASSERT_EQ(d.size(), 5u);
  const auto expect = [](const Eigen::VectorXd& v, const std::vector<double>& values) {
    ASSERT_EQ(v.size(), static_cast<Eigen::Index>(values.size()));
    for (Eigen::Index i = 0; i < v.size(); ++i) EXPECT_DOUBLE_EQ(v[i], values[static_cast<std::size_t>(i)]) << i;
  };
  EXPECT_EQ(d[0].kind, Drawn::Kind::Circle);
  EXPECT_EQ(d[0].name, "hole_2");  // the body has a hole_1
  expect(d[0].lower, {0.5, 0.5, 0.02});
  expect(d[0].upper, {1.5, 0.5, 0.1});
  expect(d[0].start, {1, 0.5, 0.06});
  EXPECT_EQ(d[1].kind, Drawn::Kind::Ellipse);
  EXPECT_EQ(d[1].name, "egg");
  const double right = pi / 2;
  expect(d[1].lower, {1, 0.4, 0.1, 0.1, -right});
  expect(d[1].upper, {1, 0.6, 0.3, 0.1, right});
  expect(d[1].start, {1, 0.5, 0.2, 0.1, right / 2});
  EXPECT_EQ(d[2].kind, Drawn::Kind::Spline);
  EXPECT_EQ(d[2].name, "hole_3");
  ASSERT_EQ(d[2].start.size(), 8);
  EXPECT_NEAR(d[2].start[0], 1.3, 1e-15);
  EXPECT_NEAR(d[2].start[3], 0.6, 1e-15);
  EXPECT_EQ(d[3].kind, Drawn::Kind::Crack);
  EXPECT_EQ(d[3].name, "crack_1");
  EXPECT_EQ(d[3].law.kind, CrackLaw::Kind::Open);
  expect(d[3].start, {0, 0.5, 0.3, 0.6});
  EXPECT_EQ(d[4].kind, Drawn::Kind::Inclusion);
  expect(d[4].lower, {0.5, 0.3, 0.1, 1});
  expect(d[4].upper, {1.5, 0.7, 0.1, 9});
  expect(d[4].start, {0.6, 0.4, 0.1, 2});
  EXPECT_EQ(d[4].poisson, 0.4);
}

const std::string two_loads = R"([[boundary]]
on = "bottom"
displacement_y = 0
[optimize]
volume = { at_most = 0.5 }
[[load_case]]
name = "pull"
weight = 2
[[load_case.boundary]]
on = "right"
traction = ["3 * y", 0]
[[load_case.boundary]]
on = "bottom"
traction = [5, 0]
[[load_case]]
name = "weight"
[load_case.body]
force = [0, "-x"]
)";

// start = "map": boxes alone, with something drawable to begin from even where all boxes are the same.
TEST(Optimize, AStartMayBeReadOffTheMap) {
  const std::string head = plate + pull + "[optimize]\nmethod = 'mma'\nvolume = { at_most = 0.5 }\n";
  const Case c = read(head + R"([[optimize.hole]]
circle = { center = [[0.2, 0.8], [0.2, 0.8]], radius = [0.05, 0.2] }
start = "map"
[[optimize.hole]]
spline = { points = [[[0.2, 0.8], [0.2, 0.8]], [[0.2, 0.8], [0.2, 0.8]], [[0.2, 0.8], [0.2, 0.8]], [[0.2, 0.8], [0.2, 0.8]]] }
start = "map"
[[optimize.crack]]
path = [[[0.2, 0.8], [0.2, 0.8]], [[0.2, 0.8], [0.2, 0.8]]]
start = "map"
[[optimize.region]]
circle = { center = [[0.2, 0.8], [0.2, 0.8]], radius = [0.05, 0.2] }
young = [1, 10]
poisson = 0.3
)");
  const std::vector<Drawn>& drawn = c.optimize->design.drawn;
  ASSERT_EQ(drawn.size(), 4u);
  for (const std::size_t k : {0, 1, 2}) EXPECT_TRUE(drawn[k].from_map);
  EXPECT_FALSE(drawn[3].from_map);
  EXPECT_NE(drawn[1].start.segment<2>(0), drawn[1].start.segment<2>(2));
  EXPECT_NE(drawn[2].start.head<2>(), drawn[2].start.tail<2>());
  for (const Drawn& d : drawn)
    EXPECT_TRUE((d.start.array() >= d.lower.array()).all() && (d.start.array() <= d.upper.array()).all());
  EXPECT_NE(error(head + "[[optimize.hole]]\ncircle = { center = [0.5, [0.2, 0.8]], radius = 0.1 }\nstart = 'mpa'\n")
                .find("start in [[optimize.hole]]"),
            std::string::npos);
}

TEST(LoadCases, CarryTheirOwnLoadsAndTheFirstIsSolved) {
  const Case c = read(plate + two_loads);
  const std::vector<LoadCase>& l = c.optimize->load_cases;
  ASSERT_EQ(l.size(), 2u);
  EXPECT_EQ(l[0].name, "pull");
  EXPECT_EQ(l[0].weight, 2);
  ASSERT_EQ(l[0].tractions.size(), 2u);
  EXPECT_EQ(c.shape.labels[static_cast<std::size_t>(l[0].tractions[0].label)], "bottom");
  EXPECT_EQ(l[0].tractions[0].value({1, 0}, {0, -1}), Vec2(5, 0));
  EXPECT_EQ(l[0].tractions[1].value({2, 0.5}, {1, 0}), Vec2(1.5, 0));
  EXPECT_FALSE(l[0].body);
  EXPECT_EQ(l[1].weight, 1);
  EXPECT_TRUE(l[1].tractions.empty());
  EXPECT_EQ(l[1].body({3, 1}), Vec2(0, -3));
  // The scene has the supports alone; what is solved outside the optimization is the first load case.
  EXPECT_EQ(c.scene.supports.size(), 2u);
  EXPECT_TRUE(c.scene.tractions.empty());
  EXPECT_FALSE(c.scene.body);
  EXPECT_EQ(loaded_scene(c).tractions.size(), 2u);
  EXPECT_FALSE(loaded_scene(c).body);
}

TEST(LoadCases, WrongOnesAreNamed) {
  const std::string head =
      plate + "[optimize]\nvolume = { at_most = 0.5 }\n[[load_case]]\nname = 'a'\n";  // lines 12, 14
  const std::string load = "[[load_case.boundary]]\non = 'right'\npressure = 1\n";
  EXPECT_EQ(error(head),
            "a.toml:14:1: [[load_case]] \"a\" has no load; add [[load_case.boundary]] with traction or "
            "pressure, or body = { force = ... }");
  EXPECT_EQ(error(head + load + "[[load_case]]\nname = 'a'\n" + load),
            "a.toml:20:8: name in [[load_case]]: the name \"a\" is taken; give each its own");
  EXPECT_EQ(error(head + "weight = 0\n" + load), "a.toml:16:10: weight in [[load_case]] must be positive, not 0");
  EXPECT_EQ(
      error(head + "[[load_case.boundary]]\non = 'right'\ndisplacement = [0, 0]"),
      "a.toml:18:16: displacement in [[load_case.boundary]]: all load cases have the supports of [[boundary]]; move "
      "it there");
  EXPECT_EQ(error(head + "[[load_case.boundary]]\non = 'right'\ntration = [0, 0]"),
            "a.toml:18:1: unknown key \"tration\" in [[load_case.boundary]]; did you mean \"traction\"?");
  EXPECT_EQ(error(head + "[[load_case.boundary]]\non = 'right'"),
            "a.toml:16:1: [[load_case.boundary]] prescribes nothing; give traction or pressure");
  EXPECT_EQ(
      error(head + "[[load_case.boundary]]\non = 'left'\ntraction = [0, 1]"),
      "a.toml:18:12: label \"left\": traction conflicts with displacement (the other is at a.toml:9:16); keep one of "
      "them");
  EXPECT_EQ(error(head + load + load),
            "a.toml:21:12: label \"right\": two conditions pressure (the other is at a.toml:18:12); keep one of them");
  EXPECT_EQ(
      error(head + load + "[body]\nforce = [0, 1]"),
      "a.toml:19:1: [body]: with [[load_case]] all loads belong to load cases; write body = { force = ... } in each "
      "load case in which it acts");
  EXPECT_EQ(error(plate + "[[load_case]]\nname = 'a'\n" + load),
            "a.toml:12:1: [[load_case]] goes with [optimize]; without it write the loads as [[boundary]] and [body]");
  std::string inverse = head + load;
  inverse.replace(inverse.find("kind = \"compliance\""), 19, "kind = 'misfit'\non = 'top'\nmeasured = [0, 0]");
  EXPECT_EQ(error(inverse),
            "a.toml:16:1: [[load_case]]: a misfit belongs to one set of loads; write them as "
            "[[boundary]] and [body]");
}

TEST(Optimize, NeedsAFunctional) {
  EXPECT_EQ(
      error(square + "[optimize]\nvolume = { at_most = 0.5 }"),
      "a.toml:7:1: [optimize] needs [functional]: what is to be made small; kind = \"compliance\" gives a stiff body");
  EXPECT_EQ(
      error(square + "[functional]\nkind = 'volume'\n[optimize]"),
      "a.toml:9:1: [optimize]: the least volume is no body at all; add an [[optimize.bound]] on what the body has to "
      "bear, such as kind = \"compliance\" with at_most");
}

TEST(Optimize, ABodyThatCannotBeDrawnIsLeftToTheRun) {
  const Case c =
      read(plate + pull + "[[hole]]\nname = 'h'\ncircle = { center = [9, 9], radius = 1e200 }\n[optimize]\n" +
           "volume = { at_most = 0.5 }\nsymmetry = { x = 1 }\nfrozen = ['pad']\n[[region]]\nname = 'pad'\n" +
           "circle = { center = [1, 0.5], radius = 0.1 }");
  EXPECT_TRUE(c.optimize);
}

TEST(Fingerprint, DependsOnWhatTheOptimizationDependsOn) {
  const std::string body = plate + pull + "[optimize]\nvolume = { at_most = 0.5 }\n";
  const std::string first = read(body).fingerprint;
  EXPECT_EQ(read(body).fingerprint, first);
  // Layout, comments, the way of writing a number, titles, output and how long to go on.
  EXPECT_EQ(read("# comment\n" + body + "\n\nmax_iterations = 3\n[output]\nhtml = false\n").fingerprint, first);
  EXPECT_EQ(read(body, {{"output.png=false"}, {"title='x'"}}).fingerprint, first);
  EXPECT_EQ(read(body, {{"material.young=10.0"}}).fingerprint, first);
  for (const char* other : {"material.young=11", "optimize.volume.at_most=0.4", "mesh.size=0.1", "solver.degree=2",
                            "boundary[1].traction=[0, 1]", "optimize.nucleate=false"})
    EXPECT_NE(read(body, {{other}}).fingerprint, first) << other;

  // Measured data count, too.
  const TemporaryFolder folder;
  const std::string inverse =
      square + "[[boundary]]\non = 'left'\ndisplacement = [0, 0]\n" + pull +
      "[functional]\nkind = 'misfit'\non = 'right'\nmeasured = 'u.csv'\n[optimize]\nvolume = { at_most = 0.5 }\n";
  const auto file = folder.write("a.toml", inverse);
  folder.write("u.csv", "x,y,u_x,u_y\n2,0,0,0\n2,1,0,0\n");
  const std::string before = read_case(file).fingerprint;
  folder.write("u.csv", "x,y,u_x,u_y\n2,0,0,0\n2,1,0,0.1\n");
  EXPECT_NE(read_case(file).fingerprint, before);
}

// Lines 7 to 16: supported on the left, pulled on the right, where the displacements are made up.
const std::string inverse = square + R"([[boundary]]
on = "left"
displacement = [0, 0]
[[boundary]]
on = "right"
traction = [1, 0]
[functional]
kind = "misfit"
on = "right"
measured = "synthetic"
)";

TEST(Synthetic, DescribesTheTrueBody) {
  const Case c = read(inverse + R"([[hole]]
name = "known"
circle = { center = [0.3, 0.3], radius = 0.1 }
[mesh]
size = 0.1
[synthetic]
noise = 0.01
seed = 7
[[synthetic.hole]]
name = "h"
circle = { center = [1.2, 0.5], radius = 0.15 }
[[synthetic.crack]]
name = "c"
path = [[1.6, 0.2], [1.6, 0.8]]
contact = "open"
[[synthetic.region]]
name = "r"
circle = { center = [0.8, 0.7], radius = 0.1 }
young = 30
poisson = 0.2
)");
  ASSERT_TRUE(c.synthetic);
  const Synthetic& s = *c.synthetic;
  EXPECT_EQ(c.shape.holes.size(), 1u);
  EXPECT_EQ(s.true_shape.holes.size(), 2u);
  EXPECT_EQ(s.true_shape.labels.back(), "hole:h");
  ASSERT_EQ(s.true_shape.cracks.size(), 1u);
  ASSERT_EQ(s.true_scene.laws.size(), 1u);
  EXPECT_EQ(s.true_scene.laws[0].kind, CrackLaw::Kind::Open);
  EXPECT_TRUE(c.scene.laws.empty());
  ASSERT_EQ(s.true_scene.regions.size(), 1u);
  EXPECT_EQ(s.true_scene.supports.size(), 1u);
  EXPECT_EQ(s.true_scene.tractions.size(), 1u);
  EXPECT_EQ(s.element.name, "afw");
  EXPECT_EQ(s.element.degree, 2);
  EXPECT_EQ(s.spacing, 0.1);
  EXPECT_DOUBLE_EQ(s.sizing.size, 0.07);
  EXPECT_EQ(s.noise, 0.01);
  EXPECT_EQ(s.seed, 7u);
  EXPECT_EQ(c.shape.labels[static_cast<std::size_t>(s.label)], "right");
  EXPECT_FALSE(find_problem(s.true_shape));

  const std::string hole = "[[synthetic.hole]]\nname = 'h'\ncircle = { center = [1.2, 0.5], radius = 0.15 }\n";
  const Case other = read(inverse + "[solver]\nelement = 'afw'\n[synthetic]\nsize = 0.02\n" + hole);
  EXPECT_EQ(other.synthetic->element.name, "bdms");
  EXPECT_EQ(other.synthetic->sizing.size, 0.02);
  EXPECT_EQ(read(inverse + "[synthetic]\nelement = 'p2'\n" + hole).synthetic->element.name, "p2");
  // Without [mesh]: of the default size.
  EXPECT_DOUBLE_EQ(read(inverse + hole).synthetic->sizing.size, 0.7 * extent(c.shape) / 40);
}

TEST(LeastSquares, AreAskedForAndFindTheirReadings) {
  const std::string hole = "[[synthetic.hole]]\nname = 'h'\ncircle = { center = [1.2, 0.5], radius = 0.15 }\n";
  const std::string sought =
      "[[optimize.hole]]\ncircle = { center = [[0.3, 1.7], [0.3, 0.7]], radius = [0.05, 0.2] }\n";
  const auto with = [&](const std::string& keys, const std::string& start = "start = 'map'\n") {
    return inverse + hole + "[optimize]\nmethod = 'mma'\n" + keys + sought + start;
  };
  EXPECT_FALSE(read(with("")).fit);
  EXPECT_FALSE(read(with("least_squares = false\n")).fit);
  const Case plain = read(with("least_squares = true\nstarts = 4\n"));
  ASSERT_TRUE(plain.fit);
  EXPECT_EQ(plain.optimize->starts, 4);
  EXPECT_EQ(plain.fit->defects_at_most, 0);
  EXPECT_EQ(plain.readings.noise, 0);
  EXPECT_EQ(plain.readings.label, plain.synthetic->label);
  EXPECT_EQ(read(with("least_squares = { noise = 0.01 }\n")).readings.noise, 0.01);
  EXPECT_EQ(read(with("defects = { at_most = 5 }\n")).fit->defects_at_most, 5);

  // Lines 20 and 22.
  EXPECT_EQ(error(with("defects = { at_most = 0 }\n")),
            "a.toml:22:23: at_most in defects in [optimize] must be between 1 and 20, not 0");
  EXPECT_EQ(error(with("defects = 3\n")), "a.toml:22:11: defects in [optimize] must be { at_most = 5 }");
  EXPECT_EQ(error(with("starts = 0\n")), "a.toml:22:10: starts in [optimize] must be between 1 and 1000, not 0");
  EXPECT_EQ(error(with("defects = { at_most = 3 }\n", "")).substr(0, 70),
            "a.toml:22:11: defects in [optimize] goes with [[optimize.hole]], [[opt");
  EXPECT_EQ(error(with("least_squares = false\ndefects = { at_most = 3 }\n")),
            "a.toml:22:17: least_squares in [optimize] = false does not go with defects, which are counted by it");
  // In every table or in none, and begun from the map.
  const std::string crack = "[[optimize.crack]]\npath = [[[0.3, 1.7], 0.5], [[0.3, 1.7], 0.5]]\n";
  const Case counted = read(with("", "count = 'auto'\n" + crack + "count = 'auto'\nstart = 'map'\n"));
  EXPECT_EQ(counted.fit->defects_at_most, 5);
  ASSERT_EQ(counted.optimize->design.drawn.size(), 2u);
  for (const Drawn& d : counted.optimize->design.drawn) EXPECT_TRUE(d.from_map);
  EXPECT_EQ(read(with("defects = { at_most = 2 }\n", "count = 'auto'\n")).fit->defects_at_most, 2);
  EXPECT_NE(error(with("", "count = 'auto'\n" + crack + "start = 'map'\n")).find("needs count = \"auto\", too"),
            std::string::npos);
  EXPECT_NE(error(with("", "count = 'auto'\nstart = { radius = 0.1 }\n")).find("does not go with count = \"auto\""),
            std::string::npos);
  EXPECT_NE(error(with("least_squares = false\n", "count = 'auto'\n")).find("does not go with count = \"auto\""),
            std::string::npos);
  EXPECT_EQ(error(with("least_squares = 1\n")),
            "a.toml:22:17: least_squares in [optimize] must be true, false or { noise = 1e-4 }");
  EXPECT_EQ(error(plate + pull + "[optimize]\nmethod = 'mma'\nleast_squares = true\n" + sought),
            "a.toml:17:17: least_squares in [optimize] goes with measured displacements: kind = \"misfit\" in "
            "[functional]");

  const TemporaryFolder folder;
  folder.write("u.csv", "x,y,u_x,u_y\n2,0,0,0\n2,0.5,0.1,0\n2,1,0,0.1\n");
  std::string measured = inverse + "[optimize]\nmethod = 'mma'\nleast_squares = true\n" + sought;
  measured.replace(measured.find("\"synthetic\""), 11, "\"u.csv\"");
  const Case c = read_case(folder.write("a.toml", measured));
  ASSERT_EQ(c.readings.at.size(), 3u);
  EXPECT_EQ(c.readings.at[1], Vec2(2, 0.5));
  EXPECT_EQ(c.readings.displacement[2], Vec2(0, 0.1));
  measured.replace(measured.find("\"u.csv\""), 7, "[\"0\", \"0\"]");
  EXPECT_NE(error(measured).find("least_squares in [optimize] needs readings at points"), std::string::npos)
      << error(measured);
}

TEST(Synthetic, WrongOnesAreNamed) {
  const std::string hole =
      "[[synthetic.hole]]\nname = 'h'\ncircle = { center = [1.2, 0.5], radius = 0.15 }\n";  // 3 lines
  EXPECT_EQ(error(inverse),
            "a.toml:16:12: measured in [functional] = \"synthetic\" needs the table [synthetic] with the "
            "true body; add [[synthetic.hole]], [[synthetic.crack]] or [[synthetic.region]]");
  EXPECT_EQ(error(inverse + "[synthetic]"),
            "a.toml:17:1: [synthetic]: there is nothing to be found; add "
            "[[synthetic.hole]], [[synthetic.crack]] or [[synthetic.region]]");
  EXPECT_EQ(error(inverse + "[synthetic]\nnosie = 0.1\n" + hole),
            "a.toml:18:1: unknown key \"nosie\" in [synthetic]; did you mean \"noise\"?");
  EXPECT_EQ(error(inverse + "[synthetic]\nnoise = 2\n" + hole),
            "a.toml:18:9: noise in [synthetic] must be between 0 and 1, not 2");
  EXPECT_EQ(error(inverse + "[synthetic]\nseed = -1\n" + hole),
            "a.toml:18:8: seed in [synthetic] must be between 0 and 2147483647, not -1");
  EXPECT_EQ(
      error(inverse + "[synthetic]\nelement = 'bdms'\n" + hole),
      "a.toml:18:11: element in [synthetic]: the data would be made with the element \"bdms\" of degree 1 that looks "
      "for the answer: an inverse crime; choose another element or degree");
  EXPECT_EQ(
      error(inverse + "[synthetic]\nelement = 'p2'\n[[synthetic.crack]]\nname = 'c'\npath = [[1, 0.3], [1, 0.6]]"),
      "a.toml:18:11: element in [synthetic]: element \"p2\" cannot do contact on cracks; use \"bdms\", \"bdms-c\", "
      "\"peers\", \"afw\", \"arnold-winther\" or \"arnold-winther-nc\", or contact = \"open\"");
  EXPECT_EQ(error(inverse + hole + hole),
            "a.toml:21:8: name in [[synthetic.hole]]: the name \"h\" is taken; give each its "
            "own");
  EXPECT_EQ(error(inverse + "[[synthetic.hole]]\nname = 'h'\ncircel = 1"),
            "a.toml:19:1: unknown key \"circel\" in [[synthetic.hole]]; did you mean \"circle\"?");
}

struct Wrong {
  const char* lines;  // appended to the plate and its pull: the first is line 15
  const char* message;
};
void PrintTo(const Wrong& w, std::ostream* out) {
  *out << w.message;
}
class WrongOptimize : public testing::TestWithParam<Wrong> {};

TEST_P(WrongOptimize, SaysWhereAndWhat) {
  EXPECT_EQ(error(plate + pull + GetParam().lines), GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(
    Table, WrongOptimize,
    testing::Values(Wrong{"[optimize]\nmehtod = 'mma'",
                          "a.toml:16:1: unknown key \"mehtod\" in [optimize]; did you mean \"method\"?"},
                    Wrong{"[optimize]\nmethod = 'mna'",
                          "a.toml:16:10: unknown method in [optimize] \"mna\"; did you mean \"mma\"?"},
                    Wrong{"[[optimize]]\nmethod = 'mma'",
                          "a.toml:15:1: there is only one [optimize]; write [optimize] instead of [[optimize]]"},
                    Wrong{"[optimize]",
                          "a.toml:15:1: [optimize]: without volume = { at_most = ... } or { penalty = ... } the full "
                          "body has the least compliance, and there is nothing to optimize; add one of them"},
                    Wrong{"[optimize]\nvolume = 0.4",
                          "a.toml:16:10: volume in [optimize] must be { at_most = 0.4 } (of the area), { penalty = 100 "
                          "} (J + penalty times area), or both in one table"},
                    Wrong{"[optimize]\nvolume = {}",
                          "a.toml:16:10: volume in [optimize] needs at_most, penalty or both"},
                    Wrong{"[optimize]\nvolume = { atmost = 0.4 }",
                          "a.toml:16:12: unknown key \"atmost\" in volume in [optimize]; did you mean \"at_most\"?"},
                    Wrong{"[optimize]\nvolume = { at_most = 1.5 }",
                          "a.toml:16:22: at_most in volume in [optimize] = 1.5 is a share of the body's area; it must "
                          "not be larger than 1"},
                    Wrong{"[optimize]\nvolume = { at_most = 0 }",
                          "a.toml:16:22: at_most in volume in [optimize] must be positive, not 0"},
                    Wrong{"[optimize]\nvolume = { penalty = -1 }",
                          "a.toml:16:22: penalty in volume in [optimize] must be positive, not -1"},
                    Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nmax_iterations = 0",
                          "a.toml:17:18: max_iterations in [optimize] must be between 1 and 1000000, not 0"},
                    Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nmax_iterations = 2.5",
                          "a.toml:17:18: max_iterations in [optimize] must be a whole number, not 2.5"},
                    Wrong{"[optimize]\nvolume = { at_most = 0.5 }\ntolerance = 1",
                          "a.toml:17:13: tolerance in [optimize] must be between 1e-12 and 0.5, not 1"}));

INSTANTIATE_TEST_SUITE_P(
    LevelSet, WrongOptimize,
    testing::Values(
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nnucleate = 5",
              "a.toml:17:12: nucleate in [optimize] must be { every = 5, fraction = 0.02 }, true or false"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nnucleate = { evry = 5 }",
              "a.toml:17:14: unknown key \"evry\" in nucleate in [optimize]; did you mean \"every\"?"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nnucleate = { every = 0 }",
              "a.toml:17:22: every in nucleate in [optimize] must be between 1 and 100000, not 0"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nnucleate = { fraction = 0.6 }",
              "a.toml:17:25: fraction in nucleate in [optimize] = 0.6 is the share of the area that one nucleation may "
              "take; it must not be larger than 0.5"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nmove = 'gradient'",
              "a.toml:17:8: unknown move in [optimize] \"gradient\"; known: shape-gradient, fixed-point"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\ninner_product = 'H1'",
              "a.toml:17:17: unknown inner_product in [optimize] \"H1\"; did you mean \"h1\"?"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nsmoothing = 3",
              "a.toml:17:13: smoothing in [optimize] = 3 must be smaller than the body, whose diagonal is 2.23607"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nmin_feature = -1",
              "a.toml:17:15: min_feature in [optimize] must be positive, not -1"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nmin_distance = 0.1",
              "a.toml:17:16: min_distance in [optimize] goes with method = \"mma\", \"ccsaq\", \"slsqp\" or "
              "\"cobyla\", which move drawn holes, cracks and regions, not with \"level-set\"; use min_feature"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nersatz = 1",
              "a.toml:17:10: ersatz in [optimize] must be between 1e-09 and 0.5, not 1"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nsymmetry = { x = 1, y = 0.5 }",
              "a.toml:17:25: symmetry in [optimize] has both x and y; keep one"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nsymmetry = { x = 0.9 }",
              "a.toml:17:12: symmetry in [optimize]: the body is not its own mirror image about that line: nothing is "
              "drawn at (1.8, 0.622222), the image of (0, 0.622222)"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nsymmetry = { point = [1, 0.5] }",
              "a.toml:17:12: missing key \"direction\" in symmetry in [optimize]; add it"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nsymmetry = { point = [1, 0.5], direction = [0, 0] }",
              "a.toml:17:44: direction in symmetry in [optimize] must not be zero; [1, 0] is along x"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nsymmetry = { point = [1, 0.5], direction = [1, 1] }",
              "a.toml:17:12: symmetry in [optimize]: the body is not its own mirror image about that line: nothing is "
              "drawn at (1.12222, -0.5), the image of (0, 0.622222)"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nsymmetry = { z = 1 }",
              "a.toml:17:12: symmetry in [optimize] needs one of x, y, point"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nstart = { holes = 6, radius = 0.1 }",
              "a.toml:17:19: holes in start in [optimize] must be [columns, rows]"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nstart = { holes = [6, 0], radius = 0.1 }",
              "a.toml:17:23: entry 2 of holes in start in [optimize] must be between 1 and 1000, not 0"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nstart = { holes = [6, 3] }",
              "a.toml:17:9: missing key \"radius\" in start in [optimize]; add it"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nstart = { holes = [6, 3], random = 3, radius = 0.1 }",
              "a.toml:17:36: start in [optimize] has both holes and random; keep one"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nstart = { holes = [6, 3], seed = 3, radius = 0.1 }",
              "a.toml:17:27: unknown key \"seed\" in start in [optimize]; known: holes, radius"},
        Wrong{
            "[optimize]\nvolume = { at_most = 0.5 }\nstart = { random = 10, radius = 5 }",
            "a.toml:17:33: radius in start in [optimize] = 5 must be smaller than the body, whose diagonal is 2.23607"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nstart = {}",
              "a.toml:17:9: start in [optimize] needs one of holes, random, design"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nfrozen = ['pad']",
              "a.toml:17:11: entry 1 of frozen in [optimize]: there is no [[region]] \"pad\"; the case has none"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nfrozen = []",
              "a.toml:17:10: frozen in [optimize] must be a list of at least 1, not a list of 0"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nfrozen = 'pad'",
              "a.toml:17:10: frozen in [optimize] must be a list, not \"pad\""},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nfrozen = ['pda']\n[[region]]\nname = 'pad'\ncircle = { center = "
              "[1, 0.5], radius = 0.1 }",
              "a.toml:17:11: entry 1 of frozen in [optimize]: there is no [[region]] \"pda\"; did you mean \"pad\"?"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nfrozen = ['pad', 'pad']\n[[region]]\nname = 'pad'\ncircle = { "
              "center = [1, 0.5], radius = 0.1 }",
              "a.toml:17:18: entry 2 of frozen in [optimize]: region \"pad\" appears twice"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nfrozen = ['pad']\n[[region]]\nname = 'pad'\ncircle = { center = "
              "[5, 0.5], radius = 0.1 }",
              "a.toml:17:11: entry 1 of frozen in [optimize]: region \"pad\" lies outside the body: there is nothing "
              "to freeze"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nfrozen = ['pad']\n[[region]]\nname = 'pad'\ncircle = { center = "
              "[1, 0.5], radius = 5 }",
              "a.toml:17:11: entry 1 of frozen in [optimize]: region \"pad\" covers the whole body: nothing is left to "
              "design"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nfrozen = ['pad']\n[[region]]\nname = 'pad'\npolygon = [[0, 0], "
              "[1, 1], [1, 0], [0, 1]]",
              "a.toml:17:11: entry 1 of frozen in [optimize]: region \"pad\": its border crosses itself at (0.5, 0.5); "
              "a loop must be simple"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\nfrozen = ['pad']\n[[region]]\nname = 'pad'\nyoung = 3\ncircle = "
              "{ center = [1, 0.5], radius = 0.1 }",
              "a.toml:18:1: missing key \"poisson\" in [[region]]; add it"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\n[[region]]\nname = 'pad'\ncircle = { center = [1, 0.5], radius "
              "= 0.1 }",
              "a.toml:17:1: missing key \"young\" in [[region]]; add it"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\n[[optimize.hole]]\ncircle = { center = [[0.5, 1.5], 0.5], "
              "radius = [0.02, 0.1] }\n",
              "a.toml:17:1: hole in [optimize] goes with method = \"mma\", \"ccsaq\", \"slsqp\" or \"cobyla\", which "
              "move drawn holes, cracks and regions, not with \"level-set\""}));

INSTANTIATE_TEST_SUITE_P(
    Parameters, WrongOptimize,
    testing::Values(
        Wrong{"[optimize]\nmethod = 'mma'\nnucleate = false",
              "a.toml:17:12: nucleate in [optimize] goes with method = \"level-set\", not with \"mma\""},
        Wrong{"[optimize]\nmethod = 'mma'\nfrozen = ['pad']\n[[region]]\nname = 'pad'\ncircle = { center = [1, 0.5], "
              "radius = 0.1 }",
              "a.toml:17:10: frozen in [optimize] goes with method = \"level-set\", not with \"mma\""},
        Wrong{"[optimize]\nmethod = 'mma'\n",
              "a.toml:15:1: [optimize]: method = \"mma\" needs something that it can move: add [[optimize.hole]], "
              "[[optimize.crack]] or [[optimize.region]], or use method = \"level-set\""},
        Wrong{"[optimize]\nmethod = 'mma'\n[[optimize.hole]]\nname = 'a'",
              "a.toml:17:1: [[optimize.hole]] needs one of circle, ellipse, spline"},
        Wrong{"[optimize]\nmethod = 'mma'\n[[optimize.hole]]\ncircle = { center = [1, 0.5], radius = 0.1 }",
              "a.toml:15:1: [optimize]: every variable of the design is fixed; give at least one a box [low, high]"},
        Wrong{"[optimize]\nmethod = 'mma'\n[[optimize.hole]]\ncircle = { center = [1, 0.5], radius = [0, 0.1] }",
              "a.toml:18:41: entry 1 of radius in circle in [[optimize.hole]] must be larger than 0, not 0"},
        Wrong{"[optimize]\nmethod = 'mma'\n[[optimize.hole]]\ncircle = { center = [1, 0.5], radius = [0.2, 0.1] }",
              "a.toml:18:40: radius in circle in [[optimize.hole]]: the lower end 0.2 of the box is above the upper "
              "end 0.1; swap them"},
        Wrong{"[optimize]\nmethod = 'mma'\n[[optimize.hole]]\ncircle = { center = [1, 0.5], radius = [0.1, 0.2, 0.3] }",
              "a.toml:18:40: radius in circle in [[optimize.hole]] must be a number, which fixes it, or a box [low, "
              "high]"},
        Wrong{"[optimize]\nmethod = 'mma'\n[[optimize.hole]]\ncircle = { center = [1, 0.5], radius = 'x' }",
              "a.toml:18:40: radius in circle in [[optimize.hole]] must be a number, not \"x\""},
        Wrong{"[optimize]\nmethod = 'mma'\n[[optimize.hole]]\ncircle = { center = [[0, 1]], radius = 0.1 }",
              "a.toml:18:21: center in circle in [[optimize.hole]] must be a pair [x, y], not a list of 1"},
        Wrong{"[optimize]\nmethod = 'mma'\n[[optimize.hole]]\ncircle = { center = [[0.5, 1.5], 0.5], radius = [0.02, "
              "0.1] }\nstart = { radius = 0.3 }",
              "a.toml:19:20: radius in start in [[optimize.hole]] = 0.3 lies outside its box [0.02, 0.1]"},
        Wrong{"[optimize]\nmethod = 'mma'\n[[optimize.hole]]\ncircle = { center = [[0.5, 1.5], 0.5], radius = [0.02, "
              "0.1] }\nstart = { center = [1, 0.4] }",
              "a.toml:19:24: entry 2 of center in start in [[optimize.hole]] = 0.4 lies outside its box [0.5, 0.5]"},
        Wrong{"[optimize]\nmethod = 'mma'\n[[optimize.hole]]\ncircle = { center = [[0.5, 1.5], 0.5], radius = [0.02, "
              "0.1] }\nstart = { centre = [1, 0.5] }",
              "a.toml:19:11: unknown key \"centre\" in start in [[optimize.hole]]; did you mean \"center\"?"},
        Wrong{"[optimize]\nmethod = 'mma'\n[[optimize.hole]]\ncircle = { center = [[0.5, 1.5], 0.5], radius = [0.02, "
              "0.1] }\ncircel = 1",
              "a.toml:19:1: unknown key \"circel\" in [[optimize.hole]]; did you mean \"circle\"?"},
        Wrong{"[optimize]\nmethod = 'mma'\n[[optimize.hole]]\ncircle = { center = [[0.5, 1.5], 0.5], radius = [0.02, "
              "0.1] }\nname = 'a'\n[[optimize.hole]]\nname = 'a'\ncircle = { center = [0.1, 0.1], radius = 0.05 }",
              "a.toml:21:8: name in [[optimize.hole]]: the name \"a\" is taken; give each its own"},
        Wrong{"[optimize]\nmethod = 'mma'\n[[optimize.hole]]\nellipse = { center = [1, 0.5], semi_axes = [0.1], "
              "angle_deg = [0, 90] }",
              "a.toml:18:44: semi_axes in ellipse in [[optimize.hole]] must be a pair [x, y], not a list of 1"},
        Wrong{"[optimize]\nmethod = 'mma'\n[[optimize.hole]]\nellipse = { center = [1, 0.5], semi_axes = [0.1, 0.2], "
              "angle_deg = [0, 90] }\nstart = { angle_deg = 100 }",
              "a.toml:19:23: angle_deg in start in [[optimize.hole]] = 100 lies outside its box [0, 90]"},
        Wrong{"[optimize]\nmethod = 'mma'\n[[optimize.hole]]\nspline = { points = [[1, 1], [2, 2], [3, 1]] }",
              "a.toml:18:21: points in spline in [[optimize.hole]] must be a list of at least 4, not a list of 3"},
        Wrong{"[optimize]\nmethod = 'mma'\n[[optimize.hole]]\nspline = { points = [[[0, 1], [0, 1]], [[0, 1], [0, 1]], "
              "[[0, 1], [0, 1]], [[0, 1], [0, 1]]] }",
              "a.toml:18:21: points in spline in [[optimize.hole]]: the control points begin in the middle of their "
              "boxes and do not run counter-clockwise around a hole; add start = { center = [x, y], radius = r }"},
        Wrong{"[optimize]\nmethod = 'mma'\n[[optimize.hole]]\nspline = { points = [[[0, 1], [0, 1]], [[0, 1], [0, 1]], "
              "[[0, 1], [0, 1]], [[0, 1], [0, 1]]] }\nstart = { points = [[0.2, 0.2], [0.2, 0.4], [0.4, 0.4], [0.4, "
              "0.2]] }",
              "a.toml:19:9: start in [[optimize.hole]]: the control points must run counter-clockwise around a hole; "
              "turn their order round"},
        Wrong{"[optimize]\nmethod = 'mma'\n[[optimize.hole]]\nspline = { points = [[[0, 1], [0, 1]], [[0, 1], [0, 1]], "
              "[[0, 1], [0, 1]], [[0, 1], [0, 1]]] }\nstart = { points = [[0.2, 0.2], [0.2, 0.4], [0.4, 0.4]] }",
              "a.toml:19:20: points in start in [[optimize.hole]] has 3 points; the spline has 4"},
        Wrong{"[optimize]\nmethod = 'mma'\n[[optimize.hole]]\nspline = { points = [[[0, 1], [0, 1]], [[0, 1], [0, 1]], "
              "[[0, 1], [0, 1]], [[0, 1], [0, 1]]] }\nstart = { center = [0.9, 0.5], radius = 0.2 }",
              "a.toml:19:9: start in [[optimize.hole]]: x of control point 1 = 1.1 lies outside its box [0, 1]"},
        Wrong{"[optimize]\nmethod = 'mma'\n[[optimize.crack]]\npath = [[0.5, 0.5]]",
              "a.toml:18:8: path in [[optimize.crack]] must be a list of at least 2, not a list of 1"},
        Wrong{"[optimize]\nmethod = 'mma'\n[[optimize.crack]]\npath = [[[0, 1], 0.5], [[0, 1], 0.5]]",
              "a.toml:18:8: path in [[optimize.crack]]: points 1 and 2 begin at the same place, the middle of their "
              "boxes; add start = { path = [[x, y], ...] }"},
        Wrong{
            "[optimize]\nmethod = 'mma'\n[[optimize.crack]]\npath = [[[0, 1], 0.5], [[1, 2], 0.5]]\ncontact = 'bonded'",
            "a.toml:19:11: unknown contact in [[optimize.crack]] \"bonded\"; known: unilateral, open"},
        Wrong{"[optimize]\nmethod = 'mma'\n[[optimize.crack]]\npath = [[[0, 1], 0.5], [[1, 2], 0.5]]\nfriction = 0.1",
              "a.toml:19:1: unknown key \"friction\" in [[optimize.crack]]; known: name, count, path, contact, start"},
        Wrong{"[optimize]\nmethod = 'mma'\n[[optimize.region]]\ncircle = { center = [1, 0.5], radius = 0.1 }\nyoung = "
              "[0, 1]\npoisson = 0.3",
              "a.toml:19:10: entry 1 of young in [[optimize.region]] must be larger than 0, not 0"},
        Wrong{"[optimize]\nmethod = 'mma'\n[[optimize.region]]\ncircle = { center = [1, 0.5], radius = 0.1 }\nyoung = "
              "[1, 2]",
              "a.toml:17:1: missing key \"poisson\" in [[optimize.region]]; add it"},
        Wrong{"[optimize]\nmethod = 'mma'\n[[optimize.region]]\ncircle = { center = [1, 0.5], radius = 0.1 }\nyoung = "
              "[1, 2]\npoisson = 0.6",
              "a.toml:20:11: poisson in [[optimize.region]] must be above -1 and at most 0.5, not 0.6"},
        Wrong{"[optimize]\nmethod = 'mma'\n[optimize.hole]\ncircle = { center = [1, 0.5], radius = 0.1 }",
              "a.toml:17:1: \"hole\" may appear several times; write [[optimize.hole]]"}));

INSTANTIATE_TEST_SUITE_P(
    Bounds, WrongOptimize,
    testing::Values(
        Wrong{
            "[optimize]\nvolume = { at_most = 0.5 }\n[[optimize.bound]]\nkind = 'max_stress'\nexcept = 4\nat_most = 1",
            "a.toml:19:10: except in [[optimize.bound]] must be { ends = 0.01, supports = 0.014 }"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\n[[optimize.bound]]\nkind = 'stress_pnorm'\np = 4",
              "a.toml:17:1: missing key \"at_most\" in [[optimize.bound]]; add it"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\n[[optimize.bound]]\nkind = 'stress_pnorm'\nat_most = 4",
              "a.toml:17:1: kind = \"stress_pnorm\" in [[optimize.bound]] needs the key \"p\"; add it"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\n[[optimize.bound]]\nkind = 'stress_pnom'\np = 4\nat_most = 4",
              "a.toml:18:8: unknown kind in [[optimize.bound]] \"stress_pnom\"; did you mean \"stress_pnorm\"?"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\n[[optimize.bound]]\nkind = 'stress_pnorm'\np = 4\nat_most = -4",
              "a.toml:20:11: at_most in [[optimize.bound]] must be positive: violations are measured relative to it"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\n[[optimize.bound]]\nkind = 'energy'\nat_most = 0",
              "a.toml:19:11: at_most in [[optimize.bound]] must not be 0: violations are measured relative to it"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\n[[optimize.bound]]\nkind = 'misfit'\non = 'right'\nmeasured = "
              "[1, 0]\nat_most = 1",
              "a.toml:17:1: [[optimize.bound]]: a misfit cannot be bounded; minimize it in [functional]"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\n[[optimize.bound]]\nkind = 'volume'\nat_most = 1\nname = "
              "'a'\n[[optimize.bound]]\nkind = 'volume'\nat_most = 1\nname = 'a'",
              "a.toml:24:8: name in [[optimize.bound]]: the name \"a\" is taken; give each its own"},
        Wrong{"[optimize]\nvolume = { at_most = 0.5 }\n[[optimize.bound]]\nkind = 'energy_release_rate'\ncrack = "
              "'c'\ntip = 'end'\nat_most = 1",
              "a.toml:19:9: crack in [[optimize.bound]]: there is no crack \"c\"; the case has none"}));

INSTANTIATE_TEST_SUITE_P(
    Elsewhere, WrongOptimize,
    testing::Values(Wrong{"[synthetic]\nnoise = 0.1",
                          "a.toml:15:1: [synthetic] is not used; write kind = \"misfit\" and measured = \"synthetic\" "
                          "in [functional]"},
                    Wrong{"[[load_case]]\nname = 'a'\n[[load_case.boundary]]\non = 'top'\npressure = 1",
                          "a.toml:14:12: traction in [[boundary]]: with [[load_case]] all loads belong to load cases; "
                          "move it to each load case in which it acts"}));

}  // namespace
}  // namespace kerf::optimize_test
