#pragma once
// The operations of the mixed elements on one triangle: local problem, elimination, fields, in arrays of compile-time
// size. local_<family>.cpp instantiate them, local.cpp picks.

#include "solver/element/elimination.hpp"
#include "solver/element/interior_fields.hpp"

namespace kerf {

template <const Element& E>
struct MixedTriangle : LocalProblem<E>, InteriorFields<E> {
  static constexpr int S = Space<E>::S, B = Space<E>::B, V = Space<E>::V, X = Space<E>::X;
  using LocalProblem<E>::assemble;
  using InteriorFields<E>::acting, InteriorFields<E>::unpack, InteriorFields<E>::has_eigenstrain,
      InteriorFields<E>::eigenstrain_load;

  // m_xi: rotations at vertices, the last of m, have no length in them.
  static Rowwise<X, 1> scaled(const Scaled& s, const SkeletonVector& m) {
    Rowwise<X, 1> v;
    for (int i = 0; i < X; ++i) v[i] = i < X - V ? m[i] / s.h : m[i];
    return v;
  }

  // The load of an eigenstrain as Elimination takes it.
  struct Strained {
    Rowwise<S, 1> stress;
    Rowwise<B, 1> low;
  };
  static Strained reduced_eigenstrain(const Reduction<E>& e, const Kernel& k, const Scaled& s,
                                      const ForceMoments& force) {
    Strained load{eigenstrain_load(k, s, force), {}};
    Rowwise<B, 1> nothing;
    set_zero(nothing);
    load.low = e.reduce(load.stress, nothing);
    return load;
  }

  static Condensed condense(const Kernel& k, const Triangle& t, const Material& material, const ForceMoments& force,
                            const Penalty& penalty) {
    const Scaled s = scale(t);
    const LocalArrays<E, S> a = assemble(k, t, s, material, force);
    const Compliant<double> is = compliant(material, penalty);
    const Elimination<E> e(a, is);
    Condensed result = e.shares(s, force.size() > 0, is).of(0);
    if (has_eigenstrain(force)) {
      const Strained more = reduced_eigenstrain(e, k, s, force);
      result.F += e.pull(a, s, more.stress, more.low);
      if (penalty.a > 0) result.own += e.mean_trace(more.stress, more.low);
    }
    return result;
  }

  // The same elimination backwards. The forces are made of the stress that is found, C s, not of K m: its rounding
  // balances itself on the triangle.
  static Eigen::VectorXd interior(const Kernel& k, const Triangle& t, const Material& material,
                                  const ForceMoments& force, const SkeletonVector& m, const Penalty& penalty,
                                  TraceForces* forces) {
    const Scaled s = scale(t);
    const LocalArrays<E, S> a = assemble(k, t, s, material, force);
    const Compliant<double> is = compliant(material, penalty);
    const Reduction<E> e(a, is);
    const bool strained = has_eigenstrain(force);
    const Strained more = strained ? reduced_eigenstrain(e, k, s, force) : Strained{};
    const auto found = strained ? e.back(a, scaled(s, m), e.given + more.low, a.given, &more.stress, is)
                                : e.back(a, scaled(s, m), e.given, a.given, nullptr, is);
    if (forces) {
      forces->given = SkeletonVector::Zero(X);
      if (force.size() > 0) forces->given = e.pull(a, s, Rowwise<S, 1>::Zero(), e.given);
      if (strained) forces->given += e.pull(a, s, more.stress, more.low);
      forces->of_trace = e.tractions(a, s, found.stress, s.h);
      forces->of_trace += forces->given;
    }
    return unpack(k, s, material, found.stress.data(), found.inner.data(), m);
  }

  // Four straight triangles side by side; `count` of them are wanted.
  // Cut spaces go through matrices of run-time size, which are not packed.
  static constexpr bool CanBePacked = !Space<E>::IsCut && V == 0 && !is_symmetric(E);
  struct Packed {
    ScaledOf<Pack> s;
    Compliant<Pack> is;
    LocalArrays<E, S, Pack> a;
  };
  // Lane by lane what LocalProblem assembles: moments and edges are computed in packs, the compliance and the scaling
  // per triangle.
  static void pack(const Kernel& k, const PackedTriangles& all, Packed& to) {
    using Problem = LocalProblem<E>;
    typename Problem::template Compliance<Pack> A;
    std::array<typename Problem::template Side<Pack>, 3> sides;
    Problem::template clear<Pack>(to.a);
    to.is.penalized = all[0]->penalty.a > 0;
    for (int at = 0; at < pack_size; ++at) {
      const LocalTriangle& one = *all[static_cast<std::size_t>(at)];
      const Scaled s = scale(one.shape);
      to.s.center.set(at, s.center);
      to.s.h[at] = s.h;
      const Compliant<double> is = compliant(*one.material, one.penalty);
      to.is.gamma[at] = is.gamma, to.is.a[at] = is.a, to.is.theta[at] = is.theta;
      const Eigen::Matrix4d compliance_here = compliance(*one.material);
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j)
          A[i][j][at] = compliance_here(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      for (std::size_t e = 0; e < 3; ++e) {
        to.s.x[e].set(at, s.x[e]);
        to.s.gradient[e].set(at, s.gradient[e]);
        const auto side = Problem::side_of(one.shape, static_cast<int>(e));
        for (std::size_t g = 0; g < side.frame.size(); ++g)
          for (std::size_t d = 0; d < 2; ++d) sides[e].frame[g][d].set(at, side.frame[g][d]);
        sides[e].forward[at] = side.forward;
      }
      for (int i = 0; i < Space<E>::U && one.force.size() > 0; ++i)
        to.a.given[i][at] = Problem::share_of_force(s) * one.force[i];
    }
    const auto of = Problem::template moments<Pack>(k, to.s);
    Problem::template add_straight<Pack>(of, A, to.a);
    Problem::template add_divergence<Pack>(of, to.a);
    for (std::size_t e = 0; e < 3; ++e) Problem::template add_edge<Pack>(k, sides[e], to.s, static_cast<int>(e), to.a);
  }

