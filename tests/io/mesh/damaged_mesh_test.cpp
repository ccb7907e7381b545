// Files that begin as meshes of gmsh and go wrong: each is refused in the line that is wrong, in words that name it.

#include "tests/io/mesh/meshes.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace kerf::damaged_mesh_test {
namespace {

using namespace meshes;

/// A unit square of two triangles in format 4.1.
const std::string square_4 = R"($MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
1
1 1 "rim"
$EndPhysicalNames
$Entities
0 1 1 0
1 0 0 0 1 1 0 1 1 0
1 0 0 0 1 1 0 0 1 1
$EndEntities
$Nodes
1 4 1 4
2 1 0 4
1
2
3
4
0 0 0
1 0 0
1 1 0
0 1 0
$EndNodes
$Elements
2 6 1 6
1 1 1 4
1 1 2
2 2 3
3 3 4
4 4 1
2 1 2 2
5 1 2 3
6 1 3 4
$EndElements
)";

struct Damage {
  std::string from, to, says;
  int later = 0;  // lines between the change and where it is noticed
};

/// Each damage alone is refused with these words, in its line.
void expect_refused(const std::string& whole, const std::vector<Damage>& damages) {
  ASSERT_EQ(complaint(whole), "no complaint");
  for (const Damage& d : damages) {
    const std::size_t at = whole.find(d.from);
    ASSERT_NE(at, std::string::npos) << d.from;
    std::string bytes = whole;
    bytes.replace(at, d.from.size(), d.to);
    const auto end = bytes.begin() + static_cast<std::ptrdiff_t>(at + d.to.size());
    const auto line = 1 + std::count(bytes.begin(), end, '\n') + d.later;
    EXPECT_EQ(complaint(bytes), fmt::format("a.msh:{}: {}", line, d.says)) << d.to;
  }
}

TEST(DamagedMesh, SectionsOfBothFormats) {
  for (const std::string& whole : {Square().text(), square_4}) {
    const std::string version = whole == square_4 ? "4.1" : "2.2";
    expect_refused(whole,
                   {{version + " 0 8", version + " 2 8", "$MeshFormat: 2 is neither 0 (text) nor 1 (binary)"},
                    {version + " 0 8", version + " 0 4", "numbers of 4 bytes are not read, those of 8 are"},
                    {"$EndMeshFormat", "$End",
                     "\"$End\" stands where $MeshFormat ends; the counts at its beginning are wrong, or it is damaged"},
                    {"$Nodes", "Nodes", "\"Nodes\" stands where a section should begin"},
                    {"$Nodes", "$EndNodes", "\"$EndNodes\" stands where a section should begin"},
                    {"$Nodes", "$No\x1b[2Jdes", "\"$No [2Jdes\" stands where a section should begin"},
                    {"$Nodes", "$", "\"$\" stands where a section should begin"},
                    {"$Nodes", "$PartitionedEntities",
                     "the mesh is partitioned; save it as one (gmsh: Mesh.PartitionCreateTopology, UnpartitionMesh)"},
                    {"$Nodes", "$Comments\nmine\n", "$Comments has no end; the file is cut off", -2},
                    {"$EndElements\n", "$EndElements\n$Nodes", "$Nodes stands twice"},
                    {"$EndElements\n", "$EndElements\n$Elements", "$Elements stands twice"},
                    {"$Nodes", "$Elements", "$Elements stands before $Nodes"}});
    const std::size_t nodes = whole.find("$Nodes"), elements = whole.find("$Elements");
    EXPECT_EQ(complaint(whole.substr(0, nodes)),
              fmt::format("a.msh:{}: there is no section $Nodes; the file is cut off, or holds no mesh",
                          1 + std::count(whole.begin(), whole.begin() + std::ptrdiff_t(nodes), '\n')));
    EXPECT_EQ(complaint(whole.substr(0, elements)),
              fmt::format("a.msh:{}: there is no section $Elements; the file is cut off, or holds no mesh",
                          1 + std::count(whole.begin(), whole.begin() + std::ptrdiff_t(elements), '\n')));
  }
}

TEST(DamagedMesh, NamesOfGroups) {
  expect_refused(Square().text(),
                 {{"1 1 \"bottom\"", "4 1 \"bottom\"", "physical group 1 of dimension 4 cannot be"},
                  {"1 1 \"bottom\"", "-1 1 \"bottom\"", "physical group 1 of dimension -1 cannot be"},
                  {"1 1 \"bottom\"", "1 0 \"bottom\"", "physical group 0 of dimension 1 cannot be"},
                  {"1 1 \"bottom\"", "1 2147483648 \"bottom\"", "physical group 2147483648 of dimension 1 cannot be"},
                  {"1 1 \"bottom\"", "1 1 \"\"", "physical group 1 has an empty name"},
                  {"1 1 \"bottom\"", "1 2 \"bottom\"", "physical group 2 of dimension 1 has two names", 1},
                  {"1 1 \"bottom\"", "1 1 bottom", "$PhysicalNames: a name in quotation marks is missing"},
                  {"1 1 \"bottom\"", "1 1 \"bottom", "$PhysicalNames: a name in quotation marks is missing"}});
}

