#include "kerf/bounds.hpp"

#include "geometry/plane.hpp"
#include "solver/nucleus.hpp"
#include "solver/post/crack_tip.hpp"
#include "solver/quadrature.hpp"
#include "solver/system.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

Vec2 turned(const Vec2& n) {
  return {-n.y(), n.x()};
}

// In the components of a support.
Vec2 components_of(const Support& support, const Vec2& u, const Vec2& n) {
  return support.normal_frame ? Vec2(n.dot(u), turned(n).dot(u)) : u;
}

BoundaryField sum(const BoundaryField& a, double factor, const BoundaryField& b) {
  if (!a) return [factor, b](const Vec2& x, const Vec2& n) -> Vec2 { return factor * b(x, n); };
  return [a, factor, b](const Vec2& x, const Vec2& n) -> Vec2 { return a(x, n) + factor * b(x, n); };
}

/// Every edge of the boundary has a label, so that it can be loaded.
Mesh labelled(Mesh mesh) {
  const Index rest = 1 + *std::max_element(mesh.label.begin(), mesh.label.end());
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    if (mesh.label[e] == none && (mesh.sides[e][0] == none || mesh.sides[e][1] == none)) mesh.label[e] = rest;
  return mesh;
}

/// The loads of w: what makes G + w free of tractions, and at rest on supports.
Scene counter(const Model& m, const Nucleus& G, Index own) {
  Scene s;
  s.material = m.scene.material;
  s.regions = m.scene.regions;
  s.laws = m.scene.laws;
  for (std::size_t c = 0; c < s.laws.size(); ++c) {
    s.laws[c].pressure = {};
    if (s.laws[c].kind == CrackLaw::Kind::Bonded || static_cast<Index>(c) == own) continue;
    s.laws[c].pressure = [G](const Vec2& x, const Vec2& n) -> Vec2 {
      const Vec2 t = G.stress(x) * n;
      return {n.dot(t), turned(n).dot(t)};
    };
  }
  const Index labels = 1 + *std::max_element(m.mesh.label.begin(), m.mesh.label.end());
  for (Index label = 0; label < labels; ++label)
    s.tractions.push_back({label, [G](const Vec2& x, const Vec2& n) -> Vec2 { return -G.stress(x) * n; }});
  for (Support support : m.scene.supports) {
    const Support as = support;
    support.value = [G, as](const Vec2& x, const Vec2& n) -> Vec2 { return -components_of(as, G.displacement(x), n); };
    s.supports.push_back(support);
  }
  return s;
}

/// The scene of u + k w.
Scene superposed(const Scene& u, const Scene& w, double k) {
  Scene s = u;
  for (const Traction& t : w.tractions) s.tractions.push_back({t.label, sum({}, k, t.value)});
  for (std::size_t i = 0; i < s.supports.size(); ++i)
    s.supports[i].value = sum(u.supports[i].value, k, w.supports[i].value);
  for (std::size_t c = 0; c < s.laws.size(); ++c)
    if (w.laws[c].pressure) s.laws[c].pressure = sum(u.laws[c].pressure, k, w.laws[c].pressure);
  return s;
}

Field superposed(const Field& u, const Field& w, double k) {
  return {u.skeleton + k * w.skeleton, u.interior + k * w.interior, u.force + k * w.force, u.eigenstrain};
}

/// A number and what it may be off by.
struct Known {
  double value = 0, error = 0;
};

/// int t.G over the tractions t of u; the error by halved edges.
Known work_on(const Model& m, const Nucleus& G) {
  static const EdgeRule rule = gauss(12);
  Known known;
  for (const Traction& t : m.scene.tractions)
    for (const Index e : labeled(m.inner->data, t.label)) {
      const EdgeLine line = edge_line(m.mesh, e);
      const auto over = [&](double from, double to) {
        double work = 0;
        for (Eigen::Index q = 0; q < rule.s.size(); ++q) {
          const Vec2 x = line.a + (from + rule.s[q] * (to - from)) * (line.b - line.a);
          work += rule.w[q] * (to - from) * t.value(x, line.n).dot(G.displacement(x));
        }
        return work * length(m.mesh, e);
      };
      const double halved = over(0, 0.5) + over(0.5, 1);
      known.value += halved;
      known.error += std::abs(halved - over(0, 1));
    }
  return known;
}

