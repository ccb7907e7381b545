// The Green tensor of a body and the prediction for a small clamped hole of radius eps, where J changes like
// 1/ln(1/eps) and a leading term alone is off by factors [theory: T.28, T.29, T.30, T.37].
//  G(. - x0) e_j + w_j: Kelvin's field, singular, plus the regular answer of the body, Hreg = w(x0);
//  M F = u(x0),   M = flexibility (kappa ln(1/eps) + 1/2) I + Hreg,   F the force on the clamp;
//  energies change by 1/2 u.F, J linear in the state by -p.F, others by J(u - (G + w) F) - J(u).
// The last is integrated with the triangles around x0 divided until they resolve the singularity. With Coulomb's
// friction the forces on sliding faces change as well and the energy gets 1/2 sum dp_t dj_t. Contact stays as it is in
// the state, so that functionals of a crack that see nothing else are refused where F would close or part its faces. A
// map everywhere interpolates Hreg (topo/map/green_samples.cpp) and is offered where no term needs w itself. Derived in
// docs/theory/topological_derivatives.md, section "Clamped holes".

#include "topo/map/green.hpp"
#include "solver/system.hpp"
#include "solver/tangent_cone.hpp"

#include "topo/map/fields.hpp"

#include "base/parallel.hpp"
#include "kerf/map.hpp"
#include "kerf/recover.hpp"
#include "topo/analysis.hpp"
#include "topo/functional/integrate.hpp"
#include "topo/map/green_of_body.hpp"
#include "topo/map/green_samples.hpp"
#include "topo/map/mask.hpp"
#include "topo/orthotropic.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

// What has no Green tensor here is refused: Kelvin's field knows one isotropic material; a body without supports would
// be held by the hole alone; biactive faces answer one-sidedly, so that w would not be linear in F.
TangentCone cone_of(const Model& m, const Field& s) {
  const auto refuse = [](const char* why) { throw Error(Fault::Usage, std::string("a clamped hole: ") + why); };
  require(m.element, can_clamp_holes);
  require_isotropic(m.scene, "clamped holes");
  if (!m.inner->floating.empty())
    refuse("the supports leave the body a rigid motion, which the hole alone would stop; add a support");
  if (std::any_of(m.mesh.region.begin(), m.mesh.region.end(), [](Index r) { return r != none; }))
    refuse("its Green tensor is known in one material only; leave out the regions, or use a free hole");
  double length = 0, open = 0;
  for (std::size_t c = 0; c < m.mesh.cracks.size(); ++c) {
    if (!is_unilateral(m.scene.laws[c])) continue;
    for (const CrackPoint& p : crack_profile(m, s, static_cast<Index>(c))) {
      length += p.length;
      if (p.status == CrackPoint::Status::Biactive) open += p.length;
    }
  }
  constexpr double few = 0.01;
  if (open > few * length)
    refuse(
        "cracks with neither gap nor pressure respond to it one-sidedly; give them contact = \"open\" or \"bonded\"");
  return tangent_cone(m, s);
}

// Kelvin's field under a force F, with the opposite sign: what the clamp takes away.
FieldPoint minus_kelvin(const Material& m, const Vec2& r, const Vec2& F) {
  FieldPoint p{.x = r};
  p.displacement = -kelvin(m, r) * F;
  p.stress = -kelvin_stress(m, r, 0) * F[0] - kelvin_stress(m, r, 1) * F[1];
  p.rotation = -cross(r, F) / (4 * pi * m.mu * r.squaredNorm());
  return p;
}

// Then forces of friction change while faces slide, and that work is of second order in the force on the clamp.
bool has_coulomb(const Scene& scene) {
  return std::ranges::any_of(scene.laws, [](const CrackLaw& l) { return has_friction(l) && l.friction > 0; });
}

// The opening or the pressure of a crack whose faces may close and part.
bool sees_contact(const Model& m, const Term& t) {
  return t.on_crack && is_unilateral(m.scene.laws[static_cast<std::size_t>(t.crack)]);
}

// The share of a crack where a clamp that takes the displacement u away by the force F, with contact as it was, lets
// faces overlap or pull at each other.
// Overlaps count against the displacement that is taken away, pulls against F spread over the crack.
double share_of_false_contact(const Model& m, const Field& clamped, Index crack, const Vec2& u, const Vec2& F) {
  double whole = 0, wrong = 0;
  const std::vector<CrackPoint> profile = crack_profile(m, clamped, crack);
  for (const CrackPoint& p : profile) whole += p.length;
  constexpr double little = 1e-6;
  for (const CrackPoint& p : profile)
    if (p.distance() < -little * u.norm() || p.contact_pressure() < -little * F.norm() / whole) wrong += p.length;
  return wrong / whole;
}

}  // namespace

