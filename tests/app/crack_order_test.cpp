// Results list cracks as the case does, though the mesh is made from left to right: numbers do not depend on the order
// of tables, their place in the list does.

#include "tests/support/folder.hpp"
#include "tests/support/running.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>

namespace kerf::crack_order_test {
namespace {

const std::string plate = R"([domain]
outline = [[0, 0], [3, 0], [3, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 100
poisson = 0.3
[[boundary]]
on = "bottom"
displacement = [0, 0]
[[boundary]]
on = "top"
traction = [0, 1]
[mesh]
size = 0.3
[output]
vtk = false
png = false
html = false
)";
const std::string left = "[[crack]]\nname = \"west\"\npath = [[0.5, 0.5], [0.9, 0.5]]\ncontact = \"open\"\n",
                  right = "[[crack]]\nname = \"east\"\npath = [[2, 0.5], [2.5, 0.6]]\ncontact = \"open\"\n";

class CrackOrder : public test::InFolder {
 protected:
  nlohmann::json cracks_of(const std::string& text) const {
    std::ofstream(folder / "a.toml") << text;
    test::Running program(folder, {KERF_PROGRAM, "solve", "a.toml", "-o", "out", "--force", "--quiet"});
    EXPECT_EQ(program.code(), 0);
    return nlohmann::json::parse(std::ifstream(folder / "out/result.json"))["cracks"];
  }
};

TEST_F(CrackOrder, IsThatOfTheCase) {
  const nlohmann::json one = cracks_of(plate + left + right), other = cracks_of(plate + right + left);
  ASSERT_EQ(one.size(), 2u);
  ASSERT_EQ(other.size(), 2u);
  EXPECT_EQ(one[0]["name"], "west");
  EXPECT_EQ(other[0]["name"], "east");
  EXPECT_EQ(one[0], other[1]) << "to the bit";
  EXPECT_EQ(one[1], other[0]);
}

}  // namespace
}  // namespace kerf::crack_order_test
