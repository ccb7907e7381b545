#include "geometry/whole_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>

namespace kerf {

namespace {

int open_new(const std::filesystem::path& path) {
  return open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
}

int write_all(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t done = write(file, bytes.data(), bytes.size());
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) return errno;
    if (done == 0) return EIO;
    bytes.remove_prefix(static_cast<std::size_t>(done));
  }
  return 0;
}

/// A new name is on the disk when its folder is. A file system that cannot flush a folder says so.
int flush_folder(const std::filesystem::path& path) {
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  const int names = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (names < 0) return 0;
  const int problem = fsync(names) == 0 || errno == EINVAL || errno == EROFS ? 0 : errno;
  close(names);
  return problem;
}

}  // namespace

int write_whole_file(const std::filesystem::path& path, std::string_view bytes, Flush flush) {
  std::filesystem::path part = path;
  part += ".part";
  int file = open_new(part);
  if (file < 0 && errno == EEXIST && unlink(part.c_str()) == 0) file = open_new(part);
  if (file < 0) return errno;
  int problem = write_all(file, bytes);
  if (problem == 0 && flush == Flush::Disk && fsync(file) != 0) problem = errno;
  // A full disk may show only here.
  if (close(file) != 0 && problem == 0) problem = errno;
  if (problem == 0 && std::rename(part.c_str(), path.c_str()) != 0) problem = errno;
  if (problem != 0)
    unlink(part.c_str());
  else if (flush == Flush::Disk)
    problem = flush_folder(path);
  return problem;
}

}  // namespace kerf
