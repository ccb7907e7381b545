#include "kerf/adaptive.hpp"
#include "kerf/bounds.hpp"

#include "geometry/plane.hpp"
#include "solver/bounds/admissible.hpp"
#include "solver/bounds/bounded.hpp"
#include "solver/bounds/dual.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace kerf {

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

void qualify(Bounded& b, const std::string& why) {
  if (why.empty() || !b.guaranteed) return;
  b.guaranteed = false;
  b.note = why;
}

Interval squared(const Bounded& b) {
  const double low = b.lower * b.lower, high = b.upper * b.upper;
  return {b.lower <= 0 && b.upper >= 0 ? 0 : std::min(low, high), std::max(low, high)};
}

namespace {

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
  if (!m.mesh.arc.empty()) return "no bounds: triangles are curved (mesh.curved)";
  if (!m.inner->standing.empty()) return "no bounds: a piece of the body is held by contact alone";
  for (const CrackLaw& law : m.scene.laws) {
    if (has_gap(law)) return "no bounds: the faces of a crack are apart before loading";
    if (has_friction(law)) return "no bounds: with friction the solution does not minimize an energy";
    if (law.kind == CrackLaw::Kind::Unilateral) return "no bounds: a crack may be in contact";
  }
  return {};
}

}  // namespace

namespace {

/// A state with the loads of duals beside its own, and its admissible fields.
struct LoadedState {
  Model m;
  AdmissiblePair pair;
  LoadedState(Model loaded, const Field& u, int inside) : m(std::move(loaded)), pair(admissible(m, u, inside)) {}
};

}  // namespace

struct QuantityBounds::Impl {
  Model m;  // all of its boundary labelled
  const Field& u;
  bool with_indicators;
  std::string why;                                 // nothing can be bounded
  std::unique_ptr<ContactQuantityBounds> contact;  // where a crack may be in contact
  // Of u, as duals that reach everywhere need it, and as those that are cut off do.
  mutable std::array<std::unique_ptr<const LoadedState>, 2> own{};

  /// The degree that fits the data of both.
  int inside(bool cut_off) const {
    return std::max(degree_inside(m, cut_off || m.scene.body, cut_off), m.inner->data.strain.degree);
  }

  const AdmissiblePair& admissible_state(bool cut_off) const {
    std::unique_ptr<const LoadedState>& a = own[cut_off ? 1 : 0];
    if (!a) a = std::make_unique<const LoadedState>(with_loads(m, with_all_edges(m)), u, inside(cut_off));
    return a->pair;
  }

  /// The indicator of w goes to `eta`.
  Bounded bound(const DualProblem& of, std::vector<Eigen::VectorXd>& eta) const {
    const bool cut_off = static_cast<bool>(of.loads.body);
    const AdmissiblePair& mine = admissible_state(cut_off);
    if (!std::isfinite(mine.bounds.upper - mine.bounds.lower)) return lost(mine.bounds.note);
    const Model dual = with_loads(m, of.loads);
    const State w = solve(dual);
    if (with_indicators) eta.push_back(error_indicator(dual, w).eta);
    const CrossEnergy cross = cross_energy(mine, admissible(dual, w, inside(cut_off)));
    if (!std::isfinite(cross.half)) return lost(cross.note);
    Bounded b;
    b.value = of.known.value + cross.middle;
    b.lower = b.value - cross.half - of.known.error;
    b.upper = b.value + cross.half + of.known.error;
    constexpr double negligible = 0.01;
    const bool resolved = of.known.error <= negligible * (b.upper - b.lower);
    b.guaranteed = cross.guaranteed && resolved && of.estimate.empty();
    if (!b.guaranteed)
      b.note = !cross.guaranteed ? cross.note
               : !resolved       ? std::string("the bounds are estimates: a load is not resolved by the mesh")
                                 : of.estimate;
    return b;
  }

  StressBounds stress(const StressPlace& where) const {
    return bound_stress(m, where, why,
                        [&](const DualProblem& dual, std::vector<Eigen::VectorXd>& eta) { return bound(dual, eta); });
  }

  /// What the loads of the dual push that nothing holds is no quantity.
  Bounded try_bound(const std::function<DualProblem()>& dual) const {
    if (!why.empty()) return lost(why);
    try {
      std::vector<Eigen::VectorXd> eta;
      return bound(dual(), eta);
    } catch (const Error& error) {
      return lost(std::string("no bounds: ") + error.what());
    }
  }
};

QuantityBounds::QuantityBounds(const Model& m, const State& u, bool with_indicators)
    : impl_(std::make_unique<Impl>(Impl{m, u, with_indicators, unavailable(m), {}})) {
  if (std::ranges::any_of(m.scene.laws, [](const CrackLaw& law) { return law.kind == CrackLaw::Kind::Unilateral; }))
    impl_->contact = std::make_unique<ContactQuantityBounds>(m, u);
  if (impl_->why.empty()) impl_->m.mesh = labelled(std::move(impl_->m.mesh));
}
QuantityBounds::~QuantityBounds() = default;

StressBounds QuantityBounds::stress(const Vec2& x) const {
  return impl_->contact ? impl_->contact->stress(x) : impl_->stress(StressPlace::point(x));
}

StressBounds QuantityBounds::mean_stress(const OverDisc& d) const {
  return impl_->contact ? impl_->contact->mean_stress(d) : impl_->stress(StressPlace::of(d));
}

