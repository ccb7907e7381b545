// Edge cracks drawn into the body and solved with exact contact, against the expansion: K of the tip by interaction
// integrals at each length, one body each. The mesh is fine at the tip, a twentieth of the length at least.

#include "inspect/near_boundary.hpp"
#include "kerf/adaptive.hpp"
#include "kerf/fracture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf::inspect {

namespace {

constexpr double good = 0.05;  // what valid_length promises

/// The body with the crack, which bears the pressure, as the last one.
TipIntensity solve_drawn(const Meshing& body, const Model& model, const EdgeCrack& crack, double length,
                         const EdgeCrackRequest& request, double pressure, Adaptation how) {
  Shape shape = body.shape;
  shape.cracks.push_back({"edge", {crack.at, crack.at + length * crack.direction()}, {}});
  Scene scene = model.scene;
  CrackLaw law{.friction = request.friction};
  if (pressure > 0) law.pressure = [pressure](const Vec2&, const Vec2&) -> Vec2 { return {pressure, 0}; };
  scene.laws.push_back(law);
  Sizing sizing = body.sizing;
  const double tip = sizing.crack_tip_size > 0 ? sizing.crack_tip_size : target_size(sizing, body.shape) / 100;
  constexpr double fine = 20;
  sizing.crack_tip_size = std::min(tip, length / fine);
  sizing.mirrored_tips = sizing.mirrored_tips || request.friction > 0;
  how.given.reset();
  how.meshed = {};
  how.estimate = false;
  const Adapted solved = solve_graded(shape, sizing, model.element, scene, how);
  for (const TipIntensity& t : crack_tips(solved.model, solved.state))
    if (t.crack == static_cast<Index>(shape.cracks.size()) - 1 && !t.at_start) return t;
  throw Error(Fault::Geometry, "its end is no tip");
}

void judge(DrawnPlace& place) {
  double worst = 0, first_order = 0, spread = 0;
  int valid = 0, agree = 0, solved = 0;
  bool nothing = true;
  for (const DrawnEdge& row : place.rows) {
    if (!row.valid || std::isnan(row.error)) continue;
    ++valid;
    spread = std::max(spread, row.spread);
    if (!(row.spread <= good)) continue;
    ++solved;
    agree += row.error <= good + row.spread;
    worst = std::max(worst, row.error);
    const double K = std::hypot(row.K_I, row.K_II);
    nothing = nothing && K == 0;
    first_order = std::max(first_order, std::abs(row.first_order - K) / K);
  }
  if (!place.reason.empty() && valid == 0) return;
  if (valid == 0) {
    place.verdict = Verdict::OutOfRange;
    place.reason =
        fmt::format("no length is within {:.3g}, up to which the expansion is good", place.crack.valid_length);
  } else if (solved == 0) {
    place.reason = fmt::format("the rings about the drawn tips differ by up to {:.2g} %", 100 * spread);
  } else if (nothing && worst == 0) {
    place.verdict = Verdict::Vanishes;
    place.reason = "the cracks are closed and do not slide";
  } else {
    place.verdict = agree == solved ? Verdict::Holds : Verdict::Fails;
    place.reason =
        fmt::format("K of {} drawn crack{} is off by at most {:.2g} %{}", solved, solved == 1 ? "" : "s", 100 * worst,
                    std::isfinite(first_order) ? fmt::format(" (1.12 stress sqrt(pi a): {:.2g} %)", 100 * first_order)
                                               : std::string());
  }
}

}  // namespace

std::vector<DrawnPlace> draw_cracks(const RecoveredState& state, const Meshing& body, const EdgeCrackRequest& request,
                                    const std::vector<EdgeCrack>& cracks, const std::vector<double>& lengths,
                                    const Adaptation& how) {
  const NearBoundary near(state, request.friction, request.pressurized);
  std::vector<DrawnPlace> drawn;
  for (const EdgeCrack& crack : cracks) {
    const BoundaryPlace& place = near.nearest(crack.at);
    DrawnPlace& to = drawn.emplace_back(DrawnPlace{.crack = crack, .rows = {}, .reason = {}});
    for (const double length : lengths) {
      const EdgeCrack expected = near.at(place, length, crack.angle);
      DrawnEdge& row = to.rows.emplace_back(DrawnEdge{.length = length,
                                                      .predicted_I = expected.K_I,
                                                      .predicted_II = expected.K_II,
                                                      .first_order = expected.first_order,
                                                      .valid = expected.masked == Masked::No});
      try {
        const TipIntensity tip = solve_drawn(body, state.model, crack, length, request,
                                             request.pressurized ? near.pressure_on(place) : 0, how);
        row.K_I = tip.K_I;
        row.K_II = tip.K_II;
        row.spread = tip.spread;
        const double K = std::hypot(tip.K_I, tip.K_II),
                     off = std::hypot(tip.K_I - expected.K_I, tip.K_II - expected.K_II);
        row.error = off == 0 ? 0 : off / std::max(K, expected.K);
      } catch (const Error& e) {
        to.reason = fmt::format("a crack of length {:.4g} cannot be drawn or solved: {}", length, e.what());
      }
    }
    judge(to);
  }
  return drawn;
}

}  // namespace kerf::inspect
