// Variables of a design from readings of the displacement at sensors: min chi^2 = |u_v(x_i) - m_i|^2 within boxes and
// geometric constraints [Levenberg 1944; Marquardt 1963; theory: I.4],
//   (J'J + mu D^2) d = -J'r,   D the lengths of the columns of J.
// J has few columns and many rows. Difference quotients, a state each, span a space Q with r in it; adjoints of the
// readings q_k'u give the exact components G = J'Q, so that J'J = G G' up to the square of their error and J'r = G Q'r
// exactly [theory: I.5]: where the search ends does not depend on the quotients. States of a round are on one mesh that
// moves with the design; rounds begin anew until one moves nothing by 1e-3 of its box. At the end s^2 = chi^2/(N - p),
// the covariance s^2 (J'J)^-1 of variables off their bounds, and 95 % ellipses of places [Seber, Wild 1989; theory:
// I.6]. The singular values of J in boxes tell which combinations of the variables the readings fix [theory: I.9], and
// chi^2 on the mesh and on a finer one whether the model explains them [theory: I.8]. Derived in
// docs/theory/inverse.md.

#include "base/chi_square.hpp"
#include "base/dense.hpp"
#include "kerf/inverse.hpp"
#include "optimize/inverse/sensors.hpp"
#include "optimize/loop/finish.hpp"
#include "optimize/loop/history_text.hpp"
#include "optimize/parametric/evaluations.hpp"
#include "optimize/parametric/shapes/shape.hpp"
#include "optimize/parametric/start.hpp"

#include <fmt/core.h>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double difference = 1e-5;  // of a box: steps of difference quotients
constexpr double settled = 1e-3;  // of the variance: what a step must gain, or it moves nothing by 3 % of a deviation
constexpr double first_damping = 1e-3;
constexpr int most_steps = 40, most_rounds = 8, most_trials = 8;
constexpr double refuting = 0.999;            // part of all chi2 that lie below the one that refutes a model
constexpr double rounding = 1e-13;            // of the largest square of a singular value: smaller ones are 0
const double anywhere = 1 / std::sqrt(12.0);  // deviation of a number that may be anywhere in its box, in boxes

/// The misfit r = u - m and J = dr/dx in an orthonormal basis Q of what they span: r = Q p, J = Q G'.
struct Linearized {
  VectorXd p;  // Q'r
  MatrixXd G;  // variables x columns of Q; zero rows for fixed variables
  MatrixXd Q;  // readings x their rank
};

// The method of Levenberg and Marquardt, with the mesh of the round and one for trials that it cannot follow.
class Fit {
 public:
  Fit(const Problem& p, const OptimizeRequest& r, const Readings& readings)
      : problem_(p), request_(r), readings_(readings) {
    for (Meshed* m : {&here_, &there_}) m->evaluations = std::make_unique<Evaluations>(problem_, request_);
    lower_ = lower_bounds(r.design);
    upper_ = upper_bounds(r.design);
    geometric_ = constraints(r.design, p, least_distance(p, r), forbidden_discs(p, r));
    measured_.resize(2 * static_cast<Eigen::Index>(readings.at.size()));
    for (std::size_t i = 0; i < readings.at.size(); ++i)
      measured_.segment<2>(2 * static_cast<Eigen::Index>(i)) = readings.displacement[i];
  }

  LeastSquares run(const VectorXd& start);

