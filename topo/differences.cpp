#include "topo/differences.hpp"

#include "solver/parallel.hpp"
#include "topo/integrate.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

using Kind = Perturbation::Kind;

Material floored(Material m) {
  constexpr double least = 1e-8;
  m.c = std::max(m.c, least / m.mu);
  return m;
}
Scene floored(Scene scene) {
  scene.material = floored(scene.material);
  for (Material& m : scene.regions) m = floored(m);
  return scene;
}

Eigen::VectorXd on_edges(const Skeleton& s, const std::vector<Index>& edges, const Eigen::VectorXd& values) {
  Eigen::VectorXd x(static_cast<Eigen::Index>(edges.size()) * s.per_edge);
  for (std::size_t i = 0; i < edges.size(); ++i)
    x.segment(static_cast<Eigen::Index>(i) * s.per_edge, s.per_edge) =
        values.segment(edge_unknown(s, edges[i]), s.per_edge);
  return x;
}

// Moments of the tractions that the triangles of `inside` exert through the edges.
Eigen::VectorXd forces_from(const Model& m, const State& s, const std::vector<Index>& edges,
                            const std::vector<bool>& inside) {
  const EdgeRule rule = gauss(8);
  const int per = m.skeleton.per_edge;
  Eigen::VectorXd f = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(edges.size()) * per);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Index e = edges[i];
    const auto& [left, right] = m.mesh.sides[e];
    const Index t = left != none && inside[left] ? left : right;
    const Vec2 n = (t == left ? 1 : -1) * normal(m.mesh, e);
    const Triangle shape = triangle(m, t);
    const Vec2& a = m.mesh.points[m.mesh.edges[e][0]];
    const Vec2 side = m.mesh.points[m.mesh.edges[e][1]] - a;
    for (Eigen::Index q = 0; q < rule.s.size(); ++q) {
      const Vec2 traction =
          tensor(stress_at(m.kernel, shape, s.interior.col(t), a + rule.s[q] * side)) * n * (side.norm() * rule.w[q]);
      const Eigen::VectorXd basis = trace_basis(m.kernel.trace, rule.s[q]);
      for (Eigen::Index g = 0; g < basis.size(); ++g)
        f.segment<2>(static_cast<Eigen::Index>(i) * per + 2 * g) +=
            basis[g] * (m.skeleton.frame[e].transpose() * traction);
    }
  }
  return f;
}

// 1/2 (A s, s) - (f, u) over some triangles.
double energy_of(const Model& m, const Eigen::MatrixXd& interior, Index t, const Material& material) {
  const Triangle shape = triangle(m, t);
  const Points x = rule_points(m.kernel.rule, shape);
  double sum = 0;
  for (Eigen::Index q = 0; q < x.cols(); ++q) {
    const Mat2 s = tensor(stress_at(m.kernel, shape, interior.col(t), x.col(q)));
    sum += 0.5 * m.kernel.rule.w[q] * s.cwiseProduct(strain(material, s)).sum();
  }
  if (m.system.force.cols() > 0) {
    const int first = stress_count(m.kernel.element), count = displacement_count(m.kernel.element);
    sum -= m.system.force.col(t).head(count).dot(interior.col(t).segment(first, count));
  }
  return area(shape) * sum;
}

}  // namespace

// One body and the operator of its difference problem.
struct Differences::Body {
  const Model* model;
  const State* state;
  std::unique_ptr<const Model> plain;  // where the model itself is penalised
  Eigen::MatrixXd W;                   // Schur complement on kept and contact rows
  std::vector<ContactPoint> points;
  Eigen::VectorXd jump, force;  // on the contact rows, of the state
  // Per ball: the others eliminated.
  std::size_t ball = static_cast<std::size_t>(-1);
  Eigen::MatrixXd S, others;  // S on (ball, contact); others = map from those to the other balls

  const Model& operators() const {
    return plain ? *plain : *model;
  }
  std::vector<State> skeletons(const Eigen::MatrixXd& mine, const Eigen::MatrixXd& push) const;
};

