// Products with K triangle by triangle, for bodies that bend by motions far larger than their strains. The assembled K
// maps a rigid motion to rounding of its own size instead of to nothing; here the motion of each triangle is taken out
// first,
//   K x = sum_T P K_T P x,   P = I - R (R'R)^-1 R'   [theory: E.17, E.18],
// R the traces of the three motions at the Gauss points. x is carried in twice the precision, P x is formed in it
// [Dekker 1971] from points and frames that both sides of an edge share to the last bit; the rest, of the size of the
// strains, is double. The same way leads back to the fields in the triangles (`recover_interior`), where the motion is
// added to u and r alone. Derived in docs/theory/elements.md, section Slender bodies.

#include "solver/system/elementwise.hpp"

#include "base/parallel.hpp"

#include <cmath>

namespace kerf {

namespace {

// A number in twice the precision [Dekker 1971].
struct Twice {
  double high = 0, low = 0;
};

// The sum is exact: s + rest = a + b, whichever is larger (six operations).
Twice sum(double a, double b) {
  const double s = a + b, part = s - a;
  return {s, (a - (s - part)) + (b - part)};
}
Twice operator+(const Twice& a, const Twice& b) {
  const Twice s = sum(a.high, b.high);
  const double low = s.low + (a.low + b.low), high = s.high + low;
  return {high, low - (high - s.high)};
}
// p and the remainder of the multiply-add are a.high b exactly; what a.low adds is rounded.
Twice operator*(const Twice& a, double b) {
  const double p = a.high * b, low = std::fma(a.high, b, -p) + a.low * b, high = p + low;
  return {high, low - (high - p)};
}

// from + s (to - from) - center
Twice offset(double from, double to, double s, double center) {
  return sum(to, -from) * s + sum(from, -center);
}

// The displacement of a motion at an offset, along a direction.
Twice along(const RigidMotion& motion, const Twice& dx, const Twice& dy, const Vec2& direction) {
  const Twice u = dy * -motion.rotation + Twice{motion.translation.x(), 0},
              v = dx * motion.rotation + Twice{motion.translation.y(), 0};
  return u * direction.x() + v * direction.y();
}

struct Traced {
  std::array<Twice, max_skeleton> of;
  SkeletonVector high;
};

// What the right side of a crack sees, base plus jump, is summed before it is rounded: both may be large and nearly
// cancel.
Traced trace_exactly(const Model& m, const DoubleDouble& values, Index t) {
  const Seen view = seen(m.mesh, m.inner->skeleton, t);
  const auto at = [&](Index u) -> Twice { return {values.high[u], values.low.size() > 0 ? values.low[u] : 0}; };
  Traced trace;
  trace.high.resize(view.count);
  for (int i = 0; i < view.count; ++i) {
    trace.of[i] = at(view.base[i]);
    if (view.jump[i] != none) trace.of[i] = trace.of[i] + at(view.jump[i]);
    trace.high[i] = trace.of[i].high;
  }
  return trace;
}

// What the local problems give back is added in the order of the triangles, whatever the number of threads.
// A force on what the right side sees, u + j, acts on u and on j.
Eigen::VectorXd scattered_to_edges(const Model& m, const Eigen::MatrixXd& local) {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(m.inner->skeleton.total);
  for (Index t = 0; t < static_cast<Index>(local.cols()); ++t) {
    const Seen view = seen(m.mesh, m.inner->skeleton, t);
    for (int i = 0; i < view.count; ++i) {
      all[view.base[i]] += local(i, t);
      if (view.jump[i] != none) all[view.jump[i]] += local(i, t);
    }
  }
  return all;
}

}  // namespace

void add(DoubleDouble& x, double share, const Eigen::VectorXd& y) {
  if (x.low.size() == 0) x.low.setZero(x.high.size());
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    const Twice next = Twice{x.high[i], x.low[i]} + Twice{share * y[i], 0};
    x.high[i] = next.high;
    x.low[i] = next.low;
  }
}

