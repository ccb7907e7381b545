// Bounds of quantities where contact changes: small problems of contact whose sets are all enumerated, exact fields of
// cracks that close in part, and bounds on finer meshes.

#include "base/quadrature.hpp"
#include "kerf/bounds.hpp"
#include "kerf/fracture.hpp"
#include "solver/bounds/dual.hpp"
#include "solver/bounds/faces.hpp"
#include "solver/bounds/load_steps.hpp"
#include "solver/data.hpp"
#include "tests/solver/exact_crack.hpp"
#include "tests/support/exact.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include <cmath>

namespace kerf::contact_bounds_test {
namespace {

using Theorem = ContactQuantityBounds::Theorem;

// Five unknowns of which the first `rows` must not be negative: J(k) = min 1/2 x'A x - (L + k l)'x. The set is found by
// trying all of them.
struct Small {
  static constexpr int size = 5, rows = 3;
  using Vector = Eigen::Matrix<double, size, 1>;
  Eigen::Matrix<double, size, size> A;
  Vector L, l;

  // A body like the others: numbers without a pattern, from their own counter.
  explicit Small(int which) {
    auto number = [&, at = 0]() mutable { return std::sin(12.9898 * which + 78.233 * ++at); };
    for (int i = 0; i < size; ++i)
      for (int j = 0; j < size; ++j) A(i, j) = number();
    A = (A * A.transpose()).eval();
    A.diagonal().array() += 0.3;
    for (int i = 0; i < size; ++i) {
      L[i] = number();
      l[i] = number();
    }
  }

