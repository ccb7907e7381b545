#pragma once
// Whole files, read at once: regular files of bounded size, which are opened before they are looked at, so that nobody
// can put another one in their place between the two.

#include <cstdint>
#include <filesystem>
#include <string>

namespace kerf {

/// The largest file that is read whole: the text of a mesh of 20 million triangles takes about half of it.
inline constexpr std::uintmax_t largest_input = std::uintmax_t{4} << 30;

/// What is in a file, or why it was not read.
struct WholeFile {
  enum class Refusal { None, Missing, System, Folder, Special, TooLarge } refusal = Refusal::None;
  int problem = 0;  // of System, as errno says it
  std::string bytes = {};
};

/// A pipe or a device, which may never end, is not waited for (Special), nor is more than `most` bytes kept.
WholeFile read_whole_file(const std::filesystem::path& path, std::uintmax_t most = largest_input);

/// In words: "it is a folder". Nothing for what was read.
std::string in_words(const WholeFile& file, std::uintmax_t most = largest_input);

}  // namespace kerf
