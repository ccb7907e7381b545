// J of powers 2 < p < 4 of the stress on a body with a slit converges like h^(2 - p/2) at the tips; two meshes with
// edges there as 1 to 4 give D = D_n + (D_n - D_(n/2))/(2^(4-p) - 1) [theory: V.12].

#include "topo/validate/slit_limit.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

// Up to the power 2 J converges like the energy; from 4 on it is infinite.
bool is_slow(const Term& term) {
  constexpr double as_the_energy = 2, infinite = 4;
  return term.stress_power > as_the_energy && term.stress_power < infinite;
}

}  // namespace

std::vector<double> changes_of_terms(const Functional& j, const Analysis& bonded, const Analysis& slit) {
  std::vector<double> change;
  for (std::size_t i = 0; i < j.terms.size(); ++i)
    change.push_back(j.terms[i].factor * (slit.term_value[i] - bonded.term_value[i]));
  return change;
}

bool slow_at_tips(const Functional& j) {
  return std::ranges::any_of(j.terms, is_slow);
}

double limit_of_changes(const Functional& j, const std::vector<double>& fine, const std::vector<double>& coarse) {
  double sum = 0;
  for (std::size_t i = 0; i < j.terms.size(); ++i) {
    sum += fine[i];
    if (is_slow(j.terms[i])) sum += (fine[i] - coarse[i]) / (std::pow(2, 4 - j.terms[i].stress_power) - 1);
  }
  return sum;
}

}  // namespace kerf
