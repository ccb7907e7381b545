// The state of a body whose parts several processes have. Each condenses its own triangles and knows neighbors around
// them, so that with its own rows u it has all forces on them,
//   r_u = F_u - sum_{T touching u} (K_T P_T x)_u,   x_u <- x_u + (K^-1 r)_u   [theory: E.34],
// K^-1 by conjugate gradients of all processes (solver/system/bddc.cpp). The first process that sees an unknown answers
// for it, and tells the others its values; x is kept in twice the precision. Contact is an active set: each set of held
// rows is a system of its own, in which moving jumps are rows like all others [theory: C.31]. Uniform pressures of
// nearly incompressible pieces take a solve each [theory: E.23]. Certificates are sums and largest values over
// processes [theory: E.20, E.21]. All processes call the same functions in the same order: a branch that only some take
// would leave the others waiting. Derived in docs/theory/elements.md, section Solving in parts.

#include "solver/state/shared_body.hpp"

#include "base/dense.hpp"
#include "base/kept_memory.hpp"
#include "base/stopwatch.hpp"
#include "solver/contact/law.hpp"
#include "solver/factor.hpp"
#include "solver/state/guess.hpp"
#include "solver/state/solve.hpp"
#include "solver/system/bddc.hpp"
#include "solver/system/parted.hpp"
#include "solver/system/penalty.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

