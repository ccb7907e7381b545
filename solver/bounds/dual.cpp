// The loads of dual problems. A quantity Q that is linear in the state u is
//   Q(u) = int t . G + l(u)      [theory: B.12],
// with a field G that is singular at a point or a tip [Bueckner 1970]; l are the tractions -sigma_G n on the boundary
// and on the faces of other cracks, and -G on the supports. In bodies of one material without body force and
// eigenstrain G reaches through the whole body (global_dual). Elsewhere G is cut off by a factor chi that falls from 1
// to 0 within a disc (local_dual): with g = sym(grad chi x G)
//   Q = int chi f . G + int_faces chi t . G + int (sigma_G grad chi) . u - int g : sigma      [theory: B.20],
// so that the dual has the body force sigma_G grad chi and the eigenstrain -g. Mean displacements and forces of
// supports have loads without a singular field [theory: B.24]. docs/theory/bounds.md derives them;
// solver/bounds/nucleus.cpp has the G.

#include "solver/bounds/dual.hpp"

#include "geometry/plane.hpp"

#include <fmt/core.h>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace kerf {

namespace {

Vec2 quarter_turn(const Vec2& n) {
  return {-n.y(), n.x()};
}

// In the components of a support.
Vec2 components_of(const Support& support, const Vec2& u, const Vec2& n) {
  return support.normal_frame ? Vec2(n.dot(u), quarter_turn(n).dot(u)) : u;
}

BoundaryField sum(const BoundaryField& a, double factor, const BoundaryField& b) {
  if (!b) return a;
  if (!a) return [factor, b](const Vec2& x, const Vec2& n) -> Vec2 { return factor * b(x, n); };
  return [a, factor, b](const Vec2& x, const Vec2& n) -> Vec2 { return a(x, n) + factor * b(x, n); };
}

VectorField sum(const VectorField& a, double factor, const VectorField& b) {
  if (!b) return a;
  return a ? kerf::sum(a, scaled(factor, b)) : scaled(factor, b);
}

Vec2 nothing(const Vec2&, const Vec2&) {
  return Vec2::Zero();
}

}  // namespace

/// The body, its laws and its supports, with no load and supports at 0.
Scene at_rest(const Model& m) {
  Scene s;
  s.material = m.scene.material;
  s.regions = m.scene.regions;
  s.laws = m.scene.laws;
  for (CrackLaw& law : s.laws) law.pressure = {};
  s.supports = m.scene.supports;
  for (Support& support : s.supports) support.value = nothing;
  return s;
}

/// At rest under loads that are 0 on every label and in every crack with faces: all states that are taken together have
/// the same loaded edges.
Scene unloaded(const Model& m) {
  Scene s = at_rest(m);
  for (CrackLaw& law : s.laws)
    if (law.kind != CrackLaw::Kind::Bonded) law.pressure = nothing;
  const Index labels = 1 + *std::max_element(m.mesh.label.begin(), m.mesh.label.end());
  for (Index label = 0; label < labels; ++label) s.tractions.push_back({label, nothing});
  return s;
}

namespace {

/// How far a curved edge is from its chord, at most.
/// q has the coefficients of the deviation from the chord, which is s (1 - s) (q_0 + q_1 s + q_2 s^2): at most 1/4 of
/// the sum of their norms.
double bulge(const Model& m, Index e) {
  const EdgeCurvature* curvature = curvature_at(m.inner->skeleton.curvatures, e);
  return curvature ? 0.25 * (curvature->q[0].norm() + curvature->q[1].norm() + curvature->q[2].norm()) : 0;
}

/// To the nearest triangle with curved edges, where a field that is cut off must be 0.
double clear_of_arcs(const Model& m, const Vec2& x) {
  double least = infinity;
  if (m.mesh.arc.empty()) return least;
  for (Index t = 0; t < static_cast<Index>(m.mesh.triangles.size()); ++t)
    if (is_curved(triangle(m, t)))
      for (const Index e : m.mesh.edges_of[t])
        least = std::min(
            least, distance(x, m.mesh.points[m.mesh.edges[e][0]], m.mesh.points[m.mesh.edges[e][1]]) - bulge(m, e));
  return std::max(least, 0.0);
}

/// Of a place, which is a line at most, to the segment from a to b.
/// 0 where they cross, else the least distance of an end of one from the other.
double gap(const StressPlace& place, const Vec2& a, const Vec2& b) {
  if (crossing(place.from, place.to, a, b)) return 0;
  return std::min({distance(place.from, a, b), distance(place.to, a, b), distance(a, place.from, place.to),
                   distance(b, place.from, place.to)});
}

/// The tractions of G were sampled: they are as smooth as it takes on edges that are not long beside their distance. G
/// of a disc goes on to its middle.
std::string unresolved(const Model& m, const StressPlace& singular, Index own) {
  constexpr double far = 0.5;  // of the length of an edge
  for (std::size_t e = 0; e < m.mesh.edges.size(); ++e) {
    const Index crack = m.mesh.crack[e];
    const bool outer = m.mesh.sides[e][0] == none || m.mesh.sides[e][1] == none;
    const bool face = crack != none && crack != own && m.scene.laws[crack].kind != CrackLaw::Kind::Bonded;
    if (!outer && !face) continue;
    const Vec2 &a = m.mesh.points[m.mesh.edges[e][0]], &b = m.mesh.points[m.mesh.edges[e][1]];
    if (gap(singular, a, b) < far * length(m.mesh, static_cast<Index>(e)))
      return fmt::format(
          "the bounds are estimates: the mesh is coarse on the boundary or the crack beside ({:.6g}, {:.6g})",
          singular.middle().x(), singular.middle().y());
  }
  return {};
}

}  // namespace

