// A first guess of holes, cracks and inclusions from displacements on the boundary, by topological derivatives of the
// readings.
//   b_k = int phi_k . (u_m - u),   b_k ~ sum_i a_i T_k(x_i),   T_k = form(sigma, zeta_k) - f . p_k    [theory: I.1]
// phi_k are hats along the label, normed so that equal independent noise stays so (whitened by the Cholesky factor of
// their mass). Over places, kinds, angles and areas within the boxes min |b - sum_i a_i T(x_i)|^2 is sought [theory:
// I.2]: one adjoint per reading, a dictionary of columns T(x) at candidate places and variants, each thing in turn and
// all pairs, areas by coordinate descent, places refined between the candidates. The guess is drawn and solved for,
// what the expansion missed is taken off b, and the fit is repeated while that explains more [theory: I.3]. Without a
// misfit the places are the most negative of the map of the objective. Derived in docs/theory/inverse.md.

#include "kerf/inverse.hpp"

#include "base/dense.hpp"
#include "geometry/plane.hpp"
#include "kerf/element.hpp"
#include "kerf/map.hpp"
#include "optimize/inverse/boundary_line.hpp"
#include "optimize/parametric/shapes/shape.hpp"
#include "topo/responses.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

namespace kerf {

namespace {

/// Distance from a point to everything that is no plain material.
struct Surroundings {
  std::vector<std::array<Vec2, 2>> segments;
  std::vector<std::pair<Vec2, double>> rings;  // of functionals

  double clearance(const Vec2& x) const {
    double least = infinity;
    for (const auto& [a, b] : segments) least = std::min(least, distance(x, a, b));
    for (const auto& [center, radius] : rings) least = std::min(least, (x - center).norm() - radius);
    return least;
  }
};
// Edges of the boundary, of cracks and between materials.
Surroundings surroundings(const Mesh& mesh, const Functional& j) {
  Surroundings s;
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e)
    if (mesh.sides[e][0] == none || mesh.sides[e][1] == none || mesh.crack[e] != none || is_interface(mesh, e))
      s.segments.push_back({mesh.points[mesh.edges[e][0]], mesh.points[mesh.edges[e][1]]});
  for (const Term& term : j.terms)
    if (term.feature_radius > 0) s.rings.emplace_back(term.feature, term.feature_radius);
  return s;
}

/// A grid over the box, where there is room.
/// At most 41 by 41 places: the dictionary has a column for each and every variant.
std::vector<Vec2> candidates(const Sought& s, const Mesh& mesh, const Surroundings& around, double room,
                             double spacing) {
  std::array<int, 2> intervals;
  for (int d = 0; d < 2; ++d) {
    constexpr int most = 40;
    intervals[static_cast<std::size_t>(d)] =
        std::clamp(static_cast<int>(std::ceil((s.high[d] - s.low[d]) / spacing)), 0, most);
  }
  std::vector<Vec2> grid, inside;
  for (int i = 0; i <= intervals[0]; ++i)
    for (int k = 0; k <= intervals[1]; ++k)
      grid.push_back(s.low + Vec2(intervals[0] > 0 ? (s.high.x() - s.low.x()) * i / intervals[0] : 0,
                                  intervals[1] > 0 ? (s.high.y() - s.low.y()) * k / intervals[1] : 0));
  const std::vector<Index> where = locate(mesh, grid);
  for (std::size_t i = 0; i < grid.size(); ++i)
    if (where[i] != none && around.clearance(grid[i]) >= room) inside.push_back(grid[i]);
  return inside;
}

[[noreturn]] void no_room(const Drawn& d) {
  throw Error(Fault::Usage, fmt::format("start = \"map\" of {}: nowhere in its box is there room for it in the body; "
                                        "move the box, or allow it to be smaller",
                                        name(d)));
}

/// Hats along the label and their products.
struct Hats {
  BoundaryLine line;
  std::vector<std::vector<Index>> node;  // per curve, at equal distances
  Index count = 0;
  Eigen::MatrixXd mass;

