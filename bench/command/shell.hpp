#pragma once
// Other programs as child processes.

#include <filesystem>
#include <string>

namespace kerf {

inline constexpr const char* freefem = "FreeFem++";
inline constexpr const char* python = "/usr/bin/python3";  // the packages belong to the system's interpreter

bool in_path(const std::string& program);

struct Outcome {
  int code = -1;
  std::string output;
  double memory_mb = 0;  // largest resident memory of one of its processes
  double seconds = 0;    // processor seconds of all of them
};

/// By /bin/sh; waits for its end.
Outcome shell(const std::string& command);

/// In `folder` on one thread, ended after `limit` seconds (code 124 or 137); both outputs together.
Outcome run_script(const std::filesystem::path& folder, const std::string& command, double limit);

/// The scripts write beside themselves: they run in a copy, with the reference data unpacked. Throws Error(Files).
void copy_scripts(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace kerf
