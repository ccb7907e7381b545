// The table of a sweep: cells of several runs below the columns that any of them has.

#include "app/sweep/sweep_page.hpp"
#include "io/result_table.hpp"

#include <gtest/gtest.h>

namespace kerf::sweep_table_test {
namespace {

std::vector<Leaf> leaves(int from, int to) {
  std::vector<Leaf> out{{"status", "ok"}};
  for (int k = from; k < to; ++k) out.push_back({"a" + std::to_string(k), std::to_string(10 * k), true});
  return out;
}

TEST(SweepTable, CellsStandBelowTheirColumns) {
  SweepTable table;
  SweepTable::Row first, second;
  add_result(table, first, leaves(0, 3));
  add_result(table, second, leaves(2, 4));
  EXPECT_EQ(table.columns, (std::vector<std::string>{"a0", "a1", "a2", "a3"}));
  EXPECT_EQ(first.cells, (std::vector<std::string>{"0", "10", "20"}));
  EXPECT_EQ(second.cells, (std::vector<std::string>{"", "", "20", "30"}));
  EXPECT_EQ(second.status, "ok");
}

// A stranger's result of a few megabytes: each name was looked for among all columns.
TEST(SweepTable, ManyColumnsAreNoMatter) {
  constexpr int many = 200000;
  SweepTable table;
  SweepTable::Row row;
  add_result(table, row, leaves(0, many));
  ASSERT_EQ(table.columns.size(), std::size_t{many});
  EXPECT_EQ(table.columns.back(), "a" + std::to_string(many - 1));
  EXPECT_EQ(row.cells.back(), std::to_string(10 * (many - 1)));
}

}  // namespace
}  // namespace kerf::sweep_table_test
