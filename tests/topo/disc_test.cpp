// The exact disc cases of tests/data/topological_derivatives.json once more, by the program itself: J of the disc with
// its hole, clamp or inclusion meshed, and T at the center of the full disc.

#include "kerf/map.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>
#include <map>

namespace kerf::disc_test {
namespace {

using nlohmann::json;

double number(const json& j) {
  return std::stod(j.get<std::string>());
}
Mat2 tensor(const json& j) {
  return (Mat2() << j[0], j[2], j[2], j[1]).finished();
}
Mat2 diagonal(double xx, double yy) {
  return Vec2(xx, yy).asDiagonal();
}

constexpr Index rim = 0, hole = 1;
BoundaryField linear(const Mat2& gradient) {
  return [=](const Vec2& x, const Vec2&) -> Vec2 { return gradient * x; };
}
BoundaryField constant(const Vec2& u) {
  return [=](const Vec2&, const Vec2&) { return u; };
}

enum class Inside { Same, Hole, Other };

// A case of the file: the loads on the disc, its functional, what the small change is.
struct Case {
  std::string name;
  bool strain;
  json data;
  Material matrix, other;
  Scene scene;
  Functional functional;
  Inside inside = Inside::Hole;
  Perturbation change;

  Material material(double young, double poisson) const {
    return strain ? plane_strain(young, poisson) : plane_stress(young, poisson);
  }
  bool has(const char* part) const {
    return name.find(part) != std::string::npos;
  }

  explicit Case(const json& c) : name(c.at("name")), strain(c.at("problem").at("plane") == "strain"), data(c) {
    const json& p = c.at("problem");
    matrix = material(p.at("E"), p.at("nu"));
    scene.material = matrix;
    const auto held = [&](Index label, BoundaryField u) {
      scene.supports.push_back({label, false, true, true, std::move(u)});
    };
    const auto pulled = [&](const Mat2& s) {
      scene.tractions.push_back({rim, [=](const Vec2&, const Vec2& n) -> Vec2 { return s * n; }});
    };
    if (p.contains("sigma_bar")) pulled(tensor(p.at("sigma_bar")));
    if (p.contains("E_bar")) held(rim, linear(tensor(p.at("E_bar"))));
    if (p.contains("u0")) held(rim, constant({p.at("u0").get<double>(), 0}));
    if (p.contains("body_force")) {
      const Vec2 b(p.at("body_force")[0], p.at("body_force")[1]);
      scene.body = [=](const Vec2&) { return b; };
      held(rim, constant(Vec2::Zero()));
    }
    if (has("kohn_vogelius")) pulled(diagonal(1.2, 0.2));
    if (has("clamped")) {
      held(hole, constant(Vec2::Zero()));
      // Its center does not move: like a rigid inclusion.
      change = {Perturbation::Kind::Inclusion, {1e12 * matrix.mu, 1e-12 * matrix.c}};
    }
    if (has("inclusion")) {
      inside = Inside::Other;
      other = material(p.at("E_star"), p.at("nu_star"));
      change = {Perturbation::Kind::Inclusion, other};
    }
    functional.terms = {term()};
  }

  double truth(double eps) const {
    if (data.contains("values")) {
      for (const json& v : data.at("values"))
        if (v.at("eps") == eps) return number(v.at("J"));
    } else {
      for (std::size_t i = 0; i < data.at("eps").size(); ++i)
        if (data.at("eps")[i] == eps) return number(data.at("J")[i]);
    }
    throw std::invalid_argument("no such radius");
  }

