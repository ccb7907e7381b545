#pragma once
// The program as a traced child: one call of the system fails, whoever makes it.

#include "tests/faults/faults.hpp"

#include <optional>
#include <string>
#include <vector>

namespace kerf::fuzz {

/// A call that concerns a file of the run: "openat out/map.csv.part".
struct FileCall {
  std::string name, path;
  friend bool operator==(const FileCall&, const FileCall&) = default;
};

struct Traced {
  Outcome outcome;
  std::vector<FileCall>
      calls;  // to make, write, close, flush, rename files below the folder of the run, and to read there
};

/// Runs the input with ptrace(2); call `failing` of those (from 0) fails with that error number. nullopt: this system
/// lets nobody trace.
std::optional<Traced> run_traced(const std::filesystem::path& work, const Input& input,
                                 std::optional<std::size_t> failing, int error);

}  // namespace kerf::fuzz
