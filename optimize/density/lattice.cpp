// A body on square cells, in units of its own: lengths in cells, the stiffest shear modulus 1, the largest nodal force
// 1, all rounded to 2^-36, so that the units of the case change no bit of the result. The share of a cell in the frame
// is exact: int x dy along the sides, cut at the lines of the lattice, cell by cell. The number of cells is chosen near
// the one wanted such that sides parallel to the axes and ends of sides lie on lines. Tractions are integrated in the
// bilinear functions, supports are springs along the sides, beta/2 int |P u|^2 ds with beta = 1e3 mu/h [theory: P.1],
// so that no node needs to lie on a side. The bulk modulus is at most five times the shear modulus: nearly
// incompressible cells would lock. Cells on cracks that are not bonded are a hundred times softer. Derived in
// docs/theory/density.md, section "Lattice".

#include "optimize/density/lattice.hpp"

#include "geometry/plane.hpp"
#include "optimize/level_set/solid.hpp"
#include "optimize/loop/evaluate.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr double grid = 0x1p36;           // places, moduli and forces are multiples of 1/grid of the largest
constexpr double snap = 1e-6;             // of a cell: nearer to a line of the lattice lies on it
constexpr double least_part = 1e-4;       // cells with less of the body do not count
constexpr double loaded_part = 0.05;      // of the stiffness of a cell with loads or supports, at least
constexpr double hold = 1e3;              // stiffness of supports per length, relative to the material's over a cell
constexpr double crack_stiffness = 1e-2;  // of cells on a crack
constexpr double stiffest_bulk = 5;       // of bulk against shear modulus: nu = 0.4 in plane strain, against locking

double rounded(double x) {
  return std::round(x * grid) / grid;
}

/// From the body's units to shares of the longer side of its bounding box.
struct Box {
  Vec2 low;
  double length;
  Vec2 size;  // relative
  Vec2 relative(const Vec2& x) const {
    return ((x - low) / length).unaryExpr(&rounded);
  }
};

Box bounding_box(const Polygon& outline) {
  Vec2 low = Vec2::Constant(infinity), high = -low;
  for (const Vec2& x : outline.points) low = low.cwiseMin(x), high = high.cwiseMax(x);
  const double length = (high - low).maxCoeff();
  return {low, length, ((high - low) / length).unaryExpr(&rounded)};
}

/// Loops of the frame with the body on their left, straight pieces.
struct Outlines {
  std::vector<Polygon> loops;
};

// Holes are reversed, and labels moved by one with them: a label belongs to the side that begins at its point.
Outlines outlines(const Shape& frame, double chord) {
  Outlines o;
  o.loops.push_back(flatten(frame.outline, chord, infinity));
  for (const Loop& hole : frame.holes) {
    Polygon p = flatten(hole, chord, infinity);
    std::reverse(p.points.begin(), p.points.end());
    std::reverse(p.label.begin(), p.label.end());
    std::rotate(p.label.begin(), p.label.begin() + 1, p.label.end());
    o.loops.push_back(std::move(p));
  }
  return o;
}

double area_of(const Outlines& o) {
  double twice = 0;
  for (const Polygon& p : o.loops)
    for (std::size_t i = 0; i < p.points.size(); ++i) twice += cross(p.points[i], p.points[(i + 1) % p.points.size()]);
  return twice / 2;
}

/// Cells along the longer side of the box, near the number wanted, for which sides that are parallel to the axes lie on
/// lines of the lattice.
Index cells_along(const Outlines& relative, double wanted) {
  const Index low = std::max<Index>(2, static_cast<Index>(std::floor(0.92 * wanted)));
  const Index high = std::max<Index>(low + 1, static_cast<Index>(std::ceil(1.15 * wanted)));
  Index best = low;
  double least = infinity;
  for (Index n = low; n <= high; ++n) {
    // Weights of what is off a line: the lengths of parallel sides in full, ends of sides by 1/50, the number itself by
    // 1/20.
    double misfit = 0.05 * std::abs(n / wanted - 1);
    for (const Polygon& p : relative.loops)
      for (std::size_t i = 0; i < p.points.size(); ++i) {
        const Vec2 &a = p.points[i], &b = p.points[(i + 1) % p.points.size()];
        for (int k = 0; k < 2; ++k)
          if (a[k] == b[k]) misfit += std::abs(a[1 - k] - b[1 - k]) * std::abs(a[k] * n - std::round(a[k] * n));
        // Ends of sides: there begin loads and supports.
        for (int k = 0; k < 2; ++k) misfit += 0.02 * std::abs(a[k] * n - std::round(a[k] * n));
      }
    if (misfit < least - 1e-6) least = misfit, best = n;
  }
  return best;
}

