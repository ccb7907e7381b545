// Solutions on meshes that fit them: graded to the ends of contact, or refined in rounds until the estimated error is
// small enough. A round solves, estimates eta_T per triangle [theory: R.4, R.6], and makes the next mesh either by new
// sizes,
//   r_T ~ eta_T^(-1/(p + 1)),   p the order of the element      [theory: R.7],
// the fewest triangles for an error, or by bisecting the fewest triangles that carry half of the squared sum,
//   sum_marked eta_T^2 >= 1/2 sum_T eta_T^2      [Doerfler 1996; theory: R.8].
// What ends the rounds: the asked error, the number of triangles, three rounds without gain, 40 rounds, or the caller.
// A goal (the interval of a quantity) takes the place of the error of the stress. Contact begins on each mesh with what
// the faces did on the one before. docs/theory/recovery_and_estimates.md, "Error indicator".

#include "kerf/adaptive.hpp"
#include "kerf/recover.hpp"
#include "kerf/stop.hpp"

#include "geometry/adapt.hpp"
#include "solver/adapting.hpp"

#include "solver/system.hpp"

#include "base/stopwatch.hpp"
#include "solver/lone_cracks.hpp"
#include "solver/saddle_point.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace kerf {

namespace {

// The fewest triangles that carry half of the squared error.
// Sorted from the largest on; a stable sort, so that equal triangles keep their order on every machine.
std::vector<Index> mark(const Eigen::VectorXd& eta) {
  std::vector<Index> order(eta.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return eta[a] > eta[b]; });
  const double half = 0.5 * eta.squaredNorm();
  double sum = 0;
  std::size_t count = 0;
  while (count < order.size() && sum < half) sum += std::pow(eta[order[count++]], 2);
  order.resize(count);
  return order;
}

// Of the triangles before each was divided into four, so many times: those of one follow each other.
Eigen::VectorXd on_undivided(const Eigen::VectorXd& eta, int divisions) {
  if (divisions == 0) return eta;
  const Eigen::Index parts = Eigen::Index{1} << (2 * divisions);
  return eta.reshaped(parts, eta.size() / parts).colwise().norm();
}

State solved(const Model& model, const Adaptation& how) {
  return how.saddle_point ? solve_saddle_point(model) : solve(model, how.contact);
}

// Between two neighboring points of a crack of which one is open, slips or sticks and the other does something else.
struct End {
  Vec2 at;
  double gap;  // between the points
  double run;  // the shorter of the stretches that meet
};

/// A walk along the points of the profile. `does`: bit 0 closed, bit 1 sticking. `run` of an end is the shorter of the
/// two stretches that meet there: the longest runs are graded first, at most 32.
void add_ends(const Model& m, const Field& s, Index crack, std::vector<End>& ends) {
  const bool friction = has_friction(m.scene.laws[crack]);
  const std::vector<CrackPoint> points = crack_profile(m, s, crack);
  const auto does = [&](std::size_t i) {
    return (points[i].status == CrackPoint::Status::Closed ? 1 : 0) + (friction && points[i].jump_t == 0 ? 2 : 0);
  };
  // A single point between two that agree is what the mesh does not resolve.
  const auto alone = [&](std::size_t i) {
    return i > 0 && i + 1 < points.size() && does(i - 1) == does(i + 1) && does(i) != does(i - 1);
  };
  const std::size_t none_before = ends.size();
  double begin = 0;
  std::size_t before = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (alone(i)) continue;
    if (does(i) != does(before)) {
      const double at = 0.5 * (points[before].s + points[i].s);
      if (ends.size() > none_before) ends.back().run = std::min(ends.back().run, at - begin);
      ends.push_back({0.5 * (points[before].at + points[i].at), points[i].s - points[before].s, at - begin});
      begin = at;
    }
    before = i;
  }
  if (ends.size() > none_before) ends.back().run = std::min(ends.back().run, points.back().s - begin);
}

/// More ends than that are the noise of a mesh that does not resolve contact.
std::vector<End> ends_of(const Model& m, const Field& s) {
  std::vector<End> ends;
  for (Index c = 0; c < static_cast<Index>(m.mesh.cracks.size()); ++c)
    if (is_unilateral(m.scene.laws[c])) add_ends(m, s, c, ends);
  constexpr std::size_t most = 32;
  std::stable_sort(ends.begin(), ends.end(), [](const End& a, const End& b) { return a.run > b.run; });
  if (ends.size() > most) ends.resize(most);
  return ends;
}

