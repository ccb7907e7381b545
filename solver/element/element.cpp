#include "kerf/element.hpp"

#include <fmt/core.h>

namespace kerf {

const Element& element(std::string_view name, int degree) {
  std::string known, degrees;
  for (const Element& e : elements) {
    if (e.name == name && e.degree == degree) return e;
    if (e.name == name) degrees += fmt::format("{}{}", degrees.empty() ? "" : ", ", e.degree);
    if (known.find(fmt::format("\"{}\"", e.name)) == std::string::npos)
      known += fmt::format("{}\"{}\"", known.empty() ? "" : ", ", e.name);
  }
  if (!degrees.empty())
    throw Error(Fault::Usage, fmt::format("element \"{}\" has no degree {}; it has {}", name, degree, degrees));
  throw Error(Fault::Usage, fmt::format("unknown element \"{}\"; known: {}", name, known));
}

}  // namespace kerf
