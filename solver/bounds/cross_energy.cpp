// The products of two states that differences of energies are made of.

#include "solver/anisotropic.hpp"
#include "solver/bounds/admissible.hpp"
#include "solver/bounds/right_inverse.hpp"
#include "solver/parallel.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace kerf {

namespace {

/// Of the lower and the upper bound as quadratic forms, and the sizes of what they are sums of.
struct Products {
  double lower = 0, upper = 0, size = 0;

  void add_lower(double term) {
    lower += term;
    size += std::abs(term);
  }
  void add_upper(double term) {
    upper += term;
    size += std::abs(term);
  }
};

/// A p : q.
double compliance_product(const Material& m, const Eigen::Vector4d& p, const Eigen::Vector4d& q) {
  const double differences = (p[0] - p[3]) * (q[0] - q[3]), traces = (p[0] + p[3]) * (q[0] + q[3]);
  double sum = (0.5 * differences + p[1] * q[1] + p[2] * q[2]) / (2 * m.mu) + m.c * traces;
  if (isotropic(m)) return sum;
  const Eigen::Vector3d e = orthotropic_strain(m, p[0], p[3], 0.5 * (p[1] + p[2]));
  return sum + e[0] * q[0] + e[1] * q[3] + e[2] * (q[1] + q[2]);
}

/// C d : e of displacement gradients less eigenstrains.
double stiffness_product(const Material& m, const Eigen::Matrix3d& C, const Eigen::Vector4d& d,
                         const Eigen::Vector4d& e) {
  if (!isotropic(m)) return Eigen::Vector3d(d[0], d[3], d[1] + d[2]).dot(C * Eigen::Vector3d(e[0], e[3], e[1] + e[2]));
  const double differences = (d[0] - d[3]) * (e[0] - e[3]), shears = (d[1] + d[2]) * (e[1] + e[2]);
  const double volumes = (d[0] + d[3]) * (e[0] + e[3]);
  return m.mu * (differences + shears) + (m.c > 0 ? volumes / (4 * m.c) : 0);
}

class Crossing {
 public:
  Crossing(const AdmissiblePair& u, const AdmissiblePair& w) : u_(u), w_(w) {}

  Products inside(Index t) const {
    const bool rich = !u_.edges[t].empty();
    const TriangleRule& rule = rich ? u_.rich : u_.plain;
    const Share &a = u_.shares[t], &b = w_.shares[t];
    const Triangle shape = triangle(u_.m, t);
    const Material& material = material_of(u_.m.mesh, u_.m.scene, t);
    const Eigen::Matrix3d C = isotropic(material) ? Eigen::Matrix3d::Zero() : stress_matrix(material);
    const Eigen::Matrix4Xd free_a = eigenstrain(u_, t, rule), free_b = eigenstrain(w_, t, rule);
    Products sum;
    for (Eigen::Index q = 0; q < rule.w.size(); ++q) {
      const double weight = rule.w[q] * area(shape);
      double work = compliance_product(material, a.kept_stress.col(q), b.kept_stress.col(q));
      if (free_a.cols() > 0) work += free_a.col(q).dot(b.kept_stress.col(q));
      if (free_b.cols() > 0) work += free_b.col(q).dot(a.kept_stress.col(q));
      sum.add_lower(-0.5 * weight * work);
      sum.add_upper(0.5 * weight * stiffness_product(material, C, a.kept_strain.col(q), b.kept_strain.col(q)));
    }
    sum.add_upper(-0.5 * area(shape) * (work_of_force(u_, w_, t, rule) + work_of_force(w_, u_, t, rule)));
    return sum;
  }

  /// Loads on the displacement of data edge i, prescribed values on its tractions.
  Products on_edge(std::size_t i) const {
    static const EdgeRule carrier = gauss(data_carriers);
    const EdgeData &a = u_.data[i], &b = w_.data[i];
    const double l = length(u_.m.mesh, a.edge);
    Products sum;
    for (int k = 0; k < 2; ++k) {
      double work = 0;
      for (int g = 0; g < data_carriers; ++g)
        work += 0.5 * l * carrier.w[g] *
                (a.load(k, g) * w_.conforming.value[i](k, g) + b.load(k, g) * u_.conforming.value[i](k, g));
      sum.add_upper(-work);
      if (!a.held[k]) continue;
      sum.add_lower(0.5 * (work_of_support(u_, w_, i, k) + work_of_support(w_, u_, i, k)) - work);
      sum.size += 0.5 * (size_at_support(u_, w_, i) + size_at_support(w_, u_, i));
    }
    return sum;
  }

