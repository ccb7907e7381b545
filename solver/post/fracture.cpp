// Interaction integral [Yau, Wang, Corten 1980] as a domain integral. In the frame of the tip, with the fields (s, u)
// of the body, the auxiliary fields (s', u') of a tip, f the body force and q = 1 near the tip, 0 beyond the ring:
//   P_j = s : grad u' delta_1j - s_ij u'_i,1 - s'_ij u_i,1,    div P = f . u'_,1,
//   I = - int (P . grad q + q f . u'_,1) + int_faces q P . n,    n out of the body,
// with an eigenstrain e div P has s' : e_,1 less, and J takes the elastic energy [theory: H.6];
//   K = E'/2 I with the fields of unit K, T = E' I with those of a unit force along x at the tip [Cardew et al. 1985].
// grad q lives on a ring, so that the fields next to the tip, where they are poor, do not enter. On straight faces P .
// n leaves the work of the tractions on [u'_,1]. On curved ones the auxiliary fields are continued across the straight
// line behind the tip up to the crack, and all of P enters. J: the same with P_j = 1/2 s : grad u delta_1j - s_ij
// u_i,1. I is linear in (s, u): a polynomial state, whose K = 0 and T are known, is taken out before the quadrature,
// so that such states are exact.

#include "kerf/fracture.hpp"
#include "solver/half_cracks.hpp"
#include "solver/recovery.hpp"
#include "solver/shared_tips.hpp"
#include "solver/tip_fields.hpp"

#include "solver/system.hpp"

#include "base/parallel.hpp"
#include "kerf/recover.hpp"
#include "solver/data/near_tip.hpp"
#include "solver/post/crack_tip.hpp"
#include "solver/post/orthotropic_tip.hpp"
#include "solver/post/polynomial_state.hpp"
#include "solver/post/slip_error.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

/// The sums of these over processes, where there are several.
void all(const Sums& sums, std::initializer_list<double*> values) {
  if (!sums.add) return;
  std::vector<double> flat;
  for (const double* v : values) flat.push_back(*v);
  sums.add(flat);
  std::size_t i = 0;
  for (double* v : values) *v = flat[i++];
}

/// Three rings of outer radii 1, .8, .6 of the room of the tip; the middle one gives the values, the differences
/// between rings the spread.
constexpr int rings = 3;
constexpr int middle = 1;
constexpr int auxiliary = 3;  // unit K_I, unit K_II, unit force

/// Each ring is 0.6 of its outer radius wide.
std::array<TipRing, rings> place_rings(double radius) {
  std::array<TipRing, rings> ring;
  for (int k = 0; k < rings; ++k) {
    const double outer = (1 - 0.2 * k) * radius;
    ring[k] = {0.4 * outer, outer};
  }
  return ring;
}

/// Rows: integrals for K_I, K_II, T, J. One column per ring.
using Integrals = Eigen::Matrix<double, auxiliary + 1, rings>;
using Vectors = Eigen::Matrix<double, 2, auxiliary + 1>;  // P of these four in the columns

/// All fields are compared in the frame of the tip. An eigenstrain that is constant in the disc strains it without
/// stress and is taken out of the gradients: its value at the tip.
struct Disc {
  CrackTip tip;
  Material material;  // as seen in the frame of the tip; no ring reaches another one
  std::array<TipRing, rings> ring;
  double rotation =
      0;  // mean over the disc: rigid, so that taking it out changes nothing but the rounding and the mesh error
  PolynomialState smooth;  // in the frame of the tip, less that rotation
  double eigenstrain = 0;  // Field::eigenstrain; the gradients of all fields are less that at the tip
  Eigen::Vector4d at_tip = Eigen::Vector4d::Zero();
};

// The eigenstrain of the state less its value at the tip, which strains the body without stress.
Eigen::Matrix4Xd eigenstrain_beyond_tip(const Model& model, const Disc& disc, Index t, const Points& x) {
  return eigenstrain_at(model, disc.eigenstrain, t, x).colwise() - disc.at_tip;
}

/// The rotation enters the gradient alone; the mean rotation of the disc is taken out of it, which changes no integral.
LocalState in_frame(const Disc& disc, Eigen::Vector4d stress, double rotation,
                    const Eigen::Vector4d& free = Eigen::Vector4d::Zero()) {
  // The skew part of s is pure error, orthogonal to linear functions: without it s is nearer to the exact stress.
  stress[1] = stress[2] = 0.5 * (stress[1] + stress[2]);
  const Mat2& frame = disc.tip.frame;
  if (!isotropic(disc.material)) {
    const Mat2 turned = frame.transpose() * tensor(stress) * frame;
    const Eigen::Vector4d s(turned(0, 0), turned(0, 1), turned(1, 0), turned(1, 1));
    return {turned, tensor(displacement_gradient(disc.material, s, rotation - disc.rotation)) +
                        frame.transpose() * tensor(free) * frame};
  }
  const Eigen::Vector4d gradient = displacement_gradient(disc.material, stress, rotation - disc.rotation) + free;
  return {frame.transpose() * tensor(stress) * frame, frame.transpose() * tensor(gradient) * frame};
}

/// A tensor in the frame of the tip.
Mat2 turned(const Disc& disc, const Eigen::Vector4d& t) {
  return disc.tip.frame.transpose() * tensor(t) * disc.tip.frame;
}

/// Less the polynomial state.
LocalState less(const Disc& disc, const LocalState& state, const Vec2& at) {
  const LocalState smooth = disc.smooth.at(at);
  return {state.stress - smooth.stress, state.gradient - smooth.gradient};
}

