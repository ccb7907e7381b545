#pragma once
// Everything a loop needs to go on as if it had never stopped.

#include "base/whole_file.hpp"
#include "kerf/optimize.hpp"

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace kerf {

/// Named numbers and texts. `fingerprint` says which case they belong to.
struct Checkpoint {
  std::string fingerprint;
  std::map<std::string, Eigen::VectorXd> numbers;
  std::map<std::string, std::string> texts;
};

/// Binary, with a checksum; written to a temporary file beside it, flushed to disk if asked for and renamed: after a
/// kill at any moment the file is the old or the new one. Throws Error(Files).
void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint, Flush flush = Flush::Disk);

/// At the place, by who writes there.
void keep(const CheckpointPlace& place, Checkpoint checkpoint);

/// Nothing when there is no file. Throws Error(Files) when it cannot be read or its checksum is wrong.
std::optional<Checkpoint> read_checkpoint(const std::filesystem::path& path);

/// FNV-1a, 64 bits: every step is a bijection of the sum, so that no change of a single byte goes unseen.
std::uint64_t checksum(std::string_view bytes);

}  // namespace kerf