TEST(DamagedMesh, ElementsOfFormat2) {
  Square many;
  many.elements[8] = "11 2 1000001 0 1 1 2 5";
  EXPECT_EQ(complaint(many.text()), "a.msh:33: element 11 has 1000001 tags, which cannot be");
  many.elements[8] = "11 2 -1 0 1 1 2 5";
  EXPECT_EQ(complaint(many.text()), "a.msh:33: element 11 has -1 tags, which cannot be");
  Square group;
  group.elements[8] = "11 2 2 -2147483648 1 1 2 5";
  EXPECT_EQ(complaint(group.text()), "a.msh:33: element 11 has no physical group");
  Square unknown;
  unknown.elements[8] = "11 2 2 0 1 1 2 77";
  EXPECT_EQ(complaint(unknown.text()), "a.msh:33: element 11 has the node 77, which there is not");
  Square type;
  type.elements[8] = "11 93 2 0 1 1 2 5";
  EXPECT_EQ(complaint(type.text()),
            "a.msh:33: element 11 has the type 93 of gmsh, of higher order or unknown; kerf takes lines and triangles "
            "of first and second order");
  type.elements[8] = "11 4 2 0 1 77 2 5 4";
  EXPECT_EQ(complaint(type.text()), "a.msh:33: element 11 is a tetrahedron; kerf takes plane meshes (gmsh -2)");
}

TEST(DamagedMesh, SectionsOfFormat4) {
  expect_refused(square_4, {{"1 0 0 0 1 1 0 1 1 0", "1 0 0 0 1 1 0 1 0 0",
                             "entity 1 has the physical group 0, which cannot be", 0},
                            {"0 1 1 0\n1 0", "0 2 0 0\n1 0", "entity 1 of dimension 1 stands twice", 1},
                            {"2 1 0 4\n", "4 1 0 4\n", "a block of nodes of dimension 4, parametric 0, cannot be", -1},
                            {"2 1 0 4\n", "2 1 2 4\n", "a block of nodes of dimension 2, parametric 2, cannot be", -1},
                            {"1 4 1 4\n", "1 3 1 4\n", "there are more nodes than announced"},
                            {"1 4 1 4\n", "1 5 1 4\n", "there are 4 nodes, 5 are announced", 8},
                            {"2 6 1 6\n", "2 7 1 6\n", "there are 6 elements, 7 are announced", 7},
                            {"1 1 2\n2 2 3", "1 1 2\n2 2 9", "element 2 has the node 9, which there is not"},
                            {"5 1 2 3", "5 1 2 2147483650", "element 5 has the node 2147483650, which there is not"}});
}

/// Coordinates of nodes on their curve or surface are passed over.
TEST(DamagedMesh, ParametersOfNodesAreNoDamage) {
  std::string bytes = square_4;
  const std::string from = "2 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  bytes.replace(bytes.find(from), from.size(), "2 1 1 4\n1\n2\n3\n4\n0 0 0 7 7\n1 0 0 7 7\n1 1 0 7 7\n0 1 0 7 7\n");
  EXPECT_EQ(complaint(bytes), "no complaint");
}

/// Tags far apart are as good as others, and twice is twice.
TEST(DamagedMesh, SparseTags) {
  Square s;
  s.nodes[4] = "2000000000 1 1 0";
  for (std::string& e : s.elements)
    for (std::size_t at; (at = e.find(" 5", e.size() < 12 ? 0 : 8)) != std::string::npos;)
      e.replace(at, 2, " 2000000000");
  EXPECT_EQ(complaint(s.text()), "no complaint");
  s.nodes[6] = "2000000000 0 2 0";
  EXPECT_EQ(complaint(s.text()), "a.msh:19: node 2000000000 stands twice");
}

