// kerf-fuzz: thousands of inputs that nobody would write, each made from two numbers, and what the program promises for
// every one of them. CONTRIBUTING.md says how to use it.

#include "tests/fuzz/minimise.hpp"

#include <fmt/format.h>

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <mutex>
#include <stdexcept>
#include <thread>

namespace kerf::fuzz {

namespace {

namespace fs = std::filesystem;

constexpr const char* usage =
    "kerf-fuzz --program kerf --corpus FOLDER [--corpus FOLDER] [--seed 1] [--first 0] [--count 1000] [--jobs 1]\n"
    "          [--seconds 10] [--grace 10] [--memory-gb 3] [--keep FOLDER] [--minimise] [--print]\n"
    "  --first K --count 1   the one input again; --print shows it, --minimise makes it small\n"
    "  --keep FOLDER         inputs that fail, a folder each with `arguments` and the files\n"
    "  --memory-gb 0         no limit: sanitizers reserve terabytes\n";

std::atomic<bool> stopped = false;

extern "C" void on_signal(int) {
  stopped = true;
}

struct Options {
  fs::path program, keep;
  std::vector<fs::path> corpus;
  std::uint64_t seed = 1, first = 0, count = 1000;
  unsigned jobs = 1;
  Limits limits;
  bool small = false, print = false;
};

Options parse(int argc, char** argv) {
  Options o;
  const auto number = [](const std::string& s) { return std::stoull(s); };
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    if (name == "--minimise" || name == "--print") {
      (name == "--print" ? o.print : o.small) = true;
      continue;
    }
    if (i + 1 >= argc) throw std::invalid_argument(name + ": a value is missing");
    const std::string value = argv[++i];
    if (name == "--program")
      o.program = fs::absolute(value);
    else if (name == "--corpus")
      o.corpus.emplace_back(value);
    else if (name == "--keep")
      o.keep = value;
    else if (name == "--seed")
      o.seed = number(value);
    else if (name == "--first")
      o.first = number(value);
    else if (name == "--count")
      o.count = number(value);
    else if (name == "--jobs")
      o.jobs = static_cast<unsigned>(std::max(1ull, number(value)));
    else if (name == "--seconds")
      o.limits.seconds = std::stod(value);
    else if (name == "--grace")
      o.limits.grace = std::stod(value);
    else if (name == "--memory-gb")
      o.limits.memory_gb = std::stod(value);
    else
      throw std::invalid_argument("unknown option " + name);
  }
  if (o.program.empty() || o.corpus.empty()) throw std::invalid_argument("--program and --corpus are needed");
  return o;
}

void write_input(const Input& input, const fs::path& folder) {
  fs::create_directories(folder);
  std::ofstream arguments(folder / "arguments");
  for (const std::string& a : input.arguments) arguments << a << '\n';
  for (const auto& [name, bytes] : input.files) std::ofstream(folder / name, std::ios::binary) << bytes;
}

std::string in_words(const Input& input) {
  std::string out = "kerf";
  for (const std::string& a : input.arguments) out += " '" + a + "'";
  out += "    # from " + input.from + '\n';
  for (const auto& [name, bytes] : input.files) out += "--- " + name + '\n' + bytes + '\n';
  return out;
}

/// What all jobs share.
struct Campaign {
  const Options& options;
  const Corpus& corpus;
  fs::path work;
  std::atomic<std::uint64_t> next = 0, slow = 0;
  std::mutex lock;
  std::map<int, std::uint64_t> codes;
  std::map<std::string, std::uint64_t> failures;
  double seconds = 0;
  std::string broken_off;  // why the fuzzer itself cannot go on
};

void report(Campaign& c, std::uint64_t number, const Input& input, const Failure& failure, const fs::path& work) {
  const Options& o = c.options;
  Input small = input;
  if (o.small)
    small = minimise(input, [&](const Input& i) {
      const auto again = broken(i, run_child(o.program, i, o.limits, work));
      return again && again->kind == failure.kind;
    });
  const std::lock_guard guard(c.lock);
  ++c.failures[failure.kind];
  std::cout << fmt::format("FAILED  --seed {} --first {} --count 1   {}: {}   ({} {}, from {})\n", o.seed, number,
                           failure.kind, failure.detail, "kerf", input.arguments.empty() ? "" : input.arguments[0],
                           input.from)
            << std::flush;
  if (o.small) std::cout << in_words(small) << std::flush;
  if (!o.keep.empty()) write_input(small, o.keep / fmt::format("{}_{}", o.seed, number));
}

void work_off(Campaign& c, unsigned job) {
  const Options& o = c.options;
  const fs::path work = c.work / fmt::format("{}", job);
  try {
    for (std::uint64_t i; !stopped && (i = c.next++) < o.count;) {
      const std::uint64_t number = o.first + i;
      const Input input = make_input(c.corpus, o.seed, number);
      if (o.print) std::cout << in_words(input);
      const Outcome outcome = run_child(o.program, input, o.limits, work);
      if (o.print)
        std::cout << fmt::format("--- exit {} signal {} in {:.2f} s, {:.0f} MB\n{}{}", outcome.code, outcome.signal,
                                 outcome.seconds, outcome.memory_mb, outcome.out, outcome.error);
      if (const auto failure = broken(input, outcome)) report(c, number, input, *failure, work);
      const std::lock_guard guard(c.lock);
      ++c.codes[outcome.signal != 0 ? -outcome.signal : outcome.code];
      c.seconds += outcome.seconds;
      if (outcome.asked) {
        ++c.slow;
        std::cout << fmt::format("slow    --seed {} --first {} --count 1   stopped after {:.0f} s (kerf {}, from {})\n",
                                 o.seed, number, outcome.seconds, input.arguments[0], input.from)
                  << std::flush;
      }
    }
  } catch (const std::exception& e) {
    const std::lock_guard guard(c.lock);
    c.broken_off = e.what();
  }
}

int fuzz(const Options& o) {
  const Corpus corpus = read_corpus(o.corpus);
  std::string name = (fs::temp_directory_path() / "kerf-fuzz-XXXXXX").string();
  if (!mkdtemp(name.data())) throw std::runtime_error("cannot make a folder in " + fs::temp_directory_path().string());
  Campaign c{.options = o, .corpus = corpus, .work = name};
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, on_signal);  // say what was found so far
  std::vector<std::thread> jobs;
  for (unsigned j = 0; j < o.jobs; ++j) jobs.emplace_back([&c, j] { work_off(c, j); });
  for (std::thread& j : jobs) j.join();
  std::error_code ignored;
  fs::remove_all(c.work, ignored);
  if (!c.broken_off.empty()) throw std::runtime_error(c.broken_off);
  std::uint64_t failed = 0, tried = 0;
  std::string endings;
  for (const auto& [code, count] : c.codes) {
    tried += count;
    endings += fmt::format(", {} {}: {}", code < 0 ? "signal" : "exit", std::abs(code), count);
  }
  std::cout << fmt::format("{} inputs of seed {} from {} case files, {:.0f} s of processor time{}; slow: {}\n", tried,
                           o.seed, corpus.size(), c.seconds, endings, c.slow.load());
  for (const auto& [kind, count] : c.failures) {
    failed += count;
    std::cout << fmt::format("  {} x {}\n", count, kind);
  }
  return failed == 0 ? 0 : 1;
}

}  // namespace

}  // namespace kerf::fuzz

int main(int argc, char** argv) {
  try {
    return kerf::fuzz::fuzz(kerf::fuzz::parse(argc, argv));
  } catch (const std::invalid_argument& e) {
    std::cerr << "kerf-fuzz: " << e.what() << '\n' << kerf::fuzz::usage;
    return 2;
  } catch (const std::exception& e) {
    std::cerr << "kerf-fuzz: " << e.what() << '\n';
    return 2;
  }
}
