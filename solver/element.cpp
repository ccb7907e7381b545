#include "solver/element.hpp"

#include <fmt/core.h>

namespace kerf {

const Element& element(std::string_view name) {
  std::string known;
  for (const Element& e : elements) {
    if (e.name == name) return e;
    known += (known.empty() ? "\"" : ", \"") + std::string(e.name) + "\"";
  }
  throw Error(Fault::Usage, fmt::format("unknown element \"{}\"; known: {}", name, known));
}

}  // namespace kerf
