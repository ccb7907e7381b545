// Two points to validate at: of a grid over the body those where the least part of T is the largest share (an error in
// a part is seen by its share), with room for the radii and T not small (docs/theory/validation.md, "The verdict").

#include "topo/validate/chosen.hpp"

#include "solver/system.hpp"
#include "topo/analysis.hpp"
#include "topo/map/fields.hpp"
#include "topo/map/jumps.hpp"
#include "topo/map/modes.hpp"
#include "topo/validate/sites.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

// How much of T its least part is; 1 is as good as a third.
// The second factor: T that cancels to a small share of its parts is a bad place.
double visibility(const std::vector<Mode>& modes, double T) {
  constexpr double plenty = 1. / 3;
  double least = plenty, sum = 0;
  for (const Mode& m : modes) sum += std::abs(m.value);
  if (!(sum > 0)) return 0;
  for (const Mode& m : modes) least = std::min(least, std::abs(m.value) / sum);
  return least / plenty * std::min(1.0, 2 * std::abs(T) / sum);
}

struct Candidate {
  Vec2 at;
  double score, room, size;
};

}  // namespace

// The best point, and the best of those a quarter of the body away that is half as good.
std::vector<Vec2> chosen_points(const Choice& c) {
  const Model& m = *c.a.model;
  std::vector<Vec2> x;
  // A grid over the body sees all of it; triangles crowd at tips.
  Vec2 low = m.mesh.points[0], high = low;
  for (const Vec2& p : m.mesh.points) low = low.cwiseMin(p), high = high.cwiseMax(p);
  constexpr int lines = 25;
  for (int i = 1; i < lines; ++i)
    for (int k = 1; k < lines; ++k)
      x.emplace_back(low + Vec2((high - low).x() * i / lines, (high - low).y() * k / lines));
  const std::vector<Index> in = locate(m.mesh, x);
  ValidationRequest at = c.r;
  at.points = x;
  std::vector<double> clear(x.size(), 0);
  for (const std::vector<Site>& batch : place(c.shape, c.j, at, jumps_of_data(m, c.j)))
    for (const Site& s : batch) clear[s.number] = s.inside ? s.clear : 0;
  const bool series = has_series(c.r.perturbation);
  const Expansion e(c.a, c.j, c.r.perturbation);
  const std::shared_ptr<const MapFields> fields = recover_fields(c.a);
  std::vector<bool> closed = no_row_closed(c.a);
  std::vector<Candidate> all;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double room = clear[i] / (reach(c.r.perturbation) * c.r.radii.front());
    if (in[i] == none || room <= 0) continue;
    double score = 1, size = 1;
    if (series) {
      const PointValues v = values_at(e, *fields, in[i], x[i]);
      const Oriented t = expand(e, v, closed);
      score = visibility(modes_of(e, v, t), t.value);
      size = std::abs(t.value);
    }
    all.push_back({x[i], score, room, size});
  }
  if (all.empty()) throw Error(Fault::Usage, "validation finds no point with room for a radius; give points");
  std::vector<double> sizes;
  for (const Candidate& k : all) sizes.push_back(k.size);
  std::nth_element(sizes.begin(), sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2), sizes.end());
  const double typical = sizes[sizes.size() / 2];
  constexpr double enough = 4;  // radii to the next feature
  // Visible parts, room and a T of typical size: each takes its share off.
  const auto value = [&](const Candidate& k) {
    constexpr double blind = 0.02;  // a point that misses a mode is better than none
    return (blind + k.score) * std::min(1.0, k.room / enough) * (typical > 0 ? std::min(1.0, k.size / typical) : 1);
  };
  std::stable_sort(all.begin(), all.end(), [&](const Candidate& a, const Candidate& b) { return value(a) > value(b); });
  std::vector<Vec2> chosen{all[0].at};
  const double apart = 0.25 * (high - low).norm();
  for (const Candidate& k : all)
    if (chosen.size() == 1 && (k.at - chosen[0]).norm() > apart && value(k) > 0.5 * value(all[0]))
      chosen.push_back(k.at);
  return chosen;
}

}  // namespace kerf
