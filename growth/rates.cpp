// Laws of fatigue crack growth: one function per law, chosen by std::visit.

#include "growth/rates.hpp"

#include "growth/numeric/around.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace kerf::growth {

namespace {

template <class... Functions>
struct Cases : Functions... {
  using Functions::operator()...;
};
template <class... Functions>
Cases(Functions...) -> Cases<Functions...>;

struct Constant {
  const char* name;
  double value;
  double least, most;
  const char* wanted;
  bool open = false;  // whether `least` itself is too little
};

void check_constants(const std::string& law, std::initializer_list<Constant> constants) {
  for (const Constant& c : constants)
    if (!(c.open ? c.value > c.least : c.value >= c.least) || !(c.value <= c.most))
      throw Error(Fault::Usage, fmt::format("{} = {} of the law of {}; {} is wanted", c.name, c.value, law, c.wanted));
}

constexpr double largest_number = std::numeric_limits<double>::max();

// A cycle that grows the crack: 0 < dK above the threshold, K_max < K_c.
struct GrowingCycle {
  double dK, R, K_max, K_c, dK_th;
};

double growth(const Paris& law, const GrowingCycle& c) {
  return law.C * std::pow(c.dK, law.m);
}
double growth(const Walker& law, const GrowingCycle& c) {
  return law.C * std::pow(c.dK / std::pow(1 - c.R, 1 - law.gamma), law.m);
}
double growth(const Forman& law, const GrowingCycle& c) {
  return law.C * std::pow(c.dK, law.m) / ((1 - c.R) * (c.K_c - c.K_max));
}
double growth(const Nasgro& law, const GrowingCycle& c) {
  const double f = opening_ratio(c.R, law.alpha, law.flow_ratio);
  return law.C * std::pow((1 - f) * c.K_max, law.m) * std::pow(1 - c.dK_th / c.dK, law.p) /
         std::pow(1 - c.K_max / c.K_c, law.q);
}

// A_0 to A_3 of Newman's f.
struct NewmanSeries {
  double a0, a1, a2, a3;
};
NewmanSeries newman(double alpha, double flow_ratio) {
  const double a0 = (0.825 - 0.34 * alpha + 0.05 * alpha * alpha) * std::pow(std::cos(pi / 2 * flow_ratio), 1 / alpha);
  const double a1 = (0.415 - 0.071 * alpha) * flow_ratio;
  const double a3 = 2 * a0 + a1 - 1;
  return {a0, a1, 1 - a0 - a1 - a3, a3};
}

}  // namespace

std::string name(const GrowthLaw& law) {
  return std::visit(Cases{[](const Paris&) { return "Paris"; }, [](const Walker&) { return "Walker"; },
                          [](const Forman&) { return "Forman"; }, [](const Nasgro&) { return "NASGRO"; }},
                    law.form);
}

void check(const GrowthLaw& law) {
  const std::string who = name(law);
  const auto common = [&](double C, double m) {
    check_constants(who, {{"C", C, 0, largest_number, "a positive number", true},
                          {"m", m, 0, 100, "an exponent above 0, at most 100", true},
                          {"threshold", law.threshold, 0, largest_number, "0 or a positive number"}});
    if (!(law.K_c > 0))
      throw Error(Fault::Usage, fmt::format("K_c = {} of the law of {}; a positive number is wanted", law.K_c, who));
  };
  const auto finite_toughness = [&] {
    if (!std::isfinite(law.K_c))
      throw Error(Fault::Usage, fmt::format("the law of {} wants K_c, at which the crack runs; there is none", who));
  };
  std::visit(Cases{[&](const Paris& l) { common(l.C, l.m); },
                   [&](const Walker& l) {
                     common(l.C, l.m);
                     check_constants(who, {{"gamma", l.gamma, 0, 1, "a number from 0 to 1"}});
                   },
                   [&](const Forman& l) {
                     common(l.C, l.m);
                     finite_toughness();
                   },
                   [&](const Nasgro& l) {
                     common(l.C, l.m);
                     finite_toughness();
                     check_constants(
                         who, {{"p", l.p, 0, 100, "an exponent from 0 to 100"},
                               {"q", l.q, 0, 100, "an exponent from 0 to 100"},
                               {"alpha", l.alpha, 1, 3, "a number from 1 (plane stress) to 3 (plane strain)"},
                               {"flow_ratio", l.flow_ratio, 0, std::nextafter(1., 0.), "a number from 0 to below 1"},
                               {"dK_0", l.dK_0, 0, largest_number, "0 or a positive number"},
                               {"a_0", l.a_0, 0, largest_number, "0 or a positive length"},
                               {"C_plus", l.C_plus, -100, 100, "a number"},
                               {"C_minus", l.C_minus, -100, 100, "a number"}});
                     if (law.threshold != 0)
                       throw Error(Fault::Usage,
                                   fmt::format("threshold = {}: the law of NASGRO has its own by dK_0", law.threshold));
                   }},
             law.form);
}