  Vector held(unsigned set, const Vector& load) const {  // the rows of the set at 0
    Eigen::Matrix<double, size, size> B = A;
    Vector b = load;
    for (int i = 0; i < rows; ++i) {
      if (!(set >> i & 1)) continue;
      B.row(i).setZero();
      B.col(i).setZero();
      B(i, i) = 1;
      b[i] = 0;
    }
    return B.ldlt().solve(b);
  }
  Vector solve(double k) const {
    const Vector load = L + k * l;
    for (unsigned set = 0; set < 1u << rows; ++set) {
      const Vector x = held(set, load), p = A * x - load;
      if (x.head<rows>().minCoeff() >= -1e-13 && p.head<rows>().minCoeff() >= -1e-12) return x;
    }
    throw std::logic_error("no set of contact");
  }
  double energy(const Vector& x, const Vector& load) const {
    return 0.5 * x.dot(A * x) - load.dot(x);
  }
  double energy(double k) const {
    return energy(solve(k), L + k * l);
  }
  double work(double pressing, double opening) const {
    const Vector p = A * solve(pressing) - L - pressing * l;
    return p.head<rows>().dot(solve(opening).head<rows>());
  }
  LoadSteps steps(double k) const {
    const double less = energy(-k), more = energy(k);
    return {k, {less, less}, {more, more}, work(-k, k), work(k, -k)};
  }
  Curvature curvature() const {
    return {energy(held(0, l), l), energy(held((1u << rows) - 1, l), l)};
  }
};

bool contains(const Interval& i, double value, double rounding = 1e-10) {
  return i.low - rounding <= value && value <= i.high + rounding;
}

// With exact energies whatever is left of the width is the theorems' own: their terms can neither be missing nor be
// taken with the wrong sign or for one another.
TEST(LoadSteps, ContainTheQuantityOfSmallContactProblems) {
  int changing = 0;
  std::array<int, 6> broken{};
  for (int which = 0; which < 400; ++which) {
    const Small small(which);
    const double exact = small.l.dot(small.solve(0));
    for (const double k : {0.05, 0.4, 3.0}) {
      const LoadSteps s = small.steps(k);
      const Enclosed zero{small.energy(0), small.energy(0)};
      const Curvature c = small.curvature();
      EXPECT_LE(c.open, c.tied + 1e-12);
      EXPECT_TRUE(contains(by_concavity(s, zero, c), exact)) << which << " " << k;
      EXPECT_TRUE(contains(by_crossed_works(s), exact)) << which << " " << k;
      if (s.less_on_more + s.more_on_less > 1e-6) ++changing;
      LoadSteps without = s, swapped = s, turned = s;
      without.less_on_more = without.more_on_less = 0;
      std::swap(swapped.less_on_more, swapped.more_on_less);
      std::swap(turned.less, turned.more);
      broken[0] += !contains(by_concavity(s, zero, {c.tied, c.tied}), exact);
      broken[1] += !contains(by_concavity(s, zero, {c.open, c.open}), exact);
      broken[2] += !contains(by_concavity(turned, zero, c), exact);
      broken[3] += !contains(by_crossed_works(without), exact);
      broken[4] += !contains(by_crossed_works(swapped), exact);
      broken[5] += !contains(by_crossed_works(turned), exact);
    }
  }
  EXPECT_GT(changing, 300);
  for (const int count : broken) EXPECT_GT(count, 50);
}

// A spring of stiffness a behind a stop, x >= 0, pushed against it by L + k l, beside one without a stop that stores
// `free` k^2: whatever can be known is found.
TEST(LoadSteps, AreSharpForASpringBehindAStop) {
  constexpr double a = 2, l = 3, k = 0.25, free = 1.7;
  for (const double L : {-5.0, 0.0, 5.0}) {  // it stays closed, it opens for k > 0, it stays open
    const auto opening = [&](double step) { return std::max(L + step * l, 0.0) / a; };
    const auto pressure = [&](double step) { return std::max(-L - step * l, 0.0); };
    const auto energy = [&](double step) {
      const double value = -0.5 * a * std::pow(opening(step), 2) - free * step * step;
      return Enclosed{value, value};
    };
    const LoadSteps s{k, energy(-k), energy(k), pressure(-k) * opening(k), pressure(k) * opening(-k)};
    const Curvature c{-0.5 * l * l / a - free, -free};
    const double exact = l * opening(0);
    const Interval one = by_concavity(s, energy(0), c), two = by_crossed_works(s);
    EXPECT_TRUE(contains(one, exact, 1e-13) && contains(two, exact, 1e-13)) << L;
    if (L != 0) {
      EXPECT_NEAR(one.high - one.low, 0, 1e-13) << L;
      EXPECT_NEAR(two.high - two.low, 0, 1e-13) << L;
      continue;
    }
    // J is -k^2 l^2/(2a) on one side and 0 on the other: every chord ends at the true value.
    EXPECT_NEAR(one.low, 0, 1e-13);
    EXPECT_NEAR(one.high, 0.5 * k * l * l / a, 1e-13);
  }
}

CrackProblem touching_crack(const exact::ExactField& f, int n, int degree, const std::vector<Index>& held,
                            const char* name = "bdms") {
  return crack_problem(f, n, degree, held, CrackLaw::Kind::Unilateral, name);
}

// int t.u over a label, of the exact field.
double exact_work(const CrackProblem& p, Index label, const BoundaryField& t) {
  const EdgeRule rule = gauss(24);
  double work = 0;
  for (Index e = 0; e < static_cast<Index>(p.model.mesh.edges.size()); ++e) {
    if (p.model.mesh.label[e] != label) continue;
    const EdgeLine line = edge_line(p.model.mesh, e);
    for (Eigen::Index q = 0; q < rule.s.size(); ++q) {
      const Vec2 x = line.a + rule.s[q] * (line.b - line.a);
      work +=
          length(p.model.mesh, e) * rule.w[q] * t(x, line.n).dot(p.exact.displacement(x, exact::side_of(p.exact, x)));
    }
  }
  return work;
}

double half_width(const Bounded& b) {
  return 0.5 * (b.upper - b.lower);
}

void expect_contains(const Bounded& b, double exact, const std::string& which) {
  EXPECT_LE(b.lower, exact) << which << " " << b.note;
  EXPECT_GE(b.upper, exact) << which << " " << b.note;
  EXPECT_TRUE(b.guaranteed) << which << " " << b.note;
}

BoundaryField along(int k) {
  return [k](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Unit(k); };
}

std::vector<exact::ExactField> closing() {
  const Material m = plane_strain(10, 0.2);
  return {exact::table_field("c05_partial_linear", 0.3),
          exact::table_field("c05c_lens", 0.3),
          exact::table_field("c04_inclined_closed", 0.3),
          exact::table_field("c03_inclined_open", 0.3),
          exact::line_crack("turned", m, {.angle = 0.4, .p0 = 0.2, .p1 = -0.9, .s_tt = 0.3, .s_tn = 0.5}),
          exact::line_crack("nearly closed", m, {.angle = -0.7, .p0 = -0.6, .p1 = 0.8, .s_tt = -0.4, .s_tn = 0.2})};
}

std::array<Bounded, 3> components(const StressBounds& s) {
  return {s.s11, s.s22, s.s12};
}

void expect_stresses(const CrackProblem& p, Theorem by, const std::string& which) {
  const ContactQuantityBounds bounds(p.model, p.state, by);
  const Vec2 x(0.2, 1.1);
  const auto s = components(bounds.stress(x));
  const Mat2 exact = p.exact.stress(x, exact::side_of(p.exact, x));
  expect_contains(s[0], exact(0, 0), which + " s11");
  expect_contains(s[1], exact(1, 1), which + " s22");
  expect_contains(s[2], exact(0, 1), which + " s12");
}

void expect_works(const CrackProblem& p, Theorem by, const std::string& which) {
  const ContactQuantityBounds bounds(p.model, p.state, by);
  for (const int k : {0, 1})
    expect_contains(bounds.work({{2, along(k)}}), exact_work(p, 2, along(k)), fmt::format("{} component {}", which, k));
}

TEST(ContactQuantityBounds, ContainStressesOfCracksThatCloseInPart) {
  int partly = 0;
  for (const exact::ExactField& f : closing()) {
    partly += !f.transitions.empty();
    expect_stresses(touching_crack(f, 8, 1, {}), Theorem::CrossedWorks, f.name);
  }
  EXPECT_EQ(partly, 4);
}

TEST(ContactQuantityBounds, ContainStressesBesideSupportsAndOfOtherElements) {
  for (const exact::ExactField& f : {closing()[0], closing()[4]}) {
    expect_stresses(touching_crack(f, 8, 1, {0, 3}), Theorem::Concavity, f.name + " first theorem");
    expect_stresses(touching_crack(f, 8, 1, {0, 3}), Theorem::CrossedWorks, f.name + " second theorem");
  }
  expect_stresses(touching_crack(closing()[0], 8, 2, {}), Theorem::CrossedWorks, "degree 2");
  expect_stresses(touching_crack(closing()[1], 8, 1, {}, "afw"), Theorem::CrossedWorks, "afw");
}

TEST(ContactQuantityBounds, ContainWorksOnTheBoundary) {
  for (const exact::ExactField& f : closing()) {
    const CrackProblem p = touching_crack(f, 8, 1, {0});
    expect_works(p, Theorem::CrossedWorks, f.name + " second theorem");
    expect_works(p, Theorem::Concavity, f.name + " first theorem");
  }
}

// Of the half width of the mean displacement across the crack, from 128 to 2,048 triangles, in the gap of the energy
// [theory: B.19].
double order(const char* id, Theorem by) {
  std::array<double, 2> gap, width;
  for (const int i : {0, 1}) {
    const CrackProblem p = touching_crack(exact::table_field(id, 0.3), i == 0 ? 8 : 32, 1, {0});
    const EnergyBounds energy = energy_bounds(p.model, p.state);
    gap[i] = energy.upper - energy.lower;
    width[i] = half_width(ContactQuantityBounds(p.model, p.state, by).work({{2, along(1)}}));
  }
  return std::log(width[0] / width[1]) / std::log(gap[0] / gap[1]);
}

TEST(ContactQuantityBounds, CloseInHalfTheOrderOfTheGapByConcavity) {
  EXPECT_NEAR(order("c05_partial_linear", Theorem::Concavity), 0.5, 0.1);
}

TEST(ContactQuantityBounds, CloseFasterByCrossedWorks) {
  constexpr double theory = 2.0 / 3;
  for (const char* id : {"c05_partial_linear", "c05c_lens"}) {
    const double found = order(id, Theorem::CrossedWorks);
    EXPECT_GT(found, theory - 0.05) << id;
    EXPECT_LT(found, theory + 0.2) << id;
  }
}

TEST(ContactQuantityBounds, CloseAsTheGapWhereNoEndOfContactMoves) {
  for (const char* id : {"c04_inclined_closed", "c03_inclined_open"})
    EXPECT_NEAR(order(id, Theorem::CrossedWorks), 1, 0.15) << id;
}

// Where nothing is closed the crossed works vanish, and the interval is that of superposed loads.
TEST(ContactQuantityBounds, OfAnOpenCrackAreThoseOfSuperposedLoads) {
  const exact::ExactField f = exact::table_field("c01_modeI", 0.3);
  const Vec2 x(0.3, 0.9);
  const CrackProblem open = crack_problem(f, 16, 1, {0}), contact = touching_crack(f, 16, 1, {0});
  const auto by_superposition = components(QuantityBounds(open.model, open.state).stress(x));
  const auto by_works = components(ContactQuantityBounds(contact.model, contact.state).stress(x));
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(half_width(by_works[i]), 1.25 * half_width(by_superposition[i])) << i;
    EXPECT_GT(half_width(by_works[i]), 0.95 * half_width(by_superposition[i])) << i;
  }
}

// A uniform fluid pressure in the crack, taken off the tractions, changes the stress by as much and nothing else
// [theory: C.17]: not the contact, and so no width.
TEST(ContactQuantityBounds, ShiftUnderAUniformFluidPressure) {
  const double fluid = 0.7;
  const exact::ExactField f = closing()[4];
  const CrackProblem p = touching_crack(f, 8, 1, {});
  Scene dry = p.model.scene, wet = dry;
  dry.laws[0].pressure = [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); };
  for (Traction& t : wet.tractions)
    t.value = [given = t.value, fluid](const Vec2& x, const Vec2& n) -> Vec2 { return given(x, n) - fluid * n; };
  wet.laws[0].pressure = [fluid](const Vec2&, const Vec2&) -> Vec2 { return {fluid, 0}; };
  const auto bounds = [&](const Scene& scene) {
    const Model m = prepare(p.model.mesh, element("bdms"), scene, 1);
    const State state = solve(m);
    return components(ContactQuantityBounds(m, state).stress({0.2, 1.1}));
  };
  const auto one = bounds(dry), two = bounds(wet);
  for (int i = 0; i < 3; ++i) {
    const double shift = i < 2 ? fluid : 0;
    EXPECT_NEAR(two[i].lower + shift, one[i].lower, 1e-6 * half_width(one[i])) << i;
    EXPECT_NEAR(two[i].upper + shift, one[i].upper, 1e-6 * half_width(one[i])) << i;
  }
}

