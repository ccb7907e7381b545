// `kerf bench defaults`: what defaults alone give on the bodies of the validation manual. Each case is solved as the
// manual has it, which is the reference, and without its [mesh] and [solver], for degrees 1 to 3 with curved edges and
// degree 1 with chords. A row is a value with its relative errors; values that are 0 by symmetry are left out, as are
// those that need several runs. The summary has the medians and the 90 % of all errors. docs/benchmarks.md has the
// results.

#include "bench/verify/defaults.hpp"

#include "app/run.hpp"
#include "base/stopwatch.hpp"
#include "bench/verify/manual.hpp"
#include "bench/verify/records.hpp"
#include "io/document.hpp"
#include "io/files.hpp"
#include "kerf/stop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr std::array<std::array<std::string_view, 2>, 4> overrides_of{{{"solver.degree=1", "mesh.curved=false"},
                                                                       {"solver.degree=1", "mesh.curved=\"auto\""},
                                                                       {"solver.degree=2", "mesh.curved=\"auto\""},
                                                                       {"solver.degree=3", "mesh.curved=\"auto\""}}};

/// The values of the first run.
struct Values {
  std::vector<double> of;  // of the entry; nan where they need other runs
  double seconds = 0;
};

Values solve_case(const ManualEntry& e, Case c, const std::filesystem::path& folder) {
  Stopwatch watch;
  const Result result = run(c, Job::Run, {.folder = folder});
  if (result.status != "ok")
    throw Error(Fault::Numerics, fmt::format("{}: {}", result.status, result.reason.value_or("no reason given")));
  Values found{{}, watch.lap()};
  for (const ManualValue& value : e.values) {
    std::vector<std::pair<std::string, double>> numbers;
    for (const ManualValue::Take& take : value.takes)
      if (take.run == 0) numbers.emplace_back(take.name, read_number(folder, take.where));
    // Chords leave out probes on the curve.
    const bool there = std::ranges::all_of(numbers, [](const auto& n) { return std::isfinite(n.second); });
    found.of.push_back(there && numbers.size() == value.takes.size() ? value_of(value.quantity, numbers) : nan);
  }
  return found;
}

void add_benchmark(const ManualEntry& e, const BenchOptions& options, std::vector<DefaultsRow>& rows) {
  const std::filesystem::path path = options.folder / "cases" / (e.id + ".toml"), runs = options.folder / "runs" / e.id;
  write_file(path, e.case_text + "\n");
  Case own = read_case(path, e.runs[0].overrides);
  if (own.grow) return;  // bodies of many meshes
  own.output = {.vtk = false, .png = false, .html = false};
  const Values reference = solve_case(e, own, runs / "manual");
  const std::size_t first = rows.size();
  for (std::size_t k = 0; k < e.values.size(); ++k)
    rows.push_back({.id = e.id, .quantity = e.values[k].name, .reference = reference.of[k]});
  Node document = read_document(path);
  std::erase_if(document.entries, [](const Entry& entry) { return entry.key == "mesh" || entry.key == "solver"; });
  for (std::size_t way = 0; way < overrides_of.size(); ++way) {
    for (std::size_t k = first; k < rows.size(); ++k) rows[k].error[way] = rows[k].seconds[way] = nan;
    std::vector<std::string> overrides;
    for (const std::string& given : e.runs[0].overrides)
      if (!given.starts_with("mesh.") && !given.starts_with("solver.")) overrides.push_back(given);
    overrides.insert(overrides.end(), overrides_of[way].begin(), overrides_of[way].end());
    try {
      const Values found = solve_case(e, read_case(document, {e.id, path.parent_path(), path.string()}, overrides),
                                      runs / defaults_ways[way]);
      for (std::size_t k = 0; k < e.values.size(); ++k) {
        DefaultsRow& row = rows[first + k];
        row.error[way] = (found.of[k] - row.reference) / std::abs(row.reference);
        row.seconds[way] = found.seconds;
      }
    } catch (const Error& error) {
      if (stop_requested()) throw Stopped{};
      for (std::size_t k = first; k < rows.size(); ++k)
        if (rows[k].trouble.empty()) rows[k].trouble = fmt::format("{}: {}", defaults_ways[way], error.what());
    }
  }
}

