// Two measurements of meshing in optimizations. The share of remeshing in an iteration: the loop runs at its area from
// the beginning, and beside each iterate its design is carved (twice, as the loop does while it looks for the area) and
// meshed once more with the clock on; the first iterations are left out. Random designs: level functions made of discs,
// slits, touching discs and discs over cracks, the same on every machine; each must be meshed, with its area to 1e-9,
// or be refused with a geometric reason. Signed distances for the first are made from the design's own boundary, on a
// mesh twice as fine as the loop's.

#include "bench/optimize/remesh.hpp"

#include "bench/measure/measure.hpp"
#include "geometry/carve.hpp"
#include "geometry/plane.hpp"
#include "kerf/optimize.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace kerf {

namespace {

/// Signed distance to the part of the boundary that was designed, negative inside.
Eigen::VectorXd distance_to(const Shape& shape, Index design, const Mesh& background) {
  std::vector<std::array<Vec2, 2>> all, drawn;
  const auto add = [&](const Loop& loop) {
    for (std::size_t i = 0; i < loop.sides.size(); ++i) {
      all.push_back({loop.sides[i].start, loop.sides[(i + 1) % loop.sides.size()].start});
      if (loop.sides[i].label == design) drawn.push_back(all.back());
    }
  };
  add(shape.outline);
  for (const Loop& hole : shape.holes) add(hole);
  Eigen::VectorXd phi(static_cast<Eigen::Index>(background.points.size()));
  for (Eigen::Index v = 0; v < phi.size(); ++v) {
    const Vec2& x = background.points[v];
    double nearest = 1;
    for (const auto& [a, b] : drawn) nearest = std::min(nearest, distance(x, a, b));
    phi[v] = inside(all, x) ? -nearest : nearest;
  }
  // On the frame the parity is a matter of rounding: what the neighbors further in say counts.
  std::vector<bool> rim(background.points.size(), false);
  for (std::size_t e = 0; e < background.edges.size(); ++e)
    if (background.sides[e][0] == none || background.sides[e][1] == none)
      for (const Index v : background.edges[e]) rim[v] = true;
  for (const auto& [a, b] : background.edges)
    for (const auto& [on, in] : {std::pair(a, b), std::pair(b, a)})
      if (rim[on] && !rim[in] && std::abs(phi[in]) > (background.points[a] - background.points[b]).norm())
        phi[on] = std::copysign(phi[on], phi[in]);
  return phi;
}

}  // namespace

Remeshing measure_remeshing(OptimizeProblem p, double size, int iterations) {
  p.problem.sizing.size = size;
  // At its area from the beginning, with the boundary of a design: meshes are coarser while the area still falls.
  OptimizeRequest r = p.request;
  r.level_set.start = StartHoles{.columns = 10, .rows = 5, .radius = 0.08};
  r.volume_at_most = 0.49;
  r.max_iterations = iterations;
  r.tolerance = 0;
  r.starts = 1;
  // The loop's own grid is twice as fine as its meshes.
  const Mesh background = triangulate(p.problem.frame, {.size = size / 2, .crack_tip_size = size / 2});
  Carving how{.spacing = size, .least_area = size * size / 4};
  for (const Traction& t : p.problem.scene.tractions) how.keep.push_back(t.label);
  for (const Support& s : p.problem.scene.supports) {
    how.keep.push_back(s.label);
    how.holding.push_back(s.label);
  }
  Remeshing out;
  ProcessorWatch watch;
  double spent = 0, triangles = 0;
  const auto see = [&](const Iterate& at) {
    const double lap = watch.lap();
    // The first ones pay for what is made once, and for the way to the area.
    if (at.row.number > 1 && at.row.number <= iterations) {
      const Eigen::VectorXd phi = distance_to(at.shape, static_cast<Index>(p.problem.frame.labels.size()), background);
      watch.lap();
      Carved carved = carve(p.problem.frame, background, phi, how);
      carved = carve(p.problem.frame, background, phi, how);  // again when the area is not yet the wanted one
      out.carve_s += watch.lap();
      const Mesh mesh = triangulate(carved.shape, {.size = size, .across = 1});
      out.mesh_s += watch.lap();
      spent += lap;
      triangles += static_cast<double>(mesh.triangles.size());
      ++out.iterations;
    }
    watch.lap();
    return true;
  };
  optimize_level_set(p.problem, r, see, {});
  const double count = std::max(out.iterations, 1);
  out.triangles = static_cast<Index>(triangles / count);
  out.iteration_s = spent / count;
  out.carve_s /= count;
  out.mesh_s /= count;
  return out;
}