// A hole with a series never does. An energy does with Coulomb's friction, where its change takes the field w [theory:
// T.37].
bool needs_points(const Model& m, const Functional& j, const Perturbation& p) {
  const bool coulomb = has_coulomb(m.scene);
  return !has_series(p) && std::ranges::any_of(j.terms, [&](const Term& t) {
    return sees_contact(m, t) || (is_energy(m, t) ? coulomb : !t.linear);
  });
}

GreenTensor::GreenTensor(const Model& m, const Field& s) : model_(m), reply_(m, cone_of(m, s)) {}

namespace {

std::vector<Nucleus> unit_forces(const Material& material, const Vec2& x0) {
  const auto force = [&](int j) -> Nucleus {
    return {[=](const Vec2& x) -> Vec2 { return kelvin(material, x - x0).col(j); },
            [=](const Vec2& x) -> Mat2 { return kelvin_stress(material, x - x0, j); }};
  };
  return {force(0), force(1)};
}

}  // namespace

// All samples at once are read without refinement [theory: T.38]. The first one is solved for wholly as well; where the
// two differ, none of the batch is believed and each is solved for.
std::vector<Mat2> GreenTensor::regular_at(std::span<const Vec2> x, std::span<const Index> t, double enough) {
  std::vector<Mat2> all;
  std::vector<BodyReply::Singularity> many;
  for (std::size_t i = 0; i < x.size(); ++i)
    many.push_back({x[i], t[i], unit_forces(material_of(model_.mesh, model_.scene, t[i]), x[i])});
  std::optional<std::vector<Points>> found = reply_.displacements(many);
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (found && i > 0) {
      all.emplace_back((*found)[i]);
      continue;
    }
    all.push_back(at(x[i], t[i], false, enough).regular);
    constexpr double agree = 1e-6;  // a hundredth of what samples are predicted to, and less
    if (found && !((Mat2((*found)[i]) - all[i]).norm() <= agree * all[i].norm())) found.reset();
  }
  return all;
}

// Column j is the reply to a unit force along axis j; whole fields only where they are asked for.
Green GreenTensor::at(const Vec2& x0, Index t, bool fields, double enough) {
  const std::vector<Nucleus> forces = unit_forces(material_of(model_.mesh, model_.scene, t), x0);
  const std::array<Index, 1> here = {t};
  std::vector<TangentField> replies =
      reply_.to(x0, forces, fields ? std::span<const Index>() : std::span<const Index>(here), enough);
  Green green;
  for (int j = 0; j < 2; ++j) {
    // Samples stop at a residual of 1e-7 (`enough`); above 1e-4 there is no solution.
    TangentField& w = replies[static_cast<std::size_t>(j)];
    constexpr double solved = 1e-4;
    if (!(w.residual < solved))
      throw Error(Fault::Numerics, "a clamped hole: Green's tensor could not be solved for: its residual stays large");
    green.regular.col(j) = displacement_at(model_, w, t, x0, true);
    if (fields) green.field.push_back(std::move(w));
  }
  return green;
}

namespace {

// What the predictions at all points share.
class Clamped {
 public:
  // Sorts the terms of J: energies by their shares; terms linear in the state by one adjoint of their sum; all others
  // are inserted. Where all terms with an adjoint are linear it is the adjoint of the analysis.
  Clamped(const Analysis& a, const Functional& j, double eps) : a_(a), j_(j), eps_(eps) {
    if (!(eps > 0)) throw Error(Fault::Usage, "the map of a clamped hole needs the radius of the hole ([map] radius)");
    Sensitivity linear;
    bool any = false;
    for (std::size_t i = 0; i < j.terms.size(); ++i) {
      const Term& term = j.terms[i];
      if (sees_contact(*a.model, term)) watched_.push_back(i);
      if (is_energy(*a.model, term)) {
        if (!has_frictional_cracks(a.model->scene)) continue;
        Sensitivity slips = work_of_slips(*a.state);
        slips.skeleton *= term.factor;
        linear += slips;
        any = true;
        rubs_ = rubs_ || has_coulomb(a.model->scene);
      } else if (!term.linear) {
        others_.push_back(i);
      } else if (term.work || term.on_crack || term.on_boundary) {
        Sensitivity d = derivative(term, *a.model, *a.state);
        d.interior *= term.factor;
        d.skeleton *= term.factor;
        d.force *= term.factor;
        linear += d;
        any = true;
      }
    }
    if (!any) return;
    if (others_.empty())
      adjoint_ = &*a.adjoint;
    else
      own_ = solve_adjoint(*a.model, linear, tangent_cone(*a.model, *a.state));
    if (own_) adjoint_ = &*own_;
  }

