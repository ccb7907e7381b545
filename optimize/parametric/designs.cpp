// DesignSpace (optimize/designs.hpp): the evaluations of the NLopt methods, one at a time. A round (Evaluations) lasts
// until it is ended, so that all designs of it move the meshes of each other.

#include "optimize/designs.hpp"

#include "optimize/load_cases.hpp"
#include "optimize/parametric/evaluations.hpp"
#include "optimize/refuse.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace kerf {

struct DesignSpace::Impl {
  Problem problem;
  OptimizeRequest request;
  Eigen::VectorXd lower, upper, start;
  std::vector<std::string> names, constraints = {};
  std::unique_ptr<Evaluations> evaluations = {};
};

DesignSpace::DesignSpace(Problem problem, OptimizeRequest request)
    : impl_(std::make_unique<Impl>(Impl{std::move(problem), in_order(std::move(request)), {}, {}, {}, {}})) {
  Impl& s = *impl_;
  if (s.request.method == OptimizeMethod::LevelSet || s.request.design.drawn.empty())
    throw Error(Fault::Usage,
                "a level set has no variables; give [optimize] another method, and [[optimize.hole]] or "
                "[[optimize.crack]] to draw with numbers");
  refuse_wrong(s.problem, s.request);
  const auto by_map = std::ranges::find(s.request.design.drawn, true, &Drawn::from_map);
  if (by_map != s.request.design.drawn.end())
    throw Error(Fault::Usage, fmt::format("the start of {} is read off a map, which an optimization makes; give it "
                                          "start = {{ ... }} in numbers",
                                          name(*by_map)));
  s.lower = lower_bounds(s.request.design);
  s.upper = upper_bounds(s.request.design);
  s.start = start_of(s.request.design);
  s.names = variable_names(s.request.design);
  s.evaluations = std::make_unique<Evaluations>(s.problem, s.request);
  for (Eigen::Index i = 0; i < s.evaluations->constraints(); ++i) s.constraints.push_back(s.evaluations->constraint(i));
  s.evaluations->begin_round();
}

DesignSpace::~DesignSpace() = default;

const std::vector<std::string>& DesignSpace::names() const {
  return impl_->names;
}
const std::vector<std::string>& DesignSpace::constraints() const {
  return impl_->constraints;
}
const Eigen::VectorXd& DesignSpace::lower() const {
  return impl_->lower;
}
const Eigen::VectorXd& DesignSpace::upper() const {
  return impl_->upper;
}
const Eigen::VectorXd& DesignSpace::start() const {
  return impl_->start;
}

void DesignSpace::forget_meshes() {
  impl_->evaluations->begin_round();
}

DesignValues DesignSpace::evaluate(const Eigen::VectorXd& x, bool gradients) {
  Impl& s = *impl_;
  if (x.size() != s.start.size())
    throw Error(Fault::Usage, fmt::format("a design has {} numbers here, not {}", s.start.size(), x.size()));
  Eigen::VectorXd inside = x;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    constexpr double rounding = 1e-12;
    const double room = rounding * std::max({s.upper[i] - s.lower[i], std::abs(s.lower[i]), std::abs(s.upper[i])});
    if (!(x[i] >= s.lower[i] - room && x[i] <= s.upper[i] + room))
      throw Error(Fault::Usage, fmt::format("{} = {:g} lies outside of its bounds, {:g} to {:g}",
                                            s.names[static_cast<std::size_t>(i)], x[i], s.lower[i], s.upper[i]));
    inside[i] = std::clamp(x[i], s.lower[i], s.upper[i]);
  }
  if (gradients && s.evaluations->blind()) throw Error(Fault::Usage, *s.evaluations->blind());
  const DesignEvaluation found = s.evaluations->evaluate(inside, gradients);
  const Evaluation& e = found.evaluation;
  DesignValues v{.value = e.values[0],
                 .constraints = e.values.tail(e.values.size() - 1),
                 .objective = found.objective,
                 .volume_fraction = found.volume_fraction,
                 .bounds = found.bounds,
                 .triangles = found.triangles,
                 .failure = e.failure};
  if (!gradients) return v;
  v.gradient = e.gradients.col(0);
  v.jacobian = e.gradients.rightCols(e.gradients.cols() - 1).transpose();
  return v;
}

}  // namespace kerf