 private:
  static Eigen::Matrix4Xd eigenstrain(const AdmissiblePair& a, Index t, const TriangleRule& rule) {
    const StrainData& strain = a.m.inner->data.strain;
    return strain.empty() ? Eigen::Matrix4Xd() : strain_at(strain, t, rule.x);
  }

  /// The mean of f of one times v of the other.
  static double work_of_force(const AdmissiblePair& of, const AdmissiblePair& on, Index t, const TriangleRule& rule) {
    if (of.f.nodal.cols() == 0) return 0;
    const Eigen::Map<const Points> nodal(of.f.nodal.col(t).data(), 2, of.f.nodal.rows() / 2);
    const Points at = nodal * interpolation(of.f.degree, rule.x).transpose();
    return (at.cwiseProduct(on.shares[t].kept_displacement) * rule.w).sum();
  }

  /// Component k of the tractions of one on the values prescribed for the other.
  static double work_of_support(const AdmissiblePair& of, const AdmissiblePair& on, std::size_t i, int k) {
    const EdgeData& d = of.data[i];
    const EdgeRule& trace = of.m.inner->kernel.trace;
    double work = 0;
    for (Eigen::Index g = 0; g < trace.w.size(); ++g) {
      const Index unknown = d.edge * on.m.inner->skeleton.per_edge + 2 * static_cast<Index>(g) + k;
      work += trace.w[g] * of.shares[d.triangle].tractions(k, trace.w.size() * d.side + g) *
              on.m.inner->skeleton.prescribed[unknown];
    }
    return length(of.m.mesh, d.edge) * work;
  }

  /// Of the terms of that work in any direction: a component that vanishes is as precise as the others are.
  static double size_at_support(const AdmissiblePair& of, const AdmissiblePair& on, std::size_t i) {
    const EdgeData& d = of.data[i];
    const EdgeRule& trace = of.m.inner->kernel.trace;
    double size = 0;
    for (Eigen::Index g = 0; g < trace.w.size(); ++g) {
      const auto first = static_cast<std::size_t>(d.edge * on.m.inner->skeleton.per_edge + 2 * static_cast<Index>(g));
      const std::vector<double>& prescribed = on.m.inner->skeleton.prescribed;
      size += trace.w[g] * of.shares[d.triangle].tractions.col(trace.w.size() * d.side + g).norm() *
              std::hypot(prescribed[first], prescribed[first + 1]);
    }
    return length(of.m.mesh, d.edge) * size;
  }

