#pragma once
// What acts on the body: supports, loads, crack laws; and what it is made of.

#include "kerf/field.hpp"
#include "kerf/material.hpp"

#include <functional>
#include <vector>

namespace kerf {

/// Prescribed displacement on a label. The components are x, y, or normal, tangential when `normal_frame` is set; only
/// the components with first/second set are prescribed, the others stay free (rollers).
struct Support {
  Index label = none;
  bool normal_frame = false;
  bool first = true, second = true;
  BoundaryField value;  // in those components
};

struct Traction {
  Index label = none;
  BoundaryField value;  // x, y components of sigma n
};

/// Faces in contact slide when the shear traction reaches slip_bound + friction * (pressure of contact, without that of
/// a fluid): Tresca's law with friction = 0, Coulomb's with slip_bound = 0; for loads that grow in proportion.
struct CrackLaw {
  enum class Kind { Unilateral, Open, Bonded } kind = Kind::Unilateral;
  double friction = 0;    // Coulomb's coefficient
  double slip_bound = 0;  // stress
  /// Unit normal of a curved crack, either way; empty: that of its edges. Chords would lock: sliding faces of a polygon
  /// interlock at every vertex.
  std::function<Vec2(const Vec2& x)> normal = {};
  /// Pressure p of a fluid in the crack, in the first component: it acts on both faces, sigma_nn = -p - the pressure of
  /// contact [theory: C.15]. Negative: suction. A shear q in the second component: sigma_nt = -q, t = n turned by +90
  /// degrees, on open cracks alone. The direction of the normal n that it is given is arbitrary; empty: none.
  BoundaryField pressure = {};
  /// Distance g of the faces before loading, in the first component: they touch where the normal jump is -g
  /// [theory: C.21]. Negative: interference, a press fit. Unilateral cracks alone; empty: none.
  BoundaryField gap = {};
};

/// Faces that may touch and part.
inline bool is_unilateral(const CrackLaw& law) {
  return law.kind == CrackLaw::Kind::Unilateral;
}

/// Faces that are apart, or overlap, before loading.
inline bool has_gap(const CrackLaw& law) {
  return is_unilateral(law) && static_cast<bool>(law.gap);
}

/// Faces that resist sliding.
inline bool has_friction(const CrackLaw& law) {
  return is_unilateral(law) && (law.friction > 0 || law.slip_bound > 0);
}

/// Strain e that the material would take without stress, from heat, swelling, a misfit, or left by its making, as the
/// plane problem sees it: in plane strain e11 + nu e33, e22 + nu e33. Empty: none.
struct Eigenstrain {
  VectorField normal;         // 11, 22
  VectorField shear;          // 12; and e33 of plane strain, for the stress s33 = nu tr s - E e33
  bool out_of_plane = false;  // e33 is not 0
  explicit operator bool() const {
    return static_cast<bool>(normal);
  }
};

/// Faces that a fluid presses apart.
inline bool has_pressure(const CrackLaw& law) {
  return static_cast<bool>(law.pressure);
}

struct Scene {
  Material material;
  std::vector<Material> regions;         // per region of the mesh, instead of `material`
  std::vector<Eigenstrain> eigenstrain;  // outside all regions, then per region; may be shorter
  VectorField body;                      // force per area; empty: none
  std::vector<Support> supports;
  std::vector<Traction> tractions;
  std::vector<CrackLaw> laws;  // per crack
};

/// Whether faces of a crack may touch.
inline bool has_contact(const Scene& scene) {
  for (const CrackLaw& law : scene.laws)
    if (is_unilateral(law)) return true;
  return false;
}

inline bool has_eigenstrain(const Scene& scene) {
  for (const Eigenstrain& e : scene.eigenstrain)
    if (e) return true;
  return false;
}

/// `material` first.
inline std::vector<Material> all_materials(const Scene& scene) {
  std::vector<Material> all{scene.material};
  all.insert(all.end(), scene.regions.begin(), scene.regions.end());
  return all;
}

}  // namespace kerf
