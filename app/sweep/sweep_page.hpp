#pragma once
// The page of a sweep: small multiples of its numbers, the pictures of its runs, its table.

#include "io/result_table.hpp"

#include <optional>

namespace kerf {

struct SweepTable {
  struct Row {
    std::string name;
    std::vector<std::string> values;      // of the keys
    std::string status, reason = {};      // "ok", "failed", "missing", or what the result says
    std::vector<std::string> cells = {};  // by columns; as many as were known when it was added
  };
  std::string title;
  std::vector<std::string> keys, columns = {};
  std::vector<bool> is_number = {};  // per column
  std::vector<Row> rows = {};
};

/// What a result says goes to the cells of its row; columns that no row had before are added.
void add_result(SweepTable& table, SweepTable::Row& row, const std::vector<Leaf>& leaves);

/// Needs no network; pictures and reports of the runs are those in their folders below `folder`.
void write_sweep_page(const std::filesystem::path& path, const SweepTable& table, const std::filesystem::path& folder);

}  // namespace kerf
