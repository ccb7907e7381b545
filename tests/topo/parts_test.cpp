// Functionals, adjoints and maps of a body that several processes have in parts: as one process has them. The
// processes are threads.

#include "geometry/mesh_part.hpp"
#include "kerf/map.hpp"
#include "kerf/mesher.hpp"
#include "solver/system.hpp"
#include "solver/tangent_cone.hpp"
#include "tests/support/communicator.hpp"
#include "topo/analysis.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf::parts_test {
namespace {

/// The unit square, held on its left side, with a crack, a disc of another material and loads that open a part of the
/// crack and close the rest.
struct Body {
  double poisson = 0.3;
  Element element = bdms(1);
  CrackLaw law = {.kind = CrackLaw::Kind::Unilateral};
  bool body_force = false, pulled = false;  // on the right side, by a displacement
  bool rests = false;                       // drawn along its crack, whose faces only touch
};

constexpr Index right = 1, top = 2, left = 3;
const Perturbation hole{};
const std::vector<Vec2> points{{0.21, 0.3}, {0.5, 0.24}, {0.497, 0.747}, {0.503, 0.82}, {0.88, 0.13}, {0.13, 0.88}};

Mesh mesh_of(const Body& b) {
  Shape shape{.outline = polygon("outline", {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, 0),
              .holes = {},
              .cracks = {{"c", {{0.3, b.rests ? 0.48 : 0.55}, {0.75, 0.48}}, {}}},
              .labels = {"bottom", "right", "top", "left"},
              .regions = {circle("disc", {0.8, 0.75}, 0.1, none)}};
  for (Index side = 0; side < 4; ++side) shape.outline.sides[static_cast<std::size_t>(side)].label = side;
  return triangulate(shape, {.size = 0.15, .crack_tip_size = 0.06});
}

Scene scene_of(const Body& b) {
  const BoundaryField nothing = [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); };
  Scene s;
  s.material = plane_strain(1, b.poisson);
  s.regions = {plane_strain(3, 0.3)};
  s.supports = {{left, false, true, true, nothing}};
  if (b.pulled)
    s.supports.push_back(
        {right, false, true, true, [](const Vec2& x, const Vec2&) { return Vec2(0.1, 0.03 * x.y()); }});
  s.tractions = {{top, [](const Vec2& x, const Vec2&) { return Vec2(0.2, 12 * (x.x() - 0.55)); }}};
  if (b.rests) {
    s.material = plane_strain(1, 0);
    s.regions = {s.material};
    s.tractions = {{right, [](const Vec2&, const Vec2&) { return Vec2(1, 0); }}};
  }
  if (b.body_force) s.body = [](const Vec2& x) { return Vec2(x.y(), -1); };
  s.laws = {b.law};
  return s;
}

struct Found {
  double value = 0, biactive_length = 0;
  std::size_t one_sided = 0;
  std::vector<double> T;
  std::size_t sliding = 0;  // points, of one process
};

Found by_one(const Body& b, const Functional& j, const Perturbation& p) {
  const Model m = prepare(refine(mesh_of(b)), b.element, scene_of(b), 1);
  const State state = solve(m);
  EXPECT_TRUE(certified(state));
  const Analysis a = analyze(j, m, state);
  Found found{a.value, a.biactive_length, a.biactive ? a.biactive->response.size() : 0, {}};
  for (const MapPoint& at : map_at(a, j, {.perturbation = p, .radius = 0.01}, points)) found.T.push_back(at.value);
  found.sliding = tangent_cone(m, state).sliding.size();
  return found;
}

/// In four squares.
Found in_parts(const Body& b, const Functional& j, const Perturbation& p) {
  const Mesh coarse = mesh_of(b);
  std::vector<Index> process;
  for (Index t = 0; t < static_cast<Index>(coarse.triangles.size()); ++t) {
    const Vec2 x = centroid(coarse, t);
    process.push_back((x.x() > 0.5 ? 2 : 0) + (x.y() > 0.5 ? 1 : 0));
  }
  Found found;
  test::on_peers(4, [&](Communicator& comm) {
    const std::vector<Index> pieces = pieces_for_pressure(coarse, scene_of(b));
    const MeshPart part = mesh_part(coarse, process, comm.count(), comm.here(), 1);
    const auto make = [&](Scene scene) {
      return std::make_shared<SharedBody>(part, b.element, std::move(scene), 1, Floating{}, pieces, comm);
    };
    const auto body = make(scene_of(b));
    const State state = body->solve({}, true);
    const MeasuredBody measured = [&](const Support& given) {
      const auto other = make(measured_scene(scene_of(b), given));
      return std::pair(std::shared_ptr<const Model>(other, &other->model()),
                       std::make_shared<const State>(other->solve()));
    };
    const Analysis a = analyze(j, body->model(), state, whole_body(*body, state, comm, measured), false);
    std::vector<Index> where = locate(body->model().mesh, points);
    const std::vector<MapPoint> map = map_at(a, j, {.perturbation = p, .radius = 0.01}, points);
    std::vector<double> sums(points.size()), counts(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
      if (where[i] != none && where[i] < own_triangles(body->model())) {
        sums[i] = map[i].value;
        counts[i] = 1;
      }
    comm.sum(sums);
    comm.sum(counts);
    if (comm.here() != 0) return;
    found = {a.value, a.biactive_length, a.biactive ? a.biactive->response.size() : 0, {}};
    for (std::size_t i = 0; i < points.size(); ++i) found.T.push_back(sums[i] / counts[i]);
  });
  return found;
}

Found expect_same(const Body& b, const Functional& j, const Perturbation& p, const std::string& what,
                  double within = 1e-9) {
  const Found found = in_parts(b, j, p), truth = by_one(b, j, p);
  EXPECT_NEAR(found.value, truth.value, within * std::abs(truth.value)) << what;
  EXPECT_NEAR(found.biactive_length, truth.biactive_length, 1e-12) << what;
  EXPECT_EQ(found.one_sided, truth.one_sided) << what;
  double largest = 0;
  for (const double T : truth.T) largest = std::max(largest, std::abs(T));
  EXPECT_GT(largest, 0) << what;
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_NEAR(found.T[i], truth.T[i], within * largest) << what << ", point " << i;
  return truth;
}

Functional of(Term term) {
  Functional j{.kind = term.kind, .terms = {}};
  j.terms.push_back(std::move(term));
  return j;
}

const ScalarField beside = [](const Vec2& x) { return 1 + x.x(); };
const BoundaryWeight along_side = [](const Vec2& x, const Vec2&) { return 1 + x.y(); };
const VectorField target = [](const Vec2& x) -> Vec2 { return {0.1 * x.y(), -0.2}; };
const BoundaryField target_on_side = [](const Vec2& x, const Vec2&) -> Vec2 { return {0.1 * x.y(), -0.2}; };
const BoundaryField upward = [](const Vec2&, const Vec2&) -> Vec2 { return {0.3, 1}; };

TEST(Parts, FunctionalsAndTheirMaps) {
  const Body b{.body_force = true};
  expect_same(b, of(boundary_displacement(right, upward, along_side)), hole, "boundary_displacement");
  expect_same(b, of(boundary_tracking(right, target_on_side, along_side)), hole, "boundary_tracking");
  expect_same(b, of(displacement_tracking(target, beside)), hole, "displacement_tracking");
  expect_same(b, of(stress_pnorm(3, beside, true)), hole, "stress_pnorm");
  expect_same(b, of(crack_opening(0, beside)), hole, "crack_opening");
  expect_same(b, of(crack_pressure(0, beside, beside)), hole, "crack_pressure");
  expect_same(b, of(volume()), hole, "volume");
  expect_same(b, of(compliance()), hole, "compliance");
}

TEST(Parts, AdjointsOfAnyMaterialAndDegree) {
  for (const auto& [poisson, element] :
       {std::pair(0.4999, bdms(1)), std::pair(0.5, bdms(1)), std::pair(0.3, bdms(2)), std::pair(0.3, afw(1))}) {
    const Body b{.poisson = poisson, .element = element};
    const std::string what = "nu " + std::to_string(poisson) + ", degree " + std::to_string(element.degree);
    expect_same(b, of(boundary_tracking(right, target_on_side, along_side)), hole, what, 1e-8);
  }
}

TEST(Parts, CompliancesOfPrescribedDisplacements) {
  const Body b{.body_force = true, .pulled = true};
  expect_same(b, of(compliance()), hole, "compliance");
  Functional sum{.kind = "sum", .terms = {compliance(), energy(), volume()}, .sum = true};
  sum.terms[1].factor = -0.7;
  sum.terms[2].factor = 3;
  expect_same(b, sum, hole, "a sum");
}

TEST(Parts, Misfits) {
  expect_same({}, of(misfit(top, target_on_side)), hole, "misfit");
}

// The dual jumps of closed points follow the slips: an unsymmetric problem.
TEST(Parts, FrictionalFaces) {
  for (const CrackLaw& law : {CrackLaw{.kind = CrackLaw::Kind::Unilateral, .friction = 0.4},
                              CrackLaw{.kind = CrackLaw::Kind::Unilateral, .friction = 0.2, .slip_bound = 0.05}}) {
    const Body b{.law = law, .body_force = true};
    EXPECT_GT(expect_same(b, of(energy()), hole, "energy", 1e-8).sliding, 3u);
    expect_same(b, of(boundary_tracking(right, target_on_side, along_side)), hole, "boundary_tracking", 1e-8);
    expect_same(b, of(crack_pressure(0, beside, beside)), hole, "crack_pressure", 1e-8);
  }
}

// Faces that touch without a pressure: derivatives are one-sided.
TEST(Parts, FacesThatOnlyTouch) {
  const Body b{.rests = true};
  const Functional j = of(boundary_tracking(right, target_on_side, along_side));
  EXPECT_GT(expect_same(b, j, hole, "touching").one_sided, 5u);
}

}  // namespace
}  // namespace kerf::parts_test
