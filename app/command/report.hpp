#pragma once
// report.html from the files of a run.

#include <filesystem>

namespace kerf {

/// The page of a folder: from result.json, report.bin, case.toml, history.csv and crack_<name>.csv; what is not there,
/// but for result.json, is not on the page. Throws Error(Files).
void write_report(const std::filesystem::path& folder);

}  // namespace kerf
