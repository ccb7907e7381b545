// Validation of an expansion at points: the change is made at finite radii, and differences of J are compared with area
// times T. 1. The body is solved on the mesh of the case; points are chosen where none are given. 2. Points in batches
// whose balls keep apart: a mesh with nested polygons of 64 sides around each, one factor, and the difference problem
// per radius [theory: V.1, V.2]. Slits are solved twice per radius, bonded and in contact. 3. The series of radii is
// judged [theory: V.7, V.8, V.10] and withdrawn where it has not begun [theory: V.11]. 4. What it says is compared with
// one radius drawn into the body on another mesh, first a coarse, then a fine one [theory: V.9]. 5. "Fails" is kept
// only where radii ten times smaller say it again. A verdict is about a point and its radii. Derived in
// docs/theory/validation.md.

#include "kerf/validate.hpp"

#include "geometry/plane.hpp"
#include "kerf/adaptive.hpp"
#include "kerf/stop.hpp"
#include "topo/analysis.hpp"
#include "topo/functional/tip.hpp"
#include "topo/map/fields.hpp"
#include "topo/map/green.hpp"
#include "topo/map/jumps.hpp"
#include "topo/map/mask.hpp"
#include "topo/map/point.hpp"
#include "topo/orthotropic.hpp"
#include "topo/validate/batch.hpp"
#include "topo/validate/center.hpp"
#include "topo/validate/changed_scene.hpp"
#include "topo/validate/chosen.hpp"
#include "topo/validate/drawn.hpp"
#include "topo/validate/sites.hpp"
#include "topo/validate/slit_limit.hpp"
#include "topo/validate/verdict.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace kerf {