// The change of the skeleton outside a ball, from that on its boundary and at the contact rows; columns are radii.
std::vector<State> Differences::Body::skeletons(const Eigen::MatrixXd& mine, const Eigen::MatrixXd& push) const {
  const Model& o = operators();
  const Eigen::Index kept = o.ordering.kept, contact = o.ordering.trailing, nb = mine.rows() - contact,
                     begin = static_cast<Eigen::Index>(ball) * nb, count = mine.cols();
  const Eigen::MatrixXd rest = others * mine;
  Eigen::MatrixXd tail(kept + contact, count), y = Eigen::MatrixXd::Zero(o.ordering.size, count);
  tail << rest.topRows(begin), mine.topRows(nb), rest.bottomRows(rest.rows() - begin), mine.bottomRows(contact);
  y.bottomRows(tail.rows()) = o.factor.kept_factor().triangularView<Eigen::Lower>().transpose() * tail;
  const Eigen::MatrixXd x = o.factor.backward(y);
  std::vector<State> states(static_cast<std::size_t>(count));
  for (Eigen::Index i = 0; i < count; ++i) {
    State& s = states[static_cast<std::size_t>(i)];
    s.skeleton.setZero(o.skeleton.total);
    s.force.setZero(o.skeleton.total);
    for (Index u = 0; u < o.skeleton.total; ++u) {
      const Index row = o.ordering.row[u];
      if (row == none) continue;
      s.skeleton[u] = x(row, i);
      if (row >= o.ordering.size - contact) s.force[u] = push(row - (o.ordering.size - contact), i);
    }
  }
  return states;
}

namespace {

// What lies inside a contour, made of another material, between given displacements of the contour.
struct InnerState {
  Model model;
  State state;
};
InnerState inner_state(const Piece& inner, const Kernel& kernel, const Scene& scene, const Eigen::VectorXd& contour,
                       bool body) {
  Model m{inner.part.mesh,
          kernel,
          scene,
          inner.skeleton,
          inner.ordering,
          inner.system,
          Factor(LowerTriangle{}, 0),
          {},
          {},
          1,
          {}};
  State s;
  s.skeleton = complete(inner, contour, body);
  s.force.setZero(inner.skeleton.total);
  s.interior.resize(interior_count(kernel.element), static_cast<Eigen::Index>(inner.part.triangle.size()));
  for (Index t = 0; t < static_cast<Index>(inner.part.triangle.size()); ++t)
    s.interior.col(t) = interior(kernel, triangle(m, t), material_of(m.mesh, m.scene, t), force_of(m.system, t),
                                 trace_seen(m.mesh, m.skeleton, s.skeleton, t));
  return {std::move(m), std::move(s)};
}

double energy_inside(const InnerState& inner) {
  double sum = 0;
  for (Index t = 0; t < static_cast<Index>(inner.state.interior.cols()); ++t)
    sum += energy_of(inner.model, inner.state.interior, t, material_of(inner.model.mesh, inner.model.scene, t));
  return sum;
}

double work_inside(const Model& m, const State& s, Index t) {
  if (m.system.force.cols() == 0) return 0;
  const int first = stress_count(m.kernel.element), count = displacement_count(m.kernel.element);
  return area(m.mesh, t) * m.system.force.col(t).head(count).dot(s.interior.col(t).segment(first, count));
}

// Of the work of the body force inside the ball: it stays where the body stays.
double work_difference(const Model& m, const State& s, const State& change, const std::vector<bool>& disc,
                       const std::vector<bool>& ring, const InnerState* starred) {
  double d = 0;
  for (Index t = 0; t < static_cast<Index>(disc.size()); ++t) {
    if (disc[t]) d -= work_inside(m, s, t);
    if (ring[t]) d += work_inside(m, change, t);
  }
  if (starred)
    for (Index t = 0; t < static_cast<Index>(starred->state.interior.cols()); ++t)
      d += work_inside(starred->model, starred->state, t);
  return d;
}

void add_fields(State& s, const Piece& p, const Eigen::VectorXd& values, const Kernel& kernel, const Scene& scene) {
  for (Index t = 0; t < static_cast<Index>(p.part.triangle.size()); ++t)
    s.interior.col(p.part.triangle[static_cast<std::size_t>(t)]) =
        interior(kernel, triangle(p.part.mesh, p.skeleton, t), material_of(p.part.mesh, scene, t), {},
                 trace_seen(p.part.mesh, p.skeleton, values, t));
}

struct Change {
  Eigen::VectorXd ball, contact, contour, load;  // changes; load: on the contour
  Eigen::VectorXd push;                          // of the contact forces
  bool same = true;
};

}  // namespace