std::vector<Vec2> places_of_ends(const std::vector<End>& ends) {
  std::vector<Vec2> at;
  for (const End& e : ends) at.push_back(e.at);
  return at;
}

// The solutions of one body on meshes that are graded better and better.
// `once` meshes and solves; `solve` repeats it with the ends of contact that it finds until they lie in the fine part.
class Grading {
 public:
  Grading(const Shape& shape, const Element& e, const Scene& scene, const Adaptation& how)
      : shape_(shape), element_(e), scene_(scene), how_(how) {}

  /// Until the ends lie in the fine part of their mesh, or `most` solutions. `told`: of each mesh.
  Adapted solve(Sizing sizing, int most, bool told) {
    sizing.size = target_size(sizing, shape_);
    while (true) {
      Adapted a = once(sizing, told);
      if (!has_contact(scene_) || --most == 0) return a;
      const std::vector<End> ends = ends_of(a.model, a.state);
      if (how_.given) {  // what meshes of the same body, for bars and validation, are to be graded at
        a.sizing.ends = places_of_ends(ends);
        return a;
      }
      constexpr double fine = 3;  // times the size that is asked for
      if (std::all_of(ends.begin(), ends.end(), [&](const End& e) { return e.gap <= fine * end_size(sizing.size); }))
        return a;
      sizing.ends = places_of_ends(ends);
    }
  }

  /// On the mesh of `a`, divided.
  Adapted divided(Adapted a) {
    Stopwatch watch;
    Mesh mesh = std::move(a.model.mesh);
    a.model = {};
    for (int k = 0; k < how_.divisions; ++k) mesh = refine(mesh);
    if (how_.meshed) how_.meshed(mesh);
    return on(std::move(mesh), a.sizing, watch.lap());
  }
  /// Not solved.
  Adapted meshed(Sizing sizing) const {
    sizing.size = target_size(sizing, shape_);
    Adapted a{.model = {.mesh = how_.given ? *how_.given : triangulate(shape_, sizing)}};
    a.sizing = std::move(sizing);
    return a;
  }

  /// The ends of contact on a mesh so coarse that it costs little beside the one that is asked for.
  /// `coarse`: the size of the body over that of the edges; `cheaper`: it must be at least twice as coarse as what is
  /// asked for, four times fewer triangles.
  std::vector<Vec2> guess(const Sizing& wanted) {
    constexpr double coarse = 24, cheaper = 2;
    Sizing sizing = wanted;
    sizing.size = extent(shape_) / coarse;
    const double size = target_size(wanted, shape_);
    if (!has_contact(scene_) || how_.given || sizing.size < cheaper * size) return {};
    const Adapted a = solve(sizing, 4, false);
    return contact_ends(a.model, a.state);
  }

  std::vector<Round> rounds;

 private:
  Adapted once(const Sizing& sizing, bool told) {
    Stopwatch watch;
    Mesh mesh = how_.given ? *how_.given : triangulate(shape_, sizing);
    if (told && how_.meshed) how_.meshed(mesh);
    return on(std::move(mesh), sizing, watch.lap());
  }

  /// Large contact begins with what the faces do on a mesh four times coarser, where that costs little; `known_` is of
  /// the last mesh.
  /// `fewer`: the coarse mesh has at most a fifth of the triangles and half of the rows in contact, else it does not
  /// pay.
  void look_coarser(const Sizing& wanted, Index rows, Index triangles) {
    constexpr double coarser = 4;
    constexpr Index fewer = 5;
    if (how_.given || how_.saddle_point || known_rows_ * 8 >= rows) return;
    Sizing sizing = wanted;
    sizing.size *= coarser;
    sizing.crack_tip_size *= coarser;
    if (sizing.size > extent(shape_) / 4) return;
    Stopwatch watch;
    Mesh mesh = triangulate(shape_, sizing);
    const bool cheap = static_cast<Index>(mesh.triangles.size()) * fewer <= triangles;
    if (cheap && rows_in_contact(mesh) * 2 <= rows)
      on(std::move(mesh), sizing, watch.lap());
    else
      look_at_lone_cracks(wanted);
  }

