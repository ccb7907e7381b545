#include "topo/validate/differences.hpp"

#include "solver/parallel.hpp"
#include "topo/functional/integrate.hpp"
#include "topo/validate/ball_fields.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <limits>

namespace kerf {

namespace {

using Kind = Perturbation::Kind;

}  // namespace

struct Differences::Change {
  Eigen::VectorXd ball, contact, contour, load;  // changes; load: on the contour
  Eigen::VectorXd push;                          // of the contact forces
  bool same = true;
};

struct Differences::Solved {
  std::vector<bool> disc;  // triangles inside the contour
  std::vector<Index> contour;
  std::optional<CondensedPiece> annulus, inner;
  std::vector<Change> changes;  // per body
  std::vector<double> energy;
  bool same_contact = true;
  Eigen::VectorXd others;   // on the boundaries of the other balls
  Eigen::Index column = 0;  // in Differences::far_
  Eigen::VectorXd far;      // per term: change of its domain integral outside the ball
};

// One body and the operator of its difference problem.
struct Differences::Body {
  const Model* model;
  const Field* state;
  std::unique_ptr<const Model> plain;  // where the model itself is penalized
  Eigen::MatrixXd W;                   // Schur complement on kept and contact rows
  std::vector<ContactPoint> points;
  Eigen::VectorXd jump, force;  // on the contact rows, of the state
  std::vector<ContactStatus> status;
  // Per ball: the others eliminated.
  std::size_t ball = static_cast<std::size_t>(-1);
  Eigen::MatrixXd S, others;  // S on (ball, contact); others = map from those to the other balls

