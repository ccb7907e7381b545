// What small changes of topology would bring to a design, against the price of their area [theory: L.11, L.13]. The
// prices of area and of the bounds that bind (within 1 % of their limits) are the nonnegative ones that balance the
// rates along the free boundary best: min |sum mu_k g_k + lambda + g|^2 weighted by length. With them
//   hole margin = min (T - lambda)/lambda over centroids,
//   bump margin = min (lambda + kappa dJ_n)/lambda over free edges,
// T and dJ_n of J plus the bounds times their prices, kappa the share of a half disc of material (topo/bump.hpp). What
// the best of them would gain is pi r^2 (lambda - T - c2 r^2) and pi r^2 (-kappa dJ_n - lambda)/2 at the best r that
// fits. Places beside the boundary, where moving it does the same, in what stays solid and within two mesh sizes of
// singular points are left out. `proved` makes holes at the least T and asks the validation whether T says what they
// bring. Derived in docs/theory/level_set.md, section "Optimality".

#include "optimize/level_set/certificate.hpp"

#include "base/nonnegative.hpp"
#include "geometry/plane.hpp"
#include "kerf/map.hpp"
#include "optimize/level_set/hole_terms.hpp"
#include "solver/stress.hpp"
#include "topo/bump.hpp"
#include "topo/map_at_centroids.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr double binding = 1e-2;         // of a bound, relative: nearer than this it has a price
constexpr double clear_of_singular = 2;  // of singular points, in mesh sizes

/// Distance of points to the boundary of a mesh, no more than `most`.
std::vector<double> to_boundary(const Mesh& mesh, double most) {
  std::vector<double> distance(mesh.triangles.size(), most);
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    if (mesh.sides[e][0] != none && mesh.sides[e][1] != none) continue;
    const Vec2 &a = mesh.points[std::size_t(mesh.edges[e][0])], &b = mesh.points[std::size_t(mesh.edges[e][1])];
    for (std::size_t t = 0; t < distance.size(); ++t)
      distance[t] = std::min(distance[t], kerf::distance(centroid(mesh, static_cast<Index>(t)), a, b));
  }
  return distance;
}

/// Whether what is looked at there would be that of a singular point.
bool beside_singular(const Ground& g, const std::vector<Vec2>& singular, const Vec2& x) {
  return std::any_of(singular.begin(), singular.end(),
                     [&](const Vec2& y) { return (x - y).norm() < clear_of_singular * g.size; });
}

}  // namespace

// Only the area where it is used up, and bounds within 1 % of their limits, have a price.
Prices prices_of(const Ground& g, const Evaluated& e) {
  Prices prices{g.price, std::vector<double>(e.bounds.size(), 0)};
  prices.rate = boundary_rate(e, analyze_objective(e));
  const BoundaryRate objective = prices.rate;
  std::vector<std::size_t> binds;
  for (std::size_t k = 0; k < e.bounds.size(); ++k)
    if (e.bounds[k] > g.r.bounds[k].at_most - binding * std::abs(g.r.bounds[k].at_most)) binds.push_back(k);
  const bool full = g.limited && e.area > (1 - binding) * g.target;
  // sum mu_k g_k + lambda = -g along the free boundary, in the mean of squares.
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < objective.density.size(); ++i)
    if (objective.label[static_cast<std::size_t>(i)] >= g.free_label()) rows.push_back(i);
  const auto count = static_cast<Eigen::Index>(binds.size() + (full ? 1 : 0));
  if (rows.empty() || count == 0) return prices;
  const Eigen::VectorXd weight = objective.length(rows).cwiseSqrt();
  Eigen::MatrixXd A(static_cast<Eigen::Index>(rows.size()), count);
  std::vector<BoundaryRate> bounded;
  for (std::size_t k = 0; k < binds.size(); ++k) {
    bounded.push_back(boundary_rate(e, analyze_bound(e, binds[k])));
    A.col(static_cast<Eigen::Index>(k)) = weight.cwiseProduct(bounded.back().density(rows));
  }
  if (full) A.col(count - 1) = weight;
  const double volume = g.r.volume_penalty;  // J has the rest
  const Eigen::VectorXd right = -weight.cwiseProduct((objective.density(rows).array() + volume).matrix());
  // Columns are scaled to length 1: rates of stresses and of compliances have different units.
  Eigen::VectorXd unit = A.colwise().norm().transpose().cwiseMax(1e-300);
  const Eigen::VectorXd x = nonnegative_least_squares(A * unit.cwiseInverse().asDiagonal(), right).cwiseQuotient(unit);
  for (std::size_t k = 0; k < binds.size(); ++k) {
    const double price = prices.bound[binds[k]] = x[static_cast<Eigen::Index>(k)];
    if (price > 0) add(prices.rate, price, bounded[k]);
  }
  if (full) prices.area += x[count - 1];
  return prices;
}