/// All of (F.4) but the faces: - w (P . grad q + q rest), with grad q = q'(r) x/r; `rest` is f . u'_,1 less s' : e_,1
/// for an eigenstrain e [theory: H.6], and for J, with the state itself in place of the auxiliary fields, the same
/// terms of its own.
Integrals over_triangle(const Model& model, const Field& state, const Disc& disc, Index t) {
  const Triangle shape = triangle(model, t);
  // q bends within a ring: small triangles see a parabola of it.
  constexpr double small = 0.2;
  const double size = std::sqrt(2 * area(shape));
  const TipRing& narrow = disc.ring.back();
  const TriangleRule& rule =
      size < small * (narrow.outer - narrow.inner) ? model.inner->kernel.rule : model.inner->kernel.load;
  const Points x = rule_points(rule, shape);
  const Eigen::VectorXd weight = rule_weights(rule, shape);
  const Fields f = evaluate(model.inner->kernel, shape, state.interior.col(t), x);
  const bool strained = disc.eigenstrain != 0;
  const Eigen::Matrix4Xd free = eigenstrain_beyond_tip(model, disc, t, x);
  Eigen::Matrix4Xd free_slope;
  if (strained)
    free_slope = disc.eigenstrain * (disc.tip.frame(0, 0) * eigenstrain_slope_at(model, t, x, 0) +
                                     disc.tip.frame(1, 0) * eigenstrain_slope_at(model, t, x, 1));
  Integrals sum = Integrals::Zero();
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const Vec2 at = disc.tip.frame.transpose() * (x.col(i) - disc.tip.at);
    const double r = at.norm(), w = area(shape) * weight[i];
    const auto [s, d] = in_frame(disc, f.stress.col(i), f.rotation[i], free.col(i));
    const LocalState other = less(disc, {s, d}, at);
    const auto unit = tip_fields(disc.material, at, angle_about(disc.tip, at));
    Vectors P;
    Eigen::Vector4d rest = Eigen::Vector4d::Zero();  // the factor of q
    for (int k = 0; k < auxiliary; ++k)
      P.col(k) = other.stress.cwiseProduct(unit[k].gradient).sum() * Vec2::UnitX() -
                 other.stress * unit[k].gradient.col(0) - unit[k].stress * other.gradient.col(0);
    P.col(auxiliary) = 0.5 * s.cwiseProduct(d).sum() * Vec2::UnitX() - s * d.col(0);
    if (model.scene.body) {
      const Vec2 force = disc.tip.frame.transpose() * model.scene.body(x.col(i));
      for (int k = 0; k < auxiliary; ++k) rest[k] = (force - disc.smooth.force).dot(unit[k].gradient.col(0));
      rest[auxiliary] = force.dot(d.col(0));
    }
    if (strained) {
      const Mat2 own = turned(disc, free.col(i)), slope = turned(disc, free_slope.col(i));
      P.col(auxiliary) -= 0.5 * s.cwiseProduct(own).sum() * Vec2::UnitX();
      for (int k = 0; k < auxiliary; ++k) rest[k] -= unit[k].stress.cwiseProduct(slope).sum();
      rest[auxiliary] -= s.cwiseProduct(slope).sum();
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

/// `elements`: the outer radius over the mean edge length sqrt(2 |T|) in the outer half of the disc.
Cover cover(const Model& model, const Vec2& at, double inner, double outer, const Sums& sums) {
  const Mesh& mesh = model.mesh;
  Cover c;
  double in_ring = 0, count = 0;
  for (Index t = 0; t < own_triangles(model); ++t) {
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
  all(sums, {&in_ring, &count});
  if (count > 0) c.elements = outer / std::sqrt(2 * in_ring / count);
  return c;
}

/// Weighted by the slope of the cut-off, so that it does not matter which triangles at the rims count.
double mean_rotation(const Model& model, const Field& state, const Disc& disc, std::span<const Index> triangles,
                     const Sums& sums) {
  double sum = 0, size = 0;
  for (const Index t : triangles) {
    const Vec2 x = centroid(model.mesh, t);
    const double weight = area(model.mesh, t) * std::abs(cut_off_slope(disc.ring.front(), (x - disc.tip.at).norm()));
    if (weight == 0) continue;
    sum += weight * evaluate(model, state, t, x).rotation[0];
    size += weight;
  }
  all(sums, {&sum, &size});
  return size > 0 ? sum / size : 0;
}

/// In the plane y = 0: of a crack in a plane of symmetry the half that is not there.
StateSample mirrored(StateSample s) {
  s.x.y() *= -1;
  s.stress(0, 1) *= -1;
  s.stress(1, 0) *= -1;
  s.rotation *= -1;
  return s;
}

/// From the middles of the triangles. The degree is that of the element's stresses; no more than two, which is a good
/// part of any smooth state. Fields beside curved faces are turned from the chord to the curve: only a pressure does
/// not mind.
PolynomialState smooth_part(const Model& model, const Field& state, const Disc& disc, std::span<const Index> triangles,
                            std::span<const CrackPoint> profile, const Sums& sums) {
  if (disc.tip.curved) {
    double sum = 0, size = 0;
    for (const CrackPoint& p : profile)
      if ((p.at - disc.tip.at).norm() < disc.ring.front().outer) sum += p.length * p.sigma_n, size += p.length;
    return uniform_pressure(disc.material, size > 0 ? sum / size : 0);
  }
  std::vector<StateSample> samples;
  for (const Index t : triangles) {
    const Vec2 x = centroid(model.mesh, t), at = disc.tip.frame.transpose() * (x - disc.tip.at);
    const double weight = area(model.mesh, t) * std::abs(cut_off_slope(disc.ring.front(), at.norm()));
    if (weight == 0) continue;
    const Fields f = evaluate(model, state, t, x);
    samples.push_back({at, in_frame(disc, f.stress.col(0), 0).stress, f.rotation[0] - disc.rotation, weight});
    if (disc.tip.half != 0) samples.push_back(mirrored(samples.back()));
  }
  const Vec2 force =
      model.scene.body ? Vec2(disc.tip.frame.transpose() * model.scene.body(disc.tip.at)) : Vec2(Vec2::Zero());
  return fit_state(disc.material, std::clamp(model.element.degree, 1, 2), force, samples, sums);
}

Integrals over_ring(const Model& model, const Field& state, const Disc& disc, std::span<const Index> triangles,
                    const Sums& sums) {
  // Summed in the order of the triangles, whatever the number of threads.
  std::vector<Integrals> part(triangles.size());
  parallel_for(static_cast<Index>(triangles.size()), model.threads, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) part[i] = over_triangle(model, state, disc, triangles[i]);
  });
  Integrals sum = Integrals::Zero();
  for (const Integrals& p : part) sum += p;
  if (sums.add) sums.add({sum.data(), static_cast<std::size_t>(sum.size())});
  return sum;
}

/// An edge of the faces behind the tip, with what goes through it at places t in [0, 1] away from the tip. The points
/// have no fluid pressure in sigma_n: it is given, and known everywhere on the edge.
struct Face {
  std::size_t edge;  // of tip.edges
  std::vector<double> t;
  std::vector<CrackPoint> points;
  const EdgeValues* fluid = nullptr;
  bool along_edge = true;  // the places run with those of `fluid`, or against them
};

double fluid_pressure(const Face& face, double t) {
  return face.fluid ? pressure_at(*face.fluid, face.along_edge ? t : 1 - t) : 0;
}

/// Of a point of a curved edge, in its parameter away from the tip.
/// Point k from the tip is Gauss point n - 1 - k of an edge that runs towards the tip.
double trace_place(const Model& model, bool along_edge, int point) {
  const Eigen::VectorXd& s = model.inner->kernel.trace.s;
  return along_edge ? s[point] : 1 - s[s.size() - 1 - point];
}

/// A crack as far as its tip is concerned.
struct Beside {
  const CrackTip& tip;
  Material material;                       // CrackTip::frame aside
  std::span<const CrackPoint> profile;     // of all of the crack
  std::size_t points;                      // per edge
  const std::vector<CrackEdge>* edges;     // of all of it; null where it is known in parts
  std::span<const Index> here;             // per CrackTip::edges that of the model, or none where others have it
  double stress;                           // its size in the body
  std::span<const EdgeValues> fluid = {};  // in parts: its pressure per edge from the tip, as far as the rings reach
  double eigenstrain = 0;                  // Field::eigenstrain of the body
  Eigen::Vector4d at_tip = Eigen::Vector4d::Zero();  // the eigenstrain there
};

/// lim g/sqrt(r) of the gap g at a tip, r the distance from it: as far as faces may close there [theory: F.9]. 0 where
/// they touch before loading or overlap, infinite where they are apart up to the tip.
/// With g = c sqrt(r) + d r, g/sqrt(r) at r and r/4 give c = 2 g(r/4)/sqrt(r/4) - g(r)/sqrt(r).
double room_to_close(const CrackTip& tip, const CrackLaw& law) {
  constexpr double near = 1e-6;
  if (!has_gap(law)) return 0;
  const auto reduced = [&](double t) {
    const CurvePoint c = curve_point(tip, 0, t);
    const Vec2 along = tip.frame * c.slope.normalized();
    return law.gap(tip.at + tip.frame * c.at, Vec2(-along.y(), along.x())).x() / std::sqrt(c.at.norm());
  };
  constexpr double grows = 1.1;  // g falls slower than r^0.43
  const double at = reduced(near), nearer = reduced(near / 4);
  if (nearer > grows * at && nearer > 0) return infinity;
  return std::max(0.0, 2 * nearer - at);  // c of c sqrt(r) + d r
}

/// Points of the profile per edge, from the tip, with the pressure of contact as the mesh has it.
std::vector<Face> faces_beside(const Model& model, const Beside& crack) {
  const CrackTip& tip = crack.tip;
  const std::span<const CrackPoint> profile = crack.profile;
  const std::size_t count = crack.points, edges = profile.size() / count;
  const LoadedCrack* fluid = pressure_in(model.inner->data, tip.crack);
  std::vector<Face> faces;
  for (std::size_t i = 0; i < tip.edges.size(); ++i) {
    Face face{.edge = i};
    const std::size_t place = tip.at_start ? i : edges - 1 - i;
    if (!crack.edges)
      face.fluid = i < crack.fluid.size() ? &crack.fluid[i] : nullptr;
    else if (fluid)
      face.fluid = &fluid->values[place];
    const CrackEdge* const edge = crack.edges ? &(*crack.edges)[place] : nullptr;
    if (edge) face.along_edge = edge->forward == tip.at_start;
    for (std::size_t k = 0; k < count; ++k) {
      const CrackPoint& p = tip.at_start ? profile[i * count + k] : profile[profile.size() - 1 - i * count - k];
      const Vec2 x = tip.frame.transpose() * (p.at - tip.at), along = tip.vertices[i + 1] - tip.vertices[i];
      const bool bowed = edge ? curvature_at(model.inner->skeleton.curvatures, edge->edge) != nullptr : tip.follows;
      face.t.push_back(bowed ? trace_place(model, face.along_edge, static_cast<int>(k))
                             : (x - tip.vertices[i]).dot(along) / along.squaredNorm());
      face.points.push_back(p);
      face.points.back().sigma_n = -p.contact_pressure();
    }
    faces.push_back(std::move(face));
  }
  return faces;
}

/// The discrete pressure of contact on the edge at a tip is off by the order of K_II/sqrt(h), which would leave an
/// error of some hundredths of K_II in K_I on every mesh. The mean of that on the next edge takes its place, and the
/// friction there. Returns whether that presses: then the tip is closed or nearly so. As it is where faces overlap
/// before loading and press on each other up to an open tip, and where a gap keeps them apart (`apart`): nothing
/// presses there, or what does is on the mesh.
bool mend_pressure_at_tip(const CrackLaw& law, bool apart, std::vector<Face>& faces) {
  const bool wedged = std::ranges::any_of(faces[0].points, [](const CrackPoint& p) { return p.gap < 0; });
  if (!is_unilateral(law) || wedged || apart) return false;
  const bool open = std::ranges::all_of(faces[0].points, [](const CrackPoint& p) { return !(p.sigma_n < 0); });
  double pressure = 0, length = 0;
  if (faces.size() > 1 && !open)
    for (const CrackPoint& p : faces[1].points) pressure -= p.length * p.sigma_n, length += p.length;
  const double beyond = length > 0 ? std::max(0.0, pressure / length) : 0;
  for (CrackPoint& p : faces[0].points) {
    p.sigma_n = -beyond;
    if (faces.size() > 1) p.sigma_t = faces[1].points[0].sigma_t;
  }
  return beyond > 0;
}

/// The polynomial through the values at the points of a face, at t.
double along_face(const Face& face, double t, double CrackPoint::*value) {
  double sum = 0;
  for (std::size_t i = 0; i < face.t.size(); ++i) {
    double basis = 1;
    for (std::size_t j = 0; j < face.t.size(); ++j)
      if (j != i) basis *= (t - face.t[j]) / (face.t[i] - face.t[j]);
    sum += basis * face.points[i].*value;
  }
  return sum;
}

/// A point of the crack: n points to the upper face, t to the tip.
struct Spot {
  Vec2 at, n, t;
  double weight;  // length
  double upper;   // angle about the tip of the upper face, that of the lower one is 2 pi less
  double place;   // on the edge, 0 to 1
};

/// Gauss points in sqrt(r): what grows like r^-1/2 towards the tip times dr is smooth in it.
std::vector<Spot> spots(const CrackTip& tip, std::size_t edge) {
  const EdgeRule rule = gauss(8);
  std::vector<Spot> spots;
  // dr/sqrt(r) = 2 d sqrt(r)
  const double near = tip.vertices[edge].norm(), far = tip.vertices[edge + 1].norm();
  const double from = std::sqrt(near), to = std::sqrt(far);
  for (Eigen::Index i = 0; i < rule.s.size(); ++i) {
    const double root = from + rule.s[i] * (to - from), place = (root * root - near) / (far - near);
    const CurvePoint c = curve_point(tip, edge, place);
    const Vec2 t = -c.slope.normalized();
    spots.push_back({.at = c.at,
                     .n = {-t.y(), t.x()},
                     .t = t,
                     .weight = c.slope.norm() * rule.w[i] * 2 * root * (to - from) / (far - near),
                     .upper = pi + std::atan2(-c.at.y(), -c.at.x()),
                     .place = place});
  }
  return spots;
}

using Row = Eigen::Matrix<double, 1, rings>;

/// (s n) with n to the upper face: contact or cohesion less the given pressure of a fluid, and friction.
Vec2 traction(const Face& face, const Spot& p) {
  return (along_face(face, p.place, &CrackPoint::sigma_n) - fluid_pressure(face, p.place)) * p.n +
         along_face(face, p.place, &CrackPoint::sigma_t) * p.t;
}

/// int q (s n) . [u'_,1]: the auxiliary fields only; s less the polynomial state.
Integrals work_of_tractions(const Disc& disc, std::span<const Face> faces) {
  Integrals sum = Integrals::Zero();
  for (const Face& face : faces) {
    if (disc.tip.vertices[face.edge].norm() >= disc.ring.front().outer) break;
    for (const Spot& p : spots(disc.tip, face.edge)) {
      const auto upper = tip_fields(disc.material, p.at, p.upper),
                 lower = tip_fields(disc.material, p.at, p.upper - 2 * pi);
      const Vec2 through = traction(face, p) - disc.smooth.at(p.at).stress * p.n;
      for (int k = 0; k < rings; ++k)
        for (int i = 0; i < auxiliary; ++i)
          sum(i, k) += p.weight * cut_off(disc.ring[k], p.at.norm()) *
                       through.dot(upper[i].gradient.col(0) - lower[i].gradient.col(0));
    }
  }
  return sum;
}

/// The share of the pressure of contact on the first of them.
/// The integrals are linear in the tractions: the difference of two of them is that of the pressure alone.
Integrals work_of_pressure_at_tip(const Disc& disc, const Face& first) {
  Face free = first;
  for (CrackPoint& p : free.points) p.sigma_n = 0;
  return work_of_tractions(disc, {&first, 1}) - work_of_tractions(disc, {&free, 1});
}

/// What the polynomials of a fluid's pressure leave of it works on the singular auxiliary fields, too: where the
/// pressure is narrow, or grows without bounds at the tip. On straight faces. `error`: of each, added.
Integrals work_of_fluid_rest(const Disc& disc, const CrackLaw& law, std::span<const Face> faces, Integrals& error) {
  Integrals sum = Integrals::Zero();
  constexpr double rounding = 1e-10;
  const auto left_out = [&](const Face& face) {
    const double size = face.fluid ? face.fluid->at.row(0).cwiseAbs().maxCoeff() : 0;
    return face.fluid && !(face.fluid->rest.x() <= std::pow(rounding * size, 2));
  };
  const double outer = disc.ring.back().outer;
  std::vector<const Face*> with_rest;
  std::vector<double> ends;
  for (const Face& face : faces) {
    if (disc.tip.vertices[face.edge].norm() >= outer) break;
    if (!left_out(face)) continue;
    with_rest.push_back(&face);
    for (const std::size_t end : {face.edge, face.edge + 1}) ends.push_back(disc.tip.vertices[end].norm());
  }
  if (with_rest.empty()) return sum;
  const auto counts = [&](double r) {
    for (std::size_t i = 0; i < ends.size(); i += 2)
      if (ends[i] <= r && r <= ends[i + 1]) return true;
    return false;
  };
  const EdgeLine line{disc.tip.at, disc.tip.at - ends.back() * disc.tip.frame.col(0), disc.tip.frame.col(1)};
  for (int k = 0; k < rings; ++k)
    for (int i = 0; i < auxiliary; ++i) {
      const auto gradient = [&](double r, double angle) {
        return tip_fields(disc.material, Vec2(-r, 0), angle)[static_cast<std::size_t>(i)].gradient(1, 0);
      };
      std::vector<double> breaks = ends;
      breaks.insert(breaks.end(), {disc.ring[k].inner, disc.ring[k].outer});
      const Known exact = over_face(law.pressure, line, std::move(breaks), [&](double r) {
        return counts(r) ? cut_off(disc.ring[k], r) * (gradient(r, pi) - gradient(r, -pi)) * std::sqrt(r) : 0.0;
      });
      sum(i, k) -= exact.value;
      error(i, k) += exact.error;
    }
  for (const Face* face : with_rest)
    for (const Spot& p : spots(disc.tip, face->edge)) {
      const auto upper = tip_fields(disc.material, p.at, p.upper),
                 lower = tip_fields(disc.material, p.at, p.upper - 2 * pi);
      for (int k = 0; k < rings; ++k)
        for (int i = 0; i < auxiliary; ++i)
          sum(i, k) += p.weight * cut_off(disc.ring[k], p.at.norm()) * fluid_pressure(*face, p.place) *
                       p.n.dot(upper[i].gradient.col(0) - lower[i].gradient.col(0));
    }
  return sum;
}

/// The same for J on straight faces, int q s_12 d[u_1] and, of a fluid, int q s_22 d[u_2], as a sum over the points of
/// the profile: exact for a uniform friction and pressure. Where faces were apart before, contact follows their gap and
/// does work, too.
/// By the trapezoidal rule from point to point, tractions with q; the jump is 0 at the tip.
Row work_on_faces(const Disc& disc, std::span<const Face> faces) {
  using Pair = Eigen::Matrix<double, 2, rings>;
  const bool apart = std::ranges::any_of(faces, [](const Face& f) {
    return std::ranges::any_of(f.points, [](const CrackPoint& p) { return p.gap != 0; });
  });
  const auto tractions = [&](const CrackPoint& p) -> Pair {
    Pair both;
    for (int k = 0; k < rings; ++k)
      both.col(k) = cut_off(disc.ring[k], (p.at - disc.tip.at).norm()) *
                    Vec2(p.sigma_t, (apart ? p.sigma_n : 0) - p.fluid_pressure);
    return both;
  };
  Row sum = Row::Zero();
  Pair before = tractions(faces[0].points[0]);
  Vec2 jump = Vec2::Zero();
  for (const Face& face : faces)
    for (const CrackPoint& p : face.points) {
      const Pair here = tractions(p);
      const Vec2 to(p.jump_t, p.jump_n);
      sum -= 0.5 * (to - jump).transpose() * (before + here);
      jump = to;
      before = here;
    }
  return sum;
}

/// The fields beside a chord, turned into the direction of the curve.
/// Both tensors are turned as the direction of the chord turns into that of the curve at the same place.
LocalState along_curve(const LocalState& f, const Vec2& chord, const Spot& p) {
  const Vec2 along = -chord.normalized();
  const double c = along.dot(p.t), s = cross(along, p.t);
  const Mat2 turn = (Mat2() << c, -s, s, c).finished();
  return {turn * f.stress * turn.transpose(), turn * f.gradient * turn.transpose()};
}

/// P . n less the part of the traction s n on the auxiliary fields, and less all of it in J.
/// P_j n_j = (s : grad u') n_1 - (s n) . u'_,1 - (s' n) . u_,1: the second term is that of work_of_tractions.
Eigen::Vector4d flux(const Material& m, const Spot& p, const LocalState& f, bool upper) {
  const Vec2 out = upper ? Vec2(-p.n) : p.n;
  const auto unit = tip_fields(m, p.at, upper ? p.upper : p.upper - 2 * pi);
  Eigen::Vector4d sum;
  for (int k = 0; k < auxiliary; ++k)
    sum[k] = f.stress.cwiseProduct(unit[k].gradient).sum() * out.x() - (unit[k].stress * out).dot(f.gradient.col(0));
  sum[auxiliary] = 0.5 * f.stress.cwiseProduct(f.gradient).sum() * out.x();
  return sum;
}

/// What that leaves out in J, (s n) . [u_,1], one face's share. Faces in contact stay so as they slide: n . [u_,t] is
/// the slip times the curvature, much smoother than the gradients beside the chords. A fluid follows either face.
double work_of_sliding(const Face& face, const Spot& p, const LocalState& f, bool upper, double curvature) {
  const double normal = along_face(face, p.place, &CrackPoint::sigma_n),
               shear = along_face(face, p.place, &CrackPoint::sigma_t),
               slip = along_face(face, p.place, &CrackPoint::jump_t);
  const double beside = shear * p.t.dot(f.gradient.col(0)) + normal * p.n.x() * p.n.dot(f.gradient * p.n) -
                        fluid_pressure(face, p.place) * p.n.dot(f.gradient.col(0));
  return (upper ? beside : -beside) + 0.5 * normal * p.t.x() * curvature * slip;
}

/// What P . n leaves on curved faces besides the work of the tractions on the auxiliary fields. It tends to a constant
/// towards the tip, that of T grows like r^-1/2, as does the work of friction in J. On the edges next to the tip, where
/// the discrete fields are poor, it is continued like that from the next edge. `here`: Beside::here.
Integrals over_curved_faces(const Model& model, const Field& state, const Disc& disc, std::span<const Face> faces,
                            std::span<const Index> here_edges, const Sums& sums) {
  const CrackTip& tip = disc.tip;
  const std::size_t poor = std::min<std::size_t>(2, tip.edges.size() - 1);
  Integrals sum = Integrals::Zero();
  Row work = Row::Zero();
  for (std::size_t edge = poor; edge < tip.edges.size(); ++edge) {
    const Vec2 &a = tip.vertices[edge], &b = tip.vertices[edge + 1];
    if (a.norm() >= disc.ring.front().outer) break;
    const Index e = here_edges[edge];
    const std::vector<Spot> all = e == none ? std::vector<Spot>() : spots(tip, edge);
    const bool bowed = e != none && curvature_at(model.inner->skeleton.curvatures, e);
    Points x(2, static_cast<Eigen::Index>(all.size()));
    for (std::size_t i = 0; i < all.size(); ++i)
      x.col(static_cast<Eigen::Index>(i)) = tip.at + tip.frame * (bowed ? all[i].at : Vec2(a + all[i].place * (b - a)));
    const double curvature = cross(tip.slopes[edge + 1], tip.slopes[edge]) / (b - a).norm();
    const bool away = e != none && (tip.frame * (b - a)).dot(tangent(model.mesh, e)) > 0;
    for (const bool upper : {true, false}) {
      // To the left of a walk away from the tip lies the lower face.
      const Index t = e == none ? none : model.mesh.sides[e][upper == away ? 1 : 0];
      if (t == none || t >= own_triangles(model)) continue;
      const Fields f = evaluate(model.inner->kernel, triangle(model, t), state.interior.col(t), x);
      const Eigen::Matrix4Xd free = eigenstrain_beyond_tip(model, disc, t, x);
      for (std::size_t i = 0; i < all.size(); ++i) {
        const Eigen::Index column = static_cast<Eigen::Index>(i);
        const Spot& p = all[i];
        const LocalState beside = in_frame(disc, f.stress.col(column), f.rotation[column], free.col(column)),
                         here = bowed ? beside : along_curve(beside, b - a, p);
        Eigen::Vector4d through = flux(disc.material, p, less(disc, here, p.at), upper);
        through[auxiliary] = flux(disc.material, p, here, upper)[auxiliary];
        if (disc.eigenstrain != 0)  // J takes the elastic energy
          through[auxiliary] -=
              0.5 * here.stress.cwiseProduct(turned(disc, free.col(column))).sum() * (upper ? -p.n.x() : p.n.x());
        const double sliding = work_of_sliding(faces[edge], p, here, upper, curvature);
        for (int k = 0; k < rings; ++k) {
          const double weight = p.weight * cut_off(disc.ring[k], p.at.norm());
          sum.col(k) += weight * through;
          work[k] += weight * sliding;
        }
      }
    }
    if (edge > poor) continue;
    const double near = a.norm(), far = b.norm();
    // On the edges next to the tip the integrand is that of the next edge: constant, its share is far/(far - near);
    // like r^-1/2, sqrt(far)/(sqrt(far) - sqrt(near)).
    const double constant = far / (far - near), root = std::sqrt(far) / (std::sqrt(far) - std::sqrt(near));
    sum.array().colwise() *= Eigen::Array4d(constant, constant, root, constant);
    work *= root;
  }
  sum.row(auxiliary) += work;
  if (sums.add) sums.add({sum.data(), static_cast<std::size_t>(sum.size())});
  return sum;
}

double largest_difference(const Row& values) {
  return values.maxCoeff() - values.minCoeff();
}

/// The material of a tip, and as seen in its frame.
const Material& material_at(const Mesh& mesh, const Scene& scene, const CrackTip& tip) {
  const auto& [left, right] = mesh.sides[tip.edges.front()];
  return material_of(mesh, scene, left != none ? left : right);
}
Material in_frame_of(const CrackTip& tip, const Material& m) {
  return isotropic(m) ? m : seen_from(m, std::atan2(tip.frame(1, 0), tip.frame(0, 0)));
}

/// |K_I/K_II| at a closed tip [theory: O.12].
double slope_of_closed_tip(const Material& m) {
  if (isotropic(m)) return 0;
  const Mat2 inverse_L = surface(m).inverse_L;
  return std::abs(inverse_L(1, 0) / inverse_L(1, 1));
}

/// What the integrals say, per ring.
/// A column per ring; K_I and K_II are the rows of K.
struct Factors {
  Eigen::Matrix<double, 2, rings> K;
  Row T, G;
};

/// `traction`: s_12, s_22 that the faces bear at the tip; `least`: the opening (L^-1 K)_n that contact asks for;
/// `pressed`: the part of I that is of a pressure on the edge at the tip. Whether that edge is closed the rest says:
/// K_I > 0 without it means that the tip is open, and nothing presses there; at a closed tip a positive term is
/// missing.
/// K = E'/2 I, T = E' I, G = |K|^2/E' [theory: F.5], in orthotropic bodies K = L I [theory: O.12]; I with the
/// polynomial state taken out, whose T is added. `least` bounds the opening, hence K_I, from below.
Factors factors(const Disc& disc, const Integrals& all, const Integrals& pressed, const Vec2& traction, double least) {
  const Integrals I = all - pressed;
  const double modulus = plane_modulus(disc.material);
  Factors f{modulus / 2 * all.topRows<2>(), (modulus * all.row(2)).array() + disc.smooth.t_stress(), {}};
  if (isotropic(disc.material)) {
    f.K.row(0) = modulus / 2 * I.row(0);
    f.K.row(0) = f.K.row(0).cwiseMax(modulus / 2 * least);
    f.G = f.K.colwise().squaredNorm() / modulus;
    return f;
  }
  const Mat2 smooth = disc.smooth.at(Vec2::Zero()).stress;
  for (int k = 0; k < rings; ++k) {
    // A pressure at the tip changes K_I alone, so that K_II is that of either.
    f.K.col(k) = orthotropic_factors(disc.material, I.col(k).head<2>(), least);
    f.G[k] = orthotropic_release(disc.material, f.K.col(k));
    const bool closed = !(I(0, k) > least);  // then the pressure at the tip is known from the next edge alone
    f.T[k] = closed ? nan
                    : disc.smooth.t_stress() +
                          orthotropic_t_stress(disc.material, all(2, k), traction - Vec2(smooth(0, 1), smooth(1, 1)));
  }
  return f;
}

/// What the pressure of contact on the edge at a tip whose faces are apart does to K_I: where on the edge it ends is
/// not known, so that all of it may be false.
/// A pressure p on the length l at the tip has K_I = -2 p sqrt(2 l/pi).
double unresolved_contact(const CrackTip& tip, const Face& first) {
  double largest = 0;
  for (const CrackPoint& p : first.points) largest = std::max(largest, -p.sigma_n);
  return 2 * std::sqrt(2 / pi * tip.vertices[1].norm()) * largest;
}

/// What acts on an edge of the boundary, in the frame of the tip.
Vec2 load_on(const Model& model, const CrackTip& tip, Index edge, const Vec2& at) {
  const Vec2 n = outward_normal(model.mesh, edge);
  Vec2 load = Vec2::Zero();
  for (const Traction& t : model.scene.tractions)
    if (t.label == model.mesh.label[edge]) load += t.value(tip.at + tip.frame * at, n);
  return tip.frame.transpose() * load;
}

/// int q P . n on the face of half a crack, n out of the body: - q (s n) . u'_,1, s less the polynomial state, and for
/// J
/// - q (s n) . u_,1, on the edges next to the tip, where the discrete fields are poor, continued from the next edge
/// like r^-1/2.
Integrals work_on_half_face(const Model& model, const Field& state, const Disc& disc) {
  const CrackTip& tip = disc.tip;
  const Vec2 n(0, -tip.half);
  const std::size_t poor = std::min<std::size_t>(2, tip.edges.size() - 1);
  Integrals sum = Integrals::Zero();
  Row work = Row::Zero();
  for (std::size_t edge = 0; edge < tip.edges.size(); ++edge) {
    if (tip.vertices[edge].norm() >= disc.ring.front().outer) break;
    const Index e = tip.edges[edge], inside = model.mesh.sides[e][model.mesh.sides[e][0] == none ? 1 : 0];
    for (const Spot& p : spots(tip, edge)) {
      const Vec2 load = load_on(model, tip, e, p.at), through = load - disc.smooth.at(p.at).stress * n;
      const auto unit = tip_fields(disc.material, p.at, tip.half * pi);
      double beside = 0;
      if (edge >= poor && !load.isZero(0)) {
        const Vec2 x = tip.at + tip.frame * p.at;
        const Fields f = evaluate(model, state, inside, x);
        const Eigen::Vector4d free = eigenstrain_beyond_tip(model, disc, inside, x).col(0);
        beside = load.dot(in_frame(disc, f.stress.col(0), f.rotation[0], free).gradient.col(0));
      }
      for (int k = 0; k < rings; ++k) {
        const double weight = p.weight * cut_off(disc.ring[k], p.at.norm());
        for (int i = 0; i < auxiliary; ++i) sum(i, k) -= weight * through.dot(unit[i].gradient.col(0));
        work[k] -= weight * beside;
      }
    }
    const double near = std::sqrt(tip.vertices[edge].norm()), far = std::sqrt(tip.vertices[edge + 1].norm());
    if (edge == poor) work *= far / (far - near);
  }
  sum.row(auxiliary) += work;
  return sum;
}

/// Of a tip without values.
TipIntensity unknown(const CrackTip& tip) {
  TipIntensity t{.crack = tip.crack, .at_start = tip.at_start, .at = tip.at, .on_border = tip.on_border};
  t.K_I = t.K_II = t.T = t.G = t.J = nan;
  t.spread = t.spread_K_I = t.spread_K_II = t.spread_T = nan;
  return t;
}

/// In the order of the method: rings that fit beside everything else, the rigid rotation and the polynomial state, what
/// acts on the faces, the integrals, and K, T, G, J with their spreads. `safe`: rings end before the next boundary.
/// With fewer than 1.5 elements between the tip and the outer circle there are no values.
TipIntensity intensity(const Model& model, const Field& state, const Beside& crack, const Sums& sums = {}) {
  const CrackTip& tip = crack.tip;
  const std::span<const CrackPoint> profile = crack.profile;
  const double stress = crack.stress;
  constexpr double safe = 0.9, fewest_elements = 1.5;
  const double radius = safe * tip.room;
  Disc disc{tip, in_frame_of(tip, crack.material), place_rings(radius), 0, {}};
  TipIntensity result{.crack = tip.crack, .at_start = tip.at_start, .at = tip.at};
  disc.eigenstrain = crack.eigenstrain;
  disc.at_tip = crack.at_tip;
  const bool all_over = model.scene.body || disc.eigenstrain != 0;
  const Cover c = cover(model, tip.at, all_over ? 0 : disc.ring.back().inner, radius, sums);
  const CrackLaw& law = model.scene.laws[tip.crack];
  const bool follows_gap = tip.curved && has_gap(law);  // the work of contact on it is known on straight faces
  if (c.elements < fewest_elements || follows_gap) return unknown(tip);
  disc.rotation = mean_rotation(model, state, disc, c.triangles, sums);
  disc.smooth = smooth_part(model, state, disc, c.triangles, profile, sums);
  const double to_close = room_to_close(tip, law);
  std::vector<Face> behind = faces_beside(model, crack);
  const bool presses = mend_pressure_at_tip(law, std::isinf(to_close), behind);
  Integrals I = over_ring(model, state, disc, c.triangles, sums) + work_of_tractions(disc, behind);
  Integrals fluid_error = Integrals::Zero();
  if (tip.curved) {
    I += over_curved_faces(model, state, disc, behind, crack.here, sums);
  } else {
    I.row(auxiliary) += work_on_faces(disc, behind);
    if (has_pressure(law)) I += work_of_fluid_rest(disc, law, behind, fluid_error);
  }
  const double modulus = plane_modulus(disc.material);
  const Vec2 at_tip(along_face(behind[0], 0, &CrackPoint::sigma_t),
                    along_face(behind[0], 0, &CrackPoint::sigma_n) - fluid_pressure(behind[0], 0));
  const bool contact = is_unilateral(law);
  const Integrals pressed = presses ? work_of_pressure_at_tip(disc, behind[0]) : Integrals(Integrals::Zero());
  const auto [K, T, G] = factors(disc, I, pressed, at_tip, contact ? -std::sqrt(pi / 8) * to_close : -infinity);
  result.K_I = K(0, middle);
  result.K_II = K(1, middle);
  result.T = T[middle];
  result.G = G[middle];
  result.J = I(auxiliary, middle);
  result.radius = disc.ring[middle].outer;
  const auto relative = [](double difference, double size) { return size > 0 ? difference / size : 0; };
  // Spreads are relative to |K|, or to what the mean stress would make of a crack of that radius, where K is small.
  const double size = std::max(K.col(middle).norm(), stress * std::sqrt(pi * result.radius));
  result.spread_K_I = relative(largest_difference(K.row(0)), size);
  result.spread_K_II = relative(largest_difference(K.row(1)), size);
  if (fluid_error.maxCoeff() > 0) {
    const auto uncut = [&](const Integrals& all) { return factors(disc, all, pressed, at_tip, -infinity).K; };
    const Eigen::MatrixXd off = (uncut(I + fluid_error) - uncut(I)).cwiseAbs();
    result.spread_K_I += relative(off(0, middle), size);
    result.spread_K_II += relative(off(1, middle), size);
  }
  if (std::isinf(to_close)) result.spread_K_I += relative(unresolved_contact(tip, behind[0]), size);
  if (has_friction(law) && law.friction > 0) {
    // The rings agree whatever false friction does to all of them.
    const double of_energy = std::abs(result.J - result.G) * modulus / 2;
    // In orthotropic bodies slip presses the faces, which friction feels, and K_I follows K_II [theory: O.12].
    constexpr double most = 0.9;
    const double follows = slope_of_closed_tip(disc.material);
    const double more =
        relative(slip_error(tip, law, profile, radius), size) / (1 - std::min(law.friction * follows, most)) +
        relative(of_energy, size * size);
    result.spread_K_II += more;
    result.spread_K_I += follows * more;
  }
  result.spread_T = relative(largest_difference(T), std::max(std::abs(result.T), stress));
  result.spread = std::max(result.spread_K_I, result.spread_K_II);
  return result;
}

/// K_I, T, G and J of the whole body from the half that is there: both halves of the ring have the same share of each
/// integral of symmetric fields, and none of the one with the fields of K_II; on the ligament P . n = 0.
TipIntensity half_intensity(const Model& model, const Field& state, const CrackTip& tip, double stress) {
  constexpr double safe = 0.9, fewest_elements = 1.5;
  const double radius = safe * tip.room;
  TipIntensity result{.crack = tip.crack, .at_start = tip.at_start, .at = tip.at};
  Disc disc{tip, in_frame_of(tip, material_at(model.mesh, model.scene, tip)), place_rings(radius), 0, {}};
  disc.eigenstrain = state.eigenstrain;
  const Index e = tip.edges.front(), inside = model.mesh.sides[e][model.mesh.sides[e][0] == none ? 1 : 0];
  disc.at_tip = eigenstrain_at(model, state.eigenstrain, inside, tip.at).col(0);
  const bool all_over = model.scene.body || disc.eigenstrain != 0;
  const Cover c = cover(model, tip.at, all_over ? 0 : disc.ring.back().inner, radius, {});
  if (!(c.elements >= fewest_elements)) return unknown(tip);
  disc.smooth = smooth_part(model, state, disc, c.triangles, {}, {});
  Integrals I = 2 * (over_ring(model, state, disc, c.triangles, {}) + work_on_half_face(model, state, disc));
  I.row(1).setZero();
  const Vec2 load = load_on(model, tip, e, Vec2(-1e-9 * radius, 0)), at_tip = -tip.half * load;  // s_12, s_22
  auto [K, T, G] = factors(disc, I, Integrals::Zero(), at_tip, -infinity);
  result.K_I = K(0, middle);
  result.T = T[middle];
  result.G = G[middle];
  result.J = I(auxiliary, middle);
  result.radius = disc.ring[middle].outer;
  const auto relative = [](double difference, double size) { return size > 0 ? difference / size : 0; };
  const double size = std::max(std::abs(result.K_I), stress * std::sqrt(pi * result.radius));
  result.spread = result.spread_K_I = relative(largest_difference(K.row(0)), size);
  result.spread_T = relative(largest_difference(T), std::max(std::abs(result.T), stress));
  return result;
}

}  // namespace

