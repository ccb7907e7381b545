#include "io/mesh/confine.hpp"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/syscall.h>

#include <cerrno>
#include <cstddef>
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
  /// When an argument has one of the flags. The lower half of it: little endian.
  void refuse_flags(unsigned call, unsigned argument, unsigned flags) {
    add(BPF_JMP | BPF_JEQ | BPF_K, call, 0, 4);
    load(static_cast<unsigned>(offsetof(seccomp_data, args)) + 8 * argument);
    add(BPF_JMP | BPF_JSET | BPF_K, flags, 0, 1);
    add(BPF_RET | BPF_K, refused);
    add(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
  }
  /// Unless an argument has one of the flags.
  void refuse_without(unsigned call, unsigned argument, unsigned flags) {
    add(BPF_JMP | BPF_JEQ | BPF_K, call, 0, 4);
    load(static_cast<unsigned>(offsetof(seccomp_data, args)) + 8 * argument);
    add(BPF_JMP | BPF_JSET | BPF_K, flags, 1, 0);
    add(BPF_RET | BPF_K, refused);
    add(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
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
  void load(unsigned offset) {
    add(BPF_LD | BPF_W | BPF_ABS, offset);
  }
  void add(unsigned short code, unsigned k, unsigned char yes = 0, unsigned char no = 0) {
    code_.push_back({code, yes, no, k});
  }
  std::vector<sock_filter> code_;
};

void refuse_programs(Filter& filter) {
  for (const unsigned call : {__NR_execve, __NR_execveat, __NR_kill, __NR_tkill, __NR_ptrace, __NR_socket,
                              __NR_process_vm_writev, __NR_io_uring_setup})
    filter.refuse(call);
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

bool confine(Confined what) {
  Filter filter;
  refuse_programs(filter);
  if (what == Confined::Files) refuse_files(filter);
  return filter.install();
}

}  // namespace kerf
