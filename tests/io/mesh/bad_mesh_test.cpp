// What is no mesh of a plane body is refused with one sentence that names the element or node and the place.

#include "tests/io/mesh/meshes.hpp"

#include <cstring>

namespace kerf::bad_mesh_test {
namespace {

using namespace meshes;

TEST(BadMesh, TheSquareIsGood) {
  EXPECT_EQ(complaint(Square().text()), "no complaint");
}

TEST(BadMesh, CoordinatesOutOfThePlane) {
  Square s;
  s.nodes[4] = "5 1 1 0.25";
  EXPECT_EQ(complaint(s.text()), "a.msh: node 5 at (1, 1, 0.25) lies out of the plane z = 0; kerf takes plane meshes");
}

TEST(BadMesh, Quadrilaterals) {
  Square s;
  s.elements[8] = "11 3 2 0 1 1 2 5 4";
  EXPECT_EQ(complaint(s.text()),
            "a.msh:33: element 11 at (0, 0) is a quadrilateral; kerf takes triangles (gmsh: leave "
            "out Recombine)");
}

TEST(BadMesh, CellsOfThirdOrder) {
  Square s;
  s.elements[9] = "12 21 2 0 1 1 5 4 2 3 6 7 8 9 3";
  EXPECT_EQ(complaint(s.text()),
            "a.msh:34: element 12 has the type 21 of gmsh, of higher order or unknown; kerf takes lines and triangles "
            "of first and second order");
}

// The node in the middle of the edge between elements 11 and 12 is another one for each.
TEST(BadMesh, MiddlesOfEdgesThatDiffer) {
  Square s;
  s.nodes.insert(s.nodes.end(),
                 {"21 0.5 0 0", "22 1 0.5 0", "23 0.5 0.5 0", "24 0.5 0.6 0", "25 0.5 1 0", "26 0 0.5 0"});
  s.elements[8] = "11 9 2 0 1 1 2 5 21 22 23";
  s.elements[9] = "12 9 2 0 1 1 5 4 24 25 26";
  EXPECT_EQ(complaint(s.text()),
            "a.msh: element 12 has its node in the middle of the edge at (0.5, 0.6) elsewhere than its neighbor there, "
            "at (0.5, 0.5): faces must lie on each other");
}

// Beyond a third of a turn an edge is no shape of a side.
TEST(BadMesh, MiddlesOfEdgesFarOff) {
  Square s;
  s.nodes.insert(s.nodes.end(), {"21 0.5 -0.4 0", "22 1 0.5 0", "23 0.5 0.5 0"});
  s.elements[8] = "11 9 2 0 1 1 2 5 21 22 23";
  EXPECT_EQ(
      complaint(s.text()),
      "a.msh: the edge at (0.5, 0) has its node in the middle at (0.5, -0.4), off its chord by 0.4 of its length; an "
      "edge turns by less than 120 degrees, off by 0.29, and its middle lies between its ends: a finer mesh is "
      "needed");
}

TEST(BadMesh, NoGroups) {
  Square s;
  for (std::size_t k = 0; k < 8; ++k) s.elements[k].replace(2, 7, "1 2 0 0");
  EXPECT_EQ(complaint(s.text()),
            "a.msh: no physical curve lies on the rim: nothing can be supported or loaded; name its sides as physical "
            "curves, or with [[domain.side]]");
}

TEST(BadMesh, HangingNodes) {
  Square s;  // the triangle 11 loses its lower half: node 10 hangs on the edge from 1 to 5
  s.nodes.push_back("10 0.5 0.5 0");
  s.elements[8] = "11 2 2 0 1 1 2 10";
  s.elements.push_back("19 2 2 0 1 2 5 10");
  EXPECT_EQ(complaint(s.text()),
            "a.msh: node 10 at (0.5, 0.5) lies on the edge from node 1 at (0, 0) to node 5 at (1, 1) "
            "without being one of its ends: a hanging node");
}

TEST(BadMesh, InvertedTriangles) {
  Square s;
  s.elements[10] = "13 2 2 0 1 2 6 3";
  EXPECT_EQ(complaint(s.text()),
            "a.msh: element 13 at (1.66667, 0.333333) is turned over: its corners run the other way "
            "round than those of the other triangles of its surface");
  Square flat;
  flat.elements[8] = "11 2 2 0 1 1 2 3";
  EXPECT_EQ(complaint(flat.text()), "a.msh: element 11 at (1, 0) has no area");
}

TEST(BadMesh, DuplicateTriangles) {
  Square s;
  s.elements.push_back("19 2 2 0 1 5 1 2");
  EXPECT_EQ(complaint(s.text()), "a.msh: elements 11 and 19 at (0, 0) have the same corners");
}

TEST(BadMesh, OverlappingTriangles) {
  Square s;  // beside the edge from 1 to 5 lie 11 and this one, both on its right
  s.nodes.push_back("10 0.9 0.3 0");
  s.elements[9] = "12 2 2 0 1 1 10 5";
  EXPECT_EQ(complaint(s.text()), "a.msh: elements 11 and 12 at (0, 0) overlap: they lie on the same side of an edge");
  Square apart;  // of a second body that reaches into this one
  for (const char* node : {"10 1.5 1.2 0", "11 3 1.5 0", "12 3 1.7 0"}) apart.nodes.push_back(node);
  apart.elements.push_back("19 2 2 0 1 10 11 12");
  EXPECT_EQ(complaint(apart.text()), "a.msh: elements 17 and 19 at (1, 1) overlap");
}

TEST(BadMesh, OverlapAroundANode) {
  Square s;  // twice around the middle: a fan of 16 triangles, none of them beside another of its edges
  s.nodes.clear();
  s.elements.clear();
  s.nodes.push_back("1 0 0 0");
  for (int k = 0; k < 14; ++k) {
    const double angle = 2 * 2 * pi * k / 14, r = 1 + 0.5 * k / 14;
    s.nodes.push_back(fmt::format("{} {} {} 0", k + 2, r * std::cos(angle), r * std::sin(angle)));
    s.elements.push_back(fmt::format("{} 2 2 0 1 1 {} {}", k + 20, k + 2, (k + 1) % 14 + 2));
    s.elements.push_back(fmt::format("{} 1 2 1 1 {} {}", k + 50, k + 2, (k + 1) % 14 + 2));
  }
  EXPECT_NE(complaint(s.text()).find("overlap"), std::string::npos) << complaint(s.text());
}

TEST(BadMesh, EdgesWithThreeTriangles) {
  Square s;
  s.nodes.push_back("10 0.9 0.3 0");
  s.elements.push_back("19 2 2 0 1 1 10 5");
  EXPECT_EQ(complaint(s.text()),
            "a.msh: the edge from node 1 at (0, 0) to node 5 at (1, 1) has 3 triangles; it may have two");
}

TEST(BadMesh, SeveralBodies) {
  Square s;
  for (const char* node : {"10 5 0 0", "11 6 0 0", "12 6 1 0"}) s.nodes.push_back(node);
  s.elements.push_back("19 2 2 0 1 10 11 12");
  EXPECT_EQ(complaint(s.text()),
            "a.msh: there are several bodies: element 19 at (5.66667, 0.333333) is not connected with "
            "element 11 at (0.666667, 0.333333)");
  Square touching;  // in one point
  touching.nodes.push_back("10 3 2 0");
  touching.nodes.push_back("11 3 3 0");
  touching.elements.push_back("19 2 2 0 1 9 10 11");
  EXPECT_NE(complaint(touching.text()).find("several bodies"), std::string::npos);
  Square pinched;  // two quarters that meet at node 5, and a way around from one to the other
  for (const int gone : {15, 14, 9, 8, 7, 4, 3, 0}) pinched.elements.erase(pinched.elements.begin() + gone);
  pinched.nodes.push_back("10 4 4 0");
  pinched.nodes.push_back("11 0 5 0");
  for (const char* t : {"6 3 10", "7 8 11", "8 10 11", "8 6 10"})
    pinched.elements.push_back(fmt::format("{} 2 2 0 1 {}", 20 + pinched.elements.size(), t));
  EXPECT_EQ(complaint(pinched.text()), "a.msh: the body touches itself at node 5 at (1, 1); its rim must not");
}

TEST(BadMesh, TruncatedFiles) {
  // However many bytes are missing; the last newline alone may.
  for (const std::string& name : committed) {
    const std::string whole = text(file(name));
    for (std::size_t n = 0; n + 1 < whole.size(); n += 1 + whole.size() / 97)
      EXPECT_NE(complaint(whole.substr(0, n)), "no complaint") << name << " cut to " << n;
    EXPECT_NE(complaint(whole.substr(0, whole.size() - 3)), "no complaint");
  }
  EXPECT_EQ(complaint(Square().text().substr(0, 190)), "a.msh:21: the file ends inside $Nodes; it is cut off");
  EXPECT_EQ(
      complaint(text(file("gmsh41_binary")).substr(0, 13000)),
      "a.msh: $Elements, byte 12287: $Elements announces 616 elements, which the rest of the file cannot hold; it is "
      "cut off or damaged");
}

TEST(BadMesh, TheOtherByteOrder) {
  for (const char* name : {"gmsh41_binary", "gmsh22_binary"}) {
    std::string bytes = text(file(name));
    const std::size_t one = bytes.find('\n', bytes.find('\n') + 1) + 1;
    std::swap(bytes[one], bytes[one + 3]);
    EXPECT_EQ(complaint(bytes),
              fmt::format("a.msh: $MeshFormat, byte {}: the file was written on a machine with the other "
                          "byte order; save it as text (gmsh -bin 0)",
                          one + 4));
  }
}

TEST(BadMesh, TagsTwice) {
  Square s;
  s.nodes[6] = "5 0 2 0";
  EXPECT_EQ(complaint(s.text()), "a.msh:19: node 5 stands twice");
  Square cells;
  cells.elements[12] = "11 2 2 0 1 4 5 8";
  EXPECT_EQ(complaint(cells.text()), "a.msh:37: element 11 stands twice");
}

TEST(BadMesh, LabelsAndCracksThatCannotBe) {
  Square twice;
  twice.elements.push_back("20 1 2 3 3 1 2");
  EXPECT_EQ(complaint(twice.text()),
            "a.msh: the edge at (0.5, 0) belongs to the physical curves \"bottom\" and \"top\"; a "
            "side has one label");
  Square off;
  off.elements.push_back("20 1 2 3 3 1 9");
  EXPECT_EQ(complaint(off.text()), "a.msh: element 20 of physical curve \"top\", at (0, 0), is no edge of a triangle");
  const auto with_cracks = [](std::vector<std::string> edges) {
    Square s;
    s.names = "5\n1 1 \"bottom\"\n1 2 \"right\"\n1 3 \"top\"\n1 4 \"left\"\n1 5 \"crack:c\"\n";
    for (std::size_t k = 0; k < edges.size(); ++k) s.elements.push_back(fmt::format("{} 1 2 5 5 {}", 20 + k, edges[k]));
    return complaint(s.text());
  };
  EXPECT_EQ(
      with_cracks({"1 2"}),
      "a.msh: element 20 of physical curve \"crack:c\", at (0.5, 0), lies on the rim of the body; a crack lies inside");
  EXPECT_EQ(with_cracks({"4 5", "5 6", "5 8"}),
            "a.msh: crack \"c\" branches at (1, 1); each branch needs a name of its own");
  EXPECT_EQ(with_cracks({}), "a.msh: physical curve crack:c has no edge in the mesh");
  EXPECT_NE(with_cracks({"1 5", "2 6"}).find("is in several pieces"), std::string::npos);
  Square two;
  two.names = "5\n1 1 \"bottom\"\n1 2 \"right\"\n1 3 \"top\"\n1 5 \"crack:c\"\n1 6 \"crack:d\"\n";
  two.elements.push_back("20 1 2 5 5 4 5");
  two.elements.push_back("21 1 2 6 6 4 5");
  EXPECT_EQ(complaint(two.text()), "a.msh: the edge at (0.5, 1) belongs to the cracks \"c\" and \"d\"; to one at most");
  two.names.replace(two.names.find("crack:d"), 7, "crack:a/b");
  EXPECT_EQ(complaint(two.text()),
            "a.msh: physical curve \"crack:a/b\": after crack: a name of letters, digits, _ . or - is needed");
}

TEST(BadMesh, OtherFiles) {
  EXPECT_EQ(complaint(""), "a.msh:1: this is no mesh of gmsh: it does not begin with $MeshFormat");
  EXPECT_EQ(complaint("$MeshFormat\n4 0 8\n$EndMeshFormat\n"),
            "a.msh:2: format \"4\" is not read; save the mesh in format 4.1 or 2.2 (gmsh -format msh41)");
  EXPECT_EQ(
      complaint("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n10000000000\n1 0 0 0\n"),
      "a.msh:5: $Nodes announces 10000000000 nodes, which the rest of the file cannot hold; it is cut off or damaged");
  EXPECT_THROW(read_mesh("/nowhere/a.msh"), Error);
  Square s;
  s.nodes[3] = "4 nan 1 0";
  EXPECT_EQ(complaint(s.text()), "a.msh:16: a number is not finite");
  s.nodes[3] = "4 1,5 1 0";
  EXPECT_EQ(complaint(s.text()), "a.msh:16: \"1,5\" is no number, or too large");
}

}  // namespace
}  // namespace kerf::bad_mesh_test
