// Intervals of quantities that are linear in the state, without contact: stresses at a point, over a disc or along a
// line, K and G at tips, works of tractions, forces of supports. For the dual w of a quantity (solver/bounds/dual.cpp)
// and any k > 0
//   Q = known + l,   -2 k l = Pi(u + k w) - Pi(u - k w)      [theory: B.12],
// and both energies have two sides by the admissible fields of u and w; their difference is bilinear in them, so that
// each state is solved and made admissible once (cross_energy.cpp). Duals of all quantities that are asked for go into
// one list, and batches of them are solved and bounded together [theory: B.30] where that is possible, else one by one.
// What follows from several intervals (components, von Mises, G = (K_I^2 + K_II^2)/E') is interval arithmetic. Bodies
// whose cracks may be in contact go to contact_quantity.cpp. docs/theory/bounds.md, "Stresses at points, K and G".

#include "kerf/adaptive.hpp"
#include "kerf/bounds.hpp"

#include "geometry/plane.hpp"
#include "solver/bounds/admissible.hpp"
#include "solver/bounds/bounded.hpp"
#include "solver/bounds/curved.hpp"
#include "solver/bounds/dual.hpp"
#include "solver/bounds/lane_bounds.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <optional>
#include <span>

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
/// A ray from just behind the mouth to beyond the body: if it meets the boundary again, the body lies on the cut of G.
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

/// Superposition asks for a linear problem: nothing one-sided, no friction.
std::string no_quantity_because(const Model& m) {
  if (!m.inner->semicoercive.empty()) return "no bounds: a piece of the body is held by contact alone";
  for (const CrackLaw& law : m.scene.laws) {
    if (has_gap(law)) return "no bounds: the faces of a crack are apart before loading";
    if (has_friction(law)) return "no bounds: with friction the solution does not minimize an energy";
    if (is_unilateral(law)) return "no bounds: a crack may be in contact";
  }
  return {};
}

}  // namespace

namespace {

/// A state with the loads of duals beside its own, and its admissible fields.
/// The model has data on every edge that a dual may load (with_all_edges), which changes nothing of the state.
struct LoadedState {
  Model m;
  AdmissiblePair pair;
  LoadedState(Model loaded, const Field& u, int inside) : m(std::move(loaded)), pair(admissible(m, u, inside)) {}
};

}  // namespace

/// Everything that is made of u alone is kept for the next quantity; hence the mutable members. Not for several
/// threads.
struct QuantityBounds::Impl {
  Model m;  // all of its boundary labelled
  const Field& u;
  bool with_indicators;
  std::string why;                                 // nothing can be bounded
  std::unique_ptr<ContactQuantityBounds> contact;  // where a crack may be in contact
  // Of u, as duals that reach everywhere need it, and as those that are cut off do.
  mutable std::array<std::unique_ptr<const LoadedState>, 2> own{};

  // The same for batches; and the body at rest, which duals that are cut off load in their rings alone.
  mutable std::array<std::unique_ptr<const LaneOwn>, 2> in_modes{};
  mutable std::unique_ptr<const Model> resting{};
  mutable LaneRoom room{};

  /// The degree that fits the data of both.
  /// Both states of a pair must have polynomials of the same degree and the same rules, so that their products are sums
  /// over the same points.
  int inside(bool cut_off) const {
    // Nothing holds it: loads that are sampled on arcs are balanced by a body force.
    const bool balanced = !m.inner->floating.empty() && !m.mesh.arc.empty();
    return std::max(degree_inside(m, cut_off || m.scene.body || balanced, cut_off), m.inner->data.strain.degree);
  }

  const AdmissiblePair& admissible_state(bool cut_off) const {
    std::unique_ptr<const LoadedState>& a = own[cut_off ? 1 : 0];
    if (!a) a = std::make_unique<const LoadedState>(with_loads(m, with_all_edges(m)), u, inside(cut_off));
    return a->pair;
  }

  /// The pair of u is made for the degree that cut-off duals need, or for the others: at most two of them.
  BoundedDual bound(const DualProblem& of) const {
    const bool cut_off = static_cast<bool>(of.loads.body);
    const AdmissiblePair& mine = admissible_state(cut_off);
    if (!std::isfinite(mine.bounds.upper - mine.bounds.lower)) return {lost(mine.bounds.note), {}};
    const Model dual = with_loads(m, of.loads);
    const State w = solve(dual);
    Eigen::VectorXd eta;
    if (with_indicators) eta = error_indicator(dual, w).eta;
    return {interval(of, cross_energy(mine, admissible(dual, w, inside(cut_off)))), std::move(eta)};
  }