std::vector<TipIntensity> half_crack_tips(const Model& model, const Field& state, std::span<const HalfCrack> cracks) {
  std::vector<TipIntensity> tips;
  const double stress = mean_stress(model, state);
  for (std::size_t c = 0; c < cracks.size(); ++c)
    for (const bool start : {true, false}) {
      if (!cracks[c].tips[start ? 0 : 1]) continue;
      std::vector<Index> face = cracks[c].edges;
      if (!start) std::ranges::reverse(face);
      CrackTip tip = half_tip(model.mesh, face, cracks[c].ahead[start ? 0 : 1]);
      tip.crack = static_cast<Index>(c);
      tip.at_start = start;
      tips.push_back(half_intensity(model, state, tip, stress));
    }
  return tips;
}

/// Tips come in the order of the cracks, so that the profile of a crack is made once for both of its ends.
std::vector<TipIntensity> crack_tips(const Model& model, const Field& state) {
  std::vector<TipIntensity> tips;
  const double stress = mean_stress(model, state);
  std::vector<CrackPoint> profile;
  Index crack = none;
  for (const CrackTip& tip : find_tips(model.mesh, 0, &model.scene)) {
    if (tip.crack != crack) profile = crack_profile(model, state, tip.crack);
    crack = tip.crack;
    const std::vector<CrackEdge>& edges = model.mesh.cracks[crack];
    Beside beside{
        tip,   material_at(model.mesh, model.scene, tip), profile, profile.size() / edges.size(), &edges, tip.edges,
        stress};
    beside.eigenstrain = state.eigenstrain;
    beside.at_tip = eigenstrain_at(model, state.eigenstrain, model.mesh.sides[tip.edges.front()][0], tip.at).col(0);
    tips.push_back(intensity(model, state, beside));
    tips.back().region = region_of(model.mesh, model.mesh.sides[tip.edges.front()][0]);
  }
  return tips;
}