Vec2 snapped(Vec2 x) {
  for (int k = 0; k < 2; ++k)
    if (std::abs(x[k] - std::round(x[k])) < snap) x[k] = std::round(x[k]);
  return x;
}

/// Part of a side of the frame within one cell.
struct Piece {
  Vec2 a, b;
  Index cell, label;
  Vec2 outward() const {
    const Vec2 d = (b - a).normalized();
    return {d.y(), -d.x()};
  }
};

/// Sides cut at the lines of the lattice; those on a line belong to the cell on their left, in which the body is.
std::vector<Piece> pieces_of(const Outlines& in_cells, Index columns, Index rows) {
  std::vector<Piece> pieces;
  for (const Polygon& p : in_cells.loops)
    for (std::size_t i = 0; i < p.points.size(); ++i) {
      const Vec2 a = p.points[i], b = p.points[(i + 1) % p.points.size()];
      std::vector<double> at{0, 1};
      for (int k = 0; k < 2; ++k) {
        const auto [low, high] = std::minmax(a[k], b[k]);
        for (double line = std::floor(low) + 1; line < high; ++line) at.push_back((line - a[k]) / (b[k] - a[k]));
      }
      std::sort(at.begin(), at.end());
      // A point 1/1000 of a cell to the left decides which cell a piece on a line belongs to.
      const Vec2 left = 1e-3 * Vec2(a.y() - b.y(), b.x() - a.x()).normalized();
      for (std::size_t s = 0; s + 1 < at.size(); ++s) {
        const Vec2 from = at[s] == 0 ? a : snapped(a + at[s] * (b - a));
        const Vec2 to = at[s + 1] == 1 ? b : snapped(a + at[s + 1] * (b - a));
        if ((to - from).norm() < snap) continue;
        const Vec2 middle = (from + to) / 2 + left;
        const Index column = std::clamp<Index>(static_cast<Index>(std::floor(middle.x())), 0, columns - 1);
        const Index row = std::clamp<Index>(static_cast<Index>(std::floor(middle.y())), 0, rows - 1);
        pieces.push_back({from, to, column + columns * row, p.label[i]});
      }
    }
  return pieces;
}

/// Share of every cell to the left of the pieces: the integral of x dy along them, cell by cell.
Eigen::VectorXd parts_of(const std::vector<Piece>& pieces, Index columns, Index rows) {
  Eigen::VectorXd part = Eigen::VectorXd::Zero(std::int64_t{columns} * rows), whole = part;
  for (const Piece& p : pieces) {
    // A piece adds its share within its own cell, and its whole height to all cells on its left, which are summed from
    // the right.
    const double height = p.b.y() - p.a.y(), x = (p.a.x() + p.b.x()) / 2;
    if (height == 0) continue;
    const Index row = std::clamp<Index>(static_cast<Index>(std::floor((p.a.y() + p.b.y()) / 2)), 0, rows - 1);
    const Index column = static_cast<Index>(std::floor(x));
    if (column < columns) part[column + columns * row] += height * (x - column);
    if (column > 0) whole[std::min(column, columns) - 1 + columns * row] += height;
  }
  for (Index row = 0; row < rows; ++row) {
    double sum = 0;
    for (Index column = columns - 1; column >= 0; --column) {
      sum += whole[column + columns * row];
      double& share = part[column + columns * row];
      share = std::clamp(rounded(share + sum), 0.0, 1.0);
      if (share < least_part) share = 0;
    }
  }
  return part;
}