StressBounds QuantityBounds::mean_stress(const AlongLine& line) const {
  return impl_->contact ? impl_->contact->mean_stress(line) : impl_->stress(StressPlace::of(line));
}

Bounded QuantityBounds::work(const std::vector<Traction>& of) const {
  return impl_->contact ? impl_->contact->work(of) : impl_->try_bound([&] { return work_dual(impl_->m, of); });
}

Bounded QuantityBounds::work_of_loads() const {
  if (impl_->contact) return impl_->contact->work_of_loads();
  if (!impl_->why.empty()) return lost(impl_->why);
  if (works_twice_its_energy(impl_->m)) return twice_energy(impl_->admissible_state(false).bounds);
  return impl_->try_bound([&] { return loads_dual(impl_->m); });
}

Bounded QuantityBounds::reaction(const std::vector<Index>& labels, int component) const {
  if (impl_->contact) return impl_->contact->reaction(labels, component);
  if (std::string why = no_reaction(impl_->m, labels, component); !why.empty()) return lost(std::move(why));
  return impl_->try_bound([&] { return reaction_dual(impl_->m, labels, component); });
}

Bounded twice_energy(const EnergyBounds& e) {
  return {-e.lower - e.upper, -2 * e.upper, -2 * e.lower, e.guaranteed, e.note};
}

StressBounds bound_stress(const Model& m, const StressPlace& x, std::string why, const BoundDual& bound) {
  const StressDual at(m, x);
  if (why.empty()) why = at.why();
  if (!why.empty()) return {lost(why), lost(why), lost(why), lost(why), lost(why)};
  StressBounds s;
  s.trace = bound(at(PointStress::Trace), s.eta);
  s.difference = bound(at(PointStress::Difference), s.eta);
  s.s12 = bound(at(PointStress::Shear), s.eta);
  s.s11 = combined(s.trace, 0.5, s.difference, -1);
  s.s22 = combined(s.trace, 0.5, s.difference, 1);
  return s;
}

StrainBounds strain_bounds(const Material& m, const StressBounds& s) {
  const double shape = 0.5 / m.mu;
  return {combined(s.trace, m.c, s.difference, -shape), combined(s.trace, m.c, s.difference, shape),
          combined(s.s12, shape, s.s12, 0)};
}

// 4 mu c = 1 - 2 nu in plane strain.
Bounded von_mises_bounds(const Material& m, bool plane_strain, const StressBounds& s) {
  const double share = std::pow(plane_strain ? 2 * m.mu * m.c : 0.5, 2);
  const Interval trace = squared(s.trace), difference = squared(s.difference), shear = squared(s.s12);
  Bounded b = combined(combined(s.trace, 1, s.difference, 1), 1, s.s12, 1);  // what they say of themselves
  b.lower = std::sqrt(share * trace.low + 3 * (difference.low + shear.low));
  b.upper = std::sqrt(share * trace.high + 3 * (difference.high + shear.high));
  b.value = 0.5 * (b.lower + b.upper);
  return b;
}

TipBounds QuantityBounds::tip(const TipIntensity& of) const {
  const Model& m = impl_->m;
  const auto all_lost = [](const std::string& why) { return TipBounds{lost(why), lost(why), lost(why)}; };
  if (!impl_->why.empty()) return all_lost(impl_->why);
  if (m.scene.laws[of.crack].kind == CrackLaw::Kind::Bonded) return all_lost("no bounds: the crack is bonded");
  const std::vector<CrackTip> tips = find_tips(m.mesh);
  const auto found =
      std::ranges::find_if(tips, [&](const CrackTip& t) { return t.crack == of.crack && t.at_start == of.at_start; });
  if (found == tips.end()) return all_lost("no bounds: that end of the crack is no tip");
  if (found->curved) return all_lost("no bounds: the crack is curved");
  const Index where = m.mesh.sides[found->edges.front()][0];
  const Material& material = material_of(m.mesh, m.scene, where);
  const bool inside = std::ranges::count_if(tips, [&](const CrackTip&t) { return t.crack == of.crack; }) == 2,
             straight = found->edges.size() == m.mesh.cracks[of.crack].size(),
             plain = is_plain(m.scene) && straight && !has_pressure(m.scene.laws[of.crack]) &&
                     (inside || !behind_mouth(m.mesh, *found));
  if (const std::string why = plain ? std::string() : no_disc(m, where); !why.empty()) return all_lost(why);
  if (!isotropic(material)) return all_lost("no bounds: the material is orthotropic");
  const CutOffDisc disc{found->at, within * found->room, &*found};
  const double length = inside && plain ? found->vertices.back().norm() : infinity;
  TipBounds b;
  const auto bound = [&](int mode) {
    const Nucleus G = tip_nucleus(material, found->at, found->frame, length, mode);
    return impl_->bound(plain ? global_dual(m, G, StressPlace::point(found->at), of.crack) : local_dual(m, G, disc),
                        b.eta);
  };
  b.K_I = bound(1);
  b.K_II = bound(2);
  const Interval first = squared(b.K_I), second = squared(b.K_II);
  const double modulus = plane_modulus(material);
  b.G = combined(b.K_I, 1, b.K_II, 1);
  b.G.lower = (first.low + second.low) / modulus;
  b.G.upper = (first.high + second.high) / modulus;
  b.G.value = 0.5 * (b.G.lower + b.G.upper);
  return b;
}

}  // namespace kerf