  double at(const Vec2& x, Index k) const {
    const Place p = nearest_place(line, x);
    const std::vector<Index>& nodes = node[static_cast<std::size_t>(p.curve)];
    const auto pieces = static_cast<Index>(nodes.size()) - 1;
    // The place in pieces of the curve: 1 at its node, linear to its neighbors.
    const double s = std::clamp(p.arc / line.curves[static_cast<std::size_t>(p.curve)].arc.back(), 0.0, 1.0) * pieces;
    const Index i = std::min(static_cast<Index>(s), pieces - 1);
    return (nodes[static_cast<std::size_t>(i)] == k ? 1 - (s - i) : 0) +
           (nodes[static_cast<std::size_t>(i) + 1] == k ? s - i : 0);
  }
};
// About 24 pieces in all. Curves that meet share the node at their joint.
Hats make_hats(const Shape& shape, Index label) {
  constexpr double wanted = 24;  // pieces
  Hats h{.line = boundary_line(shape, label)};
  if (h.line.curves.empty())
    throw Error(Fault::Usage, "start = \"map\": nothing of the boundary has the label of the misfit");
  std::vector<Index> at_joint(static_cast<std::size_t>(h.line.joints), none);
  struct Piece {
    Index a, b;
    double length;
  };
  std::vector<Piece> pieces;
  for (const BoundaryCurve& c : h.line.curves) {
    const int n = std::max(2, static_cast<int>(std::lround(wanted * c.arc.back() / h.line.length)));
    std::vector<Index> nodes;
    for (int i = 0; i <= n; ++i) {
      const Index joint = i == 0 ? c.joint[0] : i == n ? c.joint[1] : none;
      if (joint != none && at_joint[static_cast<std::size_t>(joint)] != none) {
        nodes.push_back(at_joint[static_cast<std::size_t>(joint)]);
      } else {
        nodes.push_back(h.count++);
        if (joint != none) at_joint[static_cast<std::size_t>(joint)] = nodes.back();
      }
      if (i > 0) pieces.push_back({nodes[nodes.size() - 2], nodes.back(), c.arc.back() / n});
    }
    h.node.push_back(std::move(nodes));
  }
  h.mass.setZero(h.count, h.count);
  for (const Piece& p : pieces) {
    // int phi_i phi_k of linear hats.
    h.mass(p.a, p.a) += p.length / 3;
    h.mass(p.b, p.b) += p.length / 3;
    h.mass(p.a, p.b) += p.length / 6;
    h.mass(p.b, p.a) += p.length / 6;
  }
  return h;
}

/// Readings in coordinates in which they are independent: whitened components.
struct GuessData {
  std::shared_ptr<const Hats> hats;
  Eigen::LLT<Eigen::MatrixXd> factor;
  std::vector<Term> readings;
  Responses responses;
  Eigen::VectorXd b;  // what the readings of the true body have more

  Eigen::VectorXd whiten(const Eigen::VectorXd& readings) const {
    Eigen::VectorXd out(readings.size());
    const Eigen::Index n = hats->count;
    for (int d = 0; d < 2; ++d) out.segment(d * n, n) = solve_lower(factor, readings.segment(d * n, n));
    return out;
  }
  Eigen::VectorXd column(const PointResponse& at, const Variant& v) const {
    return whiten(derivatives(at, v.what, v.angle));
  }
};
// Hats for x first, then for y; value is that of int phi (u - u_m), so that b has the sign turned.
GuessData read_data(const Shape& frame, const Support& measured, const Model& m, const Field& s) {
  const auto hats = std::make_shared<const Hats>(make_hats(frame, measured.label));
  std::vector<Term> readings;
  for (int d = 0; d < 2; ++d)
    for (Index k = 0; k < hats->count; ++k) {
      Term term{.kind = "reading", .linear = true, .label = measured.label};
      term.on_boundary = [hats, k, d, value = measured.value](const Vec2& x, const Vec2& n, const Vec2& u) {
        Density out;
        const double phi = hats->at(x, k);
        if (phi == 0) return out;
        out.value = phi * (u - value(x, n))[d];
        out.by_displacement[d] = phi;
        return out;
      };
      readings.push_back(std::move(term));
    }
  Responses r = responses(m, s, readings);
  GuessData data{hats, cholesky(hats->mass), std::move(readings), std::move(r), {}};
  data.b = data.whiten(-data.responses.value);
  return data;
}

/// What each candidate would add to the readings, per area: a column for every place and variant.
struct Dictionary {
  std::vector<Vec2> x;
  std::vector<Variant> variants;
  Eigen::MatrixXd columns;  // place by place
  Eigen::VectorXd squares;