  /// Guaranteed if the energies are, if the work of the data on G is enclosed, and if the loads of the dual are
  /// resolved.
  static Bounded interval(const DualProblem& of, const CrossEnergy& cross) {
    if (!std::isfinite(cross.half)) return lost(cross.note);
    if (!std::isfinite(of.known.error)) return lost(not_integrated);
    Bounded b;
    b.value = of.known.value + cross.middle;
    b.lower = b.value - cross.half - of.known.error;
    b.upper = b.value + cross.half + of.known.error;
    const bool resolved = is_resolved(of.known, b.upper - b.lower);
    b.guaranteed = cross.guaranteed && resolved && of.estimate.empty();
    if (!b.guaranteed) b.note = !cross.guaranteed ? cross.note : !resolved ? std::string(work_sampled) : of.estimate;
    return b;
  }

  /// What the loads of the dual push that nothing holds is no quantity.
  template <typename Bounding>
  static BoundedDual tried(const Bounding& bounding) {
    try {
      return bounding();
    } catch (const Error& error) {
      return {lost(std::string("no bounds: ") + error.what()), {}};
    }
  }

  /// All of them, in batches of which one pass over the triangles serves every dual.
  /// Batches are possible on straight meshes without eigenstrain in u and without indicators, for models that
  /// can_solve_together. A dual whose tractions are balanced by a body force (`loads_alone`) is bounded alone.
  std::vector<BoundedDual> bound_all(const std::vector<DualProblem>& duals) const {
    std::vector<BoundedDual> all(duals.size());
    const bool together = duals.size() > 1 && !with_indicators && !has_eigenstrain(m.scene) && m.mesh.arc.empty() &&
                          can_solve_together(m);
    std::array<std::vector<Batched>, 2> batched;  // that reach everywhere, that are cut off
    for (std::size_t i = 0; i < duals.size(); ++i)
      all[i] = tried([&]() -> BoundedDual {
        const bool cut_off = static_cast<bool>(duals[i].loads.body);
        if (!together || (cut_off && !duals[i].ring)) return bound(duals[i]);
        if (cut_off) {
          batched[1].push_back({i, {}});
          return {};
        }
        Model loaded = loads_alone(m, duals[i].loads);
        if (loaded.scene.body) return bound(duals[i]);
        batched[0].push_back({i, std::move(loaded)});
        return {};
      });
    for (const bool cut_off : {false, true}) {
      const std::vector<Batched>& of = batched[cut_off ? 1 : 0];
      for (std::size_t first = 0; first < of.size(); first += lanes)
        bound_together(duals, {&of[first], std::min<std::size_t>(lanes, of.size() - first)}, cut_off, all);
    }
    return all;
  }

  Bounded try_bound(const std::function<DualProblem()>& dual) const {
    if (!why.empty()) return lost(why);
    return bound_all({dual()}).front().interval;
  }

 private:
  struct Batched {
    std::size_t place;            // among the duals
    std::optional<Model> loaded;  // none: cut off
  };

  const Model& body_at_rest() const {
    if (!resting) resting = std::make_unique<const Model>(loads_alone(m, unloaded(m)));
    return *resting;
  }

  const LaneOwn& own_in_modes(bool cut_off) const {
    std::unique_ptr<const LaneOwn>& of = in_modes[cut_off ? 1 : 0];
    if (!of) of = std::make_unique<const LaneOwn>(admissible_state(cut_off), cut_off);
    return *of;
  }

