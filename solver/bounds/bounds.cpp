// Two-sided bounds of the potential energy Pi of the exact solution u [Prager, Synge 1947; theory: B.1],
//   -1/2 (A q, q) + <u_D, q n>  <=  Pi(u)  <=  1/2 (C eps(v), eps(v)) - l(v),
// with q in equilibrium and v continuous, from the solution on the mesh: solver/bounds/statics.cpp balances the stress,
// conforming.cpp makes v, triangle_bounds.cpp corrects both inside each triangle, and this file sums up. The interval
// is widened by what the polynomials of the data leave out [theory: B.7, B.8, B.9, B.10], by the rest of an eigenstrain
// [theory: B.28], by rounding, measured as the work of what tractions lack in balance, and along arcs by an estimate of
// what the body has beyond the polynomials of its edges. `guaranteed` is false where one of these is an estimate that
// counts. docs/theory/bounds.md derives all of it, docs/theory/guarantees.md says what it assumes.

#include "kerf/bounds.hpp"

#include "solver/anisotropic.hpp"
#include "solver/recovery.hpp"
#include "solver/shared_bounds.hpp"
#include "solver/system.hpp"

#include "base/parallel.hpp"
#include "solver/bounds/admissible.hpp"
#include "solver/bounds/curved.hpp"
#include "solver/bounds/faces.hpp"
#include "solver/bounds/right_inverse.hpp"
#include "solver/bounds/statics.hpp"
#include "solver/bounds/triangle_bounds.hpp"

#include <fmt/core.h>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