std::string cell(double value, const char* format) {
  return std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : "-";
}

void write(const DefaultsBench& bench, const std::filesystem::path& folder) {
  std::string csv = "id,quantity,reference";
  for (const char* way : defaults_ways) csv += fmt::format(",\"error, {0}\",\"seconds, {0}\"", way);
  csv += '\n';
  for (const DefaultsRow& row : bench.rows) {
    csv += fmt::format("{},\"{}\",{:.17g}", row.id, row.quantity, row.reference);
    for (std::size_t way = 0; way < row.error.size(); ++way)
      csv += fmt::format(",{},{}", cell(row.error[way], "{:.6g}"), cell(row.seconds[way], "{:.3g}"));
    csv += '\n';
  }
  write_file(folder / "defaults.csv", csv);
  write_file(folder / "defaults.json", fmt::format("{{\"schema\": 1, \"status\": \"{}\", \"rows\": {}}}\n",
                                                   bench.stopped ? "stopped" : "ok", bench.rows.size()));
}

}  // namespace

DefaultsBench run_defaults_bench(const BenchOptions& options) {
  make_folder(options.folder / "cases");
  DefaultsBench bench{.rows = {}, .quick = options.quick};
  try {
    for (const std::string& id : defaults_case_names()) {
      if (!is_wanted(options.cases, id)) continue;
      const ManualEntry e = read_manual(id, options.folder / "cases");
      if (!e.impossible.empty() || (options.quick && !e.quick)) continue;
      if (stop_asked(options)) throw Stopped{};
      if (options.on_phase) options.on_phase(id);
      add_benchmark(e, options, bench.rows);
    }
  } catch (const Stopped&) {
    bench.stopped = true;
  }
  // What is nothing by symmetry has no relative error.
  std::erase_if(bench.rows, [](const DefaultsRow& row) { return !(std::abs(row.reference) > 1e-12); });
  write(bench, options.folder);
  return bench;
}

std::string summary(const DefaultsBench& bench) {
  std::string out = fmt::format("{:<26}{:<34}{:>12}", "benchmark", "quantity", "reference");
  for (const char* way : defaults_ways) out += fmt::format("{:>12}", way);
  out += fmt::format("{:>9}\n", "seconds");
  std::array<std::vector<double>, 4> all;
  for (const DefaultsRow& row : bench.rows) {
    out += fmt::format("{:<26}{:<34.33}{:>12.5g}", row.id, row.quantity, row.reference);
    for (std::size_t way = 0; way < row.error.size(); ++way) {
      out += fmt::format("{:>12}", cell(100 * row.error[way], "{:.3f} %"));
      if (std::isfinite(row.error[way])) all[way].push_back(std::abs(row.error[way]));
    }
    out += fmt::format("{:>9}{}\n", cell(row.seconds[2], "{:.2f}"), row.trouble.empty() ? "" : "  " + row.trouble);
  }
  for (const double share : {0.5, 0.9}) {
    out += fmt::format("{:<72}", fmt::format("{:g} % of the errors are below", 100 * share));
    for (std::vector<double>& errors : all) {
      std::ranges::sort(errors);
      const auto at = static_cast<std::size_t>(share * static_cast<double>(errors.size()));
      out +=
          fmt::format("{:>12}", errors.empty() ? "-" : cell(100 * errors[std::min(at, errors.size() - 1)], "{:.3f} %"));
    }
    out += '\n';
  }
  return out;
}

std::vector<std::string> defaults_case_names() {
  std::vector<std::string> names = manual_ids();
  std::erase_if(names, [](const std::string& id) { return id.starts_with("td-"); });
  return names;
}

}  // namespace kerf
