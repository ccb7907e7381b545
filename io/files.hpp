#pragma once
// Whole files at once. A file appears under its name complete or not at all.

#include "base/read_whole_file.hpp"
#include "base/whole_file.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace kerf {

/// Through a temporary file beside `path` that is renamed. Throws Error(Files) naming the path and the reason.
void write_file(const std::filesystem::path& path, std::string_view bytes, Flush flush = Flush::Buffers);

/// The same of a name beneath a folder, whose own folders are made where they are missing and may be no links.
void write_file(const std::filesystem::path& folder, const std::filesystem::path& name, std::string_view bytes);

/// As read_whole_file(). Throws Error(Files) naming the path and the reason.
std::string read_file(const std::filesystem::path& path, std::uintmax_t most = largest_input);

/// One run at a time in a folder: held until the end of its life or of the process, however that ends; leaves nothing
/// behind.
class FolderLock {
 public:
  FolderLock() = default;
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock();
  /// Does nothing when it is held already, or there is no such folder. Throws Error(Files) when another run has it.
  void take(const std::filesystem::path& folder);

 private:
  int folder_ = -1;
};

}  // namespace kerf
