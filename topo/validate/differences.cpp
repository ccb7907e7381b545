// J of a body changed at finite radius less J, term by term, from the change w of the state [theory: V.5, V.6].
// Energies are exact in terms of w. Of other functionals
//   J_eps - J = int_outside (j'(z) w + [j(z + w) - j(z) - j'(z) w])
//             + int_ring (j(z + w) - j(z)) - int_disc j(z) [+ j*(z + w)],
// the part outside the balls by topo/validate/far_field.cpp, with the derivative exactly; in the ring of the ball the
// difference of the densities at the points of the rule; in the disc what is lost and what a new content has. Powers of
// an integral change by I^q expm1(q log1p(dI/I)), which keeps the digits of small dI. Derived in
// docs/theory/validation.md, section "The difference problem".

#include "topo/validate/differences.hpp"

#include "topo/analysis.hpp"
#include "topo/validate/ball_fields.hpp"
#include "topo/validate/changed_scene.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

bool sees_fields(const Term& term) {
  return term.uses_stress || term.uses_displacement || term.uses_rotation;
}

// factor ((I + d)^power - I^power), `value` = I^power.
double change_of_power(const Term& term, double value, double d) {
  if (term.power == 1) return term.factor * d;
  const double before = std::pow(value, 1 / term.power);
  // A norm of nothing: its change is the power of the change itself.
  if (before == 0) return term.factor * std::pow(std::max(d, 0.0), term.power);
  return term.factor * value * std::expm1(term.power * std::log1p(d / before));
}

}  // namespace

// One radius, and what its change is inside the ball.
struct Differences::Changed {
  const ChangedBall& of;
  const Field& near;
  std::vector<bool> ring;          // the ball without the disc
  std::optional<InnerState> disc;  // where fields are asked for and another material fills it
};

namespace {

// Of what fills the discs of inclusions: the same material everywhere, with the eigenstrain that it has at each ball.
// Each ball asks for the scene of its own change, as its tables may give another eigenstrain to each place.
Scene filling(const BallsInBody& in, const Perturbation& p, const ScenesOfChanges& drawn) {
  const Model& m = *in.a.model;
  Scene inside = m.scene;
  if (row(p).becomes != Becomes::Material) return inside;
  inside.eigenstrain.assign(inside.regions.size() + 1, {});
  for (std::size_t ball = 0; ball + 1 < in.filled.first_triangle.size(); ++ball) {
    const Index t = in.filled.first_triangle[ball], region = region_of(m.mesh, t);
    const Scene with =
        changed_scene(m.scene, none, p, drawn,
                      {.region = region, .center = centroid(m.mesh, t), .radius = std::sqrt(area(m.mesh, t))});
    inside.material = with.regions.back();
    if (with.eigenstrain.size() == with.regions.size() + 1)
      inside.eigenstrain[static_cast<std::size_t>(region + 1)] = with.eigenstrain.back();
  }
  std::ranges::fill(inside.regions, inside.material);
  return inside;
}

}  // namespace

Differences::Differences(const BallsInBody& in, const Perturbation& p, const Preparation& how,
                         const ScenesOfChanges& drawn)
    : in_(in), setting_(*in.a.model, p, filling(in, p, drawn)), self_adjoint_(has_self_adjoint_work(*in.a.model)) {
  for (const Term& term : in.j.terms) {
    const bool constant = term.density && !sees_fields(term);
    fields_ = fields_ || !(term.energy || term.measured || (term.work && self_adjoint_) || constant);
  }
  bodies_.emplace_back(*in.a.model, *in.a.state, how);
  if (in.a.measured) bodies_.emplace_back(*in.a.measured_model, *in.a.measured, how);
}

// A ball's triangles are consecutive in the mesh, and its boundary rows among those kept.
BallInMesh Differences::ball(std::size_t number, const BallMesh& mesh) const {
  const auto& contours = in_.filled.contour[number];
  return {.number = number,
          .mesh = mesh,
          .contours = contours,
          .first = in_.filled.first_triangle[number],
          .end = in_.filled.first_triangle[number + 1],
          .triangles = setting_.whole.triangles.size(),
          .unknowns = static_cast<Eigen::Index>(contours[0].size()) * in_.a.model->inner->skeleton.per_edge};
}

