#include "kerf/adaptive.hpp"

#include "geometry/adapt.hpp"

#include "solver/system.hpp"

#include "solver/saddle_point.hpp"
#include "solver/stopwatch.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace kerf {

namespace {

// The fewest triangles that carry half of the squared error.
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

Mesh refined(const Shape& shape, const Sizing& sizing, const Adaptation& wanted, const Model& model,
             const Indicator& indicator) {
  if (wanted.refinement == Refinement::Bisect) return bisect(model.mesh, mark(indicator.eta));
  constexpr double most_growth = 6;  // of the number of triangles: coarse indicators know only so much
  // Below the goal: at singular points the error falls slower than the order of the element says.
  constexpr double safety = 0.7;
  Goal goal{.error = safety * wanted.error / indicator.relative * indicator.eta.norm(),
            .order = static_cast<double>(model.element.order),
            .max_triangles = std::min<double>(wanted.max_triangles, most_growth * indicator.eta.size())};
  // The indicator grades the mesh: the growth that is right around a tip without it makes twice the triangles at
  // degree 2.
  Sizing steep = sizing;
  steep.grading = std::max(sizing.grading, 0.5);
  const std::span<const double> eta(indicator.eta.data(), static_cast<std::size_t>(indicator.eta.size()));
  Background background{&model.mesh, equidistributed_sizes(model.mesh, eta, goal)};
  Mesh mesh = triangulate(shape, steep, background);
  // Sizes fit a number of triangles only nearly; the limit is one.
  for (int attempt = 0; attempt < 3 && static_cast<double>(mesh.triangles.size()) > goal.max_triangles; ++attempt) {
    const double excess = static_cast<double>(mesh.triangles.size()) / goal.max_triangles;
    for (double& size : background.size) size *= 1.03 * std::sqrt(excess);
    mesh = triangulate(shape, steep, background);
  }
  return mesh;
}

// The first of the data that no estimate on this mesh can have seen.
std::string unseen_by_estimate(const Model& m) {
  for (const UnseenData& u : unseen_data(m.mesh, m.scene, m.inner->data))
    if (u.stops_bounds) return fmt::format("{} {} near ({:.6g}, {:.6g})", u.what, u.how, u.at.x(), u.at.y());
  return {};
}

}  // namespace

Adapted solve_adaptively(const Shape& shape, const Sizing& sizing, const Element& e, const Scene& scene,
                         const Adaptation& wanted) {
  require(e, can_estimate_error);
  constexpr std::size_t most_rounds = 40;
  Stopwatch watch;
  Mesh mesh = triangulate(shape, sizing);
  if (wanted.refinement == Refinement::Bisect) mesh = longest_edges_first(std::move(mesh));
  std::vector<Round> rounds;
  double best = infinity;
  int without_gain = 0;
  while (true) {
    Round round{.triangles = static_cast<Index>(mesh.triangles.size()), .mesh = watch.lap()};
    Model model = prepare(std::move(mesh), e, scene, wanted.threads);
    round.assemble = model.seconds.assemble;
    round.factor = model.seconds.factor;
    watch.lap();
    State state = wanted.saddle_point ? solve_saddle_point(model) : solve(model, wanted.contact);
    round.solve = watch.lap();
    round.contact = state.seconds.contact;
    Indicator indicator = error_indicator(model, state);
    round.estimate = watch.lap();
    round.estimated_error = indicator.relative;
    rounds.push_back(round);
    constexpr double gain = 0.95;
    without_gain = round.estimated_error < gain * best ? 0 : without_gain + 1;
    best = std::min(best, round.estimated_error);
    std::string stopped;
    const std::string unseen = unseen_by_estimate(model);
    if (round.estimated_error <= wanted.error && unseen.empty())
      stopped = fmt::format("reached the asked error {:.3g}", wanted.error);
    else if (round.triangles >= 0.9 * wanted.max_triangles)
      stopped = fmt::format("stopped at max_triangles = {}: estimated error {:.3g}, asked {:.3g}", wanted.max_triangles,
                            round.estimated_error, wanted.error);
    else if (without_gain == 3)
      stopped = fmt::format("stopped: the estimated error stays at {:.3g}, asked {:.3g}", best, wanted.error);
    else if (rounds.size() == most_rounds)
      stopped = fmt::format("stopped after {} rounds: estimated error {:.3g}, asked {:.3g}", most_rounds,
                            round.estimated_error, wanted.error);
    else if (wanted.go_on && !wanted.go_on(round))
      stopped = "stopped on request";
    if (!stopped.empty() && !unseen.empty()) stopped += "; " + unseen;
    if (!stopped.empty())
      return {std::move(model), std::move(state), std::move(indicator), std::move(rounds), std::move(stopped)};
    mesh = refined(shape, sizing, wanted, model, indicator);
  }
}

}  // namespace kerf