/// On a face a traction enters as a pressure and a shear in the frame of the crack, n from the left to the right side:
/// both faces get -sigma_G n of their own outward normal. Supports get -G in the components that they hold.
DualProblem global_dual(const Model& m, const Nucleus& G, const StressPlace& singular, Index own) {
  Scene s = unloaded(m);
  for (std::size_t c = 0; c < s.laws.size(); ++c) {
    if (s.laws[c].kind == CrackLaw::Kind::Bonded || static_cast<Index>(c) == own) continue;
    s.laws[c].pressure = [G](const Vec2& x, const Vec2& n) -> Vec2 {
      const Vec2 t = G.stress(x) * n;
      return {n.dot(t), quarter_turn(n).dot(t)};
    };
  }
  for (Traction& t : s.tractions) t.value = [G](const Vec2& x, const Vec2& n) -> Vec2 { return -G.stress(x) * n; };
  for (Support& support : s.supports)
    support.value = [G, as = support](const Vec2& x, const Vec2& n) -> Vec2 {
      return -components_of(as, G.displacement(x), n);
    };
  return {std::move(s), work_of_tractions(m, G), unresolved(m, singular, own)};
}

namespace {

/// The slope of the fading factor at x.
Vec2 slope_at(const Fade& fade, const Vec2& middle, const Vec2& x) {
  const Vec2 d = x - middle;
  const double r = d.norm();
  const double slope = fade.slope(r);
  return slope == 0 ? Vec2(Vec2::Zero()) : Vec2(slope / r * d);
}

/// The fields of the ring are sampled in triangles that should be small in it.
std::string coarse_in(const Model& m, const CutOffDisc& disc, const Fade& fade) {
  constexpr double small = 0.7;  // of the width of the ring
  for (std::size_t e = 0; e < m.mesh.edges.size(); ++e) {
    const Vec2 &a = m.mesh.points[m.mesh.edges[e][0]], &b = m.mesh.points[m.mesh.edges[e][1]];
    if (distance(disc.middle, a, b) < fade.outer && (a - b).norm() > small * (fade.outer - fade.inner))
      return fmt::format(
          "the bounds are estimates: the mesh is coarse about ({:.6g}, {:.6g}), for the distance to the "
          "next boundary, crack or region",
          disc.middle.x(), disc.middle.y());
  }
  return {};
}

}  // namespace

Vec2 CutOffRing::slope(const Vec2& x) const {
  return slope_at({inner, outer}, middle, x);
}

/// chi = 1 within a quarter of the radius: the wider the ring, the smaller grad chi and the loads.
std::shared_ptr<const CutOffRing> CutOffDisc::ring(Nuclei fields) const {
  constexpr double share = 0.25;
  return std::make_shared<const CutOffRing>(
      CutOffRing{middle, std::max(share * radius, solid), radius, std::move(fields)});
}

