// A stress of higher order at points [Zienkiewicz, Zhu 1992], from polynomials fitted to the discrete stress around
// corners:
//   min over pi in P_d of  sum_T |T|/(0.1 + delta_T^2) |mean_T pi - mean_T s|^2   (orders 1 and 2, two rings)   or
//   min over pi in P_d of  sum_T int_T |pi - s|^2   (above, one ring)      [theory: R.2],
// delta_T the distance of the centroid from the corner over the largest in the patch. At a point the polynomials of the
// three corners are blended by barycentric coordinates [theory: R.3]. Patches do not cross cracks, nor corners where
// the stress may be infinite; around those the discrete stress is kept. Corners are fitted four at a time, in packs,
// and the normal matrix is shared by all fields of one mesh; where it is close to singular a corner is fitted alone, by
// a lower degree. Equilibrium, functionals and bounds never use this stress. docs/theory/recovery_and_estimates.md,
// "Stresses".

#include "solver/recover_stress.hpp"
#include "solver/post/blend.hpp"
#include "solver/post/shared_corners.hpp"
#include "solver/recovery.hpp"

#include "geometry/plane.hpp"
#include "solver/system.hpp"

#include "base/parallel.hpp"
#include "base/polynomial.hpp"
#include "kerf/recover.hpp"
#include "solver/element/pack_kernels.hpp"
#include "solver/stress.hpp"
#include "solver/system/lists.hpp"

#include <cmath>

namespace kerf {

namespace {

template <int P>
using Monomial = Eigen::Matrix<double, dim(P), 1>;

template <int P, class Number>
void set_monomials(const Number& x, const Number& y, Number* m) {
  m[0] = Number{} + 1.0;
  for (int degree = 1, at = 1; degree <= P; ++degree) {
    const int before = at - degree;
    for (int j = 0; j < degree; ++j) m[at + j] = m[before + j] * x;
    m[at + degree] = m[before + degree - 1] * y;
    at += degree + 1;
  }
}
template <int P>
Monomial<P> monomial(double x, double y) {
  Monomial<P> m;
  set_monomials<P>(x, y, m.data());
  return m;
}

// The moments of a triangle, from its corners about the centroid.
// Means of monomials over a triangle are sums over its corners: of x^2 about the centroid (1/12) sum d_i^2, of x^3
// (1/30) sum d_i^3.
struct Moments {
  Vec2 center = Vec2::Zero();
  double area = 0;
  Eigen::Vector3d second = Eigen::Vector3d::Zero();  // means of x^2, x y, y^2 about the centroid
  Eigen::Vector4d third = Eigen::Vector4d::Zero();   // of x^3, x^2 y, x y^2, y^3
};
void set_moments(Moments& m, const Triangle& t) {
  m.second.setZero();
  m.third.setZero();
  for (const Vec2& corner : t.x) {
    const Vec2 d = corner - m.center;
    m.second += Eigen::Vector3d(d.x() * d.x(), d.x() * d.y(), d.y() * d.y()) / 12;
    m.third +=
        Eigen::Vector4d(d.x() * d.x() * d.x(), d.x() * d.x() * d.y(), d.x() * d.y() * d.y(), d.y() * d.y() * d.y()) /
        30;
  }
}

/// The middles of the edges integrate quadratics exactly.
Eigen::Vector3d mean_stress_of(const FieldToRecover& of, Index t) {
  const Model& m = of.model;
  const Triangle shape = triangle(m, t);
  const auto coefficients = of.field.interior.col(t);
  const Vec2 center = centroid(shape);
  const std::array<Vec2, 3> middle = {0.5 * (shape.x[1] + shape.x[2]), 0.5 * (shape.x[2] + shape.x[0]),
                                      0.5 * (shape.x[0] + shape.x[1])};
  Eigen::Vector3d stress = Eigen::Vector3d::Zero();
  if (m.element.stress <= 1) {  // bubbles have no mean, and vanish at the centroid
    stress = symmetric_part(stress_at(m.inner->kernel, shape, coefficients, center));
  } else {
    for (const Vec2& x : middle) stress += symmetric_part(stress_at(m.inner->kernel, shape, coefficients, x)) / 3;
  }
  if (of.load && m.element.displacement == 0 && is_mixed(m.element)) {
    // |T| mean(s) = int_dT (s n) x^T - int_T (div s) x^T: the element has the means of f for f.
    Mat2 missing = Mat2::Zero();
    for (const Vec2& x : middle) missing += of.load(x) * (x - center).transpose() / 3;
    stress += Eigen::Vector3d(missing(0, 0), missing(1, 1), 0.5 * (missing(0, 1) + missing(1, 0)));
  }
  return stress;
}

using Fields3 = std::vector<Eigen::Matrix3Xd>;  // stresses per field, a column per sample

// What is known about the stresses in the triangles: their means, a sample each, or values at points. What is asked of
// samples: the triangle's center; and of four of them, one beside each of four corners, the monomials m of
// (x - corner) / reach and the weights. No triangle: a weight of 0.
struct FourSamples {
  std::array<Index, pack_size> triangle;  // or none
  int of_triangle;                        // which of its samples
};
struct FourCorners {
  Pack x, y, reach;
};

/// `set` fills m with the means of the monomials over the triangle: the monomial at the centroid plus moments of the
/// differences. The weight falls with the distance, so that far triangles of irregular patches count less.
class Means {
 public:
  static constexpr int per_triangle = 1;
  Fields3 stress;

