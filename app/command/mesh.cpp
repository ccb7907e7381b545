// `kerf mesh`: the mesh of a case as a file, with labels and cracks as groups or fields.

#include "app/command/mesh.hpp"

#include "app/body_mesh.hpp"
#include "app/run/solve.hpp"
#include "io/words.hpp"
#include "kerf/mesher.hpp"
#include "kerf/vtk.hpp"
#include "solver/divided.hpp"

#include <fmt/format.h>

namespace kerf {

namespace {

/// 1 at the vertices that an edge of the group has.
NamedField flags_of_edges(const std::string& name, const Mesh& mesh, const std::vector<Index>& of_edge, Index group) {
  NamedField field{name, false, Eigen::MatrixXd::Zero(1, static_cast<Eigen::Index>(mesh.points.size()))};
  for (std::size_t e = 0; e < mesh.edges.size(); ++e)
    if (of_edge[e] == group)
      for (const Index v : mesh.edges[e]) field.values(0, v) = 1;
  return field;
}

void write_groups(const std::filesystem::path& path, const Mesh& mesh, const Shape& shape) {
  std::vector<NamedField> fields;
  NamedField region{"region", true, Eigen::MatrixXd(1, static_cast<Eigen::Index>(mesh.triangles.size()))};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    region.values(0, static_cast<Eigen::Index>(t)) = region_of(mesh, static_cast<Index>(t));
  fields.push_back(std::move(region));
  for (std::size_t k = 0; k < shape.labels.size(); ++k)
    fields.push_back(flags_of_edges(shape.labels[k], mesh, mesh.label, static_cast<Index>(k)));
  for (std::size_t k = 0; k < shape.cracks.size(); ++k)
    fields.push_back(flags_of_edges("crack:" + shape.cracks[k].name, mesh, mesh.crack, static_cast<Index>(k)));
  write_vtu(path, mesh.points, mesh.triangles, fields, middle_points(mesh, mesh.triangles));
}

Mesh divided_mesh(const Case& c) {
  Mesh mesh = c.mesh ? *c.mesh : triangulate(c.shape, c.sizing);
  check_division(mesh, c.element, c.divisions);
  for (int k = 0; k < c.divisions; ++k) mesh = refine(mesh);
  return mesh;
}

}  // namespace

/// With chords where an edge that follows a curve folds a triangle, unless mesh.curved = true.
Mesh mesh_of_run(Case c) {
  return as_it_can(c, [&c] { return divided_mesh(c); });
}

void require_mesh_ending(const std::filesystem::path& path) {
  if (path.extension() != ".msh" && path.extension() != ".vtu")
    throw Error(Fault::Usage, fmt::format("{}: the mesh is written as .msh (gmsh) or .vtu (ParaView); give such a name "
                                          "with -o",
                                          path.empty() ? "no file" : quote(path.string())));
}

std::string write_mesh_of(const Case& c, const std::filesystem::path& path, const std::string& format) {
  require_mesh_ending(path);
  const Mesh mesh = mesh_of_run(c);
  if (path.extension() == ".msh")
    write_mesh(path, mesh, c.shape, format == "2.2" ? MshVersion::V2 : MshVersion::V4);
  else
    write_groups(path, mesh, c.shape);
  const Quality q = quality(mesh);
  return fmt::format("{} triangles, {} vertices, edges {:.4g} to {:.4g}, smallest angle {:.3g} degrees in {}\n",
                     mesh.triangles.size(), mesh.points.size(), q.h_min, q.h_max, q.min_angle_deg, path.string());
}

}  // namespace kerf
