// Polylines with fewer and better placed points.
// A line is sampled at even steps, five per spacing; smoothed by pairs of steps with factors .5 and -.53, which damp
// short waves and keep long ones [Taubin 1995]; then a shortest path picks the points that stay, with the cost
//   log(length/spacing)^2 + (largest distance from the chord/allowed)^2/2   per chord,
// chords of up to 8 steps; and what is not fixed moves along its normals until the area is that of the line. Each move
// is at most a fifth of the point's clearance, so that lines that were apart stay apart. docs/theory/level_set.md,
// "Smoothing".

#include "geometry/carve/simplify.hpp"
#include "geometry/plane.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr int fineness = 5;                   // points on the line for each that stays
constexpr int pairs = 12;                     // of smoothing steps
constexpr double shrink = 0.5, grow = -0.53;  // [Taubin 1995]: their product of filters keeps long waves

Vec2 right(const Vec2& d) {
  return {d.y(), -d.x()};
}

}  // namespace

/// Between fixed points steps are even; a loose closed chain has at least twenty.
Chain sample(const Chain& chain, double spacing) {
  const double step = spacing / fineness;
  const std::size_t n = chain.points.size();
  const std::size_t legs = chain.closed ? n : n - 1;
  Chain fine{{}, {}, {}, chain.closed};
  std::size_t first = 0;  // a closed chain starts at a fixed point if it has one
  if (chain.closed)
    while (first < n && !chain.fixed[first]) ++first;
  const bool loose = first == n;
  if (loose) first = 0;
  const auto at = [&](std::size_t i) -> const Vec2& { return chain.points[(first + i) % n]; };
  for (std::size_t start = 0; start < legs;) {
    std::size_t end = start + 1;
    double length = (at(end) - at(start)).norm();
    for (; end < legs && !chain.fixed[(first + end) % n]; ++end) length += (at(end + 1) - at(end)).norm();
    const int least = loose ? 4 * fineness : 1;
    const int count = std::max(least, int(std::lround(length / step)));
    fine.points.push_back(at(start));
    fine.fixed.push_back(chain.fixed[(first + start) % n]);
    fine.meets.push_back(chain.meets[(first + start) % n]);
    std::size_t leg = start;
    double before = 0, here = (at(leg + 1) - at(leg)).norm();
    for (int i = 1; i < count; ++i) {
      const double wanted = length * i / count;
      while (before + here < wanted && leg + 1 < end) {
        before += here;
        ++leg;
        here = (at(leg + 1) - at(leg)).norm();
      }
      const double part = here > 0 ? std::clamp((wanted - before) / here, 0.0, 1.0) : 0;
      fine.points.push_back(at(leg) + part * (at(leg + 1) - at(leg)));
      fine.fixed.push_back(false);
      fine.meets.push_back(none);
    }
    start = end;
  }
  if (!chain.closed) {
    fine.points.push_back(chain.points.back());
    fine.fixed.push_back(true);
    fine.meets.push_back(chain.meets.back());
  }
  return fine;
}

namespace {

constexpr double share = 0.2;  // of the clearance that smoothing may use, and chords

/// Short waves go, long ones stay; no point moves further than `move`.
void relax(Chain& chain, const std::vector<Clearance>& clearance, double most) {
  if (!(most > 0)) return;
  const std::vector<Vec2> origin = chain.points;
  const std::size_t n = origin.size();
  std::vector<Vec2> next = origin;
  for (int step = 0; step < 2 * pairs; ++step) {
    const double factor = step % 2 == 0 ? shrink : grow;
    for (std::size_t i = 0; i < n; ++i) {
      if (chain.fixed[i] || (!chain.closed && (i == 0 || i + 1 == n))) continue;
      const Vec2 &a = chain.points[i == 0 ? n - 1 : i - 1], &b = chain.points[i + 1 == n ? 0 : i + 1];
      next[i] = chain.points[i] + factor * ((a + b) / 2 - chain.points[i]);
      const Vec2 moved = next[i] - origin[i];
      const double move = std::min(most, share * clearance[i].all);
      if (moved.norm() > move) next[i] = origin[i] + move / moved.norm() * moved;
    }
    chain.points.swap(next);
  }
}

/// A chain between two fixed points, or a loose one from a point around to it again.
struct Stretch {
  std::vector<Vec2> x;
  std::vector<Clearance> clearance;
  bool loose;
};

/// How far the points between lie from the chord x[i] -> x[j], in relation to what is allowed.
double off_chord(const Stretch& s, std::size_t i, std::size_t j, double chord) {
  double off = 0;
  const bool at_end = !s.loose && (i == 0 || j + 1 == s.x.size());
  for (std::size_t k = i + 1; k < j; ++k)
    off = std::max(off, distance(s.x[k], s.x[i], s.x[j]) /
                            std::min(chord, share * (at_end ? s.clearance[k].beside : s.clearance[k].all)));
  return off;
}

/// The cheapest way from the first to the last point by chords of about the wanted length, none further than allowed
/// from the points between: numbers of the points that stay.
/// The path always exists: a chord of one step is allowed whatever it misses.
std::vector<std::size_t> cheapest(const Stretch& s, const Simplifying& how) {
  const std::size_t n = s.x.size() - 1;
  const std::size_t most =
      std::max<std::size_t>(1, s.loose ? std::min<std::size_t>(longest_chord, n / 4) : longest_chord);
  std::vector<double> cost(n + 1, infinity);
  std::vector<std::size_t> from(n + 1, 0);
  cost[0] = 0;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j <= std::min(n, i + most); ++j) {
      const double off = off_chord(s, i, j, how.chord);
      if (off > 1 && j > i + 1) continue;
      const double length = (s.x[j] - s.x[i]).norm();
      if (!(length > 0)) continue;
      const double ratio = std::log(length / how.spacing);
      const double total = cost[i] + ratio * ratio + 0.5 * off * off + 1e-3;
      if (total >= cost[j]) continue;
      cost[j] = total;
      from[j] = i;
    }
  std::vector<std::size_t> path{n};
  while (path.back() != 0) path.push_back(from[path.back()]);
  std::reverse(path.begin(), path.end());
  return path;
}