namespace kerf {

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

// |grad w - its mean rotation| <= K |eps(w)| on a triangle, K^2 = 1 + 2/beta^2 with a lower bound of the inf-sup
// constant beta of a body that sees the disk of radius r and lies in the one of radius R [Costabel, Dauge 2015]: the
// rotation has grad omega = div of a tensor as large as eps(w).
// r = 2 |T|/perimeter is the radius of the inscribed circle, R the distance of the farthest corner from its middle.
double local_korn(const Triangle& t) {
  double perimeter = 0;
  Vec2 center = Vec2::Zero();
  for (int i = 0; i < 3; ++i) {
    const double side = (t.x[(i + 2) % 3] - t.x[(i + 1) % 3]).norm();
    perimeter += side;
    center += side * t.x[i];
  }
  center /= perimeter;
  double outer = 0;
  for (const Vec2& x : t.x) outer = std::max(outer, (x - center).norm());
  const double ratio = std::pow(2 * area(t) / perimeter / outer, 2);
  const double beta_squared = ratio / (2 * (1 + std::sqrt(1 - ratio)));
  return std::sqrt(1 + 2 / beta_squared);
}

/// Of an edge, by the triangles beside it.
/// An edge between two processes counts half on each, so that sums over processes count it once.
double own_share(const Model& m, Index e) {
  double own = 0, all = 0;
  for (const Index t : m.mesh.sides[e])
    if (t != none) own += t < own_triangles(m) ? 1 : 0, all += 1;
  return own / all;
}

/// In each pair of sides the tractions are those outward from either triangle: they cancel in an equilibrated stress.
double imbalance(const Model& m, const Field& s, const std::vector<EdgeData>& data, const Conforming& conforming,
                 const std::vector<Share>& shares) {
  const Index points = points_per_edge(m.element);
  const Skeleton& skeleton = m.inner->skeleton;
  std::vector<Index> place(m.mesh.edges.size(), none);
  for (std::size_t i = data.size(); i-- > 0;) place[data[i].edge] = static_cast<Index>(i);  // of cracks the left side
  double total = 0;
  for (Index e = 0; e < static_cast<Index>(m.mesh.edges.size()); ++e) {
    const double mine = own_share(m, e);
    if (mine == 0) continue;
    EdgeWork at{e, {}, place[e] == none ? nullptr : &data[place[e]], {}, {}, conforming.penetration[e]};
    for (int k = 0; k < 2; ++k) {
      at.side[k] = Tractions::Zero(2, points);
      const Index t = m.mesh.sides[e][k];
      if (t == none) continue;
      int i = 0;
      while (m.mesh.edges_of[t][i] != e) ++i;
      at.side[k] = shares[t].tractions.middleCols(points * i, points);
    }
    at.base = s.skeleton.segment(e * skeleton.per_edge, 2 * points);
    if (skeleton.jump[e] != none) at.jump = s.skeleton.segment(skeleton.jump[e], 2 * points);
    total += mine * imbalance_on(m, at);
  }
  return total;
}

// Values of what is conforming on one side of an edge, at the Gauss points of the trace.
Points on_edge(const Model& m, const Conforming& conforming, Index e, int side) {
  const Index t = m.mesh.sides[e][side];
  int i = 0;
  while (m.mesh.edges_of[t][i] != e) ++i;
  const Eigen::VectorXd& s = m.inner->kernel.trace.s;
  Eigen::Matrix3Xd l = Eigen::Matrix3Xd::Zero(3, s.size());
  l.row((i + (side == 0 ? 1 : 2)) % 3) = (1 - s.array()).matrix().transpose();
  l.row((i + (side == 0 ? 2 : 1)) % 3) = s.transpose();
  const Eigen::Map<const Points> nodal(conforming.nodal.col(t).data(), 2, conforming.nodal.rows() / 2);
  return nodal * interpolation(conforming.degree, l.bottomRows<2>()).transpose();
}

/// The pressure of contact is minus the normal traction of the left side less that of the pressure of a fluid, which is
/// a load and no contact. `trace_basis/trace.w` turns moments against the trace functions into values at the Gauss
/// points.
FaceFields face_fields(const Model& m, const std::vector<EdgeData>& data, const Conforming& conforming,
                       const std::vector<Share>& shares) {
  std::vector<Index> edges;
  for (std::size_t c = 0; c < m.mesh.cracks.size(); ++c)
    if (is_unilateral(m.scene.laws[c]))
      for (const CrackEdge& crack : m.mesh.cracks[c]) edges.push_back(crack.edge);
  std::vector<const EdgeData*> given(m.mesh.edges.size(), nullptr);
  for (std::size_t i = data.size(); i-- > 0;) given[data[i].edge] = &data[i];  // of cracks the left side
  const EdgeRule carrier = gauss(data_carriers), &trace = m.inner->kernel.trace;
  const Eigen::Index points = trace.w.size(), count = static_cast<Eigen::Index>(edges.size());
  FaceFields faces{Eigen::VectorXd(count), trace.w, Eigen::MatrixXd(points, count), Eigen::MatrixXd(points, count),
                   Eigen::VectorXd(count)};
  for (Eigen::Index j = 0; j < count; ++j) {
    const Index e = edges[j], left = m.mesh.sides[e][0];
    int i = 0;
    while (m.mesh.edges_of[left][i] != e) ++i;
    Eigen::RowVectorXd normal = shares[left].tractions.middleCols(points * i, points).row(0);
    if (given[e])
      for (int q = 0; q < data_carriers; ++q)
        normal -=
            carrier.w[q] * given[e]->load(0, q) * trace_basis(trace, carrier.s[q]).cwiseQuotient(trace.w).transpose();
    faces.lengths[j] = length(m.mesh, e);
    faces.pressure.col(j) = -normal.transpose();
    faces.opening.col(j) =
        (on_edge(m, conforming, e, 1) - on_edge(m, conforming, e, 0)).transpose() * m.inner->skeleton.frame[e].col(0);
    faces.overlap[j] = conforming.penetration[e];
  }
  return faces;
}

// Rapid changes r = g - P on an edge: with a function psi on T that is the primitive of r on e and 0 on the other
// edges, (r, w)_e = (curl psi, grad w)_T. The primitive is carried towards the apex and fades over a depth d <= H/2,
// which takes the best value [theory: B.10]. The square of the factor of |grad w|, for component k in the frame of the
// edge.
// The square is |grad psi|^2 <= (2/3) d (1 + 2 q^2) |r|^2 + (2/d) |R|^2, least at d = sqrt(3 |R|^2/((1 + 2 q^2)
// |r|^2)); `slant` is q, the largest slope of a ray from the edge to the opposite corner. Where (B.7) gives less, that
// is taken.
double rapid(const Model& m, const EdgeData& d, int k, double trace) {
  const double l = length(m.mesh, d.edge), square = l * d.unseen[k] * d.unseen[k],
               primitive = l * l * l * d.primitive[k] * d.primitive[k];
  if (square == 0) return 0;
  const Triangle shape = triangle(m, d.triangle);
  const Vec2 &a = shape.x[(d.side + 1) % 3], &b = shape.x[(d.side + 2) % 3], &apex = shape.x[d.side];
  const double height = 2 * area(shape) / l, foot = (apex - a).dot(b - a) / l;
  const double slant = std::max(std::abs(foot), std::abs(l - foot)) / height, steep = 1 + 2 * slant * slant;
  const double depth = std::min(0.5 * height, std::sqrt(3 * primitive / (steep * square)));
  const double carried = depth > 0 ? steep * depth * 2 / 3 * square + 2 * primitive / depth : infinity;
  return std::min(carried, trace * square);
}

}  // namespace