  Means(std::span<const FieldToRecover> fields, Index triangles)
      : stress(fields.size(), Eigen::Matrix3Xd(3, triangles)), of_(static_cast<std::size_t>(triangles)) {
    const Model& m = fields[0].model;
    parallel_for(triangles, m.threads, [&](Index begin, Index end) {
      for (Index t = begin; t < end; ++t) {
        const Triangle shape = triangle(m, t);
        Moments& moments = of_[t];
        moments.center = centroid(shape);
        moments.area = area(shape);
        set_moments(moments, shape);
        for (std::size_t f = 0; f < fields.size(); ++f) stress[f].col(t) = mean_stress_of(fields[f], t);
      }
    });
  }
  const Vec2& center(Index t) const {
    return of_[t].center;
  }
  template <int P>
  Pack set(const FourSamples& at, const FourCorners& corners, Pack* m) const {
    static const Moments nothing;
    Pack x, y, area, second[3], third[4];
    for (int lane = 0; lane < pack_size; ++lane) {
      const Index t = at.triangle[static_cast<std::size_t>(lane)];
      const Moments& of = t == none ? nothing : of_[t];
      x[lane] = of.center.x();
      y[lane] = of.center.y();
      area[lane] = of.area;
      for (int i = 0; i < 3; ++i) second[i][lane] = of.second[i];
      if constexpr (P == 3)
        for (int i = 0; i < 4; ++i) third[i][lane] = of.third[i];
    }
    const Pack scale = 1.0 / corners.reach, square = scale * scale;
    x = scale * (x - corners.x);
    y = scale * (y - corners.y);
    set_monomials<P>(x, y, m);
    for (int i = 0; i < 3; ++i) {
      second[i] *= square;
      m[3 + i] += second[i];
    }
    if constexpr (P == 3) {
      const Pack cube = square * scale;
      m[6] += 3.0 * x * second[0] + cube * third[0];
      m[7] += 2.0 * x * second[1] + y * second[0] + cube * third[1];
      m[8] += 2.0 * y * second[1] + x * second[2] + cube * third[2];
      m[9] += 3.0 * y * second[2] + cube * third[3];
    }
    return area * square / (0.1 + x * x + y * y);
  }

 private:
  std::vector<Moments> of_;
};

/// Six points of a rule of degree 4 per triangle, weighted by area.
class StressValues {
 public:
  static constexpr int per_triangle = 6;
  Fields3 stress;