  /// Those of a ring are sampled together.
  /// Neighbours in the list that share a ring are sampled in one call: their fields have the same places.
  std::vector<LaneDual> lane_duals(const std::vector<DualProblem>& duals, std::span<const Batched> batch,
                                   bool cut_off) const {
    std::vector<LaneDual> all;
    if (!cut_off) {
      for (const Batched& b : batch) all.push_back({&*b.loaded, edge_data(*b.loaded), {}, b.loaded->inner->system.F});
      return all;
    }
    const std::vector<EdgeData> data = edge_data(body_at_rest());
    for (std::size_t first = 0; first < batch.size();) {
      const std::shared_ptr<const CutOffRing>& ring = duals[batch[first].place].ring;
      std::vector<std::size_t> fields;
      for (; first < batch.size() && duals[batch[first].place].ring == ring; ++first)
        fields.push_back(duals[batch[first].place].field);
      for (RingLoads& loads : ring_loads(body_at_rest(), *ring, fields))
        all.push_back({&body_at_rest(), data, std::move(loads)});
    }
    return all;
  }

  /// If the solutions of a batch are not precise enough all of it is bounded one by one, and so is a single dual whose
  /// balance is poor: what the batch saves is time, never precision.
  void bound_together(const std::vector<DualProblem>& duals, std::span<const Batched> batch, bool cut_off,
                      std::vector<BoundedDual>& all) const {
    const AdmissiblePair& mine = admissible_state(cut_off);
    if (!std::isfinite(mine.bounds.upper - mine.bounds.lower)) {
      for (const Batched& b : batch) all[b.place].interval = lost(mine.bounds.note);
      return;
    }
    std::vector<LaneDual> together = lane_duals(duals, batch, cut_off);
    const bool assembled =
        std::ranges::all_of(together, [](LaneDual& d) { return !d.ring || (!d.ring->open && assemble_ring(d)); });
    const LaneRings rings(together, static_cast<Index>(m.mesh.triangles.size()));
    if (!assembled || !solve_together(m, together, rings, room.states)) {
      for (const Batched& b : batch) all[b.place] = tried([&] { return bound(duals[b.place]); });
      return;
    }
    const std::vector<std::optional<CrossEnergy>> crossed =
        cross_energies(own_in_modes(cut_off), together, rings, room);
    for (std::size_t i = 0; i < batch.size(); ++i) {
      const DualProblem& dual = duals[batch[i].place];
      BoundedDual& to = all[batch[i].place];
      if (crossed[i])
        to.interval = interval(dual, *crossed[i]);
      else
        to = tried([&] { return bound(dual); });
    }
  }
};

namespace {

/// A tip of a crack that is one arc of a circle from tip to tip, its edges those of the arc; nothing for others.
/// `rounding`: of centers and radii relative to the radius; the two semi-axes are orthogonal and as long as each other.
std::optional<ArcTip> arc_of_tip(const Mesh& mesh, const CrackTip& tip, const std::vector<CrackTip>& tips) {
  const auto other =
      std::ranges::find_if(tips, [&](const CrackTip& t) { return t.crack == tip.crack && t.at_start != tip.at_start; });
  const std::vector<CrackEdge>& edges = mesh.cracks[tip.crack];
  if (other == tips.end() || mesh.arc.empty() || edges.size() < 2) return std::nullopt;
  const auto arc = [&](const CrackEdge& e) {
    return mesh.arc[e.edge] == none ? nullptr : &mesh.arcs[mesh.arc[e.edge]];
  };
  const Arc* first = arc(edges.front());
  if (!first) return std::nullopt;
  constexpr double rounding = 1e-9;
  const Mat2& axes = first->axes;
  const double radius = axes.col(0).norm();
  const bool round = std::abs(axes.col(0).dot(axes.col(1))) < rounding * radius * radius &&
                     std::abs(axes.col(1).norm() - radius) < rounding * radius;
  const bool alike = std::ranges::all_of(edges, [&](const CrackEdge& e) {
    const Arc* own = arc(e);
    return own && (own->center - first->center).norm() < rounding * radius &&
           (own->axes - axes).norm() < rounding * radius;
  });
  if (!round || !alike) return std::nullopt;
  const auto& [a, b] = mesh.edges[edges[edges.size() / 2].edge];
  const Vec2& x = mesh.points[a];
  const Vec2 inside =
      (x - tip.at).norm() > rounding * radius && (x - other->at).norm() > rounding * radius ? x : mesh.points[b];
  return ArcTip{first->center, tip.at, other->at, inside, tip.frame};
}

}  // namespace