/// The eigenstrain is entered for the region of the middle alone, as the disc lies in one material. `start` is the
/// angle of the crack, on which G jumps.
DualProblem local_dual(const Model& m, const Nucleus& G, const CutOffDisc& disc, std::shared_ptr<const CutOffRing> ring,
                       std::size_t field) {
  const Fade fade{ring->inner, ring->outer};
  DualProblem dual{unloaded(m), {}, coarse_in(m, disc, fade), std::move(ring), field};
  const Vec2 middle = disc.middle;
  dual.loads.body = [G, fade, middle](const Vec2& x) -> Vec2 {
    const Vec2 slope = slope_at(fade, middle, x);
    return slope.isZero(0) ? Vec2(Vec2::Zero()) : Vec2(G.stress(x) * slope);
  };
  const auto strain = [G, fade, middle](const Vec2& x) -> Mat2 {
    const Vec2 slope = slope_at(fade, middle, x);
    if (slope.isZero(0)) return Mat2::Zero();
    const Vec2 u = G.displacement(x);
    return -0.5 * (slope * u.transpose() + u * slope.transpose());
  };
  const Index where = locate(m.mesh, {&disc.middle, 1}).front();
  const std::size_t place = static_cast<std::size_t>(region_of(m.mesh, where) + 1);
  dual.loads.eigenstrain.resize(place + 1);
  dual.loads.eigenstrain[place] = {[strain](const Vec2& x) -> Vec2 { return strain(x).diagonal(); },
                                   [strain](const Vec2& x) -> Vec2 {
                                     return {strain(x)(0, 1), 0};
                                   },
                                   false};
  FadingField fading{G, middle, fade, std::atan2(disc.along.y(), disc.along.x()), disc.rough};
  if (disc.tip) fading.start = std::atan2(disc.tip->frame(1, 0), disc.tip->frame(0, 0)) - pi;
  if (m.scene.body) dual.known = work_of_body(m.scene.body, fading);
  if (disc.tip)
    if (const BoundaryField& p = m.scene.laws[disc.tip->crack].pressure)
      dual.known = dual.known + work_of_pressure(p, fading, disc.tip->frame.col(0));
  return dual;
}

namespace {

/// A boundary, an interface, or a crack with faces.
bool ends_material(const Model& m, Index e) {
  const auto [left, right] = m.mesh.sides[e];
  const Index crack = m.mesh.crack[e];
  const bool face = crack != none && m.scene.laws[crack].kind != CrackLaw::Kind::Bonded;
  return left == none || right == none || face || is_interface(m.mesh, e);
}

/// To the next of these.
double clearance(const Model& m, const Vec2& x) {
  double least = infinity;
  for (Index e = 0; e < static_cast<Index>(m.mesh.edges.size()); ++e)
    if (ends_material(m, e))
      least = std::min(least,
                       distance(x, m.mesh.points[m.mesh.edges[e][0]], m.mesh.points[m.mesh.edges[e][1]]) - bulge(m, e));
  return std::max(least, 0.0);
}

}  // namespace

bool is_plain(const Scene& s) {
  return s.regions.empty() && !s.body && !has_eigenstrain(s);
}

double room_of_tip(const Model& m, const CrackTip& tip) {
  return std::min(tip.room, clear_of_arcs(m, tip.at));
}

std::string no_disc(const Model& m, Index triangle) {
  const Material& material = material_of(m.mesh, m.scene, triangle);
  if (!isotropic(material)) return "no bounds: the material there is orthotropic";
  if (eigenstrain_of(m.mesh, m.scene, triangle)) return "no bounds: there is an eigenstrain";
  return {};
}

Mesh labelled(Mesh mesh) {
  const Index rest = 1 + *std::max_element(mesh.label.begin(), mesh.label.end());
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    if (mesh.label[e] == none && (mesh.sides[e][0] == none || mesh.sides[e][1] == none)) mesh.label[e] = rest;
  return mesh;
}

namespace {

Nucleus nucleus(const Material& m, const StressPlace& place, PointStress part) {
  if (place.radius > 0) return disc_nucleus(m, place.from, place.radius, part);
  return place.from == place.to ? point_nucleus(m, place.from, part) : line_nucleus(m, place.from, place.to, part);
}

Nuclei nuclei(const Material& m, const StressPlace& place) {
  if (place.reach() == 0) return point_nuclei(m, place.from);
  std::array<Nucleus, Nuclei::most> each;
  for (int i = 0; i < Nuclei::most; ++i) each[i] = nucleus(m, place, static_cast<PointStress>(i));
  return {[each](const Vec2& x, std::array<NucleusValue, Nuclei::most>& values) {
    for (int i = 0; i < Nuclei::most; ++i) values[i] = {each[i].displacement(x), each[i].stress(x)};
  }};
}

/// How much of the disc that G does not fade in leaves room for the ring beyond.
/// The stress of G grows like 1/r at the ends of a line: chi begins to fall at 1.2 times their distance from the
/// middle.
double solid_part(const StressPlace& place) {
  constexpr double beyond_ends = 1.2;  // of a line, where the stress of G is not bounded
  return (place.radius > 0 ? 1 : beyond_ends) * place.reach();
}

}  // namespace

