// kerf: arguments, exit codes, signals. CLI11 lives here and nowhere else.

#include "app/keys.hpp"
#include "app/optimize.hpp"
#include "app/progress.hpp"
#include "app/run.hpp"
#include "app/templates.hpp"
#include "bench/map.hpp"
#include "bench/optimize.hpp"
#include "bench/state.hpp"
#include "io/files.hpp"
#include "io/words.hpp"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <new>
#include <thread>

namespace kerf {

namespace {

// Set by the first Ctrl-C; a signal handler can reach nothing else.
volatile std::sig_atomic_t stop_requested = 0;

extern "C" void request_stop(int) {
  stop_requested = 1;
}

/// The first signal asks for a clean stop, the second one ends the process.
void catch_signals() {
  struct sigaction action = {};
  action.sa_handler = request_stop;
  action.sa_flags = SA_RESETHAND | SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

struct Arguments {
  std::string command, case_file, folder;
  std::vector<std::string> overrides;
  int threads = std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, 256);
  bool quiet = false, force = false, resume = false;
  std::string log_level;      // empty: info, or warn when quiet
  std::string template_name;  // of init
  KeysRequest keys;
  std::vector<CommandWords> commands;  // and their options
  std::string bench;                   // its name
  StateBenchOptions state_bench;       // what it shares with MapBenchOptions goes to both
  bool large = false;
  bool list = false;
};

struct Command {
  std::string name, description;
};

const std::vector<Command>& commands() {
  static const std::vector<Command> all = {
      {"run", "Every job that the case names: solve, map, validate, optimize, report"},
      {"solve", "The state alone"},
      {"map", "The state and the map of the topological derivative"},
      {"check", "Read the case, mesh it, print what each label selected; solve nothing"},
      {"validate", "The expansion against computations with changes of finite size"},
      {"optimize", "Nucleate, move and reshape holes until the design is best"},
      {"keys", "What may stand in a case file: all keys, or one of them"},
      {"init", "Write a commented case to begin from"},
      {"bench", "Speed against error, with CSV, JSON and pictures"}};
  return all;
}

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
      {"optimize", "compliance, time and state solves of optimized designs beside those of other programs",
       optimize_case_names()}};
  return all;
}

void declare_common(CLI::App* sub, Arguments& arguments) {
  sub->add_flag("--quiet", arguments.quiet, "No summary and no progress");
  sub->add_option("--log-level", arguments.log_level, "How much to log on stderr; default info")
      ->check(CLI::IsMember(log_levels()));
  sub->add_flag("--force", arguments.force, "Overwrite results");
}

void declare_bench(CLI::App* sub, Arguments& arguments) {
  StateBenchOptions& options = arguments.state_bench;
  sub->add_option("NAME", arguments.bench, "Which one; see --list");
  sub->add_flag("--list", arguments.list, "Print the benches, their cases and elements; run nothing");
  sub->add_option("-o,--output", arguments.folder, "Folder for the results; default out/bench_<name>");
  sub->add_option("--seconds", options.seconds, "state, map: time for kerf's runs; default 300")
      ->check(CLI::Range(1e-3, 1e6));
  sub->add_option("--peer-seconds", options.peer_seconds, "Time for the runs of other programs; default 1200")
      ->check(CLI::Range(1e-3, 1e6));
  const auto several = [sub](const char* name, std::vector<std::string>& names, const char* words) {
    sub->add_option(name, names, words)
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->allow_extra_args(false);
  };
  several("--case", options.cases, "Only this case (may be repeated)");
  several("--element", options.elements, "Only this element (may be repeated)");
  sub->add_flag("--quick", options.quick, "Two coarse meshes of everything: shows that it works, measures nothing");
  sub->add_flag("--large", arguments.large, "map: a million triangles, too; about 10 GB and a few minutes");
  sub->add_option("--peers", options.peers, "Folder with the scripts of other programs, run too where installed");
  declare_common(sub, arguments);
}

