// Rows of a history in a checkpoint: 13 numbers, then bounds and variables per row, notes by line.

#include "optimize/loop/history_text.hpp"

#include "optimize/checkpoint_reader.hpp"

#include <algorithm>

namespace kerf {

std::string join(const std::vector<std::string>& parts, const std::string& separator) {
  std::string all;
  for (const std::string& part : parts) {
    if (part.empty()) continue;
    if (!all.empty()) all += separator;
    all += part;
  }
  return all;
}

std::vector<std::string> split_lines(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    lines.push_back(text.substr(from, end - from));
    from = end + 1;
  }
  return lines;
}

// Counts stand before the numbers that they count; a note per row, in the same order.
void write_rows(Checkpoint& c, const std::vector<Iteration>& rows) {
  std::vector<double> x;
  std::string notes;
  for (const Iteration& r : rows) {
    for (const double v : {static_cast<double>(r.number), r.objective, r.merit, r.volume_fraction, r.violation, r.step,
                           r.optimality, static_cast<double>(r.holes), static_cast<double>(r.triangles),
                           static_cast<double>(r.state_solves), static_cast<double>(r.accepted),
                           static_cast<double>(r.bounds.size()), static_cast<double>(r.variables.size())})
      x.push_back(v);
    x.insert(x.end(), r.bounds.begin(), r.bounds.end());
    x.insert(x.end(), r.variables.begin(), r.variables.end());
    append_line(notes, r.note);
  }
  c.numbers["rows"] = Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
  c.texts["notes"] = notes;
}

// Values that are no counts may be NaN: residuals that nobody asked for are.
std::vector<Iteration> read_rows(const Checkpoint& c) {
  NumberReader in(numbers_of(c, "rows"));
  LineReader notes(text_of(c, "notes"));
  std::vector<Iteration> rows;
  while (!in.empty()) {
    Iteration r;
    r.number = in.count();
    for (double* x : {&r.objective, &r.merit, &r.volume_fraction, &r.violation, &r.step, &r.optimality}) *x = in.any();
    r.holes = in.count();
    r.triangles = in.count();
    r.state_solves = in.count();
    r.accepted = in.flag();
    const int bounds = in.count(), variables = in.count();
    const Eigen::VectorXd values = in.take(bounds);
    r.bounds.assign(values.begin(), values.end());
    r.variables = in.take(variables);
    r.note = notes.line();
    rows.push_back(std::move(r));
  }
  notes.end();
  return rows;
}

}  // namespace kerf
