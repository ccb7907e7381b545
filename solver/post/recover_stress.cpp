#include "solver/recover_stress.hpp"
#include "solver/post/blend.hpp"
#include "solver/recovery.hpp"

#include "geometry/plane.hpp"
#include "solver/system.hpp"

#include "kerf/recover.hpp"
#include "solver/parallel.hpp"
#include "solver/polynomial.hpp"
#include "solver/stress.hpp"
#include "solver/system/lists.hpp"

#include <cmath>

namespace kerf {

namespace {

template <int P>
using Monomial = Eigen::Matrix<double, dim(P), 1>;

template <int P>
Monomial<P> monomial(double x, double y) {
  Monomial<P> m;
  m[0] = 1;
  for (int degree = 1, at = 1; degree <= P; ++degree) {
    const int before = at - degree;
    for (int j = 0; j < degree; ++j) m[at + j] = m[before + j] * x;
    m[at + degree] = m[before + degree - 1] * y;
    at += degree + 1;
  }
  return m;
}

// What is known about the stress in a triangle: its mean, or values at points.
constexpr int gauss_points = 6;
struct Mean {
  Vec2 center;
  double area;
  Eigen::Vector3d stress;
  Eigen::Vector3d second;  // means of x^2, x y, y^2 about the centroid
  Eigen::Vector4d third;   // of x^3, x^2 y, x y^2, y^3
};
struct Values {
  Vec2 center;
  double area;
  Eigen::Matrix<double, 2, gauss_points> x;
  Eigen::Matrix<double, 3, gauss_points> stress;
};

// The moments of a triangle, from its corners about the centroid.
void set_moments(Mean& m, const Triangle& t) {
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

Mean mean(const Model& m, const Field& s, Index t, const VectorField& load) {
  const Triangle shape = triangle(m, t);
  const auto coefficients = s.interior.col(t);
  Mean r;
  r.center = centroid(shape);
  r.area = area(shape);
  set_moments(r, shape);
  const std::array<Vec2, 3> middle = {0.5 * (shape.x[1] + shape.x[2]), 0.5 * (shape.x[2] + shape.x[0]),
                                      0.5 * (shape.x[0] + shape.x[1])};
  if (m.element.stress <= 1) {  // bubbles have no mean, and vanish at the centroid
    r.stress = symmetric_part(stress_at(m.inner->kernel, shape, coefficients, r.center));
  } else {
    r.stress.setZero();
    for (const Vec2& x : middle) r.stress += symmetric_part(stress_at(m.inner->kernel, shape, coefficients, x)) / 3;
  }
  if (load && m.element.displacement == 0 && is_mixed(m.element)) {
    // |T| mean(s) = int_dT (s n) x^T - int_T (div s) x^T: the element has the means of f for f.
    Mat2 missing = Mat2::Zero();
    for (const Vec2& x : middle) missing += load(x) * (x - r.center).transpose() / 3;
    r.stress += Eigen::Vector3d(missing(0, 0), missing(1, 1), 0.5 * (missing(0, 1) + missing(1, 0)));
  }
  return r;
}

Values values(const Model& m, const Field& s, Index t, const TriangleRule& rule) {
  const Triangle shape = triangle(m, t);
  Values r{centroid(shape), area(shape), {}, {}};
  for (int q = 0; q < gauss_points; ++q) {
    const Vec2 x = shape.x[0] + rule.x(0, q) * (shape.x[1] - shape.x[0]) + rule.x(1, q) * (shape.x[2] - shape.x[0]);
    r.x.col(q) = x;
    r.stress.col(q) = symmetric_part(stress_at(m.inner->kernel, shape, s.interior.col(t), x));
  }
  return r;
}

// Where each corner is one of a triangle's three: place / 3 is the triangle.
Lists places_of(const Corners& c) {
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

// Weighted least squares; falls back to lower degrees where the samples do not determine the fit. Padded to whole
// registers; of the normal matrix what is below the diagonal, and a little more.
template <int P>
class Fit {
 public:
  void add(const Monomial<P>& m, const Eigen::Vector3d& value, double weight) {
    Eigen::Matrix<double, rows, 1> padded = Eigen::Matrix<double, rows, 1>::Zero();
    padded.template head<n>() = m;
    accumulate<0>(padded, weight * m);
    for (int k = 0; k < 3; ++k) load_.col(k) += (weight * value[k]) * padded;
  }
  /// Coefficients, 3 x dim(P).
  Eigen::Matrix<double, 3, dim(P)> solve() {
    constexpr double least_pivot = 1e-6;  // of the diagonal
    const Eigen::Matrix<double, rows, 1> diagonal = normal_.diagonal();
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
  static constexpr int n = dim(P), rows = (n + 3) / 4 * 4;
  template <int J>
  void accumulate(const Eigen::Matrix<double, rows, 1>& m, const Monomial<P>& weighted) {
    if constexpr (J < n) {
      constexpr int from = J / 4 * 4;
      normal_.col(J).template tail<rows - from>() += weighted[J] * m.template tail<rows - from>();
      accumulate<J + 1>(m, weighted);
    }
  }
  Eigen::Matrix<double, rows, rows> normal_ = Eigen::Matrix<double, rows, rows>::Zero();
  Eigen::Matrix<double, rows, 3> load_ = Eigen::Matrix<double, rows, 3>::Zero();
};

template <int P>
void add(Fit<P>& fit, const Mean& s, const Vec2& corner, double reach) {
  const double scale = 1 / reach;
  const Vec2 d = scale * (s.center - corner);
  Monomial<P> m = monomial<P>(d.x(), d.y());
  const Eigen::Vector3d second = scale * scale * s.second;
  m.template segment<3>(3) += second;
  if constexpr (P == 3) {
    const Eigen::Vector4d third = scale * scale * scale * s.third;
    m[6] += 3 * d.x() * second[0] + third[0];
    m[7] += 2 * d.x() * second[1] + d.y() * second[0] + third[1];
    m[8] += 2 * d.y() * second[1] + d.x() * second[2] + third[2];
    m[9] += 3 * d.y() * second[2] + third[3];
  }
  fit.add(m, s.stress, s.area * scale * scale / (0.1 + d.squaredNorm()));
}

template <int P>
void add(Fit<P>& fit, const Values& s, const Vec2& corner, double reach, const TriangleRule& rule) {
  for (int q = 0; q < gauss_points; ++q) {
    const Vec2 d = (s.x.col(q) - corner) / reach;
    fit.add(monomial<P>(d.x(), d.y()), s.stress.col(q), rule.w[q] * s.area / (reach * reach));
  }
}

template <int P>
Eigen::Vector3d value(const RecoveredStress& r, Index corner, const Vec2& from_corner) {
  const Vec2 d = from_corner / r.reach[corner];
  return Eigen::Map<const Eigen::Matrix<double, 3, dim(P)>>(r.coefficients.col(corner).data()) *
         monomial<P>(d.x(), d.y());
}

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

// What is to be fitted, and where not.
struct Fitting {
  const Model& model;
  const Field& field;
  const Corners& corners;
  const std::vector<bool>& singular;
};

// Of the discrete stresses of the triangles at a corner, weighted by area.
Eigen::Vector3d average(const Fitting& f, const Lists& places, Index corner) {
  const Vec2& x = f.model.mesh.points[f.corners.vertex[corner]];
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double weight = 0;
  for (const Index place : places[corner]) {
    const Index t = place / 3;
    const Triangle shape = triangle(f.model, t);
    sum += area(shape) * symmetric_part(stress_at(f.model.inner->kernel, shape, f.field.interior.col(t), x));
    weight += area(shape);
  }
  return sum / weight;
}

template <class Samples>
double reach_of(const std::vector<Index>& patch, const std::vector<Samples>& samples, const Vec2& corner) {
  double reach = 0;
  for (const Index t : patch) reach = std::max(reach, (samples[t].center - corner).squaredNorm());
  return std::sqrt(reach);
}

// `add_to`(fit, sample, corner, reach) adds what is known about a triangle to the fit at a corner.
template <int P, class Samples, class Add>
RecoveredStress fitted(const Fitting& f, const std::vector<Samples>& samples, const PatchSize& size,
                       const Add& add_to) {
  const Corners& c = f.corners;
  const Index corners = static_cast<Index>(c.vertex.size()), triangles = static_cast<Index>(c.of.size());
  RecoveredStress r{Eigen::Matrix3Xd(3, corners),         Eigen::Matrix3Xd(3, triangles), P,
                    Eigen::MatrixXd(3 * dim(P), corners), Eigen::VectorXd(corners),       {}};
  r.kept = with_neighbors(c, f.singular);
  const Lists places = places_of(c);
  parallel_for(corners, f.model.threads, [&](Index begin, Index end) {
    Patch patch(c, places, f.singular);
    for (Index i = begin; i < end; ++i) {
      if (r.kept[i]) {
        r.at_corners.col(i) = average(f, places, i);
        continue;
      }
      const Vec2& corner = f.model.mesh.points[c.vertex[i]];
      const auto& around = patch.around(i, size);
      r.reach[i] = reach_of(around, samples, corner);
      Fit<P> fit;
      for (const Index t : around) add_to(fit, samples[t], corner, r.reach[i]);
      Eigen::Map<Eigen::Matrix<double, 3, dim(P)>> coefficients(r.coefficients.col(i).data());
      coefficients = fit.solve();
      r.at_corners.col(i) = coefficients.col(0);
    }
  });
  parallel_for(triangles, f.model.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t)
      r.at_centroids.col(t) = blended<P>(f.model, f.field, c, r, {t, samples[t].center});
  });
  return r;
}

template <int P>
RecoveredStress from_means(const Fitting& f, const VectorField& load) {
  std::vector<Mean> means(f.corners.of.size());
  parallel_for(static_cast<Index>(means.size()), f.model.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) means[t] = mean(f.model, f.field, t, load);
  });
  return fitted<P>(f, means, {.rings = 2, .triangles = dim(P) + 4},
                   [](Fit<P>& fit, const Mean& of, const Vec2& corner, double reach) { add(fit, of, corner, reach); });
}

template <int P>
RecoveredStress from_values(const Fitting& f) {
  const TriangleRule rule = triangle_rule(4);
  std::vector<Values> samples(f.corners.of.size());
  parallel_for(static_cast<Index>(samples.size()), f.model.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) samples[t] = values(f.model, f.field, t, rule);
  });
  return fitted<P>(
      f, samples, {.rings = 1, .triangles = 5},
      [&](Fit<P>& fit, const Values& of, const Vec2& corner, double reach) { add(fit, of, corner, reach, rule); });
}

