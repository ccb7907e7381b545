// Every element on one triangle of any shape, size and place: dimension, traces, unisolvence, what the condensed
// matrix does not see, mapping, linear fields.

#include "base/polynomial.hpp"
#include "solver/system.hpp"
#include "tests/solver/scenes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <random>

namespace kerf::element_space_test {
namespace {

constexpr int triangles = 12;  // per test

Mat2 turn(double angle) {
  return (Mat2() << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle)).finished();
}

// Symmetric tensors as (s11, s22, sqrt(2) s12).
Eigen::Vector3d flat(const Mat2& s) {
  return {s(0, 0), s(1, 1), std::sqrt(2.0) * s(0, 1)};
}
Mat2 symmetric(const Eigen::Vector3d& v) {
  const double shear = v[2] / std::sqrt(2.0);
  return (Mat2() << v[0], shear, shear, v[1]).finished();
}

// Aspect ratios up to 10, sizes 1e-3, 1, 1e3; frames turned arbitrarily, edge directions at random.
struct Shapes {
  std::mt19937 random{7};
  double in(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  }
  Triangle next(const Element& e, int trial) {
    const double size = std::pow(10, 3 * (trial % 3 - 1));
    const Mat2 place = size * turn(in(0, 6.3));
    Triangle t;
    t.x = {Vec2(0, 0), Vec2(1, 0), Vec2(in(0, 1), std::pow(10, -in(0, 1)))};
    for (Vec2& x : t.x) x = place * (x + Vec2(3, -2));
    for (int i = 0; i < 3; ++i) {
      t.frame[i] = turn(in(0, 6.3));
      t.forward[i] = in(0, 1) < 0.5;
      if (e.at_vertices == AtVertices::Displacement) t.corner[i].topLeftCorner<2, 2>() = turn(in(0, 6.3));
      if (e.at_vertices == AtVertices::Stress)
        t.corner[i] =
            Eigen::HouseholderQR<Eigen::Matrix3d>(Eigen::Matrix3d::NullaryExpr([&](Eigen::Index, Eigen::Index) {
              return in(-1, 1);
            })).householderQ();
    }
    return t;
  }
};

int rank(const Eigen::MatrixXd& a) {
  Eigen::MatrixXd scaled = a;
  for (Eigen::Index i = 0; i < scaled.rows(); ++i) scaled.row(i) /= std::max(scaled.row(i).norm(), 1e-300);
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(scaled);
  qr.setThreshold(1e-10);
  return static_cast<int>(qr.rank());
}

Eigen::MatrixXd stacked(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  Eigen::MatrixXd all(a.rows() + b.rows(), a.cols());
  all << a, b;
  return all;
}

double size_of(const Triangle& t) {
  return std::sqrt(2 * area(t));
}

// What a displacement, its rotation and its stress are to the skeleton.
SkeletonVector skeleton_of(const Kernel& k, const Triangle& t, const std::function<Vec2(const Vec2&)>& u,
                           double rotation, const Mat2& stress) {
  const Element& e = k.element;
  SkeletonVector m(skeleton_count(e));
  for (int i = 0; i < 3; ++i) {
    for (int g = 0; g < points_per_edge(e); ++g)
      m.segment<2>(per_edge(e) * i + 2 * g) = t.frame[i].transpose() * u(trace_point(k, t, i, g));
    const int at = 3 * per_edge(e) + per_vertex(e) * i;
    if (e.at_vertices == AtVertices::Rotation) m[at] = rotation;
    if (e.at_vertices == AtVertices::Displacement)
      m.segment<2>(at) = t.corner[i].topLeftCorner<2, 2>().transpose() * u(t.x[i]);
    if (e.at_vertices == AtVertices::Stress) m.segment<3>(at) = t.corner[i].transpose() * flat(stress);
  }
  return m;
}

// A basis of the element's stresses (interior coefficients, columns): what the cut leaves; or, where that depends on
// the triangle, all answers to traces and loads.
Eigen::MatrixXd stresses(const Kernel& k, const Triangle& t) {
  const Element& e = k.element;
  const int full = stress_count(e);
  Eigen::MatrixXd all;
  if (e.cut == Cut::LinearNormal) {
    const int m = skeleton_count(e), f = displacement_count(e);
    all = Eigen::MatrixXd::Zero(interior_count(e), m + f);
    for (int i = 0; i < m + f; ++i) {
      const SkeletonVector values = i < m ? SkeletonVector(SkeletonVector::Unit(m, i)) : SkeletonVector::Zero(m);
      ForceMoments force = ForceMoments::Zero(f);
      if (i >= m) force[i - m] = 1;
      all.col(i).head(full) = interior(k, t, plane_strain(1, 0.3), force, values).head(full);
      all.col(i).normalize();
    }
    return all;
  }
  const Eigen::MatrixXd cut = e.cut == Cut::None ? Eigen::MatrixXd(Eigen::MatrixXd::Identity(full, full)) : k.cut;
  all = Eigen::MatrixXd::Zero(interior_count(e), cut.cols());
  all.topRows(full) = cut;
  return all;
}

// Linear functionals of those stresses, one per row.
struct Functionals {
  Eigen::MatrixXd values;         // at points of the triangle, components 11, 12, 21, 22 of each
  Eigen::MatrixXd divergence;     // its coefficients, both rows of each monomial of the barycentric coordinates
  Eigen::MatrixXd asymmetry;      // moments of s12 - s21 against P_rotation
  Eigen::MatrixXd moments, rest;  // Legendre coefficients of s n on the edges: up to the trace's degree, and above
  Eigen::MatrixXd normal_rest;    // above, of n . s n
  Eigen::MatrixXd vertices;       // symmetric parts of the values there
  Eigen::MatrixXd mean;           // symmetric part
};

Functionals functionals(const Kernel& k, const Triangle& t) {
  const Element& e = k.element;
  const Eigen::MatrixXd basis = stresses(k, t);
  const int n = static_cast<int>(basis.cols()), degree = stress_degree(e);
  const TriangleRule rule = triangle_rule(2 * degree + 1);
  const Points x = rule_points(rule, t);
  const Eigen::MatrixXd v = monomials(degree, rule.x);
  const Eigen::MatrixXd fit = v.transpose().completeOrthogonalDecomposition().pseudoInverse();
  const Eigen::MatrixXd against = monomials(e.rotation, rule.x) * rule.w.asDiagonal();
  Mat2 jacobian;
  jacobian << t.x[1] - t.x[0], t.x[2] - t.x[0];
  const Mat2 inverse = size_of(t) * jacobian.inverse();
  const EdgeRule edge = gauss(degree + 2);
  Functionals f;
  f.values.resize(4 * x.cols(), n);
  f.divergence = Eigen::MatrixXd::Zero(2 * dim(degree), n);
  f.asymmetry.resize(dim(e.rotation), n);
  const int low = 2 * (e.trace + 1), high = 2 * (degree + 1) - low;
  f.moments = Eigen::MatrixXd::Zero(3 * low, n);
  f.rest = Eigen::MatrixXd::Zero(3 * high, n);
  f.normal_rest = Eigen::MatrixXd::Zero(3 * high / 2, n);
  f.vertices.resize(9, n);
  f.mean.resize(3, n);
  for (int i = 0; i < n; ++i) {
    const Eigen::Matrix4Xd s = evaluate(k, t, basis.col(i), x).stress;
    f.values.col(i) = Eigen::Map<const Eigen::VectorXd>(s.data(), s.size());
    for (int row = 0; row < 2; ++row) {
      Eigen::VectorXd divergence = Eigen::VectorXd::Zero(dim(degree));
      for (int axis = 0; axis < 2; ++axis) {
        const Eigen::VectorXd c = fit * s.row(2 * row + axis).transpose();
        for (int l = 0; l < 2; ++l) divergence += inverse(l, axis) * (derivative(degree, l) * c);
      }
      for (int m = 0; m < dim(degree); ++m) f.divergence(2 * m + row, i) = divergence[m];
    }
    f.asymmetry.col(i) = against * (s.row(1) - s.row(2)).transpose();
    const Eigen::Vector4d mean = s * rule.w;
    f.mean.col(i) << mean[0], mean[3], 0.5 * (mean[1] + mean[2]);
    for (int j = 0; j < 3; ++j) {
      const Vec2 &from = t.x[(j + 1) % 3], side = t.x[(j + 2) % 3] - from, normal = -turn(0.5 * pi) * side.normalized();
      for (Eigen::Index q = 0; q < edge.s.size(); ++q) {
        const Mat2 here = tensor(stress_at(k, t, basis.col(i), from + edge.s[q] * side));
        const Vec2 traction = here * normal;
        for (int p = 0; p <= degree; ++p) {
          const double weight = edge.w[q] * legendre(p, edge.s[q]);
          if (p <= e.trace) {
            f.moments.col(i).segment<2>(low * j + 2 * p) += weight * traction;
          } else {
            f.rest.col(i).segment<2>(high * j + 2 * (p - e.trace - 1)) += weight * traction;
            f.normal_rest(high / 2 * j + p - e.trace - 1, i) += weight * normal.dot(traction);
          }
        }
      }
      const Mat2 corner = tensor(stress_at(k, t, basis.col(i), t.x[j]));
      f.vertices.col(i).segment<3>(3 * j) << corner(0, 0), corner(1, 1), 0.5 * (corner(0, 1) + corner(1, 0));
    }
  }
  return f;
}

class ElementSpace : public testing::TestWithParam<Element> {
 protected:
  const Element& e = GetParam();
  Kernel k = kernel(e);
  Shapes shapes;
};
class MixedSpace : public ElementSpace {};

TEST_P(MixedSpace, StressesHaveTheirDimensionSymmetryDivergenceAndTraces) {
  for (int trial = 0; trial < triangles; ++trial) {
    const Triangle t = shapes.next(e, trial);
    const Functionals f = functionals(k, t);
    const double size = f.values.cwiseAbs().maxCoeff();
    EXPECT_EQ(rank(f.values), stress_dimension(e)) << trial;
    if (is_symmetric(e)) {
      EXPECT_LT(f.asymmetry.cwiseAbs().maxCoeff(), 1e-12 * size);
    }
    // The divergence lies in P_displacement and fills it, with the asymmetry where that is a condition of its own.
    const int u = displacement_count(e);
    const Eigen::MatrixXd divergence = f.divergence.topRows(u);
    EXPECT_LT(f.divergence.bottomRows(f.divergence.rows() - u).cwiseAbs().maxCoeff(), 1e-10 * size);
    EXPECT_EQ(rank(divergence), u);
    if (!is_symmetric(e)) {
      EXPECT_EQ(rank(stacked(divergence, f.asymmetry)), u + rotation_count(e));
    }
    const double rest = f.rest.size() > 0 ? f.rest.cwiseAbs().maxCoeff() : 0;
    switch (e.at_vertices == AtVertices::Stress ? Cut::None : e.cut) {
      case Cut::LinearNormal:  // the normal stress is linear, the shear stress is not
        EXPECT_LT(f.normal_rest.cwiseAbs().maxCoeff(), 1e-10 * size);
        EXPECT_GT(rest, 1e-3 * size);
        EXPECT_EQ(rank(f.moments), 12);
        EXPECT_EQ(rank(stacked(f.moments, f.mean)), 15) << "unisolvent";
        break;
      case Cut::LinearDivergence:
        // At a corner n1 . s n2 = n2 . s n1: one condition on the moments of symmetric stresses per corner.
        EXPECT_LT(rest, 1e-10 * size);
        EXPECT_EQ(rank(f.moments), 21);
        EXPECT_EQ(rank(stacked(f.moments, f.mean)), 24) << "unisolvent";
        break;
      default:
        if (e.at_vertices == AtVertices::Stress) {
          const Eigen::MatrixXd known = stacked(f.moments, f.vertices);
          EXPECT_EQ(rank(known), 21);
          EXPECT_EQ(rank(stacked(known, f.rest)), 21) << "cubic normal stresses from linear moments and vertices";
          EXPECT_EQ(rank(stacked(known, f.mean)), 24) << "unisolvent";
        } else {
          EXPECT_LT(rest, 1e-10 * size);
          EXPECT_EQ(rank(f.moments), 3 * per_edge(e));
        }
    }
  }
}

TEST_P(ElementSpace, CondensedMatrixSeesAllButRigidMotions) {
  for (const double nu : {0.0, 0.3, 0.4999})
    for (int trial = 0; trial < triangles; ++trial) {
      const Triangle t = shapes.next(e, trial);
      const Material material = plane_strain(3, nu);
      Eigen::MatrixXd K = condense(k, t, material, {}).K;
      const Eigen::Index n = K.rows(), edges = 3 * per_edge(e);
      ASSERT_EQ(n, skeleton_count(e));
      const double scale = K.cwiseAbs().maxCoeff();
      EXPECT_LT((K - K.transpose()).cwiseAbs().maxCoeff(), 1e-13 * scale);
      const double h = size_of(t);
      const Vec2 center = centroid(t);
      for (int motion = 0; motion < 3; ++motion) {
        const auto u = [&](const Vec2& x) -> Vec2 {
          const Vec2 d = (x - center) / h;
          return motion == 0 ? Vec2(1, 0) : motion == 1 ? Vec2(0, 1) : Vec2(-d.y(), d.x());
        };
        const SkeletonVector m = skeleton_of(k, t, u, motion == 2 ? -1 / h : 0, Mat2::Zero());
        EXPECT_LT((K * m).cwiseAbs().maxCoeff(), 1e-11 * scale) << nu << ' ' << trial;
      }
      // Rotations and stresses at vertices scale with the triangle.
      if (e.at_vertices == AtVertices::Rotation || e.at_vertices == AtVertices::Stress) {
        K.bottomRows(n - edges) /= h;
        K.rightCols(n - edges) /= h;
      }
      const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues();
      const double zero = 1e-12 * values.cwiseAbs().maxCoeff(), positive = 1e-4 * material.mu;
      // Stresses at vertices are the dual side of the problem: quasi-definite. Without them their symmetry leaves one
      // mode of the cubic traces free at each corner.
      const Eigen::Index negative = e.at_vertices == AtVertices::Stress ? 9 : 0;
      const Eigen::Index free = e.cut == Cut::LinearDivergence && negative == 0 ? 6 : 3;
      for (Eigen::Index i = 0; i < n; ++i) {
        if (i < negative) {
          EXPECT_LT(values[i], -1e-6 / material.mu) << nu << ' ' << trial;
        } else if (i < negative + free) {
          EXPECT_LT(std::abs(values[i]), zero) << nu << ' ' << trial;
        } else {
          EXPECT_GT(values[i], positive) << nu << ' ' << trial;
        }
      }
    }
}

/// Monomials of degree 4 on thin triangles: what is lost more than by those of degree 3.
double of_quartics(const Element& e) {
  return e.stress == 4 ? 1e2 : 1;
}

TEST_P(ElementSpace, CondensedMatrixTurnsAndScalesWithTheTriangle) {
  const Material material = plane_strain(1, 0.3);
  for (int trial = 0; trial < triangles; ++trial) {
    const Triangle t = shapes.next(e, trial);
    const double factor = std::exp(shapes.in(-3, 3));
    const Mat2 q = turn(shapes.in(0, 6.3));
    Eigen::Matrix3d turned;  // of stresses
    for (int i = 0; i < 3; ++i) turned.col(i) = flat(q * symmetric(Eigen::Vector3d::Unit(i)) * q.transpose());
    Triangle other = t;
    for (int i = 0; i < 3; ++i) {
      other.x[i] = factor * (q * t.x[i]);
      other.frame[i] = q * t.frame[i];
      if (e.at_vertices == AtVertices::Displacement)
        other.corner[i].topLeftCorner<2, 2>() = q * t.corner[i].topLeftCorner<2, 2>();
      if (e.at_vertices == AtVertices::Stress) other.corner[i] = turned * t.corner[i];
    }
    Eigen::MatrixXd expected = condense(k, t, material, {}).K;
    const Eigen::Index vertices = expected.rows() - 3 * per_edge(e);
    if (e.at_vertices == AtVertices::Rotation || e.at_vertices == AtVertices::Stress) {
      expected.bottomRows(vertices) *= factor;
      expected.rightCols(vertices) *= factor;
    }
    const Eigen::MatrixXd found = condense(k, other, material, {}).K;
    EXPECT_LT((found - expected).norm(), 1e-11 * of_quartics(e) * expected.norm()) << trial;
  }
}

TEST_P(ElementSpace, LinearDisplacementGivesItsStressRotationAndItself) {
  for (const double nu : {0.0, 0.3, 0.4999})
    for (int trial = 0; trial < triangles; ++trial) {
      const Triangle t = shapes.next(e, trial);
      const Material material = plane_strain(2, nu);
      const double h = size_of(t), omega = 0.25;
      const Mat2 stress = (Mat2() << 1.3, -0.4, -0.4, 0.7).finished();
      const Mat2 gradient = strain(material, stress) + (Mat2() << 0, omega, -omega, 0).finished();
      const Vec2 center = centroid(t);
      const auto u = [&](const Vec2& x) -> Vec2 { return gradient * (x - center) + h * Vec2(0.1, 0.2); };
      ForceMoments none;
      if (e.at_vertices == AtVertices::Stress) none = ForceMoments::Zero(displacement_count(e) + cubic_trace_count);
      const Eigen::VectorXd inside = interior(k, t, material, none, skeleton_of(k, t, u, omega, stress));
      Points x(2, 2);
      x << center, 0.5 * t.x[0] + 0.3 * t.x[1] + 0.2 * t.x[2];
      const Fields f = evaluate(k, t, inside, x);
      const double tolerance = 1e-11 * of_quartics(e) / (1 - 1.99 * nu);
      for (int i = 0; i < 2; ++i) {
        EXPECT_LT((tensor(f.stress.col(i)) - stress).norm(), tolerance) << nu << ' ' << trial;
        EXPECT_NEAR(f.rotation[i], omega, tolerance) << nu << ' ' << trial;
        const Vec2 at = e.displacement == 0 ? center : Vec2(x.col(i));
        EXPECT_LT((f.displacement.col(i) - u(at)).norm(), tolerance * h) << nu << ' ' << trial;
      }
    }
}

const auto by_title = [](const auto& info) { return title(info.param); };
INSTANTIATE_TEST_SUITE_P(Elements, ElementSpace, testing::ValuesIn(elements), by_title);
INSTANTIATE_TEST_SUITE_P(Elements, MixedSpace, testing::ValuesIn(elements.begin(), elements.begin() + 11), by_title);

}  // namespace
}  // namespace kerf::element_space_test
