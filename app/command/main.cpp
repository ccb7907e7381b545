// kerf: the commands and their arguments. parse() makes Arguments of the command line (CLI11), perform() does what they
// say: report, keys and init need no case; check, mesh and a dry run solve nothing that stays; all others run a case in
// a folder that is claimed and locked first. A watchdog ends what takes more memory or time than allowed, from the
// reading of the case on. Under mpiexec all processes but the first serve it; with --processes the program starts
// itself by mpiexec. Exit codes are those of docs/command-line.md, given by the kind of the error.

#include "app/command/keys.hpp"
#include "app/command/mesh.hpp"
#include "app/command/report.hpp"
#include "app/command/templates.hpp"
#include "app/command/version.hpp"
#include "app/command/watch.hpp"
#include "app/command/watchdog.hpp"
#include "app/command_line.hpp"
#include "app/folder.hpp"
#include "app/forecast.hpp"
#include "app/parts/task_pool.hpp"
#include "app/processes.hpp"
#include "app/program.hpp"
#include "app/progress.hpp"
#include "app/run.hpp"
#include "app/run/checkpoints.hpp"
#include "app/run/optimize.hpp"
#include "app/sweep.hpp"
#include "io/files.hpp"
#include "io/kept.hpp"
#include "io/module.hpp"
#include "io/untrusted.hpp"
#include "io/words.hpp"
#include "kerf/stop.hpp"

#include <fmt/format.h>

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <iostream>
#include <optional>
#include <span>
#include <sstream>
#include <thread>

