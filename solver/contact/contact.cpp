// Contact and friction on the small problem p = S j - r, all but the jumps j in contact eliminated, by an active set
// [theory: C.5, C.8, C.10]. A row is held (j = 0, p unknown) or moves (p known). After a solve with that set
//   held -> moves where p is outside of its admissible interval [low, high],
//   moves -> held where j has the wrong sign for the way it moves,
// all wrong rows at once: a semismooth Newton method, which usually ends after a few sets. Where it does not: a path
// through the inside (interior.cpp), then without friction steps to the first row that turns back, each of which lowers
// 1/2 j'S j - r'j [Lawson, Hanson 1974]; with Coulomb's friction a damped fixed point on given limits. Coulomb's limits
// at sliding points follow the pressures of the same solve: an affine fixed point per set, by GMRES [Saad, Schultz
// 1986]. The algorithm knows S through `Eliminated::solve` alone: dense.cpp has it dense, solver/system/held.hpp does
// not. Derived in docs/theory/contact.md, sections Algorithms and Friction.

#include "solver/contact/contact.hpp"

#include "solver/contact/gmres.hpp"

#include "kerf/stop.hpp"
#include "solver/contact/law.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

// Accuracy of Coulomb's limits relative to the load, while sets still change and in the end.
constexpr double rough = 1e-4, exact = 1e-15;

// What a search has spent, and the size of the forces that its tolerances are relative to.
struct Search {
  const Eliminated& system;
  double load = 0;  // max|r|
  bool was_elsewhere = false;
  int iterations = 0, solves = 0;
};

// Where the search stands. Pressures, per point, are the first guess for the coupled solve of the next set.
struct Trial {
  std::vector<Motion> motion;
  Eigen::VectorXd pressure;
  Response response;
  double noise = 0;   // what the moving rows miss of their force: forces are not known better
  double defect = 0;  // of the pressures that the limits were taken from, in the mean
};

double sign(Motion m) {
  return static_cast<double>(m);
}

// Elsewhere no given force follows a pressure: an open point has none, and the force of a sticking row is unknown.
bool slips(const ContactPoint& p, const std::vector<Motion>& motion) {
  return p.friction > 0 && p.tangential != none && motion[p.normal] == Motion::Held &&
         motion[p.tangential] != Motion::Held;
}

// Rows whose force is 0 whatever they do.
std::vector<bool> free_rows(const std::vector<ContactPoint>& points, const std::vector<Motion>& motion) {
  std::vector<bool> free(motion.size(), true);
  for (const ContactPoint& p : points) {
    free[p.normal] = false;
    if (p.tangential != none)
      free[p.tangential] = p.slip_bound == 0 && (p.friction == 0 || motion[p.normal] != Motion::Held);
  }
  return free;
}

// The forces of the moving rows; `pressure` at the slipping points alone.
Eigen::VectorXd known_forces(const std::vector<ContactPoint>& points, const std::vector<Motion>& motion,
                             const Eigen::VectorXd& pressure) {
  Eigen::VectorXd force = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(motion.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ContactPoint& p = points[i];
    if (p.tangential == none) continue;
    const double limit = p.slip_bound + (slips(p, motion) ? p.friction * pressure[i] : 0);
    force[p.tangential] = -sign(motion[p.tangential]) * limit;
  }
  return force;
}

Eigen::VectorXd pressures(const std::vector<ContactPoint>& points, const Eigen::VectorXd& force) {
  Eigen::VectorXd p(static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) p[i] = force[points[i].normal];
  return p;
}

// The response of the set with the limits of the slipping points at its own pressures, to `accuracy` of the load: an
// affine fixed point.
// With x the pressures of the slipping points, the pressures of the solve at limits from x are affine in x, B x + c; B
// is known by products, a solve each. Where it is nearly singular GMRES gives what it has, and the defect is measured;
// a step that does not lower it tenfold ends the iteration.
void respond(Search& s, const std::vector<ContactPoint>& points, Trial& t, double accuracy) {
  const std::vector<bool> free = free_rows(points, t.motion);
  for (std::size_t i = 0; i < free.size(); ++i)
    if (free[i] && t.motion[i] == Motion::Held) t.motion[i] = Motion::Forward;
  const auto solve = [&](const Eigen::VectorXd& pressure) -> Response {
    check_stop();
    ++s.solves;
    return s.system.solve(t.motion, known_forces(points, t.motion, pressure));
  };
  const auto missed = [&](const Eigen::VectorXd& pressure) {
    const Eigen::VectorXd known = known_forces(points, t.motion, pressure);
    double most = 0;
    for (std::size_t i = 0; i < t.motion.size(); ++i)
      if (t.motion[i] != Motion::Held) most = std::max(most, std::abs(t.response.force[i] - known[i]));
    return most;
  };
  // Pressures on the points that slip, 0 elsewhere.
  const auto seen = [&](const Response& response) -> Eigen::VectorXd {
    Eigen::VectorXd p = pressures(points, response.force);
    for (std::size_t i = 0; i < points.size(); ++i)
      if (!slips(points[i], t.motion)) p[i] = 0;
    return p;
  };
  ++s.iterations;
  Eigen::VectorXd pressure = t.pressure;
  t.response = solve(pressure);
  t.noise = missed(pressure);
  const double mean = std::sqrt(static_cast<double>(points.size()));
  for (double last = infinity;; last = t.defect) {
    for (std::size_t i = 0; i < points.size(); ++i)
      if (!slips(points[i], t.motion)) pressure[i] = 0;
    const Eigen::VectorXd base = seen(t.response), defect = base - pressure;
    const double size = defect.norm(), enough = std::max(accuracy * s.load, t.noise);
    t.defect = size / mean;
    if (!(t.defect > enough) || !(t.defect < 0.1 * last)) break;
    const auto product = [&](const Eigen::VectorXd& v) -> Eigen::VectorXd {
      return (seen(solve(pressure + size * v)) - base) / size;
    };
    pressure += gmres(product, defect, enough * mean);
    t.response = solve(pressure);
    t.noise = missed(pressure);
  }
  for (std::size_t i = 0; i < t.motion.size(); ++i)
    if (free[i]) t.motion[i] = t.response.jump[i] < 0 ? Motion::Backward : Motion::Forward;
  t.pressure = pressures(points, t.response.force).cwiseMax(0);
}

