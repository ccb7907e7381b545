// The value of J = sum f_i I_i^q_i, its derivative by the state, and the adjoint that the expansion of J takes. Terms
// are of three kinds. Multiples of an energy at the state need no adjoint (energy, misfit, and the compliance where it
// is -2 times the energy) [theory: A.11, T.6, T.7]: they give `energy_share`, `measured_share`. All others are
// differentiated, dJ = sum f q I^(q-1) dI [theory: T.8], and one adjoint is solved for their sum, with homogeneous
// supports in the mixed sign and on the tangent cone of the contact [theory: A.2, A.8, A.15]. With friction the energy
// has the work of the forces on sliding rows as well [theory: A.17]. Rows with neither gap nor pressure give a unit
// response each and the matrix S of the openings that these cause [theory: A.12]. All sums go through WholeBody, so
// that a body in parts has the same numbers on every process. What has no derivative is refused here: J that sees rigid
// motions, undecided friction, an infinite J. Derived in docs/theory/adjoint.md.

#include "kerf/analysis.hpp"

#include "kerf/recover.hpp"
#include "solver/tangent_cone.hpp"
#include "topo/analysis.hpp"
#include "topo/functional/edge_crack_norm.hpp"
#include "topo/functional/integrate.hpp"
#include "topo/functional/tip.hpp"
#include "topo/max_stress.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace kerf {

namespace {

Sensitivity scaled(double factor, Sensitivity s) {
  s.interior *= factor;
  s.skeleton *= factor;
  s.force *= factor;
  return s;
}

// Work of the tractions that the measured displacements replace, on them: of own triangles.
// <g, u_m> of (T.7).
double work_on_measured(const Model& m, const Support& measured) {
  const EdgeRule rule = gauss(data_points);
  double work = 0;
  for (const LoadedEdges& traction : m.inner->data.tractions) {
    if (traction.label != measured.label) continue;
    const std::vector<Index>& edges = labeled(m.inner->data, traction.label);
    for (std::size_t j = 0; j < edges.size(); ++j) {
      const auto& [left, right] = m.mesh.sides[edges[j]];
      if (std::max(left, right) >= own_triangles(m)) continue;
      const EdgeValues u =
          edge_values(measured.value, {m.mesh, m.inner->skeleton.curvatures, edges[j]}, "measured displacement", false);
      for (int q = 0; q < data_points; ++q)
        work += length(m.mesh, edges[j]) * rule.w[q] * traction.values[j].at.col(q).dot(u.at.col(q));
    }
  }
  return work;
}

// Of own unknowns and triangles.
double along(const Model& m, const Sensitivity& d, const Field& s) {
  double sum = 0;
  for (Index u = 0; u < static_cast<Index>(d.skeleton.size()); ++u)
    if (owns(m, u)) sum += d.skeleton[u] * s.skeleton[u];
  const Index own = own_triangles(m);
  if (d.interior.size() > 0) sum += d.interior.leftCols(own).cwiseProduct(s.interior.leftCols(own)).sum();
  return sum;
}

// Sum over the biactive rows of their share of the crack: of own edges.
double length_of(const Model& m, const Field& s) {
  double length = 0;
  for (std::size_t c = 0; c < m.mesh.cracks.size(); ++c) {
    if (!is_unilateral(m.scene.laws[c])) continue;
    const std::vector<CrackPoint> profile = crack_profile(m, s, static_cast<Index>(c));
    const std::vector<CrackEdge>& path = m.mesh.cracks[c];
    // crack_profile has the same number of points on every edge of the path, in its order.
    const std::size_t each = path.empty() ? 1 : profile.size() / path.size();
    for (std::size_t i = 0; i < profile.size(); ++i)
      if (profile[i].status == CrackPoint::Status::Biactive && m.mesh.sides[path[i / each].edge][1] < own_triangles(m))
        length += profile[i].length;
  }
  return length;
}

// A unit force on each biactive row; what opens under it is a column of S [theory: A.12].
OneSided one_sided(const Model& m, const Field& state) {
  const std::vector<ContactStatus> status = contact_status(m, state);
  std::vector<Index> unknowns;
  const Index leading = m.inner->ordering.leading();
  for (Index u = m.inner->skeleton.base; u < m.inner->skeleton.total; ++u) {
    const Index row = m.inner->ordering.row[u];
    if (row >= leading && status[static_cast<std::size_t>(row - leading)] == ContactStatus::Biactive)
      unknowns.push_back(u);
  }
  OneSided found;
  if (unknowns.empty()) return found;
  // S is dense and each of its columns is a solve.
  constexpr std::size_t most = 2000;
  if (unknowns.size() > most)
    throw Error(Fault::Numerics,
                "more than 2000 points of the cracks carry neither a gap nor a pressure, too many for one-sided "
                "derivatives; use longer edges there (mesh.size), or loads that open or close the cracks");
  const Eigen::Index n = static_cast<Eigen::Index>(unknowns.size());
  found.opening.resize(n, n);
  TangentSolver solver(m, tied(status));  // without friction
  const auto unit = [&](std::size_t i) -> Eigen::VectorXd {
    return Eigen::VectorXd::Unit(m.inner->skeleton.total, unknowns[i]);
  };
  for (TangentField& field : solver.solve_all(unknowns.size(), unit)) found.response.push_back(std::move(field));
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index k = 0; k < n; ++k)
      found.opening(k, i) = found.response[static_cast<std::size_t>(i)].skeleton[unknowns[static_cast<std::size_t>(k)]];
  // S is symmetric by reciprocity; the solves leave rounding.
  found.opening = 0.5 * (found.opening + found.opening.transpose()).eval();
  return found;
}

