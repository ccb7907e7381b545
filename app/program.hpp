#pragma once
// What kerf and kerf-bench share: messages and exit codes, Ctrl-C, the folder for results.

#include "io/files.hpp"

#include <filesystem>
#include <span>
#include <string>

namespace kerf {

inline constexpr const char* exit_codes =
    "Exit codes: 0 done, 2 wrong usage or case file, 3 invalid geometry, 4 not solved, 5 files.";

/// `work`, and one line on stderr for whatever it throws. Returns the exit code of the process.
int run_program(int (*work)(int argc, char** argv), int argc, char** argv);

/// The first SIGINT, SIGTERM or SIGHUP (unless that is ignored, as by nohup) asks for a clean stop (kerf/stop.hpp), the
/// second one ends the process. A file that grows beyond the limit (ulimit -f) is an error of writing it, not a signal.
void catch_signals();

/// What was typed, on one line, with quotes where a shell needs them.
std::string command_line(int argc, const char* const* argv);

/// To stdout. Throws Error(Files).
void print(const std::string& text);

/// Throws Error(Usage): what the parser of the arguments has to say about those of `command` ("bench ", or nothing).
[[noreturn]] void refuse_arguments(std::string message, const std::string& command);
/// Throws Error(Usage) unless `name`, a `what`, is one of those that are known.
void require_known(const char* what, const std::string& name, std::span<const std::string> known);

/// "info", or "warn" when quiet, unless a level was asked for.
std::string log_level(const std::string& asked, bool quiet);

/// Throws Error(Files) when another run has the folder, or it holds the result already, unless that may be overwritten:
/// then it goes.
void make_ready(const std::filesystem::path& folder, bool force, const std::string& result, FolderLock& lock);

}  // namespace kerf