  StressValues(std::span<const FieldToRecover> fields, Index triangles)
      : stress(fields.size(), Eigen::Matrix3Xd(3, Eigen::Index{per_triangle} * triangles)),
        x_(2, Eigen::Index{per_triangle} * triangles),
        weight_(Eigen::Index{per_triangle} * triangles),
        center_(static_cast<std::size_t>(triangles)) {
    const Model& m = fields[0].model;
    const TriangleRule rule = triangle_rule(4);
    parallel_for(triangles, m.threads, [&](Index begin, Index end) {
      for (Index t = begin; t < end; ++t) {
        const Triangle shape = triangle(m, t);
        center_[t] = centroid(shape);
        for (int q = 0; q < per_triangle; ++q) {
          const Vec2 x =
              shape.x[0] + rule.x(0, q) * (shape.x[1] - shape.x[0]) + rule.x(1, q) * (shape.x[2] - shape.x[0]);
          const Eigen::Index k = Eigen::Index{per_triangle} * t + q;
          x_.col(k) = x;
          weight_[k] = rule.w[q] * area(shape);
          for (std::size_t f = 0; f < fields.size(); ++f)
            stress[f].col(k) =
                symmetric_part(stress_at(fields[f].model.inner->kernel, shape, fields[f].field.interior.col(t), x));
        }
      }
    });
  }
  const Vec2& center(Index t) const {
    return center_[t];
  }
  template <int P>
  Pack set(const FourSamples& at, const FourCorners& corners, Pack* m) const {
    Pack x = corners.x, y = corners.y, weight{};
    for (int lane = 0; lane < pack_size; ++lane) {
      const Index t = at.triangle[static_cast<std::size_t>(lane)];
      if (t == none) continue;
      const Eigen::Index k = Eigen::Index{per_triangle} * t + at.of_triangle;
      x[lane] = x_(0, k);
      y[lane] = x_(1, k);
      weight[lane] = weight_[k];
    }
    set_monomials<P>(Pack((x - corners.x) / corners.reach), Pack((y - corners.y) / corners.reach), m);
    return weight / (corners.reach * corners.reach);
  }

 private:
  Points x_;
  Eigen::VectorXd weight_;
  std::vector<Vec2> center_;
};

// Where each corner is one of a triangle's three: place / 3 is the triangle.
Lists places_of_corners(const Corners& c) {
  std::vector<Index> corner;
  corner.reserve(3 * c.of.size());
  for (const auto& of : c.of) corner.insert(corner.end(), of.begin(), of.end());
  return file_under(static_cast<Index>(c.vertex.size()), corner);
}

// These and all that share a triangle with one.
std::vector<bool> with_neighbors(const Corners& c, const std::vector<bool>& corners) {
  std::vector<bool> result(corners.size(), false);
  for (const auto& of : c.of)
    if (corners[of[0]] || corners[of[1]] || corners[of[2]])
      for (const Index i : of) result[i] = true;
  return result;
}

// At least so many rings and triangles, if there are.
struct PatchSize {
  int rings, triangles;
};

// Rings of triangles around one corner after the other. Neighbors across a singular corner do not count: it sees both
// faces of a crack.
// `seen_` and `passed_` hold the number of the corner that was served last: nothing is cleared between corners.
class Patch {
 public:
  Patch(const Corners& c, const Lists& places, const std::vector<bool>& singular)
      : c_(c), places_(places), singular_(singular), seen_(c.of.size(), none), passed_(c.vertex.size(), none) {}

  const std::vector<Index>& around(Index corner, const PatchSize& size) {
    triangles_.clear();
    passed_[corner] = corner;
    add(corner, corner);
    std::size_t begin = 0;
    for (int ring = 1; ring < max_rings; ++ring) {
      if (ring >= size.rings && static_cast<int>(triangles_.size()) >= size.triangles) break;
      const std::size_t end = triangles_.size();
      for (; begin < end; ++begin)
        for (const Index i : c_.of[triangles_[begin]]) {
          if (passed_[i] == corner || singular_[i]) continue;
          passed_[i] = corner;
          add(corner, i);
        }
    }
    return triangles_;
  }