 private:
  bool is_free(Eigen::Index i) const {
    return upper_[i] > lower_[i];
  }
  /// A mesh that moves with the design, and the sensors on it.
  struct Meshed {
    std::unique_ptr<Evaluations> evaluations;
    std::unique_ptr<Sensors> sensors;
    void begin() {
      evaluations->begin_round();
      sensors.reset();
    }
  };
  std::optional<VectorXd> misfit(Meshed& on, const VectorXd& x);
  std::optional<VectorXd> try_at(const VectorXd& x);
  VectorXd begin_round(const VectorXd& x);
  Linearized linearize(const VectorXd& x, const VectorXd& r);
  double violation(const VectorXd& x) const;
  bool improve(VectorXd& x, VectorXd& r);
  VectorXd step(const Linearized& l, const VectorXd& x, double damping) const;
  double optimality(const Linearized& l, const VectorXd& x) const;
  double freedom() const;
  double variance() const;
  /// Whether combinations of the unknowns are.
  bool is_open() const {
    return rank_of(out_) < static_cast<int>(out_.combinations.size());
  }
  void describe(const Linearized& l);
  void combine(const Linearized& l);
  void draw_ellipses();
  void look_at_finer(const Linearized& l);
  double difference_of_neighbors(const VectorXd& r) const;
  FitVerdict verdict();

  Problem problem_;
  OptimizeRequest request_;
  const Readings& readings_;
  Meshed here_, there_;  // of the round, of trials that it cannot follow
  std::vector<Constraint> geometric_;
  VectorXd lower_, upper_, measured_;
  std::string failure_;
  Fault fault_ = Fault::Geometry;
  bool fresh_ = false;
  double damping_ = first_damping;
  double neighbors_ = nan;             // mean square of what they differ by in what remains on the finer mesh
  std::vector<Eigen::Index> unknown_;  // at the end: off their bounds, which count as known [theory: I.6]
  LeastSquares out_;
};

/// u - m at a design on a mesh that is moved there, or nothing.
std::optional<VectorXd> Fit::misfit(Meshed& on, const VectorXd& x) {
  const auto reading = [this, &on](const Model& m, const Field& s) -> VectorXd {
    ++out_.state_solves;
    if (!on.sensors) on.sensors = std::make_unique<Sensors>(m.mesh, readings_);
    return on.sensors->read(m, s);
  };
  const Evaluations::Response found = on.evaluations->respond(x, reading);
  failure_ = found.failure;
  fault_ = found.fault;
  if (!failure_.empty()) return std::nullopt;
  return found.values - measured_;
}

/// The same, on a fresh mesh (`there_`) where the one of the round cannot follow.
std::optional<VectorXd> Fit::try_at(const VectorXd& x) {
  if (const std::optional<VectorXd> r = misfit(here_, x)) {
    fresh_ = false;
    return r;
  }
  there_.begin();
  fresh_ = true;
  return misfit(there_, x);
}

/// A fresh mesh, and the misfit on it.
VectorXd Fit::begin_round(const VectorXd& x) {
  here_.begin();
  const std::optional<VectorXd> r = misfit(here_, x);
  if (!r) throw Error(fault_, fmt::format("the design to fit to the readings cannot be solved: {}", failure_));
  return *r;
}

// Basis Q of quotients and r, then exact derivatives of the readings q_k'u by adjoints on the same mesh [theory: I.5].
Linearized Fit::linearize(const VectorXd& x, const VectorXd& r) {
  MatrixXd quotients(r.size(), x.size() + 1);
  Eigen::Index columns = 0;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    if (!is_free(i)) continue;
    VectorXd y = x;
    // Backwards at the upper bound.
    const double h = difference * (upper_[i] - lower_[i]);
    y[i] += y[i] + h <= upper_[i] ? h : -h;
    if (const std::optional<VectorXd> other = misfit(here_, y)) quotients.col(columns++) = (*other - r) / (y[i] - x[i]);
  }
  // With r among the columns G p is the exact slope of chi^2/2.
  quotients.col(columns++) = r;
  for (Eigen::Index k = 0; k < columns; ++k)
    if (const double size = quotients.col(k).norm(); size > 0) quotients.col(k) /= size;
  // Columns are scaled first: the rank is of directions, not of units.
  const Eigen::ColPivHouseholderQR<MatrixXd> qr = pivoted_qr(quotients.leftCols(columns));
  const MatrixXd basis = orthonormal(qr, qr.rank());
  // Readings weighted by the columns of Q, as functionals.
  const auto asked = [&](const Model& m) {
    std::vector<Functional> all;
    for (Eigen::Index k = 0; k < basis.cols(); ++k)
      all.push_back({"reading", {here_.sensors->weighted(m, basis.col(k))}});
    return all;
  };
  // No numbers are read off: derivatives alone are asked for.
  const auto nothing = [](const Model&, const Field&) { return VectorXd(); };
  ++out_.state_solves;
  const Evaluations::Response found = here_.evaluations->respond(x, nothing, asked);
  if (!found.failure.empty())
    throw Error(found.fault, fmt::format("the readings have no derivative at the design: {}", found.failure));
  Linearized l{.p = basis.transpose() * r, .G = found.gradients, .Q = basis};
  for (Eigen::Index i = 0; i < x.size(); ++i)
    if (!is_free(i)) l.G.row(i).setZero();
  return l;
}

