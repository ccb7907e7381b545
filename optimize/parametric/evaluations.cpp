// A design of numbers evaluated: J, bounds per load case and their derivatives by the variables. A round begins with a
// mesh of its first design. Vertices on drawn things are its followers: they keep their place on the thing and move
// with the variables, the others by harmonic extension [theory: S.7], so that J is a smooth function with the exact
// derivative (S.3), gathered onto the followers and pulled back to the variables; the stiffness of an inclusion has
// (S.6). Other designs of the round move the mesh of the nearest one that was meshed; where that strains it, they get a
// mesh of their own. Load cases share a factor. Meshes are built when needed, six are kept. Evaluations replayed from a
// checkpoint build none. docs/theory/shape_gradient.md.

#include "optimize/parametric/evaluations.hpp"

#include "optimize/checkpoint_reader.hpp"

#include "kerf/element.hpp"
#include "kerf/shape_gradient.hpp"
#include "optimize/loop/evaluate.hpp"
#include "optimize/parametric/followers.hpp"
#include "optimize/parametric/start.hpp"
#include "solver/moved.hpp"
#include "solver/system.hpp"
#include "topo/young_gradient.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace kerf {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double too_close = 0.5;      // a violated constraint that leaves designs unsolved: half the distance
constexpr std::size_t most_built = 6;  // meshes kept with their extension

/// A design that was meshed, from which others are moved. Built when first needed: a replay may never need it.
struct Base {
  VectorXd at;
  struct Built {
    Mesh mesh;
    std::vector<Follower> followers;
    Extension extension;
    std::vector<double> angles;
    Points start;  // of the followers
  };
  std::unique_ptr<Built> built = {};
  int used = 0;
};

// Given to the extension are all vertices with a meaning: followers among them move, the others stay.
std::unique_ptr<Base::Built> build(const Design& d, const VectorXd& x, const Problem& p, const Shape& shape) {
  Mesh mesh = triangulate(shape, p.sizing);
  std::vector<Follower> f = followers(d, x, p, mesh);
  Extension extension = make_extension(mesh, vertices_that_mean_something(mesh));
  std::vector<double> angles = smallest_angles(mesh);
  Points start = positions(d, f, x);
  return std::make_unique<Base::Built>(
      Base::Built{std::move(mesh), std::move(f), std::move(extension), std::move(angles), std::move(start)});
}

/// The mesh with its followers where x wants them, or nothing when it suffers.
std::optional<Mesh> moved(const Base::Built& base, const Design& d, const VectorXd& x) {
  Points motion = Points::Zero(2, static_cast<Eigen::Index>(base.mesh.points.size()));
  const Points to = positions(d, base.followers, x);
  for (std::size_t k = 0; k < base.followers.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    motion.col(base.followers[k].vertex) = to.col(column) - base.start.col(column);
  }
  return carry(base.extension, base.mesh, base.angles, motion);
}

}  // namespace

// Rows of constraints: volume, bounds each under all load cases, geometry.
struct Evaluations::Impl {
  const Problem& problem;
  const OptimizeRequest& request;
  const Design& design;
  VectorXd lower, upper;
  double frame = 0;
  std::vector<LoadCase> loads;        // one at least, with what the scene itself bears
  std::vector<Constraint> geometric;  // need no mesh
  std::vector<std::string> names;     // of constraints
  std::vector<double> bound_scale, at_most;
  std::optional<std::string> blind;
  int round = -1;
  std::vector<Base> bases, before;  // of this round and the one before
  int clock = 0;
  std::shared_ptr<const SolvedDesign> last, spare;  // spare: the one before, whose memory serves the next one
  VectorXd last_at;