  /// Whether the fields of Green's tensor are needed.
  bool inserts() const {
    return rubs_ || !others_.empty() || watches();
  }
  /// Whether contact must stay as it is.
  bool watches() const {
    return !watched_.empty();
  }

  // Tensors of the body and, with a misfit, of the measured one; NaN where they admit no hole of this size.
  double operator()(const Vec2& x, Index t, const Green& green, const Mat2* measured) const {
    return change(x, t, green, measured, false).value;
  }

  // `sized`: with the size, else it is NaN.
  ClampedChange change(const Vec2& x, Index t, const Green& green, const Mat2* measured, bool sized) const {
    // Where M is not definite the radius is too large for the body there: NaN.
    const Material& material = material_of(a_.model->mesh, a_.model->scene, t);
    if (!admits_clamp(clamped_matrix(material, eps_, green.regular))) return {};
    ClampedChange sum{0, sized ? 0 : nan};
    const auto add = [&](double part) {
      sum.value += part;
      sum.size += std::abs(part);
    };
    const Vec2 u = displacement_at(*a_.model, *a_.state, t, x, true),
               F = clamped_force(material, eps_, green.regular, u);
    add(0.5 * a_.energy_share * u.dot(F));
    if (measured) {
      if (!admits_clamp(clamped_matrix(material, eps_, *measured))) return {};
      const Vec2 um = displacement_at(*a_.measured_model, *a_.measured, t, x, true);
      add(0.5 * a_.measured_share * um.dot(clamped_force(material, eps_, *measured, um)));
    }
    if (adjoint_) add(-F.dot(displacement_at(*a_.model, *adjoint_, t, x, true)));
    for (const Term& term : j_.terms)
      // A linear density loses its value in the disc, to leading order.
      if (term.linear && term.density) add(-pi * eps_ * eps_ * term.factor * term.density({.x = x}).value);
    if (!inserts()) return sum;
    const Field put = change_of(green, F);
    refuse_moving_contact(x, put, u, F);
    // 1/2 sum dp_t dj_t of the sliding rows [theory: T.37].
    if (rubs_) add(0.5 * a_.energy_share * put.force.dot(put.skeleton));
    const double forth = inserted(x, material, put, F);
    if (!sized) {
      sum.value += forth;
      return sum;
    }
    // With F and -F the odd and the even part in the field put in come apart: their sizes, not their sum, say what the
    // prediction may be off by.
    const double back = inserted(x, material, change_of(green, -F), -F);
    add(0.5 * (forth - back));
    add(0.5 * (forth + back));
    return sum;
  }

 private:
  // Without the part in closed form.
  static Field change_of(const Green& green, const Vec2& F) {
    Field change;
    change.skeleton = -F[0] * green.field[0].skeleton - F[1] * green.field[1].skeleton;
    change.interior = -F[0] * green.field[0].interior - F[1] * green.field[1].interior;
    change.force = -F[0] * green.field[0].force - F[1] * green.field[1].force;
    return change;
  }

  // Contact is kept as it is without the hole, and such functionals see nothing else.
  void refuse_moving_contact(const Vec2& x, const Field& put, const Vec2& u, const Vec2& F) const {
    if (!watches()) return;
    Field clamped = *a_.state;
    clamped.skeleton += put.skeleton;
    clamped.force += put.force;
    for (const std::size_t i : watched_) {
      const double wrong = share_of_false_contact(*a_.model, clamped, j_.terms[i].crack, u, F);
      constexpr double few = 0.01;
      if (wrong > few)
        throw Error(
            Fault::Usage,
            fmt::format("functional \"{}\": a clamped hole of radius {:.3g} at ({:.6g}, {:.6g}) parts or closes "
                        "the faces along {:.2g} % of its crack, where a map keeps contact as it is without the "
                        "hole; draw the hole and solve, or map an energy or a displacement",
                        j_.terms[i].kind, eps_, x.x(), x.y(), 100 * wrong));
    }
  }

  // J of u - (G + w) F against J of u, term by term.
  // A power of an integral changes by (I + dI)^q - I^q, not by its slope: dI is no small number here.
  double inserted(const Vec2& x0, const Material& material, const Field& change, const Vec2& F) const {
    const Singular kelvins{x0, eps_, [&](const Vec2& x) { return minus_kelvin(material, x - x0, F); }};
    double sum = 0;
    for (const std::size_t i : others_) {
      const Term& term = j_.terms[i];
      if ((term.uses_stress || term.uses_rotation) && !(term.somewhere && !term.somewhere(x0, clear_radii * eps_)))
        throw Error(Fault::Usage, "functional \"" + term.kind +
                                      "\": the stress around a clamped hole is singular, and with it this functional; "
                                      "use an energy, a compliance or a functional of the displacement");
      const double by = difference(term, *a_.model, *a_.state, change, kelvins);
      sum += term.power == 1 ? term.factor * by
                             : term.factor * (std::pow(std::pow(a_.term_value[i], 1 / term.power) + by, term.power) -
                                              a_.term_value[i]);
    }
    return sum;
  }