  static void condense_packed(const Kernel& k, const PackedTriangles& all, int count, Condensed* const* to) {
    if constexpr (CanBePacked) {
      Packed p;
      pack(k, all, p);
      const Elimination<E, Pack> e(p.a, p.is);
      const auto shares = e.shares(p.s, all[0]->force.size() > 0, p.is);
      for (int i = 0; i < count; ++i) *to[i] = shares.of(i);
    }
  }

  static void interior_packed(const Kernel& k, const PackedTriangles& all, int count, Recovered* const* to) {
    if constexpr (CanBePacked) {
      constexpr int F = Space<E>::F, U = Space<E>::U;
      Packed p;
      pack(k, all, p);
      const Reduction<E, Pack> e(p.a, p.is);
      Grid<Pack, X, 1> m;
      set_zero(m);
      for (int at = 0; at < count; ++at)
        for (int i = 0; i < X; ++i) m[i][at] = to[at]->m[i] / p.s.h[at];
      const auto found = e.back(p.a, m, e.given, p.a.given, nullptr, p.is);
      Grid<Pack, S, 1> nothing;
      set_zero(nothing);
      Grid<Pack, X, 1> given;
      set_zero(given);
      if (all[0]->force.size() > 0) given = e.pull(p.a, p.s, nothing, e.given);
      const Grid<Pack, X, 1> of_trace = e.tractions(p.a, p.s, found.stress, p.s.h);
      for (int at = 0; at < count; ++at) {
        Recovered& r = *to[at];
        for (int i = 0; i < F; ++i) r.interior[i] = found.stress[i][at];
        for (int b = 0; b < B; ++b) r.interior[F + b] = (b < U ? p.s.h[at] : 1) * found.inner[b][at];
        r.forces.given.resize(X);
        r.forces.of_trace.resize(X);
        for (int i = 0; i < X; ++i) {
          r.forces.given[i] = given[i][at];
          r.forces.of_trace[i] = of_trace[i][at] + given[i][at];
        }
      }
    }
  }

  // Traces without loads: one elimination serves all columns.
  static Eigen::MatrixXd interiors(const Kernel& k, const Triangle& t, const Material& material,
                                   const Eigen::MatrixXd& m) {
    const Scaled s = scale(t);
    const LocalArrays<E, S> a = assemble(k, t, s, material, {});
    const Reduction<E> e(a, compliant(material, {}));
    Eigen::MatrixXd all(interior_count(E), m.cols());
    for (Eigen::Index i = 0; i < m.cols(); ++i) {
      const auto found = e.back(a, scaled(s, m.col(i)), e.given, a.given, nullptr, compliant(material, {}));
      all.col(i) = unpack(k, s, material, found.stress.data(), found.inner.data(), m.col(i));
    }
    return all;
  }

  // Eight fields side by side, one value after the other: the inner loops run over fields. Elements that are cut,
  // symmetric or have rotations at vertices take the way of columns.
  static void interiors_lanes(const Kernel& k, const Triangle& t, const Material& material, const double* m,
                              double* all) {
    const Scaled s = scale(t);
    if constexpr (Space<E>::IsCut || V > 0 || is_symmetric(E)) {
      const Eigen::Map<const Eigen::Matrix<double, X, lanes, Eigen::RowMajor>> traces(m);
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, lanes, Eigen::RowMajor>>(all, interior_count(E), lanes) =
          interiors(k, t, material, traces);
    } else {
      const LocalArrays<E, S> a = assemble(k, t, s, material, {});
      const Reduction<E> e(a, compliant(material, {}));
      Rowwise<X, lanes> scaled_m;
      for (int i = 0; i < X * lanes; ++i) scaled_m.data()[i] = m[i] / s.h;
      typename Reduction<E>::template Solutions<lanes> found;
      e.template back<lanes>(a, scaled_m, found);
      constexpr int F = Space<E>::F, U = Space<E>::U;
      std::copy_n(found.stress.data(), F * lanes, all);
      for (int b = 0; b < B; ++b)
        for (int j = 0; j < lanes; ++j) all[(F + b) * lanes + j] = (b < U ? s.h : 1) * found.inner(b, j);
    }
  }

