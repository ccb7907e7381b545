// Points for the interior of a mesh: a hexagonal lattice per level of size, steps cap, cap/2, cap/4, ..., nested, each
// used where the target length rounds to its step in log2. The body's box is cut into squares as a quadtree; a square
// carries the pieces near it and a witness, a point of which it is known whether it lies in the body; whether another
// point does follows from the number of sides crossed on the way to it. Points nearer than .6 steps to a piece, or
// inside its diametral circle, are left out: they would be encroached upon, and the refinement would split that piece.
// Squares are visited depth first, so that points that follow each other are neighbours, which is what the
// triangulation needs to insert them in constant time.

#include "geometry/mesher/lattice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr double clear = 0.6;  // of the step, from every piece
constexpr double leaf = 8;     // width of the squares that are filled at once, in steps

/// Steps of level 0. The rows and columns are stretched a little to fit the bounding box, so that the lattice
/// continues the points on its sides.
struct Lattice {
  Vec2 origin;
  double column, row;
};

/// From 8 steps on the stretch is at most a sixteenth.
Lattice fit(const Vec2& low, const Vec2& high, double step) {
  const auto fitted = [](double length, double wanted) {
    const double count = std::round(length / wanted);
    return count >= 8 ? length / count : wanted;
  };
  return {low, fitted(high.x() - low.x(), step), fitted(high.y() - low.y(), step * std::sqrt(0.75))};
}

struct LatticeSquare {
  Vec2 low;
  double width;
};

/// Target lengths in a square: bounds.
struct Bounds {
  double low, high;
};

/// A point and whether it lies in the body: crossings counted from there say it of others.
struct Witness {
  Vec2 x;
  bool inside;
};

struct Filler {
  const Drawing& drawing;
  const Pieces& pieces;
  const SizeField& field;
  const Lattice lattice;
  const std::size_t most;
  std::vector<Vec2> found;

  int level(double h) const {
    return int(std::lround(std::log2(field.cap / h)));
  }

  /// Sides crossed on the way from x straight along one axis, then along the other, to y: odd or even.
  /// Half-open: an end of a piece that lies on the line counts for one of its two pieces.
  bool crosses(const Vec2& x, const Vec2& y, const std::vector<Index>& near) const {
    bool odd = false;
    const auto leg = [&](int axis, double at, double from, double to) {
      if (to < from) std::swap(from, to);
      for (const Index i : near) {
        const Piece& piece = pieces.pieces[std::size_t(i)];
        if (drawing.strands[std::size_t(piece.strand)].loop == none) continue;
        const Vec2 &a = pieces.points[std::size_t(piece.a)], &b = pieces.points[std::size_t(piece.b)];
        if ((a[1 - axis] > at) == (b[1 - axis] > at)) continue;
        const double cut = a[axis] + (at - a[1 - axis]) / (b[1 - axis] - a[1 - axis]) * (b[axis] - a[axis]);
        if (from <= cut && cut < to) odd = !odd;
      }
    };
    leg(0, x.y(), x.x(), y.x());
    leg(1, y.x(), x.y(), y.y());
    return odd;
  }

  bool is_clear(const Vec2& x, double step, const std::vector<Index>& near) const {
    for (const Index i : near) {
      const Vec2 &a = pieces.points[std::size_t(pieces.pieces[std::size_t(i)].a)],
                 &b = pieces.points[std::size_t(pieces.pieces[std::size_t(i)].b)];
      if ((a - x).dot(b - x) < 0 || distance(x, a, b) < clear * step) return false;
    }
    return true;
  }