double twice_area(const std::vector<Vec2>& x, bool closed) {
  double sum = 0;
  const Vec2& origin = x.front();
  for (std::size_t i = 0; i + 1 < x.size(); ++i) sum += cross(x[i] - origin, x[i + 1] - origin);
  if (closed) sum += cross(x.back() - origin, x.front() - origin);
  return sum;
}

/// Moves what is not fixed along its normals until twice the area on the left is as wanted.
void restore_area(Chain& chain, const std::vector<Clearance>& clearance, double wanted, double most) {
  const std::size_t n = chain.points.size();
  double rest = most;
  for (int round = 0; round < 3; ++round) {
    const double missing = wanted - twice_area(chain.points, chain.closed);
    std::vector<Vec2> way(n, Vec2::Zero());
    double gain = 0;  // of twice the area, per length of the move
    for (std::size_t i = 0; i < n; ++i) {
      if (chain.fixed[i] || (!chain.closed && (i == 0 || i + 1 == n))) continue;
      const Vec2 along = chain.points[(i + 1) % n] - chain.points[(i + n - 1) % n];
      if (!(along.norm() > 0)) continue;
      const double part = std::min(1.0, share * clearance[i].all / most);
      way[i] = part * right(along).normalized();
      gain += part * along.norm();
    }
    if (!(gain > 0)) return;
    const double step = std::clamp(missing / gain, -rest, rest);
    for (std::size_t i = 0; i < n; ++i) chain.points[i] += step * way[i];
    rest -= std::abs(step);
  }
}

/// A closed chain that may start anywhere: where it turns most.
/// By the shortest distance between the points two steps away on either side.
void start_sharpest(Chain& chain, std::vector<Clearance>& clearance) {
  const std::size_t n = chain.points.size();
  std::size_t sharpest = 0;
  double least = infinity;
  for (std::size_t i = 0; i < n; ++i) {
    const double wide = (chain.points[(i + 2) % n] - chain.points[(i + n - 2) % n]).norm();
    if (wide < least * (1 - 1e-9)) sharpest = i, least = wide;
  }
  std::rotate(chain.points.begin(), chain.points.begin() + Index(sharpest), chain.points.end());
  std::rotate(clearance.begin(), clearance.begin() + Index(sharpest), clearance.end());
}

double length(const Chain& chain) {
  double sum = chain.closed ? (chain.points.front() - chain.points.back()).norm() : 0;
  for (std::size_t i = 0; i + 1 < chain.points.size(); ++i) sum += (chain.points[i + 1] - chain.points[i]).norm();
  return sum;
}

}  // namespace

/// Between fixed points by themselves, so that a fixed point never moves; the area is restored for the chain as a
/// whole.
Chain simplify(const Chain& chain, const Chain& given, const std::vector<Clearance>& given_clearance,
               const Simplifying& how) {
  Chain fine = given;
  std::vector<Clearance> clearance = given_clearance;
  relax(fine, clearance, how.move);
  const std::size_t n = fine.points.size();
  const bool loose = fine.closed && !fine.fixed.front();
  if (loose) start_sharpest(fine, clearance);
  Chain result{{}, {}, {}, chain.closed};
  std::vector<Clearance> kept;
  for (std::size_t start = 0; start < (fine.closed ? n : n - 1);) {
    Stretch stretch{{fine.points[start]}, {clearance[start]}, loose};
    std::size_t end = start;
    do {
      ++end;
      stretch.x.push_back(fine.points[end % n]);
      stretch.clearance.push_back(clearance[end % n]);
    } while (end < n - (fine.closed ? 0 : 1) && !fine.fixed[end % n]);
    const std::vector<std::size_t> path = cheapest(stretch, how);
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
      result.points.push_back(stretch.x[path[i]]);
      result.fixed.push_back(i == 0 && !loose);
      kept.push_back(stretch.clearance[path[i]]);
    }
    start = end;
  }
  if (!fine.closed) {
    result.points.push_back(fine.points.back());
    result.fixed.push_back(true);
    kept.push_back(clearance.back());
  }
  restore_area(result, kept, twice_area(chain.points, chain.closed) + 2 * how.offset * length(chain), how.chord);
  return result;
}

}  // namespace kerf
