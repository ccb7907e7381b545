// The runs of a sweep, what is known of each from its folder, and the table of them all. The runs are all combinations
// of the values, the last key fastest; run k has the digits of k in the mixed base of the numbers of values. A folder
// is named by keys and values where these are short and safe, else by a checksum. A run is done when its folder holds
// results of this very case: its case.toml without the head, and the files beside it, equal what would be kept now. So
// a sweep goes on where it was ended, and a changed case is run again. Failures that would repeat (exit codes 3 and 4)
// are kept, others are tried again.

#include "app/sweep.hpp"

#include "app/sweep/convergence.hpp"
#include "app/sweep/sweep_page.hpp"
#include "io/csv.hpp"
#include "io/document.hpp"
#include "io/files.hpp"
#include "io/kept.hpp"
#include "io/words.hpp"
#include "kerf/case_file.hpp"
#include "kerf/mesher.hpp"
#include "optimize/checkpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace kerf {

namespace {

namespace fs = std::filesystem;

/// "open" without quotes where that is safe, [[0, 0], [1, 0]] as eight digits of its checksum.
std::string word_of(const std::string& value) {
  constexpr std::size_t longest = 24;
  std::string bare = value;
  if (bare.size() > 2 && bare.front() == '"' && bare.back() == '"') bare = bare.substr(1, bare.size() - 2);
  const auto safe = [](unsigned char c) { return std::isalnum(c) || c == '.' || c == '_' || c == '-' || c == '+'; };
  if (!bare.empty() && bare.size() <= longest && std::all_of(bare.begin(), bare.end(), safe)) return bare;
  return fmt::format("{:016x}", checksum(value)).substr(0, 8);
}

/// The last part of the path, or all of it where two keys end alike.
std::vector<std::string> short_keys(const std::vector<Swept>& over) {
  std::vector<std::string> out;
  for (const Swept& one : over) out.push_back(one.key.substr(one.key.rfind('.') + 1));
  std::vector<std::string> all = out;
  for (std::size_t k = 0; k < out.size(); ++k)
    if (std::ranges::count(all, all[k]) > 1) out[k] = over[k].key;
  return out;
}

std::string name_of(const std::vector<std::string>& keys, const std::vector<std::string>& values) {
  constexpr std::size_t longest = 100;
  std::string name, whole;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    name += fmt::format("{}{}={}", k ? "__" : "", keys[k], word_of(values[k]));
    whole += fmt::format("{}={}\n", keys[k], values[k]);
  }
  return name.size() <= longest ? name : fmt::format("run-{:016x}", checksum(whole));
}

void refuse_twice(const SweepPlan& plan) {
  std::set<std::string> keys;
  for (const Swept& one : plan.over) {
    if (!keys.insert(one.key).second)
      throw Error(Fault::Usage, fmt::format("--over {}: the key stands twice", one.key));
    std::set<std::string> values;
    for (const std::string& value : one.values)
      if (!values.insert(value).second)
        throw Error(Fault::Usage, fmt::format("--over {}: the value {} stands twice", one.key, value));
  }
}

/// The exit code and the reason in failed.txt.
std::pair<std::string, std::string> read_failure(const fs::path& folder) {
  const std::string text = read_file(folder / "failed.txt");
  const std::size_t line = std::min(text.find('\n'), text.size());
  std::string reason = text.substr(std::min(line + 1, text.size()));
  while (reason.ends_with('\n')) reason.pop_back();
  constexpr std::string_view program = "kerf: ";
  return {text.substr(0, line), reason.starts_with(program) ? reason.substr(program.size()) : reason};
}

/// The text of case.toml without the comment at its head, which tells who made it.
std::string without_head(const std::string& text) {
  std::size_t at = 0;
  while (at < text.size() && text[at] == '#') at = std::min(text.find('\n', at), text.size() - 1) + 1;
  return text.substr(at);
}

bool is_of_this_case(const SweepPlan& plan, const SweepRun& run) {
  const fs::path folder = plan.folder / run.name;
  if (!fs::exists(folder / "case.toml")) return false;
  try {
    const KeptCase kept = keep_file(plan.case_file, overrides_of(plan, run));
    if (without_head(read_file(folder / "case.toml")) != without_head(kept.text)) return false;
    return std::ranges::all_of(kept.files, [&](const auto& file) {
      return fs::exists(folder / file.first) && read_file(folder / file.first) == file.second;
    });
  } catch (const Error&) {  // what is wrong with it is said when it is run
    return false;
  }
}

