#pragma once
// Scenes written as case files, run as a user runs them: what the program says, to be compared with truths that do not
// come from its own formulas.

#include "app/run.hpp"
#include "tests/support/folder.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace kerf {

/// A folder of its own per test, gone afterwards.
class Truth : public test::InFolder {
 protected:
  /// result.json of the case `text` (TOML, no output but the numbers) with `overrides` as --set gives them.
  nlohmann::json run_scene(const std::string& text, Job job = Job::Solve,
                           const std::vector<std::string>& overrides = {}) {
    const std::filesystem::path file = folder / "scene.toml";
    std::ofstream(file) << text << "\n[output]\nvtk = false\npng = false\nhtml = false\n";
    run(read_case(file, overrides), job, {.folder = folder / "out", .threads = 2});
    std::ifstream result(folder / "out" / "result.json");
    return nlohmann::json::parse(result);
  }
};

}  // namespace kerf