double Fit::violation(const VectorXd& x) const {
  double most = 0;
  for (const Constraint& c : geometric_) most = std::max(most, c.value(x, nullptr));
  return most;
}

/// min |p + G'd|^2 + damping |D d|^2, D the sizes of the rows of G, over x + d within the bounds: variables that a step
/// would take across one stop there.
VectorXd Fit::step(const Linearized& l, const VectorXd& x, double damping) const {
  const VectorXd size = l.G.rowwise().norm();
  VectorXd d = VectorXd::Zero(x.size());
  std::vector<bool> held(static_cast<std::size_t>(x.size()));
  for (Eigen::Index i = 0; i < x.size(); ++i) held[static_cast<std::size_t>(i)] = !(size[i] > 0);
  for (Eigen::Index round = 0; round <= x.size(); ++round) {
    std::vector<Eigen::Index> free;
    for (Eigen::Index i = 0; i < x.size(); ++i)
      if (!held[static_cast<std::size_t>(i)]) free.push_back(i);
    if (free.empty()) break;
    const auto n = static_cast<Eigen::Index>(free.size());
    VectorXd rhs = l.p;
    for (Eigen::Index i = 0; i < x.size(); ++i)
      if (held[static_cast<std::size_t>(i)]) rhs += d[i] * l.G.row(i).transpose();
    MatrixXd A(l.p.size() + n, n);
    A.setZero();
    for (Eigen::Index k = 0; k < n; ++k) {
      A.col(k).head(l.p.size()) = l.G.row(free[static_cast<std::size_t>(k)]) / size[free[static_cast<std::size_t>(k)]];
      A(l.p.size() + k, k) = std::sqrt(damping);
    }
    // In units of D: columns of G over their lengths, sqrt(mu) times the identity below.
    VectorXd b = VectorXd::Zero(A.rows());
    b.head(l.p.size()) = -rhs;
    const VectorXd z = solve_least_squares(A, b);
    bool across = false;
    for (Eigen::Index k = 0; k < n; ++k) {
      const Eigen::Index i = free[static_cast<std::size_t>(k)];
      d[i] = z[k] / size[i];
      if (x[i] + d[i] >= lower_[i] && x[i] + d[i] <= upper_[i]) continue;
      d[i] = std::clamp(x[i] + d[i], lower_[i], upper_[i]) - x[i];
      held[static_cast<std::size_t>(i)] = across = true;
    }
    if (!across) break;
  }
  return d;
}

/// The largest cosine between the misfit and what a variable that may move changes it by.
/// At a bound only what pulls inwards counts.
double Fit::optimality(const Linearized& l, const VectorXd& x) const {
  double most = 0;
  const double size = l.p.norm();
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double row = l.G.row(i).norm();
    if (!(row > 0) || !(size > 0)) continue;
    const double cosine = l.G.row(i).dot(l.p) / (row * size);
    if ((x[i] <= lower_[i] && cosine > 0) || (x[i] >= upper_[i] && cosine < 0)) continue;
    most = std::max(most, std::abs(cosine));
  }
  return most;
}