namespace kerf {

namespace {

struct Arguments {
  std::string command, case_file, folder;
  std::vector<std::string> overrides;
  int threads = std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, 256);
  int processes = 1;
  bool quiet = false, force = false, resume = false;
  std::string log_level;       // empty: info, or warn when quiet
  std::string template_name;   // of init
  std::string format = "4.1";  // of mesh
  KeysRequest keys;
  std::vector<CommandWords> commands;  // and their options
  std::string line;                    // as it was typed
  bool list = false, dry_run = false;
  std::string max_memory;  // "12GB"
  double max_seconds = 0;  // 0: any
  bool untrusted = false;
  bool strict = false;            // of validate
  std::string other, page;        // of report
  std::vector<std::string> over;  // of sweep
  int jobs = 0;                   // 0: one per core
  int threads_of_run = 1;
  std::string write;  // a script instead of runs
  bool collect = false;
  std::string columns;
};

struct Command {
  std::string name, description;
};

const std::vector<Command>& commands() {
  static const std::vector<Command> all = {
      {"run", "Every job that the case names: solve, map, validate, grow, optimize, report"},
      {"solve", "The state alone: displacement, stress, contact, stress intensities"},
      {"map", "The state and the map of the topological derivative"},
      {"check", "Read the case, mesh it, print what each label selected, draw check.png; solve nothing"},
      {"watch", "Check the case again whenever it is saved, beside a page that shows it"},
      {"validate", "The state, and whether a map is right: holes of several radii are made and compared"},
      {"grow", "The state, and its cracks grown from their tips, quasi-statically or by fatigue"},
      {"optimize", "Nucleate, move and reshape holes until the design is best"},
      {"sweep", "A case with many values of some of its keys, a table and a page of them all"},
      {"report", "The page of a run, made again from the files in its folder"},
      {"mesh", "The mesh alone, for gmsh or ParaView"},
      {"keys", "What may stand in a case file: all keys, or one of them"},
      {"init", "Write a commented case to begin from"},
      {"help", "The options of a command"},
      {"bench", "Speed against error, with CSV, JSON and pictures"}};
  return all;
}

void declare_untrusted(CommandOptions& sub, Arguments& arguments) {
  sub.flag("--untrusted", arguments.untrusted,
           "The case is a stranger's: files of its own folder alone, no script of gmsh, limits of 600 s and 4 GB");
}

void declare_limits(CommandOptions& sub, Arguments& arguments, const char* memory, const char* seconds) {
  sub.words("--max-memory", arguments.max_memory, memory);
  sub.number("--max-seconds", arguments.max_seconds, seconds, {1e-3, 1e9});
}

void declare_sweep(CommandOptions& sub, Arguments& arguments) {
  sub.several("--over", arguments.over, "A key and its values: 'mesh.size=[0.1, 0.05]' (may be repeated)",
              "KEY=[VALUES]", true);
  sub.number("--jobs", arguments.jobs, "Runs at a time; default one per core", {1, 4096});
  sub.number("--threads", arguments.threads_of_run, "Number of threads of each run; default 1", {1, 256});
  sub.one_of("--write", arguments.write, "Write a script that makes the runs elsewhere, and run nothing",
             {"snakemake", "slurm"});
  declare_limits(sub, arguments, "Of each run, as 800MB or 12GB", "Of each run");
  declare_untrusted(sub, arguments);
  sub.words("--columns", arguments.columns,
            "What the table shows: names of result.json or their ends, as K_I,verdict; all; default what is usual");
  sub.flag("--collect", arguments.collect, "Make the table of what there is; run nothing");
  sub.flag("--quiet", arguments.quiet, "No summary and no progress");
}

constexpr const char *end_memory = "End what needs more, as 800MB or 12GB", *end_seconds = "End what takes longer";

/// The options of a command that reads no case; whether it is one.
bool declare_without_case(CommandOptions& sub, Arguments& arguments, const std::string& name) {
  if (name == "keys") {
    sub.words("NAME", arguments.keys.name, "Of a key or a table, such as mesh.size or hole; default all");
    sub.flag("--markdown", arguments.keys.markdown, "Print the tables of keys in Markdown");
    sub.flag("--schema", arguments.keys.schema, "Print a JSON Schema of case files, for editors");
    sub.words("--completion", arguments.keys.completion, "Print a completion for a shell: bash");
    sub.words("--write", arguments.keys.folder, "Make what is made from the keys anew in this folder (docs)");
    return true;
  }
  if (name == "init") {
    sub.words("NAME", arguments.template_name, "Which one; see --list");
    sub.flag("--list", arguments.list, "Print the names and what they show; write nothing");
    sub.words("-o,--output", arguments.folder, "The file to write; default <NAME>.toml");
    sub.flag("--force", arguments.force, "Overwrite the file");
    return true;
  }
  if (name == "report") {
    sub.words("DIR", arguments.folder, "Folder of a run that has ended, such as out/<case name>", true);
    sub.words("OTHER", arguments.other, "Folder of another run to compare it with, in compare.html");
    sub.words("-o,--output", arguments.page, "Where compare.html goes; default the folder of the other run");
    sub.flag("--quiet", arguments.quiet, "Do not say what was written");
    declare_limits(sub, arguments, end_memory, end_seconds);
    return true;
  }
  return name == "bench" || name == "help";  // a program of its own; see spell_help
}

void declare(CommandLine& line, Arguments& arguments) {
  line.version(version_text);
  for (const Command& command : commands()) {
    CommandOptions sub = line.command(command.name, command.description,
                                      [&arguments, name = command.name] { arguments.command = name; });
    if (declare_without_case(sub, arguments, command.name)) continue;
    sub.words("CASE", arguments.case_file, "The case file (TOML)", true);
    if (command.name == "mesh") {
      sub.words("-o,--output", arguments.folder, "The file to write: .msh or .vtu; default <case name>.msh");
      sub.one_of("--format", arguments.format, "Of gmsh, for .msh; default 4.1", {"4.1", "2.2"});
    } else {
      sub.words("-o,--output", arguments.folder, "Folder for the results; default out/<case name>");
    }
    sub.several("--set", arguments.overrides, "Override one key of the case: mesh.size=0.02 (may be repeated)",
                "KEY=VALUE");
    if (command.name == "watch") {
      declare_untrusted(sub, arguments);
      continue;
    }
    if (command.name == "sweep") {
      declare_sweep(sub, arguments);
      continue;
    }
    if (command.name == "validate")
      sub.flag("--strict", arguments.strict, "Exit with 4 unless the expansion holds at every point");
    if (command.name == "run" || command.name == "optimize" || command.name == "grow")
      sub.flag("--resume", arguments.resume,
               "Go on with the optimization or the growth whose checkpoint is in the folder");
    sub.number("--threads", arguments.threads, "Number of threads; default all cores", {1, 256});
    if (command.name == "run" || command.name == "solve" || command.name == "map" || command.name == "optimize")
      sub.number("--processes", arguments.processes,
                 "Start so many by mpiexec, for solver.backend = \"petsc\" or optimize.starts; default 1", {1, 4096});
    declare_untrusted(sub, arguments);
    sub.flag("--quiet", arguments.quiet, "No summary and no progress");
    sub.one_of("--log-level", arguments.log_level, "How much to log on stderr; default info", log_levels());
    sub.flag("--force", arguments.force, "Overwrite results");
    if (command.name == "check" || command.name == "mesh") {
      declare_limits(sub, arguments, end_memory, end_seconds);
      continue;
    }
    sub.flag("--dry-run", arguments.dry_run, "Say what it will take (triangles, memory, seconds); run nothing");
    declare_limits(sub, arguments,
                   "Refuse what would need more, as 800MB or 12GB, and end what does; default what there is",
                   "Refuse what would take longer, and end what does");
  }
}

/// In MB. Throws Error(Usage).
std::optional<double> memory_limit(const std::string& text) {
  if (text.empty()) return std::nullopt;
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const std::string_view unit(end, text.data() + text.size());
  const double factor = unit == "GB" || unit == "G" ? 1000 : unit == "MB" || unit == "M" ? 1 : 0;
  if (error != std::errc() || !(number > 0) || factor == 0)
    throw Error(Fault::Usage,
                fmt::format("--max-memory {}: write a number with its unit, such as 800MB or 12GB", quote(text)));
  return number * factor;
}

/// For the command line of another kerf.
std::vector<std::string> limits_as_given(const Arguments& arguments) {
  std::vector<std::string> words;
  if (!arguments.max_memory.empty()) words.insert(words.end(), {"--max-memory", arguments.max_memory});
  if (arguments.max_seconds > 0) words.insert(words.end(), {"--max-seconds", fmt::format("{}", arguments.max_seconds)});
  if (arguments.untrusted) words.emplace_back("--untrusted");
  return words;
}

/// Of memory each of several processes has its share.
Allowed limits_of(const Arguments& arguments, int processes = 1) {
  constexpr double strangers_mb = 4000, strangers_seconds = 600;
  Allowed limits{memory_limit(arguments.max_memory),
                 arguments.max_seconds > 0 ? std::optional(arguments.max_seconds) : std::nullopt};
  if (arguments.untrusted && !limits.memory_mb) limits.memory_mb = strangers_mb;
  if (arguments.untrusted && !limits.seconds) limits.seconds = strangers_seconds;
  if (limits.memory_mb) *limits.memory_mb /= processes;
  return limits;
}

std::optional<Forecast> forecast_of(const Case& c, Job job, const Arguments& arguments) {
  return forecast_where_needed(c, job, arguments.threads, limits_of(arguments), arguments.dry_run);
}

/// Nothing when help or the version was asked for and has been printed.
std::optional<Arguments> parse(int argc, char** argv) {
  Arguments arguments;
  arguments.line = command_line(argc, argv);
  CommandLine line("kerf: topological derivatives for plane elastic bodies with cracks in contact", "kerf", exit_codes);
  declare(line, arguments);
  std::vector<std::string> names;
  for (const Command& command : commands()) names.push_back(command.name);
  if (argc > 1 && argv[1][0] != '-' && std::find(names.begin(), names.end(), argv[1]) == names.end())
    throw Error(Fault::Usage, fmt::format("unknown command {}; {}", quote(argv[1]), suggest(argv[1], names)));
  if (!line.parse(argc, argv)) return std::nullopt;
  arguments.commands = line.commands();
  if (arguments.command.empty()) {
    std::cout << line.help();
    throw Error(Fault::Usage, "a command is missing");
  }
  return arguments;
}

/// kerf-bench beside this program, or else on the PATH, in place of this process: same exit code. Returns only by
/// throwing.
[[noreturn]] void start_bench(char** arguments) {
  for (const std::filesystem::path& bench : {find_beside("kerf-bench"), find_program("kerf-bench")})
    if (!bench.empty()) execv(bench.c_str(), arguments);
  throw Error(Fault::Files, "the benches are not installed: there is no program kerf-bench beside kerf or on the PATH");
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

int perform_mesh(const Arguments& arguments, const Case& c) {
  const std::filesystem::path path = arguments.folder.empty() ? c.name + ".msh" : arguments.folder;
  require_mesh_ending(path);
  if (std::filesystem::exists(std::filesystem::symlink_status(path)) && !arguments.force)
    throw Error(Fault::Files, fmt::format("{} is there already; use --force to overwrite it", path.string()));
  const std::string said = write_mesh_of(c, path, arguments.format);
  if (!arguments.quiet) print(said);
  return 0;
}

int perform_report(const Arguments& arguments) {
  const std::filesystem::path folder = arguments.folder;
  if (!std::filesystem::is_directory(folder))
    throw Error(Fault::Files, fmt::format("{} is no folder; give the folder of a run that has ended, such as "
                                          "out/cracked_plate",
                                          folder.string()));
  if (!arguments.other.empty()) {
    const std::filesystem::path other = arguments.other, page = arguments.page.empty()
                                                                    ? other / "compare.html"
                                                                    : std::filesystem::path(arguments.page);
    write_comparison(folder, other, page);
    if (!arguments.quiet) print(fmt::format("wrote {}\n", page.string()));
    return 0;
  }
  if (!arguments.page.empty()) throw Error(Fault::Usage, "-o goes with two folders: kerf report A B -o compare.html");
  FolderLock lock;
  lock.take(folder);
  write_report(folder);
  if (!arguments.quiet) print(fmt::format("wrote {}\n", (folder / "report.html").string()));
  return 0;
}

/// A signal ends it as it ends a run: the folder of the trials goes away.
std::optional<Forecast> foretell(const Case& c, Job job, const Arguments& arguments) {
  try {
    return forecast_of(c, job, arguments);
  } catch (...) {
    if (stop_requested()) throw Error(Fault::Numerics, "stopped before it was known what the run takes");
    throw;
  }
}

/// Throws Error(Numerics) unless the expansion holds at every point.
void require_all_hold(const Result& result) {
  std::vector<std::string> others;
  std::size_t points = 0;
  if (result.validate)
    for (const Validation& v : result.validate->points) {
      ++points;
      if (v.verdict != Verdict::Holds)
        others.push_back(fmt::format("({:.6g}, {:.6g}) {}", v.at.x(), v.at.y(), word(v.verdict)));
    }
  if (points == 0) throw Error(Fault::Numerics, "--strict: no point was validated");
  if (!others.empty())
    throw Error(Fault::Numerics, fmt::format("--strict: the expansion does not hold at {} of {} points: {}",
                                             others.size(), points, fmt::join(others, ", ")));
}

int perform_jobs(const Arguments& arguments, const Case& c, Job job, RunOptions& options, Watchdog& watchdog) {
  watchdog.allow_forecast();
  const std::optional<Forecast> expected = foretell(c, job, arguments);
  watchdog.end_forecast();
  Progress progress(log_level(arguments.log_level, arguments.quiet));
  if (expected && !expected->at_most && !expected->by_one) progress.expect(expected->seconds);
  options.threads = arguments.threads;
  options.in_single = expected && expected->single;
  options.on_phase = [&progress](const std::string& phase) { progress.phase(phase); };
  const Result result = run(c, job, options);
  progress.finish();
  if (!arguments.quiet) print(fmt::format("{}results in {}\n", summary(result), options.folder.string()));
  if (result.status != "ok") throw Error(Fault::Numerics, result.reason.value_or(result.status));
  if (arguments.strict) require_all_hold(result);
  return 0;
}

/// The command that makes the table of this sweep again, in any folder.
std::string collecting(const Arguments& arguments, const SweepPlan& plan) {
  std::vector<std::string> words{"kerf",
                                 "sweep",
                                 std::filesystem::absolute(plan.case_file).string(),
                                 "-o",
                                 std::filesystem::absolute(plan.folder).string(),
                                 "--collect"};
  for (const std::string& one : arguments.overrides) words.insert(words.end(), {"--set", one});
  for (const std::string& one : arguments.over) words.insert(words.end(), {"--over", one});
  if (!arguments.columns.empty()) words.insert(words.end(), {"--columns", arguments.columns});
  std::vector<const char*> argv;
  for (const std::string& word : words) argv.push_back(word.c_str());
  return command_line(static_cast<int>(argv.size()), argv.data());
}

/// What cannot be made is said by what is written there.
void make_result_folder(const std::filesystem::path& folder) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
}

/// Words between commas, without blanks.
std::vector<std::string> split(std::string text) {
  std::erase(text, ' ');
  std::vector<std::string> words;
  std::istringstream in(text);
  for (std::string word; std::getline(in, word, ',');)
    if (!word.empty()) words.push_back(word);
  return words;
}

int perform_sweep(const Arguments& arguments) {
  SweepPlan plan{.case_file = arguments.case_file, .folder = arguments.folder, .overrides = arguments.overrides};
  if (plan.folder.empty()) plan.folder = std::filesystem::path("out") / (plan.case_file.stem().string() + "_sweep");
  for (const std::string& one : arguments.over) plan.over.push_back(parse_swept(one));
  plan.columns = split(arguments.columns);
  plan = with_sizes(std::move(plan));
  plan = plan_sweep(std::move(plan));
  keep_file(plan.case_file, overrides_of(plan, plan.runs[0]));  // a key that cannot be is said before anything is made
  if (!arguments.write.empty()) {
    print(write_sweep_script(plan, arguments.write, arguments.threads_of_run, collecting(arguments, plan)));
    return 0;
  }
  make_result_folder(plan.folder);
  FolderLock lock;
  lock.take(plan.folder);
  catch_signals();
  if (!arguments.collect)
    run_sweep(plan, {.jobs = arguments.jobs > 0 ? arguments.jobs : arguments.threads,
                     .threads = arguments.threads_of_run,
                     .quiet = arguments.quiet,
                     .limits = limits_as_given(arguments)});
  const SweepSummary done = collect_sweep(plan);
  if (!arguments.quiet) print(in_words(done, plan));
  if (stop_requested()) throw Error(Fault::Numerics, "stopped; the same command goes on with what is left");
  if (done.failed > 0 && !arguments.collect)
    throw Error(Fault::Numerics, fmt::format("{} of {} runs failed", done.failed, plan.runs.size()));
  return 0;
}

/// What all processes but the first do.
void serve(const Case& c, Processes& processes, const Watchdog& watchdog) {
  catch_signals();
  processes.serve([&](std::string_view task, Communicator& comm) { work_on(c, task, comm); },
                  [&] { return watchdog.why(); });
}

/// What takes a case and a folder.
int perform_run(const Arguments& arguments, const Case& c, Watchdog& watchdog, Processes& processes) {
  RunOptions options;
  options.folder = std::filesystem::path(arguments.folder);
  if (options.folder.empty()) options.folder = std::filesystem::path("out") / c.name;
  if (arguments.command == "check") {
    print(check(c, options.folder));
    return 0;
  }
  options.command = arguments.line;
  options.processes = &processes;
  options.resume = arguments.resume;
  if (options.resume && !c.optimize && !c.grow)
    throw Error(Fault::Usage, "there is nothing to resume: the case has no table [optimize] and no table [grow]");
  const Job job = job_called(arguments.command);
  if (arguments.dry_run) {
    watchdog.allow_forecast();
    catch_signals();
    const Forecast f = *foretell(c, job, arguments);
    print(fmt::format("{} (found out in {:.1f} s on coarser meshes)\n", in_words(f), f.taken));
    return 0;
  }
  // Whoever started this process: MPI knows how many there are, before any of them writes.
  if (c.backend == Backend::Petsc && processes.start() > 0) {
    serve(c, processes, watchdog);
    return 0;
  }
  if (options.resume) check_checkpoint(options.folder, c.fingerprint);
  // Nothing to resume: a run like any other, which overwrites nothing.
  const bool resume = options.resume;
  options.resume = resume && has_checkpoint(options.folder);
  FolderLock lock;
  claim_folder(options.folder, arguments.force, resume, lock);
  options.lock = &lock;
  catch_signals();
  return perform_jobs(arguments, c, job, options, watchdog);
}

int perform_command(const Arguments& arguments, Watchdog& watchdog, Processes& processes) {
  if (arguments.command == "init") return perform_init(arguments);
  if (arguments.command == "report") return perform_report(arguments);
  if (arguments.command == "keys") {
    print(keys(arguments.keys, arguments.commands));
    return 0;
  }
  if (arguments.untrusted) require_own_files(arguments.case_file, arguments.overrides);
  if (arguments.command == "sweep" && processes.count() > 1)
    throw Error(Fault::Usage, "kerf sweep starts its runs itself; start it without mpiexec");
  if (arguments.command == "sweep") {
    limits_of(arguments);  // what they mean is said before anything is made
    return perform_sweep(arguments);
  }
  if (arguments.command == "watch") {
    const std::filesystem::path file = arguments.case_file;
    const std::filesystem::path folder =
        arguments.folder.empty() ? std::filesystem::path("out") / file.stem() : std::filesystem::path(arguments.folder);
    catch_signals();
    make_result_folder(folder);
    watch_case(file, arguments.overrides, folder);
    return 0;
  }
  const Case c = read_case(arguments.case_file, arguments.overrides);
  if (!processes.words().empty() && c.backend != Backend::Petsc)
    throw Error(Fault::Usage, "what stands behind -- are options of PETSc, for solver.backend = \"petsc\"");
  if (arguments.command == "mesh") return perform_mesh(arguments, c);
  return perform_run(arguments, c, watchdog, processes);
}

/// Reading counts, too: gmsh may take long for a geometry.
int perform(const Arguments& arguments, Processes& processes) {
  Watchdog watchdog(arguments.command == "sweep" ? Allowed{} : limits_of(arguments, processes.count()));
  const auto explain = [&](const std::string& otherwise) {
    const auto why = watchdog.why();
    processes.end_what_waits(why.value_or(otherwise));
    if (why) throw Error(Fault::Numerics, *why);
  };
  try {
    return perform_command(arguments, watchdog, processes);
  } catch (const Error& e) {
    explain(e.what());
    throw;
  } catch (const Stopped&) {
    explain("stopped, and with it all processes; what was written before stays");
    throw;
  }
}

/// The arguments in front of --; what stands behind them are options of PETSc.
std::span<char*> before_words(int argc, char** argv, Processes& processes) {
  const std::span<char*> all(argv, static_cast<std::size_t>(argc));
  const auto at = std::ranges::find_if(all, [](const char* word) { return std::string_view(word) == "--"; });
  if (at != all.end()) processes.take_words({at + 1, all.end()});
  return {all.begin(), at};
}

/// `kerf help COMMAND` as `kerf COMMAND --help`, `kerf help` as `kerf --help`; ends with a null as argv does.
std::vector<char*> spell_help(int argc, char** argv, std::string& option) {
  std::vector<char*> words(argv, argv + argc);
  if (argc > 1 && std::string_view(argv[1]) == "help") {
    words.erase(words.begin() + 1);
    words.push_back(option.data());
  }
  words.push_back(nullptr);
  return words;
}

int start(int given, char** words) {
  std::string help = "--help";
  std::vector<char*> spelled = spell_help(given, words, help);
  const int argc = static_cast<int>(spelled.size()) - 1;
  char** argv = spelled.data();
  if (argc > 1 && std::string_view(argv[1]) == "bench") start_bench(argv + 1);
  Processes processes;
  const std::span<char*> own = before_words(argc, argv, processes);
  const auto parse_own = [&] {
    processes.check_words();
    std::optional<Arguments> arguments = parse(static_cast<int>(own.size()), own.data());
    if (arguments) arguments->line = command_line(argc, argv);
    return arguments;
  };
  if (is_launched() && processes.start() > 0) {
    std::optional<Watchdog> watchdog;
    catch_signals();
    processes.serve(
        [&](std::string_view task, Communicator& comm) {
          const auto arguments = parse_own();  // as the first process has done
          if (!watchdog) watchdog.emplace(limits_of(*arguments, processes.count()));
          work_on(read_case(arguments->case_file, arguments->overrides), task, comm);
        },
        [&] { return watchdog ? watchdog->why() : std::nullopt; });
    return 0;
  }
  const auto arguments = parse_own();
  if (!arguments) return 0;
  if (arguments->processes > 1 && !is_launched()) return run_by_mpiexec(arguments->processes, argv);
  if (arguments->processes > 1 && arguments->processes != processes.count())
    throw Error(Fault::Usage, fmt::format("mpiexec started {} processes, --processes says {}; leave out one of them",
                                          processes.count(), arguments->processes));
  return perform(*arguments, processes);
}

}  // namespace

}  // namespace kerf

int main(int argc, char** argv) {
  return kerf::run_program(kerf::start, argc, argv);
}
