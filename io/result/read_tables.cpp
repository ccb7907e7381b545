// Tables that kerf wrote, read back: crack_NAME.csv and history.csv. Cells may be quoted, with line ends inside; every
// row must have the cells of the head, an empty cell is NaN. Columns are found by name, but those of bounds and
// variables of an optimization by their place, since users name these and may choose the name of a column. A table that
// is not there leaves the result without rows; one of another form is "damaged".

#include "io/result/read_tables.hpp"

#include "io/files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>

namespace kerf {

namespace {

using Row = std::vector<std::string>;

/// Cells with quotes where a text needs them; a line end inside quotes belongs to the text.
std::vector<Row> split_csv(const std::string& text) {
  std::vector<Row> rows;
  Row row(1);
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted && c == '"' && i + 1 < text.size() && text[i + 1] == '"') {
      row.back() += '"';
      ++i;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (!quoted && c == ',') {
      row.emplace_back();
    } else if (!quoted && c == '\n') {
      rows.push_back(std::move(row));
      row.assign(1, std::string());
    } else {
      row.back() += c;
    }
  }
  return rows;
}

/// A table with names of columns.
class Table {
 public:
  Table(const std::filesystem::path& path, std::initializer_list<std::string_view> needed) : path_(path) {
    rows_ = split_csv(read_file(path));
    if (rows_.empty()) refuse();
    const Row head = rows_.front();
    rows_.erase(rows_.begin());
    column_count_ = head.size();
    for (std::size_t k = 0; k < head.size(); ++k) column_.emplace(head[k], k);
    for (const Row& row : rows_)
      if (row.size() != head.size()) refuse();
    for (const std::string_view name : needed)
      if (!has(name)) refuse();
  }
  std::size_t size() const {
    return rows_.size();
  }
  bool has(std::string_view name) const {
    return column_.count(std::string(name)) > 0;
  }
  const std::string& text(std::size_t row, std::string_view name) const {
    return rows_[row][column_.at(std::string(name))];
  }
  std::size_t columns() const {
    return column_count_;
  }
  double number(std::size_t row, std::string_view name) const {
    return number(row, column_.at(std::string(name)));
  }
  double number(std::size_t row, std::size_t column) const {
    const std::string& cell = rows_[row][column];
    double out = nan;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), out);
    if (!cell.empty() && (error != std::errc() || end != cell.data() + cell.size())) refuse();
    return cell.empty() ? nan : out;
  }
  int whole(std::size_t row, std::string_view name) const {
    const double value = number(row, name);
    return value > -1e9 && value < 1e9 ? static_cast<int>(value) : 0;
  }
  [[noreturn]] void refuse() const {
    throw Error(Fault::Files, fmt::format("{} is damaged, or no table that kerf has written", path_.string()));
  }

 private:
  std::filesystem::path path_;
  std::vector<Row> rows_;
  std::map<std::string, std::size_t> column_;  // the first of a name
  std::size_t column_count_ = 0;
};

}  // namespace

void read_crack_rows(const std::filesystem::path& path, CrackResult& crack) {
  if (!std::filesystem::exists(path)) return;
  const Table t(path, {"s", "x", "y", "jump_n", "jump_t", "sigma_n", "sigma_t", "status"});
  const bool fluid = t.has("fluid_pressure");
  crack.has_gap = t.has("gap");
  for (std::size_t i = 0; i < t.size(); ++i)
    crack.rows.push_back({t.number(i, "s"),
                          {t.number(i, "x"), t.number(i, "y")},
                          t.number(i, "jump_n"),
                          t.number(i, "jump_t"),
                          t.number(i, "sigma_n"),
                          t.number(i, "sigma_t"),
                          t.text(i, "status") == "closed",
                          fluid ? t.number(i, "fluid_pressure") : 0,
                          crack.has_gap ? t.number(i, "gap") : 0});
}

std::vector<Iteration> read_history(const std::filesystem::path& path, const OptimizeNames& names) {
  std::vector<Iteration> out;
  if (!std::filesystem::exists(path)) return out;
  const Table t(path, {"iteration", "objective", "merit", "volume_fraction", "violation", "step", "optimality", "holes",
                       "triangles", "state_solves", "accepted", "note"});
  constexpr std::size_t first_of_users = 11;
  if (t.columns() != first_of_users + names.bounds.size() + names.variables.size() + 1) t.refuse();
  for (std::size_t i = 0; i < t.size(); ++i) {
    Iteration row;
    row.number = t.whole(i, "iteration");
    row.objective = t.number(i, "objective");
    row.merit = t.number(i, "merit");
    row.volume_fraction = t.number(i, "volume_fraction");
    row.violation = t.number(i, "violation");
    row.step = t.number(i, "step");
    row.optimality = t.number(i, "optimality");
    row.holes = t.whole(i, "holes");
    row.triangles = t.whole(i, "triangles");
    row.state_solves = t.whole(i, "state_solves");
    row.accepted = t.whole(i, "accepted") != 0;
    row.note = t.text(i, "note");
    // By their place: names of users may be those of other columns.
    std::size_t column = first_of_users;
    for (std::size_t k = 0; k < names.bounds.size(); ++k) row.bounds.push_back(t.number(i, column++));
    row.variables = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(names.variables.size()), nan);
    for (double& value : row.variables) value = t.number(i, column++);
    out.push_back(std::move(row));
  }
  return out;
}

}  // namespace kerf