/// One step that lowers the sum; false: none found.
bool Fit::improve(VectorXd& x, VectorXd& r) {
  const Linearized l = linearize(x, r);
  out_.optimality = optimality(l, x);
  const double allowed = violation(x);
  for (int trial = 0; trial < most_trials; ++trial, damping_ = std::max(10 * damping_, 1e-6)) {
    const VectorXd d = step(l, x, damping_), y = (x + d).cwiseMax(lower_).cwiseMin(upper_);
    // The fall of |p|^2 = |r|^2 by the linear model; |p|^2/N is the variance that `settled` is relative to.
    const double predicted = l.p.squaredNorm() - (l.p + l.G.transpose() * d).squaredNorm();
    if (!(predicted > settled * l.p.squaredNorm() / static_cast<double>(r.size()))) return false;
    // No step may violate the geometry more than the design does already.
    if (violation(y) > allowed) continue;
    const std::optional<VectorXd> other = try_at(y);
    if (!other || !(other->squaredNorm() < r.squaredNorm())) continue;
    // More than half of what the linear model predicted: less damping.
    if (r.squaredNorm() - other->squaredNorm() > 0.5 * predicted) damping_ *= 0.1;
    // The mesh of an accepted trial becomes that of the round.
    if (fresh_) std::swap(here_, there_);
    x = y;
    r = *other;
    ++out_.steps;
    return true;
  }
  return false;
}

/// Readings less variables off their bounds, of which `unknown_` are.
double Fit::freedom() const {
  return static_cast<double>(measured_.size()) - static_cast<double>(unknown_.size());
}

/// Of the noise: given, or estimated by what remains, over one degree of freedom at least.
double Fit::variance() const {
  return out_.estimated ? out_.end / std::max(1.0, freedom()) : readings_.noise * readings_.noise;
}

/// Noise and covariance at the end.
void Fit::describe(const Linearized& l) {
  const auto n = static_cast<Eigen::Index>(unknown_.size());
  // What has no reading left to be estimated by is not known.
  out_.noise = !out_.estimated || freedom() > 0 ? std::sqrt(variance()) : nan;
  out_.covariance = MatrixXd::Zero(out_.variables.size(), out_.variables.size());
  if (n == 0) return;
  MatrixXd J(l.p.size(), n);
  VectorXd size(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    size[k] = l.G.row(unknown_[static_cast<std::size_t>(k)]).norm();
    J.col(k) = l.G.row(unknown_[static_cast<std::size_t>(k)]).transpose() / size[k];
  }
  // Of columns of length 1, for the sake of its condition; the lengths come back below. What the readings do not tell
  // at all keeps a variance that is large, not infinite.
  const Eigenpairs pairs = eigenpairs(transposed_multiply(J, J));
  const VectorXd inverse = pairs.values.cwiseMax(rounding * pairs.values[n - 1]).cwiseInverse();
  const MatrixXd C = pairs.vectors * inverse.asDiagonal() * pairs.vectors.transpose();
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index k = 0; k < n; ++k)
      out_.covariance(unknown_[static_cast<std::size_t>(i)], unknown_[static_cast<std::size_t>(k)]) =
          out_.noise * out_.noise * C(i, k) / (size[i] * size[k]);
}

/// Singular values of J in boxes, of all variables that have one: s_k of combination k, whose deviation is the noise
/// over s_k.
void Fit::combine(const Linearized& l) {
  std::vector<Eigen::Index> open;
  for (Eigen::Index i = 0; i < lower_.size(); ++i)
    if (is_free(i)) open.push_back(i);
  const auto n = static_cast<Eigen::Index>(open.size());
  if (n == 0) return;
  MatrixXd G(n, l.p.size());
  for (Eigen::Index k = 0; k < n; ++k) {
    const Eigen::Index i = open[static_cast<std::size_t>(k)];
    G.row(k) = (upper_[i] - lower_[i]) * l.G.row(i);
  }
  const Eigenpairs pairs = eigenpairs(multiply_transposed(G, G));
  for (Eigen::Index k = n - 1; k >= 0; --k) {
    Combination c{.weights = VectorXd::Zero(lower_.size())};
    for (Eigen::Index i = 0; i < n; ++i) c.weights[open[static_cast<std::size_t>(i)]] = pairs.vectors(i, k);
    // As many as there are readings at most: what is left is rounding.
    const bool told = pairs.values[k] > rounding * pairs.values[n - 1] && n - 1 - k < measured_.size();
    if (told) c.deviation = out_.noise / std::sqrt(pairs.values[k]);
    c.fixed = told && !(c.deviation >= anywhere);
    out_.combinations.push_back(std::move(c));
  }
}