  const Analysis& a_;
  const Functional& j_;
  double eps_;
  std::vector<std::size_t> others_;   // terms that u_eps is inserted into
  std::vector<std::size_t> watched_;  // terms that see contact alone
  const Field* adjoint_ = nullptr;    // of the linear terms
  bool rubs_ = false;                 // an energy, with forces of friction that change
  std::optional<Field> own_;
};

}  // namespace

namespace {

// Points outside, or masked, keep what ClampedChange begins with.
std::vector<ClampedChange> changes_at(const Analysis& a, const Functional& j, double eps, std::span<const Vec2> points,
                                      bool sized) {
  const Clamped predicted(a, j, eps);
  const GreenOfBody* const known = a.fields ? a.fields->green.get() : nullptr;
  std::optional<GreenTensor> tensor, measured;
  if (!known) tensor.emplace(*a.model, *a.state);
  if (!known && a.measured) measured.emplace(*a.measured_model, *a.measured);
  const std::vector<Index> where = locate(a.model->mesh, points);
  const std::vector<bool> masked = too_close(*a.model, j, points, clear_radii * eps, eps);
  std::vector<ClampedChange> found(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Index t = where[i];
    if (t == none || masked[i]) continue;
    const Green green = known ? Green{.regular = known->regular(known->body, points[i]), .field = {}}
                              : tensor->at(points[i], t, predicted.inserts());
    Mat2 other;
    if (a.measured)
      other = known ? known->regular(known->measured.value(), points[i]) : measured->at(points[i], t, false).regular;
    found[i] = predicted.change(points[i], t, green, a.measured ? &other : nullptr, sized);
  }
  return found;
}

}  // namespace

std::vector<double> clamped_at(const Analysis& a, const Functional& j, double eps, std::span<const Vec2> points) {
  std::vector<double> value;
  for (const ClampedChange& c : changes_at(a, j, eps, points, false)) value.push_back(c.value);
  return value;
}

ClampedChange clamped_change(const Analysis& a, const Functional& j, double eps, const Vec2& point) {
  return changes_at(a, j, eps, std::span(&point, 1), true).front();
}

// Tensors are interpolated, displacements are those of the point itself.
ClampedMap clamped_everywhere(const Analysis& a, const Functional& j, double eps, const Candidates& points) {
  const Clamped predicted(a, j, eps);
  if (predicted.inserts())
    throw Error(
        Fault::Usage,
        fmt::format("functional \"{}\": a clamped hole {}; list the points in [map] points instead of a map "
                    "everywhere",
                    j.kind,
                    predicted.watches() ? "may part or close the faces of the crack, which takes a look per point"
                                        : "takes an integral over the whole body per point"));
  std::vector<std::size_t> wanted;
  std::vector<Vec2> place;
  std::vector<Index> in;
  for (std::size_t i = 0; i < points.x.size(); ++i) {
    if (points.skip[i]) continue;
    wanted.push_back(i);
    place.push_back(points.x[i]);
    in.push_back(points.in[i]);
  }
  ClampedMap map;
  map.value = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(points.x.size()), nan);
  const GreenOfBody* const known = a.fields ? a.fields->green.get() : nullptr;
  const GreenSamples tensor = known ? known->body.samples : sample_green(*a.model, *a.state, eps, place, in);
  map.error = tensor.error;
  map.samples = static_cast<Index>(tensor.x.size());
  std::optional<GreenSamples> measured;
  if (a.measured) {
    measured = known ? known->measured.value().samples : sample_green(*a.measured_model, *a.measured, eps, place, in);
    map.error = std::max(map.error, measured->error);
    map.samples += static_cast<Index>(measured->x.size());
  }
  parallel_for(static_cast<Index>(wanted.size()), a.model->threads, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      const std::size_t k = static_cast<std::size_t>(i);
      const Green green{.regular = interpolate(tensor, place[k]), .field = {}};
      Mat2 other;
      if (measured) other = interpolate(*measured, place[k]);
      map.value[static_cast<Eigen::Index>(wanted[k])] = predicted(place[k], in[k], green, measured ? &other : nullptr);
    }
  });
  return map;
}

}  // namespace kerf