// No exact solution: bounds on finer meshes lie in those on coarser ones, nearly.
TEST(ContactQuantityBounds, HoldForBodyForcesSeveralMaterialsAndAlmostNoCompressibility) {
  const exact::ExactField f = exact::table_field("c05_partial_linear", 0.3);
  CrackProblem p = touching_crack(f, 8, 1, {0});
  Mesh mesh = p.model.mesh;
  mesh.region.assign(mesh.triangles.size(), none);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (centroid(mesh, static_cast<Index>(t)).y() > 0) mesh.region[t] = 0;
  Scene scene;
  scene.material = plane_strain(3, 0.4999);
  scene.regions = {plane_stress(1, 0.3)};
  scene.body = [](const Vec2& x) -> Vec2 { return {0.1, -0.2 * x.x()}; };
  scene.supports.push_back({0, false, true, true, [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); }});
  scene.tractions.push_back({2, [](const Vec2& x, const Vec2&) -> Vec2 { return {0.2, x.x()}; }});
  scene.laws.resize(1);
  std::vector<std::array<Bounded, 2>> of;
  for (int level = 0; level < 2; ++level, mesh = refine(mesh)) {
    const Model m = prepare(mesh, element("bdms", 2), scene, 1);
    const State state = solve(m);
    of.push_back({ContactQuantityBounds(m, state).work({{2, along(1)}}),
                  ContactQuantityBounds(m, state, Theorem::Concavity).work({{2, along(1)}})});
  }
  for (const Bounded& coarse : of[0])
    for (const Bounded& fine : of[1]) {
      EXPECT_TRUE(coarse.guaranteed && fine.guaranteed) << coarse.note << fine.note;
      EXPECT_LE(std::max(coarse.lower, fine.lower), std::min(coarse.upper, fine.upper));
    }
  EXPECT_LT(half_width(of[1][0]), 0.7 * half_width(of[0][0]));  // the gap is halved: 2^(-2/3) in theory
}

