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

/// A program for the kernel, instruction by instruction.
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
  void refuse(unsigned call) {
    add(BPF_JMP | BPF_JEQ | BPF_K, call, 0, 1);
    add(BPF_RET | BPF_K, refused);
  }
  /// When an argument has one of the flags.
  void refuse_flags(unsigned call, unsigned argument, unsigned flags) {
    refuse_where(call, argument, BPF_JSET, flags, true);
  }
  /// Unless an argument has one of the flags.
  void refuse_without(unsigned call, unsigned argument, unsigned flags) {
    refuse_where(call, argument, BPF_JSET, flags, false);
  }
  /// When an argument is this number.
  void refuse_value(unsigned call, unsigned argument, unsigned value) {
    refuse_where(call, argument, BPF_JEQ, value, true);
  }
  /// When it is another one.
  void refuse_but(unsigned call, unsigned argument, unsigned value) {
    refuse_where(call, argument, BPF_JEQ, value, false);
  }
  /// As on systems that do not have the call: callers then take an older one.
  void hide(unsigned call) {
    add(BPF_JMP | BPF_JEQ | BPF_K, call, 0, 1);
    add(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | ENOSYS);
  }
  bool install() {
    add(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
    const sock_fprog program{static_cast<unsigned short>(code_.size()), code_.data()};
    return architecture != 0 && prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
           prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
  }

 private:
  /// Where a test of an argument holds, or does not. The lower half of it: little endian.
  void refuse_where(unsigned call, unsigned argument, unsigned short test, unsigned value, bool holds) {
    add(BPF_JMP | BPF_JEQ | BPF_K, call, 0, 4);
    load(static_cast<unsigned>(offsetof(seccomp_data, args)) + 8 * argument);
    add(static_cast<unsigned short>(BPF_JMP | test | BPF_K), value, holds ? 0 : 1, holds ? 1 : 0);
    add(BPF_RET | BPF_K, refused);
    add(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
  }
  void load(unsigned offset) {
    add(BPF_LD | BPF_W | BPF_ABS, offset);
  }
  void add(unsigned short code, unsigned k, unsigned char yes = 0, unsigned char no = 0) {
    code_.push_back({code, yes, no, k});
  }
  std::vector<sock_filter> code_;
};

void refuse_programs(Filter& filter) {
  for (const unsigned call : {__NR_execve,
                              __NR_execveat,
                              __NR_kill,
                              __NR_tkill,
                              __NR_ptrace,
                              __NR_socket,
                              __NR_process_vm_readv,
                              __NR_process_vm_writev,
                              __NR_io_uring_setup,
                              __NR_rt_sigqueueinfo,
                              __NR_rt_tgsigqueueinfo,
                              __NR_pidfd_open,
                              __NR_pidfd_send_signal,
                              __NR_mount,
                              __NR_umount2,
                              __NR_chroot,
                              __NR_pivot_root,
                              __NR_unshare,
                              __NR_setns,
                              __NR_bpf,
                              __NR_perf_event_open,
                              __NR_userfaultfd,
                              __NR_keyctl,
                              __NR_add_key,
                              __NR_request_key,
                              __NR_init_module,
                              __NR_finit_module,
                              __NR_open_by_handle_at,
                              __NR_setxattr,
                              __NR_lsetxattr,
                              __NR_fsetxattr,
                              __NR_removexattr,
                              __NR_lremovexattr,
                              __NR_fremovexattr,
                              __NR_fchmod,
                              __NR_fchown,
                              __NR_acct,
                              __NR_swapon,
                              __NR_reboot})
    filter.refuse(call);
  filter.refuse_but(__NR_tgkill, 0, static_cast<unsigned>(getpid()));  // abort is
  filter.refuse_value(__NR_ioctl, 1, TIOCSTI);                         // words of a terminal
#if defined(__x86_64__)
  filter.refuse(__NR_fork);
  filter.refuse(__NR_vfork);
#endif
  filter.refuse_without(__NR_clone, 0, CLONE_THREAD);
  filter.hide(__NR_clone3);  // its flags lie where a filter cannot read
}

void refuse_files(Filter& filter) {
  constexpr unsigned writes = O_WRONLY | O_RDWR | O_CREAT | O_TRUNC | O_APPEND;
  filter.refuse_flags(__NR_openat, 2, writes);
#if defined(__x86_64__)  // calls that newer machines have no more
  filter.refuse_flags(__NR_open, 1, writes);
  for (const unsigned call : {__NR_creat, __NR_unlink, __NR_rename, __NR_mkdir, __NR_rmdir, __NR_link, __NR_symlink,
                              __NR_chmod, __NR_chown, __NR_lchown, __NR_mknod, __NR_utime, __NR_utimes})
    filter.refuse(call);
#endif
#if defined(__NR_renameat)
  filter.refuse(__NR_renameat);
#endif
  for (const unsigned call : {__NR_openat2, __NR_unlinkat, __NR_renameat2, __NR_mkdirat, __NR_linkat, __NR_symlinkat,
                              __NR_fchmodat, __NR_fchownat, __NR_mknodat, __NR_truncate, __NR_utimensat})
    filter.refuse(call);
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
  refuse_programs(filter);
  if (what == Confined::Files) refuse_files(filter);
  return filter.install();
}

}  // namespace kerf
