// Every exact case of tests/data/topological_derivatives.json: discs with a small change at the center, where state and
// adjoint of the full disc are known by hand. J to 20 digits, T to 1e-12.

#include "topo/formulas/clamped_hole.hpp"
#include "topo/formulas/von_mises.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>
#include <numbers>

namespace kerf::exact_disc_test {
namespace {

using nlohmann::json;

constexpr long double exact_pi = std::numbers::pi_v<long double>;

long double number(const json& j) {
  return std::strtold(j.get<std::string>().c_str(), nullptr);
}

std::vector<json> cases() {
  std::ifstream file(std::string(KERF_TEST_DATA) + "/topological_derivatives.json");
  return json::parse(file).at("exact").get<std::vector<json>>();
}

Mat2 tensor(double xx, double yy, double xy) {
  Mat2 s;
  s << xx, xy, xy, yy;
  return s;
}
Mat2 tensor(const json& j) {
  return tensor(j[0], j[1], j[2]);
}

Mat2 stress_of(const Material& m, const Mat2& e) {
  const Mat2 mean = 0.5 * e.trace() * Mat2::Identity();
  return 2 * m.mu * (e - mean) + mean / (2 * m.c);
}

// Everything about a case that the formulas ask for.
struct Disc {
  std::string name;
  bool strain;
  Material m;
  Mat2 s;  // of the full disc

