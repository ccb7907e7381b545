#pragma once
// The program as a child with limits.

#include "tests/fuzz/input.hpp"

#include <filesystem>
#include <map>
#include <string>

namespace kerf::fuzz {

struct Limits {
  double seconds = 10;   // of processor time; then it is asked to stop
  double grace = 10;     // and must have done so within these
  double memory_gb = 3;  // of address space; 0: any, as sanitizers need
  double file_mb = 200;  // per file
};

struct Outcome {
  int code = -1;       // of exit
  int signal = 0;      // that ended it
  bool asked = false;  // to stop, because it took long
  bool hung = false;   // it did not, and was killed
  double seconds = 0;  // processor time
  double memory_mb = 0;
  std::string out, error;
  std::map<std::string, std::string> files;  // that were not there before or differ, with paths from its folder
  std::vector<std::string> elsewhere;        // in its home and its folder for temporary files
};

/// Runs the program on the input in a folder of its own below `work`, which is empty again afterwards. Throws
/// std::runtime_error when that cannot be done.
Outcome run_child(const std::filesystem::path& program, const Input& input, const Limits& limits,
                  const std::filesystem::path& work);

}  // namespace kerf::fuzz
