#pragma once
// Meshes of the tests: those committed, and small ones made up as text.

#include "kerf/mesh_file.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

namespace kerf::meshes {

inline std::filesystem::path file(const std::string& name) {
  return std::filesystem::path(KERF_TEST_DATA) / "meshes" / (name + ".msh");
}

inline std::string text(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline const std::vector<std::string> committed = {"gmsh22",     "gmsh22_binary", "gmsh41", "gmsh41_binary",
                                                   "gmsh_crack", "freefem",       "meshio"};

/// A mesh of format 2.2: a square [0, 2]^2 of eight triangles; node 3 j + i + 1 at (i, j), element 1 to 8 the rim
/// (physical curves 1 to 4, two edges each), 11 to 18 the triangles. Tests change its parts.
struct Square {
  std::string names = "4\n1 1 \"bottom\"\n1 2 \"right\"\n1 3 \"top\"\n1 4 \"left\"\n";
  std::vector<std::string> nodes, elements;
  Square() {
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) nodes.push_back(fmt::format("{} {} {} 0", 3 * j + i + 1, i, j));
    const int rim[] = {1, 2, 3, 6, 9, 8, 7, 4, 1};
    for (int k = 0; k < 8; ++k)
      elements.push_back(fmt::format("{} 1 2 {} {} {} {}", k + 1, k / 2 + 1, k / 2 + 1, rim[k], rim[k + 1]));
    for (int j = 0, tag = 11; j < 2; ++j)
      for (int i = 0; i < 2; ++i) {
        const int a = 3 * j + i + 1, b = a + 1, c = a + 4, d = a + 3;
        elements.push_back(fmt::format("{} 2 2 0 1 {} {} {}", tag++, a, b, c));
        elements.push_back(fmt::format("{} 2 2 0 1 {} {} {}", tag++, a, c, d));
      }
  }
  std::string text() const {
    return fmt::format(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{}$EndPhysicalNames\n$Nodes\n{}\n{}\n$EndNodes\n"
        "$Elements\n{}\n{}\n$EndElements\n",
        names, nodes.size(), fmt::join(nodes, "\n"), elements.size(), fmt::join(elements, "\n"));
  }
};

/// What reading says, and that it is about geometry.
inline std::string complaint(const std::string& bytes, const MeshFileRequest& request = {},
                             Fault fault = Fault::Geometry) {
  try {
    parse_mesh("a.msh", bytes, request);
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, fault) << e.what();
    return e.what();
  }
  return "no complaint";
}

}  // namespace kerf::meshes