Differences::Differences(const Analysis& a, const Functional& j, const Perturbation& p, const Filled& filled,
                         const Preparation& how)
    : a_(a), j_(j), p_(p), filled_(filled) {
  if (p.kind == Kind::Inclusion) p_.inclusion = floored(p.inclusion);
  const auto add = [&](const Model* m, const State* s) {
    auto body = std::make_unique<Body>();
    body->model = m;
    body->state = s;
    if (m->system.penalty > 0 || m->ordering.kept == 0) {
      Preparation plain = how;
      plain.plain = true;
      body->plain = std::make_unique<Model>(prepare(m->mesh, m->kernel.element, floored(m->scene), m->threads, plain));
    }
    const Model& o = body->operators();
    body->W = o.factor.kept_complement();
    const Index trailing = o.ordering.trailing, leading = o.ordering.size - trailing;
    body->jump.resize(trailing);
    body->force.resize(trailing);
    for (Index u = m->skeleton.base; u < m->skeleton.total; ++u) {
      const Index row = o.ordering.row[u];
      if (row < leading) continue;
      body->jump[row - leading] = s->skeleton[u];
      body->force[row - leading] = s->force[u];
    }
    for (Index row = 0; row < trailing; ++row) body->points.push_back({.normal = row});
    bodies_.push_back(std::move(body));
  };
  add(a.model, a.state);
  if (a.measured) add(a.measured_model.get(), a.measured.get());
}

Differences::~Differences() = default;

// The derivative exactly, what is left of the density at the centroids.
std::vector<Eigen::VectorXd> Differences::far_changes(const std::vector<State>& changes, Index first, Index end) {
  const Model& m = *a_.model;
  const Model& o = bodies_[0]->operators();
  const Index triangles = static_cast<Index>(m.mesh.triangles.size());
  const Eigen::Index count = static_cast<Eigen::Index>(changes.size()),
                     terms = static_cast<Eigen::Index>(j_.terms.size());
  if (derivatives_.empty())
    for (const Term& term : j_.terms)
      derivatives_.push_back(term.energy || term.measured ? Sensitivity{} : derivative(term, m, *a_.state));
  Eigen::MatrixXd part = Eigen::MatrixXd::Zero(terms * count, triangles);
  parallel_for(triangles, m.threads, [&](Index from, Index to) {
    for (Index t = from; t < to; ++t) {
      if (t >= first && t < end) continue;
      Eigen::MatrixXd traces(skeleton_count(m.kernel.element), count);
      for (Eigen::Index k = 0; k < count; ++k)
        traces.col(k) = trace_seen(o.mesh, o.skeleton, changes[static_cast<std::size_t>(k)].skeleton, t);
      const Eigen::MatrixXd w = interiors(o.kernel, triangle(o, t), material_of(o.mesh, o.scene, t), traces);
      for (Eigen::Index i = 0; i < terms; ++i) {
        const Sensitivity& d = derivatives_[static_cast<std::size_t>(i)];
        if (d.interior.size() == 0) continue;
        const Term& term = j_.terms[static_cast<std::size_t>(i)];
        auto sum = part.col(t).segment(i * count, count);
        sum = w.transpose() * d.interior.col(t);
        if (!term.work) sum += second_order(term, m, *a_.state, t, w);
      }
    }
  });
  std::vector<Eigen::VectorXd> all(static_cast<std::size_t>(terms), Eigen::VectorXd::Zero(count));
  for (Index t = 0; t < triangles; ++t)
    for (Eigen::Index i = 0; i < terms; ++i) all[static_cast<std::size_t>(i)] += part.col(t).segment(i * count, count);
  return all;
}

