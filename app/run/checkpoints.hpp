#pragma once
// What a run that was cut short goes on from: the checkpoints in its folder.

#include "kerf/growth.hpp"
#include "optimize/checkpoint.hpp"

namespace kerf {

/// Of an optimization, and of growth.
std::filesystem::path checkpoint_file(const std::filesystem::path& folder);
std::filesystem::path growth_checkpoint_file(const std::filesystem::path& folder);

/// Whether there is something to resume.
bool has_checkpoint(const std::filesystem::path& folder);
/// Throws Error(Usage) when the folder holds a checkpoint of another case, Error(Files) when one cannot be read.
void check_checkpoint(const std::filesystem::path& folder, const std::string& fingerprint);

/// Without a fingerprint.
Checkpoint as_checkpoint(const growth::GrowthRecord& record);
/// Throws Error(Files) where it is not what as_checkpoint makes.
growth::GrowthRecord growth_record(const Checkpoint& checkpoint);

}  // namespace kerf
