// Files as a whole: written beside the old one and renamed (write_whole_file), read with a limit. Reading refuses
// folders, devices and pipes, and does not wait for a pipe without a writer; the limit holds for what is read, too,
// since files of /proc say that they are empty. FolderLock is an exclusive flock on the folder of a run: it ends with
// the process, however that ends. A file system that cannot lock gives none, and the run goes on.

#include "io/files.hpp"

#include "kerf/types.hpp"

#include <fmt/core.h>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace kerf {

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

std::string read_file(const std::filesystem::path& path, std::uintmax_t most) {
  WholeFile file = read_whole_file(path, most);
  if (file.refusal != WholeFile::Refusal::None)
    throw Error(Fault::Files, fmt::format("cannot read '{}': {}", path.string(), in_words(file, most)));
  return std::move(file.bytes);
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