  // Columns run through the variants of a place, then of the next one.
  const Vec2& place(Eigen::Index column) const {
    return x[static_cast<std::size_t>(column) / variants.size()];
  }
  const Variant& variant(Eigen::Index column) const {
    return variants[static_cast<std::size_t>(column) % variants.size()];
  }
};
Dictionary make_dictionary(const GuessData& data, const std::vector<Vec2>& places,
                           const std::vector<Variant>& variants) {
  Dictionary d{places, variants, {}, {}};
  d.columns.setZero(data.b.size(), static_cast<Eigen::Index>(places.size() * variants.size()));
  Eigen::Index column = 0;
  for (const Vec2& x : places) {
    const auto at = response_at(data.responses, x);
    for (const Variant& v : variants) {
      // Places outside the body keep columns of 0, which nothing picks.
      if (at) d.columns.col(column) = data.column(*at, v);
      ++column;
    }
  }
  d.squares = d.columns.colwise().squaredNorm();
  return d;
}

struct Range {
  double least, most;  // areas
  /// Area for which |r - a c|^2 is least: a = clamp(r.c / c.c), and by how much it falls.
  double area(double rc, double cc) const {
    return cc > 0 ? std::clamp(rc / cc, least, most) : least;
  }
  // r|^2 - |r - a c|^2 = a (2 r.c - a c.c).
  double gain(double rc, double cc) const {
    const double a = area(rc, cc);
    return a * (2 * rc - a * cc);
  }
};

struct Pick {
  Vec2 x = Vec2::Zero();
  Variant variant;
  double area = 0;
  Eigen::VectorXd column;  // empty: not picked yet
};

void draw_guess(const Guess& g, Drawn& d) {
  d.start = shape_of(d).guessed(g, d).cwiseMax(d.lower).cwiseMin(d.upper);
}

/// No larger than there is room for.
/// Two that come too close share the room in proportion to their sizes.
void make_room(std::vector<Guess>& guesses, const std::vector<Sought>& sought, const Surroundings& around,
               double clear) {
  for (std::size_t i = 0; i < guesses.size(); ++i)
    guesses[i].size = std::clamp(guesses[i].size, sought[i].least,
                                 std::max(sought[i].least, around.clearance(guesses[i].at) - clear));
  for (std::size_t i = 0; i < guesses.size(); ++i)
    for (std::size_t k = i + 1; k < guesses.size(); ++k) {
      const double room = (guesses[i].at - guesses[k].at).norm() - clear, sum = guesses[i].size + guesses[k].size;
      if (sum <= room) continue;
      guesses[i].size = std::max(sought[i].least, std::min(room / sum * guesses[i].size, room - sought[k].least));
      guesses[k].size = std::max(sought[k].least, room - guesses[i].size);
    }
}

struct Search {
  const GuessData& data;
  const Surroundings& around;
  const std::vector<Sought>& sought;
  double clear;
  Eigen::VectorXd b;  // to be explained
  std::vector<std::shared_ptr<const Dictionary>> dictionary = {};
  std::vector<Pick> picks = {};

