// What was asked of a design against what its shape has. Volume by the exact area; a frozen region by the depth in it
// of the free boundary (samples, then golden sections along each side: the depth changes by no more than the way) and
// by points of a lattice that are void; thickness by touching discs; symmetry by the distance of images of points of
// every side from the boundary.

#include "optimize/constraints.hpp"

#include "geometry/plane.hpp"
#include "optimize/constraints/mirrored.hpp"
#include "optimize/constraints/thickness.hpp"
#include "optimize/loop/finish.hpp"
#include "optimize/loop/history_text.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace kerf {

namespace {

constexpr double of_frozen = 1e-9, of_images = 1e-12;  // lengths, of the extent of the frame, that do not count
constexpr double of_volume = 1e-4;                     // relative
constexpr int lattice = 48;                            // points across a frozen region

std::string place(const Vec2& x) {
  return fmt::format("({:.4g}, {:.4g})", x.x(), x.y());
}

/// Sides that the design drew: no label of the frame.
std::vector<bool> drawn_sides(const std::vector<DrawnSide>& sides, const Shape& frame) {
  std::vector<bool> drawn;
  for (const DrawnSide& s : sides) drawn.push_back(s.label == none || std::size_t(s.label) >= frame.labels.size());
  return drawn;
}

/// The largest value along a side of a function that changes by no more than the way.
struct Peak {
  double value, part;
};
template <typename F>
Peak peak_along(const DrawnSide& side, double step, double worth, const F& f) {
  const int n = std::max(4, int(std::ceil(length(side) / step)));
  const auto value = [&](double part) { return f(at(side, part)); };
  Peak best{-infinity, 0};
  for (int k = 0; k <= n; ++k)
    if (const double here = value(double(k) / n); here > best.value) best = {here, double(k) / n};
  if (best.value + length(side) / n < worth) return best;
  constexpr double golden = 0.6180339887498949;
  double low = std::max(0.0, best.part - 1.0 / n), high = std::min(1.0, best.part + 1.0 / n);
  for (int k = 0; k < 50; ++k) {
    const double a = high - golden * (high - low), b = low + golden * (high - low);
    if (value(a) > value(b))
      high = b;
    else
      low = a;
  }
  const double part = 0.5 * (low + high);
  if (const double here = value(part); here > best.value) best = {here, part};
  return best;
}

std::array<Vec2, 2> box_of_sides(const std::vector<DrawnSide>& sides) {
  std::array<Vec2, 2> box{Vec2::Constant(infinity), Vec2::Constant(-infinity)};
  for (const DrawnSide& s : sides)
    for (int k = 0; k <= 16; ++k) {
      const Vec2 x = at(s, k / 16.0);
      box[0] = box[0].cwiseMin(x);
      box[1] = box[1].cwiseMax(x);
    }
  return box;
}

/// Points of a lattice over the box of a region that lie in it, each with its depth there.
template <typename Visit>
void at_points_in(const Region& region, const Visit& visit) {
  const auto [low, high] = box_of_sides(region.sides());
  for (int i = 0; i < lattice; ++i)
    for (int k = 0; k < lattice; ++k) {
      const Vec2 x = low + Vec2((i + 0.5) / lattice, (k + 0.5) / lattice).cwiseProduct(high - low);
      if (const double in = region.depth(x); in > 0) visit(x, in);
    }
}

KeptConstraint of_volume_limit(const MeasuredDesign& d, double at_most) {
  KeptConstraint c{.kind = KeptConstraint::Kind::Volume,
                   .name = "volume",
                   .asked = at_most,
                   .got = d.frame ? area(d.shape) / area(*d.frame) : d.volume_fraction};
  c.kept = c.got <= at_most * (1 + (d.frame ? of_volume : feasible_violation));
  if (!c.kept) c.note = fmt::format("volume fraction {:.6g} > {:.6g}", c.got, at_most);
  return c;
}

KeptConstraint of_frozen_region(const MeasuredDesign& d, const Loop& frozen) {
  const Intrusion found = intrusion(d.shape, *d.frame, frozen);
  KeptConstraint c{
      .kind = KeptConstraint::Kind::Frozen, .name = "frozen " + frozen.name, .asked = 0, .got = found.depth};
  c.kept = c.got <= of_frozen * extent(*d.frame);
  if (c.kept) return c;
  c.at = found.at;
  c.note = fmt::format("conflict: \"{}\" is frozen, but void reaches {:.3g} into it at {}{}", frozen.name, found.depth,
                       place(found.at),
                       found.share > 0 ? fmt::format(", and {:.2g} % of it is void", 100 * found.share) : "");
  return c;
}

KeptConstraint of_void_region(const MeasuredDesign& d, const Loop& keep_out) {
  const Intrusion found = solid_in(d.shape, keep_out);
  KeptConstraint c{
      .kind = KeptConstraint::Kind::Void, .name = "keep_out " + keep_out.name, .asked = 0, .got = found.depth};
  c.kept = c.got <= of_frozen * extent(d.frame ? *d.frame : d.shape);
  if (c.kept) return c;
  c.at = found.at;
  c.note = fmt::format("conflict: \"{}\" stays void, but material reaches {:.3g} into it at {}", keep_out.name,
                       found.depth, place(found.at));
  return c;
}

KeptConstraint of_width(const MeasuredDesign& d, double asked, bool gaps) {
  const std::vector<DrawnSide> sides = sides_of(d.shape);
  const std::vector<bool> moves = drawn_sides(sides, *d.frame);
  Thinnest found;
  const double whole = extent(*d.frame);
  for (double most = 1.5 * asked; most < 2 * whole && !std::isfinite(found.width); most *= 2)
    found = thinnest(sides, moves, gaps, most);
  KeptConstraint c{.kind = KeptConstraint::Kind::Width,
                   .name = gaps ? "min_gap" : "min_feature",
                   .asked = asked,
                   .got = std::min(found.width, whole)};
  c.kept = c.got >= kept_thickness * asked;
  if (std::isfinite(found.width)) c.at = found.at;
  if (!c.kept)
    c.note = fmt::format("conflict: {} = {:.6g}, but a {} is {:.3g} {} at {}", c.name, asked, gaps ? "gap" : "member",
                         c.got, gaps ? "wide" : "thick", place(found.at));
  return c;
}

KeptConstraint of_mirror(const MeasuredDesign& d, const Mirror& mirror) {
  const Asymmetry found = asymmetry(d.shape, mirror);
  KeptConstraint c{
      .kind = KeptConstraint::Kind::Mirror, .name = "symmetry", .asked = 0, .got = found.distance, .at = found.at};
  // Points of flat arcs are known to the rounding of their centers.
  double flat = 0;
  for (const DrawnSide& s : sides_of(d.shape))
    if (s.arc) flat = std::max(flat, largest_radius(*s.arc));
  c.kept = c.got <= std::max(of_images * extent(*d.frame), 4 * std::numeric_limits<double>::epsilon() * flat);
  if (!c.kept)
    c.note =
        fmt::format("conflict: the design is not its own mirror image: its boundary lies {:.3g} from its image at {}",
                    c.got, place(found.at));
  return c;
}

}  // namespace