namespace {

constexpr int around = 64;  // edges around a ball and a hole
// Relative error of D that the polygon and the mesh around it leave, whatever the radius; measured.
double plateau_of(const Element& e, const Perturbation& p) {
  const double round = e.order == 1 ? 4e-3 : 3e-4;
  return round * aspect(p);
}

// Largest radius first, each once.
ValidationRequest checked(ValidationRequest r, double size) {
  std::sort(r.radii.begin(), r.radii.end(), std::greater<>());
  r.radii.erase(std::unique(r.radii.begin(), r.radii.end()), r.radii.end());
  if (r.radii.empty() || !(r.radii.back() > 0))
    throw Error(Fault::Usage, "validation needs positive radii; give radii in [validate]");
  // The order divides by the logarithm of the ratio of two radii.
  constexpr double least = 1e-6, apart = 1.05;
  if (r.radii.back() < least * size)
    throw Error(Fault::Usage, fmt::format("radius {:.3g} of the validation is too small for a mesh: use {:.2g} or more",
                                          r.radii.back(), least * size));
  for (std::size_t i = 0; i + 1 < r.radii.size(); ++i)
    if (r.radii[i] < apart * r.radii[i + 1])
      throw Error(
          Fault::Usage,
          fmt::format("radii {:.6g} and {:.6g} of the validation lie too close together: each should be {} times "
                      "the next or more",
                      r.radii[i], r.radii[i + 1], apart));
  constexpr double longest = 10;
  if (aspect(r.perturbation) > longest)
    throw Error(Fault::Usage,
                fmt::format("validation resolves ellipses of aspect {} at most, not {:g}; the map goes further",
                            longest, r.perturbation.aspect));
  return r;
}

// Nothing computed yet.
Validation blank(const Vec2& at, const std::vector<double>& radii) {
  Validation v;
  v.at = at;
  for (const double radius : radii)
    v.rows.push_back({.radius = radius, .J = nan, .difference = nan, .predicted = nan, .remainder = nan, .order = nan});
  return v;
}

void no_radius_fits(const Site& s, Validation& v) {
  v.coefficient = v.order = v.intercept = v.c2 = v.c3 = nan;
  v.verdict = Verdict::OutOfRange;
  v.reason = s.clear > 0 ? fmt::format(
                               "no radius fits: the nearest boundary, crack, jump of the data or other feature is "
                               "{:.3g} away; use radii below {:.3g}",
                               s.clear, 0.25 * s.clear)
             : s.inside
                 ? "the point lies on a boundary, a crack or a jump of the data, or in the ring of the functional"
                 : "the point lies outside the body";
}

// Of what J could change by if nothing in its derivative cancelled, what its rounding is at most, many times over: a
// crack that stays closed, say, has no opening to change.
// Row by row of the interior: coefficients of stresses and of displacements have different units.
double faint_change(const Analysis& a) {
  constexpr double faint = 1e-10;
  const Sensitivity& d = a.derivative;
  const Field& s = *a.state;
  double sum = 0;
  if (d.skeleton.size() > 0) sum += d.skeleton.lpNorm<1>() * s.skeleton.lpNorm<Eigen::Infinity>();
  if (d.force.size() > 0) sum += d.force.lpNorm<1>() * s.force.lpNorm<Eigen::Infinity>();
  for (Eigen::Index k = 0; k < d.interior.rows(); ++k)
    sum += d.interior.row(k).lpNorm<1>() * s.interior.row(k).lpNorm<Eigen::Infinity>();
  return faint * sum;
}

// J of stresses to a power from 4 on is infinite where a crack that may move has a tip under its weight.
std::optional<std::string> infinite(const Functional& j, const Shape& shape, const Scene& scene) {
  constexpr double integrable = 4;
  for (const Term& term : j.terms) {
    if (!(term.stress_power >= integrable)) continue;
    for (std::size_t c = 0; c < shape.cracks.size(); ++c) {
      if (scene.laws[c].kind == CrackLaw::Kind::Bonded) continue;
      const std::vector<Vec2> points =
          shape.cracks[c].arc ? points_on(*shape.cracks[c].arc, 2) : shape.cracks[c].points;
      if (points.front() == points.back()) continue;  // closed: no tips
      for (const Vec2& tip : {points.front(), points.back()}) {
        // Some deviator tells whether the weight lets the tip count.
        const FieldPoint at{.x = tip, .stress = Vec2(1, -1).asDiagonal(), .material = scene.material};
        if (term.density(at).value > 0)
          return fmt::format(
              "the stress to the power {:g} is not integrable at the tips of crack \"{}\": {} is "
              "infinite; give it a weight that vanishes there",
              term.stress_power, shape.cracks[c].name, term.kind);
      }
    }
  }
  return std::nullopt;
}

// One validation of all points: the body as it is, then batch by batch.
class Validating {
 public:
  // `again`: the second time, with smaller radii.
  Validating(const Meshing& meshing, const Element& e, const Scene& scene, const Functional& j,
             const ValidationRequest& request, bool again)
      : again_(again),
        shape_(meshing.shape),
        element_(e),
        scene_(scene),
        j_(j),
        r_(checked(request, extent(meshing.shape))),
        own_(solve_graded(meshing.shape, meshing.sizing, e, scene, {.estimate = false, .threads = request.threads})),
        sizing_(own_.sizing),
        analysis_(analyze(j, own_.model, own_.state)) {
    require_expansion(scene, j, r_.perturbation);
    if (!certified(own_.state)) throw Error(Fault::Numerics, "the body of the validation could not be solved");
    require_supports(j_, own_.model);
    for (const Term& term : j_.terms)
      if (at_closed_tip(term, own_.model, own_.state))
        throw Error(Fault::Usage,
                    "contact closes the tip: K_I is 0, and stays so for small changes of the body, so that there is "
                    "nothing to compare; take mode = \"II\" or \"eq\"");
    jumps_ = jumps_of_data(own_.model, j_);
    if (r_.points.empty()) r_.points = chosen_points({analysis_, j_, r_, shape_});
  }

