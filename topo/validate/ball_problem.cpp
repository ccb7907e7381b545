// The difference problem of one ball: the unknown is the change w of the state when a disc inside is changed, not the
// changed state, so that nothing large is subtracted [theory: V.2, V.3, V.4, V.5]. The body is condensed once onto the
// balls' boundaries and the contact rows (W, the Schur complement of its factor). For one ball the others are
// eliminated and the ball's own matrix is taken off: S is the body around it. Per radius
//   K w = q,   K the annulus (ball boundary 0, contour k) + S on ball and contact rows,   q = moments of sigma n,
// with the new content K* added on the contour, or w = -u there for a clamp. Contour first, then ball, then contact:
// the rows in contact alone are a complementarity problem, solved for their set; then once more linearly for the change
// itself, with the jumps of held rows and the forces of the others given. The energy of the change is exact:
//   dPi = -Pi_D(u) [+ Pi*_D] - q.w + p_c.w_j + 1/2 (q.w + g.w_j).
// Derived in docs/theory/validation.md, section "The difference problem".

#include "topo/validate/ball_problem.hpp"

#include "base/dense.hpp"
#include "base/parallel.hpp"
#include "solver/tangent_cone.hpp"
#include "topo/validate/ball_fields.hpp"

#include <Eigen/Cholesky>

#include <algorithm>

