#pragma once
// What every reader promises of any bytes: a value, or an Error that is a sentence. Never another exception, a signal
// or undefined behaviour; never more than 10 seconds or 1 GB (libFuzzer's limits, tests/fuzz/parsers.sh).

#include "kerf/types.hpp"

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace kerf::parsers {

[[noreturn]] inline void broken(const char* what, const char* said) {
  std::fprintf(stderr, "broken promise: %s: %s\n", what, said);
  std::abort();
}

/// Runs what reads.
template <typename Read>
void promise(const Read& read) {
  try {
    read();
  } catch (const Error& error) {
    const std::string_view said = error.what();
    if (said.size() < 16) broken("a message that says nothing", error.what());
    for (const char c : said)  // no bytes of a file that a terminal would obey
      if ((c >= 0 && c < 32 && c != '\n') || c == 127) broken("a control character in a message", error.what());
  } catch (const std::exception& other) {
    broken("an exception that is no Error", other.what());
  }
}

inline void require(bool holds, const char* what) {
  if (!holds) broken(what, "does not hold");
}

/// A folder of this process, gone at its end.
class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "kerf-parser-XXXXXX").string();
    if (!mkdtemp(name.data())) broken("no folder", name.c_str());
    path = name;
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  std::filesystem::path put(const char* name, std::string_view bytes) const {
    std::ofstream(path / name, std::ios::binary) << bytes;
    return path / name;
  }
  std::filesystem::path path;
};

/// The next part of an input that stands for several files, which lines "%%" divide.
inline std::string_view next_part(std::string_view& rest) {
  constexpr std::string_view divider = "\n%%\n";
  const std::size_t end = std::min(rest.find(divider), rest.size());
  const std::string_view part = rest.substr(0, end);
  rest.remove_prefix(std::min(end + divider.size(), rest.size()));
  return part;
}

inline std::string_view text(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

}  // namespace kerf::parsers
