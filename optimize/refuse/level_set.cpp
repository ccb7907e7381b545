// What is wrong with a level-set request before anything is meshed: start holes that leave no body or cut the loads
// off, frozen parts that cover it all or more than the area allowed, lengths larger than the body, a boundary of which
// nothing can move. Nothing is refused on a sample alone. The body is covered by at most 200 squares along its longer
// side, each with the depth of its middle, and a depth changes by no more than the way to a corner (`slack`): start
// holes count as smaller, what stays solid as larger than they are, frozen parts as smaller where their share is
// bounded below. Squares that touch at a corner hang together, so that what is found to be cut off is cut off. The
// rules are listed in optimize/refuse.hpp.

#include "optimize/level_set/start.hpp"
#include "optimize/loop/evaluate.hpp"
#include "optimize/refuse/methods.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

/// Squares over the bounding box of the body, each with the depth of its middle.
struct Lattice {
  Vec2 low;
  double cell = 0, chord = 0;
  int columns = 0, rows = 0;
  std::vector<double> depth;

  double slack() const {  // from the middle to a corner, and of the depths
    return cell * std::sqrt(0.5) + chord;
  }
  Vec2 middle(int i, int k) const {
    return low + cell * Vec2(i + 0.5, k + 0.5);
  }
  int at(int i, int k) const {
    return i + columns * k;
  }
};

// Squares, 200 along the longer side of the box.
Lattice lattice_over(const Shape& body, double chord) {
  constexpr int across = 200;
  const auto [low, high] = box_of(body.outline);
  Lattice l{.low = low, .cell = (high - low).maxCoeff() / across, .chord = chord};
  l.columns = static_cast<int>(std::ceil((high - low).x() / l.cell));
  l.rows = static_cast<int>(std::ceil((high - low).y() / l.cell));
  const Depth depth(body, chord);
  for (int k = 0; k < l.rows; ++k)
    for (int i = 0; i < l.columns; ++i) l.depth.push_back(depth(l.middle(i, k)));
  return l;
}

/// Sides with one of some labels.
struct Sides {
  std::vector<std::array<Vec2, 2>> segments;
  double away(const Vec2& x) const {
    double least = infinity;
    for (const auto& [a, b] : segments) least = std::min(least, distance(x, a, b));
    return least;
  }
};
Sides sides_of(const Shape& body, const std::vector<Index>& labels, double chord) {
  Sides out;
  const auto add = [&](const Loop& loop) {
    const Polygon p = flatten(loop, chord, infinity);
    for (std::size_t i = 0; i < p.points.size(); ++i)
      if (std::ranges::find(labels, p.label[i]) != labels.end())
        out.segments.push_back({p.points[i], p.points[(i + 1) % p.points.size()]});
  };
  add(body.outline);
  for (const Loop& hole : body.holes) add(hole);
  return out;
}

/// What bears loads or is looked at stays solid.
std::vector<Index> solid_labels(const Problem& p, const OptimizeRequest& r) {
  std::vector<Index> labels;
  for (const Scene& scene : scenes_of(p, r))
    for (const Traction& t : scene.tractions) labels.push_back(t.label);
  const auto add = [&labels](const Functional& j) {
    for (const Term& term : j.terms) {
      if (term.label != none) labels.push_back(term.label);
      if (term.measured) labels.push_back(term.measured->label);
    }
  };
  add(p.objective);
  for (const FunctionalBound& bound : r.bounds) add(bound.functional);
  return labels;
}

/// Pieces of what may be solid: 0, 1, ... per square, -1 elsewhere. Squares that touch at a corner hang together.
std::vector<int> pieces_of(const Lattice& l, const std::vector<bool>& solid) {
  std::vector<int> piece(solid.size(), -1);
  int count = 0;
  for (int start = 0; start < static_cast<int>(solid.size()); ++start) {
    if (!solid[static_cast<std::size_t>(start)] || piece[static_cast<std::size_t>(start)] >= 0) continue;
    std::vector<int> left{start};
    piece[static_cast<std::size_t>(start)] = count;
    while (!left.empty()) {
      const int at = left.back(), i = at % l.columns, k = at / l.columns;
      left.pop_back();
      for (int y = std::max(0, k - 1); y <= std::min(l.rows - 1, k + 1); ++y)
        for (int x = std::max(0, i - 1); x <= std::min(l.columns - 1, i + 1); ++x) {
          const auto other = static_cast<std::size_t>(l.at(x, y));
          if (!solid[other] || piece[other] >= 0) continue;
          piece[other] = count;
          left.push_back(l.at(x, y));
        }
    }
    ++count;
  }
  return piece;
}

