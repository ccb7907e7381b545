#pragma once
// The units in which a case is written. They are labels: nothing is converted.

#include "kerf/functional.hpp"

#include <optional>
#include <string>

namespace kerf {

struct Units {
  std::string length, stress;  // both, or neither
  bool given() const {
    return !length.empty();
  }
};

/// stress^stress length^length, of a body of unit thickness.
struct Dimension {
  double stress = 0, length = 0;
};

namespace dimension {
inline constexpr Dimension length{0, 1}, area{0, 2}, stress{1, 0}, force{1, 1}, moment{1, 2}, energy{1, 2},
    stress_intensity{1, 0.5}, release_rate{1, 1};
}

/// "MPa", "N/mm", "MPa √mm"; forces and energies are those per unit of thickness. Empty without units.
std::string unit(const Units& units, const Dimension& of);

/// The same of a whole plate, thickness included: "N" for a force.
std::string unit_of_plate(const Units& units, const Dimension& of);

/// Of a functional whose weights have none; nothing for sums.
std::optional<Dimension> dimension_of(const Functional& j);

/// Of its topological derivative, which is per area.
Dimension per_area(const Dimension& j);

/// What is odd about a modulus in these units, in words; empty: nothing.
std::string implausible(const Units& units, double young);

}  // namespace kerf
