#include "io/files.hpp"

#include "kerf/types.hpp"

#include <fmt/core.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

namespace kerf {

namespace {

struct Close {
  void operator()(std::FILE* file) const {
    std::fclose(file);
  }
};
using File = std::unique_ptr<std::FILE, Close>;

}  // namespace

void write_file(const std::filesystem::path& path, std::string_view bytes) {
  const auto fail = [&](const std::string& reason) {
    return Error(Fault::Files, fmt::format("cannot write '{}': {}; choose a folder that exists and may be written to",
                                           path.string(), reason));
  };
  std::error_code code;
  if (std::filesystem::is_directory(path, code)) throw fail("it is a folder");
  std::filesystem::path part = path;
  part += ".part";
  File file(std::fopen(part.c_str(), "wb"));
  if (!file) throw fail(std::strerror(errno));
  // A full disk may show only when the buffer is flushed: the result of closing counts, too.
  bool good = std::fwrite(bytes.data(), 1, bytes.size(), file.get()) == bytes.size();
  int reason = errno;
  if (std::fclose(file.release()) != 0) {
    if (good) reason = errno;
    good = false;
  }
  if (!good) {
    std::filesystem::remove(part, code);
    throw fail(std::strerror(reason));
  }
  std::filesystem::rename(part, path, code);
  if (code) {
    const std::string message = code.message();
    std::filesystem::remove(part, code);
    throw fail(message);
  }
}

std::string read_file(const std::filesystem::path& path) {
  const auto fail = [&](const std::string& reason) {
    return Error(Fault::Files, fmt::format("cannot read '{}': {}", path.string(), reason));
  };
  std::error_code code;
  if (std::filesystem::is_directory(path, code)) throw fail("it is a folder");
  const File file(std::fopen(path.c_str(), "rb"));
  if (!file) throw fail(std::strerror(errno));
  std::string bytes;
  char block[1 << 16];
  std::size_t count;
  while ((count = std::fread(block, 1, sizeof block, file.get())) > 0) bytes.append(block, count);
  if (std::ferror(file.get())) throw fail(std::strerror(errno));
  return bytes;
}

}  // namespace kerf
