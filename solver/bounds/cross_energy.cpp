// The products of two states that differences of energies are made of.
// Let L and U be the lower and the upper bound of (B.1) as quadratic functions of the admissible fields and the data.
// Then
//   Pi(u + k w) lies between L(u) + 2 k L(u, w) + k^2 L(w) and U(u) + 2 k U(u, w) + k^2 U(w), and so
//   | -(Pi(u + k w) - Pi(u - k w))/(2 k) + L(u, w) + U(u, w) |  <=  (gap(u) + k^2 gap(w))/(2 k)      [theory: B.12],
// which is least at k^2 = gap(u)/gap(w): the square root of the two gaps. The admissible fields of u and of w are
// enough, for every k. What the data leave out [theory: B.9], the rest of eigenstrains [theory: B.28], rounding, and on
// curved cells the two rules and the arcs [theory: B.40] widen it. docs/theory/bounds.md, "Stresses at points, K and
// G".

#include "base/parallel.hpp"
#include "solver/anisotropic.hpp"
#include "solver/bounds/admissible.hpp"
#include "solver/bounds/curved.hpp"
#include "solver/bounds/right_inverse.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace kerf {

namespace {

/// A p : q.
/// Of stresses that are symmetric up to rounding; components in the order 11, 12, 21, 22.
double compliance_product(const Material& m, const Eigen::Vector4d& p, const Eigen::Vector4d& q) {
  const double differences = (p[0] - p[3]) * (q[0] - q[3]), traces = (p[0] + p[3]) * (q[0] + q[3]);
  double sum = (0.5 * differences + p[1] * q[1] + p[2] * q[2]) / (2 * m.mu) + m.c * traces;
  if (isotropic(m)) return sum;
  const Eigen::Vector3d e = orthotropic_strain(m, p[0], p[3], 0.5 * (p[1] + p[2]));
  return sum + e[0] * q[0] + e[1] * q[3] + e[2] * (q[1] + q[2]);
}

/// C d : e of displacement gradients less eigenstrains.
/// Without compressibility (c = 0) the deviators alone: neither strain has a trace.
double stiffness_product(const Material& m, const Eigen::Matrix3d& C, const Eigen::Vector4d& d,
                         const Eigen::Vector4d& e) {
  if (!isotropic(m)) return Eigen::Vector3d(d[0], d[3], d[1] + d[2]).dot(C * Eigen::Vector3d(e[0], e[3], e[1] + e[2]));
  const double differences = (d[0] - d[3]) * (e[0] - e[3]), shears = (d[1] + d[2]) * (e[1] + e[2]);
  const double volumes = (d[0] + d[3]) * (e[0] + e[3]);
  return m.mu * (differences + shears) + (m.c > 0 ? volumes / (4 * m.c) : 0);
}

/// Component k of the tractions of one on the values prescribed for the other.
/// At the Gauss points of the trace, where the prescribed values are those of the skeleton.
double work_of_support(const EdgeSide& of, const EdgeSide& on, int k) {
  const EdgeData& d = of.data;
  const EdgeRule& trace = of.m.inner->kernel.trace;
  double work = 0;
  for (Eigen::Index g = 0; g < trace.w.size(); ++g) {
    const Index unknown = d.edge * on.m.inner->skeleton.per_edge + 2 * static_cast<Index>(g) + k;
    work += trace.w[g] * of.tractions(k, trace.w.size() * d.side + g) * on.m.inner->skeleton.prescribed[unknown];
  }
  return length(of.m.mesh, d.edge) * work;
}

/// Of the terms of that work in any direction: a component that vanishes is as precise as the others are.
/// It measures rounding only: |t| |u_D| at every Gauss point.
double size_at_support(const EdgeSide& of, const EdgeSide& on) {
  const EdgeData& d = of.data;
  const EdgeRule& trace = of.m.inner->kernel.trace;
  double size = 0;
  for (Eigen::Index g = 0; g < trace.w.size(); ++g) {
    const auto first = static_cast<std::size_t>(d.edge * on.m.inner->skeleton.per_edge + 2 * static_cast<Index>(g));
    const std::vector<double>& prescribed = on.m.inner->skeleton.prescribed;
    size += trace.w[g] * of.tractions.col(trace.w.size() * d.side + g).norm() *
            std::hypot(prescribed[first], prescribed[first + 1]);
  }
  return length(of.m.mesh, d.edge) * size;
}

Eigen::Matrix4Xd eigenstrain(const AdmissiblePair& a, Index t, const TriangleRule& rule) {
  const StrainData& strain = a.m.inner->data.strain;
  return strain.empty() ? Eigen::Matrix4Xd() : strain_at(strain, t, rule.x);
}

/// The mean of f of one times v of the other.
double work_of_force(const AdmissiblePair& of, const AdmissiblePair& on, Index t, const TriangleRule& rule) {
  if (of.f.nodal.cols() == 0) return 0;
  const Eigen::Map<const Points> nodal(of.f.nodal.col(t).data(), 2, of.f.nodal.rows() / 2);
  const Points at = nodal * interpolation(of.f.degree, rule.x).transpose();
  return (at.cwiseProduct(on.shares[t].kept_displacement) * rule.w).sum();
}

/// f of one times v of the other, at the points l of the rule.
Eigen::RowVectorXd forced(const AdmissiblePair& of, const AdmissiblePair& on, Index t, const Points& l) {
  if (of.f.nodal.cols() == 0) return Eigen::RowVectorXd::Zero(l.cols());
  const Eigen::Map<const Points> nodal(of.f.nodal.col(t).data(), 2, of.f.nodal.rows() / 2);
  const Points at = nodal * interpolation(of.f.degree, l).transpose();
  return at.cwiseProduct(on.shares[t].kept_displacement).colwise().sum();
}

/// On a curved cell, by its two rules.
Products inside_curved(const AdmissiblePair& u, const AdmissiblePair& w, Index t) {
  const Share &a = u.shares[t], &b = w.shares[t];
  const Material& material = material_of(u.m.mesh, u.m.scene, t);
  const Eigen::Matrix3d C = isotropic(material) ? Eigen::Matrix3d::Zero() : stress_matrix(material);
  const Points& l = u.edges[t].empty() ? u.plain_curved : u.rich_curved;
  const auto free = [&](const AdmissiblePair& of) -> Eigen::Matrix4Xd {
    const StrainData& strain = of.m.inner->data.strain;
    return strain.empty() ? Eigen::Matrix4Xd(Eigen::Matrix4Xd::Zero(4, l.cols())) : strain_at(strain, t, l);
  };
  const Eigen::Matrix4Xd free_u = free(u), free_w = free(w);
  Vec2 lower = Vec2::Zero(), upper = Vec2::Zero();  // by either rule
  double size = 0;
  for (Eigen::Index q = 0; q < a.kept_weight.cols(); ++q) {
    const double p = -0.5 * (compliance_product(material, a.kept_stress.col(q), b.kept_stress.col(q)) +
                             free_u.col(q).dot(b.kept_stress.col(q)) + free_w.col(q).dot(a.kept_stress.col(q))),
                 v = 0.5 * stiffness_product(material, C, a.kept_strain.col(q), b.kept_strain.col(q));
    lower += p * a.kept_weight.col(q);
    upper += v * a.kept_weight.col(q);
    size += (std::abs(p) + std::abs(v)) * a.kept_weight(0, q);
  }
  const double rules = doubt_of_rules * (std::abs(lower[0] - lower[1]) + std::abs(upper[0] - upper[1]));
  Eigen::RowVectorXd force = forced(u, w, t, l) + forced(w, u, t, l);  // times J, as the forces have it
  const Triangle cell = triangle(u.m, t);
  for (Eigen::Index q = 0; q < force.size(); ++q) force[q] /= cell_map(cell, l.col(q)).J;
  return {lower[0], upper[0] - 0.5 * force.dot(a.kept_weight.row(0)), size, rules};
}

/// a(u, w)/2 and the halves of the two works f_u . v_w and f_w . v_u; the eigenstrain of one works on the stress of the
/// other.
Products inside(const AdmissiblePair& u, const AdmissiblePair& w, Index t) {
  if (u.shares[t].kept_weight.cols() > 0) return inside_curved(u, w, t);
  const TriangleRule& rule = u.edges[t].empty() ? u.plain : u.rich;
  const Share &a = u.shares[t], &b = w.shares[t];
  const double size = area(triangle(u.m, t));
  Products sum = crossed_fields(material_of(u.m.mesh, u.m.scene, t), size, rule, a, b);
  const Eigen::Matrix4Xd free_a = eigenstrain(u, t, rule), free_b = eigenstrain(w, t, rule);
  if (free_a.cols() > 0) sum.add_lower(-0.5 * size * free_a.cwiseProduct(b.kept_stress).colwise().sum().dot(rule.w));
  if (free_b.cols() > 0) sum.add_lower(-0.5 * size * free_b.cwiseProduct(a.kept_stress).colwise().sum().dot(rule.w));
  sum.add_upper(-0.5 * size * (work_of_force(u, w, t, rule) + work_of_force(w, u, t, rule)));
  return sum;
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
    sum += eigenstrain_unseen(material_of(u.m.mesh, u.m.scene, t), triangle(u.m, t), rest, error, x, y, k);
  }
  return sum;
}