// slope_i = dJ . Y_i, Y_i the response to a unit force on row i; summed over the parts of the body.
std::shared_ptr<const Biactive> biactive(const Model& m, OneSided found, const Sensitivity& dJ, const WholeBody& body) {
  if (found.response.empty()) return nullptr;
  auto b = std::make_shared<Biactive>(Biactive{std::move(found.response), std::move(found.opening), {}});
  b->slope.resize(b->opening.cols());
  for (Eigen::Index i = 0; i < b->slope.size(); ++i)
    b->slope[i] = along(m, dJ, b->response[static_cast<std::size_t>(i)]);
  body.sum({b->slope.data(), static_cast<std::size_t>(b->slope.size())});
  return b;
}

// Of all of a crack; nothing where nothing is loaded.
Undecided undecided(const Model& m, const Field& s, Index crack, const WholeBody& body) {
  const bool here = crack < static_cast<Index>(m.mesh.cracks.size()) && !s.interior.isZero(0);
  const Undecided own = here ? undecided_friction(m, s, crack) : Undecided{};
  // Five numbers per process; the place told is that of the first process that has one.
  const std::vector<double> all = body.gather({own.length, own.whole, own.at.x(), own.at.y(), own.touches ? 1.0 : 0.0});
  Undecided found;
  for (std::size_t i = 0; i < all.size(); i += 5) {
    if (found.length == 0 && all[i] > 0) {
      found.at = {all[i + 2], all[i + 3]};
      found.touches = all[i + 4] > 0;
    }
    found.length += all[i];
    found.whole += all[i + 1];
  }
  return found;
}

// With friction there are no one-sided derivatives: points that are about to change what they do are refused where they
// have a length.
void require_friction_decided(const Functional& j, const Model& m, const Field& s, const WholeBody& body) {
  for (const Term& term : j.terms)
    if (term.measured)
      throw Error(Fault::Usage,
                  "functional \"misfit\" needs cracks without friction for its derivatives: neither of its two states "
                  "minimizes an energy; remove friction and tresca, or track the displacements (boundary_tracking)");
  constexpr double few = 0.01;
  for (std::size_t c = 0; c < m.scene.laws.size(); ++c) {
    const Undecided open = undecided(m, s, static_cast<Index>(c), body);
    if (open.length <= few * open.whole) continue;
    throw Error(
        Fault::Numerics,
        fmt::format("with friction, derivatives are known where it is decided what faces do; from ({:.6g}, "
                    "{:.6g}) on they {}, on {:.3g} of the {:.3g} of the crack. Change the loads or the friction "
                    "a little, or give the crack contact = \"open\" or \"bonded\"",
                    open.at.x(), open.at.y(),
                    open.touches ? "touch without pressure" : "stick with all their friction used up", open.length,
                    open.whole));
  }
}

}  // namespace

// l(u) = -2 Pi needs prescribed displacements 0, no eigenstrain and no friction [theory: N.8, H.4, A.17].
bool has_self_adjoint_work(const Model& m) {
  return m.inner->data.strain.empty() && !has_frictional_cracks(m.scene) &&
         std::all_of(m.inner->skeleton.prescribed.begin(), m.inner->skeleton.prescribed.end(),
                     [](double v) { return v == 0; });
}

bool is_energy(const Model& m, const Term& term) {
  return term.energy || term.measured || (term.work && has_self_adjoint_work(m));
}

