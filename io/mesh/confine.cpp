// What a process or a thread may do, limited by the kernel for good: for gmsh, whose .geo scripts are programs. Two
// means: a filter of system calls (seccomp: a BPF program that looks at the number of the call and the lower 32 bits of
// its arguments) and rules for what may be written (Landlock, where the kernel has it). The filter refuses calls of
// other architectures and of the x32 table first, since their numbers mean other calls. It sees flags that are
// arguments (open, clone), not those in memory: clone3 is answered as on kernels that do not have it, and the C library
// takes clone, where a new process is told from a new thread by CLONE_THREAD. docs/security.md, "What kerf starts".

#include "io/mesh/confine.hpp"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <vector>

namespace kerf {

namespace {

#if defined(__x86_64__)
constexpr unsigned architecture = AUDIT_ARCH_X86_64, other_tables = 0x40000000;  // x32
#elif defined(__aarch64__)
constexpr unsigned architecture = AUDIT_ARCH_AARCH64, other_tables = 0x40000000;
#else
constexpr unsigned architecture = 0, other_tables = 0;
#endif

constexpr unsigned refused = SECCOMP_RET_ERRNO | EPERM;

/// A program for the kernel, instruction by instruction: what it does not name is refused.
class Filter {
 public:
  Filter() {
    load(offsetof(seccomp_data, arch));
    add(BPF_JMP | BPF_JEQ | BPF_K, architecture, 1, 0);
    add(BPF_RET | BPF_K, refused);
    load(offsetof(seccomp_data, nr));
    add(BPF_JMP | BPF_JGE | BPF_K, other_tables, 0, 1);
    add(BPF_RET | BPF_K, refused);
  }
  void allow(unsigned call) {
    add(BPF_JMP | BPF_JEQ | BPF_K, call, 0, 1);
    add(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
  }
  /// When an argument has none of the flags.
  void allow_without(unsigned call, unsigned argument, unsigned flags) {
    allow_where(call, argument, BPF_JSET, flags, false);
  }
  /// When it has one of them.
  void allow_with(unsigned call, unsigned argument, unsigned flags) {
    allow_where(call, argument, BPF_JSET, flags, true);
  }
  /// When it is this number.
  void allow_value(unsigned call, unsigned argument, unsigned value) {
    allow_where(call, argument, BPF_JEQ, value, true);
  }
  /// As on systems that do not have the call: callers then take an older one.
  void hide(unsigned call) {
    add(BPF_JMP | BPF_JEQ | BPF_K, call, 0, 1);
    add(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | ENOSYS);
  }
  bool install() {
    add(BPF_RET | BPF_K, refused);
    const sock_fprog program{static_cast<unsigned short>(code_.size()), code_.data()};
    return architecture != 0 && prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
           prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
  }

 private:
  /// Where a test of an argument holds, or does not; else the next rule for the call is asked. The lower half of the
  /// argument: little endian.
  void allow_where(unsigned call, unsigned argument, unsigned short test, unsigned value, bool holds) {
    add(BPF_JMP | BPF_JEQ | BPF_K, call, 0, 4);
    load(static_cast<unsigned>(offsetof(seccomp_data, args)) + 8 * argument);
    add(static_cast<unsigned short>(BPF_JMP | test | BPF_K), value, holds ? 0 : 1, holds ? 1 : 0);
    add(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
    load(offsetof(seccomp_data, nr));
  }
  void load(unsigned offset) {
    add(BPF_LD | BPF_W | BPF_ABS, offset);
  }
  void add(unsigned short code, unsigned k, unsigned char yes = 0, unsigned char no = 0) {
    code_.push_back({code, yes, no, k});
  }
  std::vector<sock_filter> code_;
};

/// What computing, reading files and writing to what is open need.
void allow_computing(Filter& filter) {
  for (const unsigned call : {
         __NR_read, __NR_pread64, __NR_readv, __NR_preadv, __NR_write, __NR_pwrite64, __NR_writev, __NR_pwritev,
             __NR_lseek, __NR_close, __NR_fstat, __NR_newfstatat, __NR_statx, __NR_statfs, __NR_fstatfs, __NR_faccessat,
             __NR_readlinkat, __NR_getdents64, __NR_getcwd, __NR_dup, __NR_dup3, __NR_fadvise64, __NR_fsync,
             __NR_fdatasync, __NR_ppoll, __NR_brk, __NR_mmap, __NR_munmap, __NR_mremap, __NR_mprotect, __NR_madvise,
             __NR_futex, __NR_set_robust_list, __NR_get_robust_list, __NR_membarrier, __NR_set_tid_address,
             __NR_sched_yield, __NR_sched_getaffinity, __NR_sched_setaffinity, __NR_sched_getparam,
             __NR_sched_getscheduler, __NR_getcpu, __NR_get_mempolicy, __NR_exit, __NR_exit_group, __NR_rt_sigaction,
             __NR_rt_sigprocmask, __NR_rt_sigreturn, __NR_sigaltstack, __NR_restart_syscall, __NR_nanosleep,
             __NR_clock_nanosleep, __NR_clock_gettime, __NR_clock_getres, __NR_gettimeofday, __NR_times, __NR_getrusage,
             __NR_getrandom, __NR_uname, __NR_sysinfo, __NR_umask, __NR_getpid, __NR_getppid, __NR_gettid, __NR_getuid,
             __NR_geteuid, __NR_getgid, __NR_getegid,
#if defined(__NR_rseq)
             __NR_rseq,
#endif
#if defined(__NR_faccessat2)
             __NR_faccessat2,
#endif
#if defined(__x86_64__)  // calls that newer machines have no more
             __NR_stat, __NR_lstat, __NR_access, __NR_readlink, __NR_getdents, __NR_dup2, __NR_poll, __NR_select,
             __NR_time, __NR_arch_prctl
#endif
       })
    filter.allow(call);
  filter.allow_with(__NR_clone, 0, CLONE_THREAD);
  filter.hide(__NR_clone3);                                             // its flags lie where a filter cannot read
  filter.allow_value(__NR_tgkill, 0, static_cast<unsigned>(getpid()));  // abort is
  filter.allow_value(__NR_ioctl, 1, TCGETS);                            // is it a terminal?
  filter.allow_value(__NR_prlimit64, 0, 0);                             // its own stack
  for (const unsigned wanted : {F_DUPFD, F_DUPFD_CLOEXEC, F_GETFD, F_SETFD, F_GETFL})
    filter.allow_value(__NR_fcntl, 1, wanted);
  for (const unsigned option : {PR_SET_NAME, PR_GET_NAME, PR_SET_NO_NEW_PRIVS, PR_SET_SECCOMP})
    filter.allow_value(__NR_prctl, 0, option);
}

void allow_opening(Filter& filter, Confined what) {
  if (what == Confined::Programs) {
    filter.allow(__NR_openat);
    filter.allow(__NR_ftruncate);
#if defined(__x86_64__)
    filter.allow(__NR_open);
#endif
    return;
  }
  constexpr unsigned writes = O_WRONLY | O_RDWR | O_CREAT | O_TRUNC | O_APPEND;
  filter.allow_without(__NR_openat, 2, writes);
#if defined(__x86_64__)
  filter.allow_without(__NR_open, 1, writes);
#endif
}

}  // namespace

void stand_nowhere() {
  std::error_code none;
  std::string name = (std::filesystem::temp_directory_path(none) / "kerf-XXXXXX").string();
  if (mkdtemp(name.data()) && chdir(name.data()) == 0) rmdir(name.data());
}

bool write_only(const std::string& path) {
  // What this kernel knows of writing: of version 1 what makes, writes and removes; 2 renames, 3 truncates.
  const long version = syscall(__NR_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION);
  if (version < 1) return false;
  constexpr __u64 refer = 1ULL << 13, truncate = 1ULL << 14;
  const __u64 into_a_file = LANDLOCK_ACCESS_FS_WRITE_FILE | (version >= 3 ? truncate : 0);
  landlock_ruleset_attr all = {};
  all.handled_access_fs = into_a_file | LANDLOCK_ACCESS_FS_REMOVE_DIR | LANDLOCK_ACCESS_FS_REMOVE_FILE |
                          LANDLOCK_ACCESS_FS_MAKE_CHAR | LANDLOCK_ACCESS_FS_MAKE_DIR | LANDLOCK_ACCESS_FS_MAKE_REG |
                          LANDLOCK_ACCESS_FS_MAKE_SOCK | LANDLOCK_ACCESS_FS_MAKE_FIFO | LANDLOCK_ACCESS_FS_MAKE_BLOCK |
                          LANDLOCK_ACCESS_FS_MAKE_SYM | (version >= 2 ? refer : 0);
  const int rules = static_cast<int>(syscall(__NR_landlock_create_ruleset, &all, sizeof all.handled_access_fs, 0));
  const int file = open(path.c_str(), O_PATH | O_CLOEXEC | O_NOFOLLOW);
  landlock_path_beneath_attr one = {};
  one.allowed_access = into_a_file;
  one.parent_fd = file;
  const bool held = rules >= 0 && file >= 0 &&
                    syscall(__NR_landlock_add_rule, rules, LANDLOCK_RULE_PATH_BENEATH, &one, 0) == 0 &&
                    prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && syscall(__NR_landlock_restrict_self, rules, 0) == 0;
  if (rules >= 0) close(rules);
  if (file >= 0) close(file);
  return held;
}

bool confine(Confined what) {
  Filter filter;
  allow_computing(filter);
  allow_opening(filter, what);
  return filter.install();
}

}  // namespace kerf