Products products(const AdmissiblePair& u, const AdmissiblePair& w) {
  const Index triangles = static_cast<Index>(u.shares.size());
  std::vector<Products> each(u.shares.size());
  parallel_for(triangles, u.m.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) each[static_cast<std::size_t>(t)] = inside(u, w, t);
  });
  Products sum;
  for (const Products& p : each) sum.add(p);
  for (std::size_t i = 0; i < u.data.size(); ++i) {
    const auto side = [i](const AdmissiblePair& of) -> EdgeSide {
      return {of.m, of.data[i], of.conforming.value[i], of.shares[of.data[i].triangle].tractions};
    };
    sum.add(crossed_on_edge(side(u), side(w)));
  }
  return sum;
}

/// What the products presume: the same rules in every triangle, the same edges with data in the same order.
bool fit(const AdmissiblePair& u, const AdmissiblePair& w) {
  return u.plain.w.size() == w.plain.w.size() && u.rich.w.size() == w.rich.w.size() &&
         std::ranges::equal(u.data, w.data, [](const EdgeData& a, const EdgeData& b) {
           return a.edge == b.edge && a.triangle == b.triangle && a.held == b.held;
         });
}

/// Whose interval is narrowest. Loads of w that act on held edges alone move nothing: what they work is known.
/// With gap(w) = 0 the interval shrinks as k grows; k ends where gap(u)/k reaches the last digit of the middle.
double best_step(double own, double other, double middle) {
  if (!(own > 0)) return 1;
  if (other > 0) return std::sqrt(own / other);
  constexpr double digits = 1e16;
  return middle > 0 ? digits * own / middle : 1;
}

}  // namespace