namespace kerf {

DifferenceSetting::DifferenceSetting(const Model& m, const Perturbation& p, const Scene& filling)
    : whole(m.mesh),
      kernel(m.inner->kernel),
      scene(floored(m.scene)),
      inner_scene(floored(filling)),
      becomes(row(p).becomes),
      body(scene.body || has_eigenstrain(scene)) {}

std::vector<bool> BallInMesh::shells(Index from, Index to) const {
  std::vector<bool> use(triangles, false);
  for (Index t = first; t < end; ++t) {
    const Index shell = mesh.shell[static_cast<std::size_t>(t - first)];
    use[t] = shell >= from && shell < to;
  }
  return use;
}

// What the state holds on the contact rows: jumps less what is prescribed, forces, and which way rows move.
BodyOperator::BodyOperator(const Model& m, const Field& s, const Preparation& how) : model(&m), state(&s) {
  // A penalized matrix, or one without the balls' rows, is factorized anew with floored compliances and no penalty.
  if (m.inner->system.penalty > 0 || m.inner->ordering.interface_rows == 0) {
    Preparation without = how;
    without.plain = true;
    plain = std::make_unique<Model>(prepare(m.mesh, m.inner->kernel.element, floored(m.scene), m.threads, without));
  }
  const Inner& o = *operators().inner;
  W = o.factor->interface_complement();
  o.semicoercive.release(W.bottomRightCorner(o.ordering.contact_rows, o.ordering.contact_rows));
  const Index trailing = o.ordering.contact_rows, leading = o.ordering.size - trailing;
  status = contact_status(m, s);
  jump.resize(trailing);
  force.resize(trailing);
  for (Index u = m.inner->skeleton.base; u < m.inner->skeleton.total; ++u) {
    const Index row = o.ordering.row[u];
    if (row < leading) continue;
    jump[row - leading] = s.skeleton[u] - m.inner->skeleton.prescribed[u];
    force[row - leading] = s.force[u];
  }
  points = contact_points(operators());  // what slides freely is a row of no law
  motion.assign(status.size(), Motion::Held);
  for (std::size_t i = 0; i < motion.size(); ++i)
    if (status[i] == ContactStatus::Open)
      // The jump of an open normal row is positive; that of a tangential row has the direction of slip.
      motion[i] = jump[static_cast<Eigen::Index>(i)] < 0 ? Motion::Backward : Motion::Forward;
}

// S = W_mm - W_mr W_rr^-1 W_rm - K, m this ball and the contact rows, r the other balls. half_ = L^-1 W_rm.
void BodyOperator::focus(const BallInMesh& ball, const Eigen::MatrixXd& K) {
  const Ordering& o = operators().inner->ordering;
  const Eigen::Index n = ball.unknowns, begin = static_cast<Eigen::Index>(ball.number) * n;
  std::vector<Eigen::Index> mine, rest;
  for (Eigen::Index i = 0; i < o.interface_rows; ++i) (i >= begin && i < begin + n ? mine : rest).push_back(i);
  for (Eigen::Index i = 0; i < o.contact_rows; ++i) mine.push_back(o.interface_rows + i);
  S = W(mine, mine);
  if (!rest.empty()) {
    rest_ = cholesky(W(rest, rest)).matrixL();
    half_ = W(rest, mine);
    rest_.triangularView<Eigen::Lower>().solveInPlace(half_);
    S.selfadjointView<Eigen::Lower>().rankUpdate(half_.transpose(), -1);
    S.triangularView<Eigen::StrictlyUpper>() = S.transpose();
  } else {
    half_.resize(0, static_cast<Eigen::Index>(mine.size()));
  }
  S.topLeftCorner(n, n) -= K;
}

// x_r = -W_rr^-1 W_rm x_m, by the factor of W_rr.
Eigen::VectorXd BodyOperator::others(const Eigen::VectorXd& mine) const {
  Eigen::VectorXd moved = -multiply(half_, mine);
  if (moved.size() > 0) rest_.triangularView<Eigen::Lower>().transpose().solveInPlace(moved);
  return moved;
}

namespace {

double direction(Motion m) {
  return static_cast<double>(m);
}

// Whether rows hold, or slide, other than in the state; rows of no law, and those that were undecided, aside.
bool same_motions(const BodyOperator& b, const std::vector<Motion>& motion) {
  const auto same = [&](Index i) {
    const auto k = static_cast<std::size_t>(i);
    return b.status[k] == ContactStatus::Biactive || motion[k] == b.motion[k];
  };
  return std::ranges::all_of(b.points, [&](const ContactPoint& p) {
    if (!same(p.normal)) return false;
    const auto n = static_cast<std::size_t>(p.normal);
    // Without resistance a row may slide either way with the same force 0.
    const bool resists = p.slip_bound > 0 || (p.friction > 0 && b.motion[n] == Motion::Held);
    return p.tangential == none || !resists || same(p.tangential);
  });
}

// What the forces of the moving rows change by, less the share of the pressures' change; and those shares.
std::vector<SlidingPoint> given_forces(const BodyOperator& b, const std::vector<Motion>& motion,
                                       Eigen::VectorXd& given) {
  std::vector<SlidingPoint> sliding;
  given = -b.force;
  for (const ContactPoint& p : b.points) {
    if (p.tangential == none) continue;
    const double against = -direction(motion[static_cast<std::size_t>(p.tangential)]);
    const bool closed = motion[static_cast<std::size_t>(p.normal)] == Motion::Held;
    given[p.tangential] += against * (p.slip_bound + (closed ? p.friction * b.force[p.normal] : 0));
    if (closed && p.friction > 0 && against != 0) sliding.push_back({p.normal, p.tangential, against * p.friction});
  }
  return sliding;
}

// The contact rows alone, everything else eliminated: S x = r + forces. Which rows hold, then the change itself: rows
// that close, stick, or stay so have their jump given, the others their force.
void settle(const BodyOperator& b, const Eigen::MatrixXd& S, const Eigen::VectorXd& r, BallChange& c) {
  // In terms of the changed state: S (j + w_j) = S j + r - p_c + (p_c + g).
  const Contact contact = dual_qp(S, S * b.jump + r - b.force, b.points, b.motion);
  if (!contact.converged)
    throw Error(Fault::Numerics, "contact did not settle in the body with a change of finite size");
  c.same = same_motions(b, contact.motion);
  Eigen::VectorXd given, jump = Eigen::VectorXd::Zero(S.rows());
  const std::vector<SlidingPoint> sliding = given_forces(b, contact.motion, given);
  std::vector<bool> held(contact.motion.size());
  for (std::size_t i = 0; i < held.size(); ++i) {
    held[i] = contact.motion[i] == Motion::Held;
    if (held[i]) jump[static_cast<Eigen::Index>(i)] = -b.jump[static_cast<Eigen::Index>(i)];
    if (held[i]) given[static_cast<Eigen::Index>(i)] = 0;
  }
  if (sliding.empty())
    c.contact = jump + OpenRows(S, held).jumps(r + given - S * jump);
  else
    c.contact = SlidingRows(S, contact.motion, {sliding}).jumps(r + given, &jump);
  c.push = S * c.contact - r;
}

// The steps of one radius: the annulus between the ball's boundary (0) and the contour (k), and what fills the disc.
class RadiusProblem {
 public:
  RadiusProblem(const DifferenceSetting& setting, const BallInMesh& ball, Index k, ChangedBall& of)
      : setting_(setting), ball_(ball), n_(ball.unknowns), of_(of) {
    of.disc = ball.shells(k, ball.all_shells());
    of.contour = ball.contours[k];
    std::vector<Index> both = ball.contours[0];
    both.insert(both.end(), of.contour.begin(), of.contour.end());
    const std::vector<bool> ring = ball.shells(0, k);
    of.annulus.emplace(condense({setting.whole, ring, both}, setting.kernel, setting.scene, false));
    if (setting.becomes == Becomes::Material)
      of.inner.emplace(
          condense({setting.whole, of.disc, of.contour}, setting.kernel, setting.inner_scene, setting.body));
    eliminate_contour();
  }

