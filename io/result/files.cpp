#include "io/files.hpp"

#include "kerf/types.hpp"

#include <fmt/core.h>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>
#include <utility>

namespace kerf {

namespace {

struct Close {
  void operator()(std::FILE* file) const {
    std::fclose(file);
  }
};
using File = std::unique_ptr<std::FILE, Close>;

}  // namespace

namespace {

Error cannot_write(const std::filesystem::path& path, int problem) {
  if (problem == ENOTDIR)
    return Error(Fault::Files, fmt::format("cannot write '{}': what its folder is called is a link or no folder; take "
                                           "it away, or choose another folder",
                                           path.string()));
  return Error(Fault::Files, fmt::format("cannot write '{}': {}; choose a folder that exists and may be written to",
                                         path.string(), std::strerror(problem)));
}

}  // namespace

void write_file(const std::filesystem::path& path, std::string_view bytes, Flush flush) {
  if (const int problem = write_whole_file(path, bytes, flush)) throw cannot_write(path, problem);
}

void write_file(const std::filesystem::path& folder, const std::filesystem::path& name, std::string_view bytes) {
  if (const int problem = write_whole_file(folder, name, bytes, Flush::Buffers))
    throw cannot_write(folder / name, problem);
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

FolderLock::~FolderLock() {
  if (folder_ >= 0) close(folder_);
}

void FolderLock::take(const std::filesystem::path& folder) {
  if (folder_ >= 0) return;
  folder_ = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder_ < 0) return;  // not there, or not to be read: writing will tell
  if (flock(folder_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;  // not every file system can
  close(std::exchange(folder_, -1));
  throw Error(Fault::Files, fmt::format("another kerf is writing into '{}'; wait until it is done, or choose another "
                                        "folder with --output",
                                        folder.string()));
}

}  // namespace kerf