  // Loads with all edges at rest, m = 0: the particular solutions that the traces are added to.
  static void loaded(const Kernel& k, const Triangle& t, const Material& material, const Eigen::MatrixXd& forces,
                     Loaded& to) {
    const Scaled s = scale(t);
    const LocalArrays<E, S> a = assemble(k, t, s, material, {});
    const Reduction<E> e(a, compliant(material, {}));
    const Rowwise<X, 1> at_rest = Rowwise<X, 1>::Zero();
    const SkeletonVector nothing = SkeletonVector::Zero(X);
    for (Eigen::Index i = 0; i < forces.cols(); ++i) {
      const ForceMoments force = forces.col(i);
      Rowwise<B, 1> right;
      set_zero(right);
      for (int b = 0; b < Space<E>::U; ++b) right[b] = LocalProblem<E>::share_of_force(s) * force[b];
      Rowwise<B, 1> low = right;
      forward<B, 1>(e.LB, low);
      to.given.col(i) = e.pull(a, s, Rowwise<S, 1>::Zero(), low);
      Strained more{Rowwise<S, 1>::Zero(), Rowwise<B, 1>::Zero()};
      if (has_eigenstrain(force)) {
        more = reduced_eigenstrain(e, k, s, force);
        to.given.col(i) += e.pull(a, s, more.stress, more.low);
      }
      const auto found = e.back(a, at_rest, low + more.low, right, &more.stress, compliant(material, {}));
      to.interior.col(i) = unpack(k, s, material, found.stress.data(), found.inner.data(), nothing);
    }
  }

  // The adjoint has the same matrix and -J for its loads, on stresses, displacements and rotations [theory: A.2, A.6].
  static DualLoad condense_dual(const Kernel& k, const Triangle& t, const Material& material, const Eigen::VectorXd& J,
                                const Penalty& penalty) {
    const Scaled s = scale(t);
    const LocalArrays<E, S> a = assemble(k, t, s, material, {});
    const Reduction<E> e(a, compliant(material, penalty));
    auto load = acting(k, s, material, J);
    const Rowwise<B, 1> low = e.reduce(load.stress, load.given);
    DualLoad result{e.pull(a, s, load.stress, low), 0};
    for (int v = 0; v < V; ++v) result.F[X - V + v] += load.at_vertices[v];
    if (penalty.a > 0) result.own = e.mean_trace(load.stress, low);
    return result;
  }

  static Eigen::VectorXd interior_dual(const Kernel& k, const Triangle& t, const Material& material,
                                       const Eigen::VectorXd& J, const SkeletonVector& m, const Penalty& penalty) {
    const Scaled s = scale(t);
    const LocalArrays<E, S> a = assemble(k, t, s, material, {});
    const Reduction<E> e(a, compliant(material, penalty));
    auto load = acting(k, s, material, J);
    const Rowwise<B, 1> given = load.given;
    load.given = e.reduce(load.stress, load.given);
    const auto found = e.back(a, scaled(s, m), load.given, given, &load.stress, compliant(material, penalty));
    return unpack(k, s, material, found.stress.data(), found.inner.data(), m);
  }

  // In xi, nothing eliminated: the saddle point without elimination takes it (C.13).
  static LocalSystem local_system(const Kernel& k, const Triangle& t, const Material& material,
                                  const ForceMoments& force) {
    const Scaled s = scale(t);
    const LocalArrays<E, S> a = assemble(k, t, s, material, force);
    return {s.h,
            by_columns(a.M.data(), S, S),
            by_columns(a.Bt.data(), S, B),
            by_columns(a.Ct.data(), S, X),
            by_columns(a.given.data(), B, 1),
            by_columns(a.trace.data(), S, 1),
            has_eigenstrain(force) ? Eigen::VectorXd(eigenstrain_load(k, s, force)) : Eigen::VectorXd()};
  }

  static Eigen::VectorXd interior_of(const Kernel& k, const Triangle& t, const Material& material,
                                     const Eigen::VectorXd& local, const SkeletonVector& m) {
    return unpack(k, scale(t), material, local.data(), local.data() + S, m);
  }
};

/// The functions of one element, by which local.cpp reaches the instance.
template <const Element& E>
constexpr Operations mixed_operations() {
  using Sized = MixedTriangle<E>;
  return {&Sized::condense,
          &Sized::interior,
          &Sized::evaluate,
          &Sized::stress_at_point,
          &Sized::weigh,
          &Sized::local_system,
          &Sized::interior_of,
          &Sized::condense_dual,
          &Sized::interior_dual,
          &Sized::interiors,
          &Sized::interiors_lanes,
          &Sized::evaluate_lanes,
          &Sized::loaded,
          Sized::CanBePacked ? &Sized::condense_packed : nullptr,
          Sized::CanBePacked ? &Sized::interior_packed : nullptr};
}

}  // namespace kerf