/// The tractions of G were sampled: they are as smooth as it takes on edges that are not long beside their distance.
std::string unresolved(const Model& m, const std::vector<Vec2>& singular, Index own) {
  constexpr double far = 0.5;  // of the length of an edge
  for (std::size_t e = 0; e < m.mesh.edges.size(); ++e) {
    const Index crack = m.mesh.crack[e];
    const bool outer = m.mesh.sides[e][0] == none || m.mesh.sides[e][1] == none;
    const bool face = crack != none && crack != own && m.scene.laws[crack].kind != CrackLaw::Kind::Bonded;
    if (!outer && !face) continue;
    const Vec2 &a = m.mesh.points[m.mesh.edges[e][0]], &b = m.mesh.points[m.mesh.edges[e][1]];
    for (const Vec2& x : singular)
      if (distance(x, a, b) < far * length(m.mesh, static_cast<Index>(e)))
        return fmt::format(
            "the bounds are estimates: the mesh is coarse on the boundary or the crack beside ({:.6g}, {:.6g})", x.x(),
            x.y());
  }
  return {};
}

Bounded lost(std::string why) {
  return {nan, nan, nan, false, std::move(why)};
}

Bounded combined(const Bounded& a, double fa, const Bounded& b, double fb) {
  Bounded r;
  r.value = fa * a.value + fb * b.value;
  const auto low = [](const Bounded& of, double f) { return f * (f > 0 ? of.lower : of.upper); };
  const auto high = [](const Bounded& of, double f) { return f * (f > 0 ? of.upper : of.lower); };
  r.lower = low(a, fa) + low(b, fb);
  r.upper = high(a, fa) + high(b, fb);
  r.guaranteed = a.guaranteed && b.guaranteed;
  r.note = a.note.empty() ? b.note : a.note;
  return r;
}

/// Of the square of a bounded number.
std::array<double, 2> square(const Bounded& b) {
  const double low = b.lower * b.lower, high = b.upper * b.upper;
  return {b.lower <= 0 && b.upper >= 0 ? 0 : std::min(low, high), std::max(low, high)};
}

/// The field of a crack that starts on the boundary jumps on all of the line behind its mouth, too.
bool behind_mouth(const Mesh& mesh, const CrackTip& tip) {
  const Vec2 back = tip.vertices.back(), way = back.normalized();
  double far = 0;
  for (const Vec2& x : mesh.points) far = std::max(far, (x - tip.at).norm());
  constexpr double beside = 1e-6;
  const Vec2 from = tip.at + tip.frame * (back + beside * back.norm() * way), to = tip.at + tip.frame * (2 * far * way);
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    if (mesh.sides[e][0] == none || mesh.sides[e][1] == none)
      if (crossing(from, to, mesh.points[mesh.edges[e][0]], mesh.points[mesh.edges[e][1]])) return true;
  return false;
}

std::string unavailable(const Model& m) {
  for (const CrackLaw& law : m.scene.laws)
    if (law.kind == CrackLaw::Kind::Unilateral) return "no bounds: a crack may be in contact";
  if (m.scene.body) return "no bounds: there is a body force";
  if (has_eigenstrain(m.scene)) return "no bounds: there is an eigenstrain";
  if (!m.scene.regions.empty()) return "no bounds: there are several materials";
  if (!isotropic(m.scene.material)) return "no bounds: the material is orthotropic";
  return {};
}

}  // namespace

struct QuantityBounds::Impl {
  Model m;  // all of its boundary labelled
  const Field& u;
  EnergyBounds energy;
  std::string why;  // nothing can be bounded

