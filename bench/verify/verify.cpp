// `kerf bench verify`: the validation manual. Each benchmark is run in a folder of its own, with its runs and, for the
// error bar of each number, once more with the overrides of `again`. Numbers are read from the files of a run, as a
// user would read them. The deviation is relative to the published value, or absolute where the tolerance is; "at
// least" and "at most" allow any amount on the right side. What kerf cannot do is "outside" with the reason; what the
// manual says is impossible is not run.

#include "bench/verify/verify.hpp"

#include "app/run.hpp"
#include "bench/measure/measure.hpp"
#include "bench/verify/pages.hpp"
#include "bench/verify/paths.hpp"
#include "bench/verify/records.hpp"
#include "io/files.hpp"
#include "kerf/stop.hpp"
#include "plot/shrink.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr int picture_width = 500;  // pixels

/// Case file -> folder with its results. `small`: no files but those that numbers are taken from.
Index run_case(const std::filesystem::path& path, const std::vector<std::string>& overrides,
               const std::filesystem::path& folder, bool small) {
  Case c = read_case(path, overrides);
  c.output = {.vtk = false, .png = !small, .html = false, .margins = false};
  const Result result = run(c, Job::Run, {.folder = folder});
  if (result.status != "ok")
    throw Error(Fault::Numerics, fmt::format("{}: {}", result.status, result.reason.value_or("no reason given")));
  return result.triangles;
}

/// One benchmark in a folder of its own.
class Runner {
 public:
  Runner(VerifiedEntry& out, const VerifyOptions& options)
      : out_(out), options_(options), folder_(options.bench.folder / "runs" / out.entry.id) {}

  void run() {
    const std::filesystem::path path = options_.bench.folder / "cases" / (out_.entry.id + ".toml");
    write_file(path, out_.entry.case_text + "\n");
    out_.values.resize(out_.entry.values.size());
    const bool again = !out_.entry.again.empty() && !options_.bench.quick;
    for (std::size_t k = 0; k < out_.entry.runs.size(); ++k) {
      std::vector<std::string> overrides = out_.entry.runs[k].overrides;
      const Index triangles = run_case(path, overrides, place(k, false), k > 0);
      if (k == 0) out_.triangles = triangles;
      overrides.insert(overrides.end(), out_.entry.again.begin(), out_.entry.again.end());
      if (again) run_case(path, overrides, place(k, true), true);
    }
    for (std::size_t k = 0; k < out_.values.size(); ++k) {
      out_.values[k].measured = measured(out_.entry.values[k], false);
      if (again) out_.values[k].error_bar = std::abs(measured(out_.entry.values[k], true) - out_.values[k].measured);
    }
    for (std::size_t k = 0; k < out_.values.size(); ++k) judge(out_.entry.values[k], out_.values[k]);
    draw_picture();
  }

 private:
  std::filesystem::path place(std::size_t run, bool again) const {
    return folder_ / fmt::format("{}{}", run, again ? "_again" : "");
  }

  double measured(const ManualValue& value, bool again) const {
    std::vector<std::pair<std::string, double>> numbers;
    for (const ManualValue::Take& take : value.takes)
      numbers.emplace_back(take.name, read_number(place(take.run, again), take.where, out_.entry.references));
    return value_of(value.quantity, numbers);
  }

  void draw_picture() {
    std::filesystem::path drawn = place(0, false) / out_.entry.picture;
    if (out_.entry.picture == "paths") {
      std::vector<std::filesystem::path> runs;
      for (std::size_t k = 0; k < out_.entry.runs.size(); ++k) runs.push_back(place(k, false));
      drawn = folder_ / "paths.png";
      draw_paths(drawn, out_.entry, runs);
    }
    if (!std::filesystem::exists(drawn)) return;
    shrink(drawn, options_.pages / (out_.entry.id + ".png"), picture_width);
    out_.has_picture = true;
  }

  VerifiedEntry& out_;
  const VerifyOptions& options_;
  std::filesystem::path folder_;
};

/// What kerf cannot do is a verdict like any other; wrong data of the manual and files that cannot be written are not.
void verify(VerifiedEntry& e, const VerifyOptions& options) {
  if (!e.entry.impossible.empty()) {
    e.verdict = "not possible";
    return;
  }
  ProcessorWatch watch;
  try {
    Runner(e, options).run();
    const bool within = std::ranges::all_of(e.values, [](const VerifiedValue& v) { return v.within; });
    e.verdict = within ? "within" : "outside";
  } catch (const Error& error) {
    if (stop_requested()) throw Stopped{};
    if (error.fault != Fault::Numerics) throw;
    e.values.clear();
    e.trouble = error.what();
    e.verdict = "outside";
  }
  e.seconds = watch.lap();
}

