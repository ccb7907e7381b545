#include "optimize/level_set.hpp"

#include "optimize/evaluate.hpp"
#include "optimize/regularise.hpp"
#include "solver/recover.hpp"
#include "solver/stopwatch.hpp"
#include "topo/point.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace kerf {

namespace {

double knob(const char* name, double value) {
  const char* s = std::getenv(name);
  return s ? std::atof(s) : value;
}

// dJ = sum weight density theta.n at points of the design boundary
struct Rate {
  Curve curve;
  Eigen::MatrixXd density;  // per edge two points
};

struct Timer {
  double carve = 0, mesh = 0, solve = 0, grad = 0, other = 0;
};

// T of compliance at centroids:
Eigen::VectorXd derivative_at_centroids(const Analysis& a, const Functional& j) {
  const Model& m = *a.model;
  const Index n = static_cast<Index>(m.mesh.triangles.size());
  Eigen::VectorXd T(n);
  std::vector<bool> closed = no_row_closed(a);
  for (Index t = 0; t < n; ++t) {
    PointValues v{.x = centroid(m.mesh, t), .material = material_of(m.mesh, m.scene, t)};
    const Triangle shape = triangle(m, t);
    v.stress = components(stress_at(m.kernel, shape, a.state->interior.col(t), v.x));
    if (a.adjoint) v.dual = components(stress_at(m.kernel, shape, a.adjoint->interior.col(t), v.x));
    T[t] = expand(a, j, Perturbation{}, v, closed).value;
  }
  return T;
}

}  // namespace