  // The state of the first body tells the load; ball and contact rows first, then the contour, then the energy.
  void solve(const BodyOperator& b) {
    const Before before{on_edges(b.model->inner->skeleton, of_.contour, b.state->skeleton),
                        forces_from(*b.model, *b.state, of_.contour, of_.disc)};
    BallChange c;
    const Eigen::VectorXd load = load_ball(b, before, c);
    Eigen::MatrixXd S = b.S;
    S.topLeftCorner(n_, n_) += outer_;
    move_ball(b, S, load, c);
    move_contour(c);
    of_.same_contact = of_.same_contact && c.same;
    of_.energy.push_back(energy(b, before, c));
    if (of_.changes.empty()) {
      Eigen::VectorXd mine(S.rows());
      mine << c.ball, c.contact;
      of_.others = b.others(mine);
    }
    of_.changes.push_back(std::move(c));
  }

 private:
  // On the contour: the state, and the forces of the disc.
  struct Before {
    Eigen::VectorXd displacement, pull;
  };

  auto K00() const {
    return of_.annulus->K.topLeftCorner(n_, n_);
  }
  auto K0k() const {
    return of_.annulus->K.topRightCorner(n_, n_);
  }
  auto Kkk() const {
    return of_.annulus->K.bottomRightCorner(n_, n_);
  }
  bool clamped() const {
    return setting_.becomes == Becomes::Clamp;
  }

  // outer_ = K00 - K0k (Kkk + K*)^-1 Kk0; a clamp gives the contour, and K00 remains.
  void eliminate_contour() {
    outer_ = K00();
    if (clamped()) return;
    // Kkk of the annulus, and of what fills the disc.
    Eigen::MatrixXd M = Kkk();
    if (of_.inner) M += of_.inner->K;
    middle_ = cholesky(M);
    outer_ -= multiply_transposed(K0k(), solve_from_right(K0k(), middle_));
  }

  // The load on the ball's boundary from what is given on the contour: a clamp its displacement, all others the forces
  // that the disc no longer bears.
  Eigen::VectorXd load_ball(const BodyOperator& b, const Before& before, BallChange& c) const {
    if (clamped()) {
      c.contour = -before.displacement;
      return -multiply(K0k(), c.contour);
    }
    c.load = before.pull;
    // A stiff disc must not feel the rounding of its rigid motion.
    if (of_.inner) c.load -= of_.inner->K * strained(*b.model, of_.contour, before.displacement) - of_.inner->load;
    return -multiply(K0k(), kerf::solve(middle_, c.load));
  }