std::vector<Difference> Differences::at(std::size_t ball, const BallMesh& mesh) {
  const Mesh& whole = a_.model->mesh;
  const Kernel& kernel = a_.model->kernel;
  const std::size_t triangles = whole.triangles.size();
  const Index first = filled_.first_triangle[ball], end = filled_.first_triangle[ball + 1];
  const auto shells = [&](Index from, Index to) {  // triangles of the ball with from <= shell < to
    std::vector<bool> use(triangles, false);
    for (Index t = first; t < end; ++t) {
      const Index shell = mesh.shell[static_cast<std::size_t>(t - first)];
      use[t] = shell >= from && shell < to;
    }
    return use;
  };
  const auto& contours = filled_.contour[ball];
  const Index count = static_cast<Index>(contours.size()) - 1, all = count + 1;
  const Eigen::Index nb = static_cast<Eigen::Index>(contours[0].size()) * a_.model->skeleton.per_edge;
  const Scene scene = floored(a_.model->scene);
  const bool body = static_cast<bool>(scene.body);
  const Piece full = condense(whole, shells(0, all), contours[0], kernel, scene, false);
  Scene star = scene;
  if (p_.kind == Kind::Inclusion) {
    star.material = p_.inclusion;
    std::fill(star.regions.begin(), star.regions.end(), p_.inclusion);
  }
  for (const auto& b : bodies_) {
    if (b->ball == ball) continue;
    b->ball = ball;
    const Eigen::Index kept = b->operators().ordering.kept, contact = b->operators().ordering.trailing,
                       begin = static_cast<Eigen::Index>(ball) * nb;
    std::vector<Eigen::Index> mine, rest;
    for (Eigen::Index i = 0; i < kept; ++i) (i >= begin && i < begin + nb ? mine : rest).push_back(i);
    for (Eigen::Index i = 0; i < contact; ++i) mine.push_back(kept + i);
    b->S = b->W(mine, mine);
    if (!rest.empty()) {
      const Eigen::MatrixXd couple = b->W(rest, mine);
      b->others = -Eigen::MatrixXd(b->W(rest, rest)).llt().solve(couple);
      b->S += couple.transpose() * b->others;
    } else {
      b->others.resize(0, static_cast<Eigen::Index>(mine.size()));
    }
    b->S.topLeftCorner(nb, nb) -= full.K;
  }

  bool fields = false;  // whether the fields themselves are asked for
  const bool self_adjoint = std::all_of(a_.model->skeleton.prescribed.begin(), a_.model->skeleton.prescribed.end(),
                                        [](double v) { return v == 0; });
  for (const Term& term : j_.terms) {
    const bool constant = term.density && !term.uses_stress && !term.uses_displacement && !term.uses_rotation;
    fields = fields || !(term.energy || term.measured || (term.work && self_adjoint) || constant);
  }

  const Body& b0 = *bodies_[0];
  // Every radius by itself: the ring outside its contour, the changes of all bodies, their energies.
  struct Solved {
    std::vector<bool> disc;
    std::optional<Piece> annulus, inner;
    std::vector<Change> changes;
    std::vector<double> energy;  // per body
    bool same_contact = true;
  };
  std::vector<Solved> solved(static_cast<std::size_t>(count));
  parallel_tasks(count, a_.model->threads, [&](Index number) {
    Solved& of = solved[static_cast<std::size_t>(number)];
    const Index k = number + 1;
    of.disc = shells(k, all);
    const std::vector<bool>& disc = of.disc;
    std::vector<Index> both = contours[0];
    both.insert(both.end(), contours[k].begin(), contours[k].end());
    of.annulus.emplace(condense(whole, shells(0, k), both, kernel, scene, false));
    const Piece& annulus = *of.annulus;
    const auto A00 = annulus.K.topLeftCorner(nb, nb);
    const auto A0k = annulus.K.topRightCorner(nb, nb);
    const auto Akk = annulus.K.bottomRightCorner(nb, nb);
    std::optional<Piece>& inner = of.inner;
    if (p_.kind == Kind::Inclusion) inner.emplace(condense(whole, disc, contours[k], kernel, star, body));
    Eigen::LLT<Eigen::MatrixXd> middle;
    Eigen::MatrixXd outer = A00;
    if (p_.kind != Kind::ClampedHole) {
      Eigen::MatrixXd M = Akk;
      if (inner) M += inner->K;
      middle.compute(M);
      outer -= A0k * middle.solve(A0k.transpose());
    }
    for (const auto& b : bodies_) {
      const Model& m = *b->model;
      const Eigen::VectorXd before = on_edges(m.skeleton, contours[k], b->state->skeleton);
      const Eigen::VectorXd pull = forces_from(m, *b->state, contours[k], disc);
      Change c;
      Eigen::VectorXd r0;
      if (p_.kind == Kind::ClampedHole) {
        c.contour = -before;
        r0 = -A0k * c.contour;
      } else {
        c.load = pull;
        if (inner) c.load -= inner->K * before - inner->load;
        r0 = -A0k * middle.solve(c.load);
      }
      Eigen::MatrixXd S = b->S;
      S.topLeftCorner(nb, nb) += outer;
      const Eigen::Index nc = S.rows() - nb;
      const Eigen::LLT<Eigen::MatrixXd> of_ball(S.topLeftCorner(nb, nb));
      c.contact.setZero(nc);
      c.push.setZero(nc);
      if (nc > 0) {
        const Eigen::MatrixXd couple = S.topRightCorner(nb, nc), reach = of_ball.solve(couple);
        Eigen::MatrixXd Sc = S.bottomRightCorner(nc, nc) - couple.transpose() * reach;
        Sc = 0.5 * (Sc + Sc.transpose()).eval();
        const Eigen::VectorXd rc = -reach.transpose() * r0;
        std::vector<Motion> motion(static_cast<std::size_t>(nc));
        for (Eigen::Index i = 0; i < nc; ++i)
          motion[static_cast<std::size_t>(i)] = b->force[i] > 0 || !(b->jump[i] > 0) ? Motion::Held : Motion::Forward;
        const Contact contact = dual_qp(Sc, Sc * b->jump + rc - b->force, b->points, motion);
        if (!contact.converged)
          throw Error(Fault::Numerics, "contact did not settle in the body with a change of finite size");
        // With the set known, the change itself: rows that close or stay closed have their jump given, the others
        // their force.
        std::vector<Eigen::Index> free, held;
        Eigen::VectorXd given = Eigen::VectorXd::Zero(nc);
        for (Eigen::Index i = 0; i < nc; ++i) {
          const bool holds = contact.motion[static_cast<std::size_t>(i)] == Motion::Held;
          if (holds != (motion[static_cast<std::size_t>(i)] == Motion::Held)) c.same = false;
          (holds ? held : free).push_back(i);
          if (holds) c.contact[i] = -b->jump[i];
          given[i] = rc[i] - (holds ? 0 : b->force[i]);
        }
        if (!free.empty()) {
          Eigen::VectorXd rest = given(free);
          if (!held.empty()) rest -= Sc(free, held) * c.contact(held);
          c.contact(free) = Eigen::VectorXd(Eigen::MatrixXd(Sc(free, free)).llt().solve(rest));
        }
        c.push = Sc * c.contact - rc;
        c.ball = of_ball.solve(r0 - couple * c.contact);
      } else {
        c.ball = of_ball.solve(r0);
      }
      if (p_.kind == Kind::ClampedHole)
        c.load = A0k.transpose() * c.ball + Akk * c.contour;
      else
        c.contour = middle.solve(c.load - A0k.transpose() * c.ball);
      of.same_contact = of.same_contact && c.same;

      // Pi(x + w) - Pi(x) in the changed body, and what the change of the disc is at x itself.
      double change = 0;
      for (Index t = first; t < end; ++t)
        if (disc[t]) change -= energy_of(m, b->state->interior, t, material_of(m.mesh, m.scene, t));
      if (inner) change += energy_inside(inner_state(*inner, kernel, star, before, body));
      const double first_order = p_.kind == Kind::ClampedHole ? -pull.dot(c.contour) : -c.load.dot(c.contour);
      change += first_order + b->force.dot(c.contact) + 0.5 * (c.load.dot(c.contour) + c.push.dot(c.contact));
      of.energy.push_back(change);
      of.changes.push_back(std::move(c));
    }
  });

  std::vector<State> outside;        // change of the skeleton and the forces, per radius
  std::vector<Eigen::VectorXd> far;  // per term: change of its domain integral outside the ball, per radius
  if (fields) {
    Eigen::MatrixXd mine(b0.S.rows(), count), push(b0.S.rows() - nb, count);
    for (Index i = 0; i < count; ++i) {
      const Change& c = solved[static_cast<std::size_t>(i)].changes[0];
      mine.col(i) << c.ball, c.contact;
      push.col(i) = c.push;
    }
    outside = b0.skeletons(mine, push);
    far = far_changes(outside, first, end);
  }

  std::vector<Difference> results;
  for (Index number = 0; number < count; ++number) {
    const Solved& of = solved[static_cast<std::size_t>(number)];
    const std::vector<bool>& disc = of.disc;
    Difference result{.same_contact = of.same_contact};
    std::optional<InnerState> starred;
    State near;  // the change inside the ball, outside the contour
    if (fields) {
      const Change& c = of.changes[0];
      Eigen::VectorXd edges(2 * nb);
      edges << c.ball, c.contour;
      near.skeleton = outside[static_cast<std::size_t>(number)].skeleton;
      near.force = outside[static_cast<std::size_t>(number)].force;
      near.interior.setZero(interior_count(kernel.element), static_cast<Eigen::Index>(triangles));
      add_fields(near, *of.annulus, complete(*of.annulus, edges, false), kernel, scene);
      if (of.inner)
        starred.emplace(inner_state(*of.inner, kernel, star,
                                    on_edges(a_.model->skeleton, contours[number + 1], a_.state->skeleton) + c.contour,
                                    body));
    }
    std::vector<bool> ring(triangles, false);
    for (Index t = first; t < end; ++t) ring[t] = !disc[t];
    for (std::size_t i = 0; i < j_.terms.size(); ++i) {
      const Term& term = j_.terms[i];
      double d = 0;
      if (term.energy)
        d = of.energy[0];
      else if (term.measured)
        d = of.energy[1] - of.energy[0];
      else if (term.work && self_adjoint)
        d = -2 * of.energy[0];
      else {
        if (fields) {
          d = far[i][number];
          d += term.work ? derivatives_[i].skeleton.dot(near.skeleton)
                         : surface_difference(term, *a_.model, *a_.state, near);
          d += term.work ? work_difference(*a_.model, *a_.state, near, disc, ring, starred ? &*starred : nullptr)
                         : domain_difference(term, *a_.model, *a_.state, near, ring);
        }
        if (term.density) {
          d -= integral_over(term, *a_.model, *a_.state, disc);
          if (starred)
            d += integral(term, starred->model, starred->state);
          else if (p_.kind == Kind::Inclusion)
            d += integral_over(term, *a_.model, *a_.state, disc);  // constant densities stay
        }
      }
      if (term.power == 1) {
        result.value += term.factor * d;
      } else {  // (I + d)^power - I^power
        const double before = std::pow(a_.term_value[i], 1 / term.power);
        result.value += term.factor * a_.term_value[i] * std::expm1(term.power * std::log1p(d / before));
      }
    }
    results.push_back(result);
  }
  return results;
}

}  // namespace kerf
