// Dispatch over the kinds of perturbations: each is a row of the table in kind.hpp, and what a kind lacks is refused
// here.

#include "topo/formulas/kind.hpp"

#include <fmt/core.h>

#include <cmath>

namespace kerf {

std::string_view word(Perturbation::Kind kind) {
  return row({kind}).word;
}

Perturbation::Kind perturbation_kind(std::string_view word) {
  std::string known;
  for (std::size_t k = 0; k < perturbation_kinds.size(); ++k) {
    if (perturbation_kinds[k]->word == word) return static_cast<Perturbation::Kind>(k);
    known += fmt::format("{}\"{}\"", known.empty() ? "" : ", ", perturbation_kinds[k]->word);
  }
  throw Error(Fault::Usage, fmt::format("there is no perturbation \"{}\"; use one of {}", word, known));
}

std::string description(const Perturbation& p) {
  return row(p).description(p);
}

bool has_series(const Perturbation& p) {
  return row(p).form != nullptr;
}

double scale(const Perturbation& p, double eps) {
  return has_series(p) ? pi * eps * eps : nan;
}

//  The longer semi-axis of an ellipse of area pi eps^2 is eps sqrt(aspect).
double reach(const Perturbation& p) {
  return std::sqrt(aspect(p));
}

double form(const Perturbation& p, const Material& m, double angle, const Mat2& s, const Mat2& t) {
  if (!has_series(p))
    throw Error(Fault::Usage,
                fmt::format("{} has no expansion in powers of its radius: use clamped_force", description(p)));
  return row(p).form(p, m, angle, s, t);
}

Transmission inside(const Perturbation& p, const Material& m) {
  if (!row(p).inside)
    throw Error(Fault::Usage,
                "the stress around an ellipse, a crack or a clamped hole is not that of a circle: "
                "only a hole or an inclusion has multipliers");
  return row(p).inside(p, m);
}

Oriented oriented(const Perturbation& p, const Material& m, std::span<const Product> products) {
  if (is_directed(p) && !p.angle) return row(p).orient(p, m, products);
  Oriented result{0, is_directed(p) ? *p.angle : 0};
  for (const Product& q : products) result.value += q.factor * form(p, m, result.angle, q.s, q.t);
  return result;
}

}  // namespace kerf