/// 95 % of the places that the readings fix.
void Fit::draw_ellipses() {
  const VectorXd& x = out_.variables;
  const double left = std::max(1.0, freedom());
  // The 95 % quantile of chi2 with two degrees of freedom; of 2 F(2, left) where the noise is estimated.
  const double quantile = out_.estimated ? left * (std::pow(0.05, -2 / left) - 1) : -2 * std::log(0.05);
  Eigen::Index first = 0;
  for (const Drawn& one : request_.design.drawn) {
    const DrawnShape& shape = shape_of(one);
    const Eigen::Index places = one.kind == Drawn::Kind::Crack    ? one.lower.size() / 2
                                : one.kind == Drawn::Kind::Spline ? 0
                                                                  : 1;
    for (Eigen::Index k = 0; k < places; ++k) {
      const Eigen::Index at = first + 2 * k;
      if (!is_fixed(out_, at) || !is_fixed(out_, at + 1) || !std::isfinite(out_.noise)) continue;
      // Semi-axes are sqrt(quantile lambda) along the eigenvectors, the longer one first.
      const Eigen::SelfAdjointEigenSolver<Mat2> axes(Mat2(out_.covariance.block<2, 2>(at, at)));
      const Vec2 along = axes.eigenvectors().col(1);
      out_.ellipses.push_back(
          {.name = shape.part == BodyPart::Crack ? fmt::format("{}, point {}", name(one), k + 1) : name(one),
           .at = x.segment<2>(at),
           .semi_axes = (quantile * axes.eigenvalues().reverse().cwiseMax(0)).cwiseSqrt(),
           .angle = std::remainder(std::atan2(along.y(), along.x()), pi)});
    }
    first += one.lower.size();
  }
}

/// The sum of squares on half the mesh size with one degree more, less what the variables off their bounds could lower
/// it by there, by J: min over d of |r + J d|^2; the same of the difference of the two misfits, which is what the mesh
/// errs by. Nothing where that cannot be solved.
void Fit::look_at_finer(const Linearized& l) {
  ++out_.state_solves;
  try {
    Problem p = finer_problem(problem_);
    DrawnBody body = body_of(request_.design, out_.variables, p);
    const Model m = prepare(triangulate(body.shape, p.sizing), p.element, std::move(body.scene), p.threads);
    const State s = solve(m, p.contact);
    if (!certified(s)) return;
    const VectorXd r = Sensors(m.mesh, readings_).read(m, s) - measured_;
    MatrixXd G(static_cast<Eigen::Index>(unknown_.size()), l.G.cols());
    for (std::size_t k = 0; k < unknown_.size(); ++k)
      G.row(static_cast<Eigen::Index>(k)) = l.G.row(unknown_[k]) / l.G.row(unknown_[k]).norm();
    const MatrixXd J = multiply_transposed(l.Q, G);
    const auto left = [&](const VectorXd& v) {
      return unknown_.empty() ? v : VectorXd(v - J * solve_least_norm(J, v));
    };
    const VectorXd remains = left(r);
    out_.finer = remains.squaredNorm();
    out_.mesh = left(r - l.Q * l.p).squaredNorm();
    neighbors_ = difference_of_neighbors(remains);
  } catch (const Error& error) {
    if (!of_one_body(error)) throw;
  }
}

