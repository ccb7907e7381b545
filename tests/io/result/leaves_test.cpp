// The numbers of a result as a flat table, against paths and values by hand; long lists and deep nesting are bounded.

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

std::string with_head(const std::string& more) {
  return R"({"version": "0.1", "case": "a", "status": "ok", )" + more + "}";
}

/// A list of tables is as long as a table may be wide: sixteen.
TEST(Leaves, LongListsAreLeftOut) {
  std::string sixteen = "{\"a\": 1}";
  for (int k = 1; k < 16; ++k) sixteen += ", {\"a\": 1}";
  EXPECT_EQ(leaves(with_head("\"list\": [" + sixteen + "]")).size(), 1 + 16u);
  EXPECT_EQ(leaves(with_head("\"list\": [" + sixteen + ", {\"a\": 1}]")).size(), 1u);
  EXPECT_EQ(leaves(with_head("\"list\": []")).size(), 1u);
}

void expect_refused(const std::string& text) {
  try {
    leaves(text);
    ADD_FAILURE() << text.substr(0, 100);
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, Fault::Files);
    EXPECT_NE(std::string(e.what()).find("result.json is damaged, or no result"), std::string::npos) << e.what();
  }
}

// An object looks at all its members for each more: 1 MB of a hundred thousand took 13 seconds.
TEST(Leaves, ObjectsAreOfBoundedLength) {
  const auto object = [](int members) {
    std::string text = "{\"0\": \"a, b, {\"";
    for (int k = 1; k < members; ++k) text += ", \"" + std::to_string(k) + "\": [1, 2, 3, 4]";
    return with_head("\"a\": " + text + "}");
  };
  EXPECT_EQ(leaves(object(2000)).size(), 2u);
  for (const int members : {2001, 100000, 1000000}) expect_refused(object(members));
  EXPECT_EQ(leaves(with_head("\"list\": [" + std::string(200000, ' ') + "1]")).size(), 2u);
}

// Lists and objects within each other: whoever walks through them recurses.
TEST(Leaves, DepthIsBounded) {
  const auto nested = [](std::string_view open, std::string_view inner, std::string_view close, int depth) {
    std::string text;
    for (int k = 0; k < depth; ++k) text += open;
    text += inner;
    for (int k = 0; k < depth; ++k) text += close;
    return with_head("\"a\": " + text);
  };
  for (const int depth : {63, 64, 65, 1000, 60000, 1000000})
    for (const auto& [open, close] :
         {std::pair("{\"a\":", "}"), {"[", "]"}, {"{\"a\":[", "]}"}, {"[{\"b]\\\"\":", "}]"}}) {
      const bool deep = (std::string_view(close).size() * std::size_t(depth)) + 1 > 64;
      const std::string text = nested(open, "1", close, depth);
      if (deep)
        expect_refused(text);
      else
        EXPECT_EQ(leaves(text).size(), 2u);
    }
  expect_refused("{\"a\":" + std::string(100000, '['));
  EXPECT_EQ(leaves(with_head("\"a\": \"" + std::string(1000, '[') + "\\\"{{{\"")).size(), 2u) << "of a text";
}

TEST(Leaves, WhatIsNoResultIsRefused) {
  for (const char* text : {"", "[1, 2]", "{\"state\": ", "3", "{}", R"({"version": "1", "case": "a", "stotus": "ok"})",
                           R"({"version": "1", "case": "a", "status": 0})"})
    expect_refused(text);
  EXPECT_THROW(leaves_of_result("/nowhere/result.json"), Error);
}

}  // namespace
}  // namespace kerf::leaves_test
