#pragma once
// What a quantity tends to as the mesh gets finer, from a sweep over three sizes.

#include "app/sweep/sweep_page.hpp"

namespace kerf {

/// Every number of the table on three meshes, each of half the size of the one before, for every combination of the
/// other keys whose three runs are there.
std::vector<Convergence> convergence_of(const SweepTable& table, const std::string& key);

void write_convergence(const std::filesystem::path& path, const std::vector<Convergence>& all);

/// Lines for the summary: at most twelve; a table for the page. Empty of none.
std::string in_words(const std::vector<Convergence>& all);
std::string convergence_table(const std::vector<Convergence>& all);

}  // namespace kerf