Scene measured_scene(const Scene& scene, const Support& measured) {
  Scene other = scene;
  std::erase_if(other.tractions, [&](const Traction& t) { return t.label == measured.label; });
  other.supports.push_back(measured);
  return other;
}

namespace {

// A crack with a pressure that reaches into the ring of a term.
// The domain integral of G has no term for a pressure on faces inside its ring.
bool pressed_within(const Term& term, const Model& m) {
  const Mesh& mesh = whole_mesh(m);
  for (std::size_t c = 0; c < mesh.cracks.size(); ++c)
    if (has_pressure(m.scene.laws[c]))
      for (const CrackEdge& edge : mesh.cracks[c])
        for (const Index v : mesh.edges[edge.edge])
          if ((mesh.points[v] - term.feature).norm() <= term.feature_radius) return true;
  return false;
}

// A tip inside the body whose faces overlap before loading, where the term sees the square of the pressure: the jump
// does not close towards the tip as the pressure would need to be square integrable. Its place, if there is one.
std::optional<Vec2> overlapping_tip(const Term& term, const Model& m) {
  if (!term.on_crack) return std::nullopt;
  const Mesh& mesh = whole_mesh(m);
  const CrackLaw& law = m.scene.laws[static_cast<std::size_t>(term.crack)];
  const std::vector<CrackEdge>& path = mesh.cracks[static_cast<std::size_t>(term.crack)];
  if (!has_gap(law) || path.empty()) return std::nullopt;
  const auto& [a, b] = mesh.edges[path.front().edge];
  const auto& [c, d] = mesh.edges[path.back().edge];
  const Index first = path.front().forward ? a : b, last = path.back().forward ? d : c;
  if (first == last) return std::nullopt;  // closed: no tips
  std::vector<bool> outer(mesh.points.size(), false);
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    if (mesh.sides[e][0] == none || mesh.sides[e][1] == none)
      for (const Index v : mesh.edges[e]) outer[static_cast<std::size_t>(v)] = true;
  const double rounding =
      1e-9 * (mesh.points[static_cast<std::size_t>(first)] - mesh.points[static_cast<std::size_t>(last)]).norm();
  for (const auto& [tip, edge] : {std::pair{first, path.front().edge}, std::pair{last, path.back().edge}}) {
    const Vec2& x = mesh.points[static_cast<std::size_t>(tip)];
    // A density quadratic in the pressure has a slope that depends on it.
    const auto slope = [&](double pressure) { return term.on_crack({.x = x, .pressure = pressure}).by_pressure; };
    const bool squared = slope(1) != slope(0);
    if (!outer[static_cast<std::size_t>(tip)] && squared && law.gap(x, normal(mesh, edge))[0] < -rounding) return x;
  }
  return std::nullopt;
}

}  // namespace

void require_no_eigenstrain(const Scene& scene) {
  if (has_eigenstrain(scene))
    throw Error(Fault::Usage,
                "shape derivatives: an eigenstrain stays while the material moves, which they do not know; "
                "leave it out");
}

// Loads under which a term has no derivative, or not the one that is coded: pressures in a ring, eigenstrains.
void require_known_loads(const Functional& j, const Model& m) {
  const Scene& scene = m.scene;
  for (const Term& term : j.terms)
    if (term.edge_cracks) require_edge_cracks(*term.edge_cracks, m);
  for (const Term& term : j.terms)
    if (term.feature_radius > 0 && pressed_within(term, m))
      throw Error(Fault::Usage,
                  fmt::format("functional \"{}\" does not know the work of a pressure in the crack: the state gives K "
                              "and G at every tip",
                              term.kind));
  if (!has_eigenstrain(scene)) return;
  const bool out_of_plane = std::ranges::any_of(scene.eigenstrain, [](const Eigenstrain& e) { return e.out_of_plane; });
  for (const Term& term : j.terms) {
    if (term.feature_radius > 0)
      throw Error(
          Fault::Usage,
          fmt::format("functional \"{}\" cannot be taken in a body with an eigenstrain: the state gives K and G "
                      "at every tip, but their derivatives miss a term",
                      term.kind));
    if (term.stress_power > 0 && out_of_plane)
      throw Error(Fault::Usage,
                  fmt::format("functional \"{}\" knows no stress out of the plane from an eigenstrain (its "
                              "fourth component); use plane stress, or leave that component out",
                              term.kind));
  }
}

