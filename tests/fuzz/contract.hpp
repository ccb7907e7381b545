#pragma once
// What the program promises for every input.

#include "tests/fuzz/child.hpp"

#include <optional>
#include <string>

namespace kerf::fuzz {

struct Failure {
  std::string kind;    // the same for the same fault: what a minimiser keeps
  std::string detail;  // one line
};

/// The first promise that was broken.
std::optional<Failure> broken(const Input& input, const Outcome& outcome);

}  // namespace kerf::fuzz