// T is taken from the element's own stress at centroids, of the sum of J and the bounds with their prices.
HoleMargin hole_margin(const Ground& g, const Evaluated& e, const Prices& prices) {
  constexpr double beside = 1;  // of the boundary, in mesh sizes
  const Model& m = e.cases.front().model;
  const std::vector<Vec2> singular = singular_points(m);
  Eigen::VectorXd T = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(m.mesh.triangles.size()));
  const auto hole = [](Index) -> const Perturbation& {
    static const Perturbation a_hole;
    return a_hole;
  };
  const auto add = [&](const std::vector<WeightedAnalysis>& all, double factor) {
    for (const WeightedAnalysis& w : all) T += factor * w.weight * map_at_centroids(w.analysis, *w.functional, hole);
  };
  add(analyze_objective(e), 1);
  for (std::size_t k = 0; k < prices.bound.size(); ++k)
    if (prices.bound[k] > 0) add(analyze_bound(e, k), prices.bound[k]);
  const double of_area = prices.area - (g.price - g.r.volume_penalty);  // T has what volume costs in J
  const std::vector<double> room = to_boundary(m.mesh, beside * g.size);
  HoleMargin holes{.mesh = std::make_shared<const Mesh>(m.mesh),
                   .margin = std::vector<double>(m.mesh.triangles.size(), nan)};
  for (Index t = 0; t < T.size(); ++t) {
    const Vec2 x = centroid(m.mesh, t);
    if (room[static_cast<std::size_t>(t)] < beside * g.size) continue;
    if (g.background.frozen.size() > 0 && value_at(g.background, g.background.frozen, x) < 0) continue;
    if (beside_singular(g, singular, x)) continue;
    const double margin = (T[t] - of_area) / prices.area;
    holes.margin[static_cast<std::size_t>(t)] = margin;
    if (!(margin >= holes.least)) holes.least = margin, holes.at = x;
  }
  return holes;
}

namespace {

/// Per edge of the rate (price - worth)/price of a half disc there; not a number where none is looked at. Empty: (L.13)
/// has no body force and no density in the body.
std::vector<double> bump_margins(const Ground& g, const Evaluated& e, const Prices& prices) {
  const auto has_density = [](const Functional& j) {
    return std::ranges::any_of(j.terms, [](const Term& t) { return t.density && !t.volume; });
  };
  if (std::ranges::any_of(e.cases, [](const SolvedCase& c) { return bool(c.model.scene.body); })) return {};
  if (has_density(e.objective)) return {};
  for (std::size_t k = 0; k < prices.bound.size(); ++k)
    if (prices.bound[k] > 0 && has_density(e.bounded[k])) return {};
  const BoundaryRate& rate = prices.rate;
  // The rate contains what volume costs in J; the price has all of it.
  const double in_rate = g.price - g.r.volume_penalty;  // what volume costs in J
  const std::vector<Vec2> singular = singular_points(e.cases.front().model);
  std::vector<double> margins(rate.middle.size(), nan);
  for (Eigen::Index i = 0; i < rate.density.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (rate.label[k] < g.free_label() || beside_singular(g, singular, rate.middle[k])) continue;
    margins[k] = 1 + bump_share * (rate.density[i] - in_rate) / prices.area;
  }
  return margins;
}

/// Of J with the price of area that is asked for.
double share_of_J(const Ground& g, const Evaluated& e, double gain) {
  return gain / std::abs(e.J + g.r.volume_penalty * e.area);
}

}  // namespace

BumpMargin bump_margin(const Ground& g, const Evaluated& e, const Prices& prices) {
  BumpMargin bumps;
  const std::vector<double> margins = bump_margins(g, e, prices);
  for (std::size_t k = 0; k < margins.size(); ++k)
    if (margins[k] < bumps.least || (std::isnan(bumps.least) && !std::isnan(margins[k])))
      bumps.least = margins[k], bumps.at = prices.rate.middle[k];
  return bumps;
}

// Its base reaches to the next place that does not pay, or of which nothing is known: the frame's own sides, too.
BestChange best_bump(const Ground& g, const Evaluated& e, const Prices& prices) {
  BestChange best;
  const std::vector<double> margins = bump_margins(g, e, prices);
  if (margins.empty()) return best;
  best.gain = 0;
  const std::vector<Vec2>& at = prices.rate.middle;
  const Mesh& mesh = e.cases.front().model.mesh;
  for (std::size_t k = 0; k < margins.size(); ++k) {
    if (!(margins[k] < 0)) continue;
    double radius = 0.5 * extent(e.shape);
    for (std::size_t j = 0; j < margins.size(); ++j)
      if (!(margins[j] < 0)) radius = std::min(radius, (at[j] - at[k]).norm());
    for (std::size_t i = 0; i < mesh.edges.size(); ++i)
      if ((mesh.sides[i][0] == none || mesh.sides[i][1] == none) && mesh.label[i] < g.free_label())
        radius = std::min(radius, kerf::distance(at[k], mesh.points[std::size_t(mesh.edges[i][0])],
                                                 mesh.points[std::size_t(mesh.edges[i][1])]));
    const double gain = share_of_J(g, e, 0.5 * pi * radius * radius * -margins[k] * prices.area);
    if (gain > best.gain) best = {gain, at[k], radius};
  }
  return best;
}