struct Change {
  Index row;
  Motion to;
};

// Rows that break their law: held ones by their force, moving ones by the direction of their jump.
// The tolerance of forces is the load's rounding, or what the moving rows miss of theirs, whichever is larger; that of
// jumps the rounding of the largest jump.
constexpr double rounding = 1e-13;
std::vector<Change> wrong_rows(const Search& s, const std::vector<ContactPoint>& points, const Trial& t) {
  const Eigen::VectorXd &jump = t.response.jump, &force = t.response.force;
  const Admissible a = admissible(points, force);
  const std::vector<bool> free = free_rows(points, t.motion);
  const double no_force = std::max(rounding * s.load, 4 * t.noise), no_jump = rounding * jump.cwiseAbs().maxCoeff();
  std::vector<Change> wrong;
  for (Index i = 0; i < static_cast<Index>(t.motion.size()); ++i) {
    if (free[i]) continue;
    if (t.motion[i] != Motion::Held) {
      if (sign(t.motion[i]) * jump[i] < -no_jump) wrong.push_back({i, Motion::Held});
    } else if (force[i] < a.low[i] - no_force) {
      wrong.push_back({i, Motion::Forward});
    } else if (force[i] > a.high[i] + no_force) {
      wrong.push_back({i, Motion::Backward});
    }
  }
  return wrong;
}

bool spent(const Search& s) {
  return s.iterations >= s.system.most_iterations;
}

// With Coulomb's limits at the pressures of the trial.
std::vector<ContactPoint> with_limits(std::vector<ContactPoint> points, const Eigen::VectorXd& pressure) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].slip_bound += points[i].friction * std::max(pressure[i], 0.0);
    points[i].friction = 0;
  }
  return points;
}

// Exchanges run with rough limits until no row is wrong, then with exact ones. The path through the inside is taken
// once: after twenty sets, or when ten in a row have not lowered the number of wrong rows. Its friction is given, at
// the pressures of the last set.
bool exchange(Search& s, const std::vector<ContactPoint>& points, Trial& t) {
  constexpr int trust = 10;  // exchanges in a row that need not help
  constexpr int many = 20;   // sets that cost as much as the way through the inside
  std::size_t fewest = t.motion.size() + 1;
  const auto may_go_elsewhere = [&] { return s.system.elsewhere && !s.was_elsewhere; };
  for (int patience = trust; (patience > 0 || may_go_elsewhere()) && !spent(s);) {
    if (may_go_elsewhere() && (patience == 0 || s.iterations >= many)) {
      t.motion = s.system.elsewhere(with_limits(points, t.pressure));
      s.was_elsewhere = true;
      fewest = t.motion.size() + 1;
      patience = trust;
    }
    respond(s, points, t, rough);
    std::vector<Change> wrong = wrong_rows(s, points, t);
    if (wrong.empty() && t.defect > exact * s.load) {
      respond(s, points, t, exact);
      wrong = wrong_rows(s, points, t);
    }
    if (wrong.empty()) return true;
    patience = wrong.size() < fewest ? trust : patience - 1;
    fewest = std::min(fewest, wrong.size());
    for (const Change& c : wrong) t.motion[c.row] = c.to;
  }
  return false;
}

