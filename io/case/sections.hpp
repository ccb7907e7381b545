#pragma once
// The sections of a case file, each read by one function. Which keys exist is said in keys.cpp and nowhere else.

#include "io/case/expression.hpp"
#include "io/case/fields.hpp"
#include "kerf/case_file.hpp"

namespace kerf {

/// [domain], [[hole]], [[crack]]. Labels: those of the sides in order of appearance, then "hole:<name>" per hole. Of a
/// body from a file (relative to `folder`) also what is known of its regions, its mesh and shape left out.
std::optional<MeshFile> read_shape(const Value& document, const std::filesystem::path& folder, Case& c);

/// The body that domain.file names, and which of its surfaces [[region]] and optimize.frozen mean.
MeshFile read_body_file(const Value& document, const Value& domain, const std::filesystem::path& folder, Case& c);

/// The laws that [[crack]] gives to the cracks of a file; tables of cracks that are drawn are left.
std::vector<Value> read_laws_of_file(const std::vector<Value>& tables, Case& c);

/// Whether [optimize] names a region as frozen.
bool is_frozen(const Value& document, const std::string& name);

CrackLaw read_law(const Value& crack);

/// CrackLaw::normal of an arc; empty for straight edges.
std::function<Vec2(const Vec2& x)> normal_of(const Crack& crack);

/// More of these tables, with names of their own. They come from left to right, by where they begin, so that nothing
/// hangs on how the tables stand: the mesh depends on the order of what it is made of.
/// A loop by circle, ellipse, polygon or outline.
Loop read_loop(const Value& table, const std::string& name, Index label);
/// Whether it comes first where the order of tables must not matter.
bool begins_before(const Loop& a, const Loop& b);

void add_holes(const std::vector<Value>& tables, Shape& shape);
void add_cracks(const std::vector<Value>& tables, Shape& shape, std::vector<CrackLaw>& laws);
/// What regions are made of by their keys; `body`: those that have an eigenstrain and no material of their own.
struct BodyMaterial {
  Elastic elastic;
  bool plane_strain = true;
};
std::vector<Elastic> add_regions(const std::vector<Value>& tables, const BodyMaterial& body, Shape& shape,
                                 std::vector<Material>& materials);

/// [[region]], in the plane state that [material] has.
struct ReadRegions {
  std::vector<Loop> frozen;  // by [optimize]; they are regions of the shape only if they have a material
  std::vector<std::optional<Value>> tables;  // per region of the scene, those that have one
};
ReadRegions read_regions(const Value& document, const std::optional<MeshFile>& file, Case& c);

/// [define]: the named subexpressions, each checked, and which of them have been used.
struct Definitions {
  ExpressionContext context;
  std::vector<Position> positions;
  std::vector<bool> used;
};
Definitions read_definitions(const Value& document, const Case& c);
void check_all_used(const Definitions& definitions);

/// The eigenstrains of [material] and of the regions.
void read_eigenstrains(const Value& document, const std::vector<std::optional<Value>>& regions,
                       Definitions& definitions, Case& c);

/// [[load]], and [[boundary]] with `at`: their edges are drawn into the shape. After the shape, before everything that
/// names labels.
void read_patches(const Value& document, Case& c);
/// The tables of Case::patches, in their order.
std::vector<Value> tables_of_patches(const Value& document);

/// Short sides beside the tips of cracks in planes of symmetry. After the conditions and [mesh].
void draw_half_tips(Case& c);

/// Fails where a label cannot be a plane of symmetry: curved sides, a body force across it, an eigenstrain with a
/// shear, a material whose axes it does not halve. `blamed`: the key that asks for it.
void require_symmetry(const Position& blamed, Index plane, const VectorField& body, const Case& c);

/// [[boundary]], [[load]] and [body].
void read_conditions(const Value& document, Definitions& definitions, Case& c);

/// [[step]]: the scene at the end of every part of a step; leaves the definitions as the last step does. Before the
/// conditions, which are then those of the last step.
void read_steps(const Value& document, const std::vector<std::optional<Value>>& regions, Definitions& definitions,
                Case& c);

/// [functional]: the energy when there is no table. Files lie relative to `folder`. After the conditions.
void read_functional(const Value& document, const std::filesystem::path& folder, Definitions& definitions, Case& c);
/// What the largest stresses of [functional] and of bounds leave out. After all loads and [optimize].
void leave_out_zones(const std::vector<Loop>& frozen, Case& c);

/// The same for any table that has its keys. `notes`: where those on files of measured data go.
Functional read_functional_table(const Value& table, const std::filesystem::path& folder, Definitions& definitions,
                                 const Case& c, std::vector<std::string>* notes = nullptr);

/// The key `measured` of [functional] that asks for synthetic data.
std::optional<Value> synthetic_misfit(const Value& document);

/// The readings behind a misfit: of its table of measured displacements; none of synthetic ones, which are made up
/// later. `blamed` is told where there is no misfit, or one that is no table.
Readings read_readings(const Value& document, const std::filesystem::path& folder, const Value& blamed, const Case& c);

/// [synthetic]. After [functional], [mesh] and [solver].
void read_synthetic(const Value& document, Case& c);

/// [[load_case]]. After the conditions.
std::vector<LoadCase> read_load_cases(const Value& document, Definitions& definitions, const Case& c);

/// [optimize] with [[load_case]]. After all that these refer to; `frozen` comes from read_regions.
void read_optimize(const Value& document, const std::filesystem::path& folder, const std::vector<Loop>& frozen,
                   Definitions& definitions, Case& c);

/// [[optimize.hole]], [[optimize.crack]] and [[optimize.region]].
Design read_design(const Value& optimize, const Case& c);

/// The keys `element` and `degree` of a table (degree 1 unless given), or `otherwise` without both. `blamed`: where an
/// element that does not exist is reported.
Element read_element(const Value& table, const Value& blamed, const Element& otherwise);

/// [map], [inspect] and [validate].
void read_map(const Value& document, Case& c);

/// The table `law` of [grow] and of [inspect].
void read_growth_law(const Value& law, growth::GrowRequest& to);

/// The constants of a table with young and poisson, and of an orthotropic material with young = [E1, E2] and shear.
Elastic read_elastic(const Value& table);

/// The material of such a table, which fails there when it is out of the range of numbers.
Material elastic(const Value& table, const Elastic& constants, bool in_plane_strain);

/// [[probe]]; files lie relative to `folder`.
void read_probes(const Value& document, const std::filesystem::path& folder, Case& c);

/// [bounds].
void read_bounds(const Value& document, Case& c);

/// [grow]; files lie relative to `folder`.
void read_grow(const Value& document, const std::filesystem::path& folder, Case& c);

/// The quantity that mesh.adapt refines for, if it names one. After the shape.
std::optional<GoalRequest> read_goal(const Value& adapt, const Case& c);

}  // namespace kerf