/// data: the sum of the norms that multiply K |eps(u - v)| on the triangle. Only components that are free carry a load.
std::vector<Rest> rests_of(const Model& m, const std::vector<EdgeData>& data, const Forces& f,
                           const std::vector<std::vector<Index>>& edges, std::span<const Index> column) {
  std::vector<Rest> rests(edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Index t = static_cast<Index>(i);
    Rest& r = rests[i];
    const Index at = column.empty() ? t : column[i];
    const bool forced = f.nodal.cols() > 0 && at != none;
    if (!forced && edges[i].empty()) continue;
    if (forced) {
      r.body = f.left_out[at];
      r.quadrature = f.moved[at];
    }
    r.data = r.body;
    const Triangle shape = triangle(m, t);
    for (const Index k : edges[i]) {
      const double h = diameter(shape), factor = length(m.mesh, data[k].edge) * h * h / area(shape);
      const double trace = factor * (1 / (pi * pi) + 1 / pi);
      r.data += std::sqrt(trace * data[k].left_out);
      for (int d = 0; d < 2; ++d)
        if (!data[k].held[d]) {
          r.data += std::sqrt(rapid(m, data[k], d, trace));
          r.quadrature += length(m.mesh, data[k].edge) * data[k].moved[d];
        }
    }
    if (r.data > 0) r.data *= local_korn(shape);
  }
  return rests;
}

namespace {

/// Of the first triangles; eta squared.
Oscillation oscillation_squared(const std::vector<Rest>& rests, const std::vector<Share>& shares, Index triangles) {
  Oscillation o;
  double& square = o.eta;
  for (std::size_t i = 0; i < static_cast<std::size_t>(triangles); ++i) {
    square += rests[i].data * rests[i].data;
    o.correction += rests[i].body * shares[i].rough;
    o.quadrature += rests[i].quadrature * shares[i].largest;
  }
  return o;
}

/// Of a boundary edge that is held along its normal: nothing but that, at 0.
bool is_plain_roller(const Skeleton& s, Index e) {
  for (Index u = edge_unknown(s, e); u < edge_unknown(s, e) + s.per_edge; u += 2)
    if (s.prescribed[u] != 0 || s.fixed[u + 1]) return false;
  return true;
}

/// What of triangles with curved edges the bounds do not know; null: nothing.
const char* unavailable_on_arcs(const Model& m) {
  if (m.mesh.arc.empty()) return nullptr;
  for (std::size_t e = 0; e < m.mesh.edges.size(); ++e) {
    if (m.mesh.arc[e] == none) continue;
    if (m.mesh.crack[e] != none && is_unilateral(m.scene.laws[m.mesh.crack[e]]))
      return "no bounds of the energy: contact on curved faces (mesh.curved)";
    if (rolls_along_curve(m, static_cast<Index>(e)) && !is_plain_roller(m.inner->skeleton, static_cast<Index>(e)))
      return "no bounds of the energy: a displacement, not 0, that is given along the normal of a curved side "
             "(mesh.curved)";
  }
  const StrainData& strain = m.inner->data.strain;
  for (Index t = 0; strain.degree > 0 && t < static_cast<Index>(strain.coefficients.cols()); ++t)
    if (material_of(m.mesh, m.scene, t).c == 0 && !(strain.rest[t] == 0 && strain.coefficients.col(t).isZero(0)) &&
        is_curved(triangle(m, t)))
      return "no bounds of the energy: an eigenstrain that is not constant in curved triangles of a material without "
             "compressibility (mesh.curved)";
  return nullptr;
}

constexpr const char* too_little_on_arcs =
    "no bounds of the energy: nothing holds the body, and degree 1 sees too little of its body force in curved "
    "triangles";

/// Of a body that nothing holds displacements that are constant see the means of a force alone, which beside curved
/// edges do only where it is small against the mean stress: as what balances a load is.
/// `small`: relative to the mean stress; forces below it balance sampled loads, and their moments are of that order.
bool sees_too_little_on_arcs(const Model& m, const Forces& f, double stress) {
  if (m.mesh.arc.empty() || !unseen_couples(f)) return false;
  constexpr double small = 1e-3;
  const double most = small * stress;
  for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t)
    if (const Triangle cell = triangle(m, t);
        is_curved(cell) && diameter(cell) * f.nodal.col(t).cwiseAbs().maxCoeff() > most)
      return true;
  return false;
}

