#include "optimize/loop/history_text.hpp"

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
    notes += r.note + '\n';
  }
  c.numbers["rows"] = Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
  c.texts["notes"] = notes;
}

std::vector<Iteration> read_rows(const Checkpoint& c) {
  const Eigen::VectorXd& x = c.numbers.at("rows");
  const std::string& notes = c.texts.at("notes");
  std::vector<Iteration> rows;
  std::size_t from = 0;
  for (Eigen::Index i = 0; i + 13 <= x.size();) {
    Iteration r{.number = static_cast<int>(x[i]),
                .objective = x[i + 1],
                .merit = x[i + 2],
                .volume_fraction = x[i + 3],
                .violation = x[i + 4],
                .step = x[i + 5],
                .optimality = x[i + 6],
                .holes = static_cast<int>(x[i + 7]),
                .triangles = static_cast<Index>(x[i + 8]),
                .state_solves = static_cast<int>(x[i + 9]),
                .accepted = x[i + 10] != 0};
    const Eigen::Index bounds = static_cast<Eigen::Index>(x[i + 11]), variables = static_cast<Eigen::Index>(x[i + 12]);
    i += 13;
    r.bounds.assign(x.begin() + i, x.begin() + i + bounds);
    i += bounds;
    r.variables = x.segment(i, variables);
    i += variables;
    const std::size_t end = notes.find('\n', from);
    r.note = notes.substr(from, end - from);
    from = end + 1;
    rows.push_back(std::move(r));
  }
  return rows;
}

}  // namespace kerf