 private:
  Term term() const {
    if (has("boundary_L2")) return boundary_tracking(rim, {}, {});
    if (has("domain_L2")) return displacement_tracking({}, {});
    if (has("kohn_vogelius")) return misfit(rim, linear(diagonal(0.5, 0.1)));
    const auto at = name.find("vonMises_p");
    if (at != std::string::npos) return stress_power(std::stod(name.substr(at + 10)), {}, strain);
    return has("compliance") ? compliance() : energy();
  }
};

std::vector<Case> cases() {
  std::vector<Case> all;
  const json file = json::parse(std::ifstream(std::string(KERF_TEST_DATA) + "/topological_derivatives.json"));
  for (const json& c : file.at("exact")) all.emplace_back(c);
  return all;
}

const Mesh& disc(Inside inside, double eps, double size) {
  static std::map<std::tuple<Inside, double, double>, Mesh> made;
  const auto key = std::tuple(inside, eps, size);
  if (const auto found = made.find(key); found != made.end()) return found->second;
  Shape s;
  s.labels = {"rim", "hole"};
  s.outline = circle("rim", Vec2::Zero(), 1, rim);
  if (inside == Inside::Hole) s.holes = {circle("hole", Vec2::Zero(), eps, hole)};
  if (inside == Inside::Other) s.regions = {circle("inclusion", Vec2::Zero(), eps, none)};
  return made.emplace(key, triangulate(s, {.size = size})).first->second;
}

double value(const Case& c, Inside inside, double eps, double size) {
  Scene scene = c.scene;
  if (inside == Inside::Other) scene.regions = {c.other};
  if (inside != Inside::Hole) std::erase_if(scene.supports, [](const Support& s) { return s.label == hole; });
  const Model m = prepare(disc(inside, eps, size), element("bdms", 2), scene, 2);
  const State s = solve(m);
  EXPECT_TRUE(certified(s));
  return analyze(c.functional, m, s, true).value;
}

double coefficient(const Case& c, double size) {
  Scene scene = c.scene;
  std::erase_if(scene.supports, [](const Support& s) { return s.label == hole; });
  const Model m = prepare(disc(Inside::Same, 0, size), element("bdms", 1), scene, 2);
  const State s = solve(m);
  EXPECT_TRUE(certified(s));
  const std::vector<Vec2> center = {Vec2::Zero()};
  return map_at(analyze(c.functional, m, s), c.functional, {.perturbation = c.change}, center)[0].value;
}

// The hole is a polygon of the right area, at any size of the other edges: it costs up to 7e-4 of the change of J, for
// the sixth power of the stress more.
TEST(Disc, ValuesWithTheChangeMeshed) {
  int count = 0;
  for (const Case& c : cases())
    for (const double eps : {0.2, 0.1}) {
      SCOPED_TRACE(c.name + (c.strain ? ", plane strain, " : ", plane stress, ") + std::to_string(eps));
      const double whole = c.data.contains("J0") ? number(c.data.at("J0")) : 0, j = value(c, c.inside, eps, 0.1),
                   truth = c.truth(eps);
      double allowed = (c.has("p6") ? 5e-3 : 8e-4) * std::abs(truth - whole);
      if (c.has("boundary_L2")) allowed = 6e-4 * truth;  // the outer polygon
      EXPECT_NEAR(j, truth, allowed);
      ++count;
    }
  EXPECT_EQ(count, 64);
}

// Stresses and adjoint stresses of most cases are uniform: no discretization error. The others converge, where the
// data are given on the curved rim with the order 2 of the polygon.
TEST(Disc, CoefficientsAtThreeRefinements) {
  int count = 0;
  for (const Case& c : cases()) {
    if (!c.data.contains("T")) continue;
    SCOPED_TRACE(c.name + (c.strain ? ", plane strain" : ", plane stress"));
    const double truth = number(c.data.at("T"));
    std::vector<double> error;
    for (const double size : {0.2, 0.1, 0.05}) error.push_back(std::abs(coefficient(c, size) / truth - 1));
    const double order = std::log2(error[0] / error[2]) / 2;
    if (c.has("L2_track")) {
      EXPECT_LT(error[2], c.has("boundary") ? 1.2e-4 : 2.5e-4);
      EXPECT_GT(order, 1.8);
    } else if (c.has("body_force")) {
      EXPECT_LT(error[2], 5e-8);
      EXPECT_GT(order, 3.5);
    } else {
      EXPECT_LT(error[2], 1e-11);
    }
    ++count;
  }
  EXPECT_EQ(count, 28);
}

}  // namespace
}  // namespace kerf::disc_test