void require_finite(const Functional& j, const Model& m) {
  for (const Term& term : j.terms)
    if (const auto tip = overlapping_tip(term, m))
      throw Error(
          Fault::Usage,
          fmt::format("functional \"{}\" is infinite: the faces of the crack overlap at its tip ({:.6g}, {:.6g}) "
                      "(gap below 0), where the square of the pressure has no integral; give it a weight "
                      "that vanishes there, or a gap of 0 at the tip",
                      term.kind, tip->x(), tip->y()));
}

namespace {

// Pieces that move freely, per piece; empty: all that there is does.
// A piece is loose where one of its motions has a share in the combinations that no law resists.
std::vector<bool> loose_pieces(const Model& m) {
  std::vector<bool> loose;
  const Semicoercive& semicoercive = m.inner->semicoercive;
  if (!m.inner->floating.empty()) return loose;
  for (const Index piece : semicoercive.piece)
    loose.resize(std::max(loose.size(), static_cast<std::size_t>(piece) + 1));
  for (std::size_t i = 0; i < semicoercive.motions.size(); ++i)
    if (semicoercive.free.cols() == 0 || !semicoercive.free.row(static_cast<Eigen::Index>(i)).isZero(1e-9))
      loose[static_cast<std::size_t>(semicoercive.motions[i].piece)] = true;
  return loose;
}

// Whether the term has a density of the displacement in a loose piece, or on a side of one.
bool sees_loose(const Term& term, const Model& m, const std::vector<bool>& loose) {
  if (loose.empty()) return true;
  const Mesh& mesh = m.mesh;
  const std::vector<Index>& piece = m.inner->semicoercive.piece;
  const auto is_loose = [&](Index t) { return t != none && loose[static_cast<std::size_t>(piece[t])]; };
  const auto moves = [](const Density& d) { return !d.by_displacement.isZero(0); };
  if (term.on_boundary)
    for (std::size_t e = 0; e < mesh.edges.size(); ++e)
      if (mesh.label[e] == term.label && (is_loose(mesh.sides[e][0]) || is_loose(mesh.sides[e][1]))) return true;
  if (term.density && term.uses_displacement)
    for (Index t = 0; t < static_cast<Index>(mesh.triangles.size()); ++t) {
      if (!is_loose(t)) continue;
      // At the centroid and near the corners, at an arbitrary displacement: a weight may vanish in part of the
      // triangle.
      std::vector<Vec2> places{centroid(mesh, t)};
      for (const Index v : mesh.triangles[t]) places.push_back(0.9 * mesh.points[v] + 0.1 * places[0]);
      for (const Vec2& x : places)
        if (moves(term.density({.x = x, .displacement = Vec2(1e3, -777)}))) return true;
    }
  return false;
}

}  // namespace

// Where supports leave no rigid motion all is well; else a term must not see a piece that moves.
void require_supports(const Functional& j, const Model& model) {
  if (model.inner->floating.empty() && model.inner->semicoercive.slides.cols() == 0) return;
  const std::vector<bool> loose = loose_pieces(model);
  for (const Term& term : j.terms)
    if ((term.uses_displacement || term.on_boundary) && sees_loose(term, model, loose))
      throw Error(Fault::Usage,
                  fmt::format("functional \"{}\" sees rigid motions, and the supports leave the body, or a piece of "
                              "it, free to make some: "
                              "what a change of the body does to J is not defined; add supports, or use a functional "
                              "of stresses, energies or cracks",
                              term.kind));
}

// A body in one piece: sums are what they are, and the adjoint is solved here.
Analysis analyze(const Functional& j, const Model& model, const Field& state, bool value_only) {
  const WholeBody body{
      .sum = [](std::span<double>) {},
      .gather = [](const std::vector<double>& own) { return own; },
      .adjoint = [&](const Sensitivity& dJ) { return solve_adjoint(model, dJ, tangent_cone(model, state)); },
      .one_sided = [&] { return one_sided(model, state); },
      .measured =
          [&](const Support& displacement) {
            auto other = std::make_shared<Model>(
                prepare(model.mesh, model.element, measured_scene(model.scene, displacement), model.threads));
            auto solved = std::make_shared<State>(solve(*other));
            return std::pair<std::shared_ptr<const Model>, std::shared_ptr<const State>>{std::move(other),
                                                                                         std::move(solved)};
          }};
  return analyze(j, model, state, body, value_only);
}

WholeBody whole_body(SharedBody& body, const State& state, Communicator& comm, MeasuredBody measured) {
  return {.sum = [&](std::span<double> values) { comm.sum(values); },
          .gather = [&](const std::vector<double>& own) { return gathered(comm, own); },
          .adjoint = [&](const Sensitivity& dJ) { return body.solve_adjoint(state, dJ); },
          .one_sided = [&] { return body.one_sided(state); },
          .measured = std::move(measured)};
}