 private:
  static constexpr int max_rings = 5;
  void add(Index mark, Index corner) {
    for (const Index place : places_[corner]) {
      const Index t = place / 3;
      if (seen_[t] == mark) continue;
      seen_[t] = mark;
      triangles_.push_back(t);
    }
  }
  const Corners& c_;
  const Lists& places_;
  const std::vector<bool>& singular_;
  std::vector<Index> seen_, passed_, triangles_;
};

// Weighted least squares; falls back to lower degrees where the samples do not determine the fit. Of the normal matrix
// what is below the diagonal.
// Elimination without pivoting in the order of the degrees: the first pivot below least_pivot of its diagonal drops its
// degree and all above.
template <int P>
class Fit {
 public:
  static constexpr double least_pivot = 1e-6;  // of the diagonal

  void add(const Monomial<P>& m, const Eigen::Vector3d& value, double weight) {
    for (int j = 0; j < n; ++j)
      for (int i = j; i < n; ++i) normal_(i, j) += weight * m[j] * m[i];
    for (int k = 0; k < 3; ++k) load_.col(k) += (weight * value[k]) * m;
  }
  /// Coefficients, 3 x dim(P).
  Eigen::Matrix<double, 3, dim(P)> solve() {
    const Monomial<P> diagonal = normal_.diagonal();
    int rank = n;
    for (int j = 0; j < n; ++j) {
      if (normal_(j, j) <= least_pivot * diagonal[j]) {
        int degree = 0;
        while (dim(degree) <= j) ++degree;
        rank = dim(degree - 1);
        break;
      }
      const double inverse = 1 / normal_(j, j);
      for (int k = j + 1; k < n; ++k) {
        const double factor = normal_(k, j) * inverse;
        for (int i = k; i < n; ++i) normal_(i, k) -= factor * normal_(i, j);
        load_.row(k) -= factor * load_.row(j);
      }
    }
    Eigen::Matrix<double, 3, n> c = Eigen::Matrix<double, 3, n>::Zero();
    for (int j = rank - 1; j >= 0; --j) {
      Eigen::Vector3d rest = load_.row(j).transpose();
      for (int k = j + 1; k < rank; ++k) rest -= normal_(k, j) * c.col(k);
      c.col(j) = rest / normal_(j, j);
    }
    return c;
  }

 private:
  static constexpr int n = dim(P);
  Eigen::Matrix<double, n, n> normal_ = Eigen::Matrix<double, n, n>::Zero();
  Eigen::Matrix<double, n, 3> load_ = Eigen::Matrix<double, n, 3>::Zero();
};

// The fits at four corners side by side, of all fields: the normal matrix is one for them. What a corner gets does not
// depend on the other three.
// A lane without a corner, or a sample that a smaller patch lacks, has the weight 0.
template <int P, class Samples>
class FourFits {
 public:
  FourFits(const Samples& samples, const std::vector<Vec2>& points) : samples_(samples), points_(points) {}