/// Values of the four bilinear functions of a cell.
Eigen::Vector4d bilinear(const Vec2& x, Index column, Index row) {
  const double s = x.x() - column, t = x.y() - row;
  return {(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t};
}

double signed_distance(const std::vector<Vec2>& polygon, const Vec2& x) {
  double least = infinity;
  for (std::size_t i = 0; i < polygon.size(); ++i)
    least = std::min(least, distance(x, polygon[i], polygon[(i + 1) % polygon.size()]));
  return inside(polygon, x) ? -least : least;
}

class Builder {
 public:
  Builder(const Problem& p, const OptimizeRequest& r, double cells);
  Lattice build(bool cracks);

 private:
  Vec2 in_cells(const Vec2& x) const {
    return snapped(box_.relative(x) * along_);
  }
  Vec2 in_body(const Vec2& x) const {
    return l_.origin + l_.cell * x;
  }
  std::vector<Vec2> polygon_of(const Loop& loop) const;
  bool carries(Index label) const;
  void materials();
  void supports();
  void loads();
  void solids();
  void neighbors();
  void weaken_cracks();
  template <typename Visit>
  void at_gauss_points(Index label, const Visit& visit) const;

  const Problem& p_;
  const OptimizeRequest& r_;
  std::vector<Scene> scenes_;
  Box box_;
  double along_ = 0;
  double modulus_unit_ = 1;
  std::vector<Piece> pieces_;
  Lattice l_;
};

// Outlines in shares of the box, then in cells: rounding comes before anything is cut.
Builder::Builder(const Problem& p, const OptimizeRequest& r, double cells) : p_(p), r_(r), scenes_(scenes_of(p, r)) {
  const double chord = 2e-5 * extent(p.frame);
  Outlines all = outlines(p.frame, chord);
  box_ = bounding_box(all.loops.front());
  for (Polygon& loop : all.loops)
    for (Vec2& x : loop.points) x = box_.relative(x);
  const double area = area_of(all);
  const Index n = cells_along(all, std::sqrt(cells / area));
  along_ = n;
  // The longer side of the box has the number of cells that was chosen, the other one as many as cover it.
  const int shorter = box_.size.x() < box_.size.y() ? 0 : 1;
  const Index m = std::max<Index>(1, static_cast<Index>(std::ceil(box_.size[shorter] * n - snap)));
  l_.columns = shorter == 0 ? m : n;
  l_.rows = shorter == 0 ? n : m;
  l_.cell = box_.length / n;
  l_.origin = box_.low;
  for (Polygon& loop : all.loops)
    for (Vec2& x : loop.points) x = snapped(x * along_);
  pieces_ = pieces_of(all, l_.columns, l_.rows);
  l_.part = parts_of(pieces_, l_.columns, l_.rows);
}

std::vector<Vec2> Builder::polygon_of(const Loop& loop) const {
  std::vector<Vec2> points = flatten(loop, 2e-5 * box_.length, infinity).points;
  for (Vec2& x : points) x = in_cells(x);
  return points;
}

// Moduli over the largest shear modulus, times the share of the cell in the body.
void Builder::materials() {
  std::vector<std::vector<Vec2>> regions;
  for (const Loop& region : p_.frame.regions) regions.push_back(polygon_of(region));
  modulus_unit_ = 0;
  for (const Material& m : all_materials(p_.scene)) modulus_unit_ = std::max(modulus_unit_, m.mu);
  l_.mu = Eigen::VectorXd::Zero(l_.part.size());
  l_.lambda = l_.mu;
  Eigen::VectorXd share = l_.part;
  for (const Piece& piece : pieces_)
    if (piece.label != none && carries(piece.label)) {
      // A sliver that bears a load or a support must not vanish.
      l_.part[piece.cell] = std::max(l_.part[piece.cell], least_part);
      share[piece.cell] = std::max(share[piece.cell], loaded_part);
    }
  for (Index c = 0; c < static_cast<Index>(l_.part.size()); ++c) {
    if (l_.part[c] == 0) continue;
    l_.cells.push_back(c);
    const Material* m = &p_.scene.material;
    double smallest = infinity;  // of nested regions the innermost counts
    for (std::size_t i = 0; i < regions.size(); ++i) {
      const double d = signed_distance(regions[i], l_.center(c));
      if (d < 0 && -d < smallest) smallest = -d, m = &p_.scene.regions.at(i);
    }
    // lambda = bulk - mu with bulk = 1/(4c) over mu [theory: N.4], in units of mu.
    const double bulk = std::min(m->c > 0 ? 1 / (4 * m->c * m->mu) : infinity, stiffest_bulk);
    l_.mu[c] = rounded(m->mu / modulus_unit_) * share[c];
    l_.lambda[c] = rounded(bulk - 1) * l_.mu[c];
  }
}

bool Builder::carries(Index label) const {
  const auto on = [label](const auto& x) { return x.label == label; };
  return std::any_of(p_.scene.supports.begin(), p_.scene.supports.end(), on) ||
         std::any_of(scenes_.begin(), scenes_.end(),
                     [&](const Scene& s) { return std::any_of(s.tractions.begin(), s.tractions.end(), on); });
}

/// visit(place in cells, outward normal, length, corners of the cell, their bilinear functions) at two Gauss points of
/// every piece of a label.
template <typename Visit>
void Builder::at_gauss_points(Index label, const Visit& visit) const {
  for (const Piece& piece : pieces_) {
    if (piece.label != label) continue;
    const double length = (piece.b - piece.a).norm();
    for (const double t : {0.5 - std::sqrt(1 / 12.0), 0.5 + std::sqrt(1 / 12.0)}) {
      const Vec2 x = piece.a + t * (piece.b - piece.a);
      visit(x, piece.outward(), length / 2, l_.corners(piece.cell),
            bilinear(x, piece.cell % l_.columns, piece.cell / l_.columns));
    }
  }
}

/// Springs along the label instead of a displacement prescribed.
void Builder::supports() {
  for (const Support& support : p_.scene.supports)
    at_gauss_points(support.label, [&](const Vec2&, const Vec2& n, double length, const std::array<Index, 4>& corners,
                                       const Eigen::Vector4d& value) {
      const Vec2 first = support.normal_frame ? n : Vec2(1, 0), second(-first.y(), first.x());
      // P, the projection on the held directions.
      Mat2 along = Mat2::Zero();
      if (support.first) along += first * first.transpose();
      if (support.second) along += second * second.transpose();
      for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 4; ++k)
          for (int a = 0; a < 2; ++a)
            for (int b = 0; b < 2; ++b)
              if (const double stiffness = hold * length * value[i] * value[k] * along(a, b); stiffness != 0)
                l_.springs.push_back({2 * corners[static_cast<std::size_t>(i)] + a,
                                      2 * corners[static_cast<std::size_t>(k)] + b, stiffness});
    });
}

