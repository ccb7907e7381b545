// The program under ptrace(2): a filter of seccomp(2) stops it at calls that open, read, write, flush, cut, close,
// rename, make or remove files. Those that concern the folder of the run are counted; the chosen one is not made
// (number -1) and returns the error.
// Linux on x86-64 alone; elsewhere nobody traces.

#include "tests/faults/traced.hpp"

#include <fcntl.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <fstream>

namespace kerf::fuzz {

namespace {

namespace fs = std::filesystem;

#if defined(__x86_64__)

/// The text at an address of the child.
std::string text_at(pid_t child, unsigned long long address) {
  std::string out;
  for (char block[64]; out.size() < 4096;) {
    const iovec here{block, sizeof block}, there{reinterpret_cast<void*>(address + out.size()), sizeof block};
    const ssize_t n = process_vm_readv(child, &here, 1, &there, 1, 0);
    if (n <= 0) return out;
    const std::string part(block, static_cast<std::size_t>(n));
    const std::size_t end = part.find('\0');
    out += part.substr(0, end);
    if (end != std::string::npos) return out;
  }
  return out;
}

std::string path_of(pid_t child, unsigned long long file) {
  std::error_code ignored;
  return fs::read_symlink(fs::path("/proc") / std::to_string(child) / "fd" / std::to_string(static_cast<int>(file)),
                          ignored)
      .string();
}

/// Without the folder that the child runs in; empty when it lies elsewhere.
std::string inside(const std::string& path, const std::string& folder) {
  if (path.empty() || path[0] != '/') return path;
  return path.starts_with(folder + "/") ? path.substr(folder.size() + 1) : "";
}

/// What the registers ask for, when it concerns a file of the run.
std::optional<FileCall> call_of(pid_t child, const user_regs_struct& r, const std::string& folder) {
  const auto of_file = [&](const char* name, unsigned long long file) -> std::optional<FileCall> {
    const std::string path = inside(path_of(child, file), folder);
    return path.empty() || !path.starts_with("out") ? std::nullopt : std::optional(FileCall{name, path});
  };
  const auto of_text = [&](const char* name, const std::string& text) -> std::optional<FileCall> {
    const std::string path = inside(text, folder);
    return path.empty() || !(path.starts_with("out") || path == "case.toml") ? std::nullopt
                                                                             : std::optional(FileCall{name, path});
  };
  const auto of_path = [&](const char* name, unsigned long long address) {
    return of_text(name, text_at(child, address));
  };
  const auto of_name = [&](const char* name, unsigned long long beside, unsigned long long address) {
    const std::string text = text_at(child, address);
    const bool in_folder = static_cast<int>(beside) != AT_FDCWD && !text.starts_with('/');
    return of_text(name, in_folder ? path_of(child, beside) + "/" + text : text);
  };
  switch (r.orig_rax) {
    case SYS_open:
      return of_path("open", r.rdi);
    case SYS_openat:
      return of_name("open", r.rdi, r.rsi);
    case SYS_write:
      return of_file("write", r.rdi);
    case SYS_writev:
      return of_file("write", r.rdi);
    case SYS_pwrite64:
      return of_file("write", r.rdi);
    case SYS_read:
      return of_file("read", r.rdi);
    case SYS_close:
      return of_file("close", r.rdi);
    case SYS_fsync:
      return of_file("fsync", r.rdi);
    case SYS_fdatasync:
      return of_file("fsync", r.rdi);
    case SYS_ftruncate:
      return of_file("truncate", r.rdi);
    case SYS_rename:
      return of_path("rename", r.rdi);
    case SYS_renameat:
      return of_name("rename", r.rdi, r.rsi);
    case SYS_renameat2:
      return of_name("rename", r.rdi, r.rsi);
    case SYS_mkdir:
      return of_path("mkdir", r.rdi);
    case SYS_mkdirat:
      return of_name("mkdir", r.rdi, r.rsi);
    case SYS_unlink:
      return of_path("unlink", r.rdi);
    case SYS_unlinkat:
      return of_name("unlink", r.rdi, r.rsi);
    default:
      return {};
  }
}

class Tracer {
 public:
  Tracer(pid_t child, std::string folder, std::optional<std::size_t> failing, int error)
      : child_(child), folder_(std::move(folder)), failing_(failing), error_(error) {}

  /// Until the child has ended; its status.
  int follow(std::vector<FileCall>& calls) {
    for (int status = 0;;) {
      const pid_t who = waitpid(-1, &status, __WALL);
      if (who < 0) return -1;
      if (WIFEXITED(status) || WIFSIGNALED(status)) {
        if (who == child_) return status;
        continue;
      }
      long deliver = 0;
      if (status >> 8 == (SIGTRAP | (PTRACE_EVENT_SECCOMP << 8)))
        at_call(who, calls);
      else if (status >> 16 == 0 && WSTOPSIG(status) != SIGSTOP && WSTOPSIG(status) != SIGTRAP)
        deliver = WSTOPSIG(status);
      ptrace(PTRACE_CONT, who, nullptr, deliver);
    }
  }

