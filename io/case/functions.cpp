// The functions that expressions may call, one row of a table each: name, kind of break, number of arguments, and the
// Taylor coefficients of the smooth ones. Inverse functions follow from their derivatives, c' = a'/d [theory: D.1] with
//   asin: d = sqrt(1 - a^2);  atan: 1 + a^2;  asinh: sqrt(a^2 + 1);  acosh: sqrt(a^2 - 1);  atanh: 1 - a^2.
// Outside its domain a function has the whole line as range; where only the derivative has no value (asin at 1) it has
// its range and no derivatives. Ranges of monotone functions come from the values at both ends, which is sharper than
// the range of the formula (sinh, tan). Functions that break are evaluated in enclose.cpp and deviation.cpp. A name
// must mean here what it means in expression.cpp: otherwise the tree would prove things of another function.

#include "io/case/functions.hpp"

#include <iterator>

namespace kerf {

namespace {

using Arguments = std::span<const Taylor>;
using Arithmetic = TaylorArithmetic;

Taylor one(const Arithmetic& with) {
  return with.constant(exactly(1));
}

Taylor inverse_sine(const Taylor& a, const Arithmetic& with) {
  if (!(a.c[0].low >= -1 && a.c[0].high <= 1)) return with.range(whole_line);
  const Interval value = growing(a.c[0], [](double v) { return std::asin(v); });
  const Taylor rest = with.subtract(one(with), with.square(a));
  if (!(rest.c[0].low > 0)) return with.range(value);
  return with.with_slope(a, with.square_root(rest), value);
}

Taylor inverse_cosine(const Taylor& a, const Arithmetic& with) {
  return with.subtract(with.constant(widened(pi / 2, pi / 2)), inverse_sine(a, with));
}

Taylor inverse_tangent(const Taylor& a, const Arithmetic& with) {
  return with.with_slope(a, with.add(one(with), with.square(a)), arc_tangent(a.c[0]));
}

Taylor tangent(const Taylor& a, const Arithmetic& with) {
  const Taylor cosine = with.cosine(a);
  if (contains(cosine.c[0], 0)) return with.range(whole_line);
  Taylor t = with.divide(with.sine(a), cosine);
  t.c[0] = common(t.c[0], growing(a.c[0], [](double v) { return std::tan(v); }));  // no pole within
  return t;
}

// (e^a + sign e^-a)/2.
Taylor hyperbolic(const Taylor& a, double sign, const Arithmetic& with) {
  const Taylor up = with.exponential(a), down = with.exponential(with.negate(a));
  return with.multiply(with.constant(exactly(0.5)), sign > 0 ? with.add(up, down) : with.subtract(up, down));
}
Taylor hyperbolic_sine(const Taylor& a, const Arithmetic& with) {
  Taylor t = hyperbolic(a, -1, with);
  t.c[0] = common(t.c[0], growing(a.c[0], [](double v) { return std::sinh(v); }));
  return t;
}
Taylor hyperbolic_cosine(const Taylor& a, const Arithmetic& with) {
  return hyperbolic(a, 1, with);
}
Taylor inverse_hyperbolic_sine(const Taylor& a, const Arithmetic& with) {
  return with.with_slope(a, with.square_root(with.add(one(with), with.square(a))),
                         growing(a.c[0], [](double v) { return std::asinh(v); }));
}
Taylor inverse_hyperbolic_cosine(const Taylor& a, const Arithmetic& with) {
  if (!(a.c[0].low >= 1)) return with.range(whole_line);
  const Interval value = growing(a.c[0], [](double v) { return std::acosh(v); });
  const Taylor rest = with.subtract(with.square(a), one(with));
  if (!(rest.c[0].low > 0)) return with.range(value);
  return with.with_slope(a, with.square_root(rest), value);
}
Taylor inverse_hyperbolic_tangent(const Taylor& a, const Arithmetic& with) {
  if (!(a.c[0].low > -1 && a.c[0].high < 1)) return with.range(whole_line);
  return with.with_slope(a, with.subtract(one(with), with.square(a)),
                         growing(a.c[0], [](double v) { return std::atanh(v); }));
}

template <Taylor (TaylorArithmetic::*function)(const Taylor&) const>
Taylor member(Arguments a, const Arithmetic& with) {
  return (with.*function)(a[0]);
}
template <Taylor (*function)(const Taylor&, const Arithmetic&)>
Taylor free(Arguments a, const Arithmetic& with) {
  return function(a[0], with);
}
Taylor logarithm_of_base(const Taylor& a, double base, const Arithmetic& with) {
  return with.divide(with.logarithm(a), with.constant(logarithm(exactly(base))));
}
Taylor total(Arguments a, const Arithmetic& with) {
  Taylor t = a[0];
  for (std::size_t k = 1; k < a.size(); ++k) t = with.add(t, a[k]);
  return t;
}

struct Function {
  std::string_view name;
  Breaking breaking;
  int least, most;  // arguments; -1: any number
  Taylor (*evaluate)(Arguments, const Arithmetic&);
};
const Function table[] = {
    {"abs", Breaking::Abs, 1, 1, nullptr},
    {"sign", Breaking::Sign, 1, 1, nullptr},
    {"min", Breaking::Min, 1, -1, nullptr},
    {"max", Breaking::Max, 1, -1, nullptr},
    {"rint", Breaking::Rint, 1, 1, nullptr},
    {"exp", Breaking::No, 1, 1, member<&TaylorArithmetic::exponential>},
    {"log", Breaking::No, 1, 1, member<&TaylorArithmetic::logarithm>},
    {"ln", Breaking::No, 1, 1, member<&TaylorArithmetic::logarithm>},
    {"log2", Breaking::No, 1, 1, [](Arguments a, const Arithmetic& with) { return logarithm_of_base(a[0], 2, with); }},
    {"log10", Breaking::No, 1, 1,
     [](Arguments a, const Arithmetic& with) { return logarithm_of_base(a[0], 10, with); }},
    {"sin", Breaking::No, 1, 1, member<&TaylorArithmetic::sine>},
    {"cos", Breaking::No, 1, 1, member<&TaylorArithmetic::cosine>},
    {"tan", Breaking::No, 1, 1, free<tangent>},
    {"asin", Breaking::No, 1, 1, free<inverse_sine>},
    {"acos", Breaking::No, 1, 1, free<inverse_cosine>},
    {"atan", Breaking::No, 1, 1, free<inverse_tangent>},
    {"atan2", Breaking::Angle, 2, 2, nullptr},
    {"sinh", Breaking::No, 1, 1, free<hyperbolic_sine>},
    {"cosh", Breaking::No, 1, 1, free<hyperbolic_cosine>},
    {"tanh", Breaking::No, 1, 1, member<&TaylorArithmetic::hyperbolic_tangent>},
    {"asinh", Breaking::No, 1, 1, free<inverse_hyperbolic_sine>},
    {"acosh", Breaking::No, 1, 1, free<inverse_hyperbolic_cosine>},
    {"atanh", Breaking::No, 1, 1, free<inverse_hyperbolic_tangent>},
    {"sum", Breaking::No, 1, -1, total},
    {"avg", Breaking::No, 1, -1,
     [](Arguments a, const Arithmetic& with) {
       return with.divide(total(a, with), with.constant(exactly(static_cast<double>(a.size()))));
     }},
};

}  // namespace

int function_called(std::string_view name) {
  for (std::size_t k = 0; k < std::size(table); ++k)
    if (table[k].name == name) return static_cast<int>(k);
  return -1;
}

bool takes_arguments(int function, std::size_t count) {
  const Function& f = table[function];
  const int n = static_cast<int>(count);
  return n >= f.least && (f.most < 0 || n <= f.most);
}

Breaking breaking(int function) {
  return table[function].breaking;
}

Taylor evaluate(int function, std::span<const Taylor> arguments, const TaylorArithmetic& with) {
  return table[function].evaluate(arguments, with);
}

}  // namespace kerf