  Range range(std::size_t i) const {
    return {pi * sought[i].least * sought[i].least, pi * sought[i].most * sought[i].most};
  }
  // A thing with a direction may be thin across: it keeps the clearance alone.
  double apart(std::size_t i, std::size_t k) const {
    return (sought[i].turns ? 0 : sought[i].least) + (sought[k].turns ? 0 : sought[k].least) + clear;
  }
  // `but`: another thing that is placed anew with it.
  bool keeps_apart(std::size_t i, const Vec2& x, std::size_t but) const {
    for (std::size_t k = 0; k < picks.size(); ++k)
      if (k != i && k != but && picks[k].column.size() > 0 && (picks[k].x - x).norm() < apart(i, k)) return false;
    return true;
  }
  Eigen::VectorXd rest(std::size_t i, std::size_t k) const {  // of the data without what i and k explain
    Eigen::VectorXd r = b;
    for (std::size_t n = 0; n < picks.size(); ++n)
      if (n != i && n != k && picks[n].column.size() > 0) r -= picks[n].area * picks[n].column;
    return r;
  }
  double gain(std::size_t i, const Eigen::VectorXd& r, const Eigen::VectorXd& column) const {
    return range(i).gain(r.dot(column), column.squaredNorm());
  }
  void take(std::size_t i, Eigen::Index column, double area) {
    const Dictionary& d = *dictionary[i];
    picks[i] = {d.place(column), d.variant(column), area, d.columns.col(column)};
  }

  // Of all candidates the one that lowers |rest|^2 most; the present one stays unless another gains more than rounding.
  bool best_of(std::size_t i) {
    const Dictionary& d = *dictionary[i];
    const Eigen::VectorXd r = rest(i, i), rc = d.columns.transpose() * r;
    double best = picks[i].column.size() > 0 ? gain(i, r, picks[i].column) * (1 + 1e-9) : -infinity;
    Eigen::Index at = none;
    for (Eigen::Index c = 0; c < rc.size(); ++c) {
      const double g = range(i).gain(rc[c], d.squares[c]);
      if (g > best && d.squares[c] > 0 && keeps_apart(i, d.place(c), i)) best = g, at = c;
    }
    if (at != none) take(i, at, range(i).area(rc[at], d.squares[at]));
    return at != none;
  }

  /// All pairs of places.
  bool best_of(std::size_t i, std::size_t k) {
    const Dictionary &d = *dictionary[i], &e = *dictionary[k];
    const Range first = range(i), second = range(k);
    // The unbounded optimum of two areas from the 2 x 2 normal equations bounds the gain; only pairs that may win are
    // fitted within their ranges.
    const Eigen::VectorXd r = rest(i, k), rd = d.columns.transpose() * r, re = e.columns.transpose() * r;
    const auto explained = [](double a, double b, double ra, double rb, double aa, double bb, double ab) {
      return 2 * (a * ra + b * rb) - a * a * aa - b * b * bb - 2 * a * b * ab;
    };
    const Pick &p = picks[i], &q = picks[k];
    double best = explained(p.area, q.area, r.dot(p.column), r.dot(q.column), p.column.squaredNorm(),
                            q.column.squaredNorm(), p.column.dot(q.column)) *
                  (1 + 1e-9);
    Eigen::Index at_i = none, at_k = none;
    double area_i = 0, area_k = 0;
    for (Eigen::Index c = 0; c < rd.size(); ++c) {
      if (!(d.squares[c] > 0) || !keeps_apart(i, d.place(c), k)) continue;
      const Eigen::VectorXd products = e.columns.transpose() * d.columns.col(c);
      for (Eigen::Index f = 0; f < re.size(); ++f) {
        const double aa = d.squares[c], bb = e.squares[f], ab = products[f], det = aa * bb - ab * ab;
        // Nearly parallel columns tell no two things apart.
        if (!(det > 1e-9 * aa * bb)) continue;
        double a = (rd[c] * bb - re[f] * ab) / det, b = (re[f] * aa - rd[c] * ab) / det;
        if (2 * (a * rd[c] + b * re[f]) - a * a * aa - b * b * bb - 2 * a * b * ab <= best) continue;
        for (int round = 0; round < 3; ++round) {
          a = first.area(rd[c] - b * ab, aa);
          b = second.area(re[f] - a * ab, bb);
        }
        const double g = explained(a, b, rd[c], re[f], aa, bb, ab);
        if (g <= best || (d.place(c) - e.place(f)).norm() < apart(i, k) || !keeps_apart(k, e.place(f), i)) continue;
        best = g, at_i = c, at_k = f, area_i = a, area_k = b;
      }
    }
    if (at_i == none) return false;
    take(i, at_i, area_i);
    take(k, at_k, area_k);
    return true;
  }