  // The ball's boundary, after the rows in contact.
  void move_ball(const BodyOperator& b, const Eigen::MatrixXd& S, const Eigen::VectorXd& load, BallChange& c) const {
    const Eigen::Index contact = S.rows() - n_;
    // The ball is eliminated, contact settled by what is left, then the ball follows.
    const Eigen::LLT<Eigen::MatrixXd> of_ball = cholesky(S.topLeftCorner(n_, n_));
    c.contact.setZero(contact);
    c.push.setZero(contact);
    if (contact == 0) {
      c.ball = kerf::solve(of_ball, load);
      return;
    }
    const Eigen::MatrixXd couple = S.topRightCorner(n_, contact), answer = kerf::solve(of_ball, couple);
    Eigen::MatrixXd Sc = S.bottomRightCorner(contact, contact) - transposed_multiply(couple, answer);
    Sc = 0.5 * (Sc + Sc.transpose()).eval();
    settle(b, Sc, -transposed_multiply(answer, load), c);
    c.ball = kerf::solve(of_ball, load - multiply(couple, c.contact));
  }

  void move_contour(BallChange& c) const {
    if (clamped())
      c.load = K0k().transpose() * c.ball + Kkk() * c.contour;
    else
      c.contour = kerf::solve(middle_, c.load - transposed_multiply(K0k(), c.ball));
  }

  // Pi(x + w) - Pi(x) in the changed body, and what the change of the disc is at x itself.
  double energy(const BodyOperator& b, const Before& before, const BallChange& c) const {
    const Model& m = *b.model;
    double change = 0;
    for (Index t = ball_.first; t < ball_.end; ++t)
      if (of_.disc[t]) change -= energy_of(m, b.state->interior, t, material_of(m.mesh, m.scene, t));
    if (of_.inner) {
      const Eigen::VectorXd after = before.displacement + c.contour;
      change += energy_inside(inner_state(*of_.inner, setting_.kernel, setting_.inner_scene,
                                          setting_.body ? after : strained(m, of_.contour, after), setting_.body));
    }
    // `load` on the contour includes the force of a new content; outside the disc the annulus alone counts.
    const Eigen::VectorXd outside =
        of_.inner ? Eigen::VectorXd(K0k().transpose() * c.ball + Kkk() * c.contour) : c.load;
    change +=
        b.force.dot(c.contact) - before.pull.dot(c.contour) + 0.5 * (outside.dot(c.contour) + c.push.dot(c.contact));
    return change;
  }

  const DifferenceSetting& setting_;
  const BallInMesh& ball_;
  Eigen::Index n_;
  ChangedBall& of_;
  Eigen::LLT<Eigen::MatrixXd> middle_;  // of the contour
  Eigen::MatrixXd outer_;               // the annulus and what fills the disc on the ball's boundary
};

}  // namespace

std::vector<ChangedBall> solve_ball(const DifferenceSetting& setting, const BallInMesh& ball,
                                    std::vector<BodyOperator>& bodies) {
  const Index radii = ball.all_shells() - 1;
  {
    const std::vector<bool> whole = ball.shells(0, ball.all_shells());
    // The ball as it is: what is taken off W before its own pieces are put in.
    const CondensedPiece full =
        condense({setting.whole, whole, ball.contours[0]}, setting.kernel, setting.scene, false);
    for (BodyOperator& b : bodies) b.focus(ball, full.K);
  }
  std::vector<ChangedBall> changed(static_cast<std::size_t>(radii));
  parallel_tasks(radii, bodies.front().model->threads, [&](Index number) {
    RadiusProblem problem(setting, ball, number + 1, changed[static_cast<std::size_t>(number)]);
    for (const BodyOperator& b : bodies) problem.solve(b);
  });
  return changed;
}

}  // namespace kerf
