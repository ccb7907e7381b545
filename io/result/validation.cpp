// What a validation says in one sentence, J(eps) - J(0) = pi eps^2 (T + c2 eps^2 + c3 eps^2 ln eps), and its table.
// docs/theory/validation.md, "The verdict".

#include "io/validation.hpp"

#include "io/csv.hpp"
#include "io/files.hpp"
#include "io/text.hpp"

#include <cmath>

namespace kerf {

namespace {

/// " + 5.6 eps^2", or nothing for a number that says nothing.
std::string summand(double value, const char* power) {
  if (!std::isfinite(value) || value == 0) return "";
  return fmt::format(" {} {:.3g} {}", value < 0 ? '-' : '+', std::abs(value), power);
}

}  // namespace

std::string sentence(const Validation& v) {
  std::string out = "At " + place(v.at);
  const bool expansion = std::isfinite(v.coefficient);  // not of a clamped hole
  const std::string order =
      std::isfinite(v.order) ? fmt::format("observed order {:.2f}", v.order) : "no observed order";
  if (v.verdict != Verdict::Holds && v.verdict != Verdict::Fails) {
    const std::string said = v.verdict == Verdict::Vanishes     ? " the expansion vanishes"
                             : v.verdict == Verdict::OutOfRange ? " out of range"
                                                                : " nothing can be said";
    return out + said + (v.reason.empty() ? "." : ": " + v.reason + ".");
  }
  const char* verdict = v.verdict == Verdict::Holds ? "holds" : "fails";
  out += fmt::format(" the {} {}: ", expansion ? "expansion" : "renormalized prediction", verdict);
  if (v.verdict == Verdict::Fails) {
    if (!v.reason.empty()) out += v.reason + "; ";
    if (expansion) out += fmt::format("T = {}, intercept {}, ", six(v.coefficient), six(v.intercept));
    return out + order + ".";
  }
  if (expansion)
    out += fmt::format("J(eps) - J(0) = pi eps^2 ({:.4g}{}{}), ", v.coefficient, summand(v.c2, "eps^2"),
                       summand(v.c3, "eps^2 ln eps"));
  out += order;
  const double gap = std::abs(v.intercept - v.coefficient);
  if (expansion && std::isfinite(gap))
    out += v.coefficient == 0 ? fmt::format(", intercept {}", six(v.intercept))
                              : fmt::format(", intercept within {:.2g} % of T", 100 * gap / std::abs(v.coefficient));
  if (std::isfinite(v.bar)) out += "; " + v.reason;
  return out + ".";
}

void write_validation_csv(const std::filesystem::path& path, const ValidationResult& result) {
  fmt::memory_buffer out;
  const auto text = [&out](std::string_view piece) { out.append(piece.data(), piece.data() + piece.size()); };
  text(
      "point,x,y,radius,J,J0,difference,predicted,remainder,order,coefficient,intercept,on_mesh,bar,"
      "independent,c2,c2_predicted,predicted_second,remainder_second,order_second,verdict,reason\n");
  for (std::size_t i = 0; i < result.points.size(); ++i) {
    const Validation& v = result.points[i];
    for (const ValidationRow& row : v.rows) {
      text(fmt::format("{},", i + 1));
      for (const double value :
           {v.at.x(), v.at.y(), row.radius, row.J, row.J - row.difference, row.difference, row.predicted, row.remainder,
            row.order, v.coefficient, v.intercept, v.on_mesh, v.bar, v.drawn.intercept, v.c2, v.c2_predicted,
            row.predicted_second, row.remainder_second, row.order_second}) {
        append_cell(out, value);
        out.push_back(',');
      }
      text(std::string(word(v.verdict)) + "," + csv_text(clean_text(v.reason)) + "\n");
    }
  }
  write_file(path, {out.data(), out.size()});
}

}  // namespace kerf