// Balls one after the other with their radii in parallel; far fields of all of them at once.
std::vector<std::vector<Difference>> Differences::all(const std::vector<BallMesh>& balls) {
  std::vector<std::vector<ChangedBall>> changed;
  for (std::size_t b = 0; b < balls.size(); ++b) changed.push_back(solve_ball(setting_, ball(b, balls[b]), bodies_));
  if (fields_) far_ = far_field(in_, bodies_[0], changed);
  std::vector<std::vector<Difference>> results;
  for (std::size_t b = 0; b < balls.size(); ++b) {
    auto& of_ball = results.emplace_back();
    Field near;  // the change inside the ball; every radius overwrites the ring that it uses
    if (fields_)
      near.interior.setZero(interior_count(in_.a.model->element),
                            static_cast<Eigen::Index>(setting_.whole.triangles.size()));
    for (const ChangedBall& of : changed[b]) of_ball.push_back(finish(ball(b, balls[b]), of, near));
  }
  return results;
}

// Skeleton and forces of contact of the change everywhere, from the columns of the far field; interiors in the ring
// alone.
void Differences::fill_near(const ChangedBall& of, Field& near) const {
  const Skeleton& skeleton = in_.a.model->inner->skeleton;
  const Ordering& o = bodies_[0].operators().inner->ordering;
  const BallChange& c = of.changes[0];
  near.skeleton.setZero(skeleton.total);
  near.force.setZero(skeleton.total);
  for (Index u = 0; u < skeleton.total; ++u) {
    if (o.row[u] == none) continue;
    near.skeleton[u] = far_.rows(o.row[u], of.column);
    if (const Index trailing = o.row[u] - o.leading(); trailing >= 0) near.force[u] = c.push[trailing];
  }
  Eigen::VectorXd edges(c.ball.size() + c.contour.size());
  edges << c.ball, c.contour;
  add_fields(near, *of.annulus, complete(*of.annulus, edges, false), setting_.kernel, setting_.scene);
}

// Fields are made only where some term sees them: energies have their change already.
Difference Differences::finish(const BallInMesh& ball, const ChangedBall& of, Field& near) const {
  Changed c{of, near, std::vector<bool>(of.disc.size(), false), {}};
  for (Index t = ball.first; t < ball.end; ++t) c.ring[t] = !of.disc[t];
  if (fields_) {
    fill_near(of, near);
    if (of.inner) {
      const Eigen::VectorXd before = on_edges(in_.a.model->inner->skeleton, of.contour, in_.a.state->skeleton);
      c.disc.emplace(
          inner_state(*of.inner, setting_.kernel, setting_.inner_scene, before + of.changes[0].contour, setting_.body));
    }
  }
  Difference result{.same_contact = of.same_contact};
  for (std::size_t i = 0; i < in_.j.terms.size(); ++i)
    result.value += change_of_power(in_.j.terms[i], in_.a.term_value[i], change(i, c));
  return result;
}

// Of the integral of a term.
double Differences::change(std::size_t i, const Changed& c) const {
  const Term& term = in_.j.terms[i];
  if (term.energy) return c.of.energy[0];
  if (term.measured) return c.of.energy[1] - c.of.energy[0];
  if (term.work && self_adjoint_) return -2 * c.of.energy[0];
  double d = fields_ ? change_of_fields(i, c) : 0;
  if (!term.density) return d;
  const Model& m = *in_.a.model;
  d -= integral_over(term, m, *in_.a.state, c.of.disc);
  if (c.disc)
    d += integral(term, c.disc->model, c.disc->state);
  else if (setting_.becomes == Becomes::Material)
    d += integral_over(term, m, *in_.a.state, c.of.disc);  // constant densities stay
  return d;
}

// Outside the disc, where the body stays.
double Differences::change_of_fields(std::size_t i, const Changed& c) const {
  const Term& term = in_.j.terms[i];
  const Model& m = *in_.a.model;
  const Field& s = *in_.a.state;
  double d = c.of.far[static_cast<Eigen::Index>(i)];
  if (term.work) {
    d += far_.derivative[i].skeleton.dot(c.near.skeleton);
    d += work_difference(m, s, c.near, {c.of.disc, c.ring}, c.disc ? &*c.disc : nullptr);
  } else {
    d += surface_difference(term, m, s, c.near);
    d += domain_difference(term, m, s, c.near, c.ring);
  }
  return d;
}

}  // namespace kerf
