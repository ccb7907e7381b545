// A body that comes from a file: [domain] file, with what [[crack]] and [[region]] say of its parts. Physical curves
// crack:<name> and physical surfaces are matched with the tables by their names, both ways: a table that no curve has
// is refused. A mesh (.msh) or a geometry that gmsh meshes is taken as it is; kerf draws and meshes other geometries by
// itself, and only those can have more holes and cracks. The law of a crack needs the normal of its curve: of an arc it
// is known, of a polyline of at least five points whose kinks are small (0.3) it is that of the curve that the polyline
// stands for, tangents of second order at its corners, linear along the chords; other polylines have none.

#include "geometry/plane.hpp"
#include "io/case/sections.hpp"
#include "io/mesh_source.hpp"
#include "io/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

bool has_any_of(const Value& table, std::initializer_list<const char*> keys) {
  return std::any_of(keys.begin(), keys.end(), [&](const char* key) { return find(table, key).has_value(); });
}

/// The [[region]] tables that name surfaces of the file: those with a material (the numbers of `materials` count them),
/// and those that are masks.
MeshFileRequest wanted_surfaces(const Value& document) {
  MeshFileRequest request;
  for (const Value& region : find_tables(document, "region")) {
    allow_only(region);
    if (has_any_of(region, {"circle", "ellipse", "polygon", "outline"})) continue;
    const std::string name = safe_name(need(region, "name"));
    const bool mask = is_frozen(document, name), strained = find(region, "eigenstrain").has_value(),
               has_material = find(region, "young") || find(region, "poisson") || strained;
    if (mask) request.masks.push_back(name);
    if ((!mask && !strained) || find(region, "young") || find(region, "poisson")) {
      need(region, "young");
      need(region, "poisson");
    }
    // A mask alone keeps its number, but no triangle has it.
    request.materials.push_back(mask && !has_material ? std::string() : name);
  }
  return request;
}

void read_sides_of_file(const Value& domain, MeshFileRequest& request) {
  for (const Value& side : find_tables(domain, "side")) {
    allow_only(side);
    const Value near = need(side, "near");
    request.sides.push_back({point(near), safe_name(need(side, "name")), to_string(near.node->position) + ": "});
  }
}

/// The mean edge length of the mesh, as far as its triangles are equilateral.
double mean_size(const Mesh& mesh) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) sum += area(mesh, static_cast<Index>(t));
  return std::sqrt(4 / std::sqrt(3.0) * sum / static_cast<double>(mesh.triangles.size()));
}

/// What the file is by its name, and who meshes it.
BodySource body_source(const Value& document, const Value& field, const std::filesystem::path& folder) {
  BodySource source{.path = folder / text(field)};
  const auto mesh = find_table(document, "mesh");
  const auto mesher = mesh ? find(*mesh, "mesher") : std::nullopt;
  if (is_mesh_file(source.path)) {
    if (mesher) fail(mesher->node->position, fmt::format("{}: {} is a mesh already", mesher->name, quote(text(field))));
    return source;
  }
  if (!is_geometry_file(source.path))
    fail(field.node->position,
         fmt::format("{} = {}: a mesh ends in .msh, a geometry in .geo, .step, .stp, .brep, .iges or .igs", field.name,
                     quote(text(field))));
  source.keep_mesh = mesher && choice(*mesher) == "gmsh";
  if (mesh && source.keep_mesh) take(*mesh, "size", source.size);
  return source;
}