 private:
  /// Before the call is made: it is not, when it is to fail.
  void at_call(pid_t who, std::vector<FileCall>& calls) {
    user_regs_struct r;
    if (ptrace(PTRACE_GETREGS, who, nullptr, &r) != 0) return;
    const auto call = call_of(who, r, folder_);
    if (!call) return;
    const bool spoil = failing_ && calls.size() == *failing_;
    calls.push_back(*call);
    if (!spoil) return;
    r.orig_rax = static_cast<unsigned long long>(-1);
    r.rax = static_cast<unsigned long long>(-static_cast<long long>(error_));
    ptrace(PTRACE_SETREGS, who, nullptr, &r);
  }

  pid_t child_;
  std::string folder_;
  std::optional<std::size_t> failing_;
  int error_;
};

constexpr std::array<unsigned, 17> watched = {SYS_open,   SYS_openat,   SYS_write,     SYS_writev,    SYS_pwrite64,
                                              SYS_read,   SYS_close,    SYS_fsync,     SYS_fdatasync, SYS_ftruncate,
                                              SYS_rename, SYS_renameat, SYS_renameat2, SYS_mkdir,     SYS_mkdirat,
                                              SYS_unlink, SYS_unlinkat};

/// The tracer sees these calls alone: of all, a run would take ten times as long.
bool stop_at_watched() {
  std::vector<sock_filter> code{{BPF_LD | BPF_W | BPF_ABS, 0, 0, offsetof(seccomp_data, nr)}};
  for (const unsigned call : watched) {
    code.push_back({BPF_JMP | BPF_JEQ | BPF_K, 0, 1, call});
    code.push_back({BPF_RET | BPF_K, 0, 0, SECCOMP_RET_TRACE});
  }
  code.push_back({BPF_RET | BPF_K, 0, 0, SECCOMP_RET_ALLOW});
  const sock_fprog program{static_cast<unsigned short>(code.size()), code.data()};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
}

[[noreturn]] void become(const Input& input, const fs::path& folder) {
  std::vector<std::string> words{KERF_PROGRAM};
  words.insert(words.end(), input.arguments.begin(), input.arguments.end());
  std::vector<char*> argv;
  for (std::string& w : words) argv.push_back(w.data());
  argv.push_back(nullptr);
  const int out = open((folder.parent_path() / "stdout").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600),
            error = open((folder.parent_path() / "stderr").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  dup2(out, 1), dup2(error, 2);
  setenv("OPENBLAS_NUM_THREADS", "1", 1);
  setenv("ASAN_OPTIONS", "detect_leaks=0", 1);  // which needs ptrace for itself
  if (chdir(folder.c_str()) != 0 || ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) _exit(126);
  raise(SIGSTOP);
  if (!stop_at_watched()) _exit(126);
  execv(argv[0], argv.data());
  _exit(126);
}

}  // namespace

std::optional<Traced> run_traced(const fs::path& work, const Input& input, std::optional<std::size_t> failing,
                                 int error) {
  const fs::path folder = work / "in";
  fs::remove_all(work);
  fs::create_directories(folder);
  for (const auto& [name, bytes] : input.files) std::ofstream(folder / name, std::ios::binary) << bytes;
  const pid_t child = fork();
  if (child == 0) become(input, folder);
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child || !WIFSTOPPED(status)) return {};
  constexpr long how =
      PTRACE_O_TRACESECCOMP | PTRACE_O_EXITKILL | PTRACE_O_TRACECLONE | PTRACE_O_TRACEFORK | PTRACE_O_TRACEVFORK;
  if (ptrace(PTRACE_SETOPTIONS, child, nullptr, how) != 0) {
    kill(child, SIGKILL);
    waitpid(child, &status, 0);
    return {};
  }
  ptrace(PTRACE_CONT, child, nullptr, nullptr);
  Traced traced;
  status = Tracer(child, folder.string(), failing, error).follow(traced.calls);
  Outcome& o = traced.outcome;
  if (WIFEXITED(status)) o.code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) o.signal = WTERMSIG(status);
  o.out = bytes_of(work / "stdout");
  o.error = bytes_of(work / "stderr");
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (const std::string name = fs::relative(entry.path(), folder).string();
        !entry.is_directory() && !input.files.contains(name))
      o.files[name] = bytes_of(entry.path());
  fs::remove_all(work);
  return traced;
}

#else

}  // namespace

std::optional<Traced> run_traced(const fs::path&, const Input&, std::optional<std::size_t>, int) {
  return {};
}

#endif

}  // namespace kerf::fuzz