/// The holes to begin with leave no body, or one that hangs together nowhere between a load and a support. They count
/// as smaller than they are, by the squares: what is refused here is so.
void look_at_start(const Problem& p, const OptimizeRequest& r, const Lattice& l, std::vector<Wrong>& all) {
  const double chord = l.chord, slack = l.slack();
  const auto [low, high] = box_of(p.frame.outline);
  const std::vector<Disc> discs = start_discs(*r.level_set.start, low, high);
  const std::vector<Index> loaded = solid_labels(p, r);
  const Sides near_loads = sides_of(p.frame, loaded, chord);
  std::vector<Depth> masks;
  for (const Loop& loop : r.level_set.frozen) masks.emplace_back(loop, chord);
  const double strip = 2 * target_size(p.sizing, p.frame) + slack;  // at least what stays beside loads
  // unholed: what the holes may leave; solid: with what stays whatever the holes take.
  std::vector<bool> solid(l.depth.size(), false), unholed(l.depth.size(), false);
  for (int k = 0; k < l.rows; ++k)
    for (int i = 0; i < l.columns; ++i) {
      const auto at = static_cast<std::size_t>(l.at(i, k));
      // Squares that surely lie outside are left out; all others may have some of the body.
      if (l.depth[at] < -slack) continue;
      const Vec2 x = l.middle(i, k);
      unholed[at] =
          std::ranges::none_of(discs, [&](const Disc& d) { return (x - d.center).norm() < d.radius - slack; });
      solid[at] = unholed[at] || near_loads.away(x) < strip ||
                  std::ranges::any_of(masks, [&](const Depth& m) { return m(x) > -slack; });
    }
  const auto refuse = [&all](const char* what) {
    all.push_back(
        {"optimize.start", fmt::format("start in [optimize]: the holes {}; use fewer or smaller ones", what)});
  };
  if (std::ranges::none_of(unholed, [](bool here) { return here; })) return refuse("leave no body to begin with");
  std::vector<Index> held;
  for (const Support& s : p.scene.supports) held.push_back(s.label);
  // Without supports there is nothing that loads could be cut off from.
  if (held.empty()) return;
  const std::vector<int> piece = pieces_of(l, solid);
  const auto touched = [&](const std::vector<Index>& labels) {
    const Sides sides = sides_of(p.frame, labels, chord);
    std::vector<int> out;
    for (int k = 0; k < l.rows; ++k)
      for (int i = 0; i < l.columns; ++i)
        // A piece touches a side when some square of it comes within two slacks: more than surely touches.
        if (const int here = piece[static_cast<std::size_t>(l.at(i, k))];
            here >= 0 && std::ranges::find(out, here) == out.end() && sides.away(l.middle(i, k)) < 2 * slack)
          out.push_back(here);
    return out;
  };
  // Pieces that a support holds; a load none of whose pieces is among them hangs on nothing.
  const std::vector<int> supported = touched(held);
  if (supported.empty()) return refuse("take away all that the supports hold");
  for (const Scene& scene : scenes_of(p, r))
    for (const Traction& t : scene.tractions) {
      const std::vector<int> pulled = touched({t.label});
      if (std::ranges::find_first_of(pulled, supported) == pulled.end())
        return refuse("cut the loads off from the supports");
    }
}

/// The shares of the body that surely is frozen, and whether surely all of it is.
void look_at_frozen(const Problem& p, const OptimizeRequest& r, const Lattice& l, std::vector<Wrong>& all) {
  const double chord = l.chord, slack = l.slack();
  std::vector<Depth> masks;
  for (std::size_t k = 0; k < r.level_set.frozen.size(); ++k) {
    if (auto why = wrong_mask(p.frame, r.level_set.frozen[k]))
      all.push_back(
          {fmt::format("optimize.frozen[{}]", k), fmt::format("entry {} of frozen in [optimize]: {}", k + 1, *why)});
    else
      masks.emplace_back(r.level_set.frozen[k], chord);
  }
  double frozen = 0;
  bool everything = !masks.empty();
  for (int k = 0; k < l.rows; ++k)
    for (int i = 0; i < l.columns; ++i) {
      const double depth = l.depth[static_cast<std::size_t>(l.at(i, k))];
      if (depth < -slack) continue;
      const Vec2 x = l.middle(i, k);
      const bool in = std::ranges::any_of(masks, [&](const Depth& m) { return m(x) > slack; });
      // Only squares that surely lie both in the body and in a frozen part.
      if (in && depth > slack) frozen += l.cell * l.cell;
      everything = everything && in;
    }
  if (everything)
    all.push_back({"optimize.frozen",
                   "frozen in [optimize]: the regions together cover the whole body: nothing is "
                   "left to design"});
  // A lower bound of the share.
  const double share = frozen / area(p.frame);
  if (!everything && r.volume_at_most && share > *r.volume_at_most)
    all.push_back({"optimize.volume.at_most",
                   fmt::format("at_most in volume in [optimize] = {:g} is less than the share of the body that is "
                               "frozen, at least {:.3g}; allow more, or freeze less",
                               *r.volume_at_most, share)});
}