// The nearest rigid motion is found in double precision and subtracted in twice that; of what is left, small, the
// share of the motions is taken out in double precision.
Strained strained(const Model& m, const DoubleDouble& values, Index t) {
  const Kernel& k = m.inner->kernel;
  const Triangle shape = triangle(m, t);
  const Traced trace = trace_exactly(m, values, t);
  const Vec2 center = centroid(shape);
  const double h = std::sqrt(2 * area(shape));
  Strained s;
  static_cast<MotionTraces&>(s) = motion_traces(k, shape, center, h);
  const Eigen::Vector3d most = s.inverse * (s.span.transpose() * trace.high);
  s.motion = {center, most.head<2>(), most[2] / h};
  s.rest = trace.high;
  for_each_point(k, shape,
                 [&](int first, const Mat2& frame, const Vec2& a, const Vec2& b, double at, const Vec2& beyond) {
                   const Twice dx = offset(a.x(), b.x(), at, center.x()) + Twice{beyond.x(), 0},
                               dy = offset(a.y(), b.y(), at, center.y()) + Twice{beyond.y(), 0};
                   for (int c = 0; c < 2; ++c)
                     s.rest[first + c] = (trace.of[first + c] + along(s.motion, dx, dy, frame.col(c)) * -1).high;
                 });
  if (k.element.at_vertices == AtVertices::Rotation)
    for (Eigen::Index i = s.rest.size() - 3; i < s.rest.size(); ++i)
      s.rest[i] = (trace.of[i] + Twice{s.motion.rotation, 0}).high;
  const Eigen::Vector3d little = s.inverse * (s.span.transpose() * s.rest);
  s.rest -= s.span * little;
  s.motion.translation += little.head<2>();
  s.motion.rotation += little[2] / h;
  return s;
}

// On a curved triangle the displacement of a motion is the projection of the places onto the element's polynomials
// (seen_places); on a straight one it is linear in xi. The rotation has the sign of (N.1).
void add_motion(const Model& m, Index t, const RigidMotion& motion, Eigen::Ref<Eigen::VectorXd> interior) {
  const Element& e = m.element;
  const int first = stress_count(e), rotation = first + displacement_count(e);
  if (const Triangle shape = triangle(m, t); is_curved(shape)) {
    const Points places = seen_places(m.inner->kernel, shape);
    for (Eigen::Index b = 0; b < places.cols(); ++b) {
      const Vec2 d = places.col(b) - (b == 0 ? motion.center : Vec2::Zero().eval());
      interior.segment<2>(first + 2 * static_cast<int>(b)) +=
          (b == 0 ? motion.translation : Vec2::Zero().eval()) + motion.rotation * Vec2(-d.y(), d.x());
    }
    interior[rotation] -= motion.rotation;
    return;
  }
  interior.segment<2>(first) += motion.at(centroid(m.mesh, t));
  if (e.displacement > 0) {  // the coefficients of xi = (x - centroid)/h
    const double turn = motion.rotation * std::sqrt(2 * area(m.mesh, t));
    interior[first + 3] += turn;
    interior[first + 4] -= turn;
  }
  interior[rotation] -= motion.rotation;
}

LaneMotions strain_lanes(const Kernel& k, const Triangle& t, double* traces) {
  const double h = std::sqrt(2 * area(t));
  const MotionTraces s = motion_traces(k, t, centroid(t), h);
  const Eigen::Index n = s.span.rows();
  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, lanes, Eigen::RowMajor>> rest(traces, n, lanes);
  LaneMotions all = LaneMotions::Zero();
  for (int time = 0; time < 2; ++time) {  // the second takes what rounding has left
    LaneMotions on = LaneMotions::Zero(), share = LaneMotions::Zero();
    for (Eigen::Index i = 0; i < n; ++i)
      for (int c = 0; c < 3; ++c) on.row(c) += s.span(i, c) * rest.row(i);
    for (int c = 0; c < 3; ++c)
      for (int d = 0; d < 3; ++d) share.row(c) += s.inverse(c, d) * on.row(d);
    for (Eigen::Index i = 0; i < n; ++i)
      for (int c = 0; c < 3; ++c) rest.row(i) -= s.span(i, c) * share.row(c);
    all += share;
  }
  all.row(2) /= h;
  return all;
}

void add_motions(const Element& e, const Triangle& t, const LaneMotions& motions, double* interior) {
  const int first = stress_count(e), rotation = first + displacement_count(e);
  const auto row = [&](int i) { return Eigen::Map<Eigen::Matrix<double, 1, lanes>>(interior + i * lanes); };
  row(first) += motions.row(0);
  row(first + 1) += motions.row(1);
  if (e.displacement > 0) {
    const double h = std::sqrt(2 * area(t));
    row(first + 3) += h * motions.row(2);
    row(first + 4) -= h * motions.row(2);
  }
  row(rotation) -= motions.row(2);
}

double penalty_at(const Model& m, Index t) {
  return m.inner->system.penalty / material_of(m.mesh, m.scene, t).mu;
}