StressPlace StressPlace::of(const OverDisc& disc) {
  if (!(disc.radius > 0)) throw std::invalid_argument("mean_stress: the radius must be positive");
  return {disc.center, disc.center, disc.radius};
}

StressPlace StressPlace::of(const AlongLine& line) {
  if (line.from == line.to) throw std::invalid_argument("mean_stress: the line has no length");
  return {line.from, line.to, 0};
}

StressDual::StressDual(const Model& m, const StressPlace& place)
    : m_(m), place_(place), plain_(is_plain(m.scene)), disc_{.middle = place.middle()} {
  where_ = locate(m.mesh, {&disc_.middle, 1}).front();
  if (where_ == none) {
    why_ = place.reach() > 0 ? "no bounds: its middle lies outside the body"
                             : "no bounds: the point lies outside the body";
    return;
  }
  if (!plain_) disc_.radius = within * std::min(clearance(m, disc_.middle), clear_of_arcs(m, disc_.middle));
  if (place.reach() > 0) {
    disc_.rough = place.reach();
    disc_.solid = solid_part(place);
    disc_.along = place.from == place.to ? Vec2(Vec2::UnitX()) : Vec2(place.to - place.from);
  }
  why_ = why_not();
  if (!plain_ && why_.empty()) ring_ = disc_.ring(nuclei(material_of(m.mesh, m.scene, where_), place_));
}

/// A disc or a line must be clear of all that ends the material; `least` leaves a fifth of the radius for chi to fall.
std::string StressDual::why_not() const {
  if (!isotropic(material_of(m_.mesh, m_.scene, where_))) return "no bounds: the material there is orthotropic";
  if (place_.reach() > 0) {
    for (Index e = 0; e < static_cast<Index>(m_.mesh.edges.size()); ++e)
      if (ends_material(m_, e) &&
          gap(place_, m_.mesh.points[m_.mesh.edges[e][0]], m_.mesh.points[m_.mesh.edges[e][1]]) - bulge(m_, e) <=
              place_.radius)
        return "no bounds: it touches the boundary, a crack or another material";
  }
  if (plain_) return {};
  if (std::string why = no_disc(m_, where_); !why.empty()) return why;
  if (!(disc_.radius > 0)) return "no bounds: the singular field has no room to fade beside a curved triangle";
  constexpr double least = 0.8;  // of the radius in which the field may fade
  return disc_.solid <= least * disc_.radius
             ? std::string()
             : std::string(
                   "no bounds: the singular field has no room to fade between it and the next boundary, crack "
                   "or material");
}

DualProblem StressDual::operator()(PointStress part) const {
  const Nucleus G = nucleus(material_of(m_.mesh, m_.scene, where_), place_, part);
  return plain_ ? global_dual(m_, G, place_, none) : local_dual(m_, G, disc_, ring_, static_cast<std::size_t>(part));
}

DualProblem work_dual(const Model& m, const std::vector<Traction>& of) {
  DualProblem dual{unloaded(m), {}, {}};
  dual.loads.tractions.insert(dual.loads.tractions.end(), of.begin(), of.end());
  return dual;
}

/// Q = l(u) with the loads of the state itself, and supports at rest: their motion is no part of the work of the loads.
DualProblem loads_dual(const Model& m) {
  DualProblem dual{with_all_edges(m), {}, {}};
  dual.loads.eigenstrain.clear();
  for (Support& support : dual.loads.supports) support.value = nothing;
  return dual;
}

/// a(u, u) = l(u) then, so that l(u) = -2 Pi(u) [theory: N.8, B.23].
bool works_twice_its_energy(const Model& m) {
  return !has_eigenstrain(m.scene) &&
         std::ranges::all_of(m.inner->skeleton.prescribed, [](double u) { return u == 0; });
}

