#pragma once
// What one kind of perturbation is: a row of this table, which stands beside the formulas in formulas/<kind>.cpp.

#include "kerf/perturbation.hpp"

#include <array>

namespace kerf {

/// What lies where the body was.
enum class Becomes { Nothing, Material, Clamp, Slit };

struct PerturbationKind {
  std::string_view word;  // of word(kind)
  std::string (*description)(const Perturbation& p);
  Becomes becomes = Becomes::Nothing;
  bool elliptic = false;  // has an aspect
  /// form(s, t); null: J has no series in eps.
  double (*form)(const Perturbation& p, const Material& m, double angle, const Mat2& s, const Mat2& t) = nullptr;
  /// The angle that a perturbation without one takes, and the value there; null: it has no orientation.
  Oriented (*orient)(const Perturbation& p, const Material& m, std::span<const Product> products) = nullptr;
  /// The stress inside, of a free circle alone.
  Transmission (*inside)(const Perturbation& p, const Material& m) = nullptr;
};

namespace kinds {
extern const PerturbationKind hole, clamped_hole, inclusion, ellipse, crack;
}
/// In the order of Perturbation::Kind.
inline constexpr std::array perturbation_kinds{&kinds::hole, &kinds::clamped_hole, &kinds::inclusion, &kinds::ellipse,
                                               &kinds::crack};

inline const PerturbationKind& row(const Perturbation& p) {
  return *perturbation_kinds[static_cast<std::size_t>(p.kind)];
}

/// Whether the body force goes with the body.
inline bool removes_body(const Perturbation& p) {
  return row(p).becomes == Becomes::Nothing;
}
/// Whether it has an orientation.
inline bool is_directed(const Perturbation& p) {
  return row(p).orient != nullptr;
}
/// Ratio of the axes; 1 for all but an ellipse.
inline double aspect(const Perturbation& p) {
  return row(p).elliptic ? p.aspect : 1;
}
/// How far it reaches, in radii.
double reach(const Perturbation& p);

}  // namespace kerf
