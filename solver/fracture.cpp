// Interaction integral [Yau, Wang, Corten 1980] as a domain integral. In the frame of the tip, with the fields (s, u)
// of the body, (s', u') of a tip under unit K, f the body force and q = 1 near the tip, 0 beyond the ring:
//   P_j = s : grad u' delta_1j - s_ij u'_i,1 - s'_ij u_i,1,    div P = f . u'_,1,
//   K = E'/2 I,    I = - int (P . grad q + q f . u'_,1) + int_crack q (s e_2) . [u'_,1].
// grad q lives on a ring, so that the fields next to the tip, where they are poor, do not enter. J: the same with
// P_j = 1/2 s : grad u delta_1j - s_ij u_i,1 and no crack term, as nothing slides against friction.
#include "solver/fracture.hpp"

#include "solver/parallel.hpp"
#include "solver/recover.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

namespace kerf {

namespace {

constexpr int rings = 3;
constexpr int middle = 1;

/// q falls from 1 to 0 between the radii, twice continuously differentiable.
struct Ring {
  double inner, outer;
};

double cut_off(const Ring& ring, double r) {
  const double t = std::clamp((r - ring.inner) / (ring.outer - ring.inner), 0.0, 1.0);
  return 1 - t * t * t * (10 + t * (6 * t - 15));
}

double cut_off_slope(const Ring& ring, double r) {
  const double t = std::clamp((r - ring.inner) / (ring.outer - ring.inner), 0.0, 1.0);
  return -30 * t * t * (1 - t) * (1 - t) / (ring.outer - ring.inner);
}

std::array<Ring, rings> place_rings(double radius) {
  std::array<Ring, rings> ring;
  for (int k = 0; k < rings; ++k) {
    const double outer = (1 - 0.2 * k) * radius;
    ring[k] = {0.4 * outer, outer};
  }
  return ring;
}

struct Tip {
  Vec2 at;
  Mat2 frame;              // columns: the direction that extends the crack, and that turned by +90 degrees
  std::vector<Index> run;  // edges of the straight part of the crack, from the tip
  double straight;         // length of that part
};

/// The crack's edges from one of its ends.
struct Step {
  Index edge, from, to;
};
std::vector<Step> steps_from(const Mesh& mesh, Index crack, bool start) {
  std::vector<Step> steps;
  for (const CrackEdge& c : mesh.cracks[crack]) {
    const auto& [a, b] = mesh.edges[c.edge];
    steps.push_back(c.forward == start ? Step{c.edge, a, b} : Step{c.edge, b, a});
  }
  if (!start) std::reverse(steps.begin(), steps.end());
  return steps;
}

Tip find_tip(const Mesh& mesh, std::span<const Step> steps) {
  // A turn this small moves K by the same part of itself; coordinates have rounding errors.
  constexpr double kink = 1e-4;
  Tip tip{mesh.points[steps.front().from], Mat2::Identity(), {}, 0};
  Vec2 back = Vec2::Zero();
  for (const Step& s : steps) {
    const Vec2 along = mesh.points[s.to] - mesh.points[s.from];
    if (!tip.run.empty() && std::abs(cross(back, along)) > kink * back.dot(along)) break;
    tip.run.push_back(s.edge);
    back = mesh.points[s.to] - tip.at;
  }
  tip.straight = back.norm();
  back /= tip.straight;
  tip.frame << -back.x(), back.y(), -back.y(), -back.x();
  return tip;
}

double distance(const Vec2& x, const Vec2& a, const Vec2& b) {
  const double along = std::clamp((x - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (x - a - along * (b - a)).norm();
}

/// Distance to the nearest end of the material other than the straight faces that meet in the tip. `ends`: the edges of
/// the boundary and of all cracks.
double clearance(const Mesh& mesh, std::span<const Index> ends, const Tip& tip) {
  std::vector<Index> own = tip.run;
  std::sort(own.begin(), own.end());
  double least = tip.straight;
  for (const Index e : ends)
    if (!std::binary_search(own.begin(), own.end(), e))
      least = std::min(least, distance(tip.at, mesh.points[mesh.edges[e][0]], mesh.points[mesh.edges[e][1]]));
  return least;
}

struct Field {
  Mat2 stress, gradient;  // gradient: d_j u_i
};

/// A tip under unit K_I and under unit K_II, at x in its frame: Z = 1/sqrt(2 pi z) [Westergaard 1939].
std::array<Field, 2> unit_fields(const Material& m, const Vec2& x) {
  const std::complex<double> z(x.x(), x.y()), Z = 1.0 / std::sqrt(2 * std::numbers::pi * z), slope = -0.5 * Z / z;
  const double kappa_plus_1 = 2 + 8 * m.mu * m.c, turn = kappa_plus_1 / (4 * m.mu);
  const double shear_I = -x.y() * slope.real(), shear_II = Z.real() - x.y() * slope.imag();
  const Eigen::Vector4d s_I(Z.real() - x.y() * slope.imag(), shear_I, shear_I, Z.real() + x.y() * slope.imag());
  const Eigen::Vector4d s_II(2 * Z.imag() + x.y() * slope.real(), shear_II, shear_II, -x.y() * slope.real());
  return {Field{tensor(s_I), tensor(displacement_gradient(m, s_I, -turn * Z.imag()))},
          Field{tensor(s_II), tensor(displacement_gradient(m, s_II, turn * Z.real()))}};
}

/// Rows: integrals for K_I, for K_II, J. One column per ring.
using Integrals = Eigen::Matrix<double, 3, rings>;

struct Disc {
  Tip tip;
  std::array<Ring, rings> ring;
  double rotation =
      0;  // mean over the disc: rigid, so that taking it out changes nothing but the rounding and the mesh error
};

Integrals over_triangle(const Model& model, const State& state, const Disc& disc, Index t) {
  const Triangle shape = triangle(model, t);
  const Mat2& frame = disc.tip.frame;
  // q bends within a ring: small triangles see a parabola of it.
  constexpr double small = 0.2;
  const double size = std::sqrt(2 * area(shape));
  const Ring& narrow = disc.ring.back();
  const TriangleRule& rule = size < small * (narrow.outer - narrow.inner) ? model.kernel.rule : model.kernel.load;
  const Points x = rule_points(rule, shape);
  const Fields f = evaluate(model.kernel, shape, state.interior.col(t), x);
  Integrals sum = Integrals::Zero();
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const Vec2 at = frame.transpose() * (x.col(i) - disc.tip.at);
    const double r = at.norm(), w = area(shape) * rule.w[i];
    // The skew part of s is pure error, orthogonal to linear functions: without it s is nearer to the exact stress.
    Eigen::Vector4d stress = f.stress.col(i);
    stress[1] = stress[2] = 0.5 * (stress[1] + stress[2]);
    const Mat2 s = frame.transpose() * tensor(stress) * frame;
    const Mat2 d = frame.transpose() *
                   tensor(displacement_gradient(model.scene.material, stress, f.rotation[i] - disc.rotation)) * frame;
    const std::array<Field, 2> unit = unit_fields(model.scene.material, at);
    // P in the columns, then the factor of q.
    Eigen::Matrix<double, 2, 3> P;
    Eigen::Vector3d rest = Eigen::Vector3d::Zero();
    for (int k = 0; k < 2; ++k)
      P.col(k) = s.cwiseProduct(unit[k].gradient).sum() * Vec2::UnitX() - s * unit[k].gradient.col(0) -
                 unit[k].stress * d.col(0);
    P.col(2) = 0.5 * s.cwiseProduct(d).sum() * Vec2::UnitX() - s * d.col(0);
    if (model.scene.body) {
      const Vec2 force = frame.transpose() * model.scene.body(x.col(i));
      rest << force.dot(unit[0].gradient.col(0)), force.dot(unit[1].gradient.col(0)), force.dot(d.col(0));
    }
    for (int k = 0; k < rings; ++k)
      sum.col(k) -= w * (cut_off_slope(disc.ring[k], r) / r * P.transpose() * at + cut_off(disc.ring[k], r) * rest);
  }
  return sum;
}

/// The triangles that reach between the radii, and how many elements fit between the tip and the outer one.
struct Cover {
  std::vector<Index> triangles;
  double elements = 0;
};

Cover cover(const Mesh& mesh, const Vec2& at, double inner, double outer) {
  Cover c;
  double in_ring = 0;
  Index count = 0;
  for (Index t = 0; t < static_cast<Index>(mesh.triangles.size()); ++t) {
    const auto& [i, j, k] = mesh.triangles[t];
    const Vec2 x = (mesh.points[i] + mesh.points[j] + mesh.points[k]) / 3 - at;
    const double r = x.norm();
    const double reach = (mesh.points[i] - at - x).norm() + (mesh.points[j] - at - x).norm();  // > farthest vertex
    if (r - reach > outer || r + reach < inner) continue;
    c.triangles.push_back(t);
    if (r < outer && r > 0.5 * outer) {
      in_ring += area(mesh, t);
      ++count;
    }
  }
  if (count > 0) c.elements = outer / std::sqrt(2 * in_ring / count);
  return c;
}

/// Weighted by the slope of the cut-off, so that it does not matter which triangles at the rims count.
double mean_rotation(const Model& model, const State& state, const Disc& disc, std::span<const Index> triangles) {
  double sum = 0, size = 0;
  for (const Index t : triangles) {
    const Vec2 x = centroid(model.mesh, t);
    const double weight = area(model.mesh, t) * std::abs(cut_off_slope(disc.ring.front(), (x - disc.tip.at).norm()));
    if (weight == 0) continue;
    sum += weight * evaluate(model, state, t, x).rotation[0];
    size += weight;
  }
  return size > 0 ? sum / size : 0;
}

Integrals over_ring(const Model& model, const State& state, const Disc& disc, std::span<const Index> triangles) {
  // Summed in the order of the triangles, whatever the number of threads.
  std::vector<Integrals> part(triangles.size());
  parallel_for(static_cast<Index>(triangles.size()), model.threads, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) part[i] = over_triangle(model, state, disc, triangles[i]);
  });
  Integrals sum = Integrals::Zero();
  for (const Integrals& p : part) sum += p;
  return sum;
}

/// An edge of the straight faces, between two distances from the tip.
struct Face {
  double near, far;
  std::span<const CrackPoint> points;
};

std::vector<Face> faces(const Mesh& mesh, const Tip& tip, bool start, std::span<const CrackPoint> profile) {
  const std::size_t points = profile.size() / mesh.cracks[mesh.crack[tip.run.front()]].size();
  std::vector<Face> faces;
  double done = 0;
  for (std::size_t i = 0; i < tip.run.size(); ++i) {
    const double l = length(mesh, tip.run[i]);
    faces.push_back({done, done + l, profile.subspan(start ? i * points : profile.size() - (i + 1) * points, points)});
    done += l;
  }
  return faces;
}

/// The polynomial through the values at the points of a face, at distance r from the tip.
double along_face(const Face& face, const Vec2& tip, double r, double CrackPoint::*value) {
  double sum = 0;
  for (const CrackPoint& p : face.points) {
    const double here = (p.at - tip).norm();
    double basis = 1;
    for (const CrackPoint& other : face.points)
      if (&other != &p) basis *= (r - (other.at - tip).norm()) / (here - (other.at - tip).norm());
    sum += basis * p.*value;
  }
  return sum;
}

/// Crack terms of K: E'/2 [u'_,1] = -sqrt(2/pi)/sqrt(r), normal for K_I and tangential for K_II.
Eigen::Matrix<double, 2, rings> over_faces(const Disc& disc, std::span<const Face> faces) {
  const EdgeRule rule = gauss(8);
  Eigen::Matrix<double, 2, rings> sum = Eigen::Matrix<double, 2, rings>::Zero();
  for (const Face& f : faces) {
    if (f.near >= disc.ring.front().outer) break;
    // dr/sqrt(r) = 2 d sqrt(r)
    const double from = std::sqrt(f.near), to = std::sqrt(f.far);
    for (Eigen::Index i = 0; i < rule.s.size(); ++i) {
      const double root = from + rule.s[i] * (to - from), r = root * root;
      const Vec2 traction(along_face(f, disc.tip.at, r, &CrackPoint::sigma_n),
                          along_face(f, disc.tip.at, r, &CrackPoint::sigma_t));
      const double w = -std::sqrt(2 / std::numbers::pi) * 2 * (to - from) * rule.w[i];
      for (int k = 0; k < rings; ++k) sum.col(k) += w * cut_off(disc.ring[k], r) * traction;
    }
  }
  return sum;
}

TipIntensity intensity(const Model& model, const State& state, const Tip& tip, bool start, double clear,
                       std::span<const CrackPoint> profile) {
  constexpr double safe = 0.9, fewest_elements = 1.5;
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  const double radius = safe * clear;
  Disc disc{tip, place_rings(radius)};
  TipIntensity result{.crack = model.mesh.crack[tip.run.front()], .at_start = start, .at = tip.at};
  const Cover c = cover(model.mesh, tip.at, model.scene.body ? 0 : disc.ring.back().inner, radius);
  if (c.elements < fewest_elements) {
    result.K_I = result.K_II = result.G = result.J = result.spread = unknown;
    return result;
  }
  disc.rotation = mean_rotation(model, state, disc, c.triangles);
  const double modulus = plane_modulus(model.scene.material);
  const Integrals integrals = over_ring(model, state, disc, c.triangles);
  const std::vector<Face> all = faces(model.mesh, tip, start, profile);
  // The discrete pressure on the edge at the tip is off by the order of K_II/sqrt(h), which would leave an error of
  // some hundredths of K_II in K_I on every mesh. Without that edge: K_I > 0 means that the tip is open, no pressure
  // there and nothing is missing; at a closed tip a positive term is missing from K_I = 0. So it is the positive part.
  const bool unilateral = model.scene.laws[result.crack].kind == CrackLaw::Kind::Unilateral;
  Eigen::Matrix<double, 2, rings> K =
      modulus / 2 * integrals.topRows<2>() + over_faces(disc, std::span(all).subspan(unilateral ? 1 : 0));
  if (unilateral) K.row(0) = K.row(0).cwiseMax(0);
  result.K_I = K(0, middle);
  result.K_II = K(1, middle);
  result.G = K.col(middle).squaredNorm() / modulus;
  result.J = integrals(2, middle);
  result.radius = disc.ring[middle].outer;
  const double largest = K.cwiseAbs().maxCoeff();
  const double difference = (K.rowwise().maxCoeff() - K.rowwise().minCoeff()).maxCoeff();
  result.spread = largest > 0 ? difference / largest : 0;
  return result;
}

}  // namespace

std::vector<TipIntensity> crack_tips(const Model& model, const State& state) {
  const Mesh& mesh = model.mesh;
  std::vector<bool> on_boundary(mesh.points.size(), false);
  std::vector<Index> ends;
  for (Index e = 0; e < static_cast<Index>(mesh.edges.size()); ++e) {
    const bool boundary = mesh.sides[e][0] == none || mesh.sides[e][1] == none;
    if (boundary)
      for (const Index v : mesh.edges[e]) on_boundary[v] = true;
    if (boundary || mesh.crack[e] != none) ends.push_back(e);
  }
  std::vector<TipIntensity> tips;
  for (Index crack = 0; crack < static_cast<Index>(mesh.cracks.size()); ++crack) {
    if (mesh.cracks[crack].empty()) continue;
    const std::vector<CrackPoint> profile = crack_profile(model, state, crack);
    for (const bool start : {true, false}) {
      const std::vector<Step> steps = steps_from(mesh, crack, start);
      if (on_boundary[steps.front().from]) continue;
      const Tip tip = find_tip(mesh, steps);
      tips.push_back(intensity(model, state, tip, start, clearance(mesh, ends, tip), profile));
    }
  }
  return tips;
}

}  // namespace kerf
