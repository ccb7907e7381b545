// The table of elements (include/kerf/element.hpp) by name and degree, and the one wording of what an element cannot
// do: which ones can, and the way out.

#include "kerf/element.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

namespace kerf {

namespace {

/// What is said of an element that cannot, before the elements that can and, where there is one, another way out.
struct Refusal {
  Ability can;
  std::string_view lacks, or_else = "";
};
constexpr std::array refusals{
    Refusal{can_open, "cannot do cracks whose faces part: its stress is one at every vertex"},
    Refusal{can_contact, "cannot do contact on cracks", "contact = \"open\""},
    Refusal{can_press_cracks, "cannot do cracks with a pressure in them"},
    Refusal{can_have_regions, "cannot do regions of other materials: its stress is one at every vertex"},
    Refusal{can_be_strained, "cannot do an eigenstrain"},
    Refusal{can_be_curved, "cannot do curved triangles", "mesh.curved = false"},
    Refusal{can_be_incompressible, "cannot do an incompressible material (poisson = 0.5)"},
    Refusal{can_be_enclosed,
            "cannot do an incompressible body (poisson = 0.5) that its supports enclose: its pressure has no level"},
    Refusal{can_stay_uncondensed, "has no saddle-point system of its own (backend \"umfpack\")",
            "the backend \"cholmod\""},
    Refusal{can_adjoint, "has no adjoint"},
    Refusal{can_integrate_boundaries, "has no traces on edges, which functionals of boundaries need"},
    Refusal{can_clamp_holes, "has no Green tensor, which clamped holes need"},
    Refusal{can_validate, "cannot be condensed onto edges, which validation needs"},
    Refusal{can_optimize, "has no derivatives by the shape, which optimization needs"},
    Refusal{can_bound_energy, "has no bounds of the energy"},
    Refusal{can_estimate_error, "has no error estimate to adapt the mesh to"},
    Refusal{can_be_bettered, "is the best: no other could give error bars"},
};

std::string listed(const std::vector<std::string>& words, std::string_view last) {
  std::string all;
  for (std::size_t i = 0; i < words.size(); ++i)
    all += fmt::format("{}{}", i == 0 ? "" : i + 1 < words.size() ? ", " : last, words[i]);
  return all;
}

}  // namespace

bool has_degree(std::string_view name, int degree) {
  return std::ranges::any_of(elements, [&](const Element& e) { return e.name == name && e.degree == degree; });
}

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

std::string elements_that(Ability can) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < elements.size();) {
    const std::string_view name = elements[i].name;
    std::vector<std::string> degrees;
    std::size_t known = 0;
    for (; i < elements.size() && elements[i].name == name; ++i, ++known)
      if (can(elements[i])) degrees.push_back(std::to_string(elements[i].degree));
    if (degrees.empty()) continue;
    names.push_back(fmt::format("\"{}\"", name));
    if (degrees.size() < known) names.back() += fmt::format(" (degree {})", listed(degrees, " or "));
  }
  return listed(names, " or ");
}

std::optional<std::string> refusal(const Element& e, Ability can) {
  if (can(e)) return std::nullopt;
  const auto* known = std::find_if(refusals.begin(), refusals.end(), [&](const Refusal& r) { return r.can == can; });
  if (known == refusals.end()) throw std::invalid_argument("refusal: not one of the functions of element.hpp");
  const bool others =
      std::any_of(elements.begin(), elements.end(), [&](const Element& o) { return o.name == e.name && can(o); });
  return fmt::format("element \"{}\"{} {}; use {}{}", e.name, others ? fmt::format(" of degree {}", e.degree) : "",
                     known->lacks, elements_that(can),
                     known->or_else.empty() ? "" : fmt::format(", or {}", known->or_else));
}

void require(const Element& e, Ability can) {
  if (const auto why = refusal(e, can)) throw Error(Fault::Usage, *why);
}

}  // namespace kerf