  // A run that is told to stop keeps the verdicts that are done.
  std::vector<Validation> run() {
    for (const Vec2& at : r_.points) results_.push_back(blank(at, r_.radii));
    if (const auto words = infinite(j_, shape_, scene_)) {
      for (Validation& v : results_) {
        v.coefficient = v.order = v.intercept = v.c2 = v.c3 = nan;
        v.verdict = Verdict::NothingSaid;
        v.reason = *words;
      }
      return std::move(results_);
    }
    const std::vector<std::vector<Site>> batches = place(shape_, j_, r_, jumps_);
    try {
      validate_all(batches);
    } catch (const Stopped&) {
      name_undone(batches);
    }
    return std::move(results_);
  }

 private:
  void validate_all(const std::vector<std::vector<Site>>& batches) {
    find_angles();
    for (const std::vector<Site>& batch : batches) {
      std::vector<Site> usable;
      for (const Site& s : batch)
        if (s.radii.empty())
          no_radius_fits(s, results_[s.number]);
        else
          usable.push_back(s);
      if (usable.empty()) {
        ++done_;
        continue;
      }
      if (row(r_.perturbation).becomes == Becomes::Slit)
        for (const Site& s : usable) validate_slit(s);
      else
        validate_batch(usable);
      if (!again_) {
        draw(usable);
        for (const Site& s : usable) say_again(s);
      }
      ++done_;
    }
  }

  // "Fails" is said where radii ten times smaller say it, too, of the same sign.
  void say_again(const Site& site) {
    Validation& v = results_[site.number];
    if (v.verdict != Verdict::Fails) return;
    // T fits, the second term does not: its share is less at smaller radii, which cannot tell.
    if (std::abs(v.intercept - v.coefficient) <= v.plateau * std::abs(v.coefficient)) return;
    constexpr double smaller = 0.1;
    ValidationRequest request = r_;
    request.points = {site.at};
    request.radii.clear();
    for (const double radius : site.radii) request.radii.push_back(smaller * radius);
    if (is_directed(r_.perturbation)) request.perturbation.angle = angle_[site.number];
    Validation second;
    try {
      second = Validating({shape_, sizing_}, element_, scene_, j_, request, true).run()[0];
    } catch (const Error& e) {
      second = {.verdict = Verdict::NothingSaid, .reason = e.what()};
    }
    // What is wrong: the limit of the series, or its second term.
    const auto apart = [&](const Validation& of) {
      return of.drawn.apart == 0 ? of.c2 - of.c2_predicted : of.drawn.apart;
    };
    if (second.verdict == Verdict::Fails && apart(second) * apart(v) > 0) {
      v.reason += "; radii ten times smaller say it again";
      return;
    }
    v.verdict = second.verdict == Verdict::Holds ? Verdict::OutOfRange : Verdict::NothingSaid;
    v.reason = second.verdict == Verdict::Holds
                   ? fmt::format("the radii are too large: {}; with radii ten times smaller the expansion holds: {}",
                                 v.reason, second.reason)
                   : fmt::format("{}; radii ten times smaller do not say it again: {}", v.reason, second.reason);
  }

  /// Of a batch that was not done to its end nothing is said: its verdict might have been another one.
  void name_undone(const std::vector<std::vector<Site>>& batches) {
    for (std::size_t b = done_; b < batches.size(); ++b)
      for (const Site& s : batches[b]) {
        Validation& v = results_[s.number];
        v = blank(v.at, r_.radii);
        v.coefficient = v.order = v.intercept = v.c2 = v.c3 = nan;
        v.verdict = Verdict::NothingSaid;
        v.reason = "stopped before this point was done";
      }
  }

  // What orients a perturbation must be known before it is meshed: from the mesh without balls.
  void find_angles() {
    angle_.assign(r_.points.size(), 0);
    if (!has_series(r_.perturbation)) return;
    const std::vector<MapPoint> map = map_at(analysis_, j_, {.perturbation = r_.perturbation}, r_.points);
    for (std::size_t i = 0; i < angle_.size(); ++i) {
      angle_[i] = map[i].angle;
      results_[i].on_mesh = map[i].value;
    }
  }