// `noise`: the energy that rounding of the trace makes, (1000 eps)^2 mu |x|^2 per triangle: of a body that moves as a
// whole nothing else is left.
Balance recover_interior(const Model& m, const DoubleDouble& values, const Eigen::VectorXd& theta, Field& field) {
  const Index triangles = static_cast<Index>(m.mesh.triangles.size());
  const bool loaded = m.inner->system.force.cols() > 0;
  const bool penalized = m.inner->system.penalty > 0;
  const int count = skeleton_count(m.element);
  Eigen::MatrixXd forces(count, triangles), given(count, loaded ? triangles : 0);
  Eigen::MatrixXd sums(2, triangles);
  field.interior.resize(interior_count(m.element), triangles);
  constexpr Index most = 8;  // side by side
  parallel_for(triangles, m.threads, [&](Index begin, Index end) {
    std::array<LocalTriangle, most> locals;
    std::array<Recovered, most> found;
    std::array<Strained, most> strains;
    for (Index first = begin; first < end; first += most) {
      const auto count = static_cast<std::size_t>(std::min(most, end - first));
      for (std::size_t i = 0; i < count; ++i) {
        const Index t = first + static_cast<Index>(i);
        strains[i] = strained(m, values, t);
        locals[i] = {triangle(m, t),
                     &material_of(m.mesh, m.scene, t),
                     force_of(m.inner->system, t),
                     {.a = penalty_at(m, t), .theta = penalized ? theta[t] : 0}};
        m.inner->system.alike->share(t, locals[i]);
        found[i].m = strains[i].rest;
        found[i].interior = field.interior.col(t).data();
      }
      interiors(m.inner->kernel, std::span(locals).first(count), std::span(found).first(count));
      for (std::size_t i = 0; i < count; ++i) {
        const Index t = first + static_cast<Index>(i);
        const Strained& s = strains[i];
        const TraceForces& f = found[i].forces;
        add_motion(m, t, s.motion, field.interior.col(t));
        forces.col(t) = s.without_motions(f.of_trace);
        if (loaded) given.col(t) = f.given;
        const double size =
            locals[i].material->mu * trace_seen(m.mesh, m.inner->skeleton, values.high, t).squaredNorm();
        sums.col(t) << s.rest.dot(f.of_trace), size;
      }
    }
  });
  Balance b{scattered_to_edges(m, forces), m.inner->system.tractions};
  if (loaded) b.loads += scattered_to_edges(m, given);
  constexpr double rounding = 1000 * std::numeric_limits<double>::epsilon();
  const Index own = own_triangles(m);
  b.energy = sums.row(0).head(own).sum();
  b.noise = rounding * rounding * sums.row(1).head(own).sum();
  return b;
}

namespace {

// take(t, K_T) of all triangles, by several threads.
template <typename Take>
void for_each_condensed(const Model& m, const Take& take) {
  parallel_for(static_cast<Index>(m.mesh.triangles.size()), m.threads, [&](Index begin, Index end) {
    std::array<LocalTriangle, 4> locals;
    std::array<Condensed, 4> found;
    for (Index first = begin; first < end; first += 4) {
      const auto count = static_cast<std::size_t>(std::min<Index>(4, end - first));
      for (std::size_t i = 0; i < count; ++i) {
        const Index t = first + static_cast<Index>(i);
        locals[i] = {triangle(m, t), &material_of(m.mesh, m.scene, t), {}, {.a = penalty_at(m, t)}};
        m.inner->system.alike->share(t, locals[i]);
      }
      condense(m.inner->kernel, std::span(locals).first(count), std::span(found).first(count));
      for (std::size_t i = 0; i < count; ++i) take(first + static_cast<Index>(i), found[i].K);
    }
  });
}

}  // namespace

Elementwise::Elementwise(const Model& m) : m_(m) {
  const int n = skeleton_count(m.element);
  const Index triangles = static_cast<Index>(m.mesh.triangles.size());
  lower_.resize(n * (n + 1) / 2, triangles);
  for_each_condensed(m, [&](Index t, const SkeletonMatrix& K) {
    double* to = lower_.col(t).data();
    for (int j = 0; j < n; ++j)
      for (int i = j; i < n; ++i) *to++ = K(i, j);
  });
}

Elementwise::Product Elementwise::operator()(const DoubleDouble& values) const {
  const int n = skeleton_count(m_.element);
  const Index triangles = static_cast<Index>(m_.mesh.triangles.size());
  Eigen::MatrixXd forces(n, triangles);
  Eigen::VectorXd energy(triangles);
  parallel_for(triangles, m_.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) {
      const Strained s = strained(m_, values, t);
      SkeletonVector f = SkeletonVector::Zero(n);
      const double* entry = lower_.col(t).data();
      for (int j = 0; j < n; ++j) {
        double sum = *entry++ * s.rest[j];
        for (int i = j + 1; i < n; ++i, ++entry) {
          f[i] += *entry * s.rest[j];
          sum += *entry * s.rest[i];
        }
        f[j] += sum;
      }
      energy[t] = s.rest.dot(f);
      forces.col(t) = s.without_motions(f);
    }
  });
  return {scattered_to_edges(m_, forces), energy.sum()};
}

}  // namespace kerf