namespace {

bool listed(const std::vector<Index>& labels, Index label) {
  return std::ranges::find(labels, label) != labels.end();
}

/// The displacements d.v = value of a vertex that supports prescribe.
/// square = sum d d', right = sum value d: the least squares problem of all directions that are held at a vertex.
struct Prescribed {
  Mat2 square = Mat2::Zero();
  Vec2 right = Vec2::Zero();
  double values = 0;
  void add(const Vec2& d, double value) {
    square += d * d.transpose();
    right += value * d;
    values += value * value;
  }
  /// Least squares: the part of `values` that the range of sum d d' meets, against all of it. The rest is not met by
  /// any v.
  bool contradict() const {
    constexpr double rounding = 1e-9;
    const Eigen::SelfAdjointEigenSolver<Mat2> held(square);
    double met = 0;
    for (int i = 0; i < 2; ++i)
      if (const double d = held.eigenvalues()[i]; d > rounding)
        met += std::pow(held.eigenvectors().col(i).dot(right), 2) / d;
    return values - met > rounding;
  }
};

}  // namespace

// A displacement that is 1 on these labels and 0 on others that they touch has no finite energy.
std::string no_reaction(const Model& m, const std::vector<Index>& labels, int component) {
  std::vector<Prescribed> at(m.mesh.points.size());
  bool any = false;
  for (const Support& s : m.scene.supports) {
    const bool mine = listed(labels, s.label);
    for (Index e = 0; e < static_cast<Index>(m.mesh.edges.size()); ++e) {
      if (m.mesh.label[e] != s.label) continue;
      const Vec2 n = outward_normal(m.mesh, e), first = s.normal_frame ? n : Vec2(Vec2::UnitX()),
                 second = s.normal_frame ? quarter_turn(n) : Vec2(Vec2::UnitY());
      for (const auto& [held, d] : {std::pair(s.first, first), std::pair(s.second, second)}) {
        if (!held) continue;
        const double value = mine ? d[component] : 0;
        any = any || std::abs(value) > 1e-9;
        for (const Index v : m.mesh.edges[e]) at[static_cast<std::size_t>(v)].add(d, value);
      }
    }
  }
  if (!any) return "no bounds: no support holds it in that direction";
  for (std::size_t v = 0; v < at.size(); ++v)
    if (at[v].contradict())
      return fmt::format(
          "no bounds: at ({:.6g}, {:.6g}) it meets another support that holds the same direction, and the force is not "
          "divided between them",
          m.mesh.points[v].x(), m.mesh.points[v].y());
  return {};
}

/// The support moves by -e_i: Q = e_i . int sigma n over the components that are held.
DualProblem reaction_dual(const Model& m, const std::vector<Index>& labels, int component) {
  DualProblem dual{unloaded(m), {}, {}};
  for (Support& support : dual.loads.supports)
    if (listed(labels, support.label))
      support.value = [as = support, component](const Vec2&, const Vec2& n) -> Vec2 {
        return components_of(as, -Vec2::Unit(component), n);
      };
  return dual;
}

/// An edge that any of the duals loads has data in every state: shapes of the data must agree to be added up
/// (cross_energy.cpp).
Scene with_all_edges(const Model& m) {
  const Scene rest = unloaded(m);
  Scene s = m.scene;             // what is known of its data stays known
  s.tractions = rest.tractions;  // in the order of the labels first, as those of duals
  s.tractions.insert(s.tractions.end(), m.scene.tractions.begin(), m.scene.tractions.end());
  for (std::size_t c = 0; c < s.laws.size(); ++c)
    if (!s.laws[c].pressure) s.laws[c].pressure = rest.laws[c].pressure;
  return s;
}

/// The state's own tractions stay entries of their own, with what is known of them; values of supports and pressures
/// are added up to functions of which nothing is known (sampled_in_sums in contact_quantity.cpp).
Scene superposed(const Scene& u, const Scene& w, double k) {
  Scene s = u;
  s.body = sum(u.body, k, w.body);
  s.eigenstrain.resize(std::max(u.eigenstrain.size(), w.eigenstrain.size()));
  for (std::size_t i = 0; i < w.eigenstrain.size(); ++i) {
    Eigenstrain& e = s.eigenstrain[i];
    e.normal = sum(e.normal, k, w.eigenstrain[i].normal);
    e.shear = sum(e.shear, k, w.eigenstrain[i].shear);
  }
  for (const Traction& t : w.tractions) s.tractions.push_back({t.label, sum({}, k, t.value)});
  for (std::size_t i = 0; i < s.supports.size(); ++i)
    s.supports[i].value = sum(u.supports[i].value, k, w.supports[i].value);
  for (std::size_t c = 0; c < s.laws.size(); ++c) s.laws[c].pressure = sum(u.laws[c].pressure, k, w.laws[c].pressure);
  return s;
}

}  // namespace kerf