// int of traction times the bilinear functions; body force stays per cell, since it goes with the density.
void Builder::loads() {
  l_.force.setZero(2 * l_.nodes(), static_cast<Eigen::Index>(scenes_.size()));
  for (std::size_t k = 0; k < scenes_.size(); ++k) {
    for (const Traction& t : scenes_[k].tractions)
      at_gauss_points(t.label, [&](const Vec2& x, const Vec2& n, double length, const std::array<Index, 4>& corners,
                                   const Eigen::Vector4d& value) {
        const Vec2 f = t.value(in_body(x), n) * (length * l_.cell);
        for (std::size_t i = 0; i < 4; ++i)
          l_.force.block<2, 1>(2 * corners[i], static_cast<Eigen::Index>(k)) += value[static_cast<Eigen::Index>(i)] * f;
      });
    Points body = Points::Zero(2, l_.part.size());
    if (scenes_[k].body)
      for (const Index c : l_.cells)
        body.col(c) = scenes_[k].body(in_body(l_.center(c))) * (l_.part[c] * l_.cell * l_.cell);
    if (!body.isZero(0)) l_.body.resize(scenes_.size(), Points::Zero(2, l_.part.size()));
    if (!l_.body.empty()) l_.body[k] = std::move(body);
  }
  double largest = l_.force.size() > 0 ? l_.force.cwiseAbs().maxCoeff() : 0;
  for (const Points& body : l_.body) largest = std::max(largest, body.cwiseAbs().maxCoeff());
  if (largest > 0) {
    l_.force = (l_.force / largest).unaryExpr(&rounded);
    for (Points& body : l_.body) body = (body / largest).unaryExpr(&rounded);
  }
  // f . u is largest^2 / modulus in the body's units where it is 1 on the lattice.
  l_.compliance_unit = largest * largest / modulus_unit_;
  l_.force_unit = largest;
}

// What the level set keeps solid, by centers of cells, and the cells along labels that must stay.
void Builder::solids() {
  l_.solid.assign(static_cast<std::size_t>(l_.part.size()), 0);
  std::vector<std::string> notes;
  const Solid keep = solid_parts(p_, r_, l_.cell, notes);
  std::vector<std::pair<std::vector<Vec2>, double>> loops;
  for (const auto& [loop, margin] : keep.loops) loops.emplace_back(polygon_of(loop), margin / l_.cell);
  for (const Index c : l_.cells) {
    const Vec2 x = l_.center(c);
    bool solid = false;
    for (const auto& [polygon, margin] : loops) solid = solid || signed_distance(polygon, x) < margin;
    for (const auto& [center, radius] : keep.discs) solid = solid || (x - in_cells(center)).norm() < radius / l_.cell;
    l_.solid[static_cast<std::size_t>(c)] = solid;
  }
  for (const Piece& piece : pieces_)
    if (std::find(keep.labels.begin(), keep.labels.end(), piece.label) != keep.labels.end())
      l_.solid[static_cast<std::size_t>(piece.cell)] = 1;
}

