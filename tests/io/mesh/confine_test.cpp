// What a script of gmsh may not do: the system refuses it. A filter holds for its thread, and for good.

#include "io/mesh/confine.hpp"

#include "tests/support/folder.hpp"

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <functional>
#include <thread>

namespace kerf::confine_test {
namespace {

/// What `call` ends with, a number of errno or 0, in a thread that is confined.
int confined(Confined what, const std::function<int()>& call) {
  int ended = -1;
  std::thread([&] {
    if (!confine(what)) return;
    errno = 0;
    const int result = call();
    ended = result < 0 ? errno : 0;
    if (result > 2) close(result);
  }).join();
  return ended;
}

TEST(Confine, FilesAreReadAndNotWritten) {
  const test::Folder folder;
  const std::string kept = folder.path / "kept", made = folder.path / "made";
  std::ofstream(kept) << "kept";
  const auto files = [&](const std::function<int()>& call) { return confined(Confined::Files, call); };
  EXPECT_EQ(files([&] { return open(kept.c_str(), O_RDONLY); }), 0);
  for (const int flags : {O_WRONLY, O_RDWR, O_RDONLY | O_TRUNC, O_WRONLY | O_APPEND})
    EXPECT_EQ(files([&] { return open(kept.c_str(), flags); }), EPERM) << flags;
  EXPECT_EQ(files([&] { return open(made.c_str(), O_WRONLY | O_CREAT, 0600); }), EPERM);
  EXPECT_EQ(files([&] { return creat(made.c_str(), 0600); }), EPERM);
  EXPECT_EQ(files([&] { return mkdir(made.c_str(), 0700); }), EPERM);
  EXPECT_EQ(files([&] { return symlink(kept.c_str(), made.c_str()); }), EPERM);
  EXPECT_EQ(files([&] { return link(kept.c_str(), made.c_str()); }), EPERM);
  EXPECT_EQ(files([&] { return rename(kept.c_str(), made.c_str()); }), EPERM);
  EXPECT_EQ(files([&] { return unlink(kept.c_str()); }), EPERM);
  EXPECT_EQ(files([&] { return rmdir(folder.path.c_str()); }), EPERM);
  EXPECT_EQ(files([&] { return chmod(kept.c_str(), 0); }), EPERM);
  EXPECT_EQ(files([&] { return truncate(kept.c_str(), 0); }), EPERM);
  EXPECT_EQ(files([&] { return mkfifo(made.c_str(), 0600); }), EPERM);
  EXPECT_FALSE(std::filesystem::exists(made));
  EXPECT_EQ(std::filesystem::file_size(kept), 4u);
}

TEST(Confine, ProgramsAreNotStartedAndOthersNotTouched) {
  const test::Folder folder;
  const std::string made = folder.path / "made";
  for (const Confined what : {Confined::Programs, Confined::Files}) {
    EXPECT_EQ(confined(what, [] { return execl("/bin/true", "true", nullptr); }), EPERM);
    EXPECT_EQ(confined(what, [] { return kill(getpid(), 0); }), EPERM);
    EXPECT_EQ(confined(what, [] { return socket(AF_INET, SOCK_STREAM, 0); }), EPERM);
    EXPECT_EQ(confined(what,
                       [] {
                         const pid_t child = fork();
                         if (child == 0) _exit(0);
                         return int(child);
                       }),
              EPERM);
    for (const long call : {long{SYS_chdir}, long{SYS_bpf}, long{SYS_io_uring_setup}, 999L})  // no system has 999
      EXPECT_EQ(confined(what, [&] { return int(syscall(call, 0, 0, 0)); }), EPERM) << call << ": only listed calls";
    EXPECT_EQ(confined(what, [] { return fcntl(1, F_SETOWN, getppid()); }), EPERM);
    // What a thread needs goes on.
    EXPECT_EQ(confined(what,
                       [] {
                         utsname name{};
                         std::thread([&] { uname(&name); }).join();
                         return name.sysname[0] == '\0' ? -1 : 0;
                       }),
              0);
  }
  EXPECT_EQ(confined(Confined::Programs, [&] { return open(made.c_str(), O_WRONLY | O_CREAT, 0600); }), 0);
  EXPECT_TRUE(std::filesystem::exists(made)) << "gmsh itself writes its mesh";
  EXPECT_EQ(kill(getpid(), 0), 0) << "the other threads are free";
}

}  // namespace
}  // namespace kerf::confine_test