  Impl(const Problem& p, const OptimizeRequest& r) : problem(p), request(r), design(r.design) {
    check_design(design, p);
    lower = lower_bounds(design);
    upper = upper_bounds(design);
    frame = area(p.frame);
    loads = r.load_cases;
    if (loads.empty()) loads.push_back({"", 1, {}, {}});
    const std::vector<Scene> scenes = scenes_of(p, r);
    for (std::size_t l = 0; l < loads.size(); ++l) {
      // With what the scene itself bears in every case.
      loads[l].tractions = scenes[l].tractions;
      loads[l].body = scenes[l].body;
    }
    if (r.volume_at_most) names.push_back(fmt::format("the volume fraction exceeds {:g}", *r.volume_at_most));
    for (const FunctionalBound& bound : r.bounds) {
      for (const LoadCase& load : loads)
        names.push_back(fmt::format("{} exceeds {:g}{}", bound.name, bound.at_most,
                                    loads.size() > 1 ? fmt::format(" under {}", load.name) : ""));
      bound_scale.push_back(std::abs(bound.at_most));
      at_most.push_back(bound.at_most);
    }
    geometric = kerf::constraints(design, p, least_distance(p, r), forbidden_discs(p, r));
    for (const Constraint& c : geometric) names.push_back(c.name);
    blind = refusal(p.element, can_optimize);
  }

  Eigen::Index count() const {
    return static_cast<Eigen::Index>(names.size());
  }

  // In boxes: variables have different units.
  Base* nearest(const VectorXd& x) {
    Base* best = nullptr;
    double least = 0;
    for (Base& base : bases) {
      double d = 0;
      for (Eigen::Index i = 0; i < x.size(); ++i)
        if (upper[i] > lower[i]) d += std::pow((x[i] - base.at[i]) / (upper[i] - lower[i]), 2);
      if (!best || d < least) {
        best = &base;
        least = d;
      }
    }
    return best;
  }

  // The least recently used one goes first; it can be built again from its design.
  Base::Built& built(Base& base) {
    if (!base.built) base.built = build(design, base.at, problem, body_of(design, base.at, problem).shape);
    base.used = ++clock;
    while (true) {
      std::size_t alive = 0;
      Base* oldest = nullptr;
      for (std::vector<Base>* all : {&before, &bases})
        for (Base& other : *all) {
          if (!other.built) continue;
          ++alive;
          if (!oldest || other.used < oldest->used) oldest = &other;
        }
      if (alive <= most_built || oldest == &base) break;
      oldest->built.reset();
    }
    return *base.built;
  }

  /// What needs no mesh: the volume and the constraints on the geometry.
  void constrain(const VectorXd& x, bool gradients, DesignEvaluation& result) const {
    Evaluation& e = result.evaluation;
    e.x = x;
    e.values = VectorXd::Constant(1 + count(), nan);
    e.gradients = MatrixXd::Constant(x.size(), gradients ? 1 + count() : 0, nan);
    VectorXd by;
    const double holes = area_of_holes(design, x, &by);
    result.volume_fraction = (frame - holes) / frame;
    if (request.volume_at_most) {
      // Relative: 1 is twice the volume allowed.
      e.values[1] = result.volume_fraction / *request.volume_at_most - 1;
      if (gradients) e.gradients.col(1) = -by / (frame * *request.volume_at_most);
    }
    const Eigen::Index first = 1 + count() - static_cast<Eigen::Index>(geometric.size());
    for (std::size_t i = 0; i < geometric.size(); ++i) {
      const Eigen::Index k = first + static_cast<Eigen::Index>(i);
      VectorXd g;
      e.values[k] = geometric[i].value(x, gradients ? &g : nullptr);
      if (gradients) e.gradients.col(k) = g;
    }
  }

  // Empty where no constraint on the geometry is violated by more than half.
  std::string worst_constraint(const Evaluation& e) const {
    const auto many = static_cast<Eigen::Index>(geometric.size());
    Eigen::Index worst = 0;
    if (many == 0 || !(e.values.tail(many).maxCoeff(&worst) > too_close)) return {};
    return geometric[static_cast<std::size_t>(worst)].name;
  }

