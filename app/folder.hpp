#pragma once
// The folder of a run.

#include "io/files.hpp"

#include <filesystem>

namespace kerf {

/// With this begins the case.toml of every run, before the version.
inline constexpr const char* head_of_results = "The case of these results, as kerf ";

/// What an earlier run left under the names of the interface: a stale map beside a new state would mislead. But for
/// what an optimization goes on from when it is resumed. Throws Error(Files), also where no run of kerf left it.
void remove_earlier_results(const std::filesystem::path& folder, bool resume);

/// Takes the lock of a folder for a run. Throws Error(Files) where it is none, where results would replace files that
/// no run of kerf wrote, and without `force` where there are results; an optimization that has not
/// ended may be resumed.
void claim_folder(const std::filesystem::path& folder, bool force, bool resume, FolderLock& lock);

}  // namespace kerf