// Per vertex whether contact begins or ends there.
std::vector<bool> contact_changes(const Model& model, const Field& state) {
  const Mesh& mesh = model.mesh;
  const Skeleton& s = model.inner->skeleton;
  // Pressures that are small change nothing; faces between contact and gap would flicker.
  const double least = mesh.cracks.empty() ? 0 : 1e-3 * mean_stress(model, state);
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

std::vector<bool> singular_corners(const Model& model, const Field& state, const Corners& c) {
  const std::vector<bool> changes = contact_changes(model, state);
  const std::vector<double> angle = corner_angles(model.mesh, c);
  std::vector<bool> result(c.vertex.size(), false);
  for (std::size_t i = 0; i < angle.size(); ++i) result[i] = angle[i] > reentrant_angle || changes[c.vertex[i]];
  return result;
}

RecoveredStress recover_stress(const Model& m, const Field& s, const Corners& c, const std::vector<bool>& singular,
                               const VectorField& load) {
  const Fitting fitting{m, s, c, singular};
  switch (m.element.order) {
    case 1:
      return from_means<2>(fitting, load);
    case 2:
      return from_means<3>(fitting, load);
    default:
      return from_values<4>(fitting);
  }
}

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
    default:
      return blended<4>(m, s, c, r, at);
  }
}

}  // namespace kerf
