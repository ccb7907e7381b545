#include "base/read_whole_file.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace kerf {

namespace {

/// A file that is open to be read, closed at the end.
class Readable {
 public:
  explicit Readable(const std::filesystem::path& path)
      : number_(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY)) {}
  Readable(const Readable&) = delete;
  Readable& operator=(const Readable&) = delete;
  ~Readable() {
    if (number_ >= 0) close(number_);
  }
  int number() const {
    return number_;
  }

 private:
  int number_;
};

}  // namespace

WholeFile read_whole_file(const std::filesystem::path& path, std::uintmax_t most) {
  using enum WholeFile::Refusal;
  const auto system = [] { return WholeFile{errno == ENOENT || errno == ENOTDIR ? Missing : System, errno}; };
  const Readable file(path);
  struct stat status;
  if (file.number() < 0 || fstat(file.number(), &status) != 0) return system();
  if (S_ISDIR(status.st_mode)) return {Folder};
  if (!S_ISREG(status.st_mode)) return {Special};
  if (static_cast<std::uintmax_t>(status.st_size) > most) return {TooLarge};
  WholeFile out;
  out.bytes.reserve(static_cast<std::size_t>(status.st_size));
  char block[1 << 16];
  for (ssize_t count; (count = read(file.number(), block, sizeof block)) != 0;) {
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return {System, errno};
    out.bytes.append(block, static_cast<std::size_t>(count));
    if (out.bytes.size() > most) return {TooLarge};  // files of /proc say that they are empty
  }
  return out;
}

std::string in_words(const WholeFile& file, std::uintmax_t most) {
  switch (file.refusal) {
    case WholeFile::Refusal::None:
      return {};
    case WholeFile::Refusal::Missing:
    case WholeFile::Refusal::System:
      return std::strerror(file.problem);
    case WholeFile::Refusal::Folder:
      return "it is a folder";
    case WholeFile::Refusal::Special:
      return "it is no regular file";
    case WholeFile::Refusal::TooLarge:
      return fmt::format("it is too large; at most {} MiB are read", most >> 20);
  }
  return {};
}

}  // namespace kerf
