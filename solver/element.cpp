#include "solver/element.hpp"

#include <fmt/core.h>

namespace kerf {

const Element& element(std::string_view name, int degree) {
  std::string known;
  for (const Element& e : elements) {
    if (e.name == name && e.degree == degree) return e;
    known += fmt::format("{}\"{}\" of degree {}", known.empty() ? "" : ", ", e.name, e.degree);
  }
  throw Error(Fault::Usage, fmt::format("unknown element \"{}\" of degree {}; known: {}", name, degree, known));
}

}  // namespace kerf