/// What a process cannot see of the whole: the tip, the material there, and the pressure in the crack near it.
struct SharedTips::Tip {
  CrackTip tip;
  Material material;
  std::vector<EdgeValues> fluid;  // Beside::fluid
};

namespace {

/// The pressure in a straight crack on the edges behind its tip, away from it, as far as the rings reach.
std::vector<EdgeValues> fluid_behind(const CrackTip& tip, const CrackLaw& law) {
  std::vector<EdgeValues> values;
  if (!has_pressure(law)) return values;
  for (std::size_t i = 0; i < tip.edges.size() && tip.vertices[i].norm() < tip.room; ++i) {
    const Vec2 a = tip.at + tip.frame * tip.vertices[i], b = tip.at + tip.frame * tip.vertices[i + 1],
               along = (b - a).normalized();
    values.push_back(edge_values(law.pressure, {a, b, Vec2(along.y(), -along.x())}, "pressure in a crack"));
  }
  return values;
}

/// Beside::here of a tip of the whole.
/// Vertices of the tip lie ever farther from it, so that a search by distance finds the edge; places differ by rounding
/// only.
std::vector<Index> edges_here(const Mesh& mesh, const CrackTip& tip) {
  std::vector<Index> here(tip.edges.size(), none);
  for (const CrackEdge& c : mesh.cracks[static_cast<std::size_t>(tip.crack)]) {
    std::array<Vec2, 2> x;
    for (std::size_t i = 0; i < 2; ++i)
      x[i] = tip.frame.transpose() * (mesh.points[mesh.edges[static_cast<std::size_t>(c.edge)][i]] - tip.at);
    if (x[1].squaredNorm() < x[0].squaredNorm()) std::swap(x[0], x[1]);
    constexpr double rounding = 1e-6;
    const double same = rounding * (x[1] - x[0]).norm();
    const auto found =
        std::ranges::lower_bound(tip.vertices, x[0].norm() - same, {}, [](const Vec2& v) { return v.norm(); });
    const auto i = static_cast<std::size_t>(found - tip.vertices.begin());
    if (i < here.size() && (tip.vertices[i] - x[0]).norm() <= same && (tip.vertices[i + 1] - x[1]).norm() <= same)
      here[i] = c.edge;
  }
  return here;
}

/// At the tip, in the triangle on the left of the last edge of its crack: that of one process, on all.
Eigen::Vector4d eigenstrain_at_tip(const Model& part, const CrackTip& tip, const Sums& sums) {
  Eigen::Vector4d strain = Eigen::Vector4d::Zero();
  const Mesh& mesh = part.mesh;
  for (const CrackEdge& edge : mesh.cracks[static_cast<std::size_t>(tip.crack)]) {
    const auto& [a, b] = mesh.edges[static_cast<std::size_t>(edge.edge)];
    const Index left = mesh.sides[static_cast<std::size_t>(edge.edge)][0];
    if ((mesh.points[a] == tip.at || mesh.points[b] == tip.at) && left < own_triangles(part))
      strain = eigenstrain_at(part, 1, left, tip.at).col(0);
  }
  sums.add({strain.data(), 4});
  return strain;
}

}  // namespace