// From a point x whose jumps all agree with their motions: towards the minimum of the set, as far as the first row that
// turns back, which is held; from a minimum all held rows that break the law are let go. At least one of them moves on.
bool descend(Search& s, const std::vector<ContactPoint>& points, Trial& t) {
  const std::vector<bool> free = free_rows(points, t.motion);
  Eigen::VectorXd x = t.response.jump;
  for (std::size_t i = 0; i < free.size(); ++i) {
    if (free[i] || sign(t.motion[i]) * x[i] > 0) continue;
    x[i] = 0;
    t.motion[i] = Motion::Held;
  }
  std::vector<Motion> minimum;
  while (!spent(s)) {
    respond(s, points, t, 0);
    const std::vector<Change> wrong = wrong_rows(s, points, t);
    const Eigen::VectorXd& z = t.response.jump;
    double share = 1;
    const auto reach = [&](Index i) { return std::abs(x[i]) / (std::abs(x[i]) + std::abs(z[i])); };
    for (const Change& c : wrong)
      if (c.to == Motion::Held) share = std::min(share, reach(c.row));
    const bool turned = std::any_of(wrong.begin(), wrong.end(), [](const Change& c) { return c.to == Motion::Held; });
    if (turned) {
      std::vector<Index> stopped;
      for (const Change& c : wrong)
        if (c.to == Motion::Held && reach(c.row) <= share) stopped.push_back(c.row);
      x += share * (z - x);
      for (const Index i : stopped) {
        x[i] = 0;
        t.motion[i] = Motion::Held;
      }
      continue;
    }
    if (wrong.empty()) return true;
    if (t.motion == minimum) return false;  // rounding alone decides here
    minimum = t.motion;
    x = z;
    for (const Change& c : wrong) t.motion[c.row] = c.to;
  }
  return false;
}

// Ways in their order: exchanges; without Coulomb's friction descent, which ends for a positive definite S but for
// rounding; with it the fixed point of problems with given limits, each of which is a minimum, halving the damping
// where a change does not shrink by a tenth. Every eight steps exchanges are tried from there.
bool settle(Search& s, const std::vector<ContactPoint>& points, Trial& t) {
  if (exchange(s, points, t)) return true;
  const auto friction = [](const ContactPoint& p) { return p.friction > 0 && p.tangential != none; };
  if (std::none_of(points.begin(), points.end(), friction)) return descend(s, points, t);
  std::vector<ContactPoint> given = points;
  Eigen::VectorXd pressure = t.pressure;
  double damping = 1, last = infinity;
  constexpr int steps = 8;  // of the fixed point between two attempts
  for (int step = 1; !spent(s); ++step) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      given[i].slip_bound = points[i].slip_bound + points[i].friction * pressure[i];
      given[i].friction = 0;
    }
    if (!settle(s, given, t)) return false;
    const double change = (t.pressure - pressure).norm();
    if (change > 0.9 * last) damping = std::max(0.5 * damping, 0.05);
    last = change;
    pressure += damping * (t.pressure - pressure);
    if (step % steps == 0 && exchange(s, points, t)) return true;
  }
  return false;
}

// Rows that the forces p = -r of the bonded crack would move.
std::vector<Motion> first_motions(const std::vector<ContactPoint>& points, const Eigen::VectorXd& force) {
  const Admissible a = admissible(points, force);
  std::vector<Motion> motion(force.size(), Motion::Held);
  for (Eigen::Index i = 0; i < force.size(); ++i)
    motion[i] = force[i] < a.low[i] ? Motion::Forward : force[i] > a.high[i] ? Motion::Backward : Motion::Held;
  return motion;
}

}  // namespace

// The load is max|p| of the bonded crack, or of the guess where it is trusted. Where the search does not end the last
// set is solved once more, so that motions, jumps and forces belong together.
Contact active_set(const Eliminated& system, const std::vector<ContactPoint>& points,
                   const std::vector<Motion>& guess) {
  const Eigen::Index n = system.rows;
  Search s{system};
  Trial t;
  const bool guessed = static_cast<Eigen::Index>(guess.size()) == n;
  if (n > 0) {
    t.motion.assign(n, Motion::Held);
    if (guessed && system.trusts_guess) t.motion = guess;
    t.response = system.solve(t.motion, Eigen::VectorXd::Zero(n));
    ++s.solves;
    s.load = t.response.force.cwiseAbs().maxCoeff();
  }
  t.pressure = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(points.size()));
  if (s.load == 0 && t.response.jump.isZero(0))
    return {Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n), t.motion, 0, s.solves};
  t.motion = guessed ? guess : first_motions(points, t.response.force);
  t.pressure = pressures(points, t.response.force).cwiseMax(0);
  Contact c;
  c.converged = settle(s, points, t);
  if (!c.converged) respond(s, points, t, exact);  // so that motions, jumps and forces belong together
  c.kkt = optimality(points, t.response.jump, t.response.force, s.load);
  c.converged = c.converged && std::isfinite(c.kkt);
  c.iterations = s.iterations;
  c.solves = s.solves;
  c.jump = t.response.jump;
  c.force = known_forces(points, t.motion, t.pressure);
  for (Eigen::Index i = 0; i < n; ++i)
    if (t.motion[i] == Motion::Held) {
      c.jump[i] = 0;
      c.force[i] = t.response.force[i];
    }
  c.motion = std::move(t.motion);
  return c;
}

}  // namespace kerf