// Lengths that no design of this body can keep.
void look_at_lengths(const Problem& p, const OptimizeRequest& r, std::vector<Wrong>& all) {
  const double size = extent(p.frame);
  const auto [low, high] = box_of(p.frame.outline);
  // A member is no wider than twice the largest depth.
  const double widest = 2 * Depth(p.frame, 1e-4 * size).most(low, high);
  if (r.level_set.min_feature > widest)
    all.push_back({"optimize.min_feature",
                   fmt::format("min_feature in [optimize] = {:g} is more than the body is wide anywhere ({:.3g} at "
                               "most): no design has such members; use less",
                               r.level_set.min_feature, widest)});
  if (r.level_set.smoothing >= size)
    all.push_back({"optimize.smoothing", fmt::format("smoothing in [optimize] = {:g} must be smaller than the body, "
                                                     "whose diagonal is {:g}",
                                                     r.level_set.smoothing, size)});
}

/// All sides bear loads, no hole ever appears: nothing can move.
void look_at_boundary(const Problem& p, const OptimizeRequest& r, std::vector<Wrong>& all) {
  if (r.level_set.nucleate_every > 0 || r.level_set.start ||
      r.level_set.move == LevelSetRequest::Move::FixedPoint)  // which nucleates everywhere
    return;
  const std::vector<Index> solid = solid_labels(p, r);
  const auto stays = [&](const Loop& loop) {
    return std::ranges::all_of(loop.sides,
                               [&](const Side& s) { return std::ranges::find(solid, s.label) != solid.end(); });
  };
  if (stays(p.frame.outline) && std::ranges::all_of(p.frame.holes, stays))
    all.push_back({"optimize.nucleate",
                   "nucleate in [optimize] = false: no side of the body is free of loads, and "
                   "without holes nothing can move; leave it out, or add start = { holes = "
                   "[columns, rows], radius = r }"});
}

}  // namespace

void look_at_level_set(const Problem& p, const OptimizeRequest& r, bool drawable, std::vector<Wrong>& all) {
  const LevelSetRequest& how = r.level_set;
  if (const auto why = refusal(p.element, can_optimize)) all.push_back({"solver.element", *why});
  if (how.ersatz > 0 && how.move != LevelSetRequest::Move::FixedPoint)
    all.push_back({"optimize.ersatz",
                   "ersatz in [optimize]: a weak phase is moved by the fixed point only; add move = "
                   "\"fixed-point\", or leave ersatz out"});
  if (how.ersatz > 0 && !p.frame.regions.empty())
    all.push_back({"optimize.ersatz",
                   "ersatz in [optimize] does not go with [[region]], which has a material of its "
                   "own; remove one of them"});
  if (how.nucleate_every > 0 && !(how.nucleate_fraction > 0 && how.nucleate_fraction <= 0.5))
    all.push_back({"optimize.nucleate.fraction",
                   fmt::format("fraction in nucleate in [optimize] = {:g} is the share of the area that one nucleation "
                               "may take; it must be positive and not larger than 0.5",
                               how.nucleate_fraction)});
  look_at_boundary(p, r, all);
  if (!drawable) return;
  if (how.mirror)
    if (const auto why = wrong_mirror(p.frame, *how.mirror))
      all.push_back({"optimize.symmetry", "symmetry in [optimize]: " + *why});
  look_at_lengths(p, r, all);
  if (how.frozen.empty() && !how.start) return;
  const Lattice l = lattice_over(p.frame, 1e-4 * extent(p.frame));
  look_at_frozen(p, r, l, all);
  if (how.start) look_at_start(p, r, l, all);
}

}  // namespace kerf