  /// Half-open ranges of rows and columns: a point on the border of two squares belongs to one of them.
  void fill(const LatticeSquare& square, const Bounds& h, const std::vector<Index>& near, const Witness& witness) {
    const auto& [low, width] = square;
    for (int k = level(h.high); k <= level(h.low); ++k) {
      const bool sure = level(h.high) == level(h.low);
      const double scale = std::ldexp(1.0, -k), column = lattice.column * scale, row = lattice.row * scale;
      const auto first = std::int64_t(std::ceil((low.y() - lattice.origin.y()) / row));
      const auto last = std::int64_t(std::ceil((low.y() + width - lattice.origin.y()) / row)) - 1;
      for (std::int64_t j = first; j <= last; ++j) {
        const double y = lattice.origin.y() + double(j) * row;
        const double shift = lattice.origin.x() + (j % 2 != 0 ? column / 2 : 0);
        const auto left = std::int64_t(std::ceil((low.x() - shift) / column));
        const auto right = std::int64_t(std::ceil((low.x() + width - shift) / column)) - 1;
        for (std::int64_t i = left; i <= right; ++i) {
          const Vec2 x(shift + double(i) * column, y);
          if (!sure && level(size_at(field, x)) != k) continue;
          if (!near.empty() && (!is_clear(x, field.cap * scale, near) || crosses(witness.x, x, near) == witness.inside))
            continue;
          found.push_back(x);
        }
      }
    }
    if (found.size() > most)
      throw Error(Fault::Geometry, fmt::format("the mesh would have more than {} triangles; raise mesh.size or "
                                               "mesh.crack_tip_size, or widen what is narrow",
                                               2 * most));
  }

  /// With the pieces and the witness of the parent square.
  void visit(const LatticeSquare& square, const std::vector<Index>& near_parent, const Witness& witness) {
    const auto& [low, width] = square;
    const Vec2 center = low.array() + width / 2;
    const double radius = width * std::sqrt(0.5), h = size_at(field, center);
    // Within the square h lies between h - change and h + change; where h_low is small against h_high the square is cut
    // further.
    const double change = steepest(field, center, radius) * radius;
    const double h_low = h - change, h_high = std::min(largest_size(field, center, radius), h + change);
    const Witness here{center, witness.inside != crosses(witness.x, center, near_parent)};
    std::vector<Index> near;
    for (const Index i : near_parent) {
      const Vec2 &a = pieces.points[std::size_t(pieces.pieces[std::size_t(i)].a)],
                 &b = pieces.points[std::size_t(pieces.pieces[std::size_t(i)].b)];
      const double reach = radius + std::max(1.5 * clear * h_high, (b - a).norm() / 2);
      if (distance(center, a, b) <= reach) near.push_back(i);
    }
    if (near.empty() && !here.inside) return;
    // Small squares where h varies, so that h_low stays positive and few levels meet in one.
    if (width > leaf * h_high || (h_low < h_high && (h_low < 0.3 * h_high) && width > 1e-3 * h)) {
      for (int q = 0; q < 4; ++q) visit({low + width / 2 * Vec2(q & 1, q >> 1), width / 2}, near, here);
      return;
    }
    fill(square, {std::max(h_low, 0.25 * h), h_high}, near, here);
  }
};

}  // namespace

std::vector<Vec2> lattice_points(const Drawing& drawing, const Pieces& pieces, const SizeField& field,
                                 std::size_t most) {
  Vec2 low = pieces.points.front(), high = low;
  for (const Piece& piece : pieces.pieces) {
    low = low.cwiseMin(pieces.points[std::size_t(piece.a)]);
    high = high.cwiseMax(pieces.points[std::size_t(piece.a)]);
  }
  std::vector<Index> all(pieces.pieces.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = Index(i);
  Filler filler{drawing, pieces, field, fit(low, high, field.cap), most, {}};
  // Odd numbers: no square's center, from which crossings are counted, is likely to lie on a side.
  const double size = (high - low).maxCoeff();
  const Vec2 corner = low - size * Vec2(0.0127432, 0.0171931);
  filler.visit({corner, 1.0418273 * size}, all, {corner, false});
  return std::move(filler.found);
}

}  // namespace kerf
