#pragma once
// report.html from the files of a run, compare.html from those of two.

#include <filesystem>

namespace kerf {

/// Throws Error(Files) for a folder without result.json, with what to give instead.
void require_result(const std::filesystem::path& folder);

/// The page of a folder: from result.json, report.bin, case.toml, history.csv and crack_<name>.csv; what is not there,
/// but for result.json, is not on the page. Throws Error(Files).
void write_report(const std::filesystem::path& folder);

/// Two runs side by side: keys of their cases and quantities of their results that differ, and their pictures, which
/// the page names relative to where it lies. Throws Error(Files).
void write_comparison(const std::filesystem::path& a, const std::filesystem::path& b,
                      const std::filesystem::path& page);

}  // namespace kerf
