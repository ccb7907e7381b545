// Files that appear complete or not at all: written under "<name>.part", flushed if asked, and renamed over the old
// file, which POSIX does in one step. Names are walked folder by folder with openat and O_NOFOLLOW, so that a link that
// somebody puts on the way is an error (ENOTDIR) and never followed; O_EXCL makes the new file one that nobody else has
// open. With Flush::Disk the folder is flushed, too: without that a rename may be lost in a power cut. Functions return
// 0 or errno; on an error the part is removed and the old file stays.

#include "base/whole_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <utility>

namespace kerf {

namespace {

namespace fs = std::filesystem;

/// An open file or folder; below 0 -errno.
/// A descriptor or, below 0, -errno of the call that failed; release hands it on.
class Opened {
 public:
  explicit Opened(int number) : number_(number < 0 ? -errno : number) {}
  Opened(Opened&& other) noexcept : number_(other.release()) {}
  Opened& operator=(Opened&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Opened() {
    if (number_ >= 0) close(number_);
  }
  int number() const {
    return number_;
  }
  int release() {
    return std::exchange(number_, -EBADF);
  }

 private:
  int number_;
};

constexpr int folder_flags = O_PATH | O_DIRECTORY | O_CLOEXEC;

/// The folder of that name beneath another one.
Opened folder_beneath(const fs::path& folder, const fs::path& name) {
  Opened at(open(folder.empty() ? "." : folder.c_str(), folder_flags));
  for (const fs::path& part : name) {
    if (at.number() < 0) break;
    if (part == ".." || part.is_absolute()) {
      errno = EINVAL;
      return Opened(-1);
    }
    if (part.empty() || part == ".") continue;
    const bool made = mkdirat(at.number(), part.c_str(), 0777) == 0;
    at = made || errno == EEXIST ? Opened(openat(at.number(), part.c_str(), folder_flags | O_NOFOLLOW)) : Opened(-1);
  }
  return at;
}

/// A new file under this name.
Opened new_at(const Opened& folder, const fs::path& name) {
  const auto make = [&] {
    return openat(folder.number(), name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  };
  int file = make();
  if (file < 0 && errno == EEXIST && unlinkat(folder.number(), name.c_str(), 0) == 0) file = make();
  return Opened(file);
}

/// A pipe or a full disk may take less than was given; 0 bytes without an error would never end.
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
int flush_folder(const Opened& folder) {
  const Opened names(openat(folder.number(), ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (names.number() < 0) return 0;
  return fsync(names.number()) == 0 || errno == EINVAL || errno == EROFS ? 0 : errno;
}

}  // namespace

int write_whole_file(const fs::path& path, std::string_view bytes, Flush flush) {
  return write_whole_file(path.parent_path(), path.filename(), bytes, flush);
}

int write_whole_file(const fs::path& folder, const fs::path& name, std::string_view bytes, Flush flush) {
  const Opened in = folder_beneath(folder, name.parent_path());
  if (in.number() < 0) return -in.number();
  const fs::path last = name.filename();
  fs::path part = last;
  part += ".part";
  Opened file = new_at(in, part);
  if (file.number() < 0) return -file.number();
  int problem = write_all(file.number(), bytes);
  if (problem == 0 && flush == Flush::Disk && fsync(file.number()) != 0) problem = errno;
  // A full disk may show only here.
  if (close(file.release()) != 0 && problem == 0) problem = errno;
  if (problem == 0 && renameat(in.number(), part.c_str(), in.number(), last.c_str()) != 0) problem = errno;
  if (problem != 0)
    unlinkat(in.number(), part.c_str(), 0);
  else if (flush == Flush::Disk)
    problem = flush_folder(in);
  return problem;
}

int make_folder_beneath(const fs::path& folder, const fs::path& name) {
  const Opened made = folder_beneath(folder, name);
  return made.number() < 0 ? -made.number() : 0;
}

int new_file(const fs::path& folder, const fs::path& name) {
  const Opened in = folder_beneath(folder, name.parent_path());
  return in.number() < 0 ? in.number() : new_at(in, name.filename()).release();
}

}  // namespace kerf
