// The line of progress on a terminal and durations in words, against their texts: no line is wider than its terminal.

#include "app/progress.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace kerf::progress_test {
namespace {

std::size_t width(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

TEST(StatusLine, FitsEveryTerminal) {
  const std::string phase =
      "optimize 12: J 73.2817, volume 0.4, step 0.013, 5 holes, 12345 triangles, \u00e4\u00f6\u00fc at most 3 min 20 s "
      "left";
  for (std::size_t columns = 0; columns < 200; ++columns)
    for (const double expected : {0.0, 100.0}) {
      const std::string line = status_line(phase, 12.3, expected, columns);
      EXPECT_LT(width(line), std::max<std::size_t>(columns, 1)) << columns;
      if (columns >= 40) {
        EXPECT_NE(line.find("12 s"), std::string::npos) << columns;
        EXPECT_NE(line.find("\u2026") == std::string::npos, line.find(phase) == std::string::npos) << line;
      }
    }
  EXPECT_EQ(status_line("mesh", 0.2, 0, 80), "kerf: mesh (0 s)");
  EXPECT_EQ(status_line("map", 70, 3700, 80), "kerf: map (1 min 10 s, about 1 h 00 min left)");
}

TEST(StatusLine, CutsBetweenCharacters) {
  const std::string line =
      status_line("\u00e4\u00f6\u00fc\u00e4\u00f6\u00fc\u00e4\u00f6\u00fc\u00e4\u00f6\u00fc", 1, 0, 18);
  EXPECT_EQ(line, "kerf: \u00e4\u00f6\u00fc\u00e4\u2026 (1 s)");
}

TEST(Duration, IsRoundedUp) {
  EXPECT_EQ(duration(0), "0 s");
  EXPECT_EQ(duration(11.2), "12 s");
  EXPECT_EQ(duration(200), "3 min 20 s");
  EXPECT_EQ(duration(3900), "1 h 05 min");
}

}  // namespace
}  // namespace kerf::progress_test