  explicit Disc(const json& c) : name(c.at("name")), strain(c.at("problem").at("plane") == "strain") {
    const json& p = c.at("problem");
    m = material(p.at("E"), p.at("nu"));
    if (p.contains("sigma_bar"))
      s = tensor(p.at("sigma_bar"));
    else if (p.contains("E_bar"))
      s = stress_of(m, tensor(p.at("E_bar")));
    else
      s = Mat2::Zero();
  }
  Material material(double young, double poisson) const {
    return strain ? plane_strain(young, poisson) : plane_stress(young, poisson);
  }
  VonMises von_mises() const {
    return strain ? von_mises_plane_strain(m) : VonMises{1};
  }
};

// Clamped on r = 1, uniform force b: u = a (1 - r^2) b with (4 mu + 2 K) a = 1, K = 1/(4 c).
double bulge(const Material& m) {
  return 2 * m.c / (8 * m.mu * m.c + 1);
}

// The adjoint stress at the center of a free disc under the body force e x: ansatz A x + B r^2 x for the mean part of
// e, (Ex/4 - r^2 Ex/6 + (x.Ex) x/12)/mu for its deviator E.
Mat2 tracking_adjoint(const Material& m, const Mat2& e) {
  const double mean = 0.5 * e.trace(), k = 4 * m.mu * m.c;
  return mean * (2 + k) / (4 * (1 + k)) * Mat2::Identity() + 0.5 * (e - mean * Mat2::Identity());
}

double derivative(const Disc& d, const json& c) {
  const json& problem = c.at("problem");
  const auto ends = [&](const char* what) { return d.name.ends_with(what); };
  const Perturbation hole;
  const auto h = [&](const Mat2& s, const Mat2& t) { return form(hole, d.m, 0, s, t); };
  if (d.name == "free_hole_compliance") return h(d.s, d.s);
  if (d.name == "free_hole_potential_energy") return hole_energy(d.m, d.s, Vec2::Zero(), Vec2::Zero());
  if (ends("boundary_L2_track")) return h(d.s, strain(d.m, d.s));  // adjoint traction u = e n
  if (ends("domain_L2_track")) return h(d.s, tracking_adjoint(d.m, strain(d.m, d.s)));
  if (ends("dirichlet_energy")) return -0.5 * h(d.s, d.s);
  if (ends("kohn_vogelius"))
    return 0.5 * (h(tensor(1.2, 0.2, 0), tensor(1.2, 0.2, 0)) -
                  h(stress_of(d.m, tensor(0.5, 0.1, 0)), stress_of(d.m, tensor(0.5, 0.1, 0))));
  if (ends("body_force_potential_energy")) {
    const Vec2 b(problem.at("body_force")[0], problem.at("body_force")[1]);
    return hole_energy(d.m, d.s, b, bulge(d.m) * b);
  }
  if (d.name == "inclusion_compliance") {
    Perturbation p{Perturbation::Kind::Inclusion};
    p.inclusion = d.material(problem.at("E_star"), problem.at("nu_star"));
    return form(p, d.m, 0, d.s, d.s);
  }
  // The center does not move: like a rigid inclusion.
  if (ends("clamped_hole_traction_compliance")) return inclusion_form(d.m, {infinity, 0}, d.s, d.s);
  const auto at = d.name.find("vonMises_p");
  if (at == std::string::npos) {
    ADD_FAILURE() << "no formula for " << d.name;
    return 0;
  }
  const double p = std::stod(d.name.substr(at + 10));
  const PowerTable table = tabulate(d.von_mises(), p);
  // Traction on the rim: A zeta = -Phi' + strain(p) with strain(p) = Phi'. Rim held: p = 0, zeta = -A^-1 Phi'.
  const Mat2 zeta = d.name.find("dirichlet") == std::string::npos
                        ? Mat2::Zero().eval()
                        : (-stress_of(d.m, power_derivative(d.von_mises(), p, d.s))).eval();
  return h(d.s, zeta) + local_term(table, d.s);
}

TEST(ExactDisc, EveryDerivativeAndTheOrderOfItsRemainder) {
  int count = 0;
  for (const json& c : cases()) {
    if (!c.contains("T")) continue;
    ++count;
    const Disc d(c);
    SCOPED_TRACE(d.name + (d.strain ? ", plane strain" : ", plane stress"));
    const double t = derivative(d, c);
    const double target = static_cast<double>(number(c.at("T")));
    EXPECT_NEAR(t / target, 1, 1e-12);
    const long double whole = number(c.at("J0"));
    std::vector<long double> eps, rest;
    for (std::size_t i = 0; i < c.at("eps").size(); ++i) {
      eps.push_back(c.at("eps")[i].get<double>());
      rest.push_back(number(c.at("J")[i]) - whole - exact_pi * eps[i] * eps[i] * t);
    }
    const json& slopes = c.at("remainder_slopes");
    ASSERT_EQ(slopes.size() + 1, rest.size());
    for (std::size_t i = 0; i + 1 < rest.size(); ++i) {
      const double slope = static_cast<double>(std::log2(std::abs(rest[i] / rest[i + 1])));
      EXPECT_NEAR(slope, slopes[i].get<double>(), 6e-4) << "eps " << eps[i];
    }
    if (!c.contains("coef_eps4")) continue;
    const long double fourth = number(c.at("coef_eps4"));
    const long double log = c.contains("coef_eps4_log_eps") ? number(c.at("coef_eps4_log_eps")) : 0;
    const json& later = c.at("remainder_slopes_after_eps4");
    for (std::size_t i = 0; i < rest.size(); ++i) rest[i] -= std::pow(eps[i], 4) * (fourth + log * std::log(eps[i]));
    for (std::size_t i = 0; i < later.size(); ++i) {
      const double slope = static_cast<double>(std::log2(std::abs(rest[i] / rest[i + 1])));
      EXPECT_NEAR(slope, later[i].get<double>(), 6e-4) << "after eps^4, eps " << eps[i];
    }
  }
  EXPECT_EQ(count, 28);
}

// The clamp at the center of a disc held on r = 1 by u0, or under a body force.
TEST(ExactDisc, ClampedHolesAreSecondOrderAfterRenormalization) {
  int count = 0;
  for (const json& c : cases()) {
    if (!c.contains("values")) continue;
    ++count;
    const Disc d(c);
    SCOPED_TRACE(d.name + (d.strain ? ", plane strain" : ", plane stress"));
    const json& problem = c.at("problem");
    const double k = 1 + 8 * d.m.mu * d.m.c, factor = -(1 / k + 0.5);
    if (c.contains("Hreg_times_2pimu1pk")) {
      EXPECT_NEAR(factor / static_cast<double>(number(c.at("Hreg_times_2pimu1pk"))), 1, 1e-14);
    }
    const Mat2 hreg = factor / (2 * exact_pi * d.m.mu * (1 + k)) * Mat2::Identity();
    const bool body = problem.contains("body_force");
    const Vec2 u0 = body ? (bulge(d.m) * Vec2(problem["body_force"][0], problem["body_force"][1])).eval()
                         : Vec2(problem.at("u0").get<double>(), 0);
    std::vector<double> error;
    for (const json& v : c.at("values")) {
      const double eps = v.at("eps");
      const double change = 0.5 * u0.dot(clamped_force(d.m, eps, hreg, u0));
      EXPECT_NEAR(change / static_cast<double>(number(v.at("renormalised"))), 1, 1e-12) << eps;
      const double truth = static_cast<double>(number(v.at(body ? "dJ" : "J")));
      error.push_back(std::abs(change - truth));
    }
    for (std::size_t i = 0; i + 2 < c.at("values").size() && i < 4; ++i)  // eps = 0.2, ..., 0.0125
      EXPECT_GT(std::log2(error[i] / error[i + 1]), 1.9) << i;
  }
  EXPECT_EQ(count, 4);
}

// Kelvin's displacement on the rim of a circle against M - Hreg, its strain against its stress, by differences.
TEST(Clamped, KelvinIsInEquilibriumAndItsForceIsOne) {
  for (const Material m : {plane_strain(2, 0.3), plane_stress(1, 0.2), Material{0.7, 0}}) {
    const double step = 1e-4;
    for (const Vec2& r : {Vec2(0.7, 0.4), Vec2(-0.3, 1.1), Vec2(0, 0.8)})
      for (int j = 0; j < 2; ++j) {
        Mat2 grad;
        Vec2 divergence = Vec2::Zero();
        for (int l = 0; l < 2; ++l) {
          const Vec2 e = step * Vec2::Unit(l);
          grad.col(l) = (kelvin(m, r + e).col(j) - kelvin(m, r - e).col(j)) / (2 * step);
          divergence += (kelvin_stress(m, r + e, j).col(l) - kelvin_stress(m, r - e, j).col(l)) / (2 * step);
        }
        const Mat2 s = kelvin_stress(m, r, j);
        EXPECT_LT((0.5 * (grad + grad.transpose()) - strain(m, s)).norm(), 2e-7);
        EXPECT_LT(divergence.norm(), 2e-7);
        EXPECT_EQ(s(0, 1), s(1, 0));
      }
    const int n = 64;
    Mat2 rim = Mat2::Zero(), force = Mat2::Zero();
    const double eps = 0.3;
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * exact_pi * i / n;
      const Vec2 e(std::cos(angle), std::sin(angle));
      rim += kelvin(m, eps * e) / n;
      for (int j = 0; j < 2; ++j) force.col(j) += kelvin_stress(m, eps * e, j) * e * (2 * exact_pi * eps / n);
    }
    EXPECT_LT((rim - clamped_matrix(m, eps, Mat2::Zero())).norm(), 1e-15);
    EXPECT_LT((force + Mat2::Identity()).norm(), 1e-14);
  }
}

TEST(Clamped, RefusesARadiusBeyondTheExpansion) {
  const Material m = plane_strain(1, 0.3);
  EXPECT_THROW(clamped_force(m, 2, -Mat2::Identity(), Vec2(1, 0)), Error);
}

}  // namespace
}  // namespace kerf::exact_disc_test