/// The conditions under which Pi is the minimum of a convex energy over a set that both fields are admissible for.
std::string no_energy_bounds_because(const Model& m) {
  if (const auto why = refusal(m.element, can_bound_energy)) return *why;
  if (const char* why = unavailable_on_arcs(m)) return why;
  if (!m.inner->semicoercive.empty()) return "no bounds of the energy: a piece of the body is held by contact alone";
  for (const CrackLaw& law : m.scene.laws) {
    if (is_unilateral(law) && law.normal)
      return "no bounds of the energy: the chords of a curved crack in contact do not slide";
    if (has_gap(law)) return "no bounds of the energy: the faces of a crack are apart before loading";
    if (has_friction(law)) return "no bounds of the energy: with friction the solution does not minimize one";
  }
  return {};
}

/// Triangles with data on their edges take the rich reference, of degree `data_carriers` at least: the polynomials of
/// the data are of degree 5, and the fields that carry them of one degree more.
std::vector<Share> bound_triangles(const Bounding& of, const References& to, const Field& s,
                                   const Eigen::MatrixXd& statics, const std::vector<std::vector<Index>>& edges) {
  std::vector<Share> shares(edges.size());
  parallel_for(static_cast<Index>(edges.size()), of.m.threads, [&](Index begin, Index end) {
    for (Index t = begin; t < end; ++t) {
      const TriangleReference& r = edges[t].empty() ? to.plain : to.rich;
      const CellFields at{statics.col(t), s.interior.col(t), of.conforming.nodal.col(t)};
      of.lower(r, t, at, edges[t], shares[t]);
      of.upper(r, t, at, edges[t], shares[t]);
    }
  });
  return shares;
}

/// Of the first triangles.
/// Sums in the order of the triangles; of what measures rounding the largest.
Share total(const std::vector<Share>& shares, Index triangles) {
  Share sum;
  for (const Share& share : std::span(shares).first(static_cast<std::size_t>(triangles))) {
    sum.lower += share.lower;
    sum.upper += share.upper;
    sum.size += share.size;
    sum.below += share.below;
    sum.above += share.above;
    sum.rules += share.rules;
    sum.asymmetry = std::max(sum.asymmetry, share.asymmetry);
    sum.stress = std::max(sum.stress, share.stress);
    sum.divergence = std::max(sum.divergence, share.divergence);
    sum.gradient = std::max(sum.gradient, share.gradient);
  }
  return sum;
}

EnergyBounds lost(double oscillation, std::string why) {
  return {nan, nan, oscillation, false, std::move(why)};
}

}  // namespace

std::string unseen_by_bounds(const Model& m) {
  for (const UnseenData& u : unseen_data(m.mesh, m.scene, m.inner->data)) {
    if (!u.stops_bounds) continue;
    return fmt::format("no bounds of the energy: {} {} near ({:.6g}, {:.6g})", u.what, u.how, u.at.x(), u.at.y());
  }
  return {};
}

