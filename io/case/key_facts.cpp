// Units and refusals of keys, for the pages of docs/case-files. A unit belongs to the name of a key, wherever it
// stands; the few paths that differ come first. A refusal belongs to a path. Stresses and lengths are those of [units].

#include "io/case/key_facts.hpp"

#include <algorithm>
#include <string>

namespace kerf {

namespace {

using View = std::string_view;

struct Unit {
  View unit, names;  // separated by spaces
};

constexpr View intensity = "stress * sqrt(length)";

constexpr Unit units_of_paths[] = {
    {"length",
     "functional.length map.length grow.until.length grow.law.a_0 synthetic.size optimize.least_squares.noise"},
    {"none", "synthetic.noise map.perturbation.aspect optimize.start.holes"},
    {"force / length", "material.release_rate region[].release_rate"},
    {"length per cycle / (stress * sqrt(length))^m", "grow.law.C"},
    {"stress / length", "body.force load_case[].body.force"},
    {"force / thickness", "load[].force"},
    {"number of cycles", "grow.until.cycles"},
    {intensity, "grow.until.K"},
    {"of the functional", "optimize.bound[].at_most"},
    {"of J / length^2", "optimize.volume.penalty"},
    {"length, or stress for crack_pressure", "functional.target"},
};

constexpr Unit units_of_names[] = {
    {"length",
     "arc_to center near radius semi_axes polygon outline path points at width gap size crack_tip_size displacement "
     "displacement_x displacement_y displacement_normal ring radii largest from to spacing smoothing min_feature "
     "min_gap min_radius min_distance step thickness x y point measured"},
    {"stress", "young shear yield tresca pressure traction stress"},
    {intensity, "toughness K_c K_IIc threshold dK_0"},
    {"degrees", "angle angle_deg from_deg to_deg min_angle"},
    {"none",
     "poisson friction eigenstrain weight factor direction p ends supports ratio max min m gamma q alpha flow_ratio "
     "C_plus C_minus anisotropy error tolerance at_most fraction ersatz substeps define"},
};

struct Refusal {
  View path, text;
};

constexpr Refusal refusals[] = {
    {"hole[]", "beside a mesh in domain.file (.msh), into which nothing is drawn"},
    {"crack[]", "with a form beside a mesh in domain.file (.msh)"},
    {"crack[].path",
     "along a part of a border of materials that does not end at corners; across a border at less than "
     "1 degree; [optimize] refuses cracks on borders"},
    {"crack[].contact", "p1 and p2 take open and bonded alone, arnold-winther-c bonded alone"},
    {"crack[].friction",
     "contact other than unilateral; functional misfit in maps and [optimize]; start = \"map\" in [optimize]"},
    {"crack[].tresca",
     "contact other than unilateral; functional misfit in maps and [optimize]; start = \"map\" in [optimize]"},
    {"crack[].pressure",
     "contact = \"bonded\"; element arnold-winther; level sets; [[load_case]]; [[synthetic.crack]]; functional "
     "energy_release_rate"},
    {"crack[].gap", "contact other than unilateral; functional energy_release_rate"},
    {"material.young",
     "the pair [E1, E2]: plane strain; [optimize]; maps of inclusions, small cracks, clamped holes "
     "and powers of the stress"},
    {"material.poisson", "0.5 in plane strain: p1 and p2; arnold-winther-c with displacements all around"},
    {"material.eigenstrain", "[optimize]; functional energy_release_rate; arnold-winther and its variants, p1 and p2"},
    {"region[]",
     "sides that cross the outline or a hole; with [optimize] sides that touch the outline, a hole or each other; a "
     "form beside a mesh in domain.file (.msh); element arnold-winther-c"},
    {"region[].eigenstrain", "as material.eigenstrain"},
    {"interface[]", "[optimize]; a body from domain.file"},
    {"boundary[].at", "a mesh in domain.file (.msh)"},
    {"boundary[].symmetry",
     "curved sides; a second condition on the side; a body force across the plane; an "
     "eigenstrain with a shear on it; material axes that it does not halve"},
    {"load[]", "a mesh in domain.file (.msh)"},
    {"load_case[]", "without [optimize]"},
    {"step[]", "map, validate, optimize, grow; mesh.adapt; [synthetic]; backend umfpack; p1 and p2"},
    {"mesh.refine", "validate, optimize, grow: they mesh the body anew"},
    {"mesh.mesher", "without a geometry in domain.file"},
    {"mesh.adapt", "p1 and p2; output.estimate = false; [[step]]"},
    {"solver.degree", "above 1 for elements other than bdms and afw"},
    {"solver.contact", "uzawa: more than 3000 unknowns on the faces of cracks"},
    {"solver.backend",
     "umfpack: arnold-winther, arnold-winther-c, p1, p2, and [[step]]. petsc: elements other than "
     "bdms, afw and arnold-winther-nc"},
    {"solver.precision", "single: backend umfpack"},
    {"solver.petsc", "other backends"},
    {"functional.crack",
     "energy_release_rate and stress_intensity: a crack with pressure or gap, a body with an eigenstrain; "
     "stress_intensity: an arc, friction, orthotropic bodies too"},
    {"functional.p", "4 and above in maps of small cracks"},
    {"map.perturbation",
     "clamped_hole: more than one material, powers of the stress. crack: powers of the stress from "
     "4 on. Orthotropic bodies: free holes and ellipses alone"},
    {"map.bounds", "bdms of degree 4; edge_crack. Clamped holes get no bars"},
    {"map.second",
     "no values, with a note: friction, body forces, eigenstrains, several materials, orthotropic bodies, "
     "perturbations other than circular free holes and inclusions, functionals that are neither energies nor linear in "
     "the state"},
    {"validate.points", "peers, bdms-c, arnold-winther, arnold-winther-c, p1, p2"},
    {"bounds", "no intervals, with a note: elements other than bdms and afw, friction"},
    {"grow", "[[load_case]] beyond the first; [[step]]; mesh.refine; several processes"},
    {"grow.law", "quasi-static: gaps, eigenstrains and slip bounds (tresca)"},
    {"optimize", "orthotropic materials; eigenstrains; interfaces; cracks on borders of materials; regions that touch"},
    {"optimize.ersatz", "[[region]]"},
    {"optimize.bound[]", "a misfit"},
};

bool is_listed(View names, View name) {
  while (!names.empty()) {
    const std::size_t end = std::min(names.find(' '), names.size());
    if (names.substr(0, end) == name) return true;
    names.remove_prefix(std::min(end + 1, names.size()));
  }
  return false;
}

}  // namespace

bool is_numeric(const Key& key) {
  using enum KeyType;
  constexpr KeyType kinds[] = {Number, Pair, PointList, Numbers, Formula, Vector, Box, BoxPair, BoxPairs, Tensor};
  return std::ranges::any_of(kinds, [&](KeyType kind) { return has(key.type, kind); });
}

std::string_view unit_of(const Key& key) {
  if (!is_numeric(key)) return {};
  for (const auto& [unit, paths] : units_of_paths)
    if (is_listed(paths, key.path)) return unit;
  for (const auto& [unit, names] : units_of_names)
    if (is_listed(names, name(key))) return unit;
  return {};
}

std::string_view refused_with(const Key& key) {
  const auto found = std::ranges::find(refusals, key.path, &Refusal::path);
  return found == std::end(refusals) ? View() : found->text;
}

}  // namespace kerf