  /// `around`: the triangles around each corner, which are at points[vertex].
  /// Monomials in (x - corner)/reach, reach the farthest centroid of the patch: they stay of the order 1, and
  /// `least_pivot` means the same for every patch. The Cholesky factor has 1/sqrt(pivot) on its diagonal.
  void set(const std::array<std::vector<Index>, pack_size>& around, const std::array<Index, pack_size>& vertex) {
    around_ = &around;
    std::size_t triangles = 0;
    for (int lane = 0; lane < pack_size; ++lane) {
      const auto at = static_cast<std::size_t>(lane);
      const Vec2& x = points_[static_cast<std::size_t>(vertex[at])];
      corners_.x[lane] = x.x();
      corners_.y[lane] = x.y();
      double reach = 0;
      for (const Index t : around[at]) reach = std::max(reach, (samples_.center(t) - x).squaredNorm());
      corners_.reach[lane] = std::sqrt(reach);
      triangles = std::max(triangles, around[at].size());
    }
    terms_ = static_cast<int>(triangles) * Samples::per_triangle;
    monomials_.resize(static_cast<std::size_t>(terms_) * n);
    weighted_.resize(monomials_.size());
    stress_.resize(static_cast<std::size_t>(terms_) * 3);
    for (int k = 0; k < terms_; ++k) {
      Pack* m = &monomials_[static_cast<std::size_t>(k) * n];
      Pack* weighted = &weighted_[static_cast<std::size_t>(k) * n];
      const Pack weight = samples_.template set<P>(samples_at(k), corners_, m);
      for (int i = 0; i < n; ++i) weighted[i] = weight * m[i];
    }
    set_zero(factor_);
    add_products<Wanted::Upper>(factor_, terms_, by(weighted_, n), by(monomials_, n), ones);
    for (int i = 0; i < n; ++i) diagonal_[i] = factor_(i, i);
    cholesky_packs<n>(factor_);
    for (int lane = 0; lane < pack_size; ++lane) {
      determined_[static_cast<std::size_t>(lane)] = true;
      for (int i = 0; i < n; ++i) {  // 1/factor^2 are the pivots
        const double share = factor_(i, i)[lane] * factor_(i, i)[lane] * Fit<P>::least_pivot * diagonal_[i][lane];
        if (!(share < 1)) determined_[static_cast<std::size_t>(lane)] = false;
      }
    }
  }
  double reach(int lane) const {
    return corners_.reach[lane];
  }
  /// Of one field, at the first `count` corners: coefficients into to[lane].
  void solve(std::size_t field, int count, const std::array<double*, pack_size>& to) {
    const Eigen::Matrix3Xd& stress = samples_.stress[field];
    for (int k = 0; k < terms_; ++k) {
      const FourSamples at = samples_at(k);
      Pack* s = &stress_[static_cast<std::size_t>(k) * 3];
      for (int lane = 0; lane < pack_size; ++lane) {
        const Index t = at.triangle[static_cast<std::size_t>(lane)];
        const double* of =
            t == none ? nothing.data() : stress.data() + 3 * (Eigen::Index{Samples::per_triangle} * t + at.of_triangle);
        for (int i = 0; i < 3; ++i) s[i][lane] = of[i];
      }
    }
    PackGrid<n, 3> x;
    set_zero(x);
    add_products<Wanted::All>(x, terms_, by(weighted_, n), by(stress_, 3), ones);
    forward_packs<n, 3>(factor_, x);
    for (int i = n - 1; i >= 0; --i)
      for (int j = 0; j < 3; ++j) {
        Pack sum = x(i, j);
        for (int k = i + 1; k < n; ++k) sum -= factor_(i, k) * x(k, j);
        x(i, j) = sum * factor_(i, i);
      }
    for (int lane = 0; lane < count; ++lane) {
      double* c = to[static_cast<std::size_t>(lane)];
      if (!determined_[static_cast<std::size_t>(lane)])
        solve_alone(lane, c);
      else
        for (int i = 0; i < n; ++i)
          for (int j = 0; j < 3; ++j) c[3 * i + j] = x(i, j)[lane];
    }
  }

 private:
  static constexpr int n = dim(P);
  static constexpr Pack ones = {1, 1, 1, 1};
  static constexpr std::array<double, 3> nothing = {0, 0, 0};