/// Shear moduli of all regions: |eps|^2 <= energy density/mu holds with the smallest one everywhere.
Unseen unseen(const Model& m, const Oscillation& o, double mismatch_squared, double gap) {
  double mu = shear_moduli(m.scene.material).least;  // |eps|^2 <= energy/mu
  for (const Material& material : m.scene.regions) mu = std::min(mu, shear_moduli(material).least);
  // J(u) >= lower + X^2/2 - eta |eps(u - v)| with |eps(u - v)| <= (X + sqrt(2 gap))/sqrt(2 mu), for every X.
  const double below = o.eta * o.eta / (4 * mu) + o.eta * std::sqrt(gap / mu) + o.correction;
  // An extension of the rest of the prescribed displacement; its energy is estimated.
  constexpr double extension = 4;
  const double mismatch = extension * std::sqrt(mismatch_squared);
  const double displaced = mismatch * std::sqrt(2 * gap) + mismatch * mismatch;
  // The exact displacement is not far from the discrete one that the works are taken on.
  const double quadrature = 2 * o.quadrature;
  return {below + quadrature, o.correction + displaced + quadrature, displaced};
}

bool unseen_couples(const Forces& f) {
  return f.nodal.cols() > 0 && f.degree == 0;
}

namespace {

/// R has zero mean: tr R = div w with w = 0 on the boundary of the triangle, |grad w| <= |tr R|/beta. v + w is
/// admissible, and its strain less the eigenstrain moves by eps(w) - R, which has no trace.
/// K^2 - 1 = 2/beta^2, so that |grad w| <= |tr R|/beta <= sqrt(2) |R|/beta = sqrt(K^2 - 1) |R| [theory: B.28].
double moved_without_volume(double mu, const Triangle& t, double rest, const MovedField& on) {
  const double size = std::sqrt(area(t) * rest), gradient = size * std::sqrt(std::pow(local_korn(t), 2) - 1),
               square = 2 * mu * std::pow(size + gradient, 2);
  return std::sqrt(2 * on.elastic * square) + 0.5 * square + on.force * gradient;
}

/// By how much the largest part of a curved cell is larger than the triangle of its chords.
double largest_J(const Triangle& cell) {
  constexpr int n = 8;
  double J = 0;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j) J = std::max(J, cell_map(cell, {double(i) / n, double(j) / n}).J);
  return J;
}

}  // namespace

/// Both estimates hold where c > 0; the one without change of volume is the smaller one as c -> 0, since `stiffness`
/// grows like 1/(2 c). At c = 0 it is the only one.
double moved_by_eigenstrain(const Material& material, const Triangle& t, double rest, double error,
                            const MovedField& on) {
  if (rest == 0 && error == 0) return 0;
  if (is_curved(t)) rest *= largest_J(t);
  const double mu = material.mu, c = material.c;
  const bool plain = isotropic(material);
  if (plain && c == 0)
    return moved_without_volume(mu, t, rest, on) + area(t) * error * (2 * mu * on.largest + on.stress);
  // C e : e <= stiffness |e|^2
  const double stiffness = plain ? std::max(2 * mu, 1 / (2 * c)) : 2 * shear_moduli(material).largest,
               square = stiffness * area(t) * rest, moved = std::sqrt(2 * on.elastic * square) + 0.5 * square;
  return (plain && !is_curved(t) ? std::min(moved, moved_without_volume(mu, t, rest, on)) : moved) +
         stiffness * area(t) * error * on.largest;
}

double crossed_work(const FaceFields& pressing, const FaceFields& opening) {
  double work = 0;
  for (Eigen::Index e = 0; e < pressing.lengths.size(); ++e)
    for (Eigen::Index g = 0; g < pressing.weights.size(); ++g)  // both are at least 0, up to rounding
      work += pressing.lengths[e] * pressing.weights[g] * std::abs(pressing.pressure(g, e)) *
              (std::max(opening.opening(g, e), 0.0) + opening.overlap[e]);
  return work;
}

namespace {

/// Over own triangles; eta of the oscillation squared.
/// A process sums over the triangles that it owns; `energy_bounds` with Sums adds the parts of all processes.
EnergySums own_sums(const AdmissiblePair& a, const Field& s) {
  return {.sum = a.sum,
          .imbalance = imbalance(a.m, s, a.data, a.conforming, a.shares),
          .oscillation = oscillation_squared(a.rests, a.shares, own_triangles(a.m)),
          .mismatch = a.conforming.mismatch,
          .beyond_arcs = a.beyond_arcs,
          .couples = unseen_couples(a.f)};
}

EnergyBounds interval_of(const Model& m, EnergySums sums) {
  sums.oscillation.eta = std::sqrt(sums.oscillation.eta);
  return energy_interval(m, sums);
}

}  // namespace

