#pragma once
// The page of a sweep: small multiples of its numbers, the pictures of its runs, its table.

#include "app/sweep.hpp"
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
  std::vector<Convergence> convergence = {};  // of a study
};

/// What a result says goes to the cells of its row; columns that no row had before are added.
void add_result(SweepTable& table, SweepTable::Row& row, const std::vector<Leaf>& leaves);

/// The number that a cell is, if it is a finite one.
std::optional<double> number_in(const std::string& cell);

/// Quantities of result.json that engineers read first, not residuals, sizes and times.
bool is_usual(std::string_view name);

/// A page without any script, in the style of all such pages; `body` is HTML, and so is what its head has more.
std::string plain_page(const std::string& title, const std::string& body, const std::string& head = {});

/// Keeps those columns whose name is one of `wanted`, or ends with it after a dot, in their order; all for {"all"};
/// those that are usually looked at for none. Throws Error(Usage) for a word that is no column's, where there is one.
void choose_columns(SweepTable& table, const std::vector<std::string>& wanted);

/// Needs no network; pictures and reports of the runs are those in their folders below `folder`.
void write_sweep_page(const std::filesystem::path& path, const SweepTable& table, const std::filesystem::path& folder);

}  // namespace kerf
