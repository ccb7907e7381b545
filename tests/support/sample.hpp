#pragma once
// What several tests of this room need: a folder of their own, a grid of triangles, a full result.

#include "io/result.hpp"
#include "plot/picture.hpp"
#include "tests/support/folder.hpp"

#include <cmath>
#include <functional>
#include <string>

namespace kerf::test {

/// A rectangle cut into 2 nx ny triangles.
inline Picture grid(const Vec2& low, const Vec2& high, Index nx, Index ny,
                    const std::function<double(const Vec2&)>& value) {
  Picture out;
  for (Index j = 0; j <= ny; ++j) {
    for (Index i = 0; i <= nx; ++i) {
      out.points.push_back(low + (high - low).cwiseProduct(Vec2(double(i) / nx, double(j) / ny)));
    }
  }
  for (Index j = 0; j < ny; ++j) {
    for (Index i = 0; i < nx; ++i) {
      const Index a = j * (nx + 1) + i;
      out.triangles.push_back({a, a + 1, a + nx + 2});
      out.triangles.push_back({a, a + nx + 2, a + nx + 1});
    }
  }
  out.values.resize(3, static_cast<Eigen::Index>(out.triangles.size()));
  for (std::size_t t = 0; t < out.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      out.values(Eigen::Index(k), Eigen::Index(t)) = value(out.points[std::size_t(out.triangles[t][k])]);
    }
  }
  return out;
}

/// One point that holds, one that fails, one beyond reach.
inline ValidationResult sample_validation() {
  ValidationResult out{"hole", {}};
  Validation v{.at = {0.5, 0.8}, .coefficient = -1.234, .order = 4.02, .intercept = -1.2343702, .c2 = 5.6, .c3 = -0.7};
  v.plateau = 1e-5;
  v.c4 = 0.3;
  v.c2_predicted = 5.59;
  v.c2_on_mesh = 5.58;
  v.order_second = 5.9;
  v.logarithm = Logarithm::Known;
  v.verdict = Verdict::Holds;
  v.reason = "orders 4.01 and 4.03";
  for (const double radius : {0.2, 0.1, 0.05}) {
    const double predicted = pi * radius * radius * v.coefficient, remainder = 5 * std::pow(radius, 4);
    v.rows.push_back({radius, -10 + predicted + remainder, predicted + remainder, predicted, remainder, 4, true});
  }
  v.rows.back().order = std::nan("");
  v.rows[0].predicted_second = v.rows[0].difference - 1e-5;
  v.rows[0].remainder_second = 1e-5;
  v.rows[0].order_second = 5.9;
  out.points.push_back(v);
  v.at = {-0.4, 0.6};
  v.verdict = Verdict::Fails;
  v.reason = "the remainder falls with order 2, not 4";
  v.order = 2;
  v.rows[0].same_contact = false;
  out.points.push_back(v);
  v = {.at = {3, 0}, .coefficient = std::nan(""), .order = std::nan("")};
  v.intercept = v.c2 = v.c3 = v.plateau = std::nan("");
  v.reason = "the point lies outside the body";
  out.points.push_back(v);
  return out;
}

/// Every section, every optional value.
inline Result full_result() {
  Result r;
  r.version = "0.1.0";
  r.case_name = "cracked_plate";
  r.title = "Plate with a partly closing crack";
  r.triangles = 1200;
  r.vertices = 650;
  r.mesh = {0.01, 0.1, 26.3, 0.93};
  StateResult state;
  state.element = "bdms";
  state.unknowns = 30000;
  state.condensed_unknowns = 7000;
  state.residual = 1.0 / 3e15;
  state.energy = -0.1;
  state.compliance = 0.2;
  state.area = 16;
  state.estimated_error = 1e-3;
  state.energy_bounds = {-0.11, -0.09};
  state.notes = {"rigid motion fixed: translation in x"};
  r.state = state;
  r.contact = ContactResultSummary{"dual-qp", 4, 3, 1e-14, 1.3, 0.7, 0.01};
  CrackResult crack;
  crack.name = "c";
  crack.length = 2;
  crack.max_opening = 0.25;
  crack.max_pressure = 0.5;
  crack.pressure = Peak{{{-1, 0}, 0.5}, true, PlacedValue{{-0.5, 0}, 0.375}};
  crack.transitions = {{{-1.0 / 3, 0}, "closed", "open"}};
  crack.tips = {{{-1, 0}, std::nullopt, std::nullopt, std::nullopt},
                {{1, 0}, 1.25, -0.5, 1.8, -0.75, {{0.001, 0.002, 0.003}}}};
  for (int i = 0; i <= 20; ++i) {
    const double s = 0.1 * i, open = i > 7 ? (s - 0.7) * (2 - s) : 0;
    crack.rows.push_back({s, {s - 1, 0}, open, 0.01 * s, i > 7 ? 0 : -0.5, 0, i <= 7});
  }
  r.cracks = {crack};
  r.functional = {"energy", -0.1};
  MapResult map;
  map.perturbation = "hole";
  map.min = {{0.5, 0.25}, -3};
  map.max = {{-0.5, 0.75}, 4};
  map.excluded_radius = 0.05;
  map.points = {{.at = {0.5, 0.5}, .value = 0.125, .angle = pi / 4, .masked = true, .lower = 0.1, .upper = 0.15},
                {.at = {9, 9}, .value = std::nan("")}};
  map.radius = 0.0125;
  map.masked_share = 0.25;
  map.biactive_length = 0.01;
  r.map = map;
  r.validate = sample_validation();
  r.seconds = {.mesh = 0.01,
               .assemble = 0.02,
               .factor = 0.03,
               .solve = 0.04,
               .contact = 0.05,
               .map = 0.06,
               .output = 0.07,
               .total = 0.28};
  r.peak_memory_mb = 123.5;
  return r;
}

}  // namespace kerf::test