/// Of two sides with the displacements u and u + [u] the tractions t_0, t_1 do the work (t_0 + t_1) . u + t_1 . [u]. On
/// a bonded edge the first sum must balance the load. Between faces every side must balance its own load, but for a
/// pressure of contact along the normal, which works on what overlaps alone. A held component takes whatever traction
/// there is.
double imbalance_on(const Model& m, const EdgeWork& at) {
  const Index points = points_per_edge(m.element), crack = m.mesh.crack[at.edge];
  const EdgeRule& trace = m.inner->kernel.trace;
  static const EdgeRule carrier = gauss(data_carriers);
  const CrackLaw::Kind kind = crack == none ? CrackLaw::Kind::Bonded : m.scene.laws[crack].kind;
  const EdgeData* d = at.given;
  double total = 0;
  if (d && d->bent) {  // the component along the curve alone is free
    const Skeleton& s = m.inner->skeleton;
    for (Index g = 0; g < points; ++g) {
      Vec2 rest = at.side[0].col(g) + at.side[1].col(g);
      for (int q = 0; q < data_carriers; ++q)
        rest -= carrier.w[q] / trace.w[g] * trace_basis(trace, carrier.s[q])[g] * d->load.col(q);
      const double along = frame_at(s, at.edge, static_cast<int>(g)).col(1).dot(s.frame[at.edge] * rest);
      total += trace.w[g] * std::abs(along * at.base[2 * g + 1]);
    }
    return length(m.mesh, at.edge) * total;
  }
  for (Index g = 0; g < points; ++g)
    for (int k = 0; k < 2; ++k) {
      if (d && d->held[k]) continue;
      double given = 0;
      if (d)
        for (int q = 0; q < data_carriers; ++q)
          given += carrier.w[q] / trace.w[g] * trace_basis(trace, carrier.s[q])[g] * d->load(k, q);
      const double rest = at.side[0](k, g) + at.side[1](k, g) - (kind == CrackLaw::Kind::Bonded ? given : 0);
      const Index unknown = 2 * g + k;
      double work = std::abs(rest * at.base[unknown]);
      if (kind != CrackLaw::Kind::Bonded) {
        const double contact = at.side[0](k, g) - given,
                     wrong = k == 0 && kind == CrackLaw::Kind::Unilateral ? std::max(0.0, contact) : contact;
        work += std::abs(wrong * at.jump[unknown]);
        if (k == 0) work += std::abs(contact) * at.penetration;
      }
      total += trace.w[g] * work;
    }
  return length(m.mesh, at.edge) * total;
}

/// Rounding is relative to `size`, what the sums are made of. `isochoric`: div v relative to the largest gradient where
/// c = 0; above it alpha w has not made the strain free of trace. `negligible`: an estimated part of the widening below
/// 1 % of the gap leaves the word "guaranteed".
EnergyBounds energy_interval(const Model& m, const EnergySums& of) {
  EnergyBounds result;
  const Share& sum = of.sum;
  result.asymmetry = sum.stress > 0 ? sum.asymmetry / sum.stress : 0;
  result.imbalance = sum.size > 0 ? of.imbalance / sum.size : 0;
  const double rounding = (64 * epsilon + 2 * result.imbalance) * sum.size;
  const double gap = std::max(sum.upper - sum.lower, 0.0) + 2 * rounding;
  const Unseen more = unseen(m, of.oscillation, of.mismatch, gap);
  result.oscillation = std::max(more.below, more.above);
  result.lower = sum.lower - rounding - more.below - sum.below;
  result.upper = sum.upper + rounding + more.above + sum.above;
  if (!(result.lower <= result.upper))
    return lost(result.oscillation, "no bounds of the energy: they are lost to rounding");
  constexpr double isochoric = 1e-9;
  if (sum.divergence > isochoric * sum.gradient)
    return lost(result.oscillation,
                "no bounds of the energy: no admissible displacement without change of volume was found");
  constexpr double negligible = 0.01;
  const bool asymptotic = of.couples && more.below > negligible * gap;
  result.guaranteed = more.displaced <= negligible * gap && !asymptotic;
  if (!result.guaranteed)
    result.note = fmt::format("the bounds of the energy are estimates: the {} not resolved by the mesh",
                              asymptotic ? "body force is" : "prescribed displacements are");
  if (of.on_arcs || !m.mesh.arc.empty()) {
    result.guaranteed = false;
    result.note = fmt::format(
        "the bounds of the energy are estimates: what arcs have beyond the polynomials of the edges is put at {:.1g}",
        of.beyond_arcs);
  }
  return result;
}