/// The normal of the curve that a polyline of many small kinks stands for: tangents at its corners, of second order,
/// linear along its chords. Empty for other polylines.
std::function<Vec2(const Vec2& x)> normal_of_chords(const std::vector<Vec2>& line) {
  constexpr std::size_t fewest = 5;  // points
  constexpr double most = 0.3;       // of a kink, as where polygons stand for curves
  if (line.size() < fewest) return {};
  std::vector<Vec2> direction, tangent;
  for (std::size_t k = 0; k + 1 < line.size(); ++k) direction.push_back((line[k + 1] - line[k]).normalized());
  for (std::size_t k = 1; k < direction.size(); ++k) {
    const Vec2 &before = direction[k - 1], &after = direction[k];
    if (std::abs(std::atan2(cross(before, after), before.dot(after))) > most) return {};
    const double a = (line[k] - line[k - 1]).norm(), b = (line[k + 1] - line[k]).norm();
    tangent.push_back((b * before + a * after).normalized());
  }
  const auto beyond = [](const Vec2& chord, const Vec2& other) { return Vec2(2 * chord.dot(other) * chord - other); };
  tangent.insert(tangent.begin(), beyond(direction.front(), tangent.front()));
  tangent.push_back(beyond(direction.back(), tangent.back()));
  return [line, tangent](const Vec2& x) {
    std::size_t nearest = 0;
    double least = infinity;
    for (std::size_t k = 0; k + 1 < line.size(); ++k)
      if (const double d = squared_distance(x, line[k], line[k + 1]); d < least) least = d, nearest = k;
    const double part = foot(x, line[nearest], line[nearest + 1]);
    const Vec2 t = ((1 - part) * tangent[nearest] + part * tangent[nearest + 1]).normalized();
    return Vec2(t.y(), -t.x());
  };
}

std::function<Vec2(const Vec2& x)> normal_in_file(const Crack& crack) {
  return crack.arc ? normal_of(crack) : normal_of_chords(crack.points);
}

}  // namespace

MeshFile read_body_file(const Value& document, const Value& domain, const std::filesystem::path& folder, Case& c) {
  const Value field = need(domain, "file");
  MeshFileRequest request = wanted_surfaces(document);
  read_sides_of_file(domain, request);
  const BodySource source = body_source(document, field, folder);
  MeshFile file = read_body(source, request);
  for (const Value& region : find_tables(document, "region")) {
    if (has_any_of(region, {"circle", "ellipse", "polygon", "outline"})) {
      if (source.keep_mesh)
        fail(
            region.node->position,
            "[[region]]: the mesh of domain.file is taken as it is; a region is a physical surface there, and its name "
            "is all that is said here");
      continue;
    }
    const Value name = need(region, "name");
    if (std::find(file.surfaces.begin(), file.surfaces.end(), text(name)) == file.surfaces.end())
      fail(name.node->position,
           fmt::format("{}: there is no physical surface {} in {}; {}", name.name, quote(text(name)),
                       quote(text(field)), file.surfaces.empty() ? "it has none" : suggest(text(name), file.surfaces)));
  }
  c.shape = std::move(file.shape);
  if (!source.keep_mesh && !c.shape.regions.empty())
    if (const auto problem = find_problem(c.shape))
      throw Error(Fault::Geometry, fmt::format("{}: {}; mesh.mesher = \"gmsh\" keeps gmsh's mesh, in which regions may "
                                               "touch anything",
                                               source.path.string(), *problem));
  if (source.keep_mesh) {
    c.sizing.size = mean_size(file.mesh);
    c.mesh = std::make_shared<const Mesh>(std::move(file.mesh));
  }
  c.file_notes = file.notes;
  return file;
}

std::vector<Value> read_laws_of_file(const std::vector<Value>& tables, Case& c) {
  for (const Crack& crack : c.shape.cracks) c.scene.laws.push_back({.normal = normal_in_file(crack)});
  std::vector<Value> drawn;
  std::vector<std::string> known, named;
  for (const Crack& crack : c.shape.cracks) known.push_back(crack.name);
  for (const Value& crack : tables) {
    allow_only(crack);
    if (has_any_of(crack, {"path", "arc"})) {
      if (c.mesh)
        fail(
            crack.node->position,
            "[[crack]]: the mesh of domain.file is taken as it is; a crack is a physical curve crack:<name> there, and "
            "only its law is said here");
      drawn.push_back(crack);
      continue;
    }
    const Value name = need(crack, "name");
    const auto found = std::find(known.begin(), known.end(), text(name));
    if (found == known.end())
      fail(name.node->position,
           fmt::format("{}: there is no physical curve {} in domain.file; {}", name.name, quote("crack:" + text(name)),
                       known.empty() ? "it has no cracks" : suggest(text(name), known)));
    if (std::find(named.begin(), named.end(), text(name)) != named.end()) refuse_taken(name, text(name));
    named.push_back(text(name));
    CrackLaw& law = c.scene.laws[static_cast<std::size_t>(found - known.begin())];
    law = read_law(crack);
    law.normal = normal_in_file(c.shape.cracks[static_cast<std::size_t>(found - known.begin())]);
  }
  return drawn;
}

}  // namespace kerf