  /// J and the bounds of one functional on a solved body, and its derivative by x.
  double value_of(const Functional& j, Model& model, const Field& state, const Base::Built& base, const VectorXd& x,
                  VectorXd* gradient) const {
    const Analysis a = analyze(j, model, state, gradient == nullptr);
    if (!gradient) return a.value;
    // Forces on all vertices go to those that are given; of these the followers pull on variables.
    const Points force = gather(base.extension, shape_gradient(a, j));
    Points on(2, static_cast<Eigen::Index>(base.followers.size()));
    for (std::size_t k = 0; k < base.followers.size(); ++k)
      on.col(static_cast<Eigen::Index>(k)) = force.col(base.followers[k].vertex);
    *gradient = pull_back(design, base.followers, x, on);
    // The stiffness of an inclusion moves no vertex: it has a derivative of its own [theory: S.6].
    auto region = static_cast<Index>(problem.frame.regions.size());
    const std::vector<Eigen::Index> first = first_variables(design);
    for (std::size_t k = 0; k < design.drawn.size(); ++k) {
      const DrawnShape& shape = shape_of(design.drawn[k]);
      if (shape.part != BodyPart::Region) continue;
      const Eigen::Index at = first[k] + shape.young;
      if (shape.young != none && upper[at] > lower[at]) (*gradient)[at] = young_gradient(a, j, model, region, x[at]);
      ++region;
    }
    return a.value;
  }

  Eigen::Index row_of_bound(std::size_t bound, std::size_t load) const {
    return 1 + (request.volume_at_most ? 1 : 0) + static_cast<Eigen::Index>(bound * loads.size() + load);
  }

  /// Bounds of 0 are relative to the first values.
  void scale_bounds(const std::vector<double>& values) {
    for (std::size_t b = 0; b < values.size(); ++b)
      if (!(bound_scale[b] > 0)) bound_scale[b] = values[b] != 0 ? std::abs(values[b]) : 1;
  }

  /// That of the design before, unless somebody else has it.
  Model model_to_reuse() {
    const auto design = std::const_pointer_cast<SolvedDesign>(std::exchange(spare, nullptr));
    return design.use_count() == 1 ? std::move(design->model) : Model{};
  }

  /// Everything that needs the state, on a mesh that fits x. Throws Error(Numerics) when it cannot be solved.
  void solve_on(const Mesh& mesh, const Base::Built& base, const VectorXd& x, bool gradients,
                DesignEvaluation& result) {
    Evaluation& e = result.evaluation;
    DrawnBody body = body_of(design, x, problem);
    result.triangles = static_cast<Index>(mesh.triangles.size());
    result.holes = static_cast<int>(body.shape.holes.size());
    double merit = 0;
    VectorXd by_merit = VectorXd::Zero(x.size()), by;
    result.bounds.assign(request.bounds.size(), -infinity);
    std::vector<double> values;
    for (std::size_t l = 0; l < loads.size(); ++l) {
      Scene scene = body.scene;
      scene.tractions = loads[l].tractions;
      scene.body = loads[l].body;
      // Load cases differ in their loads alone: one factor for all.
      Model model = l == 0 ? prepare_moved(mesh, problem.element, std::move(scene), problem.threads, model_to_reuse(),
                                           base.extension.sequence)
                           : with_loads(last->model, std::move(scene));
      State state = kerf::solve(model, problem.contact);
      ++result.state_solves;
      if (!certified(state))
        throw Error(Fault::Numerics,
                    "the state could not be solved for: contact does not settle, or equilibrium holds "
                    "only roughly");
      VectorXd* gradient = gradients ? &by : nullptr;
      const double value = value_of(problem.objective, model, state, base, x, gradient);
      merit += loads[l].weight * value;
      if (gradients) by_merit += loads[l].weight * by;
      for (std::size_t b = 0; b < request.bounds.size(); ++b) {
        const double bounded = value_of(request.bounds[b].functional, model, state, base, x, gradient);
        result.bounds[b] = std::max(result.bounds[b], bounded);
        const Eigen::Index k = row_of_bound(b, l);
        // In rows of load cases: with the worst alone the constraint would have kinks.
        e.values[k] = bounded - at_most[b];
        if (gradients) e.gradients.col(k) = by;
      }
      // Observers see the first load case.
      if (l == 0) last = std::make_shared<SolvedDesign>(SolvedDesign{body, std::move(model), std::move(state)});
      last_at = x;
    }
    scale_bounds(result.bounds);
    for (std::size_t b = 0; b < request.bounds.size(); ++b)
      for (std::size_t l = 0; l < loads.size(); ++l) {
        e.values[row_of_bound(b, l)] /= bound_scale[b];
        if (gradients) e.gradients.col(row_of_bound(b, l)) /= bound_scale[b];
      }
    result.objective = merit;
    const double holes = area_of_holes(design, x, &by);
    // The weighted J, and the price of the body's area.
    e.values[0] = merit + request.volume_penalty * (frame - holes);
    if (gradients) e.gradients.col(0) = by_merit - request.volume_penalty * by;
  }
};