void declare(CLI::App& app, Arguments& arguments) {
  app.set_version_flag("--version", "kerf " KERF_VERSION);
  app.require_subcommand(0, 1);
  app.footer("Exit codes: 0 done, 2 wrong usage or case file, 3 invalid geometry, 4 not solved, 5 files.");
  for (const Command& command : commands()) {
    CLI::App* sub = app.add_subcommand(command.name, command.description);
    sub->callback([&arguments, name = command.name] { arguments.command = name; });
    if (command.name == "keys") {
      sub->add_option("NAME", arguments.keys.name, "Of a key or a table, such as mesh.size or hole; default all");
      sub->add_flag("--markdown", arguments.keys.markdown, "Print the tables of keys in Markdown");
      sub->add_flag("--schema", arguments.keys.schema, "Print a JSON Schema of case files, for editors");
      sub->add_option("--completion", arguments.keys.completion, "Print a completion for a shell: bash");
      sub->add_option("--write", arguments.keys.folder, "Make what is made from the keys anew in this folder (docs)");
      continue;
    }
    if (command.name == "init") {
      sub->add_option("NAME", arguments.template_name, "Which one; see --list");
      sub->add_flag("--list", arguments.list, "Print the names and what they show; write nothing");
      sub->add_option("-o,--output", arguments.folder, "The file to write; default <NAME>.toml");
      sub->add_flag("--force", arguments.force, "Overwrite the file");
      continue;
    }
    if (command.name == "bench") {
      declare_bench(sub, arguments);
      continue;
    }
    sub->add_option("CASE", arguments.case_file, "The case file (TOML)")->required();
    sub->add_option("-o,--output", arguments.folder, "Folder for the results; default out/<case name>");
    sub->add_option("--set", arguments.overrides, "Override one key of the case: mesh.size=0.02 (may be repeated)")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->allow_extra_args(false)
        ->type_name("KEY=VALUE");
    if (command.name == "run" || command.name == "optimize")
      sub->add_flag("--resume", arguments.resume, "Go on with the optimization whose checkpoint is in the folder");
    sub->add_option("--threads", arguments.threads, "Number of threads; default all cores")->check(CLI::Range(1, 256));
    declare_common(sub, arguments);
  }
}

/// Nothing when help or the version was asked for and has been printed.
std::optional<Arguments> parse(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("kerf: topological derivatives for plane elastic bodies with cracks in contact", "kerf");
  declare(app, arguments);
  std::vector<std::string> names;
  for (const Command& command : commands()) names.push_back(command.name);
  if (argc > 1 && argv[1][0] != '-' && std::find(names.begin(), names.end(), argv[1]) == names.end())
    throw Error(Fault::Usage, fmt::format("unknown command {}; {}", quote(argv[1]), suggest(argv[1], names)));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) {
      app.exit(e);
      return std::nullopt;
    }
    std::string message = e.what();
    std::replace(message.begin(), message.end(), '\n', ' ');
    const auto parsed = app.get_subcommands();
    throw Error(Fault::Usage,
                fmt::format("{}; see kerf {}--help", message, parsed.empty() ? "" : parsed.front()->get_name() + " "));
  }
  for (const CLI::App* sub : app.get_subcommands({})) {
    arguments.commands.push_back({sub->get_name(), {}});
    for (const CLI::Option* option : sub->get_options())
      for (const std::string& name : option->get_lnames()) arguments.commands.back().options.push_back("--" + name);
  }
  if (arguments.command.empty()) {
    std::cout << app.help();
    throw Error(Fault::Usage, "a command is missing");
  }
  return arguments;
}