/// Both need finite bounds of their own: these stand for everything that must hold for either field to be admissible.
CrossEnergy cross_energy(const AdmissiblePair& u, const AdmissiblePair& w) {
  for (const AdmissiblePair* of : {&u, &w})
    if (!std::isfinite(of->bounds.upper - of->bounds.lower)) return {.note = of->bounds.note};
  if (!fit(u, w)) throw std::invalid_argument("cross_energy: the loaded edges or the degrees differ");
  const auto side = [](const AdmissiblePair& a) -> CrossSide {
    return {a.bounds,
            std::max(a.sum.upper - a.sum.lower, 0.0),
            a.rounding,
            a.conforming.mismatch,
            unseen_couples(a.f),
            a.beyond_arcs,
            a.sum.rules};
  };
  return cross_interval(
      u.m, side(u), side(w), products(u, w), [&](double k) { return oscillation(u, w, k); },
      [&](double k) { return eigenstrain_unseen(u, w, k); });
}

Products crossed_fields(const Material& material, double area, const TriangleRule& rule, const Share& a,
                        const Share& b) {
  const Eigen::Matrix3d C = isotropic(material) ? Eigen::Matrix3d::Zero() : stress_matrix(material);
  Products sum;
  for (Eigen::Index q = 0; q < rule.w.size(); ++q) {
    const double half = 0.5 * rule.w[q] * area;
    sum.add_lower(-half * compliance_product(material, a.kept_stress.col(q), b.kept_stress.col(q)));
    sum.add_upper(half * stiffness_product(material, C, a.kept_strain.col(q), b.kept_strain.col(q)));
  }
  return sum;
}