Evaluations::Evaluations(const Problem& problem, const OptimizeRequest& request)
    : impl_(std::make_unique<Impl>(problem, request)) {}
Evaluations::~Evaluations() = default;

Eigen::Index Evaluations::constraints() const {
  return impl_->count();
}

const std::string& Evaluations::constraint(Eigen::Index i) const {
  return impl_->names[static_cast<std::size_t>(i)];
}

const std::optional<std::string>& Evaluations::blind() const {
  return impl_->blind;
}

double Evaluations::frame_area() const {
  return impl_->frame;
}

// Bases of the round before stay for `solved`; earlier ones are gone.
void Evaluations::begin_round() {
  ++impl_->round;
  impl_->before = std::move(impl_->bases);
  impl_->bases.clear();
}

void Evaluations::allow(const std::vector<double>& at_most) {
  impl_->at_most = at_most;
}

// By the bounds of the request, where those in force may be tighter.
double Evaluations::violation_of_request(const DesignEvaluation& design) const {
  const Impl& s = *impl_;
  const VectorXd& values = design.evaluation.values;
  const auto geometric = static_cast<Eigen::Index>(s.geometric.size());
  double worst = s.request.volume_at_most ? std::max(values[1], 0.0) : 0;
  if (geometric > 0) worst = std::max(worst, values.tail(geometric).maxCoeff());
  for (std::size_t b = 0; b < design.bounds.size(); ++b)
    worst = std::max(worst, (design.bounds[b] - s.request.bounds[b].at_most) / s.bound_scale[b]);
  return worst;
}

DesignEvaluation Evaluations::evaluate(const VectorXd& x, bool gradients) {
  Impl& s = *impl_;
  DesignEvaluation result;
  result.round = s.round;
  s.spare = std::exchange(s.last, nullptr);
  // What needs no mesh is known even where meshing or solving fails.
  s.constrain(x, gradients, result);
  Evaluation& e = result.evaluation;
  // What violates the geometry by more than half the distance is not meshed, but for a round's first design.
  if (const std::string close = s.worst_constraint(e); !close.empty() && !s.bases.empty()) {
    e.failure = close;
    return result;
  }
  try {
    std::optional<Mesh> mesh;
    if (Base* base = s.nearest(x)) {
      result.base = static_cast<Index>(base - s.bases.data());
      mesh = moved(s.built(*base), s.design, x);
    }
    if (!mesh) {
      std::unique_ptr<Base::Built> fresh = build(s.design, x, s.problem, body_of(s.design, x, s.problem).shape);
      result.base = static_cast<Index>(s.bases.size());
      result.fresh = true;
      s.bases.push_back({x, std::move(fresh)});
      mesh = s.bases.back().built->mesh;
    }
    s.solve_on(*mesh, s.built(s.bases[static_cast<std::size_t>(result.base)]), x, gradients, result);
  } catch (const Error& error) {
    if (!of_one_body(error)) throw;
    // What cannot be meshed or solved is an answer to the minimizer; other errors end the run.
    e.failure = error.what();
    result.fault = error.fault;
    s.last.reset();
  }
  return result;
}