void write(const VerifyBench& bench, const VerifyOptions& options) {
  write_verify_csv(options.bench.folder / "verify.csv", bench);
  write_verify_json(options.bench.folder / "verify.json", bench);
  write_pages(options.pages, bench);
}

std::string printed(double value) {
  return std::isfinite(value) ? fmt::format("{:.6g}", value) : "-";
}

}  // namespace

void judge(const ManualValue& value, VerifiedValue& found) {
  if (!value.published) return;
  found.deviation = found.measured - *value.published;
  if (!value.absolute) found.deviation /= std::abs(*value.published);
  using Relation = ManualValue::Relation;
  const double over = value.relation == Relation::AtLeast  ? -found.deviation
                      : value.relation == Relation::AtMost ? found.deviation
                                                           : std::abs(found.deviation);
  found.within = over <= value.tolerance;
}

VerifyBench run_verify_bench(const VerifyOptions& asked) {
  VerifyOptions options = asked;
  if (options.pages.empty()) options.pages = options.bench.folder;
  make_folder(options.bench.folder / "cases");
  make_folder(options.bench.folder / "manual");
  make_folder(options.pages);
  VerifyBench bench;
  for (const std::string& id : manual_ids()) {
    if (!is_wanted(options.bench.cases, id)) continue;
    ManualEntry entry = read_manual(id, options.bench.folder / "manual");
    if (options.bench.quick && !entry.quick) continue;
    bench.entries.push_back({.entry = std::move(entry), .verdict = {}, .trouble = {}, .values = {}});
  }
  for (std::size_t k = 0; k < bench.entries.size(); ++k) {
    bench.stopped = stop_asked(options.bench);
    if (!bench.stopped && options.bench.on_phase) options.bench.on_phase(bench.entries[k].entry.id);
    try {
      if (!bench.stopped) verify(bench.entries[k], options);
    } catch (const Stopped&) {
      bench.stopped = true;
    }
    if (!bench.stopped) continue;
    bench.entries.resize(k);
    break;
  }
  write(bench, options);
  return bench;
}

int count(const VerifyBench& bench, std::string_view verdict) {
  return static_cast<int>(std::ranges::count(bench.entries, verdict, &VerifiedEntry::verdict));
}

std::string deviation_text(const ManualValue& value, const VerifiedValue& found) {
  if (!std::isfinite(found.deviation)) return "-";
  return value.absolute ? fmt::format("{:+.2g}", found.deviation) : fmt::format("{:+.3f} %", 100 * found.deviation);
}

std::string tolerance_text(const ManualValue& value) {
  if (!value.published || !(value.tolerance > 0)) return "-";
  const std::string amount =
      value.absolute ? fmt::format("{:g}", value.tolerance) : fmt::format("{:g} %", 100 * value.tolerance);
  using Relation = ManualValue::Relation;
  return value.relation == Relation::AtLeast  ? "-" + amount + ", more is right"
         : value.relation == Relation::AtMost ? "+" + amount + ", less is right"
                                              : amount;
}

std::string summary(const VerifyBench& bench) {
  std::string out = fmt::format("{:<28} {:<34} {:>11} {:>11} {:>10} {:>9}\n", "benchmark", "value", "published",
                                "measured", "deviation", "tolerance");
  for (const VerifiedEntry& e : bench.entries) {
    out += fmt::format("{:<28} {}{}\n", e.entry.id, e.verdict,
                       !e.trouble.empty()            ? ": " + e.trouble
                       : !e.entry.impossible.empty() ? ", because " + e.entry.impossible
                                                     : fmt::format("  {:.1f} s", e.seconds));
    for (std::size_t k = 0; k < e.values.size(); ++k) {
      const ManualValue& value = e.entry.values[k];
      out +=
          fmt::format("{:<28} {:<34} {:>11} {:>11} {:>10} {:>9}{}\n", "", value.name,
                      printed(value.published.value_or(nan)), printed(e.values[k].measured),
                      deviation_text(value, e.values[k]), tolerance_text(value), e.values[k].within ? "" : "  outside");
    }
  }
  return out + fmt::format("{} within, {} outside, {} not possible\n", count(bench, "within"), count(bench, "outside"),
                           count(bench, "not possible"));
}

}  // namespace kerf