  const Model& operators() const {
    return plain ? *plain : *model;
  }
};

Differences::Differences(const Analysis& a, const Functional& j, const Perturbation& p, const Filled& filled,
                         const Preparation& how)
    : a_(a), j_(j), p_(p), filled_(filled) {
  if (p.kind == Kind::Inclusion) p_.inclusion = floored(p.inclusion);
  self_adjoint_ = std::all_of(a.model->inner->skeleton.prescribed.begin(), a.model->inner->skeleton.prescribed.end(),
                              [](double v) { return v == 0; });
  for (const Term& term : j.terms) {
    const bool constant = term.density && !term.uses_stress && !term.uses_displacement && !term.uses_rotation;
    fields_ = fields_ || !(term.energy || term.measured || (term.work && self_adjoint_) || constant);
  }
  const auto add = [&](const Model* m, const Field* s) {
    auto body = std::make_unique<Body>();
    body->model = m;
    body->state = s;
    if (m->inner->system.penalty > 0 || m->inner->ordering.interface_rows == 0) {
      Preparation plain = how;
      plain.plain = true;
      body->plain =
          std::make_unique<Model>(prepare(m->mesh, m->inner->kernel.element, floored(m->scene), m->threads, plain));
    }
    const Model& o = body->operators();
    body->W = o.inner->factor.interface_complement();
    const Index trailing = o.inner->ordering.contact_rows, leading = o.inner->ordering.size - trailing;
    body->status = contact_status(*m, *s);
    body->jump.resize(trailing);
    body->force.resize(trailing);
    for (Index u = m->inner->skeleton.base; u < m->inner->skeleton.total; ++u) {
      const Index row = o.inner->ordering.row[u];
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

// What every change does outside its ball: the skeleton by the factor of the whole, several columns at once; of the
// densities the derivative exactly, and at the centroids what is left.
void Differences::outside(std::vector<std::vector<Solved>>& solved) {
  const Model& m = *a_.model;
  const Model& o = bodies_[0]->operators();
  struct Column {
    Solved* of;
    Index first, end;  // triangles of its ball
    Eigen::Index begin;
    std::size_t number;  // of the radius
    Vec2 center;         // of the ball
    double radius;
    Eigen::Index at, count;  // columns of the ball
  };
  constexpr double near_balls = 2.5;
  std::vector<Column> columns;
  for (std::size_t b = 0; b < solved.size(); ++b) {
    Vec2 low = Vec2::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (const Index e : filled_.contour[b][0])
      for (const Index v : m.mesh.edges[e])
        low = low.cwiseMin(m.mesh.points[v]), high = high.cwiseMax(m.mesh.points[v]);
    const auto at = static_cast<Eigen::Index>(columns.size());
    for (std::size_t k = 0; k < solved[b].size(); ++k)
      columns.push_back({&solved[b][k], filled_.first_triangle[b], filled_.first_triangle[b + 1],
                         static_cast<Eigen::Index>(b) * solved[b][k].changes[0].ball.size(), k, 0.5 * (low + high),
                         0.5 * (high - low).maxCoeff(), at, static_cast<Eigen::Index>(solved[b].size())});
  }
  if (columns.empty()) return;
  const Eigen::Index count = static_cast<Eigen::Index>(columns.size()), kept = o.inner->ordering.interface_rows,
                     contact = o.inner->ordering.contact_rows, terms = static_cast<Eigen::Index>(j_.terms.size());
  {
    Eigen::MatrixXd tail(kept + contact, count), y = Eigen::MatrixXd::Zero(o.inner->ordering.size, count);
    for (Eigen::Index k = 0; k < count; ++k) {
      const Column& c = columns[static_cast<std::size_t>(k)];
      const Eigen::VectorXd& rest = c.of->others;
      tail.col(k) << rest.head(c.begin), c.of->changes[0].ball, rest.tail(rest.size() - c.begin),
          c.of->changes[0].contact;
    }
    y.bottomRows(tail.rows()) = o.inner->factor.interface_factor().triangularView<Eigen::Lower>().transpose() * tail;
    far_ = o.inner->factor.backward(y);
  }
  for (Eigen::Index k = 0; k < count; ++k) columns[static_cast<std::size_t>(k)].of->column = k;
  for (const Term& term : j_.terms)
    derivatives_.push_back(term.energy || term.measured ? Sensitivity{} : derivative(term, m, *a_.state));
  const Index triangles = static_cast<Index>(m.mesh.triangles.size());
  Eigen::MatrixXd part = Eigen::MatrixXd::Zero(terms * count, triangles);
  parallel_for(triangles, m.threads, [&](Index from, Index to) {
    Eigen::MatrixXd traces(skeleton_count(m.element), count);
    for (Index t = from; t < to; ++t) {
      const Seen view = seen(o.mesh, o.inner->skeleton, t);
      traces.setZero();
      for (int i = 0; i < view.count; ++i)
        for (const Index unknown : {view.base[i], view.jump[i]})
          if (unknown != none && o.inner->ordering.row[unknown] != none)
            traces.row(i) += far_.row(o.inner->ordering.row[unknown]);
      const Eigen::MatrixXd w = interiors(o.inner->kernel, triangle(o, t), material_of(o.mesh, o.scene, t), traces);
      for (Eigen::Index i = 0; i < terms; ++i) {
        const Sensitivity& d = derivatives_[static_cast<std::size_t>(i)];
        if (d.interior.size() == 0) continue;
        const Term& term = j_.terms[static_cast<std::size_t>(i)];
        auto sum = part.col(t).segment(i * count, count);
        sum = w.transpose() * d.interior.col(t);
        if (!term.work) sum += second_order(term, m, *a_.state, t, w);
        if (term.work) continue;
        for (const Column& c : columns)  // close to a ball the change is not small
          if (c.number == 0 && (centroid(m.mesh, t) - c.center).norm() < near_balls * c.radius)
            sum.segment(c.at, c.count) = changes_on(term, m, *a_.state, t, w.middleCols(c.at, c.count));
      }
    }
  });
  for (Eigen::Index k = 0; k < count; ++k) {
    const Column& c = columns[static_cast<std::size_t>(k)];
    c.of->far.setZero(terms);
    for (Index t = 0; t < triangles; ++t)
      if (t < c.first || t >= c.end)
        for (Eigen::Index i = 0; i < terms; ++i) c.of->far[i] += part(i * count + k, t);
  }
}

Scene Differences::starred_scene() const {
  Scene star = floored(a_.model->scene);
  if (p_.kind == Kind::Inclusion) {
    star.material = p_.inclusion;
    std::fill(star.regions.begin(), star.regions.end(), p_.inclusion);
  }
  return star;
}

std::vector<Differences::Solved> Differences::solve(std::size_t ball, const BallMesh& mesh) {
  const Mesh& whole = a_.model->mesh;
  const Kernel& kernel = a_.model->inner->kernel;
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
  const Eigen::Index nb = static_cast<Eigen::Index>(contours[0].size()) * a_.model->inner->skeleton.per_edge;
  const Scene scene = floored(a_.model->scene);
  const bool body = static_cast<bool>(scene.body);
  const CondensedPiece full = condense(whole, shells(0, all), contours[0], kernel, scene, false);
  const Scene star = starred_scene();
  for (const auto& b : bodies_) {
    if (b->ball == ball) continue;
    b->ball = ball;
    const Eigen::Index kept = b->operators().inner->ordering.interface_rows,
                       contact = b->operators().inner->ordering.contact_rows,
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

  std::vector<Solved> solved(static_cast<std::size_t>(count));
  parallel_tasks(count, a_.model->threads, [&](Index number) {
    Solved& of = solved[static_cast<std::size_t>(number)];
    const Index k = number + 1;
    of.disc = shells(k, all);
    of.contour = contours[k];
    const std::vector<bool>& disc = of.disc;
    std::vector<Index> both = contours[0];
    both.insert(both.end(), contours[k].begin(), contours[k].end());
    of.annulus.emplace(condense(whole, shells(0, k), both, kernel, scene, false));
    const CondensedPiece& annulus = *of.annulus;
    const auto A00 = annulus.K.topLeftCorner(nb, nb);
    const auto A0k = annulus.K.topRightCorner(nb, nb);
    const auto Akk = annulus.K.bottomRightCorner(nb, nb);
    std::optional<CondensedPiece>& inner = of.inner;
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
      const Eigen::VectorXd before = on_edges(m.inner->skeleton, contours[k], b->state->skeleton);
      const Eigen::VectorXd pull = forces_from(m, *b->state, contours[k], disc);
      Change c;
      Eigen::VectorXd r0;
      if (p_.kind == Kind::ClampedHole) {
        c.contour = -before;
        r0 = -A0k * c.contour;
      } else {
        c.load = pull;
        // A stiff disc must not feel the rounding of its rigid motion.
        if (inner) c.load -= inner->K * strained(m, contours[k], before) - inner->load;
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
          motion[static_cast<std::size_t>(i)] =
              b->status[static_cast<std::size_t>(i)] == ContactStatus::Open ? Motion::Forward : Motion::Held;
        const Contact contact = dual_qp(Sc, Sc * b->jump + rc - b->force, b->points, motion);
        if (!contact.converged)
          throw Error(Fault::Numerics, "contact did not settle in the body with a change of finite size");
        // With the set known, the change itself: rows that close or stay closed have their jump given, the others
        // their force.
        std::vector<Eigen::Index> free, held;
        Eigen::VectorXd given = Eigen::VectorXd::Zero(nc);
        for (Eigen::Index i = 0; i < nc; ++i) {
          const bool holds = contact.motion[static_cast<std::size_t>(i)] == Motion::Held;
          const ContactStatus was = b->status[static_cast<std::size_t>(i)];
          if (was != ContactStatus::Biactive && holds != (was == ContactStatus::Closed)) c.same = false;
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
      if (inner) {
        const Eigen::VectorXd after = before + c.contour;
        change +=
            energy_inside(inner_state(*inner, kernel, star, body ? after : strained(m, contours[k], after), body));
      }
      const Eigen::VectorXd outside = inner ? Eigen::VectorXd(A0k.transpose() * c.ball + Akk * c.contour) : c.load;
      change += b->force.dot(c.contact) - pull.dot(c.contour) + 0.5 * (outside.dot(c.contour) + c.push.dot(c.contact));
      of.energy.push_back(change);
      if (of.changes.empty()) {
        Eigen::VectorXd mine(S.rows());
        mine << c.ball, c.contact;
        of.others = b->others * mine;
      }
      of.changes.push_back(std::move(c));
    }
  });

  return solved;
}

std::vector<std::vector<Difference>> Differences::all(const std::vector<BallMesh>& balls) {
  const Model& m = *a_.model;
  std::vector<std::vector<Solved>> solved;
  for (std::size_t b = 0; b < balls.size(); ++b) solved.push_back(solve(b, balls[b]));
  if (fields_) outside(solved);
  std::vector<std::vector<Difference>> results;
  for (std::size_t b = 0; b < balls.size(); ++b) {
    auto& of_ball = results.emplace_back();
    Field near;  // the change inside the ball; every radius overwrites the ring that it uses
    if (fields_) near.interior.setZero(interior_count(m.element), static_cast<Eigen::Index>(m.mesh.triangles.size()));
    for (Solved& of : solved[b]) of_ball.push_back(finish(b, of, near));
  }
  return results;
}

Difference Differences::finish(std::size_t ball, Solved& of, Field& near) const {
  const Model& m = *a_.model;
  Difference result{.same_contact = of.same_contact};
  std::optional<InnerState> starred;
  if (fields_) {
    const Change& c = of.changes[0];
    Eigen::VectorXd edges(c.ball.size() + c.contour.size());
    edges << c.ball, c.contour;
    const Ordering& o = bodies_[0]->operators().inner->ordering;
    near.skeleton.setZero(m.inner->skeleton.total);
    near.force.setZero(m.inner->skeleton.total);
    for (Index u = 0; u < m.inner->skeleton.total; ++u) {
      if (o.row[u] == none) continue;
      near.skeleton[u] = far_(o.row[u], of.column);
      if (const Index trailing = o.row[u] - (o.size - o.contact_rows); trailing >= 0) near.force[u] = c.push[trailing];
    }
    const Scene scene = floored(m.scene);
    add_fields(near, *of.annulus, complete(*of.annulus, edges, false), m.inner->kernel, scene);
    if (of.inner)
      starred.emplace(inner_state(*of.inner, m.inner->kernel, starred_scene(),
                                  on_edges(m.inner->skeleton, of.contour, a_.state->skeleton) + c.contour,
                                  static_cast<bool>(scene.body)));
  }
  std::vector<bool> ring(of.disc.size(), false);
  for (Index t = filled_.first_triangle[ball]; t < filled_.first_triangle[ball + 1]; ++t) ring[t] = !of.disc[t];
  for (std::size_t i = 0; i < j_.terms.size(); ++i) {
    const Term& term = j_.terms[i];
    double d = 0;
    if (term.energy)
      d = of.energy[0];
    else if (term.measured)
      d = of.energy[1] - of.energy[0];
    else if (term.work && self_adjoint_)
      d = -2 * of.energy[0];
    else {
      if (fields_) {
        d = of.far[static_cast<Eigen::Index>(i)];
        d += term.work ? derivatives_[i].skeleton.dot(near.skeleton) : surface_difference(term, m, *a_.state, near);
        d += term.work ? work_difference(m, *a_.state, near, of.disc, ring, starred ? &*starred : nullptr)
                       : domain_difference(term, m, *a_.state, near, ring);
      }
      if (term.density) {
        d -= integral_over(term, m, *a_.state, of.disc);
        if (starred)
          d += integral(term, starred->model, starred->state);
        else if (p_.kind == Kind::Inclusion)
          d += integral_over(term, m, *a_.state, of.disc);  // constant densities stay
      }
    }
    if (term.power == 1) {
      result.value += term.factor * d;
    } else {  // (I + d)^power - I^power
      const double before = std::pow(a_.term_value[i], 1 / term.power);
      if (before == 0)
        result.value += term.factor * std::pow(std::max(d, 0.0), term.power);
      else
        result.value += term.factor * a_.term_value[i] * std::expm1(term.power * std::log1p(d / before));
    }
  }
  return result;
}

}  // namespace kerf