// Makes no mesh but a round's first: difference quotients would have the jump from mesh to mesh in them.
Evaluations::Response Evaluations::respond(const VectorXd& x, const Reading& reading, const Asked& asked) {
  Impl& s = *impl_;
  Response out;
  try {
    if (s.bases.empty()) s.bases.push_back({x, build(s.design, x, s.problem, body_of(s.design, x, s.problem).shape)});
    const Base::Built& base = s.built(*s.nearest(x));
    std::optional<Mesh> mesh = moved(base, s.design, x);
    if (!mesh) throw Error(Fault::Geometry, "the mesh cannot follow the design so far");
    Model model =
        prepare(std::move(*mesh), s.problem.element, body_of(s.design, x, s.problem).scene, s.problem.threads);
    const State state = kerf::solve(model, s.problem.contact);
    if (!certified(state)) throw Error(Fault::Numerics, "the state could not be solved for");
    out.values = reading(model, state);
    if (!asked) return out;
    const std::vector<Functional> functionals = asked(model);
    out.gradients.resize(x.size(), static_cast<Eigen::Index>(functionals.size()));
    for (std::size_t k = 0; k < functionals.size(); ++k) {
      VectorXd by;
      s.value_of(functionals[k], model, state, base, x, &by);
      out.gradients.col(static_cast<Eigen::Index>(k)) = by;
    }
  } catch (const Error& error) {
    if (!of_one_body(error)) throw;
    out.failure = error.what();
    out.fault = error.fault;
  }
  return out;
}

// Only that bases are numbered and bounds scaled as they were; nothing is meshed.
bool Evaluations::replay(const DesignEvaluation& known) {
  Impl& s = *impl_;
  s.last.reset();
  if (known.fresh) s.bases.push_back({known.evaluation.x});
  const bool good = known.evaluation.failure.empty();
  if (good) s.scale_bounds(known.bounds);
  const auto there = static_cast<Index>(s.bases.size());
  return known.round == s.round && known.base < there && (!known.fresh || known.base + 1 == there) &&
         (!good || (known.base != none && known.bounds.size() == s.request.bounds.size()));
}

// Where it is not the last one solved it is moved and solved again, on the mesh that it had.
std::shared_ptr<const SolvedDesign> Evaluations::solved(const DesignEvaluation& design) {
  Impl& s = *impl_;
  const VectorXd& x = design.evaluation.x;
  if (s.last && s.last_at == x) return s.last;
  const Base::Built& base =
      s.built((design.round == s.round ? s.bases : s.before).at(static_cast<std::size_t>(design.base)));
  DesignEvaluation again;
  s.constrain(x, false, again);
  const std::optional<Mesh> mesh = design.fresh ? base.mesh : moved(base, s.design, x);
  if (!mesh) throw broken_checkpoint();  // it was moved there before
  s.solve_on(*mesh, base, x, false, again);
  return s.last;
}

// Both designs on the mesh of one base, moved: the difference has no jump of meshes in it.
Evaluations::Check Evaluations::check_derivatives(const DesignEvaluation& at, const VectorXd& direction, double step) {
  Impl& s = *impl_;
  const VectorXd& x = at.evaluation.x;
  const VectorXd along = direction.cwiseProduct(s.upper - s.lower);
  const Eigen::Index many =
      1 + s.count() - static_cast<Eigen::Index>(s.geometric.size());  // the geometric ones need no state
  const std::shared_ptr<const SolvedDesign> last = s.last;
  const VectorXd last_at = s.last_at;
  Check check;
  const Base::Built& base = s.built(*s.nearest(x));
  std::vector<VectorXd> values;
  for (const double sign : {1.0, -1.0}) {
    const VectorXd y = x + sign * step * along;
    const std::optional<Mesh> mesh = moved(base, s.design, y);
    if (!mesh) throw Error(Fault::Numerics, "the mesh of the start does not survive the step of the derivative check");
    DesignEvaluation result;
    s.constrain(y, false, result);
    s.solve_on(*mesh, base, y, false, result);
    check.state_solves += result.state_solves;
    values.push_back(result.evaluation.values.head(many));
  }
  s.last = last;
  s.last_at = last_at;
  for (Eigen::Index k = 0; k < many; ++k) {
    const VectorXd& g = at.evaluation.gradients.col(k);
    const double exact = g.dot(along), difference = (values[0][k] - values[1][k]) / (2 * step);
    // Relative to the sum of the parts of the derivative, which may cancel along the direction.
    const double size = std::max(g.cwiseProduct(along).cwiseAbs().sum(), 1e-6 * std::abs(at.evaluation.values[k]));
    check.error.push_back(size > 0 ? std::abs(exact - difference) / size : std::abs(difference));
  }
  return check;
}

}  // namespace kerf