QuantityBounds::QuantityBounds(const Model& m, const State& u, bool with_indicators)
    : impl_(std::make_unique<Impl>(Impl{m, u, with_indicators, no_quantity_because(m), {}})) {
  if (has_contact(m.scene)) impl_->contact = std::make_unique<ContactQuantityBounds>(m, u);
  if (impl_->why.empty()) impl_->m.mesh = labelled(std::move(impl_->m.mesh));
}
QuantityBounds::~QuantityBounds() = default;

StressBounds QuantityBounds::stress(const Vec2& x) const {
  return std::move(all({.points = {x}}).points.front());
}

StressBounds QuantityBounds::mean_stress(const OverDisc& d) const {
  return std::move(all({.discs = {d}}).discs.front());
}

StressBounds QuantityBounds::mean_stress(const AlongLine& line) const {
  return std::move(all({.lines = {line}}).lines.front());
}

TipBounds QuantityBounds::tip(const TipIntensity& of) const {
  return std::move(all({.tips = {of}}).tips.front());
}

Bounded QuantityBounds::work(const std::vector<Traction>& of) const {
  return std::move(all({.works = {of}}).works.front());
}

Bounded QuantityBounds::reaction(const std::vector<Index>& labels, int component) const {
  return std::move(all({.reactions = {{labels, component}}}).reactions.front());
}

Bounded QuantityBounds::work_of_loads() const {
  if (impl_->contact) return impl_->contact->work_of_loads();
  if (!impl_->why.empty()) return lost(impl_->why);
  if (works_twice_its_energy(impl_->m)) return twice_energy(impl_->admissible_state(false).bounds);
  return impl_->try_bound([&] { return loads_dual(impl_->m); });
}

Bounded twice_energy(const EnergyBounds& e) {
  return {-e.lower - e.upper, -2 * e.upper, -2 * e.lower, e.guaranteed, e.note};
}

StressDuals stress_duals(const Model& m, const StressPlace& x, std::string why) {
  const StressDual at(m, x);
  if (why.empty()) why = at.why();
  if (!why.empty()) return {std::move(why), {}};
  return {{}, {at(PointStress::Trace), at(PointStress::Difference), at(PointStress::Shear)}};
}

/// s11 = trace/2 - difference, s22 = trace/2 + difference.
StressBounds stress_of(const StressDuals& of, std::span<const BoundedDual> bounded) {
  if (!of.why.empty()) return {lost(of.why), lost(of.why), lost(of.why), lost(of.why), lost(of.why)};
  StressBounds s;
  s.trace = bounded[0].interval, s.difference = bounded[1].interval, s.s12 = bounded[2].interval;
  s.s11 = combined(s.trace, 0.5, s.difference, -1);
  s.s22 = combined(s.trace, 0.5, s.difference, 1);
  for (const BoundedDual& b : bounded)
    if (b.eta.size() > 0) s.eta.push_back(b.eta);
  return s;
}

/// eps = dev s/(2 mu) + c (tr s) I: eps11 = c tr s - difference/(2 mu), eps12 = s12/(2 mu) [theory: N.4].
StrainBounds strain_bounds(const Material& m, const StressBounds& s) {
  const double shape = 0.5 / m.mu;
  return {combined(s.trace, m.c, s.difference, -shape), combined(s.trace, m.c, s.difference, shape),
          combined(s.s12, shape, s.s12, 0)};
}

// 4 mu c = 1 - 2 nu in plane strain.
// s_vM^2 = s^2 t^2 + 3 (difference^2 + s12^2), as |dev s|^2 = 2 (difference^2 + s12^2), with s of [theory: B.26]. The
// interval is that of independent intervals of the three parts.
Bounded von_mises_bounds(const Material& m, bool plane_strain, const StressBounds& s) {
  const double share = std::pow(plane_strain ? 2 * m.mu * m.c : 0.5, 2);
  const Interval trace = squared(s.trace), difference = squared(s.difference), shear = squared(s.s12);
  Bounded b = combined(combined(s.trace, 1, s.difference, 1), 1, s.s12, 1);  // what they say of themselves
  b.lower = std::sqrt(share * trace.low + 3 * (difference.low + shear.low));
  b.upper = std::sqrt(share * trace.high + 3 * (difference.high + shear.high));
  b.value = 0.5 * (b.lower + b.upper);
  return b;
}