Intrusion intrusion(const Shape& design, const Shape& frame, const Loop& frozen) {
  const Region region(frozen), body(design), whole(frame);
  const auto [low, high] = box_of_sides(region.sides());
  const double size = (high - low).norm();
  Intrusion found;
  const std::vector<bool> drawn = drawn_sides(body.sides(), frame);
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    const DrawnSide& side = body.sides()[i];
    if (!drawn[i] || region.away(at(side, 0.5)) > length(side) + size) continue;
    // Nothing beyond the frame is asked for: where the boundary of the frame is nearer, that is how deep it is.
    const Peak peak = peak_along(side, size / 64, found.depth,
                                 [&](const Vec2& x) { return std::min(region.depth(x), whole.depth(x)); });
    if (peak.value > found.depth) found = {peak.value, at(side, peak.part), 0};
  }
  int solid = 0, empty = 0;
  at_points_in(region, [&](const Vec2& x, double in) {
    const double inside = std::min(in, whole.depth(x));
    if (!(inside > 0)) return;
    const double depth = body.depth(x);
    ++(depth < 0 ? empty : solid);
    // It may be void without any boundary in it.
    if (const double reach = std::min(inside, -depth); reach > found.depth) found.depth = reach, found.at = x;
  });
  if (empty > 0) found.share = double(empty) / (empty + solid);
  return found;
}