namespace {

/// The integral of the square of what the stress has along a roller beyond the load there. At the Gauss points of the
/// trace it has nothing, between them the product of two polynomials of its degree.
double left_along_curve(const Model& m, const EdgeData& d, const Tractions& tractions) {
  static const EdgeRule carrier = gauss(data_carriers), sample = gauss(data_points);
  const Skeleton& s = m.inner->skeleton;
  const EdgeRule& trace = m.inner->kernel.trace;
  const Eigen::Index points = trace.w.size();
  const Points rest =
      tractions.middleCols(points * d.side, points) * traces(trace, sample.s) - d.load * traces(carrier, sample.s);
  double square = 0;
  for (Eigen::Index q = 0; q < rest.cols(); ++q) {
    const Vec2 along = frame_between(m.mesh, s, d.edge, sample.s[q]).col(1);
    square += sample.w[q] * std::pow(along.dot(s.frame[d.edge] * rest.col(q)), 2);
  }
  return length(m.mesh, d.edge) * square;
}

/// Fills in the fields and what the triangles contribute. `solved`: what the displacement follows.
void fill(const Field& solved, const Eigen::MatrixXd& statics, int inside, bool keep, AdmissiblePair& a) {
  const Model& m = a.m;
  a.conforming = conforming_displacement(m, solved, a.data);
  a.edges.resize(m.mesh.triangles.size());
  for (std::size_t i = 0; i < a.data.size(); ++i) a.edges[a.data[i].triangle].push_back(static_cast<Index>(i));
  const int degree =
      std::max({inside, degree_inside(m, a.f.nodal.cols() > 0 && !a.f.balanced, false), m.inner->data.strain.degree});
  a.references = std::make_shared<const References>(references(m.element, degree, a.f, !m.mesh.arc.empty()));
  a.shares = bound_triangles({m, a.f, a.data, a.conforming, keep}, *a.references, solved, statics, a.edges);
  for (EdgeData& d : a.data)
    if (d.bent) d.left_out += left_along_curve(m, d, a.shares[static_cast<std::size_t>(d.triangle)].tractions);
  a.rests = rests_of(m, a.data, a.f, a.edges);
  a.sum = total(a.shares, own_triangles(m));
}

/// Order: reasons that forbid bounds, data, the balanced stress, the two fields, and the sums. `keep` also keeps the
/// fields at the points of the rules, which products of two states need.
AdmissiblePair made(const Model& m, const Field& s, int inside, bool keep) {
  AdmissiblePair a{.m = m};
  if (const std::string why = no_energy_bounds_because(m); !why.empty()) a.bounds = {nan, nan, 0, false, why};
  if (const std::string why = unseen_by_bounds(m); a.bounds.note.empty() && !why.empty())
    a.bounds = lost(infinity, why);
  if (!a.bounds.note.empty()) return a;
  a.data = edge_data(m);
  a.f = forces(m);
  if (sees_too_little_on_arcs(m, a.f, mean_stress(m, s))) {
    a.bounds = lost(infinity, too_little_on_arcs);
    return a;
  }
  // With the couples the displacement fits the stress better, which pairs of states use; the bounds of one energy hold
  // without that.
  Eigen::VectorXd moved;
  const Eigen::MatrixXd statics = static_interior(m, s, a.f.couple, &moved);
  // The displacement follows the couples, too, which the element does not see of the body force. Their response is of
  // one sweep: with a penalty it changes the volume.
  const bool with_couples = keep && a.f.couple.size() > 0 && moved.size() > 0 && m.inner->system.penalty == 0 &&
                            m.inner->ordering.contact_rows == 0;
  const Field solved = with_couples ? Field{s.skeleton + moved, statics, s.force, s.eigenstrain} : s;
  fill(solved, statics, inside, keep, a);
  if (!m.mesh.arc.empty()) {
    a.beyond_arcs = beyond_arcs(m, s);
    a.sum.below += a.beyond_arcs;
    a.sum.above += a.beyond_arcs;
  }
  a.bounds = interval_of(m, own_sums(a, s));
  a.rounding = (64 * epsilon + 2 * a.bounds.imbalance) * a.sum.size;
  const References& to = *a.references;
  a.plain = to.plain.rule;
  a.rich = to.rich.rule;
  if (!m.mesh.arc.empty()) {
    a.plain_curved = to.plain.curved->rule.x;
    a.rich_curved = to.rich.curved->rule.x;
  }
  return a;
}

}  // namespace

