// The history of an optimization as a table, one row per iteration, its header and the collection file that shows the
// designs one after the other in ParaView.

#include "io/history.hpp"

#include "io/csv.hpp"
#include "io/files.hpp"
#include "io/text.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace kerf {

OptimizeNames optimize_names(const OptimizeRequest& request) {
  OptimizeNames names;
  names.volume_at_most = request.volume_at_most;
  for (const FunctionalBound& bound : request.bounds) {
    names.bounds.push_back(bound.name);
    names.at_most.push_back(bound.at_most);
  }
  names.variables = variable_names(request.design);
  return names;
}

std::string history_header(const OptimizeNames& names) {
  std::string out =
      "iteration,objective,merit,volume_fraction,violation,step,optimality,holes,triangles,state_solves,accepted";
  for (const auto* more : {&names.bounds, &names.variables})
    for (const std::string& name : *more) out.append(",").append(csv_text(name));
  return out + ",note\n";
}

std::string history_line(const Iteration& row, const OptimizeNames& names) {
  fmt::memory_buffer out;
  fmt::format_to(std::back_inserter(out), "{}", row.number);
  const auto add = [&out](double value) {
    out.push_back(',');
    append_cell(out, value);
  };
  for (const double value : {row.objective, row.merit, row.volume_fraction, row.violation, row.step, row.optimality})
    add(value);
  fmt::format_to(std::back_inserter(out), ",{},{},{},{}", row.holes, row.triangles, row.state_solves,
                 row.accepted ? 1 : 0);
  // Rows without a value for everything (an iterate that could not be evaluated) keep their columns.
  for (std::size_t i = 0; i < names.bounds.size(); ++i) add(i < row.bounds.size() ? row.bounds[i] : std::nan(""));
  for (std::size_t i = 0; i < names.variables.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    add(k < row.variables.size() ? row.variables[k] : std::nan(""));
  }
  out.push_back(',');
  const std::string note = clean_text(row.note);  // one row, one line
  if (!note.empty()) {
    out.push_back('"');
    for (const char c : note) {
      if (c == '"') out.push_back('"');
      out.push_back(c);
    }
    out.push_back('"');
  }
  out.push_back('\n');
  return {out.data(), out.size()};
}

void write_history_csv(const std::filesystem::path& path, const std::vector<Iteration>& history,
                       const OptimizeNames& names) {
  std::string out = history_header(names);
  for (const Iteration& row : history) out += history_line(row, names);
  write_file(path, out);
}

void write_collection(const std::filesystem::path& path, const std::vector<std::pair<int, std::string>>& files) {
  std::string out =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
      "  <Collection>\n";
  for (const auto& [iteration, file] : files)
    out +=
        fmt::format("    <DataSet timestep=\"{}\" group=\"\" part=\"0\" file=\"{}\"/>\n", iteration, escape_html(file));
  write_file(path, out + "  </Collection>\n</VTKFile>\n");
}

std::string sentence(const OptimizeResult& result) {
  std::string out =
      fmt::format("{} ended after {} iteration{} and {} state solves: {}", word(result.method), result.iterations,
                  result.iterations == 1 ? "" : "s", result.state_solves, result.stopped);
  return out;
}

}  // namespace kerf