OptimizeResult optimise_level_set(const Problem& p, const OptimizeRequest& r, const Observer& see,
                                  const CheckpointPlace&) {
  Timer time;
  Stopwatch watch;
  const double h = p.sizing.size;
  const_cast<Problem&>(p).sizing.across = knob("ACROSS", 1);
  const double hb = h * knob("HB", 1.0);
  Sizing even = p.sizing;
  even.size = hb;
  even.crack_tip_size = hb;
  Solid solid{r.level_set.frozen, {}, knob("PAD", 1.5) * hb};
  for (const Traction& t : p.scene.tractions) solid.labels.push_back(t.label);
  const Canvas canvas = make_canvas(triangulate(p.frame, even), solid, r.level_set.mirror);
  const double whole = canvas.lumped.sum();
  const double target = r.volume_at_most.value_or(1) * whole;
  Carving carving{.tolerance = knob("TOL", 0.15) * hb, .spacing = h, .least_area = hb * hb};
  for (const Traction& t : p.scene.tractions) carving.keep.push_back(t.label);
  for (const Support& s : p.scene.supports) carving.keep.push_back(s.label), carving.holding.push_back(s.label);

  Eigen::VectorXd phi = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(canvas.mesh.points.size()), -1e3);
  if (r.level_set.start) {
    Vec2 low = canvas.mesh.points[0], high = low;
    for (const Vec2& x : canvas.mesh.points) low = low.cwiseMin(x), high = high.cwiseMax(x);
    cut_discs(canvas, start_discs(*r.level_set.start, low, high), phi);
  }
  phi = constrained(canvas, phi);
  phi = signed_distance(canvas, phi).phi;
  const Helmholtz filter(canvas, knob("R", 1.5) * hb);
  const Locator locator = make_locator(canvas.mesh);

  double area_now = negative_area(canvas.mesh, phi);
  double wanted = std::max(target, area_now);
  const auto solve_at = [&](Eigen::VectorXd& f) {
    Stopwatch w;
    Carved carved = carve(p.frame, canvas.mesh, f, carving);
    for (int k = 0; k < 3 && std::abs(carved.area - wanted) > 2e-5 * whole; ++k) {
      double line = 0;
      for (const ZeroPiece& z : zero_line(canvas.mesh, f)) line += (z.a - z.b).norm();
      if (line == 0) break;
      f.array() += std::clamp((carved.area - wanted) / line, -0.2 * hb, 0.2 * hb);
      carved = carve(p.frame, canvas.mesh, f, carving);
    }
    time.carve += w.lap();
    Evaluated e = evaluate_design(p, r, carved.shape, carved.crack_of);
    time.mesh += e.seconds_mesh, time.solve += e.seconds_solve;
    return e;
  };
  int solves = 0;
  OptimizeResult result{.method = "level-set"};
  Eigen::VectorXd history;  // of the fixed point
  double step = knob("STEP", 1.0) * h;
  Evaluated e = solve_at(phi);
  ++solves;
  const int fixed = static_cast<int>(knob("FIXED", 0));
  double angle = 0, kappa = knob("KAPPA", 0.5);
  Eigen::VectorXd psi;
  double drop = knob("DROP", 0.05);
  double best_J = 1e301;
  int since = 0, best_it = 0;
  Eigen::VectorXd best_phi;
  const bool verbose = std::getenv("VERBOSE");
  for (int it = 1; it <= r.max_iterations; ++it) {
    watch.lap();
    wanted = std::max(target, wanted - drop * whole);
    const Analysis a = std::move(analyse_objective(e).front().analysis);
    Eigen::VectorXd next;
    double lag = 0;
    if (it <= fixed) {
      // topological derivative, filtered
      const Eigen::VectorXd T = derivative_at_centroids(a, e.objective);
      Eigen::VectorXd load = Eigen::VectorXd::Zero(phi.size());
      const Mesh& mesh = e.cases[0].model.mesh;
      for (Index t = 0; t < T.size(); ++t) {
        const Vec2 x = centroid(mesh, t);
        const Index k = nearest_triangle(canvas.mesh, locator, x);
        const auto& v = canvas.mesh.triangles[k];
        const Vec2 &A = canvas.mesh.points[v[0]], &B = canvas.mesh.points[v[1]], &C = canvas.mesh.points[v[2]];
        const double det = cross(B - A, C - A), amount = area(mesh, t) * T[t];
        load[v[0]] += amount * cross(B - x, C - x) / det;
        load[v[1]] += amount * cross(C - x, A - x) / det;
        load[v[2]] += amount * cross(A - x, B - x) / det;
      }
      Eigen::VectorXd G = filter.solve(load);
      // level lag so that {G > lag} has the wanted area
      G = constrained(canvas, -G);
      double low = G.minCoeff(), high = 0;
      for (int k = 0; k < 60; ++k) {
        lag = 0.5 * (low + high);
        Eigen::VectorXd f = G.array() - lag;
        if (canvas.frozen.size() > 0) f = f.cwiseMin(canvas.frozen);
        (negative_area(canvas.mesh, f) > wanted ? high : low) = lag;
      }
      const Eigen::VectorXd g = (G.array() - lag).matrix();
      const auto norm = [&](const Eigen::VectorXd& f) { return std::sqrt(canvas.lumped.dot(f.cwiseAbs2())); };
      Eigen::VectorXd unit = g / norm(g);
      if (psi.size() == 0) psi = unit;
      angle = std::acos(std::clamp(canvas.lumped.dot(unit.cwiseProduct(psi)), -1.0, 1.0));
      const double s = std::sin(angle);
      if (s > 1e-6) psi = (std::sin((1 - kappa) * angle) * psi + std::sin(kappa * angle) * unit) / s;
      psi = with_area(canvas, psi, wanted);
      next = psi;
      psi /= norm(psi);
      next = signed_distance(canvas, next).phi;
      lag = -lag;
    } else {
      // shape gradient
      const Model& m = e.cases[0].model;
      const State& st = e.cases[0].state;
      Curve curve;
      std::vector<Index> number(m.mesh.points.size(), none);
      std::vector<double> rate;
      std::vector<Vec2> middle;
      const EdgeRule rule = gauss(2);
      const Index design = static_cast<Index>(e.shape.labels.size()) - 1;
      for (Index edge = 0; edge < static_cast<Index>(m.mesh.edges.size()); ++edge) {
        if (m.mesh.sides[edge][0] != none && m.mesh.sides[edge][1] != none) continue;
        bool held = false;
        for (const Support& s : m.scene.supports) held |= s.label == m.mesh.label[edge];
        for (const Traction& s : m.scene.tractions) held |= s.label == m.mesh.label[edge];
        if (held) continue;
        (void)design;
        std::array<Index, 2> ends;
        for (int i = 0; i < 2; ++i) {
          Index& k = number[m.mesh.edges[edge][i]];
          if (k == none)
            k = static_cast<Index>(curve.points.size()), curve.points.push_back(m.mesh.points[m.mesh.edges[edge][i]]);
          ends[i] = k;
        }
        curve.edges.push_back(ends);
        const Index t = m.mesh.sides[edge][0] != none ? m.mesh.sides[edge][0] : m.mesh.sides[edge][1];
        const Vec2 tau = tangent(m.mesh, edge);
        double g = 0;
        const Vec2 A = m.mesh.points[m.mesh.edges[edge][0]], B = m.mesh.points[m.mesh.edges[edge][1]];
        for (int q = 0; q < rule.s.size(); ++q) {
          const Mat2 s = tensor(stress_at(m.kernel, triangle(m, t), st.interior.col(t), A + rule.s[q] * (B - A)));
          const double tt = tau.dot(s * tau);
          g += rule.w[q] * tt * tt * (1 / plane_modulus(m.scene.material));
        }
        rate.push_back(g);
      }
      const Eigen::Index n = static_cast<Eigen::Index>(curve.points.size());
      Eigen::VectorXd g = Eigen::Map<Eigen::VectorXd>(rate.data(), static_cast<Eigen::Index>(rate.size()));
      // half thickness at every edge
      Eigen::VectorXd speed(g.size()), len(g.size()), half(g.size());
      const double cap = knob("CAP", 1.0) * step;
      const Eigen::VectorXd D = signed_distance(canvas, phi).phi;
      const auto phi_at = [&](const Vec2& x) {
        const Index k = nearest_triangle(canvas.mesh, locator, x);
        const auto& v = canvas.mesh.triangles[k];
        const Vec2 &A = canvas.mesh.points[v[0]], &B = canvas.mesh.points[v[1]], &C = canvas.mesh.points[v[2]];
        const double det = cross(B - A, C - A);
        return (D[v[0]] * cross(B - x, C - x) + D[v[1]] * cross(C - x, A - x) + D[v[2]] * cross(A - x, B - x)) / det;
      };
      std::size_t q = 0;
      for (Index edge = 0; edge < static_cast<Index>(m.mesh.edges.size()); ++edge) {
        if (m.mesh.sides[edge][0] != none && m.mesh.sides[edge][1] != none) continue;
        bool held = false;
        for (const Support& s : m.scene.supports) held |= s.label == m.mesh.label[edge];
        for (const Traction& s : m.scene.tractions) held |= s.label == m.mesh.label[edge];
        if (held) continue;
        const Vec2 x = 0.5 * (m.mesh.points[m.mesh.edges[edge][0]] + m.mesh.points[m.mesh.edges[edge][1]]),
                   n = outward_normal(m.mesh, edge);
        double t = 0.5 * hb;
        for (double d = 0.5 * hb; d <= 4 * h; d += 0.5 * hb) {
          const double f = -phi_at(x - d * n);
          if (f < 0.6 * d) break;
          t = d;
        }
        half[q] = t;
        len[q++] = length(m.mesh, edge);
      }
      const double power = knob("POWER", 0.5);
      double low = 1e-12 * g.maxCoeff(), high = g.maxCoeff();
      for (int k = 0; k < 80; ++k) {
        lag = std::sqrt(low * high);
        for (Eigen::Index i = 0; i < g.size(); ++i)
          speed[i] = std::clamp(half[i] * (std::pow(g[i] / lag, power) - 1), -cap, cap);
        (speed.dot(len) > 0 ? low : high) = lag;
      }
      Eigen::VectorXd load = Eigen::VectorXd::Zero(n), one = Eigen::VectorXd::Ones(g.size());
      for (std::size_t k = 0; k < curve.edges.size(); ++k)
        for (const Index v : curve.edges[k]) load[v] += 0.5 * len[k] * speed[k];
      const Eigen::VectorXd v = smooth_along(curve, one, knob("RS", 1.0) * h, load);
      const Eigen::VectorXd V = extend(canvas, curve.points, v);
      next = D - V;
      if (const int every = static_cast<int>(knob("EVERY", 0));
          every > 0 && (it % every == 1 || every == 1) && it < knob("NLAST", 1000)) {
        const Eigen::VectorXd T = derivative_at_centroids(a, e.objective);
        std::vector<Index> order(T.size());
        for (Index t = 0; t < T.size(); ++t) order[t] = t;
        std::sort(order.begin(), order.end(), [&](Index x, Index y) { return std::tie(T[x], x) < std::tie(T[y], y); });
        std::vector<Disc> discs;
        double budget = knob("FRACTION", 0.02) * whole;
        for (const Index t : order) {
          if (T[t] > knob("NCUT", 1) * lag || budget < 0) break;
          const Vec2 x = centroid(m.mesh, t);
          double d = -phi_at(x);
          for (const Disc& o : discs) d = std::min(d, (o.center - x).norm() - o.radius);
          if (canvas.frozen.size() > 0) {
            const auto& v = canvas.mesh.triangles[nearest_triangle(canvas.mesh, locator, x)];
            d = std::min(d, canvas.frozen[v[0]]);
          }
          if (d < knob("NCLEAR", 3) * h) continue;
          discs.push_back({x, std::min(d / 3, knob("NRAD", 1.5) * h)});
          budget -= 3.14 * discs.back().radius * discs.back().radius;
        }
        if (verbose && !discs.empty()) fmt::print("   {} nucleated\n", discs.size());
        cut_discs(canvas, discs, next);
      }
    }
    time.grad += watch.lap();
    next = constrained(canvas, next);
    next = signed_distance(canvas, next).phi;
    next = with_area(canvas, next, wanted);
    time.other += watch.lap();
    try {
      Evaluated trial = solve_at(next);
      ++solves;
      const bool settled = wanted == target && it > fixed + 1;
      const double merit = trial.J + lag * (trial.area - wanted);
      if (verbose)
        fmt::print(
            "{} J {:.4f} (merit change {:+.2e}) vol {:.4f} tri {} holes {} step {:.3f} lag {:.3f} angle {:.3f}\n", it,
            trial.J, (merit - e.J) / e.J, trial.area / whole, trial.cases[0].model.mesh.triangles.size(),
            trial.shape.holes.size(), step / h, lag, angle);
      if (settled) {
        const double tol = knob("SLACK", 0.02);
        if (!(best_J < 1e300)) best_J = merit * 1.0001, best_phi = next, since = 0;
        if (merit < best_J * (1 - 1e-5)) {
          step = std::min(step * 1.2, knob("MAXSTEP", 1.0) * h);
          if (it > fixed) since = 0;
          best_J = merit, best_phi = next, best_it = it;
        } else if (++since > static_cast<int>(knob("WATCH", 4)) || merit > best_J * (1 + tol)) {
          step *= 0.5;
          since = 0;
          if (verbose) fmt::print("   back to {:.4f}\n", best_J);
          if (step < 0.03 * h) break;
          phi = best_phi;
          if (!std::getenv("NORESTORE")) {
            e = solve_at(phi);
          }
          continue;
        }
      }
      phi = next;
      e = std::move(trial);
    } catch (const Error& error) {
      fmt::print("{}: {}\n", it, error.what());
      step *= 0.5;
      if (step < 0.02 * h) break;
      continue;
    }
  }
  fmt::print("J {:.4f} vol {:.5f} solves {} | carve {:.2f} mesh {:.2f} solve {:.2f} grad {:.2f} other {:.2f}\n", e.J,
             e.area / whole, solves, time.carve, time.mesh, time.solve, time.grad, time.other);
  if (best_it) phi = best_phi, e = solve_at(phi);
  result.shape = e.shape;
  result.objective = e.J;
  result.volume_fraction = e.area / whole;
  (void)see;
  return result;
}

}  // namespace kerf