  // Where the series holds or fails: one radius again, on another mesh. Where a coarse one does not agree that it
  // holds, a fine one is asked.
  void draw(const std::vector<Site>& sites) {
    std::vector<Change> changes;
    for (const Site& s : sites)
      if (const Validation& v = results_[s.number]; v.verdict == Verdict::Holds || v.verdict == Verdict::Fails)
        changes.push_back({s, v.drawn.radius, angle_[s.number]});
    const std::vector<double> lengths = drawn_lengths(element_);
    for (std::size_t i = 0; i < lengths.size() && !changes.empty(); ++i) {
      std::vector<Validation> before;
      for (const Change& c : changes) before.push_back(results_[c.site.number]);
      draw_on(lengths[i], changes);
      if (i + 1 == lengths.size()) return;
      std::vector<Change> open;
      for (std::size_t k = 0; k < changes.size(); ++k)
        if (Validation& v = results_[changes[k].site.number];
            before[k].verdict == Verdict::Holds && v.verdict != Verdict::Holds) {
          v = before[k];
          open.push_back(changes[k]);
        }
      changes = std::move(open);
    }
  }

  // What cannot be drawn or solved says nothing: the series alone does not hold.
  void draw_on(double longer, const std::vector<Change>& changes) {
    std::vector<Redrawn> drawn;
    try {
      drawn = draw_changes({shape_, sizing_, own_.model, own_.state, j_, r_.perturbation, longer, r_.scenes}, changes);
    } catch (const Error& e) {
      for (const Change& c : changes) {
        results_[c.site.number].verdict = Verdict::NothingSaid;
        results_[c.site.number].reason = fmt::format("the change could not be solved on another mesh: {}", e.what());
      }
      return;
    }
    for (std::size_t i = 0; i < changes.size(); ++i) compare(changes[i], drawn[i]);
  }

  // A J of stresses that two meshes tell differently may be infinite, whatever its differences say.
  void compare(const Change& c, const Redrawn& d) {
    Validation& v = results_[c.site.number];
    const bool clamped = !has_series(r_.perturbation);
    if (clamped) v.on_mesh = clamped_at(analysis_, j_, c.radius, std::span(&c.site.at, 1))[0];
    v.drawn.difference = d.J - d.J0;
    v.drawn.coefficient = d.coefficient;
    conclude(v, d.area, clamped);
    constexpr double apart = 0.05;
    const bool stress = std::any_of(j_.terms.begin(), j_.terms.end(), [](const Term& t) { return t.uses_stress; });
    if (!stress || std::abs(d.J0 - analysis_.value) <= apart * std::abs(d.J0)) return;
    v.verdict = Verdict::NothingSaid;
    v.reason = fmt::format("J itself is {:.4g} on one mesh and {:.4g} on a better one: it may be infinite",
                           analysis_.value, d.J0);
  }

  // One mesh, one factor and one analysis; T at each center and the differences of each radius.
  void validate_batch(const std::vector<Site>& sites) {
    const Batch batch = mesh_batch({shape_, sizing_}, sites, around, {aspect(r_.perturbation), angle_});
    const SolvedBatch solved(batch, {element_, scene_, r_.threads, &r_.scenes}, j_, r_.perturbation);
    const Analysis& a = solved.a;
    const Filled& f = batch.filled;
    SecondOrders on_series(a, j_, r_.perturbation);
    const double faint = faint_change(a) / (has_series(r_.perturbation) ? area(*a.model) : 1);
    for (std::size_t s = 0; s < sites.size(); ++s) {
      const Site& site = sites[s];
      Validation& v = results_[site.number];
      v.coefficient = nan;
      v.size = faint;
      if (has_series(r_.perturbation)) {
        read_center(a, {f.first_triangle[s], f.first_triangle[s + 1], site.at, site.ball}, v);
        read_second(on_series, site, v);
      }
      v.plateau = plateau_of(element_, r_.perturbation);
      judge_series(site, fill_rows(a, site, batch.balls[s], solved.differences[s], v), on_series);
    }
  }