/// Binary files say the byte instead of the line.
TEST(DamagedMesh, BinaryNumbers) {
  const auto put = [](std::string& bytes, std::size_t at, std::int32_t value) {
    std::memcpy(bytes.data() + at, &value, sizeof value);
  };
  std::string mark = text(file("gmsh22_binary"));
  const std::size_t one = mark.find('\n', mark.find('\n') + 1) + 1;
  put(mark, one, 2);
  EXPECT_EQ(complaint(mark), fmt::format("a.msh: $MeshFormat, byte {}: the mark of the byte order is missing; the "
                                         "file is damaged",
                                         one + 4));
  std::string block = text(file("gmsh22_binary"));
  const std::size_t head = block.find('\n', block.find("$Elements\n") + 10) + 1;  // type, how many, how many tags
  put(block, head + 4, -1);
  EXPECT_EQ(complaint(block), fmt::format("a.msh: $Elements, byte {}: a block of -1 elements cannot be", head + 12));
  std::string infinite = text(file("gmsh22_binary"));
  const std::size_t node = infinite.find('\n', infinite.find("$Nodes\n") + 7) + 1;  // tag, x, y, z
  const double wrong = infinity;
  std::memcpy(infinite.data() + node + 4, &wrong, sizeof wrong);
  EXPECT_EQ(complaint(infinite), fmt::format("a.msh: $Nodes, byte {}: a number is not finite", node + 12));
}

/// A square of n x n cells, node (n + 1) j + i + 1 at (i, j), with a crack of these edges.
std::string cracked_grid(int n, const std::vector<std::pair<int, int>>& crack) {
  Square s;
  s.names = "2\n1 1 \"rim\"\n1 5 \"crack:c\"\n";
  s.nodes.clear();
  s.elements.clear();
  int tag = 1;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) s.nodes.push_back(fmt::format("{} {} {} 0", (n + 1) * j + i + 1, i, j));
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = (n + 1) * j + i + 1, b = a + 1, c = b + n + 1, d = a + n + 1;
      s.elements.push_back(fmt::format("{} 2 2 0 1 {} {} {}", tag++, a, b, c));
      s.elements.push_back(fmt::format("{} 2 2 0 1 {} {} {}", tag++, a, c, d));
    }
  for (int i = 1; i <= n; ++i) s.elements.push_back(fmt::format("{} 1 2 1 1 {} {}", tag++, i, i + 1));
  for (const auto& [a, b] : crack) s.elements.push_back(fmt::format("{} 1 2 5 5 {} {}", tag++, a, b));
  return s.text();
}

TEST(DamagedMesh, ClosedCracks) {
  const std::vector<std::pair<int, int>> loop = {{8, 9}, {9, 15}, {15, 14}, {14, 8}};  // around the cell at (1, 1)
  EXPECT_EQ(complaint(cracked_grid(5, loop)),
            "a.msh: crack \"c\" is closed, through (1, 1); a closed cut is a hole, or in a body that is drawn an "
            "[[interface]]");
  auto with_line = loop;
  with_line.emplace_back(22, 28);
  EXPECT_EQ(complaint(cracked_grid(5, with_line)),
            "a.msh: crack \"c\" is in several pieces, one from (3, 3) to (3, 4), another closed; each needs a name of "
            "its own");
  EXPECT_EQ(complaint(cracked_grid(5, {{22, 28}})), "no complaint");
}

TEST(DamagedMesh, NoTriangles) {
  Square s;
  s.elements.resize(8);
  EXPECT_EQ(complaint(s.text()), "a.msh: there are no triangles; mesh the surfaces (gmsh -2), and save them");
}

TEST(DamagedMesh, SurfacesAndSidesWithTwoNames) {
  std::string bytes = square_4;
  const auto replace = [&](const std::string& from, const std::string& to) {
    bytes.replace(bytes.find(from), from.size(), to);
  };
  replace("1\n1 1 \"rim\"", "3\n1 1 \"rim\"\n2 1 \"soft\"\n2 2 \"stiff\"");
  replace("1 0 0 0 1 1 0 0 1 1", "1 0 0 0 1 1 0 2 1 2 1 1");
  EXPECT_EQ(complaint(bytes, {.materials = {"soft"}}), "no complaint");
  EXPECT_EQ(complaint(bytes, {.materials = {"soft", "stiff"}}),
            "a.msh: element 5 at (0, 0) lies in the regions \"soft\" and \"stiff\"");
  const MeshFileRequest one = {.sides = {{{1, -0.1}, "a", "first: "}}},
                        two = {.sides = {{{1, -0.1}, "a", "first: "}, {{0.5, -0.1}, "b", "second: "}}};
  EXPECT_EQ(complaint(Square().text(), one), "no complaint");
  EXPECT_EQ(complaint(Square().text(), two, Fault::Usage),
            "second: the side at (0.5, 0) gets the names \"a\" and \"b\"");
}

}  // namespace
}  // namespace kerf::damaged_mesh_test