  /// Many cracks have no mesh that is much coarser.
  void look_at_lone_cracks(const Sizing& wanted) {
    constexpr double coarser = 4;
    if (!shape_.regions.empty()) return;  // borders in contact hold them together
    Stopwatch watch;
    known_ =
        lone_cracks_guess(shape_, element_, scene_, std::min(coarser * wanted.size, extent(shape_) / 8), how_.threads);
    rounds.push_back({.solve = watch.lap()});
  }

  Index rows_in_contact(const Mesh& mesh) const {
    Index rows = 0;
    for (std::size_t c = 0; c < mesh.cracks.size(); ++c)
      if (is_unilateral(scene_.laws[c]))
        rows += static_cast<Index>(mesh.cracks[c].size()) * points_per_edge(element_) *
                (has_friction(scene_.laws[c]) ? 2 : 1);
    return rows;
  }

  /// Where contact has more rows than a dense matrix may have, K is factorized for sets of closed points: a good guess
  /// of the first set saves factorizations.
  Adapted on(Mesh mesh, const Sizing& sizing, double meshing) {
    Round round{.triangles = static_cast<Index>(mesh.triangles.size()), .mesh = meshing};
    Preparation preparation{.precision = how_.precision};
    const Index rows = rows_in_contact(mesh);
    if (rows > preparation.most_dense) {
      look_coarser(sizing, rows, round.triangles);
      preparation.contact = known_;
    }
    Stopwatch watch;
    Model model = prepare(std::move(mesh), element_, scene_, how_.threads, preparation);
    round.assemble = model.seconds.assemble;
    round.factor = model.seconds.factor;
    watch.lap();
    State state = solved(model, how_);
    round.solve = watch.lap();
    round.contact = state.seconds.contact;
    rounds.push_back(round);
    known_ = contact_guess(model, state);
    known_rows_ = rows;
    return {.model = std::move(model), .state = std::move(state), .sizing = sizing};
  }

  ContactGuess known_;
  Index known_rows_ = 0;
  const Shape& shape_;
  const Element& element_;
  const Scene& scene_;
  const Adaptation& how_;
};

}  // namespace

/// The error is taken to fall like share^power of the indicator, of which `safety` leaves a margin; the limit of
/// triangles is for the mesh before it is divided, of which each division makes four.
Mesh next_mesh(const Shape& shape, const Sizing& sizing, const Adaptation& wanted, const Mesh& mesh, double order,
               const Indicator& indicator) {
  if (wanted.refinement == Refinement::Bisect) return bisect(mesh, mark(indicator.eta), sizing.mirrored_tips);
  constexpr double most_growth = 6;  // of the number of triangles: coarse indicators know only so much
  // Below the goal: at singular points the error falls slower than the order of the element says.
  constexpr double safety = 0.7;
  const double share = std::pow(safety * wanted.error / indicator.relative, 1 / indicator.power);
  Goal goal{.error = share * indicator.eta.norm(),
            .order = order,
            .max_triangles = std::min<double>(std::ldexp(wanted.max_triangles, -2 * wanted.divisions),
                                              most_growth * indicator.eta.size())};
  // The indicator grades the mesh: the growth that is right around a tip without it makes twice the triangles at
  // degree 2.
  Sizing steep = sizing;
  steep.grading = std::max(sizing.grading, 0.5);
  const std::span<const double> eta(indicator.eta.data(), static_cast<std::size_t>(indicator.eta.size()));
  Background background{&mesh, equidistributed_sizes(mesh, eta, goal)};
  Mesh next = triangulate(shape, steep, background);
  // Sizes fit a number of triangles only nearly; the limit is one.
  for (int attempt = 0; attempt < 3 && static_cast<double>(next.triangles.size()) > goal.max_triangles; ++attempt) {
    const double excess = static_cast<double>(next.triangles.size()) / goal.max_triangles;
    for (double& size : background.size) size *= 1.03 * std::sqrt(excess);
    next = triangulate(shape, steep, background);
  }
  return next;
}