/// The mean square of the differences between a component at a sensor and at the nearest other one: twice the variance
/// of independent noise, and next to nothing where all that is missed is smooth [Neumann 1941; theory: I.11].
double Fit::difference_of_neighbors(const VectorXd& r) const {
  const std::vector<Vec2>& at = readings_.at;
  if (at.size() < 2) return nan;
  double sum = 0;
  for (std::size_t i = 0; i < at.size(); ++i) {
    double least = infinity;
    std::size_t nearest = i;
    for (std::size_t k = 0; k < at.size(); ++k)
      if (const double away = (at[k] - at[i]).squaredNorm(); k != i && away < least) least = away, nearest = k;
    sum += (r.segment<2>(2 * static_cast<Eigen::Index>(i)) - r.segment<2>(2 * static_cast<Eigen::Index>(nearest)))
               .squaredNorm();
  }
  return sum / static_cast<double>(r.size());
}

/// chi2 by its distribution, on both meshes. A finer mesh yet could change it once more by what this one has changed,
/// at most: what that explains, the mesh is to blame for. A noise that is not given is read off neighbors, and only
/// where these are missed in the same way beyond chance is that noise believed.
FitVerdict Fit::verdict() {
  if (!(freedom() > 0)) return is_open() ? FitVerdict::Undetermined : FitVerdict::Untested;
  const double n = static_cast<double>(measured_.size()), chi = chi_square_quantile(refuting, freedom());
  const double noise = out_.estimated ? std::sqrt(0.5 * neighbors_) : readings_.noise, limit = noise * std::sqrt(chi);
  const bool here = std::sqrt(out_.end) > limit, there = std::sqrt(out_.finer) > limit;
  // Each pair of neighbors may count twice: a variance of 8/n of the ratio, whose mean is 2; 3.09 deviations are 99.9
  // %.
  const bool is_smooth = neighbors_ < (2 - 3.09 * std::sqrt(8 / n)) * out_.finer / n;
  const bool refuted = here && std::sqrt(out_.finer) - std::sqrt(out_.mesh) > limit && (!out_.estimated || is_smooth);
  if (!out_.estimated || refuted) {
    out_.noise = noise;
    out_.expected = {chi_square_quantile(0.025, freedom()), chi_square_quantile(0.975, freedom())};
    out_.most = chi;
  }
  if (refuted) return FitVerdict::Unexplained;
  if (is_open()) return FitVerdict::Undetermined;
  if (out_.estimated) return FitVerdict::Untested;
  return here || there ? FitVerdict::Coarse : FitVerdict::Explained;
}

// Each round is on a mesh made for its first design; the misfit there differs from that of the round before by the
// error of meshes.
LeastSquares Fit::run(const VectorXd& start) {
  VectorXd x = start, r = begin_round(x);
  out_.start = r.squaredNorm();
  for (int round = 0; round < most_rounds; ++round) {
    const VectorXd before = x;
    if (round > 0) r = begin_round(x);
    damping_ = first_damping;  // what shortened the steps may have been the mesh
    while (out_.steps < most_steps && improve(x, r)) {
    }
    const VectorXd moved = (x - before).cwiseAbs();
    const VectorXd width = upper_ - lower_;
    if (out_.steps >= most_steps) break;
    if ((moved.array() <= 1e-3 * width.array()).all()) break;
  }
  if (r.squaredNorm() > out_.start) {  // on meshes of their own: what was gained was less than they differ
    x = start;
    r = begin_round(x);
  }
  const Linearized l = linearize(x, r);
  out_.optimality = optimality(l, x);
  out_.variables = x;
  out_.end = r.squaredNorm();
  out_.stopped = out_.steps >= most_steps  ? fmt::format("all {} steps are used", most_steps)
                 : out_.optimality <= 0.01 ? "the misfit is orthogonal to what the variables change"
                                           : "no step within the constraints makes the misfit smaller";
  out_.readings = static_cast<int>(measured_.size());
  out_.estimated = !(readings_.noise > 0);
  for (Eigen::Index i = 0; i < x.size(); ++i)
    if (is_free(i) && x[i] > lower_[i] && x[i] < upper_[i] && l.G.row(i).norm() > 0) unknown_.push_back(i);
  const double best = (l.p + l.G.transpose() * step(l, x, 1e-9)).squaredNorm();
  out_.gain = variance() > 0 ? std::max(0.0, l.p.squaredNorm() - best) / variance() : 0;
  describe(l);
  combine(l);
  look_at_finer(l);
  out_.verdict = verdict();
  if (out_.verdict != FitVerdict::Unexplained) draw_ellipses();
  return std::move(out_);
}

}  // namespace