// Long steps change the set of contact: without the crossed works the interval misses the truth.
TEST(ContactQuantityBounds, NeedTheCrossedWorks) {
  const CrackProblem p = touching_crack(exact::table_field("c05_partial_linear", 0.3), 32, 2, {0});
  Scene pull = p.model.scene;
  pull.tractions = {{2, along(1)}};
  for (Support& support : pull.supports) support.value = [](const Vec2&, const Vec2&) -> Vec2 { return Vec2::Zero(); };
  LoadSteps s{.k = 1};
  std::array<FaceFields, 2> faces;
  for (const int side : {0, 1}) {
    const Scene scene = superposed(p.model.scene, pull, side == 0 ? -s.k : s.k);
    const Model m = prepare(p.model.mesh, element("bdms", 2), scene, 1);
    const EnergyBounds b = energy_bounds(m, solve(m), faces[side]);
    (side == 0 ? s.less : s.more) = {b.lower, b.upper};
    EXPECT_GE(faces[side].pressure.minCoeff(), -1e-12);
    EXPECT_GE(faces[side].opening.minCoeff(), -1e-15);
  }
  s.less_on_more = crossed_work(faces[0], faces[1]);
  s.more_on_less = crossed_work(faces[1], faces[0]);
  const double exact = exact_work(p, 2, along(1));
  EXPECT_TRUE(contains(by_crossed_works(s), exact, 0));
  s.less_on_more = s.more_on_less = 0;
  EXPECT_FALSE(contains(by_crossed_works(s), exact, 0));
}

