// Synthetic measurements: the true body is solved, its displacements are read at sensors along the label and get normal
// noise relative to their root mean square. The field between the sensors is interpolated by cubics along each curve,
// since the misfit as an energy wants data at every point [theory: T.7]; sensors where a support begins are known and
// get no noise. Normal numbers are made from the bits of mt19937 by the method of Box and Muller and rounded to 1e-9,
// so that they are the same on every machine. docs/theory/inverse.md.

#include "kerf/inverse.hpp"
#include "solver/system.hpp"

#include "geometry/plane.hpp"
#include "kerf/recover.hpp"
#include "optimize/inverse/boundary_line.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

namespace kerf {

namespace {

/// u* of recover.hpp, which is nearer to the truth than the edge multipliers (by 1.2 to 3 in the tests), or the
/// displacement itself where it is continuous.
Vec2 trace_at(const Model& m, const Field& s, Index edge, const Vec2& x) {
  const Vec2 &a = m.mesh.points[m.mesh.edges[edge][0]], &b = m.mesh.points[m.mesh.edges[edge][1]];
  const Index inside = m.mesh.sides[edge][0] != none ? m.mesh.sides[edge][0] : m.mesh.sides[edge][1];
  const Vec2 at = a + foot(x, a, b) * (b - a);
  return is_mixed(m.element) ? Vec2(recovered_displacement(m, s, inside, at).col(0))
                             : Vec2(evaluate(m, s, inside, at).displacement.col(0));
}

/// The mean of the traces of the edges that are nearest: two at a vertex.
Vec2 trace_at(const Model& m, const Field& s, const std::vector<Index>& edges, double size, const Vec2& x) {
  double least = infinity;
  std::vector<Index> near;
  for (const Index e : edges) {
    const Vec2 &a = m.mesh.points[m.mesh.edges[e][0]], &b = m.mesh.points[m.mesh.edges[e][1]];
    const double away = (x - a - foot(x, a, b) * (b - a)).norm();
    if (away < least - 1e-9 * size) near.clear();
    if (away < least + 1e-9 * size) near.push_back(e);
    least = std::min(least, away);
  }
  Vec2 u = Vec2::Zero();
  for (const Index e : near) u += trace_at(m, s, e, x);
  return u / static_cast<double>(near.size());
}

struct Samples {  // along one curve, at equal distances
  double spacing;
  std::vector<std::size_t> sensor;
};

struct SyntheticData {
  BoundaryLine line;
  std::vector<Samples> samples;  // per curve
  std::vector<Vec2> u;           // per sensor
};

/// Cubics with the slopes of the parabolas through three neighbors.
Vec2 interpolate(const Samples& s, const std::vector<Vec2>& u, double arc) {
  const auto n = static_cast<Index>(s.sensor.size());
  const auto value = [&](Index i) -> const Vec2& { return u[s.sensor[static_cast<std::size_t>(i)]]; };
  const double place = std::clamp(arc / s.spacing, 0.0, static_cast<double>(n - 1));
  const Index i = std::min(static_cast<Index>(place), n - 2);
  const double t = place - i;
  if (n == 2) return value(0) + t * (value(1) - value(0));
  const auto slope = [&](Index k) -> Vec2 {
    if (k == 0) return -1.5 * value(0) + 2 * value(1) - 0.5 * value(2);
    if (k == n - 1) return 1.5 * value(n - 1) - 2 * value(n - 2) + 0.5 * value(n - 3);
    return 0.5 * (value(k + 1) - value(k - 1));
  };
  const double r = 1 - t;
  // Hermite's cubic of two values and two slopes, slopes per spacing.
  return r * r * (1 + 2 * t) * value(i) + t * t * (1 + 2 * r) * value(i + 1) + r * r * t * slope(i) -
         r * t * t * slope(i + 1);
}

bool is_supported(const Scene& scene, Index label) {
  return std::any_of(scene.supports.begin(), scene.supports.end(), [&](const Support& s) { return s.label == label; });
}

}  // namespace

std::vector<double> normal_numbers(unsigned seed, std::size_t count) {
  std::mt19937 bits(seed);  // its bits are fixed by the standard, those of the distributions are not
  const auto uniform = [&bits] { return (static_cast<double>(bits()) + 0.5) / 4294967296.0; };
  const auto round = [](double x) { return std::round(x * 1e9) / 1e9; };
  std::vector<double> out;
  while (out.size() < count) {
    // [0, 1) shifted by half a step, so that no logarithm of 0 is taken; two normal numbers from two uniform ones.
    const double radius = std::sqrt(-2 * std::log(uniform())), angle = 2 * pi * uniform();
    out.push_back(round(radius * std::cos(angle)));
    if (out.size() < count) out.push_back(round(radius * std::sin(angle)));
  }
  return out;
}

// Sensors at equal distances along each curve, shared at joints.
Measurement measure(const Synthetic& s, int threads) {
  auto data = std::make_shared<SyntheticData>();
  data->line = boundary_line(s.true_shape, s.label);
  if (data->line.curves.empty())
    throw Error(Fault::Usage, "synthetic data: nothing of the boundary has the label they are measured on");
  const double spacing = s.spacing > 0 ? s.spacing : target_size(s.sizing, s.true_shape);

  const Model model = prepare(triangulate(s.true_shape, s.sizing), s.element, s.true_scene, threads);
  const State state = solve(model);
  if (!certified(state))
    throw Error(Fault::Numerics, "the true body, which the synthetic data come from, could not be solved");
  std::vector<Index> edges;
  for (Index e = 0; e < static_cast<Index>(model.mesh.edges.size()); ++e)
    if (model.mesh.label[e] == s.label) edges.push_back(e);

  Measurement out;
  std::vector<std::size_t> at_joint(static_cast<std::size_t>(data->line.joints), std::size_t(-1));
  for (const BoundaryCurve& curve : data->line.curves) {
    const double length = curve.arc.back();
    const double wanted = std::max(1.0, std::round(length / spacing));
    if (!(wanted <= 1e5))
      throw Error(Fault::Usage,
                  fmt::format("synthetic data: sensors {:g} apart are too many; use a larger spacing", spacing));
    const int intervals = static_cast<int>(wanted);
    Samples samples{length / intervals, {}};
    for (int i = 0; i <= intervals; ++i) {
      const Index joint = i == 0 ? curve.joint[0] : i == intervals ? curve.joint[1] : none;
      std::size_t sensor = joint != none ? at_joint[static_cast<std::size_t>(joint)] : std::size_t(-1);
      if (sensor == std::size_t(-1)) {
        sensor = out.at.size();
        out.at.push_back(point_at(curve, length * i / intervals));
        out.exact.push_back(trace_at(model, state, edges, length, out.at.back()));
        // Where a support begins the displacement is prescribed: no sensor's noise.
        out.known.push_back((i == 0 && is_supported(s.true_scene, curve.beside[0])) ||
                            (i == intervals && is_supported(s.true_scene, curve.beside[1])));
        if (joint != none) at_joint[static_cast<std::size_t>(joint)] = sensor;
      }
      samples.sensor.push_back(sensor);
    }
    data->samples.push_back(std::move(samples));
  }
  for (const Vec2& u : out.exact) out.scale += u.squaredNorm();
  out.scale = std::sqrt(out.scale / (2.0 * static_cast<double>(out.exact.size())));
  // Relative to the root mean square of a component over all sensors.
  const std::vector<double> noise = normal_numbers(s.seed, 2 * out.at.size());
  for (std::size_t i = 0; i < out.at.size(); ++i)
    out.displacement.push_back(
        out.known[i] ? out.exact[i] : out.exact[i] + s.noise * out.scale * Vec2(noise[2 * i], noise[2 * i + 1]));
  data->u = out.displacement;
  out.field = [data](const Vec2& x, const Vec2&) {
    const Place place = nearest_place(data->line, x);
    return interpolate(data->samples[static_cast<std::size_t>(place.curve)], data->u, place.arc);
  };
  return out;
}

// What is prescribed is no reading.
Readings readings_of(const Measurement& m, const Synthetic& s) {
  Readings r{.label = s.label, .at = {}, .displacement = {}, .noise = s.noise * m.scale};
  for (std::size_t i = 0; i < m.at.size(); ++i)
    if (!m.known[i]) {
      r.at.push_back(m.at[i]);
      r.displacement.push_back(m.displacement[i]);
    }
  return r;
}

Functional with_measured(Functional j, Index label, const BoundaryField& measured) {
  for (Term& term : j.terms)
    if (term.measured && term.measured->label == label) term.measured->value = measured;
  return j;
}

}  // namespace kerf