Intrusion solid_in(const Shape& design, const Loop& keep_out) {
  const Region region(keep_out), body(design);
  const auto [low, high] = box_of_sides(region.sides());
  const double size = (high - low).norm();
  Intrusion found;
  for (const DrawnSide& side : body.sides()) {
    if (region.away(at(side, 0.5)) > length(side) + size) continue;
    const Peak peak = peak_along(side, size / 64, found.depth, [&](const Vec2& x) { return region.depth(x); });
    if (peak.value > found.depth) found = {peak.value, at(side, peak.part), 0};
  }
  at_points_in(region, [&](const Vec2& x, double in) {
    // It may be solid without any boundary in it.
    if (const double reach = std::min(in, body.depth(x)); reach > found.depth) found.depth = reach, found.at = x;
  });
  return found;
}

Asymmetry asymmetry(const Shape& body, const Mirror& mirror) {
  const Region region(body);
  Asymmetry worst;
  for (const DrawnSide& side : region.sides())
    for (const double part : {0.0, 0.25, 0.5, 0.75}) {
      const Vec2 x = at(side, part);
      if (const double away = region.away(image_of(mirror, x)); away > worst.distance) worst = {away, x};
    }
  return worst;
}

std::vector<KeptConstraint> constraints_of(const MeasuredDesign& d, const OptimizeRequest& r) {
  std::vector<KeptConstraint> all;
  if (r.volume_at_most && *r.volume_at_most < 1) all.push_back(of_volume_limit(d, *r.volume_at_most));
  for (std::size_t k = 0; k < std::min(d.bounds.size(), r.bounds.size()); ++k) {
    const double most = r.bounds[k].at_most;
    KeptConstraint c{.kind = KeptConstraint::Kind::Bound, .name = r.bounds[k].name, .asked = most, .got = d.bounds[k]};
    c.kept = c.got - most < feasible_violation * std::max(std::abs(most), 1e-300);
    if (!c.kept) c.note = fmt::format("{} {:.6g} > {:.6g}", c.name, c.got, most);
    all.push_back(std::move(c));
  }
  if (d.shape.outline.sides.empty()) return all;
  for (const Loop& keep_out : r.keep_out) all.push_back(of_void_region(d, keep_out));
  if (!d.frame) return all;
  for (const Loop& frozen : r.level_set.frozen) all.push_back(of_frozen_region(d, frozen));
  if (r.level_set.min_feature > 0) all.push_back(of_width(d, r.level_set.min_feature, false));
  if (r.level_set.min_gap > 0) all.push_back(of_width(d, r.level_set.min_gap, true));
  if (r.level_set.mirror) all.push_back(of_mirror(d, *r.level_set.mirror));
  return all;
}

bool is_of_shape(const KeptConstraint& c) {
  return c.kind != KeptConstraint::Kind::Volume && c.kind != KeptConstraint::Kind::Bound;
}

bool is_broken(const KeptConstraint& c) {
  using enum KeptConstraint::Kind;
  return !c.kept && (c.kind == Frozen || c.kind == Void || c.kind == Mirror);
}

std::string conflicts(const std::vector<KeptConstraint>& all, bool of_shape) {
  std::vector<std::string> words;
  for (const KeptConstraint& c : all)
    if (!c.kept && (!of_shape || is_of_shape(c))) words.push_back(c.note);
  return join(words);
}

}  // namespace kerf
