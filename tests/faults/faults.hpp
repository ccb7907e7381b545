#pragma once
// The program as a child under faults: what it must leave, and what it may.

#include "tests/fuzz/contract.hpp"
#include "tests/support/folder.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace kerf::fuzz {

/// A folder of its own per test, gone afterwards.
class Faults : public test::InFolder {
 protected:
  /// `kerf ARGUMENTS` on this case file, one thread, results in out, no log.
  static Input input(const std::string& command, const std::string& text, const std::vector<std::string>& more = {});
  Outcome run(const Input& input, const Limits& limits = {.seconds = 60, .memory_gb = 0}) const;
};

/// A small plate with a crack, a map, a validation and an optimization, without pictures.
std::string small_case();
/// The same with all files.
std::string small_case_with_files();

/// result.json without times and memory; null when there is none or it is no JSON.
nlohmann::json numbers_of(const Outcome& outcome);

/// Why the run under a fault is no clean one; empty: it is. Clean is an exit code that says what failed, one message,
/// no result that says ok, no *.part; or what the run without faults left, bit for bit.
std::string unclean(const Input& input, const Outcome& outcome, const Outcome& whole);

}  // namespace kerf::fuzz