std::string unseen_by_estimate(const Model& m) {
  for (const UnseenData& u : unseen_data(m.mesh, m.scene, m.inner->data))
    if (u.stops_bounds) return fmt::format("{} {} near ({:.6g}, {:.6g})", u.what, u.how, u.at.x(), u.at.y());
  return {};
}

namespace {

/// What the estimate sees of data at points only, added to a claim.
/// Said beside "reached": data that are functions of a library are known at points alone.
std::string as_sampled(const Model& m) {
  for (const UnseenData& u : unseen_data(m.mesh, m.scene, m.inner->data))
    if (!u.stops_bounds) return fmt::format(", as sampled: {} {}", u.what, u.how);
  return {};
}

}  // namespace

/// Order matters: a round that reaches the goal at the limit of triangles has reached the goal. `gain`: a round counts
/// as a gain if its estimate is 5 % below the best one.
std::string reason_to_end(const std::vector<Round>& rounds, const std::string& unseen, const Adaptation& wanted) {
  constexpr double gain = 0.95;
  constexpr std::size_t most_rounds = 40;
  int without_gain = 0;
  double best = infinity;
  for (const Round& round : rounds) {
    without_gain = round.estimated_error < gain * best ? 0 : without_gain + 1;
    best = std::min(best, round.estimated_error);
  }
  const Round& round = rounds.back();
  std::string why;
  if (round.estimated_error <= wanted.error && unseen.empty())
    why = fmt::format("reached the asked error {:.3g}", wanted.error);
  else if (round.triangles >= 0.9 * wanted.max_triangles)
    why = fmt::format("stopped at max_triangles = {}: estimated error {:.3g}, asked {:.3g}", wanted.max_triangles,
                      round.estimated_error, wanted.error);
  else if (without_gain == 3)
    why = fmt::format("stopped: the estimated error stays at {:.3g}, asked {:.3g}", best, wanted.error);
  else if (rounds.size() == most_rounds)
    why = fmt::format("stopped after {} rounds: estimated error {:.3g}, asked {:.3g}", most_rounds,
                      round.estimated_error, wanted.error);
  else if (wanted.go_on && !wanted.go_on(round))
    why = "stopped on request";
  if (!why.empty() && !unseen.empty()) why += "; " + unseen;
  return why;
}

/// Each indicator is scaled to sum 1 before they are added: the width of the interval is a product of the errors of u
/// and of its dual. power 2: the width falls like the square of each.
Indicator refine_for(const Indicator& state, const Bounded& quantity, const std::vector<Eigen::VectorXd>& duals) {
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(state.eta.size());
  const auto add = [&](const Eigen::VectorXd& eta) {
    const double whole = eta.squaredNorm();
    if (whole > 0) squares += eta.cwiseAbs2() / whole;
  };
  add(state.eta);
  for (const Eigen::VectorXd& eta : duals) add(eta);
  const double half = 0.5 * (quantity.upper - quantity.lower), size = std::abs(quantity.value);
  constexpr double most = 1e3;  // the interval says nothing yet
  return {.eta = squares.cwiseSqrt(),
          .relative = half < most * size ? half / size : most,
          .power = 2,
          .note = quantity.guaranteed ? std::string() : quantity.note};
}

std::vector<Vec2> contact_ends(const Model& model, const Field& state) {
  return places_of_ends(ends_of(model, state));
}

/// Ends of contact are found on the mesh before it is divided, which has a fourth of the triangles per division or
/// less.
Adapted solve_graded(const Shape& shape, const Sizing& wanted, const Element& e, const Scene& scene,
                     const Adaptation& how) {
  Grading grading(shape, e, scene, how);
  Sizing sizing = wanted;
  if (sizing.ends.empty()) sizing.ends = grading.guess(sizing);
  Adapted a = how.divisions == 0   ? grading.solve(std::move(sizing), 3, true)
              : has_contact(scene) ? grading.divided(grading.solve(std::move(sizing), 3, false))
                                   : grading.divided(grading.meshed(std::move(sizing)));
  a.rounds = std::move(grading.rounds);
  if (!how.estimate) return a;
  Stopwatch watch;
  a.indicator = error_indicator(a.model, a.state);
  add_chords(shape, how.divisions, a.model, a.state, a.indicator);
  a.rounds.back().estimate = watch.lap();
  return a;
}