namespace {

/// The energy of the body that is held as measured, less that of the body under its loads; a takes its model and state.
double misfit(const Term& term, const Model& model, const Field& state, const WholeBody& body, Analysis& a) {
  if (a.measured) throw Error(Fault::Usage, "a sum may hold one misfit only");
  auto [other, solved] = body.measured(*term.measured);
  if (!certified(*solved))
    throw Error(Fault::Numerics, "the body with the measured displacements could not be solved (misfit)");
  const double value =
      potential_energy(*other, *solved) - work_on_measured(model, *term.measured) - potential_energy(model, state);
  // J is the energy of the measured body less that of the loaded one: each has its share.
  a.energy_share -= term.factor;
  a.measured_share += term.factor;
  a.measured_model = std::move(other);
  a.measured = std::move(solved);
  return value;
}

/// The largest stress of the whole body, to which the norm of the term is scaled.
double largest(const Term& term, const Model& model, const Field& state, const WholeBody& body) {
  return std::ranges::max(body.gather({largest_stress(*term.largest, model, state).value}));
}

}  // namespace

Analysis analyze(const Functional& j, const Model& model, const Field& state, const WholeBody& body, bool value_only) {
  Analysis a{.model = &model, .state = &state};
  require_known_loads(j, model);
  require_finite(j, model);
  const auto summed = [&](double value) {
    body.sum({&value, 1});
    return value;
  };
  // Values are known with friction whatever its points do; derivatives only where that is decided.
  const bool friction = has_frictional_cracks(model.scene);
  if (friction && !value_only) require_friction_decided(j, model, state, body);
  if (has_contact(model.scene)) a.biactive_length = summed(length_of(model, state));
  const bool self_adjoint_work = summed(has_self_adjoint_work(model) ? 0 : 1) == 0;
  for (const Term& term : j.terms) {
    if (term.tip && summed(at_closed_tip(term, model, state) ? 1 : 0) > 0) {
      a.term_value.push_back(0);
      a.slope.push_back(0);
      continue;
    }
    // The decision is the same on all processes: `self_adjoint_work` is a sum over them.
    const bool differentiates = !value_only && !term.measured && !term.energy && !(term.work && self_adjoint_work);
    double value = 0;
    Sensitivity by_state;
    if (term.measured) {
      value = misfit(term, model, state, body, a);
    } else if (differentiates) {
      Differentiated both = differentiated(term, model, state);
      value = both.value;
      by_state = std::move(both.derivative);
    } else {
      value = integral(term, model, state);
    }
    value = summed(value);
    if (term.power != 1 && value < 0 && !term.tip)  // of a tip it is 0 up to the mesh
      throw Error(Fault::Usage, fmt::format("the integral of \"{}\" is negative: its weight must not be", term.kind));
    const double norm = term.power == 1 ? value : std::pow(std::max(value, 0.0), term.power),
                 result = term.largest ? largest(term, model, state, body) : norm;
    a.term_value.push_back(result);
    a.slope.push_back((term.largest && norm > 0 ? result / norm : 1) * slope(term, value));
    a.value += term.factor * result;
    if (differentiates) {
      if (term.work) a.work_share += a.slope.back();
      a.derivative += scaled(a.slope.back(), std::move(by_state));
    } else if (value_only || term.measured) {
      continue;
    } else if (term.energy) {
      a.energy_share += term.factor;
      // With friction the state is no minimum of the energy: its derivative by the slips is left.
      if (friction) a.derivative += scaled(term.factor, work_of_slips(state));
    } else {  // work, and self-adjoint
      a.energy_share -= 2 * term.factor;
    }
  }
  if (!std::isfinite(a.value)) throw Error(Fault::Numerics, "the functional overflows: scale its weights or factors");
  if (value_only || empty(a.derivative)) return a;
  const TangentField adjoint = body.adjoint(a.derivative);
  // Relative residual of the adjoint's system.
  constexpr double solved = 1e-6;
  if (!(adjoint.residual < solved))
    throw Error(Fault::Numerics, "the adjoint could not be solved for: its residual stays large");
  a.adjoint = adjoint;
  // What a change does to the gaps is bilinear in the state: nothing, where nothing is loaded.
  if (!friction && summed(state.interior.isZero(0) ? 0 : 1) > 0)
    a.biactive = biactive(model, body.one_sided(), a.derivative, body);
  return a;
}

}  // namespace kerf