// T alone ranks the places, since the second term costs a solve each: none is asked where the first promises less than
// what was found, and none beside one that was.
BestChange best_hole(const Ground& g, const Evaluated& e, const Prices& prices, const HoleMargin& holes) {
  constexpr double clear_radii = 3;  // of the room around a hole where the expansion still ranks [theory: L.14]
  constexpr std::size_t most_asked = 50;
  if (!holes.mesh) return {};
  const Mesh& mesh = *holes.mesh;
  const LevelSetRequest& how = g.r.level_set;
  const double least = std::max(0.5 * (how.min_gap > 0 ? how.min_gap : how.min_feature), how.min_radius);
  struct Place {
    Vec2 at;
    double most, promise;
  };
  std::vector<Place> places;
  for (std::size_t t = 0; t < holes.margin.size(); ++t) {
    if (!(holes.margin[t] < 0)) continue;
    const Vec2 x = centroid(mesh, static_cast<Index>(t));
    double room = g.background.frozen.size() > 0 ? value_at(g.background, g.background.frozen, x) : infinity;
    for (std::size_t i = 0; i < mesh.edges.size(); ++i)
      if (mesh.sides[i][0] == none || mesh.sides[i][1] == none)
        room = std::min(room, kerf::distance(x, mesh.points[std::size_t(mesh.edges[i][0])],
                                             mesh.points[std::size_t(mesh.edges[i][1])]));
    const double most = std::min(room / clear_radii, room - how.min_feature);
    if (most >= least && most > 0) places.push_back({x, most, -holes.margin[t] * prices.area * pi * most * most});
  }
  std::ranges::stable_sort(places, std::ranges::greater(), &Place::promise);
  BestChange best{.gain = 0};
  if (places.empty()) return best;
  std::vector<WeightedAnalysis> bounds;
  for (std::size_t k = 0; k < prices.bound.size(); ++k)
    if (prices.bound[k] > 0)
      for (WeightedAnalysis& w : analyze_bound(e, k)) {
        w.weight *= prices.bound[k];
        bounds.push_back(std::move(w));
      }
  HoleExpansion expansion(analyze_objective(e), std::move(bounds));
  const double of_area = prices.area - (g.price - g.r.volume_penalty);  // T has what volume costs in J
  std::vector<Disc> asked;
  for (const Place& p : places) {
    const bool beside =
        std::ranges::any_of(asked, [&](const Disc& d) { return (d.center - p.at).norm() < 0.5 * d.radius; });
    const int images = g.background.mirror && (image_of(*g.background.mirror, p.at) - p.at).norm() > 2 * p.most ? 2 : 1;
    if (beside || !(share_of_J(g, e, images * p.promise) > best.gain)) continue;
    if (asked.size() == most_asked) break;
    asked.push_back({p.at, p.most});
    const HoleTerms terms = expansion.merit(p.at);
    const double radius = std::max(best_radius(terms, of_area, p.most), least),
                 gain = share_of_J(g, e, images * (of_area * pi * radius * radius - terms.change(radius)));
    if (gain > best.gain) best = {gain, p.at, radius};
  }
  return best;
}

// Radii 0.4 of the mesh size and halves of it, under every load case: the first verdict that does not hold is told.
Verdict proved(const Ground& g, const Evaluated& e, const Vec2& at) {
  constexpr double wide = 3, largest = 0.4;  // radius, of the mesh size: the boundary is a mesh size away
  Sizing sizing = g.p.sizing;
  sizing.size = wide * g.mesh_size;  // the formula is tried, not the design: it holds on any mesh
  sizing.across = 1;
  ValidationRequest request{.points = {at}, .radii = {}, .perturbation = {}, .threads = g.p.threads};
  for (int k = 0; k < 5; ++k) request.radii.push_back(largest * g.size * std::pow(2.0, -k));
  for (const SolvedCase& c : e.cases) {
    const Verdict verdict =
        validate({e.shape, sizing}, g.p.element, c.model.scene, e.objective, request).front().verdict;
    if (verdict != Verdict::Holds && verdict != Verdict::Vanishes) return verdict;
  }
  return Verdict::Holds;
}

}  // namespace kerf
