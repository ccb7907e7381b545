#pragma once
// Integrals of functions of one variable by Gauss' rules, parts of them halved until the halves say the same.

#include <array>
#include <cmath>
#include <vector>

namespace kerf::growth {

/// By five points [low, high].
template <class Function>
double gauss(const Function& f, double low, double high) {
  constexpr std::array<double, 3> x = {0, 0.53846931010568309104, 0.90617984593866399280},
                                  w = {0.56888888888888888889, 0.47862867049936646804, 0.23692688505618908751};
  const double middle = 0.5 * (low + high), half = 0.5 * (high - low);
  double sum = w[0] * f(middle);
  for (int i = 1; i < 3; ++i) sum += w[i] * (f(middle - half * x[i]) + f(middle + half * x[i]));
  return half * sum;
}

/// Of f >= 0, by halving the worst part until all are good to 1e-12 of the sum, or 400 times: what is infinite at an
/// end then is large.
template <class Function>
double integral(const Function& f, double low, double high) {
  struct Part {
    double low, high, value, error;
  };
  const auto part = [&](double from, double to) {
    const double middle = 0.5 * (from + to), whole = gauss(f, from, to);
    const double halves = gauss(f, from, middle) + gauss(f, middle, to);
    return Part{from, to, halves, std::abs(halves - whole)};
  };
  if (low == high) return 0;
  std::vector<Part> parts = {part(low, high)};
  for (int i = 0; i < 400; ++i) {
    double sum = 0, error = 0;
    std::size_t worst = 0;
    for (std::size_t j = 0; j < parts.size(); ++j) {
      sum += parts[j].value, error += parts[j].error;
      if (parts[j].error > parts[worst].error) worst = j;
    }
    const Part p = parts[worst];
    const double middle = 0.5 * (p.low + p.high);
    if (!(error > 1e-12 * sum) || middle <= p.low || middle >= p.high) return sum;
    parts[worst] = part(p.low, middle);
    parts.push_back(part(middle, p.high));
  }
  double sum = 0;
  for (const Part& p : parts) sum += p.value;
  return sum;
}

}  // namespace kerf::growth
