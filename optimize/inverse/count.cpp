// How many defects the readings tell of, and of which kind. Each number k, in every mixture of the things that the
// design draws, is guessed, fitted by least squares and weighed by
//   B_k = N ln(chi^2_k/N) + p_k ln N,   or chi^2_k/s^2 + p_k ln N where the noise s is known
// [Schwarz 1978; theory: I.7], and beside it by Akaike's criterion for few readings [Hurvich, Tsai 1989; theory: I.10].
// One more defect must lower B by 6, which is strong evidence [Kass, Raftery 1995]. A fit in which the size of a defect
// is less than twice its deviation, or the least that its box allows, is a phantom and refused, as is one with as many
// variables as readings. Two numbers in a row that bring nothing end the search. Derived in docs/theory/inverse.md,
// "How many".

#include "kerf/inverse.hpp"
#include "optimize/inverse/sensors.hpp"
#include "optimize/parametric/followers.hpp"
#include "optimize/parametric/shapes/shape.hpp"
#include "optimize/parametric/start.hpp"

#include <fmt/core.h>

#include <cmath>
#include <numeric>

namespace kerf {

namespace {

using Eigen::VectorXd;

constexpr int rises = 2;       // of the criterion in a row, after which nothing better is expected
constexpr double trusted = 2;  // deviations that the size of a thing must have
constexpr double strong = 6;   // evidence that one more thing needs: as much lower [Kass, Raftery 1995]

/// The sum of squares of the body without anything.
LeastSquares of_none(const Problem& p, const Readings& readings) {
  const Model m = prepare(triangulate(p.frame, p.sizing), p.element, p.scene, p.threads);
  const State s = solve(m, p.contact);
  if (!certified(s)) throw Error(Fault::Numerics, "the body without defects could not be solved");
  VectorXd measured(2 * static_cast<Eigen::Index>(readings.at.size()));
  for (std::size_t i = 0; i < readings.at.size(); ++i)
    // x and y in turn, as sensors read them.
    measured.segment<2>(2 * static_cast<Eigen::Index>(i)) = readings.displacement[i];
  // The misfit of the body as it is: nothing varies.
  LeastSquares fit{.readings = static_cast<int>(measured.size()), .state_solves = 1, .stopped = "nothing to fit"};
  fit.start = fit.end = (Sensors(m.mesh, readings).read(m, s) - measured).squaredNorm();
  fit.estimated = !(readings.noise > 0);
  fit.noise = fit.estimated ? std::sqrt(fit.end / fit.readings) : readings.noise;
  return fit;
}

// Fixed variables cost nothing in the criterion.
int free_variables(const Design& d) {
  int count = 0;
  for (const Drawn& one : d.drawn) count += static_cast<int>((one.lower.array() < one.upper.array()).count());
  return count;
}

/// For normal noise, less what is the same for all counts: -2 ln of the largest likelihood.
double unlikeliness(const LeastSquares& fit, double noise) {
  const double n = fit.readings;
  return noise > 0 ? fit.end / (noise * noise) : n * std::log(fit.end / n);
}

/// [Schwarz 1978; theory: I.7].
double criterion(const LeastSquares& fit, int variables, double noise) {
  return unlikeliness(fit, noise) + variables * std::log(static_cast<double>(fit.readings));
}

/// [Hurvich, Tsai 1989; theory: I.10]: an estimated noise is one more parameter, and few readings flatter a fit by it.
/// For a known one Akaike's own price is exact. Infinite where there are too few readings.
double corrected_akaike(const LeastSquares& fit, int variables, double noise) {
  if (noise > 0) return unlikeliness(fit, noise) + 2 * variables;
  const double k = variables + 1, left = fit.readings - k - 1;
  return left > 0 ? unlikeliness(fit, noise) + 2 * k + 2 * k * (k + 1) / left : infinity;
}

/// A thing whose size the readings do not tell from nothing, or want smaller than its box allows.
/// The size of a crack is the distance of its ends, with the deviation by the gradient of that; of a spline its area;
/// of the others the radius, variable 2.
bool has_phantom(const Design& d, const LeastSquares& fit) {
  Eigen::Index first = 0;
  for (const Drawn& one : d.drawn) {
    const VectorXd v = fit.variables.segment(first, one.lower.size());
    const Eigen::MatrixXd C = fit.covariance.block(first, first, v.size(), v.size());
    double size = 0, variance = 0;
    if (shape_of(one).part == BodyPart::Crack) {  // from end to end
      const Eigen::Index last = v.size() - 2;
      const Vec2 along = v.segment<2>(last) - v.head<2>();
      size = along.norm();
      VectorXd by = VectorXd::Zero(v.size());
      by.head<2>() = -along / size;
      by.segment<2>(last) = along / size;
      variance = by.dot(C * by);
    } else if (one.kind == Drawn::Kind::Spline) {
      VectorXd by;
      size = area_of_holes({{one}}, v, &by);
      variance = by.dot(C * by);
    } else {
      size = v[2];
      variance = C(2, 2);
    }
    const bool smallest = shape_of(one).part != BodyPart::Crack && one.kind != Drawn::Kind::Spline &&
                          one.lower[2] < one.upper[2] && v[2] <= one.lower[2];
    if (smallest || size < trusted * std::sqrt(variance)) return true;
    first += v.size();
  }
  return false;
}

Counted fit_of(const Problem& p, const OptimizeRequest& request, const Readings& readings, const std::vector<int>& of) {
  Counted one{.count = std::accumulate(of.begin(), of.end(), 0), .of = of};
  try {
    if (one.count == 0) {
      one.fit = of_none(p, readings);
    } else {
      OptimizeRequest r = request;
      r.design = copies(request.design, one.of);
      one.variables = free_variables(r.design);
      if (one.variables >= 2 * static_cast<int>(readings.at.size())) {
        one.failure = fmt::format("{} readings for {} unknowns", 2 * readings.at.size(), one.variables);
        return one;
      }
      // Every number begins with a guess of its own.
      for (Drawn& d : r.design.drawn) d.from_map = true;
      const InitialGuess guess = initial_guess(p, r.design, least_distance(p, r));
      r.design = guess.design;
      one.fit = least_squares(p, r, repaired(start_of(r.design), p, r).value_or(start_of(r.design)), readings);
      one.fit.state_solves += guess.solves;
      one.design = std::move(r.design);
      Eigen::Index first = 0;
      // What was fitted is where later runs start.
      for (Drawn& d : one.design.drawn) {
        d.start = one.fit.variables.segment(first, d.start.size());
        d.from_map = false;
        first += d.start.size();
      }
    }
    one.criterion = criterion(one.fit, one.variables, readings.noise);
    one.aicc = corrected_akaike(one.fit, one.variables, readings.noise);
    if (one.count > 0 && has_phantom(one.design, one.fit))
      one.failure = "the readings do not tell the size of one of them from nothing";
  } catch (const Error& error) {
    one.failure = error.what();
  }
  return one;
}

/// All ways to write `sum` as so many numbers, the first one falling.
std::vector<std::vector<int>> mixtures(int sum, std::size_t numbers) {
  if (numbers == 1) return {{sum}};
  std::vector<std::vector<int>> all;
  for (int first = sum; first >= 0; --first)
    for (const std::vector<int>& rest : mixtures(sum - first, numbers - 1)) {
      all.push_back({first});
      all.back().insert(all.back().end(), rest.begin(), rest.end());
    }
  return all;
}

/// "2", or "1 hole 'h' and 1 crack 'c'" where there is a choice.
std::string what(const Counted& one, const std::vector<std::string>& things) {
  if (things.size() < 2 || one.count == 0) return fmt::format("{}", one.count);
  std::string words;
  for (std::size_t i = 0; i < things.size(); ++i)
    if (one.of.at(i) > 0)
      words += fmt::format("{}{} {}", words.empty() ? "" : " and ",
                           one.of[i] == 1 ? "1" : fmt::format("{} x", one.of[i]), things[i]);
  return words;
}

}  // namespace

std::string in_words(const Count& c) {
  std::string all;
  for (const Counted& one : c.tried)
    all += fmt::format("{}{}: {}", all.empty() ? "" : ", ", what(one, c.things),
                       one.failure.empty() ? fmt::format("{:.1f}", one.criterion) : "none (" + one.failure + ")");
  const Counted& chosen = c.tried.at(c.chosen);
  const std::string found = c.things.size() < 2 || chosen.count == 0
                                ? fmt::format("{} defect{}", chosen.count, chosen.count == 1 ? "" : "s")
                                : what(chosen, c.things);
  return fmt::format("{} by the criterion of Bayes and Schwarz: {}", found, all);
}

std::vector<std::string> table_in_words(const Count& c) {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < c.tried.size(); ++i) {
    const Counted& one = c.tried[i];
    std::string line =
        fmt::format("{}{}: {} unknowns", i == c.chosen ? "chosen: " : "", what(one, c.things), one.variables);
    if (std::isfinite(one.fit.end)) {
      const double n = one.fit.readings;
      line += one.fit.estimated ? fmt::format(", noise {:.3g}", std::sqrt(one.fit.end / n))
                                : fmt::format(", chi^2/N {:.3g}", one.fit.end / (n * one.fit.noise * one.fit.noise));
    }
    if (std::isfinite(one.criterion))
      line += fmt::format(", BIC {:.1f} ({:+.1f}), AICc {:.1f} ({:+.1f})", one.criterion,
                          one.criterion - c.tried[c.chosen].criterion, one.aicc, one.aicc - c.tried[c.chosen].aicc);
    lines.push_back(line + (one.failure.empty() ? "" : "; not chosen: " + one.failure));
  }
  return lines;
}