namespace {

struct Adapting {
  const Shape& shape;
  const Element& element;
  const Scene& scene;
  const Adaptation& wanted;
};

/// A mesh solved, with its indicator, that of the goal, and what that took.
struct Solved {
  Adapted adapted;
  Indicator goal;  // on the mesh before it was divided
};

/// `meshing`: seconds.
/// The goal is asked before the chords are added, which belong to the indicator of the stress alone.
Solved one_round(const Adapting& of, Mesh mesh, double meshing, const ContactGuess& known) {
  Stopwatch watch;
  for (int k = 0; k < of.wanted.divisions; ++k) mesh = refine(mesh);
  if (of.wanted.meshed) of.wanted.meshed(mesh);
  Round round{.triangles = static_cast<Index>(mesh.triangles.size()), .mesh = meshing + watch.lap()};
  Model model = prepare(std::move(mesh), of.element, of.scene, of.wanted.threads,
                        {.contact = known, .precision = of.wanted.precision});
  round.assemble = model.seconds.assemble;
  round.factor = model.seconds.factor;
  watch.lap();
  State state = solved(model, of.wanted);
  round.solve = watch.lap();
  round.contact = state.seconds.contact;
  Indicator indicator = error_indicator(model, state), goal;
  if (of.wanted.goal) goal = of.wanted.goal(model, state, indicator);
  add_chords(of.shape, of.wanted.divisions, model, state, indicator);
  if (!of.wanted.goal) goal = indicator;
  goal.eta = on_undivided(goal.eta, of.wanted.divisions);
  round.estimate = watch.lap();
  round.estimated_error = goal.relative;
  return {{.model = std::move(model), .state = std::move(state), .indicator = std::move(indicator), .rounds = {round}},
          std::move(goal)};
}

}  // namespace

/// The fields that stay are those that results, pictures and profiles of cracks read.
void drop_factor(Model& m) {
  const Inner& inner = *m.inner;
  System system{.penalty = inner.system.penalty,
                .force = inner.system.force,
                .F = inner.system.F,
                .tractions = inner.system.tractions,
                .traces = inner.system.traces};
  m.inner = std::make_shared<const Inner>(Inner{inner.kernel, inner.skeleton, inner.ordering, std::move(system),
                                                std::make_shared<const Factor>(LowerTriangle{}, 0), inner.floating,
                                                inner.data});
}

/// `last` is the state of the round before, without its factor: what is returned when the caller stops a round halfway.
Adapted solve_adaptively(const Shape& shape, const Sizing& given, const Element& e, const Scene& scene,
                         const Adaptation& wanted) {
  require(e, can_estimate_error);
  Stopwatch watch;
  Sizing sizing = given;
  sizing.size = target_size(sizing, shape);
  Mesh mesh = wanted.given ? *wanted.given : triangulate(shape, sizing);
  if (wanted.refinement == Refinement::Bisect) mesh = longest_edges_first(std::move(mesh), sizing.mirrored_tips);
  std::vector<Round> rounds;
  std::optional<Adapted> last;
  ContactGuess known;
  try {
    while (true) {
      std::optional<Mesh> undivided;
      if (wanted.divisions > 0) undivided = mesh;
      Solved solved = one_round({shape, e, scene, wanted}, std::move(mesh), watch.lap(), known);
      Adapted& now = solved.adapted;
      last.reset();
      watch.lap();
      rounds.push_back(now.rounds.front());
      now.stopped =
          reason_to_end(rounds, solved.goal.note.empty() ? unseen_by_estimate(now.model) : solved.goal.note, wanted);
      if (now.stopped.starts_with("reached")) now.stopped += as_sampled(now.model);
      now.rounds = rounds;
      now.sizing = sizing;
      if (!now.stopped.empty()) return std::move(now);
      sizing.ends = contact_ends(now.model, now.state);
      known = contact_guess(now.model, now.state);
      last.emplace(std::move(now));
      mesh = next_mesh(shape, sizing, wanted, undivided ? *undivided : last->model.mesh, static_cast<double>(e.order),
                       solved.goal);
      drop_factor(last->model);
    }
  } catch (const Stopped&) {
    if (!last) throw;
    last->stopped = "stopped on request";
    return std::move(*last);
  }
}

}  // namespace kerf
