// Named arrays of 32-bit numbers in one file: a first line, a line "name type width rows" per array, an empty line,
// then the values one array after the other as they lie in memory (little endian). A reader of the head knows where
// each array begins. Sizes are compared with the bytes that are left before memory is taken for them, and the file must
// end with the last array. The page draws from these arrays (plot/page).

#include "io/arrays.hpp"

#include "io/files.hpp"
#include "kerf/types.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>

namespace kerf {

static_assert(std::endian::native == std::endian::little);

namespace {

constexpr std::string_view first_line = "kerf arrays 1\n";

/// What is left of a file, taken from its front.
struct Rest {
  std::string_view text;
  const std::filesystem::path& path;

  [[noreturn]] void refuse() const {
    throw Error(Fault::Files, fmt::format("{} is damaged, or no file of arrays that kerf has written", path.string()));
  }
  std::string_view until(char end) {
    const std::size_t at = text.find(end);
    if (at == std::string_view::npos) refuse();
    const std::string_view out = text.substr(0, at);
    text.remove_prefix(at + 1);
    return out;
  }
  template <typename T>
  void fill(std::vector<T>& values, std::size_t count) {
    if (count > text.size() / sizeof(T)) refuse();
    values.resize(count);
    if (count > 0) std::memcpy(values.data(), text.data(), count * sizeof(T));
    text.remove_prefix(count * sizeof(T));
  }
  std::size_t number(std::string_view digits) const {
    std::size_t out = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), out);
    if (error != std::errc() || end != digits.data() + digits.size() || out > (std::size_t{1} << 40)) refuse();
    return out;
  }
};

template <typename T>
void append(std::string& out, const std::vector<T>& values) {
  out.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

}  // namespace

const NamedArray* find_array(std::span<const NamedArray> arrays, std::string_view name) {
  const auto found = std::find_if(arrays.begin(), arrays.end(), [&](const NamedArray& a) { return a.name == name; });
  return found == arrays.end() ? nullptr : &*found;
}

void write_arrays(const std::filesystem::path& path, std::span<const NamedArray> arrays) {
  std::string out(first_line);
  for (const NamedArray& a : arrays)
    out += fmt::format("{} {} {} {}\n", a.name, a.is_indices() ? "u32" : "f32", a.width, a.rows());
  out += '\n';
  for (const NamedArray& a : arrays) {
    append(out, a.numbers);
    if (a.is_indices()) append(out, a.indices);
  }
  write_file(path, out);
}

std::vector<NamedArray> read_arrays(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  Rest rest{bytes, path};
  if (!rest.text.starts_with(first_line)) rest.refuse();
  rest.text.remove_prefix(first_line.size());
  struct Head {
    bool indices;
    std::size_t count;
  };
  std::vector<NamedArray> out;
  std::vector<Head> heads;
  while (true) {
    Rest line{rest.until('\n'), path};
    if (line.text.empty()) break;
    NamedArray a;
    a.name = std::string(line.until(' '));
    const std::string_view type = line.until(' ');
    if (type != "f32" && type != "u32") rest.refuse();
    a.width = rest.number(line.until(' '));
    const std::size_t rows = rest.number(line.text);
    if (a.width == 0 || a.width > 64 || a.name.empty()) rest.refuse();
    heads.push_back({type == "u32", a.width * rows});
    out.push_back(std::move(a));
  }
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (heads[i].indices)
      rest.fill(out[i].indices, heads[i].count);
    else
      rest.fill(out[i].numbers, heads[i].count);
  }
  if (!rest.text.empty()) rest.refuse();
  return out;
}

}  // namespace kerf