Design copies(const Design& design, const std::vector<int>& counts) {
  Design out;
  for (std::size_t i = 0; i < design.drawn.size(); ++i)
    for (int k = 1; k <= counts.at(i); ++k) {
      out.drawn.push_back(design.drawn[i]);
      if (counts[i] > 1) out.drawn.back().name = fmt::format("{}_{}", design.drawn[i].name, k);
    }
  return out;
}

// From none upwards; numbers that fail count as ones that bring nothing. Of one number of things the likeliest mixture
// counts.
Count count_defects(const Problem& problem, const OptimizeRequest& request, const Readings& readings, int at_most) {
  const Design& design = request.design;
  if (design.drawn.empty()) throw Error(Fault::Usage, "to count defects the design draws one of each kind");
  Count out;
  for (const Drawn& one : design.drawn) out.things.push_back(name(one));
  double least = infinity;
  int risen = 0;
  for (int k = 0; k <= at_most && risen < rises; ++k) {
    const double before = least - (k > 0 ? strong : 0);
    bool better = false;
    for (const std::vector<int>& of : mixtures(k, design.drawn.size())) {
      out.tried.push_back(fit_of(problem, request, readings, of));
      const Counted& one = out.tried.back();
      if (!one.failure.empty() || !(one.criterion < before) || !(one.criterion < least)) continue;
      least = one.criterion;
      out.chosen = out.tried.size() - 1;
      better = true;
    }
    risen = better ? 0 : risen + 1;
  }
  if (least == infinity)
    throw Error(Fault::Numerics, fmt::format("no number of defects could be fitted: {}", out.tried[0].failure));
  return out;
}

}  // namespace kerf