  void read_center(const Analysis& a, const BallIn& ball, Validation& v) const {
    Center::Value found = Center(*a.model, ball).value({a, j_, r_.perturbation});
    v.coefficient = found.coefficient;
    v.modes = std::move(found.modes);
    v.size = std::max(v.size, found.size);
    double parts = 0;
    for (const Mode& m : v.modes) parts += std::abs(m.value);
    v.size = std::max(v.size, parts);
  }

  // Of the same body on two meshes: their difference is what a mesh leaves of c2.
  void read_second(SecondOrders& on_series, const Site& site, Validation& v) {
    const SecondOrder found = on_series.at(site.at);
    v.logarithm = found.logarithm;
    v.c3 = found.c3;
    if (!found.available) return;
    v.c2_predicted = found.c2;
    v.c2_on_mesh = second().at(site.at).c2;
  }
  // Of the body on the mesh of the case.
  SecondOrders& second() {
    if (!second_) second_.emplace(analysis_, j_, r_.perturbation);
    return *second_;
  }

  // An inclusion of the same material changes nothing, and rounding is no verdict. What does not hold is asked whether
  // the radii are beyond the series.
  void judge_series(const Site& site, const std::vector<double>& scales, SecondOrders& on_series) {
    Validation& v = results_[site.number];
    judge(v, r_.perturbation, scales, site.clear);
    if (is_same_material(site)) {
      v.verdict = Verdict::Vanishes;
      v.reason = "the inclusion is made of what lies there: nothing changes";
      return;
    }
    if (has_series(r_.perturbation) && v.verdict != Verdict::Holds && v.verdict != Verdict::Vanishes)
      withdraw(v, on_series.answer_radius(site.at), site.clear);
  }

  bool is_same_material(const Site& site) const {
    if (row(r_.perturbation).becomes != Becomes::Material) return false;
    const Index t = locate(own_.model.mesh, {&site.at, 1})[0];
    if (t == none) return false;
    const Material &here = material_of(own_.model.mesh, scene_, t), &inside = r_.perturbation.inclusion;
    constexpr double rounding = 1e-14;
    return isotropic(here) && isotropic(inside) && std::abs(here.mu - inside.mu) <= rounding * here.mu &&
           std::abs(here.c - inside.c) <= rounding * here.c;
  }

  // Returns f(eps) of the rows, with the exact areas of the polygons.
  std::vector<double> fill_rows(const Analysis& a, const Site& site, const BallMesh& ball,
                                const std::vector<Difference>& found, Validation& v) const {
    std::vector<double> scales(v.rows.size(), nan);
    for (std::size_t k = 0, row = 0; k < site.radii.size(); ++k) {
      // Rows of radii that do not fit stay blank.
      while (v.rows[row].radius != site.radii[k]) ++row;
      ValidationRow& to = v.rows[row];
      scales[row] = ball.enclosed_area[k + 1];
      to.difference = found[k].value;
      to.J = a.value + found[k].value;
      to.same_contact = found[k].same_contact;
      to.predicted = scales[row] * v.coefficient;
      if (has_series(r_.perturbation)) continue;
      const ClampedChange change = clamped_change(a, j_, to.radius, site.at);
      to.predicted = change.value;
      to.size = change.size;
    }
    return scales;
  }