void make_ready(const std::filesystem::path& folder, bool force, const char* name = "result.json") {
  const std::filesystem::path result = folder / name;
  if (std::filesystem::exists(folder) && !std::filesystem::is_directory(folder))
    throw Error(Fault::Files, fmt::format("{} is not a folder; choose another with --output", folder.string()));
  if (!std::filesystem::exists(std::filesystem::symlink_status(result))) return;
  if (!force)
    throw Error(Fault::Files, fmt::format("{} already holds results; use --force to overwrite", folder.string()));
  std::filesystem::remove(result);
}

std::string log_level(const Arguments& arguments) {
  return !arguments.log_level.empty() ? arguments.log_level : arguments.quiet ? "warn" : "info";
}

void print(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
    throw Error(Fault::Files, "cannot write to standard output");
}

std::string list_benches() {
  std::string out;
  for (const Bench& b : benches())
    out += fmt::format("{:<10}{}\n  cases:  {}\n", b.name, b.description, fmt::join(b.cases, ", "));
  return out + fmt::format("elements: {}\n", fmt::join(bench_element_names(), ", "));
}

void require_known(const char* what, const std::string& name, const std::vector<std::string>& known) {
  if (std::find(known.begin(), known.end(), name) == known.end())
    throw Error(Fault::Usage, fmt::format("unknown {} {}; {}", what, quote(name), suggest(name, known)));
}

int perform_bench(const Arguments& arguments) {
  if (arguments.list) {
    print(list_benches());
    return 0;
  }
  std::vector<std::string> names;
  for (const Bench& b : benches()) names.push_back(b.name);
  if (arguments.bench.empty()) throw Error(Fault::Usage, fmt::format("which bench? {}", suggest("", names)));
  require_known("bench", arguments.bench, names);
  const bool maps = arguments.bench == "map", designs = arguments.bench == "optimize";
  if (arguments.large && !maps) throw Error(Fault::Usage, "--large belongs to kerf bench map");
  StateBenchOptions options = arguments.state_bench;
  const auto chosen =
      std::find_if(benches().begin(), benches().end(), [&](const Bench& b) { return b.name == arguments.bench; });
  for (const std::string& name : options.cases) require_known("case", name, chosen->cases);
  if (designs && !options.elements.empty()) throw Error(Fault::Usage, "--element does not go with kerf bench optimize");
  for (const std::string& name : options.elements) require_known("element", name, bench_element_names());
  options.folder = arguments.folder.empty() ? std::filesystem::path("out") / ("bench_" + arguments.bench)
                                            : std::filesystem::path(arguments.folder);
  make_ready(options.folder, arguments.force, (arguments.bench + ".json").c_str());
  catch_signals();
  Progress progress(log_level(arguments));
  options.stop_asked = [] { return stop_requested != 0; };
  options.on_phase = [&progress](const std::string& phase) { progress.phase(phase); };
  const auto finish = [&](const auto& bench) {
    progress.finish();
    if (!arguments.quiet) print(fmt::format("{}results in {}\n", summary(bench), options.folder.string()));
    if (bench.stopped) throw Error(Fault::Numerics, "stopped; what was done is written");
  };
  if (designs)
    finish(run_optimize_bench({.folder = options.folder,
                               .cases = options.cases,
                               .peer_seconds = options.peer_seconds,
                               .quick = options.quick,
                               .peers = options.peers,
                               .stop_asked = options.stop_asked,
                               .on_phase = options.on_phase}));
  else if (maps)
    finish(run_map_bench({.folder = options.folder,
                          .cases = options.cases,
                          .elements = options.elements,
                          .seconds = options.seconds,
                          .peer_seconds = options.peer_seconds,
                          .quick = options.quick,
                          .large = arguments.large,
                          .peers = options.peers,
                          .stop_asked = options.stop_asked,
                          .on_phase = options.on_phase}));
  else
    finish(run_state_bench(options));
  return 0;
}

