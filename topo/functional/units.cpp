// Names of units: of every result as stress^a length^b per unit thickness, written with a force where the unit of
// stress times that of length squared has a name. Inputs have no units: the case names those of stress and length and
// results repeat them, so that nothing is converted. The dimension of each functional follows from its integral (a
// functional of the displacement over the boundary is a length squared, a power p of the stress over the body stress^p
// length^2). Young's modulus is compared with what solids have, for a note on a mistaken unit.

#include "kerf/units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace kerf {

namespace {

struct Stress {
  std::string_view name;
  double pascal;
  std::string_view length, force;  // with this length its force per length reads so
};
constexpr std::array<Stress, 8> stresses{{{"Pa", 1, "m", "N"},
                                          {"kPa", 1e3, "m", "kN"},
                                          {"MPa", 1e6, "mm", "N"},
                                          {"MPa", 1e6, "m", "MN"},
                                          {"GPa", 1e9, "mm", "kN"},
                                          {"GPa", 1e9, "m", "GN"},
                                          {"psi", 6894.757293168, "in", "lbf"},
                                          {"ksi", 6894757.293168, "in", "kip"}}};

std::string power(const std::string& name, double exponent) {
  if (exponent == 0) return "";
  if (exponent == 1) return name;
  if (exponent == 0.5) return "\u221a" + name;
  if (exponent == 2) return name + "\u00b2";
  if (exponent == 3) return name + "\u00b3";
  return fmt::format("{}^{:.4g}", name, exponent);
}

std::string product(const std::string& a, const std::string& b) {
  return a + (a.empty() || b.empty() ? "" : " ") + b;
}

/// What stress times area is called; empty: nothing.
std::string force_of(const Units& units) {
  for (const Stress& s : stresses)
    if (s.name == units.stress && s.length == units.length) return std::string(s.force);
  return "";
}

}  // namespace

std::string unit(const Units& units, const Dimension& of) {
  if (!units.given()) return "";
  if (const std::string force = force_of(units); !force.empty() && of.stress == 1 && of.length >= 1)
    return product(force, power(units.length, of.length - 1)) + "/" + units.length;
  return product(power(units.stress, of.stress), power(units.length, of.length));
}

// Of a plate of given thickness: one length more.
std::string unit_of_plate(const Units& units, const Dimension& of) {
  if (!units.given()) return "";
  const double length = of.length + 1;
  if (const std::string force = force_of(units); !force.empty() && of.stress == 1 && length >= 2)
    return product(force, power(units.length, length - 2));
  return product(power(units.stress, of.stress), power(units.length, length));
}

// Of a single functional; nothing is told of sums.
std::optional<Dimension> dimension_of(const Functional& j) {
  if (j.sum || j.terms.empty()) return std::nullopt;
  const Term& term = j.terms.front();
  struct Known {
    std::string_view kind;
    Dimension dimension;
  };
  const std::array<Known, 15> known{{{"energy", dimension::energy},
                                     {"compliance", dimension::energy},
                                     {"misfit", dimension::energy},
                                     {"volume", dimension::area},
                                     {"displacement_tracking", {0, 4}},
                                     {"boundary_tracking", {0, 3}},
                                     {"displacement", {0, 2}},
                                     {"stress_power", {term.stress_power, 2}},
                                     {"stress_pnorm", {1, term.stress_power > 0 ? 2 / term.stress_power : 0}},
                                     {"worst_edge_crack", {1, 0.5 + (term.edge_cracks ? 1 / term.edge_cracks->p : 0)}},
                                     {"max_stress", {1, 0}},
                                     {"energy_release_rate", dimension::release_rate},
                                     {"stress_intensity", {1, 0.5}},
                                     {"crack_opening", {0, 2}},
                                     {"crack_pressure", {2, 1}}}};
  const auto found = std::ranges::find(known, j.kind, &Known::kind);
  return found == known.end() ? std::nullopt : std::optional(found->dimension);
}

Dimension per_area(const Dimension& j) {
  return {j.stress, j.length - 2};
}

// By the first unit of that name; pascals per unit do not depend on the length.
std::string implausible(const Units& units, double young) {
  const auto found = std::ranges::find(stresses, units.stress, &Stress::name);
  if (found == stresses.end()) return "";
  constexpr double softest = 1e9, stiffest = 1.3e12, steel = 2.1e11;  // Pa: hard plastics, diamond
  const double pascal = young * found->pascal;
  if (pascal >= softest && pascal <= stiffest) return "";
  return fmt::format("young = {:.4g} {} is {}; steel has {:.4g} {}", young, units.stress,
                     pascal < softest ? "that of soft plastics or rubber" : "more than diamond has",
                     steel / found->pascal, units.stress);
}

}  // namespace kerf