/// Parts between commas that stand in no bracket and no quotes.
std::vector<std::string> parts_of(std::string_view text) {
  std::vector<std::string> parts(1);
  int depth = 0;
  char quote = 0;
  for (const char c : text) {
    if (quote != 0)
      quote = c == quote ? 0 : quote;
    else if (c == '"' || c == '\'')
      quote = c;
    else if (c == '[' || c == '{')
      ++depth;
    else if (c == ']' || c == '}')
      --depth;
    if (c == ',' && depth == 0 && quote == 0)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

constexpr const char* by_itself = "\"auto\"";

}  // namespace

Swept parse_swept(std::string_view assignment) {
  const std::size_t equals = assignment.find('=');
  std::string key(assignment.substr(0, equals));
  std::erase(key, ' ');
  const std::string name = fmt::format("--over {}", key);
  if (equals == std::string_view::npos || key.empty())
    throw Error(Fault::Usage, fmt::format("--over {}: values are missing; write key=[1, 2]", quote(assignment)));
  const auto parse = [&](std::string_view text) {
    Node values;
    try {
      override_value(values, fmt::format("values={}", text));
    } catch (const Error& e) {
      const std::string what = e.what();
      throw Error(Fault::Usage, fmt::format("{}{}", name, what.substr(what.find(':'))));
    }
    return values.entries.at(0).value;
  };
  const std::vector<std::string> parts = parts_of(assignment.substr(equals + 1));
  Swept listed{key, {}};
  if (parts.size() > 1) {
    for (const std::string& part : parts) listed.values.push_back(inline_text(parse(part)));
    return listed;
  }
  const Node list = parse(parts[0]);
  if (inline_text(list) == by_itself) return {key, {by_itself}};
  if (list.kind != Node::Kind::Array || list.items.empty())
    throw Error(Fault::Usage, fmt::format("{}: write a list of its values, as '{}=[1, 2]'", name, key));
  Swept out{key, {}};
  for (const Node& value : list.items) out.values.push_back(inline_text(value));
  return out;
}

SweepPlan with_sizes(SweepPlan plan) {
  for (Swept& one : plan.over) {
    if (one.values != std::vector<std::string>{by_itself}) continue;
    if (one.key != "mesh.size")
      throw Error(Fault::Usage,
                  fmt::format("--over {0}=auto: only mesh.size=auto is known; write {0}=[1, 2]", one.key));
    const Case c = read_case(plan.case_file, plan.overrides);
    const double size = target_size(c.sizing, c.shape);
    one.values = {fmt::format("{}", 2 * size), fmt::format("{}", size), fmt::format("{}", 0.5 * size)};
    plan.study = true;
  }
  return plan;
}

SweepPlan plan_sweep(SweepPlan plan) {
  constexpr double most = 100000;
  refuse_twice(plan);
  double count = 1;
  for (const Swept& one : plan.over) count *= static_cast<double>(one.values.size());
  if (plan.over.empty())
    throw Error(Fault::Usage, "a sweep needs a key and its values: --over 'mesh.size=[0.1, 0.05]'");
  if (count > most)
    throw Error(Fault::Usage, fmt::format("a sweep of {:.0f} runs; at most {:.0f} are made", count, most));
  const std::vector<std::string> keys = short_keys(plan.over);
  std::set<std::string> taken;
  for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
    SweepRun run;
    run.values.resize(plan.over.size());
    std::size_t rest = k;
    for (std::size_t j = plan.over.size(); j-- > 0;) {
      const auto& values = plan.over[j].values;
      run.values[j] = values[rest % values.size()];
      rest /= values.size();
    }
    run.name = name_of(keys, run.values);
    if (!taken.insert(run.name).second) run.name = fmt::format("{}-{}", run.name, k);
    plan.runs.push_back(std::move(run));
  }
  return plan;
}

std::vector<std::string> overrides_of(const SweepPlan& plan, const SweepRun& run) {
  std::vector<std::string> out = plan.overrides;
  for (std::size_t k = 0; k < plan.over.size(); ++k)
    out.push_back(fmt::format("{}={}", plan.over[k].key, run.values[k]));
  return out;
}

RunRecord record_of(const SweepPlan& plan, const SweepRun& run) {
  const fs::path folder = plan.folder / run.name;
  const bool ended = fs::exists(folder / "result.json"), failed = fs::exists(folder / "failed.txt");
  if ((!ended && !failed) || !is_of_this_case(plan, run)) return {};
  if (failed) {
    const auto [code, reason] = read_failure(folder);
    const bool final = code == "3" || code == "4";
    return {final ? RunRecord::State::Failed : RunRecord::State::Todo, reason};
  }
  RunRecord out{RunRecord::State::Done, {}};
  try {
    for (const Leaf& leaf : leaves_of_result(folder / "result.json")) {
      if (leaf.name == "status" && leaf.value != "ok") out.state = RunRecord::State::Failed;
      if (leaf.name == "reason") out.reason = leaf.value;
    }
  } catch (const Error& error) {  // of this run alone, and once more it may be whole
    return {RunRecord::State::Todo, error.what()};
  }
  return out;
}