int rank_of(const LeastSquares& fit) {
  return static_cast<int>(std::ranges::count_if(fit.combinations, &Combination::fixed));
}

// The part of a variable in combinations that the readings leave open counts with the deviation of these.
bool is_fixed(const LeastSquares& fit, Eigen::Index variable) {
  constexpr double most = 1e4;  // boxes, for what is infinite
  double square = 0;
  for (const Combination& c : fit.combinations)
    if (!c.fixed || std::isfinite(c.deviation))
      square += std::pow(std::min(c.deviation, most) * c.weights[variable], 2);
  return square < anywhere * anywhere;
}

double deviation_of(const LeastSquares& fit, Eigen::Index variable) {
  const double deviation = std::sqrt(fit.covariance(variable, variable));
  const bool claimed = fit.verdict != FitVerdict::Unexplained && deviation > 0 && is_fixed(fit, variable);
  return claimed ? deviation : nan;
}

std::string in_words(const Combination& c, const std::vector<std::string>& names) {
  constexpr double small = 0.1;  // of the largest weight
  const double largest = c.weights.cwiseAbs().maxCoeff();
  std::string words;
  for (Eigen::Index i = 0; i < c.weights.size(); ++i) {
    if (std::abs(c.weights[i]) < small * largest) continue;
    const bool minus = c.weights[i] < 0;
    words += words.empty() ? (minus ? "-" : "") : (minus ? " - " : " + ");
    words += fmt::format("{:.2f} {}", std::abs(c.weights[i]), names.at(static_cast<std::size_t>(i)));
  }
  return words;
}

namespace {

/// "chi^2/N 22.6 where 0.84 to 1.18 is expected (95 %)"; empty where the noise is not known.
std::string chi_square_in_words(const LeastSquares& fit) {
  if (!std::isfinite(fit.most)) return {};
  const double unit = fit.noise * fit.noise * fit.readings, n = fit.readings;
  std::string words = fmt::format(
      "chi^2/N {:.3g} where the noise{} makes it {:.2f} to {:.2f} (95 %) and below {:.2f} (99.9 %)", fit.end / unit,
      fit.estimated ? " between neighboring readings" : "", fit.expected[0] / n, fit.expected[1] / n, fit.most / n);
  if (std::isfinite(fit.finer)) words += fmt::format("; {:.3g} on a finer mesh", fit.finer / unit);
  return words;
}

/// What is open, and what is known all the same.
std::vector<std::string> combinations_in_words(const LeastSquares& fit, const std::vector<std::string>& names) {
  const auto all = static_cast<int>(fit.combinations.size());
  const int rank = rank_of(fit);
  if (rank == all || fit.verdict == FitVerdict::Unexplained) return {};
  std::vector<std::string> lines{fmt::format(
      "{} readings fix {} of {} combinations of the unknowns (each measured in its box)", fit.readings, rank, all)};
  for (const Combination& c : fit.combinations)
    lines.push_back(c.fixed ? fmt::format("fixed{}: {}",
                                          std::isfinite(c.deviation) ? fmt::format(" to +- {:.2g} boxes", c.deviation)
                                                                     : std::string(),
                                          in_words(c, names))
                            : fmt::format("not fixed: {}", in_words(c, names)));
  return lines;
}

}  // namespace

