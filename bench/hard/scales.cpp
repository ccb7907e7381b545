// Length, place, load and direction: what must not matter. The same body is scaled, moved far from the origin, loaded
// by other powers of ten and turned; energies go with length^2 load^2, openings with length load, K with load
// sqrt(length), stresses with load. Powers of two are exact, so that even the mesh is the same and only rounding of
// other numbers is left. Far from the origin coordinates lose the digits of the shift, which is the limit there.

#include "bench/hard/cracks.hpp"

#include <fmt/format.h>

#include <cmath>

namespace kerf {

namespace {

// A plate of 4 x 4 with a crack of length 2 that is partly closed, held by its tractions alone.
HardCase partly_closed(const Placed& placed) {
  const auto at = [&](double x, double y) { return placed.at({x, y}); };
  std::vector<Vec2> probes;
  for (const Vec2& x : {Vec2(0, 1), Vec2(1.5, 0.2), Vec2(-1, -0.7), Vec2(0.3, -1.4)}) probes.push_back(placed.at(x));
  const std::string n = "(c * ny - s * nx)", pull = fmt::format("{} * (p + 0.2) * {}", decimal(placed.load), n);
  return {outline({at(-2, -2), at(2, -2), at(2, 2), at(-2, 2)}, {"outer", "outer", "outer", "outer"}) +
          crack("c", {at(-1, 0), at(1, 0)}) + material(1, 0.3) + local_frame(placed) +
          boundary("outer", fmt::format("traction = [\"-s * ({0})\", \"c * ({0})\"]", pull)) + probe(probes) +
          mesh_and_output(0.4 * placed.length)};
}

// Energy, K, opening, where the contact ends and stresses, against the benign ones times their powers of length and
// load: the largest deviation.
double against_scaled(const Compared& c, double length, double load) {
  const auto off = [](double value, double truth) { return std::abs(value - truth) / std::abs(truth); };
  const Result &r = c.seen.result, &b = c.benign.result;
  double worst = std::max(off(r.state->energy, b.state->energy * length * length * load * load),
                          off(r.cracks[0].max_opening, b.cracks[0].max_opening * length * load));
  worst = std::max(worst, off(r.cracks[0].open_length, b.cracks[0].open_length * length));
  const TipResult &tip = r.cracks[0].tips[1], &benign = b.cracks[0].tips[1];
  if (!tip.K_I) return infinity;
  worst = std::max(worst, off(*tip.K_I, *benign.K_I * load * std::sqrt(length)));
  for (std::size_t i = 0; i < c.seen.probe.size(); ++i)
    worst = std::max(worst, (c.seen.probe[i].stress / load - c.benign.probe[i].stress).cwiseAbs().maxCoeff());
  return worst;
}

HardFamily scaling(std::string name, std::string title, std::string knob) {
  return {.name = std::move(name),
          .title = std::move(title),
          .knob = std::move(knob),
          .truth = "the benign run scaled: energy, K, opening, end of the contact, stresses at four points",
          .limit = "3 digits above 1e-13: rounding unit times the condition of K on this mesh, about 1e5",
          .digits = [](double) { return 3.0; }};
}

/// The body whose cracks do not disturb its exact stress, on whatever mesh.
HardFamily of_place(HardFamily f, std::function<Placed(double)> placed) {
  f.truth = "closed form: the stress is linear and no crack disturbs it";
  f.make = [=](double knob) { return touching(0.5, placed(knob)); };
  f.error = [=](const Compared& c) {
    return stress_error(c.seen, [&](const Vec2& x) { return touching_stress(placed(c.knob), x); });
  };
  return f;
}

HardFamily of_length() {
  HardFamily f = scaling("length", "Size of the body", "length of the plate's unit");
  f.values = {1e-9, 1e-6, 1e-3, 1, 1e3, 1e6, 1e9};
  f.quick = {1e-9, 1e9};
  f.benign = 1;
  return of_place(f, [](double length) { return Placed{.length = length}; });
}

// Powers of two are exact, so that even the mesh is the same.
HardFamily of_binary_length() {
  HardFamily f = scaling("length-binary", "Size of the body, powers of two", "length of the plate's unit");
  f.values = {0x1p-30, 0x1p-20, 0x1p-10, 1, 0x1p10, 0x1p20, 0x1p30};
  f.quick = {0x1p-30};
  f.benign = 1;
  f.make = [](double length) { return partly_closed({.length = length}); };
  f.error = [](const Compared& c) { return against_scaled(c, c.knob, 1); };
  f.label = [](double length) { return fmt::format("2^{}", std::lround(std::log2(length))); };
  return f;
}

HardFamily of_load() {
  HardFamily f = scaling("load", "Size of the load", "load over modulus");
  f.values = {1e-12, 1e-9, 1e-6, 1e-3, 1, 1e3, 1e6, 1e9, 1e12};
  f.quick = {1e-12, 1e12};
  f.benign = 1;
  f.make = [](double load) { return partly_closed({.load = load}); };
  f.error = [](const Compared& c) { return against_scaled(c, 1, c.knob); };
  return f;
}

HardFamily of_shift() {
  HardFamily f = scaling("shift", "Far from the origin", "distance from the origin over the plate's unit");
  f.limit =
      "the coordinates are rounded to 1e-16 of the shift, and the shortest edge is 0.004: log10(shift) + 1 digits "
      "above 1e-13, at least 3";
  f.values = {0, 1e3, 1e4, 1e5, 1e6};
  f.quick = {1e3, 1e5};
  f.benign = 0;
  f.digits = [](double shift) { return std::max(3.0, shift > 0 ? std::log10(shift) + 1 : 0); };
  f.record = [](double shift) { return shift > 5e5 ? HardVerdict::Refused : HardVerdict::Held; };
  f.why = "beyond 1e5 times its extent from the origin the coordinates of a body with crack tips have too few digits";
  return of_place(f, [](double shift) { return Placed{.origin = Vec2(shift, 0.7 * shift)}; });
}

HardFamily of_rotation() {
  HardFamily f{.name = "rotation",
               .title = "Direction of the body",
               .knob = "turned by, degrees",
               .truth = "closed form: K of a row of collinear cracks, in one cell of it",
               .limit = "1 digit: the mesh is another one in each direction",
               .values = {0, 1e-6, 1, 10, 30, 45, 60, 89, 90, 135},
               .quick = {30, 90},
               .benign = 0,
               .make = [](double degrees) { return collinear_cell({.angle = degrees * pi / 180}); },
               .error = [](const Compared& c) { return collinear_error(c, 0.5); },
               .digits = [](double) { return 1.0; }};
  f.floor = 1e-4;
  return f;
}

}  // namespace

std::vector<HardFamily> scale_families() {
  return {of_length(), of_binary_length(), of_shift(), of_load(), of_rotation()};
}

}  // namespace kerf