/// From the coarse mesh as if it were divided: the curve of the crack and the room of its tips are those of the fine
/// mesh.
SharedTips::SharedTips(const Mesh& mesh, const Scene& scene, int divisions) {
  for (CrackTip& tip : find_tips(mesh, divisions, &scene)) {
    Material material = material_at(mesh, scene, tip);
    std::vector<EdgeValues> fluid;
    if (!tip.curved) fluid = fluid_behind(tip, scene.laws[tip.crack]);
    tips_.push_back({std::move(tip), std::move(material), std::move(fluid)});
  }
}
SharedTips::~SharedTips() = default;

/// The tips are those of the whole mesh, the same on all processes and in the same order: every process takes part in
/// each sum, with the triangles and faces that it owns.
std::vector<TipIntensity> SharedTips::intensities(const Model& part, const Field& state,
                                                  const std::vector<std::vector<CrackPoint>>& profiles,
                                                  const Sums& sums) const {
  const double mean = mean_stress(part, state);
  double squares = mean * mean * area(part), whole = area(part);
  all(sums, {&squares, &whole});
  const double stress = std::sqrt(squares / whole);
  const bool strained = has_eigenstrain(part.scene);
  std::vector<TipIntensity> found;
  for (const Tip& t : tips_) {
    if (t.tip.curved && (!t.tip.follows || has_pressure(part.scene.laws[t.tip.crack]))) {
      found.push_back(unknown(t.tip));
      continue;
    }
    const std::vector<Index> here = edges_here(part.mesh, t.tip);
    Beside beside{t.tip,
                  t.material,
                  profiles[t.tip.crack],
                  static_cast<std::size_t>(part.inner->skeleton.per_edge) / 2,
                  nullptr,
                  here,
                  stress,
                  t.fluid};
    if (strained) {
      beside.eigenstrain = 1;
      beside.at_tip = eigenstrain_at_tip(part, t.tip, sums);
    }
    found.push_back(intensity(part, state, beside, sums));
  }
  return found;
}

}  // namespace kerf