  const AdmissiblePair &u_, &w_;
};

/// For squares q(u + k w) <= (q(u)^1/2 + k q(w)^1/2)^2.
double together(double u, double w, double k) {
  return std::pow(std::sqrt(std::max(u, 0.0)) + k * std::sqrt(std::max(w, 0.0)), 2);
}

/// At least what the data of u + k w and of u - k w leave out.
Oscillation oscillation(const AdmissiblePair& u, const AdmissiblePair& w, double k) {
  Oscillation o;
  double square = 0;
  for (std::size_t i = 0; i < u.shares.size(); ++i) {
    const auto both = [&](double a, double b) { return a + k * b; };
    square += std::pow(both(u.rests[i].data, w.rests[i].data), 2);
    o.correction += both(u.rests[i].body, w.rests[i].body) * both(u.shares[i].rough, w.shares[i].rough);
    o.quadrature += both(u.rests[i].quadrature, w.rests[i].quadrature) * both(u.shares[i].largest, w.shares[i].largest);
  }
  o.eta = std::sqrt(square);
  return o;
}

/// The same of eigenstrains: below and above together.
double eigenstrain_unseen(const AdmissiblePair& u, const AdmissiblePair& w, double k) {
  const StrainData &a = u.m.inner->data.strain, &b = w.m.inner->data.strain;
  if (a.empty() && b.empty()) return 0;
  double sum = 0;
  for (Index t = 0; t < static_cast<Index>(u.shares.size()); ++t) {
    const Share &x = u.shares[t], &y = w.shares[t];
    const double rest = together(a.empty() ? 0 : a.rest[t], b.empty() ? 0 : b.rest[t], k),
                 error = (a.empty() ? 0 : a.error[t]) + k * (b.empty() ? 0 : b.error[t]);
    if (rest == 0 && error == 0) continue;
    const Triangle shape = triangle(u.m, t);
    sum += area(shape) * (std::sqrt(rest * together(x.square, y.square, k)) + error * (x.stress + k * y.stress));
    sum += moved_by_eigenstrain(material_of(u.m.mesh, u.m.scene, t), shape, rest, error,
                                {together(x.elastic, y.elastic, k), x.gradient + k * y.gradient,
                                 x.stress + k * y.stress, x.force + k * y.force});
  }
  return sum;
}

Products products(const AdmissiblePair& u, const AdmissiblePair& w) {
  const Crossing crossing(u, w);
  const Index triangles = static_cast<Index>(u.shares.size());
  std::vector<Products> each(u.shares.size());
  parallel_for(triangles, u.m.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) each[static_cast<std::size_t>(t)] = crossing.inside(t);
  });
  Products sum;
  const auto add = [&](const Products& p) {
    sum.lower += p.lower;
    sum.upper += p.upper;
    sum.size += p.size;
  };
  for (const Products& p : each) add(p);
  for (std::size_t i = 0; i < u.data.size(); ++i) add(crossing.on_edge(i));
  return sum;
}

bool fit(const AdmissiblePair& u, const AdmissiblePair& w) {
  return u.plain.w.size() == w.plain.w.size() && u.rich.w.size() == w.rich.w.size() &&
         std::ranges::equal(u.data, w.data, [](const EdgeData& a, const EdgeData& b) {
           return a.edge == b.edge && a.triangle == b.triangle && a.held == b.held;
         });
}

/// Whose interval is narrowest. Loads of w that act on held edges alone move nothing: what they work is known.
double best_step(double own, double other, double middle) {
  if (!(own > 0)) return 1;
  if (other > 0) return std::sqrt(own / other);
  constexpr double digits = 1e16;
  return middle > 0 ? digits * own / middle : 1;
}

}  // namespace

CrossEnergy cross_energy(const AdmissiblePair& u, const AdmissiblePair& w) {
  for (const AdmissiblePair* of : {&u, &w})
    if (!std::isfinite(of->bounds.upper - of->bounds.lower)) return {.note = of->bounds.note};
  if (!fit(u, w)) throw std::invalid_argument("cross_energy: the loaded edges or the degrees differ");
  const double own = u.bounds.upper - u.bounds.lower, other = w.bounds.upper - w.bounds.lower;
  const Products p = products(u, w);
  const double k = best_step(own, other, std::abs(p.lower + p.upper));
  const auto plain_gap = [](const AdmissiblePair& a) { return std::max(a.sum.upper - a.sum.lower, 0.0); };
  // What rounding moves is measured of each; together it is at most twice that.
  const double rounding = 2 * (u.rounding + k * k * w.rounding), gap = plain_gap(u) + k * k * plain_gap(w),
               largest = together(plain_gap(u), plain_gap(w), k) + 2 * rounding;
  const Unseen more =
      unseen(u.m, oscillation(u, w, k), together(u.conforming.mismatch, w.conforming.mismatch, k), largest);
  CrossEnergy out;
  out.middle = -(p.lower + p.upper);
  out.half = (gap + 2 * rounding + more.below + more.above + eigenstrain_unseen(u, w, k)) / (2 * k) +
             64 * std::numeric_limits<double>::epsilon() * p.size;
  constexpr double negligible = 0.01;
  const bool asymptotic = (unseen_couples(u.f) || unseen_couples(w.f)) && more.below > negligible * gap;
  out.guaranteed = u.bounds.guaranteed && w.bounds.guaranteed && more.displaced <= negligible * gap && !asymptotic;
  if (!out.guaranteed)
    out.note = !u.bounds.guaranteed   ? u.bounds.note
               : !w.bounds.guaranteed ? w.bounds.note
                                      : std::string("the bounds are estimates: the data are not resolved by the mesh");
  return out;
}

}  // namespace kerf