  // Coordinate descent converges for the convex problem in the areas.
  void fit_areas() {
    for (int round = 0; round < 200; ++round)
      for (std::size_t i = 0; i < picks.size(); ++i)
        picks[i].area = range(i).area(rest(i, i).dot(picks[i].column), picks[i].column.squaredNorm());
  }

  /// Between the candidates, in steps that are halved.
  void refine(double spacing) {
    // From half the spacing of the candidates to 1/128 of it.
    // The angle from half the spacing of the 24 candidates.
    double step = 0.5 * spacing, turn = pi / 48;
    for (int level = 0; level < 7; ++level, step *= 0.5, turn *= 0.5) {
      bool moved = true;
      for (int round = 0; moved && round < 20; ++round) {
        moved = false;
        for (std::size_t i = 0; i < picks.size(); ++i) {
          const Eigen::VectorXd r = rest(i, i);
          // Both ways along x and y, and of the angle where there is one.
          const int directions = sought[i].turns ? 6 : 4;
          for (int way = 0; way < directions; ++way) {
            Pick trial = picks[i];
            const double sign = way % 2 == 0 ? 1 : -1;
            if (way < 4)
              trial.x[way / 2] += sign * step;
            else
              trial.variant.angle += sign * turn;
            if ((trial.x - sought[i].low).minCoeff() < 0 || (sought[i].high - trial.x).minCoeff() < 0 ||
                around.clearance(trial.x) < sought[i].least + clear || !keeps_apart(i, trial.x, i))
              continue;
            const auto at = response_at(data.responses, trial.x);
            if (!at) continue;
            trial.column = data.column(*at, trial.variant);
            if (!(gain(i, r, trial.column) > gain(i, r, picks[i].column) * (1 + 1e-9))) continue;
            trial.area = range(i).area(r.dot(trial.column), trial.column.squaredNorm());
            picks[i] = std::move(trial);
            moved = true;
          }
        }
        fit_areas();
      }
    }
  }

  // Sizes by area = pi size^2; that of a crack is half its length.
  std::vector<Guess> guesses() const {
    std::vector<Guess> out;
    for (std::size_t i = 0; i < picks.size(); ++i)
      out.push_back({.drawn = sought[i].drawn,
                     .at = picks[i].x,
                     .size = std::sqrt(picks[i].area / pi),
                     .angle = std::remainder(picks[i].variant.angle, pi),
                     .young = picks[i].variant.young});
    make_room(out, sought, around, clear);
    return out;
  }
  Eigen::VectorXd predicted() const {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(b.size());
    for (const Pick& pick : picks) sum += pick.area * pick.column;
    return sum;
  }

