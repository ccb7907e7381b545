// The order of tables means nothing: shuffled, they give the same body in the same order, and its mesh to the bit.
#include "tests/io/case/case_files.hpp"

#include "kerf/mesher.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <random>

namespace kerf::table_order_test {
namespace {

/// A square with holes, cracks (some cross), regions, loads and probes at random places of a lattice: its tables.
std::vector<std::string> random_scene(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<std::string> tables{
      "[domain]\noutline = [[0, 0], [4, 0], [4, 4], [0, 4]]\nsides = [\"bottom\", \"right\", \"top\", \"left\"]\n",
      "[material]\nyoung = 1\npoisson = 0.3\n",
      "[mesh]\nsize = 0.4\ncrack_tip_size = 0.05\n",
      "[[boundary]]\non = \"bottom\"\ndisplacement = [0, 0]\n",
      "[[boundary]]\non = \"top\"\ntraction = [0.5, 1]\n",
      "[[boundary]]\non = \"right\"\npressure = \"y\"\n",
      "[[probe]]\nname = \"p\"\npoints = [[0.05, 0.05]]\n",
      "[[probe]]\nname = \"q\"\npoints = [[3.95, 3.95]]\n"};
  for (int i = 0; i < 16; ++i) {
    const double x = i % 4 + 0.4 + 0.2 * unit(random), y = i / 4 + 0.4 + 0.2 * unit(random);
    const std::string name = fmt::format("name = \"n{}\"\n", int(1000 * unit(random)) * 16 + i);
    const double r = 0.1 + 0.15 * unit(random);
    switch (random() % 6) {
      case 0:
        tables.push_back(fmt::format("[[hole]]\n{}circle = {{ center = [{}, {}], radius = {} }}\n", name, x, y, r));
        break;
      case 1:
        tables.push_back(
            fmt::format("[[hole]]\n{}polygon = [[{}, {}], [{}, {}], [{}, {}]]\n", name, x, y - r, x + r, y, x, y + r));
        break;
      case 2:
        tables.push_back(
            fmt::format("[[region]]\n{}circle = {{ center = [{}, {}], radius = {} }}\nyoung = {}\npoisson = 0.2\n",
                        name, x, y, r, 1 + i));
        break;
      case 3:
        tables.push_back(fmt::format("[[crack]]\n{}path = [[{}, {}], [{}, {}]]\ncontact = \"{}\"\n", name, x - r, y, x,
                                     y + r, i % 2 == 0 ? "open" : "unilateral"));
        break;
      case 4:  // two from one point
        for (const char* which : {"a", "b"})
          tables.push_back(fmt::format("[[crack]]\nname = \"{}{}\"\npath = [[{}, {}], [{}, {}]]\n", which, i, x, y,
                                       x + r, *which == 'a' ? y : y + r));
        break;
      default:
        break;
    }
  }
  return tables;
}

std::string text_of(const std::vector<std::string>& tables) {
  return fmt::format("{}", fmt::join(tables, ""));
}

TEST(TableOrder, MeansNothing) {
  for (unsigned seed = 0; seed < 8; ++seed) {
    std::vector<std::string> tables = random_scene(seed);
    const Case one = read(text_of(tables));
    const Mesh mesh = triangulate(one.shape, one.sizing);
    std::mt19937 random(seed + 1000);
    for (int times = 0; times < 2; ++times) {
      std::ranges::shuffle(tables, random);
      const Case other = read(text_of(tables));
      ASSERT_EQ(one.shape.holes.size(), other.shape.holes.size());
      for (std::size_t h = 0; h < one.shape.holes.size(); ++h)
        EXPECT_EQ(one.shape.holes[h].name, other.shape.holes[h].name);
      ASSERT_EQ(one.shape.cracks.size(), other.shape.cracks.size());
      for (std::size_t c = 0; c < one.shape.cracks.size(); ++c) {
        EXPECT_EQ(one.shape.cracks[c].name, other.shape.cracks[c].name);
        EXPECT_EQ(one.scene.laws[c].kind, other.scene.laws[c].kind);
      }
      ASSERT_EQ(one.shape.regions.size(), other.shape.regions.size());
      for (std::size_t r = 0; r < one.shape.regions.size(); ++r) {
        EXPECT_EQ(one.shape.regions[r].name, other.shape.regions[r].name);
        EXPECT_EQ(one.regions[r].young, other.regions[r].young);
      }
      const Mesh again = triangulate(other.shape, other.sizing);
      EXPECT_EQ(mesh.points, again.points) << "seed " << seed;
      EXPECT_EQ(mesh.triangles, again.triangles);
      EXPECT_EQ(mesh.crack, again.crack);
      EXPECT_EQ(mesh.region, again.region);
    }
  }
}

const std::string tiles = R"([domain]
outline = [[0, 0], [3, 0], [3, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 1
poisson = 0.3
)";
const std::string
    left = "[[region]]\nname = \"l\"\npolygon = [[0, 0], [1, 0], [1, 1], [0, 1]]\nyoung = 2\npoisson = 0.2\n",
    right = "[[region]]\nname = \"r\"\npolygon = [[2, 0], [3, 0], [3, 1], [2, 1]]\nyoung = 3\npoisson = 0.2\n",
    west = "[[interface]]\nname = \"w\"\nbetween = [\"l\", \"body\"]\ngap = 0.1\n",
    east = "[[interface]]\nname = \"e\"\nbetween = [\"body\", \"r\"]\nfriction = 0.5\n";

TEST(TableOrder, MeansNothingForInterfaces) {
  const Case one = read(tiles + left + right + west + east), other = read(east + west + right + tiles + left);
  ASSERT_EQ(one.shape.cracks.size(), 2u);
  ASSERT_EQ(other.shape.cracks.size(), 2u);
  for (std::size_t c = 0; c < 2; ++c) {
    EXPECT_EQ(one.shape.cracks[c].name, other.shape.cracks[c].name);
    EXPECT_EQ(one.shape.cracks[c].points, other.shape.cracks[c].points);
    EXPECT_EQ(one.scene.laws[c].friction, other.scene.laws[c].friction);
    EXPECT_EQ(bool(one.scene.laws[c].gap), bool(other.scene.laws[c].gap));
    EXPECT_EQ(bool(one.scene.laws[c].gap), one.shape.cracks[c].name == "w");
  }
  EXPECT_EQ(triangulate(one.shape, one.sizing).points, triangulate(other.shape, other.sizing).points);
}

}  // namespace
}  // namespace kerf::table_order_test