void write_failure(const fs::path& folder, int exit_code, const std::string& message) {
  write_file(folder / "failed.txt", fmt::format("{}\n{}\n", exit_code, message));
}

namespace {

/// What is known of a run that is not done, for the table.
std::string reason_of(const fs::path& folder, const RunRecord& record) {
  if (!record.reason.empty()) return record.reason;
  return fs::exists(folder / "failed.txt") ? read_failure(folder).second : std::string();
}

/// A text of TOML as it is, without its quotes where it holds no escape.
std::string unquoted(const std::string& value) {
  const bool plain =
      value.size() >= 2 && value.front() == '"' && value.back() == '"' && value.find('\\') == std::string::npos;
  return plain ? value.substr(1, value.size() - 2) : value;
}

void write_table(const fs::path& path, const SweepTable& table) {
  std::string out = "run";
  for (const std::string& key : table.keys) out += fmt::format(",{}", csv_text(key));
  out += ",status,reason";
  for (const std::string& column : table.columns) out += fmt::format(",{}", csv_text(column));
  out += "\n";
  for (const SweepTable::Row& row : table.rows) {
    out += csv_text(row.name);
    for (const std::string& value : row.values) out += fmt::format(",{}", csv_text(unquoted(value)));
    out += fmt::format(",{},{}", csv_text(row.status), csv_text(row.reason));
    for (const std::string& cell : row.cells) out += fmt::format(",{}", csv_text(cell));
    out += "\n";
  }
  write_file(path, out);
}

}  // namespace

SweepSummary collect_sweep(const SweepPlan& plan) {
  SweepSummary summary;
  SweepTable table{.title = plan.case_file.stem().string()};
  for (const Swept& one : plan.over) table.keys.push_back(one.key);
  for (const SweepRun& run : plan.runs) {
    const fs::path folder = plan.folder / run.name;
    const RunRecord record = record_of(plan, run);
    const bool todo = record.state == RunRecord::State::Todo, damaged = todo && !record.reason.empty();
    const bool failed = fs::exists(folder / "failed.txt") || record.state == RunRecord::State::Failed || damaged;
    SweepTable::Row row{.name = run.name, .values = run.values, .status = failed ? "failed" : "missing"};
    if (failed) row.reason = reason_of(folder, record);
    if (!todo && fs::exists(folder / "result.json")) add_result(table, row, leaves_of_result(folder / "result.json"));
    ++(failed ? summary.failed : record.state == RunRecord::State::Done ? summary.done : summary.missing);
    if (failed) summary.failures.push_back(fmt::format("{}: {}", run.name, row.reason));
    table.rows.push_back(std::move(row));
  }
  for (SweepTable::Row& row : table.rows) row.cells.resize(table.columns.size());
  if (plan.study) summary.convergence = convergence_of(table, "mesh.size");
  choose_columns(table, plan.columns);
  if (plan.study) {
    std::erase_if(summary.convergence, [&](const Convergence& c) { return !std::ranges::count(table.columns, c.of); });
    write_convergence(plan.folder / "convergence.csv", summary.convergence);
    table.convergence = summary.convergence;
  }
  write_table(plan.folder / "sweep.csv", table);
  write_sweep_page(plan.folder / "sweep.html", table, plan.folder);
  return summary;
}

std::string in_words(const SweepSummary& summary, const SweepPlan& plan) {
  constexpr std::size_t most = 20;
  std::string out = fmt::format("{} of {} runs done", summary.done, plan.runs.size());
  if (summary.failed > 0) out += fmt::format(", {} failed", summary.failed);
  if (summary.missing > 0) out += fmt::format(", {} not yet run", summary.missing);
  out += "\n";
  for (std::size_t k = 0; k < std::min(most, summary.failures.size()); ++k)
    out += fmt::format("failed: {}\n", summary.failures[k]);
  if (summary.failures.size() > most) out += fmt::format("and {} more\n", summary.failures.size() - most);
  out += in_words(summary.convergence);
  out += fmt::format("table in {}, page in {}\n", (plan.folder / "sweep.csv").string(),
                     (plan.folder / "sweep.html").string());
  return out;
}

}  // namespace kerf