int perform_init(const Arguments& arguments) {
  std::vector<std::string> names;
  std::string list;
  for (const Template& t : templates()) {
    names.push_back(t.name);
    list += fmt::format("{:<10}{}\n", t.name, t.description);
  }
  if (arguments.list) {
    print(list);
    return 0;
  }
  if (arguments.template_name.empty())
    throw Error(Fault::Usage, fmt::format("which template? {}; see kerf init --list", suggest("", names)));
  require_known("template", arguments.template_name, names);
  const std::filesystem::path path = arguments.folder.empty() ? arguments.template_name + ".toml" : arguments.folder;
  if (std::filesystem::exists(std::filesystem::symlink_status(path)) && !arguments.force)
    throw Error(Fault::Files, fmt::format("{} is there already; use --force to overwrite it", path.string()));
  const Template& chosen = *std::find_if(templates().begin(), templates().end(),
                                         [&](const Template& t) { return t.name == arguments.template_name; });
  write_file(path, chosen.text);
  const char* next = chosen.text.find("[optimize]") == std::string::npos ? "run" : "optimize";
  print(fmt::format("wrote {}; next: kerf {} {}\n", path.string(), next, path.string()));
  return 0;
}

int perform(const Arguments& arguments) {
  if (arguments.command == "bench") return perform_bench(arguments);
  if (arguments.command == "init") return perform_init(arguments);
  if (arguments.command == "keys") {
    print(keys(arguments.keys, arguments.commands));
    return 0;
  }
  const Case c = read_case(arguments.case_file, arguments.overrides);
  if (arguments.command == "check") {
    print(check(c));
    return 0;
  }
  RunOptions options;
  options.folder = std::filesystem::path(arguments.folder);
  if (options.folder.empty()) options.folder = std::filesystem::path("out") / c.name;
  options.resume = arguments.resume;
  if (options.resume && !c.optimize)
    throw Error(Fault::Usage, "there is nothing to resume: the case has no table [optimize]");
  if (options.resume) check_checkpoint(options.folder, c);
  // Nothing to resume: a run like any other, which overwrites nothing.
  options.resume = options.resume && has_checkpoint(options.folder);
  make_ready(options.folder, arguments.force || options.resume);
  catch_signals();
  Progress progress(log_level(arguments));
  options.threads = arguments.threads;
  options.on_phase = [&progress](const std::string& phase) { progress.phase(phase); };
  options.stop_asked = [] { return stop_requested != 0; };
  const Job job = arguments.command == "solve"      ? Job::Solve
                  : arguments.command == "map"      ? Job::Map
                  : arguments.command == "validate" ? Job::Validate
                  : arguments.command == "optimize" ? Job::Optimize
                                                    : Job::Run;
  const Result result = run(c, job, options);
  progress.finish();
  if (!arguments.quiet) print(fmt::format("{}results in {}\n", summary(result), options.folder.string()));
  if (result.status != "ok") throw Error(Fault::Numerics, result.reason.value_or(result.status));
  return 0;
}

}  // namespace

}  // namespace kerf

int main(int argc, char** argv) {
  // No call here may throw: not for want of memory, not because stderr is closed.
  const auto report = [](const char* before, const char* message, kerf::Fault fault) {
    std::fprintf(stderr, "kerf: %s%s\n", before, message);
    return static_cast<int>(fault);
  };
  try {
    const auto arguments = kerf::parse(argc, argv);
    return arguments ? kerf::perform(*arguments) : 0;
  } catch (const kerf::Error& e) {
    return report("", e.what(), e.fault);
  } catch (const std::filesystem::filesystem_error& e) {
    return report("", e.what(), kerf::Fault::Files);
  } catch (const std::bad_alloc&) {
    return report("", "out of memory; use a coarser mesh (a larger mesh.size)", kerf::Fault::Numerics);
  } catch (const std::exception& e) {
    return report("unexpected failure: ", e.what(), kerf::Fault::Numerics);
  } catch (...) {
    return report("", "unexpected failure", kerf::Fault::Numerics);
  }
}