  // One after the other first; then each again with the others held, then pairs at a time, for what one thing alone
  // cannot gain.
  void find(double spacing) {
    picks.resize(sought.size());
    for (std::size_t i = 0; i < sought.size(); ++i)
      if (!best_of(i)) return;
    const auto settle = [&] {
      for (int round = 0, moved = 1; moved && round < 50; ++round) {
        moved = 0;
        for (std::size_t i = 0; i < sought.size(); ++i) moved += best_of(i);
        fit_areas();
      }
    };
    settle();
    constexpr double most = 4e6;  // pairs
    for (int round = 0, moved = 1; moved && round < 3; ++round) {
      moved = 0;
      for (std::size_t i = 0; i < sought.size(); ++i)
        for (std::size_t k = i + 1; k < sought.size(); ++k)
          if (static_cast<double>(dictionary[i]->columns.cols()) * static_cast<double>(dictionary[k]->columns.cols()) <=
              most)
            moved += best_of(i, k);
      settle();
    }
    refine(spacing);
  }
};

/// The guess is drawn and solved for, and what the expansion missed is taken off the data, before the expansion is
/// fitted again, as long as that leaves less unexplained. Returns the explained part of the data.
double correct(Search& search, const Problem& p, double spacing, InitialGuess& out) {
  const GuessData& data = search.data;
  constexpr int most = 12;
  const double whole = data.b.squaredNorm();
  double least = infinity;
  for (int round = 0; round < most && whole > 0; ++round) {
    const std::vector<Guess> guesses = search.guesses();
    Design drawn = out.design;
    for (const Guess& g : guesses) draw_guess(g, drawn.drawn[g.drawn]);
    Eigen::VectorXd change;
    try {
      auto body = body_of(drawn, start_of(drawn), p);
      const Model m = prepare(triangulate(body.shape, p.sizing), p.element, std::move(body.scene), p.threads);
      const State s = solve(m, p.contact);
      ++out.solves;
      if (!certified(s)) break;
      change = data.whiten(read(m, s, data.readings) - data.responses.value);
    } catch (const Error&) {  // it cannot be drawn: the guess before is as good as it gets
      break;
    }
    const double left = (data.b - change).squaredNorm();
    // At least 2 % must be gained: each round is a solve.
    if (!(left < 0.98 * least)) break;
    least = left;
    out.guesses = guesses;
    // b - (change - predicted): what the expansion misses of the drawn guess [theory: I.3].
    search.b = data.b - change + search.predicted();
    search.refine(spacing);
  }
  // Not even the first guess could be drawn or solved: what the expansion itself explains is told.
  if (least == infinity) least = (data.b - search.predicted()).squaredNorm();
  return whole > 0 ? 1 - least / whole : 0;
}

/// Everything that is looked for, and what it must keep away from.
struct Wanted {
  const Design& design;
  const std::vector<Sought>& sought;
  const Surroundings& around;
  double clear, spacing;  // distances: to keep, between candidates
};

/// The most negative values of the map of the objective.
/// Things in the order of the design; later ones keep off those that are placed.
std::vector<Guess> best_of_map(const Functional& objective, const Analysis& a, const Wanted& wanted) {
  const auto& [design, sought, around, clear, spacing] = wanted;
  std::vector<Guess> guesses;
  for (const Sought& one : sought) {
    const double size = one.size;
    const std::vector<Vec2> places = candidates(one, a.model->mesh, around, size + clear, spacing);
    double best = infinity;
    Guess guess{.drawn = one.drawn, .size = size};
    for (const Variant& v : one.variants) {
      MapRequest request{.perturbation = v.what, .radius = size};
      if (one.turns) request.perturbation.angle = v.angle;
      for (const MapPoint& x : map_at(a, objective, request, places)) {
        const bool apart = std::all_of(guesses.begin(), guesses.end(),
                                       [&](const Guess& g) { return (g.at - x.at).norm() >= g.size + size + clear; });
        if (!apart || !(x.value < best)) continue;
        best = x.value;
        guess.at = x.at, guess.angle = v.angle, guess.young = v.young;
      }
    }
    if (best == infinity) no_room(design.drawn[one.drawn]);
    guesses.push_back(guess);
  }
  return guesses;
}

/// What explains the data best to second order in the areas. Things with the same candidates share a dictionary.
Search search_in(const GuessData& data, const Mesh& mesh, const Wanted& wanted) {
  const auto& [design, sought, around, clear, spacing] = wanted;
  Search search{data, around, sought, clear, data.b};
  for (std::size_t i = 0; i < sought.size(); ++i) {
    const Sought& one = sought[i];
    const std::vector<Vec2> places = candidates(one, mesh, around, one.least + clear, spacing);
    if (places.empty()) no_room(design.drawn[one.drawn]);
    const auto same =
        std::find_if(search.dictionary.begin(), search.dictionary.end(), [&, &sought = sought](const auto& d) {
          const Sought& other = sought[static_cast<std::size_t>(&d - search.dictionary.data())];
          return other.turns == one.turns && d->x == places && one.variants.size() == d->variants.size() &&
                 std::equal(one.variants.begin(), one.variants.end(), d->variants.begin(),
                            [](const Variant& a, const Variant& b) {
                              return a.what.kind == b.what.kind && a.angle == b.angle && a.young == b.young &&
                                     a.what.inclusion.mu == b.what.inclusion.mu &&
                                     a.what.inclusion.c == b.what.inclusion.c;
                            });
        });
    search.dictionary.push_back(same != search.dictionary.end()
                                    ? *same
                                    : std::make_shared<const Dictionary>(make_dictionary(data, places, one.variants)));
  }
  search.find(spacing);
  for (std::size_t i = 0; i < sought.size(); ++i)
    if (search.picks[i].column.size() == 0) no_room(design.drawn[sought[i].drawn]);
  return search;
}

}  // namespace