namespace kerf {

// The bytes go before the factor comes: a part has a place once.
std::unique_ptr<SharedSolver> Communicator::solver(std::string packed, Index, int threads, Precision precision) {
  PartMatrix part;
  {
    const LoggedWork logged(*this, PartsWork::Assembly);
    part = condensed_part(packed);
    std::string().swap(packed);
  }
  const LoggedWork logged(*this, PartsWork::SetUp);
  return bddc(std::move(part), *this, threads, precision);
}

Sums sums_over(Communicator& comm) {
  return {[&comm](std::span<double> v) { comm.sum(v); }, [&comm](std::span<double> v) { comm.largest(v); }};
}

double sum(Communicator& comm, double value) {
  comm.sum({&value, 1});
  return value;
}

// Among processes, by the triangles that hold on to each other (solver/system/parted.hpp).
std::vector<Index> shares(const Model& m, const Partitioner& partitioner) {
  return partition({m.mesh, m.inner->kernel, m.inner->skeleton, m.scene, m.inner->data, m.inner->ordering},
                   partitioner);
}

std::vector<Index> pieces_for_pressure(const Mesh& mesh, const Scene& scene) {
  constexpr Index most = 30;  // each costs a solve, and a vector of all that a process sees
  return material_pieces(mesh, scene, most);
}

namespace {

/// What the first process has, on all: whatever their processors make of the same numbers.
/// Processors may differ in the last bit of a decision; a set that differs between processes would make each wait for
/// another solve.
void agree(Communicator& comm, std::vector<Motion>& motion, Eigen::VectorXd& force) {
  std::string bytes;
  if (comm.here() == 0) {
    bytes.assign(reinterpret_cast<const char*>(motion.data()), motion.size() * sizeof(Motion));
    bytes.append(reinterpret_cast<const char*>(force.data()), static_cast<std::size_t>(force.size()) * sizeof(double));
  }
  const std::string from = comm.exchange(std::vector<std::string>(static_cast<std::size_t>(comm.count()), bytes))[0];
  std::memcpy(motion.data(), from.data(), motion.size() * sizeof(Motion));
  std::memcpy(force.data(), from.data() + motion.size() * sizeof(Motion), from.size() - motion.size() * sizeof(Motion));
}

/// Where triangle t keeps what it sees: on the right of a crack that parts freely in the place of the jump.
struct Places {
  std::array<Index, max_skeleton> at;
  int count = 0;
};
Places places(const Model& m, const Ordering& o, Index t) {
  const Seen view = seen(m.mesh, m.inner->skeleton, t);
  Places p{.count = view.count};
  for (int i = 0; i < view.count; ++i)
    p.at[static_cast<std::size_t>(i)] = unknown_of_trace(o, view.base[i], view.jump[i]);
  return p;
}
/// The jumps that it sees, or none.
Places jumps(const Model& m, Index t) {
  const Seen view = seen(m.mesh, m.inner->skeleton, t);
  return {view.jump, view.count};
}

}  // namespace

// The balance comes before contact is found: it makes the model anew.
SharedBody::Impl::Impl(MeshPart given, const Element& e, Scene scene, int threads, const Floating& floating,
                       const std::vector<Index>& of_whole, Communicator& with, const std::shared_ptr<const Mesh>& whole)
    : comm(with),
      shown(std::move(given.shown)),
      also_here(std::move(given.seen)),
      process(given.process),
      model(prepare_part(std::move(given.mesh), e, std::move(scene), threads,
                         {given.own, with.here(), given.process, whole}, floating)) {
  if (!floating.motions.empty()) balance({given.own, with.here(), given.process, whole}, floating);
  find_contact({given.from, given.whole});
  std::vector<Index> piece;
  for (const Index t : given.origin) piece.push_back(of_whole[static_cast<std::size_t>(t)]);
  uniform = UniformPressure(std::move(piece));
  for (Index u = 0; u < model.inner->skeleton.total; ++u)
    if (model.inner->ordering.row[u] != none && owns(model, u)) ++unknowns;
  unknowns = static_cast<Index>(sum(comm, unknowns));
}

// G_ij = int r_i . r_j of (A.7).
Eigen::MatrixXd SharedBody::Impl::gram() {
  const Inner& inner = *model.inner;
  Eigen::MatrixXd g = gram_of(model.mesh, inner.kernel, inner.skeleton, inner.floating, own_triangles(model));
  comm.sum({g.data(), static_cast<std::size_t>(g.size())});
  return g;
}

// Works are summed before they are compared: the loads of the body balance, not those of a part. Whether they do at all
// was asked of the mesh before it was divided (prepare).
void SharedBody::Impl::balance(OwnShare own, const Floating& floating) {
  const Inner& inner = *model.inner;
  const auto n = static_cast<Eigen::Index>(floating.motions.size());
  Eigen::VectorXd net(n), size(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Work w = work_on(model.mesh, inner.kernel, inner.skeleton, {model.scene, inner.data},
                           floating.motions[static_cast<std::size_t>(i)], own_triangles(model));
    net[i] = w.value;
    size[i] = w.size;
  }
  comm.sum({net.data(), static_cast<std::size_t>(n)});
  comm.sum({size.data(), static_cast<std::size_t>(n)});
  constexpr double exact = 1e-12;
  if ((net.cwiseAbs().array() <= exact * size.array()).all()) return;
  Scene scene = balanced(std::move(model.scene), floating.motions, solve_spd(gram(), net));
  Mesh mesh = std::move(model.mesh);
  model = prepare_part(std::move(mesh), model.element, std::move(scene), model.threads, std::move(own), floating);
}

// Numbers of rows: those of process 0 first, each process's in the order of its unknowns; neighbors learn them from
// those who answer. Held rows have no number, so that a new set is a new system.
void SharedBody::Impl::make_system(const std::vector<bool>& rows) {
  effort_before = effort();
  exchanged.clear();
  now = {.held = rows};
  return_freed_memory();  // of the system before: one has a place at a time
  const Inner& inner = *model.inner;
  const Skeleton& s = inner.skeleton;
  std::vector<bool> held_unknown(static_cast<std::size_t>(s.total), false);
  for (Index u = s.base; u < s.total && contact_rows > 0; ++u)
    held_unknown[u] = contact_of[u] != none && rows[contact_of[u]];
  now.order = as_numbered(s, &held_unknown);
  now.holder = holders(model.mesh, s, now.order, process);
  for (Index u = 0; u < s.total; ++u)
    if (now.order.row[u] != none && now.holder[u] == comm.here()) now.own_unknowns.push_back(u);
  // Own rows, in order, are numbers [first, first + own_rows()) among those of all.
  const std::vector<Index> counts = gathered(comm, std::vector<Index>{now.own_rows()});
  Index first = 0, total = 0;
  for (Index p = 0; p < comm.count(); ++p) {
    if (p < comm.here()) first += counts[static_cast<std::size_t>(p)];
    total += counts[static_cast<std::size_t>(p)];
  }
  now.total = total;
  Eigen::VectorXd at = Eigen::VectorXd::Constant(s.total, none);
  for (Index i = 0; i < now.own_rows(); ++i) at[now.own_unknowns[i]] = static_cast<double>(first + i);
  spread(at, now.holder, [&](Index t) { return places(model, now.order, t); });
  std::vector<Index> numbers(static_cast<std::size_t>(now.order.size), none);
  for (Index u = 0; u < s.total; ++u)
    if (now.order.row[u] != none) numbers[now.order.row[u]] = static_cast<Index>(at[u]);
  const Assembly from{model.mesh, inner.kernel, s, model.scene, inner.data, now.order};
  std::vector<Index> own(static_cast<std::size_t>(inner.own->triangles));
  std::iota(own.begin(), own.end(), 0);
  now.solver =
      comm.solver(packed_part({from, inner.system.penalty, corners_at_free_cracks(from), numbers}, own, now.own_rows()),
                  total, model.threads, precision);
  stiffest = now.solver->stiffest();
  comm.largest({&stiffest, 1});
}

// Each set of held rows has a solver of its own; their counts add up, the largest values stand.
SharedEffort SharedBody::Impl::effort() const {
  if (!now.solver) return effort_before;
  SharedEffort e = now.solver->effort();
  e.solves += effort_before.solves;
  e.iterations = std::max(e.iterations, effort_before.iterations);
  e.condition = std::max(e.condition, effort_before.condition);
  e.sent = std::max(e.sent, effort_before.sent);
  e.seconds += effort_before.seconds;
  e.unfinished += effort_before.unfinished;
  if (e.ended.empty()) e.ended = effort_before.ended;
  return e;
}

// Two exchanges: from those who answer for an unknown to the processes that show them its triangle; then from every
// process, which knows what its own triangles see, to neighbors of neighbors. Without `seen_here` a value that nobody
// had told would overwrite one that is known.
template <typename Where>
void SharedBody::Impl::spread(Eigen::VectorXd& values, const std::vector<Index>& holder, const Where& where) {
  std::vector<bool> seen_here(static_cast<std::size_t>(values.size()), false);
  for (Index t = 0; t < model.inner->own->triangles; ++t) {
    const Places p = where(t);
    for (int i = 0; i < p.count; ++i)
      if (p.at[i] != none) seen_here[p.at[i]] = true;
  }
  const auto once = [&](const auto& takes) {
    std::vector<std::string> to(static_cast<std::size_t>(comm.count()));
    for (std::size_t p = 0; p < to.size(); ++p)
      for (const Index t : shown[p]) {
        const Places place = where(t);
        for (int i = 0; i < place.count; ++i) {
          const double value = place.at[i] == none ? 0 : values[place.at[i]];
          to[p].append(reinterpret_cast<const char*>(&value), sizeof value);
        }
      }
    const std::vector<std::string> from = comm.exchange(to);
    for (std::size_t p = 0; p < from.size(); ++p) {
      const char* at = from[p].data();
      for (const Index t : also_here[p]) {
        const Places place = where(t);
        for (int i = 0; i < place.count; ++i, at += sizeof(double))
          if (const Index u = place.at[i]; u != none && takes(u, static_cast<Index>(p)))
            std::memcpy(&values[u], at, sizeof(double));
      }
    }
  };
  once([&](Index u, Index p) { return holder[u] == p; });
  // Now every process knows what its own triangles see, and tells the others of them.
  once([&](Index u, Index) { return !seen_here[u]; });
}

// Points of all processes are known to all, because the active set decides on all of them at once, on every process
// alike.
void SharedBody::Impl::find_contact(const PartOfPaths& paths) {
  const Skeleton& s = model.inner->skeleton;
  const Ordering& o = model.inner->ordering;
  std::vector<ContactPoint> own;
  std::vector<Index> unknown_of(static_cast<std::size_t>(o.contact_rows), none);
  const Index leading = leading_rows();
  for (Index u = s.base; u < s.total; ++u)
    if (o.row[u] != none && o.row[u] >= leading) unknown_of[o.row[u] - leading] = u;
  Index rows = 0;
  const auto number = [&](Index row) {
    if (row == none) return none;
    own_contact.push_back(unknown_of[row]);
    return rows++;
  };
  for (const ContactPoint& p : contact_points(model)) {
    if (!owns(model, unknown_of[p.normal])) continue;
    ContactPoint q = p;
    q.normal = number(p.normal);
    q.tangential = number(p.tangential);
    own.push_back(q);
  }
  // Points of process p come behind those of lower ones, and so do their rows.
  const std::vector<Index> counts = gathered(comm, std::vector<Index>{rows}),
                           sizes = gathered(comm, std::vector<Index>{static_cast<Index>(own.size())});
  points = gathered(comm, own);
  std::size_t next = 0;
  Index offset = 0;
  for (Index p = 0; p < comm.count(); ++p) {
    if (p == comm.here()) first_contact = offset;
    for (Index k = 0; k < sizes[p]; ++k, ++next)
      for (Index* row : {&points[next].normal, &points[next].tangential})
        if (*row != none) *row += offset;
    offset += counts[p];
  }
  contact_rows = offset;
  if (contact_rows == 0) return;
  Eigen::VectorXd at = Eigen::VectorXd::Constant(s.total, none);
  for (std::size_t i = 0; i < own_contact.size(); ++i)
    at[own_contact[i]] = static_cast<double>(first_contact + static_cast<Index>(i));
  spread(at, model.inner->own->holder, [&](Index t) { return jumps(model, t); });
  contact_of.assign(static_cast<std::size_t>(s.total), none);
  for (const Index u : unknown_of) contact_of[u] = static_cast<Index>(at[u]);
  own_paths = {paths.from, paths.whole};
  gaps = on_contact(on_skeleton(model, Eigen::VectorXd::Zero(o.size), &s.prescribed));
}

// A guess goes by shares of the whole length of a crack, of which a part has pieces (PartOfPaths). Each process says
// what its own rows do.
std::vector<Motion> SharedBody::Impl::first_motions(const ContactGuess& guess) {
  const Inner& inner = *model.inner;
  if (contact_rows == 0 || guess.empty()) return {};
  const PartOfPaths paths{own_paths.first, own_paths.second};
  const std::vector<Motion> local = motions_of(model.mesh, inner.skeleton, inner.ordering, inner.kernel, guess, &paths);
  std::vector<Motion> own;
  for (const Index u : own_contact) own.push_back(local[inner.ordering.row[u] - leading_rows()]);
  return gathered(comm, own);
}

// Every row is own on one process, so that the sum puts the pieces together.
Eigen::VectorXd SharedBody::Impl::on_contact(const Eigen::VectorXd& values) {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(contact_rows);
  for (std::size_t i = 0; i < own_contact.size(); ++i)
    all[first_contact + static_cast<Index>(i)] = values[own_contact[i]];
  comm.sum({all.data(), static_cast<std::size_t>(all.size())});
  return all;
}

// The unknowns of a solve on a crack that parts freely are z = (u, u + [u]): a force f_j on the jump acts on the
// second, and is taken off the first (E.30).
Eigen::VectorXd SharedBody::Impl::on_own_rows(const Eigen::VectorXd& forces) const {
  Eigen::VectorXd right(now.own_rows());
  for (Index i = 0; i < now.own_rows(); ++i) {
    const Index u = now.own_unknowns[i], jump = u < model.inner->skeleton.base ? jump_at(u) : none;
    right[i] = forces[u] - (parts_freely(now.order, jump) ? forces[jump] : 0);
  }
  return right;
}

// Trace and jump have their components in the same order.
Index SharedBody::Impl::jump_at(Index base) const {
  const Skeleton& s = model.inner->skeleton;
  const Index first = s.jump[base / s.per_edge];
  return first == none ? none : first + base % s.per_edge;
}

// Back from z: the jump moves by z_j - z_u.
void SharedBody::Impl::move(const Eigen::VectorXd& own, DoubleDouble& x) {
  const Skeleton& s = model.inner->skeleton;
  Eigen::VectorXd z = Eigen::VectorXd::Zero(s.total), moved = z;
  for (Index i = 0; i < now.own_rows(); ++i) z[now.own_unknowns[i]] = own[i];
  spread(z, now.holder, [&](Index t) { return places(model, now.order, t); });
  for (Index u = 0; u < s.base; ++u) {
    if (now.order.row[u] != none) moved[u] = z[u];
    if (const Index j = jump_at(u); parts_freely(now.order, j)) moved[j] = z[j] - z[u];
  }
  add(x, 1, moved);
}

// K x - F from the stresses, triangle by triangle; on unknowns of others it lacks the triangles that are not here. Each
// unknown counts where it is answered for, triangles where they are own.
void SharedBody::Impl::judge(Round& r, Field& field) {
  const Skeleton& s = model.inner->skeleton;
  const Ordering& o = model.inner->ordering;
  const Balance balance = recover_interior(model, r.x, r.theta, field);
  applied = balance.loads;
  r.unmet = balance.forces - applied;
  Driven driven = driven_by(model, balance, r.x, stiffest, sums_over(comm));
  std::array<double, 2> most{0, r.x.high.allFinite() ? 0.0 : 1.0};
  for (Index u = 0; u < s.total; ++u)
    if (owns(model, u) && o.row[u] != none && o.row[u] < leading_rows())
      most[0] = std::max(most[0], std::abs(r.unmet[u]));
  comm.largest(most);
  r.certificate.residual = most[0] / driven.largest;
  double law = 0;
  // Forces of contact are known on all rows that are seen here, own or not; their work is that of own rows.
  field.force = Eigen::VectorXd::Zero(s.total);
  if (contact_rows > 0) {
    const JudgedContact judged =
        judge_contact(points, r.motion, on_contact(r.x.high) - gaps, on_contact(r.unmet), driven.largest);
    r.certificate.residual = std::max(r.certificate.residual, judged.residual);
    law = judged.law;
    for (Index u = s.base; u < s.total; ++u)
      if (contact_of[u] != none) field.force[u] = judged.bears[contact_of[u]];
    for (const Index u : own_contact) driven.work += field.force[u] * (r.x.high[u] - s.prescribed[u]);
  }
  const JudgedWork work = judge_work(model, balance, driven, 0, field, sums_over(comm));
  r.size = work.size;
  r.certificate.work = work.error;
  r.certificate.kkt = most[1] == 0 ? std::max({r.certificate.residual, law, r.penalty_error}) : infinity;
}

// The active set asks for responses; each is the body moved on by what its forces leave unmet, so that later sets begin
// near their solution. Held jumps are put to first contact before, which leaves new forces unmet.
void SharedBody::Impl::correct(Round& r, State& state) {
  if (contact_rows == 0) {
    hold({});
    settle(-r.unmet, r.x);
    ++state.linear_solves;
    return;
  }
  const Skeleton& s = model.inner->skeleton;
  const LoggedWork logged(comm, PartsWork::Contact);
  const auto respond = [&](const std::vector<Motion>& wanted, const Eigen::VectorXd& given) -> Response {
    // All take the decisions of the first process.
    std::vector<Motion> motion = wanted;
    Eigen::VectorXd force = given.size() == contact_rows ? given : Eigen::VectorXd::Zero(contact_rows);
    agree(comm, motion, force);
    hold(held_by(motion, contact_rows));
    Eigen::VectorXd closed = Eigen::VectorXd::Zero(s.total);  // jumps that are taken back
    for (Index u = s.base; u < s.total; ++u)
      if (contact_of[u] != none && held[contact_of[u]]) {
        closed[u] = s.prescribed[u] - r.x.high[u] - r.x.low[u];
        r.x.high[u] = s.prescribed[u];
        r.x.low[u] = 0;
      }
    r.unmet += forces_at_contact(closed);
    Eigen::VectorXd rest = -r.unmet;
    for (Index u = s.base; u < s.total; ++u)
      if (contact_of[u] != none && !held[contact_of[u]]) rest[u] += force[contact_of[u]];
    const Eigen::VectorXd change = forces_at_contact(settle(rest, r.x));
    ++state.linear_solves;
    // Elsewhere nothing is left but what the solve leaves, which the next round sees.
    for (Index u = 0; u < s.total; ++u) r.unmet[u] = contact_of[u] == none ? 0 : r.unmet[u] + change[u];
    return {on_contact(r.x.high) - gaps, on_contact(r.unmet)};
  };
  const Contact found = active_set(
      {.rows = contact_rows, .solve = respond, .most_iterations = 500, .trusts_guess = true}, points, r.motion);
  r.motion = found.motion;
  state.contact_iterations += found.iterations;
  state.converged = found.converged;
}

// The change and the size are the largest of all processes, so that all see the same error and end in the same round.
void SharedBody::Impl::step_theta(const Loads& loads, Round& r, int& solves, bool must_fit) {
  const auto respond = [this](const Eigen::VectorXd& theta) {
    const Skeleton& s = model.inner->skeleton;
    Eigen::VectorXd force = Eigen::VectorXd::Zero(s.total);
    DoubleDouble x{force, force};
    for (Index t = 0; t < static_cast<Index>(theta.size()); ++t) {
      if (theta[t] == 0) continue;
      const Seen view = seen(model.mesh, s, t);
      for (int i = 0; i < view.count; ++i)
        for (const Index u : {view.base[i], view.jump[i]})
          if (u != none) force[u] -= theta[t] * model.inner->system.traces(i, t);
    }
    settle(force, x);
    return x.high;
  };
  const PressedBody body{.model = model,
                         .loads = loads,
                         .respond = respond,
                         .skeleton = [](const Eigen::VectorXd& x) { return x; },
                         .over_all = sums_over(comm)};
  const int before = uniform.solves();
  uniform.must_fit = must_fit;
  const Eigen::VectorXd delta = uniform.correct(body, held, r.x, r.theta);
  solves += uniform.solves() - before;
  add(r.x, 1, multiply(uniform.response(), delta));
  if (uniform.level_open()) uniform.take_out_level(body, r.x, r.theta);
  const ThetaChange moved = move_theta(model, loads, r.x, r.theta);
  std::array<double, 2> both{moved.change, moved.size};
  comm.largest(both);
  r.penalty_error = both[1] > 0 ? both[0] / both[1] : 0;
}

// r.K^-1 r of (E.21) takes one more solve.
State SharedBody::Impl::solve(const ContactGuess& guess, bool keep_factor) {
  State state;
  Stopwatch watch;
  const Loads loads = loads_of(model);
  const bool penalized = model.inner->system.penalty > 0;
  Round at{.x = {on_skeleton(model, Eigen::VectorXd::Zero(model.inner->ordering.size), &loads.prescribed),
                 Eigen::VectorXd::Zero(model.inner->skeleton.total)}};
  if (penalized) at.theta.setZero(static_cast<Eigen::Index>(model.mesh.triangles.size()));
  at.motion = first_motions(guess);
  judge(at, state);
  const auto round = [&](Round& r) {
    correct(r, state);
    if (penalized) step_theta(loads, r, state.linear_solves, true);
    judge(r, state);
    return r.certificate.kkt;
  };
  // Of a body that is moved as a whole the energy is rounding, which a residual that is small does not tell.
  const auto enough = [&](const Round& r, double error) {
    return error <= (penalized ? 1e-16 : 1e-12) && r.certificate.work <= RoundsEnd::settled;
  };
  auto [best, is_last] = best_round(std::move(at), penalized, penalized ? 40 : 15, round, enough);
  if (!is_last) judge(best, state);
  if (penalized && uniform.level_open() && contact_rows > 0) throw Error(Fault::Numerics, open_level);
  // The part of the rest that nothing answers, and the energy of the error that it stands for.
  const Eigen::VectorXd rest = best.unmet - state.force;
  DoubleDouble answer{Eigen::VectorXd::Zero(rest.size()), Eigen::VectorXd::Zero(rest.size())};
  settle(rest, answer);
  const double error = std::abs(work(rest, answer.high));
  state.certificate = best.certificate;
  if (best.size > 0) state.certificate.work = std::max(state.certificate.work, std::sqrt(error / best.size));
  state.skeleton = std::move(best.x.high);
  state.eigenstrain = model.inner->data.strain.empty() ? 0 : 1;
  if (!model.inner->floating.empty()) {
    Eigen::VectorXd moments = floating_moments(model, state);
    comm.sum({moments.data(), static_cast<std::size_t>(moments.size())});
    remove_motions(model, solve_spd(gram(), moments), state);
  }
  if (!keep_factor) drop_factor();
  state.seconds.solve = watch.lap();
  return state;
}

// The factors of the insides are most of the memory. What has been counted stays.
void SharedBody::Impl::drop_factor() {
  effort_before = effort();
  now.solver.reset();  // the most memory of all
  exchanged.clear();
  products.reset();
}

SharedBody::SharedBody(MeshPart part, const Element& e, Scene scene, int threads, const Floating& floating,
                       const std::vector<Index>& piece, Communicator& comm, std::shared_ptr<const Mesh> whole,
                       Precision precision)
    : impl_(std::make_unique<Impl>(std::move(part), e, std::move(scene), threads, floating, piece, comm, whole)) {
  impl_->precision = precision;
}
SharedBody::SharedBody(SharedBody&&) noexcept = default;
SharedBody::~SharedBody() = default;
const Model& SharedBody::model() const {
  return impl_->model;
}
Index SharedBody::unknowns() const {
  return impl_->unknowns;
}
State SharedBody::solve(const ContactGuess& guess, bool keep_factor) {
  return impl_->solve(guess, keep_factor);
}
TangentField SharedBody::solve_adjoint(const Field& state, const Sensitivity& dJ) {
  return impl_->solve_adjoint(state, dJ);
}
OneSided SharedBody::one_sided(const Field& state) {
  return impl_->one_sided(state);
}
Eigen::VectorXd SharedBody::solve_open(const Eigen::VectorXd& forces) {
  return impl_->solve_open(forces);
}
void SharedBody::drop_factor() {
  impl_->drop_factor();
}
SharedEffort SharedBody::effort() const {
  return impl_->effort();
}

}  // namespace kerf