  // A slit changes the mesh inside the ball with its length: two whole solves per radius, the crack bonded and in
  // contact, on the same mesh. Where tips make J converge slowly, those on half as many sides tell the limit, and once
  // those on a quarter how well it is known: it is as far at every radius.
  void validate_slit(const Site& site) {
    Validation& v = results_[site.number];
    constexpr int sides = 2 * around;
    v.plateau = 5e-4;
    const bool slow = slow_at_tips(j_);
    std::vector<Mesh> outside;  // of balls with ever fewer sides
    for (int n = sides; n >= (slow ? sides / 4 : sides); n /= 2)
      outside.push_back(triangulate(with_balls(shape_, {site}, n), sizing_));
    std::vector<double> scales(v.rows.size(), nan);
    bool first = true;
    for (std::size_t row = 0; row < v.rows.size(); ++row) {
      ValidationRow& to = v.rows[row];
      if (std::find(site.radii.begin(), site.radii.end(), to.radius) == site.radii.end()) continue;
      std::vector<std::vector<double>> change;
      for (std::size_t k = 0; k < outside.size() && (k < 2 || first); ++k)
        change.push_back(solve_slit(site, outside[k], sides >> k, k == 0 ? &v : nullptr, to));
      if (slow) {
        const double limit = limit_of_changes(j_, change[0], change[1]);
        if (first) v.plateau = std::max(v.plateau, std::abs(limit_of_changes(j_, change[1], change[2]) / limit - 1));
        to.J += limit - to.difference;
        to.difference = limit;
      }
      first = false;
      scales[row] = scale(r_.perturbation, to.radius);
    }
    for (std::size_t row = 0; row < v.rows.size(); ++row) v.rows[row].predicted = scales[row] * v.coefficient;
    v.logarithm = second().at(site.at).logarithm;
    judge_series(site, scales, second());
  }

  // What a slit of that radius does to every term, on a ball of n sides; its row, and with `v` what is known of T.
  std::vector<double> solve_slit(const Site& site, const Mesh& outside, int n, Validation* v, ValidationRow& to) const {
    const Filled f = fill(outside, {slit_mesh({site.at, site.ball, n}, to.radius, angle_[site.number])});
    const Scene cracked =
        changed_scene(scene_, none, r_.perturbation, r_.scenes, {none, site.at, to.radius, angle_[site.number]});
    Scene bonded = cracked;
    bonded.laws.back() = {.kind = CrackLaw::Kind::Bonded};
    const auto prepared = [&](const Scene& scene) { return prepare(f.mesh, element_, scene, r_.threads); };
    const auto solved = [](const Model& m) {
      State s = solve(m);
      if (!certified(s)) throw Error(Fault::Numerics, "the body with the small crack could not be solved");
      return s;
    };
    const Model whole = prepared(bonded), broken = prepared(cracked);
    const Field before = solved(whole), after = solved(broken);
    const Analysis a = analyze(j_, whole, before, !v), slit = analyze(j_, broken, after, true);
    const std::vector<double> change = changes_of_terms(j_, a, slit);
    if (!v) return change;
    v->size = faint_change(a) / area(whole);
    read_center(a, {f.first_triangle[0], f.first_triangle[1], site.at, site.ball}, *v);
    to.J = slit.value;
    to.difference = slit.value - a.value;
    to.same_contact = true;
    return change;
  }

  const bool again_;  // the second time, at smaller radii: the series alone
  const Shape& shape_;
  const Element& element_;
  const Scene& scene_;
  const Functional& j_;
  ValidationRequest r_;
  const Adapted own_;  // the body on the mesh of the case
  const Sizing sizing_;
  const Analysis analysis_;
  std::vector<double> angle_;  // per point
  Segments jumps_;
  std::optional<SecondOrders> second_;
  std::size_t done_ = 0;  // batches
  std::vector<Validation> results_;
};

}  // namespace

std::vector<Validation> validate(const Meshing& meshing, const Element& e, const Scene& scene, const Functional& j,
                                 const ValidationRequest& request) {
  return Validating(meshing, e, scene, j, request, false).run();
}

}  // namespace kerf
