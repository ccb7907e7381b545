// `kerf bench hard`: runs a family of cases and judges each row. The benign value of the knob is run first; with e the
// error of a row, e_0 that of the benign one and d the digits that its family may lose,
//   allowed = min(0.1, max(floor, e_0) 10^d),   digits lost = log10(max(e, floor) / max(floor, e_0)).
// Every case is written, read and solved as a user's would be, exit code included. A row is held below its limit; above
// it the run must say so, in its status or in a note that the benign run does not have, else it is silent, the worst
// verdict. Refused and told are right only where the family has them on record. Truths that need a finer run get one.

#include "app/run.hpp"
#include "base/stopwatch.hpp"
#include "bench/command/records.hpp"
#include "bench/hard.hpp"
#include "bench/hard/family.hpp"
#include "bench/hard/report.hpp"
#include "io/files.hpp"
#include "kerf/stop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <sstream>

namespace kerf {

namespace {

/// x,y,u_x,u_y,s_xx,s_yy,s_xy and more; an empty cell is not a number.
std::vector<ProbeRow> read_probe(const std::filesystem::path& path) {
  std::vector<ProbeRow> rows;
  std::istringstream text(read_file(path));
  std::string line;
  std::getline(text, line);
  while (std::getline(text, line)) {
    std::istringstream cells(line);
    std::array<double, 7> value;
    value.fill(nan);
    std::string cell;
    for (double& v : value)
      if (std::getline(cells, cell, ',') && !cell.empty()) v = std::strtod(cell.c_str(), nullptr);
    rows.push_back({{value[0], value[1]}, {value[2], value[3]}, {value[4], value[5], value[6]}});
  }
  return rows;
}

struct Ran {
  HardRow row;
  std::optional<HardRun> seen;  // absent: refused before there was a result
  bool meant = true;            // that it was refused
};

/// What the program says that it does not say of the benign run: why it failed, which digits are lost, what it did
/// otherwise. That strains are no longer small is no matter here.
std::string told(const Result& r, const Result* benign) {
  if (r.status != "ok") return r.reason.value_or(r.status);
  for (const std::string& note : r.state->notes) {
    if (note.find("linear elasticity is about small ones") != std::string::npos) continue;
    const auto same = [&](const std::string& other) { return other == note; };
    if (!benign || std::none_of(benign->state->notes.begin(), benign->state->notes.end(), same)) return note;
  }
  return {};
}

/// Of a case that is written to `folder`/cases first.
HardRun solve_case(const HardCase& c, const std::string& name, const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "cases" / (name + ".toml"), out = folder / "runs" / name;
  for (const auto& [file, bytes] : c.files) write_file(path.parent_path() / file, bytes);
  write_file(path, c.text);
  Case asked = read_case(path);
  asked.output.margins = false;
  HardRun seen{run(asked, Job::Solve, {.folder = out}), {}};
  if (std::filesystem::exists(out / "probe_p.csv")) seen.probe = read_probe(out / "probe_p.csv");
  return seen;
}

std::string label_of(const HardFamily& family, double value) {
  return family.label ? family.label(value) : fmt::format("{:.3g}", value);
}

std::string file_name(const HardFamily& family, double value) {
  std::string file = fmt::format("{}_{}", family.name, label_of(family, value));
  std::replace_if(
      file.begin(), file.end(), [](char c) { return c == ' ' || c == '/'; }, '_');
  return file;
}

/// As `kerf solve` would, exit code included.
Ran run_one(const HardFamily& family, double value, const std::filesystem::path& folder) {
  Ran ran;
  HardRow& row = ran.row;
  row.family = family.name;
  row.value = value;
  row.label = label_of(family, value);
  Stopwatch watch;
  try {
    HardRun seen = solve_case(family.make(value), file_name(family, value), folder);
    row.seconds = watch.lap();
    const Result& r = seen.result;
    row.exit = r.status == "ok" ? 0 : static_cast<int>(Fault::Numerics);
    row.triangles = r.triangles;
    if (r.state && r.state->estimated_error) row.estimated = *r.state->estimated_error;
    if (r.state) row.residual = r.contact ? r.contact->kkt : r.state->residual, row.work = r.state->work_error;
    ran.seen = std::move(seen);
  } catch (const Error& e) {
    row.exit = static_cast<int>(e.fault);
    row.said = e.what();
  } catch (const Stopped&) {
    throw;
  } catch (const std::exception& e) {  // no sentence that anybody meant
    row.exit = static_cast<int>(Fault::Numerics);
    row.said = fmt::format("unexpected failure: {}", e.what());
    ran.meant = false;
  }
  if (!ran.seen) row.seconds = watch.lap();
  return ran;
}

/// Of the run against its truth; the reference, if there is one, is run for it. Infinite without a truth.
double error_of(const HardFamily& family, double value, const HardRun& seen, const HardRun& benign,
                const std::filesystem::path& folder) {
  if (!family.reference) return family.error({seen, value, benign});
  try {
    const HardRun reference = solve_case(family.reference(value), file_name(family, value) + "_reference", folder);
    return reference.result.status == "ok" ? family.error({seen, value, benign, &reference}) : infinity;
  } catch (const Error&) {
    return infinity;
  }
}

struct Benign {
  Ran ran;
  double error = nan;
};

void judge(const HardFamily& family, const Benign& benign, Ran& ran, const std::filesystem::path& folder) {
  HardRow& row = ran.row;
  if (ran.seen && &ran != &benign.ran)
    row.said = told(ran.seen->result, benign.ran.seen ? &benign.ran.seen->result : nullptr);
  const HardVerdict record = family.record ? family.record(row.value) : HardVerdict::Held;
  if (ran.seen && benign.ran.seen) {
    row.error =
        row.value == family.benign ? benign.error : error_of(family, row.value, *ran.seen, *benign.ran.seen, folder);
    const double least = std::max(family.floor, benign.error);
    row.digits = std::log10(std::max(row.error, family.floor) / least);
    constexpr double most = 0.1;  // less than a digit is no answer
    row.allowed = std::min(most, least * std::pow(10, family.digits(row.value)));
  }
  row.slower = benign.ran.row.seconds > 0 ? row.seconds / benign.ran.row.seconds : 1;
  const bool right = row.error <= row.allowed;
  if (row.exit != 0)
    row.verdict = record == HardVerdict::Refused && ran.meant ? HardVerdict::Refused : HardVerdict::Regressed;
  else if (right)
    row.verdict = HardVerdict::Held;
  else if (row.said.empty())
    row.verdict = HardVerdict::Silent;
  else
    row.verdict = record == HardVerdict::Told ? HardVerdict::Told : HardVerdict::Regressed;
}

}  // namespace

void run_hard_family(const HardFamily& family, const BenchOptions& options, HardBench& bench) {
  make_folder(options.folder / "cases");
  if (options.on_phase) options.on_phase(family.name);
  Benign benign{run_one(family, family.benign, options.folder)};
  if (benign.ran.seen)
    benign.error = error_of(family, family.benign, *benign.ran.seen, *benign.ran.seen, options.folder);
  for (const double value : options.quick ? family.quick : family.values) {
    if (stop_asked(options)) return;
    if (options.on_phase) options.on_phase(fmt::format("{} {:.3g}", family.name, value));
    Ran ran = value == family.benign ? benign.ran : run_one(family, value, options.folder);
    if (stop_requested()) return;  // what it says is not of the case
    judge(family, benign, ran, options.folder);
    bench.rows.push_back(std::move(ran.row));
  }
}

const std::vector<HardFamily>& hard_families() {
  static const std::vector<HardFamily> all = [] {
    std::vector<HardFamily> families;
    for (const auto& some : {material_families(), scale_families(), shape_families(), crack_families(),
                             contact_families(), support_families(), mesh_families()})
      families.insert(families.end(), some.begin(), some.end());
    return families;
  }();
  return all;
}

HardBench run_hard_bench(const BenchOptions& options) {
  make_folder(options.folder);
  HardBench bench{.quick = options.quick};
  for (const HardFamily& family : hard_families()) {
    if (!is_wanted(options.cases, family.name)) continue;
    try {
      run_hard_family(family, options, bench);
    } catch (const Stopped&) {
      break;
    }
  }
  bench.stopped = stop_asked(options);
  write_hard_csv(options.folder / "hard.csv", bench);
  draw_hard_plot(options.folder / "hard.png", bench);
  write_file(options.folder / "hard.md", hard_page(bench));
  write_hard_json(options.folder / "hard.json", bench);
  return bench;
}

const char* name_of(HardVerdict verdict) {
  switch (verdict) {
    case HardVerdict::Held:
      return "held";
    case HardVerdict::Told:
      return "told";
    case HardVerdict::Refused:
      return "refused";
    case HardVerdict::Silent:
      return "silent";
    default:
      return "regressed";
  }
}

std::size_t failures(const HardBench& bench) {
  return static_cast<std::size_t>(
      std::count_if(bench.rows.begin(), bench.rows.end(), [](const HardRow& r) { return is_failure(r.verdict); }));
}

std::vector<std::string> hard_case_names() {
  std::vector<std::string> names;
  for (const HardFamily& family : hard_families()) names.push_back(family.name);
  return names;
}

}  // namespace kerf