/// Loads on held components are part of both forms, as in the bounds of one state (triangle_bounds.cpp).
Products crossed_on_edge(const EdgeSide& u, const EdgeSide& w) {
  static const EdgeRule carrier = gauss(data_carriers);
  const double l = length(u.m.mesh, u.data.edge);
  Products sum;
  for (int k = 0; k < 2; ++k) {
    double work = 0;
    for (int g = 0; g < data_carriers; ++g)
      work += 0.5 * l * carrier.w[g] * (u.data.load(k, g) * w.value(k, g) + w.data.load(k, g) * u.value(k, g));
    sum.add_upper(-work);
    if (!u.data.held[k]) continue;
    sum.add_lower(0.5 * (work_of_support(u, w, k) + work_of_support(w, u, k)) - work);
    sum.size += 0.5 * (size_at_support(u, w) + size_at_support(w, u));
  }
  return sum;
}

double eigenstrain_unseen(const Material& material, const Triangle& t, double rest, double error, const StrainShare& u,
                          const StrainShare& w, double k) {
  const double stress = u.stress + k * w.stress;
  return area(t) * (std::sqrt(rest * together(u.square, w.square, k)) + error * stress) +
         moved_by_eigenstrain(
             material, t, rest, error,
             {together(u.elastic, w.elastic, k), u.strain + k * w.strain, stress, u.force + k * w.force});
}

double together(double u, double w, double k) {
  return std::pow(std::sqrt(std::max(u, 0.0)) + k * std::sqrt(std::max(w, 0.0)), 2);
}

/// `largest`: the gap of u + k w is at most (gap(u)^1/2 + k gap(w)^1/2)^2, and that of u - k w, too. `unseen` is that
/// of one energy below and one above, as the two signs of k need them.
CrossEnergy cross_interval(const Model& m, const CrossSide& u, const CrossSide& w, const Products& p,
                           const std::function<Oscillation(double k)>& oscillation,
                           const std::function<double(double k)>& strain) {
  const auto width = [](const CrossSide& a) { return a.bounds.upper - a.bounds.lower - 2 * a.beyond_arcs; };
  const double own = width(u), other = width(w);
  const double k = best_step(own, other, std::abs(p.lower + p.upper));
  // What rounding moves is measured of each; together it is at most twice that.
  const double rounding = 2 * (u.rounding + k * k * w.rounding), gap = u.gap + k * k * w.gap,
               largest = together(u.gap, w.gap, k) + 2 * rounding;
  const Unseen more = unseen(m, oscillation(k), together(u.mismatch, w.mismatch, k), largest);
  CrossEnergy out;
  out.middle = -(p.lower + p.upper);
  out.half = (gap + 2 * rounding + more.below + more.above + strain(k)) / (2 * k) +
             64 * std::numeric_limits<double>::epsilon() * p.size;
  // On arcs the energy has a form in the state beyond the polynomials of the edges, too.
  const double arcs = 2 * std::sqrt(u.beyond_arcs * w.beyond_arcs);
  out.half += p.rules + (u.rules + k * k * w.rules) / (2 * k) + arcs;
  constexpr double negligible = 0.01;
  const bool asymptotic = (u.couples || w.couples) && more.below > negligible * gap;
  out.guaranteed = u.bounds.guaranteed && w.bounds.guaranteed && more.displaced <= negligible * gap && !asymptotic;
  if (!out.guaranteed && !m.mesh.arc.empty())
    out.note = fmt::format(
        "the bounds are estimates: what arcs have beyond the polynomials of the edges is put at {:.1g}", arcs);
  else if (!out.guaranteed)
    out.note = !u.bounds.guaranteed   ? u.bounds.note
               : !w.bounds.guaranteed ? w.bounds.note
                                      : std::string("the bounds are estimates: the data are not resolved by the mesh");
  return out;
}

}  // namespace kerf