std::vector<std::string> in_words(const LeastSquares& fit, const std::vector<std::string>& names) {
  std::vector<std::string> lines{fmt::format(
      "least squares: {:.4g} to {:.4g} over {} readings, noise {}; {}", fit.start, fit.end, fit.readings,
      std::isfinite(fit.noise) ? fmt::format("{:.3g}{}", fit.noise, fit.estimated ? " (estimated)" : "") : "not known",
      fit.stopped)};
  if (std::string words = chi_square_in_words(fit); !words.empty()) lines.push_back(std::move(words));
  for (std::string& line : combinations_in_words(fit, names)) lines.push_back(std::move(line));
  for (Eigen::Index i = 0; i < fit.variables.size(); ++i) {
    const std::string& name = names.at(static_cast<std::size_t>(i));
    if (const double deviation = deviation_of(fit, i); deviation > 0)
      lines.push_back(fmt::format("{} {:.5g} +- {:.2g}", name, fit.variables[i], deviation));
    else if (!is_fixed(fit, i))
      lines.push_back(fmt::format("{} {:.5g}: the readings do not fix it", name, fit.variables[i]));
  }
  for (const UncertaintyEllipse& e : fit.ellipses)
    if (e.semi_axes.x() > 0)
      lines.push_back(fmt::format("{}: 95 % ellipse {:.2g} by {:.2g}, long axis at {:.0f} degrees", e.name,
                                  e.semi_axes.x(), e.semi_axes.y(), e.angle * 180 / pi));
  return lines;
}

// The finer design is anew that of the fit: the one of the misfit is another.
void judge_fit(const Problem& problem, const OptimizeRequest& request, const LeastSquares& fit,
               OptimizeResult& result) {
  constexpr double least = 0.01;  // gain in variances: a tenth of a deviation
  Problem p = problem;
  DrawnBody body = body_of(request.design, fit.variables, problem);
  p.scene = std::move(body.scene);
  result.finer = solve_finer(std::move(p), request, body.shape, area(problem.frame));
  result.optimality = fit.optimality;
  const std::string chi = chi_square_in_words(fit);
  std::vector<std::string> words;
  if (fit.verdict == FitVerdict::Unexplained) {
    result.ending = Ending::Unexplained;
    words = {chi, "another number or another kind of things may explain them"};
  } else if (fit.verdict == FitVerdict::Undetermined) {
    result.ending = Ending::Undetermined;
    words = {fmt::format("{} readings fix {} of {} combinations of the unknowns", fit.readings, rank_of(fit),
                         fit.combinations.size()),
             chi};
  } else if (fit.verdict == FitVerdict::Coarse) {
    result.ending = Ending::Stalled;
    words = {fmt::format("{}: a smaller mesh.size tells whether the model explains the readings", word(fit.verdict)),
             chi};
  } else if (fit.steps >= most_steps) {
    result.ending = Ending::BudgetUsed;
    words = {fit.stopped};
  } else if (fit.gain <= least || fit.optimality <= least) {
    result.ending = Ending::Optimal;
    words = {fmt::format("least squares: a step could lower chi^2 by {:.1g} variances", fit.gain),
             chi.empty() ? "without the noise given nothing tells whether the model explains the readings" : chi};
  } else {
    result.ending = Ending::Stalled;
    words = {fit.stopped, fmt::format("a step could lower chi^2 by {:.1g} variances", fit.gain)};
  }
  result.stopped = fmt::format("{}: {}", word(result.ending), join(words));
}

LeastSquares least_squares(const Problem& problem, const OptimizeRequest& request, const VectorXd& start,
                           const Readings& readings) {
  if (const auto why = refusal(problem.element, can_optimize)) throw Error(Fault::Usage, *why);
  if (readings.at.empty()) throw Error(Fault::Usage, "least squares need readings: there are none");
  // The objective is not asked for: nothing of it is evaluated.
  OptimizeRequest r = request;
  r.bounds.clear();
  r.load_cases.clear();
  return Fit(problem, r, readings).run(start);
}

}  // namespace kerf