namespace {

struct TipDuals {
  std::string why;  // there are none
  double modulus = 0;
  std::vector<DualProblem> duals = {};
};

/// The polynomials of the edges are not the arc, whose faces alone G leaves free: the work between them is an error.
TipDuals arc_tip_duals(const Model& m, const Field& u, const ArcTip& tip, Index crack) {
  if (!isotropic(m.scene.material)) return {"no bounds: the material is orthotropic"};
  const auto dual = [&](int mode) {
    const Nucleus G = arc_tip_nucleus(m.scene.material, tip, mode);
    DualProblem problem = global_dual(m, G, StressPlace::point(tip.tip), crack);
    problem.known.error += beyond_crack(m, u, crack, G);
    return problem;
  };
  return {{}, plane_modulus(m.scene.material), {dual(1), dual(2)}};
}

/// Two fields G: reaching through the whole body from a straight crack that is not loaded, in a plain body, or cut off
/// in the disc of the tip. With its other tip inside, the field that has no dislocation is taken; a crack that starts
/// on the boundary takes the one of an infinite crack, which jumps on the line behind its mouth.
TipDuals tip_duals(const Model& m, const Field& u, const TipIntensity& of) {
  if (m.scene.laws[of.crack].kind == CrackLaw::Kind::Bonded) return {"no bounds: the crack is bonded"};
  const std::vector<CrackTip> tips = find_tips(m.mesh);
  const auto found =
      std::ranges::find_if(tips, [&](const CrackTip& t) { return t.crack == of.crack && t.at_start == of.at_start; });
  if (found == tips.end()) return {"no bounds: that end of the crack is no tip"};
  if (found->on_border) return {"no bounds: the tip lies on the border of a region"};
  if (found->curved) {
    const std::optional<ArcTip> arc = is_plain(m.scene) ? arc_of_tip(m.mesh, *found, tips) : std::nullopt;
    if (!arc || has_pressure(m.scene.laws[of.crack]))
      return {"no bounds: the crack is curved, and no free arc of a circle on a mesh that follows it"};
    return arc_tip_duals(m, u, *arc, of.crack);
  }
  const Index where = m.mesh.sides[found->edges.front()][0];
  const Material& material = material_of(m.mesh, m.scene, where);
  const bool inside = std::ranges::count_if(tips, [&](const CrackTip&t) { return t.crack == of.crack; }) == 2,
             straight = found->edges.size() == m.mesh.cracks[of.crack].size(),
             plain = is_plain(m.scene) && straight && !has_pressure(m.scene.laws[of.crack]) &&
                     (inside || !behind_mouth(m.mesh, *found));
  if (std::string why = plain ? std::string() : no_disc(m, where); !why.empty()) return {std::move(why)};
  if (!isotropic(material)) return {"no bounds: the material is orthotropic"};
  const double room = room_of_tip(m, *found);
  if (!(plain || room > 0)) return {"no bounds: a curved triangle is at the tip"};
  const CutOffDisc disc{found->at, within * room, &*found};
  const double length = inside && plain ? found->vertices.back().norm() : infinity;
  const std::shared_ptr<const CutOffRing> ring =
      plain ? nullptr : disc.ring(tip_nuclei(material, found->at, found->frame));
  const auto dual = [&](int mode) {
    const Nucleus G = tip_nucleus(material, found->at, found->frame, length, mode);
    return plain ? global_dual(m, G, StressPlace::point(found->at), of.crack)
                 : local_dual(m, G, disc, ring, static_cast<std::size_t>(mode - 1));
  };
  return {{}, plane_modulus(material), {dual(1), dual(2)}};
}

/// Squares of intervals may lose what K_I and K_II have in common; it is a bound either way.
TipBounds tip_of(const TipDuals& of, std::span<const BoundedDual> bounded) {
  if (!of.why.empty()) return {lost(of.why), lost(of.why), lost(of.why)};
  TipBounds b;
  b.K_I = bounded[0].interval, b.K_II = bounded[1].interval;
  for (const BoundedDual& mode : bounded)
    if (mode.eta.size() > 0) b.eta.push_back(mode.eta);
  const Interval first = squared(b.K_I), second = squared(b.K_II);
  b.G = combined(b.K_I, 1, b.K_II, 1);
  b.G.lower = (first.low + second.low) / of.modulus;
  b.G.upper = (first.high + second.high) / of.modulus;
  b.G.value = 0.5 * (b.G.lower + b.G.upper);
  return b;
}

/// Duals of several quantities in one list, and what is made of the intervals of each.
/// The order of the duals is that of the requests, so that batches are the same for the same requests.
class Collection {
 public:
  /// `take`: from the intervals of these.
  void add(std::vector<DualProblem> duals, std::function<void(std::span<const BoundedDual>)> take) {
    quantities_.push_back({duals_.size(), duals.size(), std::move(take)});
    std::ranges::move(duals, std::back_inserter(duals_));
  }
  template <typename Bound>
  void bound_by(const Bound& bound) const {
    const std::vector<BoundedDual> bounded = bound(duals_);
    for (const Quantity& q : quantities_) q.take(std::span(bounded).subspan(q.first, q.count));
  }