  FourSamples samples_at(int k) const {
    const auto place = static_cast<std::size_t>(k / Samples::per_triangle);
    FourSamples at{{}, k % Samples::per_triangle};
    for (std::size_t lane = 0; lane < at.triangle.size(); ++lane)
      at.triangle[lane] = place < (*around_)[lane].size() ? (*around_)[lane][place] : none;
    return at;
  }
  static auto by(const std::vector<Pack>& rows, int columns) {
    return [data = rows.data(), columns](int k, int i) { return data[k * columns + i]; };
  }
  /// The packed factor is of no use where its pivots are small; this one drops degrees.
  void solve_alone(int lane, double* to) const {
    Fit<P> fit;
    const auto terms = static_cast<int>((*around_)[static_cast<std::size_t>(lane)].size()) * Samples::per_triangle;
    for (int k = 0; k < terms; ++k) {
      Monomial<P> m;
      for (int i = 0; i < n; ++i) m[i] = by(monomials_, n)(k, i)[lane];
      Eigen::Vector3d s;
      for (int i = 0; i < 3; ++i) s[i] = by(stress_, 3)(k, i)[lane];
      fit.add(m, s, by(weighted_, n)(k, 0)[lane]);  // the first monomial is 1
    }
    Eigen::Map<Eigen::Matrix<double, 3, n>>(to).noalias() = fit.solve();
  }

  const Samples& samples_;
  const std::vector<Vec2>& points_;
  const std::array<std::vector<Index>, pack_size>* around_ = nullptr;
  FourCorners corners_;
  int terms_ = 0;
  std::vector<Pack> monomials_, weighted_, stress_;
  PackGrid<n, n> factor_;  // U with U'U the normal matrix, one over its diagonal on it
  std::array<Pack, n> diagonal_;
  std::array<bool, pack_size> determined_ = {};
};

template <int P>
/// The sum of coefficients times the monomials in (x - corner)/reach.
Eigen::Vector3d value(const RecoveredStress& r, Index corner, const Vec2& from_corner) {
  const Vec2 d = from_corner / r.reach[corner];
  return Eigen::Map<const Eigen::Matrix<double, 3, dim(P)>>(r.coefficients.col(corner).data()) *
         monomial<P>(d.x(), d.y());
}

/// One corner without a polynomial is enough: its share of the blend would be missing.
bool is_kept(const RecoveredStress& r, const Corners& c, Index t) {
  return r.kept[c.of[t][0]] || r.kept[c.of[t][1]] || r.kept[c.of[t][2]];
}

template <int P>
Eigen::Vector3d blended(const Model& m, const Field& s, const Corners& c, const RecoveredStress& r, const PointIn& at) {
  const auto& [t, x] = at;
  if (is_kept(r, c, t)) return symmetric_part(stress_at(m.inner->kernel, triangle(m, t), s.interior.col(t), x));
  const Shares share = shares_at(m.mesh, at);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) sum += share.of[i] * value<P>(r, c.of[t][i], x - m.mesh.points[m.mesh.triangles[t][i]]);
  return sum / share.whole;
}

// Of the discrete stresses of the triangles at a corner, weighted by area.
Eigen::Vector3d average(const FieldToRecover& of, std::span<const Index> places, const Vec2& x) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double weight = 0;
  for (const Index place : places) {
    const Index t = place / 3;
    const Triangle shape = triangle(of.model, t);
    sum += area(shape) * symmetric_part(stress_at(of.model.inner->kernel, shape, of.field.interior.col(t), x));
    weight += area(shape);
  }
  return sum / weight;
}

// The corners of wanted triangles.
std::vector<bool> wanted_corners(const Corners& c, const std::vector<bool>& wanted) {
  std::vector<bool> at(c.vertex.size(), wanted.empty());
  for (std::size_t t = 0; t < wanted.size(); ++t)
    if (wanted[t])
      for (const Index i : c.of[t]) at[i] = true;
  return at;
}