std::string in_words(const Guess& g, const Design& design) {
  const Drawn& d = design.drawn.at(g.drawn);
  return fmt::format("{} at ({:.4g}, {:.4g}), {}", name(d), g.at.x(), g.at.y(), shape_of(d).guess_in_words(g));
}

bool wants_map(const Design& design) {
  return std::any_of(design.drawn.begin(), design.drawn.end(), [](const Drawn& d) { return d.from_map; });
}

InitialGuess initial_guess(const Problem& p, const Design& design, double clear) {
  InitialGuess out{.design = design, .explained = nan};
  Design given;
  std::vector<Sought> sought;
  for (std::size_t k = 0; k < design.drawn.size(); ++k) {
    const Drawn& one = design.drawn[k];
    if (!one.from_map) {
      given.drawn.push_back(one);
      continue;
    }
    sought.push_back(shape_of(one).seek(one, p));
    sought.back().drawn = k;
  }
  if (sought.empty()) return out;
  // What is given is in the body; only what asks for a map is looked for.
  auto body = body_of(given, start_of(given), p);
  const Model m = prepare(triangulate(body.shape, p.sizing), p.element, std::move(body.scene), p.threads);
  const State s = solve(m, p.contact);
  if (!certified(s))
    throw Error(Fault::Numerics, "start = \"map\": the body without what is looked for could not be solved");
  out.solves = 1;
  const Surroundings around = surroundings(m.mesh, p.objective);
  const Wanted wanted{design, sought, around, clear, extent(p.frame) / 60};
  // The first term that is compared with data gives the readings.
  const auto with_data = std::find_if(p.objective.terms.begin(), p.objective.terms.end(),
                                      [](const Term& term) { return term.measured.has_value(); });
  if (with_data == p.objective.terms.end()) {
    out.guesses = best_of_map(p.objective, analyze(p.objective, m, s), wanted);
    out.solves = 2;
  } else {
    const GuessData data = read_data(body.shape, *with_data->measured, m, s);
    out.solves += static_cast<int>(data.responses.dual.size());
    Search search = search_in(data, m.mesh, wanted);
    out.guesses = search.guesses();
    out.explained = correct(search, p, wanted.spacing, out);
  }
  for (const Guess& g : out.guesses) draw_guess(g, out.design.drawn[g.drawn]);
  return out;
}

}  // namespace kerf