TEST(ContactQuantityBounds, SayWhyThereAreNone) {
  const exact::ExactField f = exact::table_field("c05_partial_linear", 0.3);
  CrackProblem p = touching_crack(f, 8, 1, {0});
  const ContactQuantityBounds bounds(p.model, p.state);
  EXPECT_EQ(components(bounds.stress({9, 9}))[0].note, "no bounds: the point lies outside the body");
  const Bounded beside = components(bounds.stress({0.05, 0.05}))[1];
  EXPECT_FALSE(beside.guaranteed);
  EXPECT_NE(beside.note.find("coarse"), std::string::npos) << beside.note;
  // K is refused by name, whatever is asked.
  const QuantityBounds all(p.model, p.state);
  for (const TipIntensity& tip : crack_tips(p.model, p.state))
    for (const TipBounds k = all.tip(tip); const Bounded& b : {k.K_I, k.K_II, k.G}) {
      EXPECT_TRUE(std::isnan(b.lower) && !b.guaranteed);
      EXPECT_EQ(b.note, "no bounds: a crack may be in contact");
    }
  Scene rough = p.model.scene;
  rough.laws[0].friction = 0.3;
  const Model slipping = prepare(p.model.mesh, element("bdms"), rough, 1);
  const State state = solve(slipping);
  const Bounded none = ContactQuantityBounds(slipping, state).work({{2, along(1)}});
  EXPECT_TRUE(std::isnan(none.lower) && !none.guaranteed);
  EXPECT_EQ(none.note, "no bounds: with friction the solution does not minimize an energy");
  EXPECT_EQ(QuantityBounds(slipping, state).stress({0.3, 0.9}).s11.note, none.note);
  // A mean displacement of a body that floats is none of its quantities.
  const CrackProblem floating = touching_crack(f, 8, 1, {});
  const Bounded drift = ContactQuantityBounds(floating.model, floating.state).work({{2, along(1)}});
  EXPECT_TRUE(std::isnan(drift.lower) && !drift.guaranteed);
  EXPECT_NE(drift.note.find("nothing holds the body"), std::string::npos) << drift.note;
}

}  // namespace
}  // namespace kerf::contact_bounds_test
