#include "io/result_table.hpp"

#include "io/files.hpp"
#include "kerf/types.hpp"
#include "tests/support/folder.hpp"

namespace kerf::leaves_test {
namespace {

std::vector<Leaf> leaves(const std::string& text) {
  const test::Folder folder;
  write_file(folder.path / "result.json", text);
  return leaves_of_result(folder.path / "result.json");
}

TEST(Leaves, NumbersAndWordsWithTheirPaths) {
  const std::vector<Leaf> all = leaves(R"({"schema": 1, "version": "0.1", "case": "a", "title": "b", "status": "ok",
    "units": {"length": "mm"}, "mesh": {"triangles": 12, "adapt": {"rounds": [1, 2]}},
    "state": {"energy": -0.65, "energy_bounds": [-0.7, null], "notes": ["x"], "stopped": false},
    "cracks": [{"name": "c", "tips": [{"at": [1, 0], "K_I": 1e-3}]}, {"name": "d", "tips": []}],
    "map": {"rows": [1, 2], "values": [1, 2, 3, 4]}, "optimize": {"names": {"a": 1}, "covariance": [[1]]},
    "time_s": {"mesh": 0.1, "total": 0.5}, "reason": "it ended"})");
  const std::vector<std::array<std::string, 2>> expected = {{"status", "ok"},
                                                            {"mesh.triangles", "12"},
                                                            {"state.energy", "-0.65"},
                                                            {"state.energy_bounds[0]", "-0.7"},
                                                            {"state.energy_bounds[1]", ""},
                                                            {"state.stopped", "false"},
                                                            {"cracks.c.tips[0].at[0]", "1"},
                                                            {"cracks.c.tips[0].at[1]", "0"},
                                                            {"cracks.c.tips[0].K_I", "0.001"},
                                                            {"time_s.total", "0.5"},
                                                            {"reason", "it ended"}};
  ASSERT_EQ(all.size(), expected.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].name, expected[i][0]);
    EXPECT_EQ(all[i].value, expected[i][1]);
    EXPECT_EQ(all[i].is_number,
              !all[i].value.empty() && std::string("-0123456789").find(all[i].value[0]) != std::string::npos);
  }
}

/// A list of tables is as long as a table may be wide: sixteen.
TEST(Leaves, LongListsAreLeftOut) {
  std::string sixteen = "{\"a\": 1}";
  for (int k = 1; k < 16; ++k) sixteen += ", {\"a\": 1}";
  EXPECT_EQ(leaves("{\"list\": [" + sixteen + "]}").size(), 16u);
  EXPECT_EQ(leaves("{\"list\": [" + sixteen + ", {\"a\": 1}]}").size(), 0u);
  EXPECT_EQ(leaves("{\"list\": []}").size(), 0u);
}

TEST(Leaves, WhatIsNoResultIsRefused) {
  for (const char* text : {"", "[1, 2]", "{\"state\": ", "3"}) {
    try {
      leaves(text);
      FAIL() << text;
    } catch (const Error& e) {
      EXPECT_EQ(e.fault, Fault::Files);
      EXPECT_NE(std::string(e.what()).find("result.json is no result of kerf"), std::string::npos) << e.what();
    }
  }
  EXPECT_THROW(leaves_of_result("/nowhere/result.json"), Error);
}

}  // namespace
}  // namespace kerf::leaves_test
