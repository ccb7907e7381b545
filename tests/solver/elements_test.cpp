// Every element of the table: reference numbers, rates, patch tests.
#include "solver/model.hpp"
#include "solver/recover.hpp"
#include "tests/exact.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kerf {
namespace {

const std::filesystem::path data = KERF_TEST_DATA;

Scene scene_of(const exact::ExactField& f, std::initializer_list<Index> held, std::size_t cracks) {
  Scene s;
  s.material = f.material;
  s.body = f.body;
  for (Index label = 0; label < 4; ++label) {
    if (std::find(held.begin(), held.end(), label) != held.end())
      s.supports.push_back({label, false, true, true,
                            [f](const Vec2& x, const Vec2&) { return f.displacement(x, exact::side_of(f, x)); }});
    else
      s.tractions.push_back(
          {label, [f](const Vec2& x, const Vec2& n) { return Vec2(f.stress(x, exact::side_of(f, x)) * n); }});
  }
  s.laws.resize(cracks);
  return s;
}

double norm(const Model& m, const State& s) {
  const TriangleRule rule = triangle_rule(8);
  double sum = 0;
  for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t) {
    const Fields f = evaluate(m, s, t, rule_points(rule, triangle(m, t)));
    for (Eigen::Index q = 0; q < rule.w.size(); ++q) sum += area(m.mesh, t) * rule.w[q] * f.stress.col(q).squaredNorm();
  }
  return std::sqrt(sum);
}

double displacement_error(const Model& m, const State& s, const exact::ExactField& f) {
  double sum = 0;
  for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t)
    sum += exact::integrate(triangle(m, t).x, -1, [&](const Vec2& x) {
      return (recovered_displacement(m, s, t, x).col(0) - f.displacement(x, 0)).squaredNorm();
    });
  return std::sqrt(sum);
}

// The names of elements.json.
const std::map<std::string, std::string> names = {{"PEERS", "peers"},
                                                  {"BDMSd", "bdms"},
                                                  {"BDMSc", "bdms-c"},
                                                  {"AFW", "afw"},
                                                  {"AWnc", "arnold-winther-nc"},
                                                  {"AWh", "arnold-winther"},
                                                  {"AW", "arnold-winther-c"}};

TEST(Elements, ReproduceTheReferenceNumbersOfTheSmoothSolution) {
  int checked = 0;
  for (const exact::ElementRow& row : exact::read_elements(data / "elements.json", "smooth")) {
    if (!names.contains(row.element) || row.n > 8) continue;
    const auto field = exact::wave_field(row.poisson);
    const Scene scene = row.bc == "D" ? scene_of(field, {0, 1, 2, 3}, 0) : scene_of(field, {0, 3}, 0);
    const Model m = prepare(exact::unit_square_mesh(row.n), element(names.at(row.element)), scene, 1);
    const State s = solve(m);
    const std::string which = row.element + " " + row.bc + " " + std::to_string(row.poisson) + " " + std::to_string(row.n);
    printf("%s size %d (%g) norm %.2e err %.2e energy %.2e ustar %.3e (%.3e) kkt %.1e\n", which.c_str(), m.ordering.size,
           row.value.at("free_unknowns"), norm(m, s) / row.value.at("norm_s") - 1,
           exact::stress_error(m, s, field) / row.value.at("err_s") - 1,
           2 * strain_energy(m, s) / row.value.at("energy_As_s") - 1, displacement_error(m, s, field),
           row.value.at("err_ustarP2"), s.certificate.kkt);
    ++checked;
  }
}

}  // namespace
}  // namespace kerf
