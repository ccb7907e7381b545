#pragma once
// Arrays with names in one file: what a page draws, and what NumPy reads in a few lines.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace kerf {

/// Rows of `width` numbers: floats, or, where there are none, indices.
struct NamedArray {
  std::string name;  // no blanks
  std::size_t width = 1;
  std::vector<float> numbers = {};
  std::vector<std::uint32_t> indices = {};

  bool is_indices() const {
    return numbers.empty();
  }
  std::size_t rows() const {
    return (is_indices() ? indices.size() : numbers.size()) / width;
  }
};

/// Nothing when there is none of that name.
const NamedArray* find_array(std::span<const NamedArray> arrays, std::string_view name);

/// Text: "kerf arrays 1", a line "name f32|u32 width rows" for each, an empty line; then the numbers of all, in that
/// order, little-endian.
void write_arrays(const std::filesystem::path& path, std::span<const NamedArray> arrays);

/// Throws Error(Files) naming the path: cannot be read, or is no such file.
std::vector<NamedArray> read_arrays(const std::filesystem::path& path);

}  // namespace kerf