template <int P, class Samples>
/// Corners are served in their order in blocks of threads, four at a time; what a corner gets does not depend on its
/// pack, so that bits do not depend on the number of threads.
std::vector<RecoveredStress> fitted(std::span<const FieldToRecover> fields, const Corners& c,
                                    const std::vector<bool>& singular, const std::vector<bool>& wanted,
                                    const PatchSize& size) {
  const Model& m = fields[0].model;
  const Index corners = static_cast<Index>(c.vertex.size()), triangles = static_cast<Index>(c.of.size());
  const Samples samples(fields, triangles);
  const Lists places = places_of_corners(c);
  const std::vector<bool> kept = with_neighbors(c, singular), at_corner = wanted_corners(c, wanted);
  std::vector<RecoveredStress> all(
      fields.size(), RecoveredStress{Eigen::Matrix3Xd(3, corners), Eigen::Matrix3Xd(3, triangles), P,
                                     Eigen::MatrixXd(3 * dim(P), corners), Eigen::VectorXd(corners), kept});
  parallel_for(corners, m.threads, [&](Index begin, Index end) {
    Patch patch(c, places, singular);
    FourFits<P, Samples> fits(samples, m.mesh.points);
    std::array<std::vector<Index>, pack_size> around;
    std::array<Index, pack_size> vertex{}, corner{};
    int count = 0;
    const auto flush = [&] {
      if (count == 0) return;
      for (auto lane = static_cast<std::size_t>(count); lane < vertex.size(); ++lane) {
        around[lane].clear();
        vertex[lane] = vertex[0];
      }
      fits.set(around, vertex);
      for (std::size_t f = 0; f < all.size(); ++f) {
        std::array<double*, pack_size> to{};
        for (std::size_t lane = 0; lane < static_cast<std::size_t>(count); ++lane) {
          to[lane] = all[f].coefficients.col(corner[lane]).data();
          all[f].reach[corner[lane]] = fits.reach(static_cast<int>(lane));
        }
        fits.solve(f, count, to);
        for (std::size_t lane = 0; lane < static_cast<std::size_t>(count); ++lane)
          all[f].at_corners.col(corner[lane]) = Eigen::Map<const Eigen::Vector3d>(to[lane]);
      }
      count = 0;
    };
    for (Index i = begin; i < end; ++i) {
      if (!at_corner[i]) continue;
      if (kept[i]) {
        for (std::size_t f = 0; f < all.size(); ++f)
          all[f].at_corners.col(i) = average(fields[f], places[i], m.mesh.points[c.vertex[i]]);
        continue;
      }
      const auto lane = static_cast<std::size_t>(count);
      around[lane] = patch.around(i, size);
      vertex[lane] = c.vertex[i];
      corner[lane] = i;
      if (++count == pack_size) flush();
    }
    flush();
  });
  parallel_for(triangles, m.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) {
      if (!wanted.empty() && !wanted[t]) continue;
      for (std::size_t f = 0; f < all.size(); ++f)
        all[f].at_centroids.col(t) = blended<P>(fields[f].model, fields[f].field, c, all[f], {t, samples.center(t)});
    }
  });
  return all;
}

// Per vertex whether contact begins or ends there. `stress`: the mean of the body.
std::vector<bool> contact_changes(const Model& model, const Field& state, double stress) {
  const Mesh& mesh = model.mesh;
  const Skeleton& s = model.inner->skeleton;
  // Pressures that are small change nothing; faces between contact and gap would flicker.
  const double least = 1e-3 * stress;
  std::vector<bool> changes(mesh.points.size(), false);
  std::vector<int> touching(mesh.points.size(), none);
  for (const auto& crack : mesh.cracks)
    for (const CrackEdge& of : crack) {
      const Index jump = s.jump[of.edge];
      if (jump == none) continue;
      for (int k = 0; k < s.per_edge; k += 2)
        for (const Index v : mesh.edges[of.edge]) {
          const int now = state.force[jump + k] > least * length(mesh, of.edge) ? 1 : 0;
          changes[v] = changes[v] || (touching[v] != none && touching[v] != now);
          touching[v] = now;
        }
    }
  return changes;
}