int degree_inside(const Model& m, bool with_body, bool with_eigenstrain) {
  return std::max(
      {stress_degree(m.element), m.element.trace + (with_body ? 2 : 1), with_eigenstrain ? strain_degree : 0});
}

/// One process after the other could stop for its own reason: every reason is agreed upon by all before anyone returns.
EnergyBounds energy_bounds(const Model& m, const Field& s, const Sums& sums, const OpenSolve& open) {
  AdmissiblePair a{.m = m};
  std::string why = no_energy_bounds_because(m);
  std::array<double, 2> here{why.empty() ? 0.0 : 1.0, m.mesh.arc.empty() ? 0.0 : 1.0};
  sums.most(here);
  if (why.empty() && here[0] > 0) why = "no bounds of the energy: curved edges on a part of another process";
  if (!why.empty()) return {nan, nan, 0, false, why};
  a.f = forces(m);
  double blind = unseen_by_bounds(m).empty() ? 0 : 1;
  sums.most({&blind, 1});
  if (blind > 0) return lost(infinity, "no bounds of the energy: data that the rules of the solver do not resolve");
  const double stress = mean_stress(m, s);
  std::array<double, 2> squares{stress * stress * area(m), area(m)};
  sums.add(squares);
  double too_little = sees_too_little_on_arcs(m, a.f, std::sqrt(squares[0] / squares[1])) ? 1 : 0;
  sums.most({&too_little, 1});
  if (too_little > 0) return lost(infinity, too_little_on_arcs);
  a.data = edge_data(m);
  std::array<double, 2> asks{a.f.couple.size() > 0 ? 1.0 : 0.0, s.force.size() > 0 ? s.force.cwiseAbs().maxCoeff() : 0};
  sums.most(asks);
  fill(s, asks[0] > 0 || asks[1] > 0 ? static_interior(m, s, a.f.couple, open) : s.interior, 0, false, a);
  a.beyond_arcs = beyond_arcs(m, s);
  a.sum.below += a.beyond_arcs;
  a.sum.above += a.beyond_arcs;
  EnergySums own = own_sums(a, s);
  own.on_arcs = here[1] > 0;
  // What is a sum over triangles or edges is added over processes; measures of rounding take the largest.
  std::array<double*, 11> added{&own.sum.lower,
                                &own.sum.upper,
                                &own.sum.size,
                                &own.sum.below,
                                &own.sum.above,
                                &own.imbalance,
                                &own.oscillation.eta,
                                &own.oscillation.correction,
                                &own.oscillation.quadrature,
                                &own.mismatch,
                                &own.beyond_arcs};
  std::array<double*, 4> largest{&own.sum.asymmetry, &own.sum.stress, &own.sum.divergence, &own.sum.gradient};
  const auto over_all = [](const auto& values, const std::function<void(std::span<double>)>& reduce) {
    std::array<double, std::tuple_size_v<std::decay_t<decltype(values)>>> all;
    std::ranges::transform(values, all.begin(), [](const double* value) { return *value; });
    reduce(all);
    for (std::size_t i = 0; i < all.size(); ++i) *values[i] = all[i];
  };
  over_all(added, sums.add);
  over_all(largest, sums.most);
  return interval_of(m, own);
}

AdmissiblePair admissible(const Model& m, const Field& s, int inside) {
  return made(m, s, inside, true);
}

EnergyBounds energy_bounds(const Model& m, const Field& s) {
  return made(m, s, 0, false).bounds;
}

EnergyBounds energy_bounds(const Model& m, const Field& s, FaceFields& faces) {
  const AdmissiblePair a = made(m, s, 0, false);
  if (!a.shares.empty()) faces = face_fields(m, a.data, a.conforming, a.shares);
  return a.bounds;
}

}  // namespace kerf
