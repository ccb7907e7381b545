// An estimate of the error of K_II that false pressure at a sliding tip makes by way of friction: delta K_II =
// sqrt(2/pi) int r^-1/2 tau dr with tau the friction on what the pressure has beyond a line [theory: F.8].

#include "solver/post/slip_error.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace kerf {

namespace {

/// From the tip: where the point's share of the crack begins and ends, and its pressure of contact.
struct Stretch {
  double from, to, pressure;
  bool open;
  double middle() const {
    return (from + to) / 2;
  }
};

/// Lengths along the crack from the tip, the points' shares one after the other.
std::vector<Stretch> from_tip(const CrackTip& tip, std::span<const CrackPoint> profile) {
  std::vector<Stretch> all;
  double s = 0;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const CrackPoint& p = tip.at_start ? profile[i] : profile[profile.size() - 1 - i];
    all.push_back({s, s + p.length, p.contact_pressure(), p.status == CrackPoint::Status::Open});
    s += p.length;
  }
  return all;
}

/// Pressure a + b r, by least squares in the lengths.
struct Line {
  double a, b;
};

/// Normal equations of two unknowns; a single point gives its own value.
Line line_through(std::span<const Stretch> points) {
  double one = 0, r = 0, rr = 0, p = 0, rp = 0;
  for (const Stretch& x : points) {
    const double w = x.to - x.from, at = x.middle();
    one += w, r += w * at, rr += w * at * at, p += w * x.pressure, rp += w * at * x.pressure;
  }
  const double determinant = one * rr - r * r;
  if (!(determinant > 0)) return {one > 0 ? p / one : 0, 0};
  return {(p * rr - rp * r) / determinant, (one * rp - r * p) / determinant};
}

}  // namespace

/// int r^-1/2 dr over a stretch is 2 (sqrt(to) - sqrt(from)). The largest partial sum from the tip counts: what is
/// false may end anywhere.
double slip_error(const CrackTip& tip, const CrackLaw& law, std::span<const CrackPoint> profile, double length) {
  // Measured on exact stick-slip cracks: the sums below times 5 and 2 miss no error, and fall to a few 1e-4 of K_II on
  // mirrored meshes.
  constexpr double safety = 5, for_open = 2, mostly = 0.1;
  if (!is_unilateral(law) || !(law.friction > 0)) return 0;
  const std::vector<Stretch> all = from_tip(tip, profile);
  for (; length > tip.vertices[1].norm(); length /= 2) {
    std::size_t count = 0;
    double open = 0;
    while (count < all.size() && all[count].from < length) {
      if (all[count].open) open += all[count].to - all[count].from;
      ++count;
    }
    const std::span<const Stretch> near(all.data(), count);
    if (count == 0 || open > mostly * near.back().to) continue;
    const Line line = line_through(near);
    double sum = 0, largest = 0, total = 0;
    for (const Stretch& x : near) {
      const double part = 2 * (std::sqrt(x.to) - std::sqrt(x.from)) * (x.pressure - line.a - line.b * x.middle());
      sum += part;
      total += std::abs(part);
      largest = std::max(largest, std::abs(sum));
    }
    // Points that false tension has opened: what they would carry is not known, nothing cancels.
    return std::sqrt(2 / pi) * law.friction * (safety * largest + (open > 0 ? for_open * total : 0));
  }
  return 0;
}

}  // namespace kerf