// Per corner the angle that its triangles fill; 0 inside the body.
// At a tip 2 pi, at a reentrant corner more than pi.
std::vector<double> corner_angles(const Mesh& mesh, const Corners& c) {
  std::vector<bool> edge(mesh.points.size(), false);
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    if (mesh.sides[e][0] == none || mesh.sides[e][1] == none || mesh.crack[e] != none)
      for (const Index v : mesh.edges[e]) edge[v] = true;
  std::vector<double> angle(c.vertex.size(), 0);
  for (std::size_t t = 0; t < c.of.size(); ++t)
    for (int i = 0; i < 3; ++i) {
      const auto& v = mesh.triangles[t];
      if (!edge[v[i]]) continue;
      const Vec2 a = mesh.points[v[(i + 1) % 3]] - mesh.points[v[i]],
                 b = mesh.points[v[(i + 2) % 3]] - mesh.points[v[i]];
      angle[c.of[t][i]] += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
    }
  return angle;
}

}  // namespace

/// At a tip and at a reentrant corner by the angle, at ends of contact by the forces.
std::vector<bool> singular_corners(const Model& model, const Field& state, const Corners& c) {
  return singular_corners(model, state, c, model.mesh.cracks.empty() ? 0 : mean_stress(model, state));
}

std::vector<bool> singular_corners(const Model& model, const Field& state, const Corners& c, double stress) {
  const std::vector<bool> changes = contact_changes(model, state, stress);
  const std::vector<double> angle = corner_angles(model.mesh, c);
  std::vector<bool> result(c.vertex.size(), false);
  for (std::size_t i = 0; i < angle.size(); ++i) result[i] = angle[i] > reentrant_angle || changes[c.vertex[i]];
  return result;
}

/// A patch of means needs more triangles than the polynomial has coefficients: four more, from a further ring at
/// boundaries.
std::vector<RecoveredStress> recover_stresses(std::span<const FieldToRecover> fields, const Corners& c,
                                              const std::vector<bool>& singular, const std::vector<bool>& wanted) {
  if (fields.empty()) return {};
  const auto from_means = [](int degree) { return PatchSize{.rings = 2, .triangles = dim(degree) + 4}; };
  switch (fields[0].model.element.order) {
    case 1:
      return fitted<2, Means>(fields, c, singular, wanted, from_means(2));
    case 2:
      return fitted<3, Means>(fields, c, singular, wanted, from_means(3));
    case 3:
    case 4:
      return fitted<4, StressValues>(fields, c, singular, wanted, {.rings = 1, .triangles = 5});
    default:
      return fitted<5, StressValues>(fields, c, singular, wanted, {.rings = 1, .triangles = 7});
  }
}

RecoveredStress recover_stress(const Model& m, const Field& s, const Corners& c, const std::vector<bool>& singular,
                               const VectorField& load) {
  const FieldToRecover alone{m, s, load};
  return std::move(recover_stresses({&alone, 1}, c, singular).front());
}

/// Cross products of the corners seen from the point. On a curved triangle these are the coordinates of the triangle of
/// its corners, which need not lie between 0 and 1.
Shares shares_at(const Mesh& mesh, const PointIn& at) {
  const auto& v = mesh.triangles[at.triangle];
  Shares s{{}, 0};
  for (int i = 0; i < 3; ++i) {
    const Vec2 a = mesh.points[v[(i + 1) % 3]] - at.x, b = mesh.points[v[(i + 2) % 3]] - at.x;
    s.of[i] = a.x() * b.y() - a.y() * b.x();
    s.whole += s.of[i];
  }
  return s;
}

Eigen::Vector3d recovered_at(const Model& m, const Field& s, const Corners& c, const RecoveredStress& r,
                             const PointIn& at) {
  switch (r.degree) {
    case 2:
      return blended<2>(m, s, c, r, at);
    case 3:
      return blended<3>(m, s, c, r, at);
    case 4:
      return blended<4>(m, s, c, r, at);
    default:
      return blended<5>(m, s, c, r, at);
  }
}

}  // namespace kerf
