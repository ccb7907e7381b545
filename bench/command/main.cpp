// kerf-bench: speed against error. `kerf bench` starts it. The name of a bench and its options come from one command
// line; what does not go together is refused before anything is run. Every bench writes CSV, JSON and pictures into its
// folder, which is claimed and locked first, prints its summary, and ends with code 4 where it was stopped, where a
// hard case regressed, an interval does not contain its value or a benchmark lies outside its tolerance. Under mpiexec
// only `machines` runs; the other processes serve the first one.

#include "app/command_line.hpp"
#include "app/processes.hpp"
#include "app/program.hpp"
#include "app/progress.hpp"
#include "bench/hard.hpp"
#include "bench/measure/contact.hpp"
#include "bench/measure/limit.hpp"
#include "bench/measure/machines.hpp"
#include "bench/measure/map.hpp"
#include "bench/measure/proof.hpp"
#include "bench/measure/state.hpp"
#include "bench/optimize/optimize.hpp"
#include "bench/verify/defaults.hpp"
#include "bench/verify/verify.hpp"
#include "io/words.hpp"
#include "kerf/types.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace kerf {

namespace {

struct Arguments {
  std::string name, folder, peers;
  BenchOptions options;
  std::vector<std::string> elements;  // state, map
  double seconds = 300;               // state, map
  bool large = false;                 // map, limit
  std::string pages;                  // verify
  bool list = false, quiet = false, force = false;
  std::string log_level;
};

struct Bench {
  std::string name, description;
  std::vector<std::string> cases;
};

const std::vector<Bench>& benches() {
  static const std::vector<Bench> all = {
      {"state", "time and memory against the error of the stress: every element on smooth, singular and contact cases",
       bench_case_names()},
      {"map", "time and memory of a map (state, adjoint, evaluation) against its error, and of validations",
       map_case_names()},
      {"contact", "what contact costs beside open cracks: many unknowns, many cracks, cracks close beneath a side",
       contact_case_names()},
      {"hard", "digits that hard cases lose: families with a knob, against truth; a regression is exit code 4",
       hard_case_names()},
      {"proof",
       "guaranteed intervals of K, G, stresses and T: width, containment, cost; one without the truth is exit code 4",
       proof_case_names()},
      {"limit", "each phase's time, the factor against dgemm's speed, memory per triangle, one thread and two",
       limit_case_names()},
      {"machines", "several processes: iterations, condition, what is sent, memory and time on 4 to 64 parts",
       machine_case_names()},
      {"optimize", "compliance, time and state solves of optimized designs beside those of other programs",
       optimize_case_names()},
      {"defaults", "defaults alone on the bodies of the validation manual, beside degrees 1 and 3",
       defaults_case_names()},
      {"verify", "the validation manual: benchmarks with published or closed-form values, each against its tolerance",
       manual_ids()}};
  return all;
}

void declare(CommandOptions line, Arguments& arguments) {
  BenchOptions& options = arguments.options;
  line.words("NAME", arguments.name, "Which one; see --list");
  line.flag("--list", arguments.list, "Print the benches, their cases and elements; run nothing");
  line.words("-o,--output", arguments.folder, "Folder for the results; default out/bench_<name>");
  line.number("--seconds", arguments.seconds, "state, map: time for kerf's runs; default 300", {1e-3, 1e6});
  line.number("--peer-seconds", options.peer_seconds, "Time for the runs of other programs; default 1200", {1e-3, 1e6});
  line.several("--case", options.cases, "Only this case (may be repeated)");
  line.several("--element", arguments.elements, "Only this element (may be repeated)");
  line.flag(
      "--quick", options.quick,
      "Two coarse meshes of everything (proof: one): shows that it works, measures nothing; hard: a few values of "
      "each knob; verify: the quick half");
  line.words("--write", arguments.pages, "verify: folder for the pages of the manual; default that of the results");
  line.flag("--large", arguments.large, "map, limit: a million triangles, too; about 10 GB and a few minutes");
  line.words("--peers", arguments.peers, "Folder with the scripts of other programs, run too where installed");
  line.flag("--quiet", arguments.quiet, "No summary and no progress");
  line.one_of("--log-level", arguments.log_level, "How much to log on stderr; default info", log_levels());
  line.flag("--force", arguments.force, "Overwrite results");
}

/// Nothing when help was asked for and has been printed.
std::optional<Arguments> parse(int argc, char** argv) {
  Arguments arguments;
  CommandLine line("Speed against error, with CSV, JSON and pictures", "kerf bench", exit_codes);
  declare(line.options(), arguments);
  if (!line.parse(argc, argv, "bench ")) return std::nullopt;
  arguments.options.peers = arguments.peers;
  return arguments;
}

std::string list_benches() {
  std::string out;
  for (const Bench& b : benches())
    out += fmt::format("{:<10}{}\n  cases:  {}\n", b.name, b.description, fmt::join(b.cases, ", "));
  return out + fmt::format("elements: {}\n", fmt::join(bench_element_names(), ", "));
}

/// Throws Error(Usage) for what is unknown or does not go together.
void check(const Arguments& arguments) {
  std::vector<std::string> names;
  for (const Bench& b : benches()) names.push_back(b.name);
  if (arguments.name.empty()) throw Error(Fault::Usage, fmt::format("which bench? {}", suggest("", names)));
  require_known("bench", arguments.name, names);
  if (arguments.large && arguments.name != "map" && arguments.name != "limit")
    throw Error(Fault::Usage, "--large belongs to kerf bench map and limit");
  if (!arguments.pages.empty() &&
      (arguments.name != "verify" || arguments.options.quick || !arguments.options.cases.empty()))
    throw Error(Fault::Usage, "--write belongs to kerf bench verify, with neither --case nor --quick");
  const auto chosen =
      std::find_if(benches().begin(), benches().end(), [&](const Bench& b) { return b.name == arguments.name; });
  for (const std::string& name : arguments.options.cases) require_known("case", name, chosen->cases);
  if (arguments.name != "state" && arguments.name != "map" && !arguments.elements.empty())
    throw Error(Fault::Usage, fmt::format("--element does not go with kerf bench {}", arguments.name));
  for (const std::string& name : arguments.elements) require_known("element", name, bench_element_names());
}

int perform(int argc, char** argv) {
  Processes processes;
  if (is_launched() && processes.start() > 0) {
    processes.serve(work_on_machine_row);
    return 0;
  }
  const auto arguments = parse(argc, argv);
  if (!arguments) return 0;
  if (arguments->list) {
    print(list_benches());
    return 0;
  }
  check(*arguments);
  if (processes.count() > 1 && arguments->name != "machines")
    throw Error(Fault::Usage,
                fmt::format("kerf bench {} runs on one process; start it without mpiexec", arguments->name));
  BenchOptions options = arguments->options;
  options.folder = arguments->folder.empty() ? std::filesystem::path("out") / ("bench_" + arguments->name)
                                             : std::filesystem::path(arguments->folder);
  FolderLock lock;
  make_ready(options.folder, arguments->force, arguments->name + ".json", lock);
  catch_signals();
  Progress progress(log_level(arguments->log_level, arguments->quiet));
  options.on_phase = [&progress](const std::string& phase) { progress.phase(phase); };
  const auto finish = [&](const auto& bench) {
    progress.finish();
    if (!arguments->quiet) print(fmt::format("{}results in {}\n", summary(bench), options.folder.string()));
    if (bench.stopped) throw Error(Fault::Numerics, "stopped; what was done is written");
  };
  if (arguments->name == "hard") {
    const HardBench bench = run_hard_bench(options);
    finish(bench);
    if (const auto n = failures(bench); n > 0)
      throw Error(Fault::Numerics, fmt::format("{} rows are worse than their limits", n));
  } else if (arguments->name == "proof") {
    const ProofBench bench = run_proof_bench(options);
    finish(bench);
    if (const auto n = failures(bench); n > 0)
      throw Error(Fault::Numerics, fmt::format("{} guaranteed intervals do not contain the exact value", n));
  } else if (arguments->name == "verify") {
    const VerifyBench bench = run_verify_bench({options, arguments->pages});
    finish(bench);
    if (const int outside = count(bench, "outside"))
      throw Error(Fault::Numerics, fmt::format("{} of the benchmarks outside their tolerance", outside));
  } else if (arguments->name == "defaults") {
    finish(run_defaults_bench(options));
  } else if (arguments->name == "limit") {
    finish(run_limit_bench(options, arguments->large));
  } else if (arguments->name == "machines") {
    finish(run_machine_bench(options, processes));
  } else if (arguments->name == "contact") {
    finish(run_contact_bench(options));
  } else if (arguments->name == "optimize") {
    finish(run_optimize_bench(options));
  } else if (arguments->name == "map") {
    finish(run_map_bench({options, arguments->elements, arguments->seconds, arguments->large}));
  } else {
    finish(run_state_bench({options, arguments->elements, arguments->seconds}));
  }
  return 0;
}

}  // namespace

}  // namespace kerf

int main(int argc, char** argv) {
  return kerf::run_program(kerf::perform, argc, argv);
}