double opening_ratio(double R, double alpha, double flow_ratio) {
  const NewmanSeries a = newman(alpha, flow_ratio);
  if (R >= 0) return std::max(R, a.a0 + R * (a.a1 + R * (a.a2 + R * a.a3)));
  return a.a0 + a.a1 * std::max(R, -2.);
}

double threshold(const GrowthLaw& law, double R, double a) {
  const auto* nasgro = std::get_if<Nasgro>(&law.form);
  if (!nasgro) return law.threshold;
  if (nasgro->dK_0 == 0 || R >= 1) return 0;
  const double base = (1 - opening_ratio(R, nasgro->alpha, nasgro->flow_ratio)) /
                      ((1 - newman(nasgro->alpha, nasgro->flow_ratio).a0) * (1 - R));
  return nasgro->dK_0 * std::sqrt(a / (a + nasgro->a_0)) /
         std::pow(base, 1 + (R >= 0 ? nasgro->C_plus : nasgro->C_minus) * R);
}

double rate(const GrowthLaw& law, double K_max, double K_min, double a) {
  if (!(K_min <= K_max) || !std::isfinite(K_max - K_min))
    throw Error(
        Fault::Usage,
        fmt::format("a cycle between K_min = {} and K_max = {}; numbers with K_min <= K_max are wanted", K_min, K_max));
  if (K_max >= law.K_c) return infinity;
  if (K_max <= 0 || K_min == K_max) return 0;
  const double dK = K_max - K_min, R = K_min / K_max, dK_th = threshold(law, R, a);
  if (dK <= dK_th) return 0;
  return std::visit([&](const auto& form) { return growth(form, {dK, R, K_max, law.K_c, dK_th}); }, law.form);
}

std::string doubt(const GrowthLaw& law, double K_max, double K_min, double a) {
  const double da = rate(law, K_max, K_min, a);
  if (da == 0 || da == infinity) return {};
  if (da > a)
    return fmt::format(
        "the law of {} gives {:.3g} lengths of the crack per cycle at K_max = {:.4g}, K_min = {:.4g}: C = {} "
        "belongs to other units of K or length",
        name(law), da / a, K_max, K_min, std::visit([](const auto& f) { return f.C; }, law.form));
  if (da < 1e-20 * a)
    return fmt::format(
        "the law of {} gives {:.3g} lengths of the crack per cycle at K_max = {:.4g}, K_min = {:.4g}, no growth "
        "in any life: C = {} belongs to other units of K or length, or a threshold is missing",
        name(law), da / a, K_max, K_min, std::visit([](const auto& f) { return f.C; }, law.form));
  return {};
}

EquivalentCycle equivalent(Equivalence how, const TipLoad& at_max, const TipLoad& at_min) {
  const TipLoad a{std::max(at_max.K_I, 0.), at_max.K_II, 0}, b{std::max(at_min.K_I, 0.), at_min.K_II, 0};
  if (how == Equivalence::Opening) {
    const double side = a.K_II > 0 || (a.K_II == 0 && b.K_II > 0) ? -1 : 1;
    const auto opening = [&](const TipLoad& load, double angle) { return std::max(kink(load, side * angle).k_1, 0.); };
    const auto range = [&](double angle) { return std::abs(opening(a, angle) - opening(b, angle)); };
    const LargestAround best = largest_around(range, largest_kink, 45);
    const double first = opening(a, best.angle), second = opening(b, best.angle);
    EquivalentCycle c{std::max(first, second), std::min(first, second), best.angle == 0 ? 0 : side * best.angle, {}};
    if (best.rival) c.rival = side * *best.rival;
    return c;
  }
  const auto size = [&](double first, double second) {
    const double s = second * second;
    return how == Equivalence::Energy ? std::hypot(first, second)
                                      : std::pow(first * first * first * first + 8 * s * s, 0.25);
  };
  const double K_max = std::max(size(a.K_I, a.K_II), size(b.K_I, b.K_II));
  return {K_max, K_max - size(a.K_I - b.K_I, a.K_II - b.K_II), 0, {}};
}

}  // namespace kerf::growth
