// Marks of axes and their labels. Steps are 1, 2 or 5 times a power of ten, the finest that gives no more marks than
// asked for. Labels have the digits of the step. Where values are large or small a power of ten goes to the end of the
// axis ("×10⁵"), and where all of them differ only beyond five digits an offset ("+ 1.2345×10³"). Logarithmic axes have
// labels at powers of ten, every second, fifth, ... of them where there are many, at 2 and 5 times them where there is
// less than a decade. Minus signs and exponents are those of print.

#include "plot/figure/ticks.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

std::string proper_minus(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '-' ? "−" : std::string(1, c);
  return out;
}

std::string power_of_ten(int exponent) {
  static constexpr const char* digits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string out = "10";
  for (const char c : fmt::format("{}", exponent)) out += c == '-' ? "⁻" : digits[c - '0'];
  return out;
}

/// "1.25e-07" -> "1.25×10⁻⁷"
std::string raised(const std::string& text) {
  const std::size_t e = text.find('e');
  if (e == std::string::npos) return proper_minus(text);
  return proper_minus(text.substr(0, e)) + "×" + power_of_ten(std::stoi(text.substr(e + 1)));
}

int decade(double value) {  // of a positive number
  return static_cast<int>(std::floor(std::log10(value) + 1e-9));
}

struct Step {
  int mantissa, exponent;  // mantissa 1, 2 or 5
  double value() const {
    return exponent < 0 ? mantissa / std::pow(10.0, -exponent) : mantissa * std::pow(10.0, exponent);
  }
  Step finer() const {
    return mantissa == 1 ? Step{5, exponent - 1} : mantissa == 2 ? Step{1, exponent} : Step{2, exponent};
  }
};

}  // namespace

std::string pretty(double value, int digits) {
  if (!std::isfinite(value)) return "–";
  return raised(fmt::format("{:.{}g}", value == 0 ? 0.0 : value, digits));
}

Ticks ticks(double low, double high, int at_most) {
  Ticks out;
  const double size = std::max(std::abs(low), std::abs(high));
  if (!std::isfinite(low) || !std::isfinite(high) || !(high - low > 1e-10 * size) || size < 1e-290 || size > 1e290) {
    out.at = {0.5 * low + 0.5 * high};
    out.labels = {pretty(out.at[0])};
    return out;
  }
  // The last step that still gives no more marks than asked, but at least two marks.
  const auto first = [&](const Step& s) { return std::ceil(low / s.value() - 1e-6); };
  const auto count = [&](const Step& s) { return std::floor(high / s.value() + 1e-6) - first(s) + 1; };
  Step step{1, decade(high - low) + 1};
  while (count(step) < 2 || count(step.finer()) <= at_most) step = step.finer();

  const double marks = count(step), value = step.value();
  double offset = 0;
  if (decade(size) - decade(value) > 5) {
    const double round = std::pow(10.0, decade(high - low));
    offset = std::floor((low + 0.1 * (high - low)) / round) * round;
  }
  double largest = 0;
  for (double k = 0; k < marks; ++k) {
    out.at.push_back((first(step) + k) * value);
    largest = std::max(largest, std::abs(out.at.back() - offset));
  }
  const int top = decade(largest), exponent = top >= 5 || top <= -3 ? top : 0;
  const int digits = std::max(0, exponent - step.exponent);
  const double scale = std::pow(10.0, -exponent);
  for (const double at : out.at) {
    const double mantissa = std::round((at - offset) / value) * value * scale;
    out.labels.push_back(proper_minus(fmt::format("{:.{}f}", mantissa == 0 ? 0.0 : mantissa, digits)));
  }
  if (exponent != 0) out.note = "×" + power_of_ten(exponent);
  if (offset != 0) {
    const std::string shift = raised(fmt::format("{:.12g}", std::abs(offset)));
    out.note += fmt::format("{}{} {}", out.note.empty() ? "" : " ", offset < 0 ? "−" : "+", shift);
  }
  return out;
}

LogTicks log_ticks(double low, double high, int at_most) {
  constexpr double slack = 1e-9;  // ends that are powers of ten, but for rounding
  const int first = static_cast<int>(std::ceil(std::log10(low) - slack));
  const int last = static_cast<int>(std::floor(std::log10(high) + slack));
  int every = 1;
  for (const int step : {1, 2, 5, 10, 20, 50, 100, 200}) {
    every = step;
    if ((last - first) / step + 1 <= at_most) break;
  }
  const bool few = last - first < 1;  // then 2 and 5 have labels, too
  LogTicks out;
  for (int k = first - 1; k <= last; ++k) {
    const double decade = std::pow(10.0, k);
    for (const int m : {1, 2, 3, 4, 5, 6, 7, 8, 9}) {
      const double value = m * decade;
      if (value < low * (1 - slack) || value > high * (1 + slack)) continue;
      const bool labeled = m == 1 ? (k - first) % every == 0 : few && (m == 2 || m == 5);
      if (labeled) {
        out.major.at.push_back(value);
        out.major.labels.push_back(m == 1 ? power_of_ten(k) : fmt::format("{}×{}", m, power_of_ten(k)));
      } else if (every == 1 || m == 1) {
        out.minor.push_back(value);
      }
    }
  }
  return out;
}

}  // namespace kerf
