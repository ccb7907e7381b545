#pragma once
// What is done with a solution: coefficients (s, u, r) of a triangle, their values at points, and the transpose of
// that.

#include "solver/element/local_problem.hpp"

namespace kerf {

// Rotation of a symmetric element, from the derivatives of its strain e = A s:
//   d1 r = d2 e11 - d1 e12,  d2 r = d2 e12 - d1 e22,
// in the mean of squares, with the mean of (d2 u1 - d1 u2)/2.
Eigen::VectorXd rotation_of(const Kernel& k, const Scaled& s, const Material& material, const Eigen::VectorXd& all);

template <const Element& E>
struct InteriorFields : Space<E> {
  using Base = Space<E>;
  using Base::P, Base::W, Base::F, Base::S, Base::U, Base::B, Base::V, Base::X, Base::IsCut, Base::monomials_at,
      Base::curls_at;

  // Of the local problem's solution s, (u_xi, r).
  // u = h u_xi; rotations have no length. Rotations at vertices become the coefficients of their linear interpolant.
  static Eigen::VectorXd unpack(const Kernel& k, const Scaled& s, const Material& material, const double* stress,
                                const double* inner, const SkeletonVector& m) {
    Eigen::VectorXd all(interior_count(E));
    if constexpr (IsCut)
      all.head(F) = span_of(k, s) * Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(stress, S));
    else
      std::copy_n(stress, F, all.data());
    for (int b = 0; b < B; ++b) all[F + b] = (b < U ? s.h : 1) * inner[b];
    if constexpr (V > 0) {
      const Eigen::Vector3d at = m.template tail<V>();
      all[F + U] = at.mean();
      for (int d = 0; d < 2; ++d)
        all[F + U + 1 + d] = at[0] * s.gradient[0][d] + at[1] * s.gradient[1][d] + at[2] * s.gradient[2][d];
    }
    if constexpr (is_symmetric(E)) all.tail(rotation_count(E)) = rotation_of(k, s, material, all);
    return all;
  }

  // What an eigenstrain adds to the right-hand side of the stress functions: M s + B'p = C'm + this.
  static bool has_eigenstrain(const ForceMoments& force) {
    return can_be_strained(E) && force.size() == U + F;
  }
  // -(e, tau) of (H.3). `force` holds means over the triangle, hence the area 1/2.
  static Rowwise<S, 1> eigenstrain_load(const Kernel& k, const Scaled& s, const ForceMoments& force) {
    constexpr double share = -0.5;  // the triangle's area in xi is 1/2
    Rowwise<S, 1> load;
    if constexpr (IsCut) {
      const Eigen::VectorXd on_span = span_of(k, s).transpose() * force.segment<F>(U);
      for (int i = 0; i < S; ++i) load[i] = share * on_span[i];
    } else {
      for (int i = 0; i < S; ++i) load[i] = share * force[U + i];
    }
    return load;
  }

  // -J as loads: on the stress functions (M s + B'p = C'm + stress), on the constraints, on the unknowns at vertices.
  struct Acting {
    Rowwise<S, 1> stress;
    Rowwise<B, 1> given;
    std::array<double, 3> at_vertices;
  };
  // h^2 times the local problem in xi is that in x: a load on stresses is divided by h^2, one on u = h u_xi by h (E.6).
  // What J sees of a rotation at vertices goes to the skeleton.
  static Acting acting(const Kernel& k, const Scaled& s, const Material& material, const Eigen::VectorXd& J) {
    Eigen::VectorXd by = J;
    if constexpr (is_symmetric(E)) {  // the rotation is a linear function of the rest
      constexpr int N = rotation_count(E);
      if (!by.tail<N>().isZero(0)) {
        Eigen::VectorXd unit = Eigen::VectorXd::Zero(interior_count(E));
        for (int i = 0; i < F + U; ++i) {
          unit[i] = 1;
          by[i] += by.tail<N>().dot(rotation_of(k, s, material, unit));
          unit[i] = 0;
        }
      }
    }
    Acting a;
    const double area = s.h * s.h;
    if constexpr (IsCut) {
      const Eigen::VectorXd on_span = span_of(k, s).transpose() * by.head(F);
      for (int i = 0; i < S; ++i) a.stress[i] = -on_span[i] / area;
    } else {
      for (int i = 0; i < S; ++i) a.stress[i] = -by[i] / area;
    }
    for (int b = 0; b < B; ++b) a.given[b] = -by[F + b] / (b < U ? s.h : area);
    a.at_vertices.fill(0);
    if constexpr (V > 0)
      for (int v = 0; v < 3; ++v)
        a.at_vertices[v] = by[F + U] / 3 + by[F + U + 1] * s.gradient[v].x() + by[F + U + 2] * s.gradient[v].y();
    return a;
  }

  static Eigen::Vector4d stress_at(const Scaled& s, const Eigen::Ref<const Eigen::VectorXd>& c, const Vec2& xi) {
    const auto v = monomials_at(xi);
    Eigen::Vector4d value = Eigen::Vector4d::Zero();
    for (int m = 0; m < P; ++m) value += v[m] * c.template segment<4>(4 * m);
    if constexpr (W > 0) {
      const auto curl = curls_at(s, xi, v);
      for (int b = 0; b < W; ++b) {
        value.template head<2>() += c[4 * P + 2 * b] * curl.row(b).transpose();
        value.template tail<2>() += c[4 * P + 2 * b + 1] * curl.row(b).transpose();
      }
    }
    return value;
  }