  /// G is singular at `singular`; `own` is the crack whose faces it leaves free.
  Bounded bound(const Nucleus& G, const std::vector<Vec2>& singular, Index own) const {
    if (!why.empty()) return lost(why);
    const Scene counter_scene = counter(m, G, own);
    const Model dual = with_loads(m, counter_scene);
    const State w = solve(dual);
    const EnergyBounds other = energy_bounds(dual, w);
    if (!std::isfinite(other.upper - other.lower)) return lost(other.note);
    const double gap = energy.upper - energy.lower, other_gap = other.upper - other.lower;
    const double k = gap > 0 && other_gap > 0 ? std::sqrt(gap / other_gap) : 1;
    std::array<EnergyBounds, 2> of;
    for (const int side : {0, 1}) {
      const double share = side == 0 ? k : -k;
      const Model model = with_loads(m, superposed(m.scene, dual.scene, share));
      of[side] = energy_bounds(model, superposed(u, w, share));
      if (!std::isfinite(of[side].upper - of[side].lower)) return lost(of[side].note);
    }
    const Known known = work_on(m, G);
    Bounded b;
    b.lower = known.value - known.error - (of[0].upper - of[1].lower) / (2 * k);
    b.upper = known.value + known.error - (of[0].lower - of[1].upper) / (2 * k);
    b.value = 0.5 * (b.lower + b.upper);
    constexpr double negligible = 0.01;
    b.guaranteed = of[0].guaranteed && of[1].guaranteed && known.error <= negligible * (b.upper - b.lower);
    if (!b.guaranteed)
      b.note = !of[0].guaranteed   ? of[0].note
               : !of[1].guaranteed ? of[1].note
                                   : std::string("the bounds are estimates: a traction is not resolved by the mesh");
    if (const std::string coarse = unresolved(m, singular, own); b.guaranteed && !coarse.empty()) {
      b.guaranteed = false;
      b.note = coarse;
    }
    return b;
  }
};

QuantityBounds::QuantityBounds(const Model& m, const Field& u)
    : impl_(std::make_unique<Impl>(Impl{m, u, {}, unavailable(m)})) {
  if (!impl_->why.empty()) return;
  impl_->energy = energy_bounds(m, u);
  if (!std::isfinite(impl_->energy.upper - impl_->energy.lower))
    impl_->why = impl_->energy.note;
  else
    impl_->m.mesh = labelled(std::move(impl_->m.mesh));
}
QuantityBounds::~QuantityBounds() = default;

std::array<Bounded, 3> QuantityBounds::stress(const Vec2& x) const {
  if (locate(impl_->m.mesh, {&x, 1}).front() == none) {
    const Bounded outside = lost("no bounds: the point lies outside the body");
    return {outside, outside, outside};
  }
  const Material& material = impl_->m.scene.material;
  const auto of = [&](PointStress part) { return impl_->bound(point_nucleus(material, x, part), {x}, none); };
  const Bounded trace = of(PointStress::Trace), difference = of(PointStress::Difference);
  return {combined(trace, 0.5, difference, -1), combined(trace, 0.5, difference, 1), of(PointStress::Shear)};
}

std::array<Bounded, 3> QuantityBounds::tip(const TipIntensity& of) const {
  const Model& m = impl_->m;
  const auto all_lost = [](const std::string& why) { return std::array{lost(why), lost(why), lost(why)}; };
  if (m.scene.laws[of.crack].kind == CrackLaw::Kind::Bonded) return all_lost("no bounds: the crack is bonded");
  const std::vector<CrackTip> tips = find_tips(m.mesh);
  const auto found =
      std::ranges::find_if(tips, [&](const CrackTip& t) { return t.crack == of.crack && t.at_start == of.at_start; });
  if (found == tips.end()) return all_lost("no bounds: that end of the crack is no tip");
  if (found->curved || found->edges.size() != m.mesh.cracks[of.crack].size())
    return all_lost("no bounds: the crack is not straight");
  if (has_pressure(m.scene.laws[of.crack])) return all_lost("no bounds: there is a pressure in the crack");
  const bool inside = std::ranges::count_if(tips, [&](const CrackTip& t) { return t.crack == of.crack; }) == 2;
  if (!inside && behind_mouth(m.mesh, *found))
    return all_lost("no bounds: the line of the crack meets the body again behind the mouth of the crack");
  const double length = inside ? found->vertices.back().norm() : infinity;
  const auto bound = [&](int mode) {
    return impl_->bound(tip_nucleus(m.scene.material, found->at, found->frame, length, mode), {found->at}, of.crack);
  };
  const Bounded one = bound(1), two = bound(2);
  const auto first = square(one), second = square(two);
  const double modulus = plane_modulus(m.scene.material);
  Bounded rate = combined(one, 1, two, 1);
  rate.lower = (first[0] + second[0]) / modulus;
  rate.upper = (first[1] + second[1]) / modulus;
  rate.value = 0.5 * (rate.lower + rate.upper);
  return {one, two, rate};
}

}  // namespace kerf
