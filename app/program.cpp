#include "app/program.hpp"

#include "io/words.hpp"
#include "kerf/stop.hpp"
#include "kerf/types.hpp"

#include <fmt/format.h>

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <string_view>

namespace kerf {

namespace {

extern "C" void on_signal(int) {
  request_stop();
}

[[noreturn]] void end_with(std::string_view words) {
  [[maybe_unused]] const auto written = write(STDERR_FILENO, words.data(), words.size());
  _exit(static_cast<int>(Fault::Numerics));
}

constexpr std::string_view no_memory = "kerf: out of memory; use a coarser mesh (a larger mesh.size)\n";

/// Destructors of libraries that ask for memory, and do not get it, end the program; so would an exception that nobody
/// may catch.
[[noreturn]] void on_terminate() noexcept {
  try {
    if (const std::exception_ptr e = std::current_exception()) std::rethrow_exception(e);
  } catch (const std::bad_alloc&) {
    end_with(no_memory);
  } catch (...) {
  }
  end_with("kerf: unexpected failure\n");
}

bool returned = false;  // by the program, not by a library

/// OpenMP calls exit(1) when it gets no memory.
void on_exit() {
  if (!returned) end_with(no_memory);
}

}  // namespace

#if defined(__AVX2__) && defined(__x86_64__)
namespace {

/// Before anything else runs, with instructions that all processors have: one sentence instead of an illegal one.
__attribute__((constructor(101), target("arch=x86-64"))) void refuse_old_processors() {
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return;
  constexpr char words[] =
      "kerf: this processor lacks AVX2, which this kerf was built for; build it with KERF_ARCH=x86-64\n";
  [[maybe_unused]] const auto written = write(STDERR_FILENO, words, sizeof words - 1);
  _exit(static_cast<int>(Fault::Usage));
}

}  // namespace
#endif

int run_program(int (*work)(int argc, char** argv), int argc, char** argv) {
  std::set_terminate(on_terminate);
  std::atexit(on_exit);
  const auto code = [](int value) {
    returned = true;
    return value;
  };
  // No call here may throw: not for want of memory, not because stderr is closed.
  const auto report = [&](const char* before, const char* message, Fault fault) {
    std::fprintf(stderr, "kerf: %s%s\n", before, message);
    return code(static_cast<int>(fault));
  };
  try {
    return code(work(argc, argv));
  } catch (const Error& e) {
    return report("", e.what(), e.fault);
  } catch (const std::filesystem::filesystem_error& e) {
    return report("", e.what(), Fault::Files);
  } catch (const Stopped&) {
    return report("", "stopped", Fault::Numerics);
  } catch (const std::bad_alloc&) {
    return report("", "out of memory; use a coarser mesh (a larger mesh.size)", Fault::Numerics);
  } catch (const std::exception& e) {
    return report("unexpected failure: ", e.what(), Fault::Numerics);
  } catch (...) {
    return report("", "unexpected failure", Fault::Numerics);
  }
}

void catch_signals() {
  struct sigaction action = {};
  action.sa_handler = on_signal;
  action.sa_flags = SA_RESETHAND | SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

std::string command_line(int argc, const char* const* argv) {
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) || std::string_view("_-./=:,+@%").find(static_cast<char>(c)) != std::string_view::npos;
  };
  std::string line = argc > 0 ? std::filesystem::path(argv[0]).filename().string() : "kerf";
  for (int k = 1; k < argc; ++k) {
    std::string word;
    for (const char c : std::string_view(argv[k]))
      word += c == '\'' ? "'\\''" : std::string(1, static_cast<unsigned char>(c) < 32 ? ' ' : c);
    line += !word.empty() && std::all_of(word.begin(), word.end(), plain) ? " " + word : " '" + word + "'";
  }
  return line;
}

void print(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
    throw Error(Fault::Files, "cannot write to standard output");
}

void refuse_arguments(std::string message, const std::string& command) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  throw Error(Fault::Usage, fmt::format("{}; see kerf {}--help", message, command));
}

void require_known(const char* what, const std::string& name, std::span<const std::string> known) {
  if (std::find(known.begin(), known.end(), name) == known.end())
    throw Error(Fault::Usage, fmt::format("unknown {} {}; {}", what, quote(name), suggest(name, known)));
}

std::string log_level(const std::string& asked, bool quiet) {
  return !asked.empty() ? asked : quiet ? "warn" : "info";
}

void make_ready(const std::filesystem::path& folder, bool force, const std::string& result) {
  const std::filesystem::path path = folder / result;
  if (std::filesystem::exists(folder) && !std::filesystem::is_directory(folder))
    throw Error(Fault::Files, fmt::format("{} is not a folder; choose another with --output", folder.string()));
  if (!std::filesystem::exists(std::filesystem::symlink_status(path))) return;
  if (!force)
    throw Error(Fault::Files, fmt::format("{} already holds results; use --force to overwrite", folder.string()));
  std::filesystem::remove(path);
}

}  // namespace kerf