 private:
  struct Quantity {
    std::size_t first, count;
    std::function<void(std::span<const BoundedDual>)> take;
  };
  std::vector<DualProblem> duals_;
  std::vector<Quantity> quantities_;
};

/// One by one.
QuantityIntervals intervals_in_contact(const ContactQuantityBounds& bounds, const std::string& no_tips,
                                       const QuantityRequest& request) {
  QuantityIntervals all;
  all.tips.assign(request.tips.size(), {lost(no_tips), lost(no_tips), lost(no_tips)});
  for (const Vec2& x : request.points) all.points.push_back(bounds.stress(x));
  for (const OverDisc& d : request.discs) all.discs.push_back(bounds.mean_stress(d));
  for (const AlongLine& line : request.lines) all.lines.push_back(bounds.mean_stress(line));
  for (const std::vector<Traction>& of : request.works) all.works.push_back(bounds.work(of));
  for (const QuantityRequest::Reaction& r : request.reactions)
    all.reactions.push_back(bounds.reaction(r.labels, r.component));
  return all;
}

}  // namespace

/// Callbacks keep references to places in `out`: each list has its final size before the first one into it is made.
QuantityIntervals QuantityBounds::all(const QuantityRequest& request) const {
  const std::string& why = impl_->why;
  if (impl_->contact) return intervals_in_contact(*impl_->contact, why, request);
  const Model& m = impl_->m;
  QuantityIntervals out;
  Collection collection;
  const auto stresses = [&](const auto& places, std::vector<StressBounds>& to, const auto& place_of) {
    to.resize(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      StressDuals of = stress_duals(m, place_of(places[i]), why);
      std::vector<DualProblem> duals = std::move(of.duals);
      collection.add(std::move(duals),
                     [&to, i, of = StressDuals{of.why, {}}](const auto& b) { to[i] = stress_of(of, b); });
    }
  };
  stresses(request.points, out.points, [](const Vec2& x) { return StressPlace::point(x); });
  stresses(request.discs, out.discs, [](const OverDisc& d) { return StressPlace::of(d); });
  stresses(request.lines, out.lines, [](const AlongLine& line) { return StressPlace::of(line); });
  out.tips.resize(request.tips.size());
  for (std::size_t i = 0; i < request.tips.size(); ++i) {
    TipDuals of = why.empty() ? tip_duals(m, impl_->u, request.tips[i]) : TipDuals{why};
    std::vector<DualProblem> duals = std::move(of.duals);
    collection.add(std::move(duals),
                   [&out, i, of = TipDuals{of.why, of.modulus}](const auto& b) { out.tips[i] = tip_of(of, b); });
  }
  const auto single = [&](std::string none_there, const auto& dual, Bounded& to) {
    if (!none_there.empty())
      to = lost(std::move(none_there));
    else
      collection.add({dual()}, [&to](const auto& b) { to = b[0].interval; });
  };
  out.works.resize(request.works.size());
  for (std::size_t i = 0; i < request.works.size(); ++i)
    single(
        why, [&] { return work_dual(m, request.works[i]); }, out.works[i]);
  out.reactions.resize(request.reactions.size());
  for (std::size_t i = 0; i < request.reactions.size(); ++i) {
    const auto& [labels, component] = request.reactions[i];
    std::string none_there = no_reaction(m, labels, component);
    single(
        none_there.empty() ? why : none_there, [&] { return reaction_dual(m, labels, component); }, out.reactions[i]);
  }
  collection.bound_by([&](const std::vector<DualProblem>& duals) { return impl_->bound_all(duals); });
  return out;
}

}  // namespace kerf