/// Cells through which a crack runs, whether it opens or closes.
void Builder::weaken_cracks() {
  std::vector<char> weak(static_cast<std::size_t>(l_.part.size()), 0);
  for (std::size_t k = 0; k < p_.frame.cracks.size(); ++k) {
    if (k < p_.scene.laws.size() && p_.scene.laws[k].kind == CrackLaw::Kind::Bonded) continue;
    const Crack& crack = p_.frame.cracks[k];
    const std::vector<Vec2> path = crack.arc ? points_on(*crack.arc, 64) : crack.points;
    for (std::size_t i = 1; i < path.size(); ++i) {
      const Vec2 a = in_cells(path[i - 1]), b = in_cells(path[i]);
      // Twenty samples per cell: a corner that a crack just cuts may be missed.
      const int samples = 1 + static_cast<int>(std::ceil(20 * (b - a).norm()));
      for (int s = 0; s <= samples; ++s) {
        const Vec2 x = a + (b - a) * s / samples;
        const Index column = std::clamp<Index>(static_cast<Index>(std::floor(x.x())), 0, l_.columns - 1);
        const Index row = std::clamp<Index>(static_cast<Index>(std::floor(x.y())), 0, l_.rows - 1);
        weak[static_cast<std::size_t>(column + l_.columns * row)] = 1;
      }
    }
  }
  for (const Index c : l_.cells)
    if (weak[static_cast<std::size_t>(c)]) l_.mu[c] *= crack_stiffness, l_.lambda[c] *= crack_stiffness;
}

/// The nearest cell of the body for every cell, by a front from all of them.
/// Densities are interpolated beyond the border of the body by those of the nearest cells in it.
void Builder::neighbors() {
  l_.inside.assign(static_cast<std::size_t>(l_.part.size()), none);
  std::vector<Index> front = l_.cells;
  for (const Index c : front) l_.inside[static_cast<std::size_t>(c)] = c;
  for (std::size_t i = 0; i < front.size(); ++i) {
    const Index column = front[i] % l_.columns, row = front[i] / l_.columns;
    for (const auto& [x, y] : {std::pair{column - 1, row}, {column + 1, row}, {column, row - 1}, {column, row + 1}}) {
      if (x < 0 || x >= l_.columns || y < 0 || y >= l_.rows) continue;
      Index& of = l_.inside[static_cast<std::size_t>(x + l_.columns * y)];
      if (of != none) continue;
      of = l_.inside[static_cast<std::size_t>(front[i])];
      front.push_back(x + l_.columns * y);
    }
  }
}

// Cracks weaken moduli that are there already; forces need the units of the moduli.
Lattice Builder::build(bool cracks) {
  materials();
  if (cracks) weaken_cracks();
  supports();
  loads();
  solids();
  neighbors();
  if (const auto& mirror = r_.level_set.mirror)
    l_.mirror = Mirror{in_cells(mirror->point), mirror->direction.normalized()};
  return std::move(l_);
}

}  // namespace

Lattice make_lattice(const Problem& p, const OptimizeRequest& r, double cells, bool cracks) {
  return Builder(p, r, cells).build(cracks);
}

bool has_cracks(const Problem& p) {
  const auto opens = [](const CrackLaw& law) { return law.kind != CrackLaw::Kind::Bonded; };
  return std::any_of(p.scene.laws.begin(), p.scene.laws.end(), opens);
}

// Least against largest eigenvalue of the 3 x 3 energy of rigid motions, lengths over the lattice's.
std::optional<std::string> unsupported(const Lattice& l) {
  // The energy of the springs under rigid motions: positive definite where they hold the body.
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  const double scale = std::max(l.columns, l.rows);
  const auto rigid = [&](Index unknown) -> Eigen::Vector3d {
    const Index node = unknown / 2;
    const double x = node % (l.columns + 1) / scale, y = node / (l.columns + 1) / scale;
    return unknown % 2 == 0 ? Eigen::Vector3d(1, 0, -y) : Eigen::Vector3d(0, 1, x);
  };
  for (const Lattice::Spring& s : l.springs) gram += s.stiffness * rigid(s.first) * rigid(s.second).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(gram);
  if (eigen.eigenvalues()[0] > 1e-8 * eigen.eigenvalues()[2]) return std::nullopt;
  return "the supports leave the body free to move";
}

}  // namespace kerf