namespace {

/// A plate with two cracks, held on one side and loaded on the other.
Shape random_frame() {
  Shape frame;
  frame.labels = {"held", "loaded", "free"};
  frame.outline.name = "outline";
  frame.outline.sides = {{{0, 0}, 2}, {{2, 0}, 1}, {{2, 1}, 2}, {{0, 1}, 0}};
  frame.cracks = {{"long", {{0.4, 0.5}, {1.1, 0.6}}}, {"short", {{1.5, 0.2}, {1.6, 0.4}}}};
  return frame;
}

/// The same designs on every machine: level functions on the vertices of a mesh, positive in voids.
class RandomVoids {
 public:
  RandomVoids(const Shape& frame, const Mesh& background) : frame_(frame), background_(background) {}

  Eigen::VectorXd next() {
    phi_ = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(background_.points.size()), -1);
    const int things = 1 + static_cast<int>(uniform(0, 12));
    for (int k = 0; k < things; ++k) add_thing(k);
    return phi_;
  }

 private:
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(bits_()) + 0.5) / 4294967296.0;
  }
  void cut(const std::function<double(const Vec2&)>& depth) {  // positive where it is void
    for (Eigen::Index v = 0; v < phi_.size(); ++v) phi_[v] = std::max(phi_[v], depth(background_.points[v]));
  }
  void disc(const Vec2& c, double radius) {
    cut([=](const Vec2& x) { return radius - (x - c).norm(); });
  }
  void add_thing(int k) {
    const Vec2 c(uniform(0, 2), uniform(0, 1));
    const double radius = uniform(0.02, 0.2), angle = uniform(0, pi);
    const Vec2 along(std::cos(angle), std::sin(angle));
    switch (static_cast<int>(uniform(0, 4))) {
      case 0:
        disc(c, radius);
        break;
      case 1: {  // a slit
        const double half = uniform(0.005, 0.03);
        cut([=](const Vec2& x) { return half - distance(x, c - 2 * radius * along, c + 2 * radius * along); });
        break;
      }
      case 2:  // two that touch
        disc(c, radius);
        disc(c + (radius + 0.6 * radius) * along, 0.6 * radius);
        break;
      default: {  // over a crack
        const auto& crack = frame_.cracks[k % 2].points;
        disc(crack[0] + uniform(0, 1) * (crack[1] - crack[0]), 0.5 * radius);
      }
    }
  }

  const Shape& frame_;
  const Mesh& background_;
  std::mt19937 bits_{2024};
  Eigen::VectorXd phi_;
};

/// Throws where the mesh is none of the carved body.
void check_mesh(const Carved& carved, const Mesh& mesh) {
  double area_meshed = 0;
  for (Index t = 0; t < static_cast<Index>(mesh.triangles.size()); ++t) {
    if (!(area(mesh, t) > 0)) throw std::runtime_error("a triangle without area");
    area_meshed += area(mesh, t);
  }
  if (std::abs(area_meshed - carved.area) > 1e-9)
    throw std::runtime_error(fmt::format("area {} became {}", carved.area, area_meshed));
}

}  // namespace

RandomDesigns try_random_designs(int count, const std::function<bool()>& stop_asked) {
  const Shape frame = random_frame();
  const Mesh background = triangulate(frame, {.size = 0.04, .crack_tip_size = 0.04});
  const Carving how{.least_area = 0.04 * 0.04, .keep = {0, 1}, .holding = {0}};
  RandomVoids voids(frame, background);
  RandomDesigns out;
  for (int i = 0; i < count && !(stop_asked && stop_asked()); ++i) {
    const Eigen::VectorXd phi = voids.next();
    ++out.count;
    ProcessorWatch watch;
    try {
      const Carved carved = carve(frame, background, phi, how);
      check_mesh(carved, triangulate(carved.shape, {.size = 0.05, .across = 1}));
      ++out.meshed;
    } catch (const Error& e) {
      if (e.fault == Fault::Geometry)
        ++out.refused;
      else
        out.failures.push_back(fmt::format("random design {}: {}", i, e.what()));
    } catch (const std::exception& e) {
      out.failures.push_back(fmt::format("random design {}: {}", i, e.what()));
    }
    const double lap = watch.lap();
    out.seconds += lap;
    out.slowest = std::max(out.slowest, lap);
  }
  return out;
}

}  // namespace kerf