  static Eigen::Vector4d stress_at_point(const Triangle& t, const Eigen::Ref<const Eigen::VectorXd>& c, const Vec2& x) {
    const Scaled s = scale(t);
    const Place p = place_of(t, s, x);
    return p.pushed(stress_at(s, c, p.xi));
  }

  // A point in the coordinates of the spaces; stresses there stand for these of the body: S D'/J [theory: E.26].
  struct Place {
    Vec2 xi;
    bool curved = false;
    Mat2 D = Mat2::Identity();
    double J = 1;

    Eigen::Vector4d pushed(const Eigen::Vector4d& S) const {
      if (!curved) return S;
      const Vec2 first = D * S.template head<2>() / J, second = D * S.template tail<2>() / J;
      return {first.x(), first.y(), second.x(), second.y()};
    }
    // The transpose.
    Eigen::Vector4d pulled(const Eigen::Vector4d& w) const {
      if (!curved) return w;
      const Vec2 first = D.transpose() * w.template head<2>() / J, second = D.transpose() * w.template tail<2>() / J;
      return {first.x(), first.y(), second.x(), second.y()};
    }
  };
  static Place place_of(const Triangle& t, const Scaled& s, const Vec2& x) {
    if (!is_curved(t)) return {(x - s.center) / s.h};
    const Vec2 l = cell_coordinates(t, x);
    const CellMap map = cell_map(t, l);
    return {point(s, l.x(), l.y()), true, map.D, map.J};
  }

  // Stresses of a curved triangle are pushed by Piola's transformation; displacements and rotations are taken over as
  // they are (E.26).
  static Fields evaluate(const Triangle& t, const Eigen::Ref<const Eigen::VectorXd>& c, const Points& x) {
    const Scaled s = scale(t);
    Fields f{Eigen::Matrix4Xd(4, x.cols()), Points::Zero(2, x.cols()), Eigen::RowVectorXd::Zero(x.cols())};
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      const Place p = place_of(t, s, x.col(i));
      const auto v = monomials_at(p.xi);
      f.stress.col(i) = p.pushed(stress_at(s, c, p.xi));
      for (int b = 0; b < U / 2; ++b) f.displacement.col(i) += v[b] * c.template segment<2>(F + 2 * b);
      for (int r = 0; r < rotation_count(E); ++r) f.rotation[i] += v[r] * c[F + U + r];
    }
    return f;
  }

  // Of fields side by side in a straight triangle.
  static void evaluate_lanes(const Triangle& t, const double* c, const Points& x, double* fields) {
    using Row = Eigen::Array<double, 1, lanes>;
    const Scaled s = scale(t);
    const auto at = [&](int i) { return Eigen::Map<const Row>(c + i * lanes); };
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      const Vec2 xi = (x.col(i) - s.center) / s.h;
      const auto v = monomials_at(xi);
      double* to = fields + i * lane_fields * lanes;
      const auto put = [&](int k, const Row& value) { Eigen::Map<Row>(to + k * lanes) = value; };
      for (int k = 0; k < 4; ++k) {
        Row sum = v[0] * at(k);
        for (int m = 1; m < P; ++m) sum += v[m] * at(4 * m + k);
        if constexpr (W > 0) {
          const auto curl = curls_at(s, xi, v);
          for (int b = 0; b < W; ++b) sum += curl(b, k % 2) * at(4 * P + 2 * b + k / 2);
        }
        put(k, sum);
      }
      for (int k = 0; k < 2; ++k) {
        Row sum = v[0] * at(F + k);
        for (int b = 1; b < U / 2; ++b) sum += v[b] * at(F + 2 * b + k);
        put(4 + k, sum);
      }
      Row turn = Row::Zero();
      for (int r = 0; r < rotation_count(E); ++r) turn += v[r] * at(F + U + r);
      put(6, turn);
    }
  }

  // The transpose of `evaluate`, term by term.
  static Eigen::VectorXd weigh(const Triangle& t, const Points& x, const Fields& w) {
    const Scaled s = scale(t);
    Eigen::VectorXd all = Eigen::VectorXd::Zero(interior_count(E));
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      const Place p = place_of(t, s, x.col(i));
      const auto v = monomials_at(p.xi);
      const Eigen::Vector4d by_stress = p.pulled(w.stress.col(i));
      for (int m = 0; m < P; ++m) all.template segment<4>(4 * m) += v[m] * by_stress;
      if constexpr (W > 0) {
        const auto curl = curls_at(s, p.xi, v);
        for (int b = 0; b < W; ++b) {
          all[4 * P + 2 * b] += curl.row(b) * by_stress.template head<2>();
          all[4 * P + 2 * b + 1] += curl.row(b) * by_stress.template tail<2>();
        }
      }
      for (int b = 0; b < U / 2; ++b) all.template segment<2>(F + 2 * b) += v[b] * w.displacement.col(i);
      for (int r = 0; r < rotation_count(E); ++r) all[F + U + r] += v[r] * w.rotation[i];
    }
    return all;
  }
};

}  // namespace kerf
