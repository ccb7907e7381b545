// How a program begins and ends, apart from what else programs share: a library that others load must not have it.
// Before main: a processor without the instructions that kerf was built for is refused in one sentence; where address
// space is short OpenBLAS is kept from starting a thread per core, by starting the program anew with one. At the end
// every exception becomes one line on stderr and an exit code, and whatever ends the program from within a library for
// want of memory says so. Code here that runs early calls nothing of libraries that are not there yet.

#include "app/program.hpp"

#include "kerf/stop.hpp"
#include "kerf/types.hpp"
#include "plot/fonts.hpp"

#include <alloca.h>
#include <sched.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <string_view>
#include <system_error>

namespace kerf {

namespace {

[[noreturn]] void end_with(std::string_view words) {
  [[maybe_unused]] const auto written = write(STDERR_FILENO, words.data(), words.size());
  _exit(static_cast<int>(Fault::Numerics));
}

constexpr std::string_view no_memory = "kerf: out of memory; use a coarser mesh (a larger mesh.size)\n";

/// Destructors of libraries that ask for memory, and do not get it, end the program; so would an exception that nobody
/// may catch.
[[noreturn]] void on_terminate() noexcept {
  try {
    if (const std::exception_ptr e = std::current_exception()) std::rethrow_exception(e);
  } catch (const std::bad_alloc&) {
    end_with(no_memory);
  } catch (...) {
  }
  end_with("kerf: unexpected failure\n");
}

bool returned = false;  // by the program, not by a library

/// OpenMP calls exit(1) when it gets no memory.
void on_exit() {
  if (!returned) end_with(no_memory);
}

}  // namespace

#if defined(__AVX2__) && defined(__x86_64__)
namespace {

/// Before anything else runs, with instructions that all processors have: one sentence instead of an illegal one.
__attribute__((constructor(101), target("arch=x86-64"))) void refuse_old_processors() {
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return;
  constexpr char words[] =
      "kerf: this processor lacks AVX2, which this kerf was built for; build it with KERF_ARCH=x86-64\n";
  [[maybe_unused]] const auto written = write(STDERR_FILENO, words, sizeof words - 1);
  _exit(static_cast<int>(Fault::Usage));
}

}  // namespace
#endif

#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__)
namespace {

bool is_set(const char* variable, const char* name) {
  while (*name && *variable == *name) ++variable, ++name;
  return !*name;
}

/// Before the constructors of the libraries. OpenBLAS starts a thread for every core when it is loaded, and each takes
/// 128 MB of address space: where that is short (ulimit -v, strict overcommit) they ask for ever, and the program could
/// not even end, or is ended by the signal that OpenBLAS raises. kerf has no use for these threads: then it starts anew
/// without them. With instructions that all processors have, and nothing of libraries that are not there yet.
#if defined(__x86_64__)
__attribute__((target("arch=x86-64")))
#endif
void spare_address_space(int, char** argv, char** environment) {
  constexpr const char* name = "OPENBLAS_NUM_THREADS=";
  std::size_t count = 0, place = 0;
  bool there = false;
  for (; environment[count]; ++count)
    if (is_set(environment[count], name)) place = count, there = true;
  if (there && is_set(environment[place], "OPENBLAS_NUM_THREADS=1") && !environment[place][22]) return;
  cpu_set_t cores;
  CPU_ZERO(&cores);
  const bool known = sched_getaffinity(0, sizeof cores, &cores) == 0;
  constexpr std::size_t per_thread = std::size_t{300} << 20, own = std::size_t{300} << 20;  // with stacks and arenas
  const std::size_t size = own + per_thread * static_cast<std::size_t>(known ? CPU_COUNT(&cores) : 64);
  void* const trial = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (trial != MAP_FAILED) {
    munmap(trial, size);
    return;
  }
  static char one[] = "OPENBLAS_NUM_THREADS=1";
  auto** const changed = static_cast<char**>(alloca((count + 2) * sizeof(char*)));
  for (std::size_t k = 0; k < count; ++k) changed[k] = environment[k];
  if (!there) place = count++;
  changed[place] = one;
  changed[count] = nullptr;
  execve("/proc/self/exe", argv, changed);  // where it fails, what is there must do
}

[[gnu::section(".preinit_array"), gnu::used]] void (*const before_libraries)(int, char**, char**) = spare_address_space;

}  // namespace
#endif

int run_program(int (*work)(int argc, char** argv), int argc, char** argv) {
  std::set_terminate(on_terminate);
  std::atexit(on_exit);
  const auto code = [](int value) {
    returned = true;
    return value;
  };
  // No call here may throw: not for want of memory, not because stderr is closed.
  const auto report = [&](const char* before, const char* message, Fault fault) {
    std::fprintf(stderr, "kerf: %s%s\n", before, message);
    return code(static_cast<int>(fault));
  };
  try {
    offer_own_font();
    return code(work(argc, argv));
  } catch (const Error& e) {
    return report("", e.what(), e.fault);
  } catch (const std::filesystem::filesystem_error& e) {
    const char* path = e.path1().empty() ? "the folder for temporary files (TMPDIR)" : e.path1().c_str();
    std::fprintf(stderr, "kerf: cannot use %s: %s\n", path, std::strerror(e.code().value()));
    return code(static_cast<int>(Fault::Files));
  } catch (const Stopped&) {
    return report("", "stopped by a signal before it was done", Fault::Numerics);
  } catch (const std::bad_alloc&) {
    return report("", "out of memory; use a coarser mesh (a larger mesh.size)", Fault::Numerics);
  } catch (const std::system_error& e) {
    if (e.code() != std::errc::resource_unavailable_try_again)
      return report("unexpected failure: ", e.what(), Fault::Numerics);
    return report("", "no more threads can be started; use --threads 1", Fault::Numerics);
  } catch (const std::exception& e) {
    return report("unexpected failure: ", e.what(), Fault::Numerics);
  } catch (...) {
    return report("", "unexpected failure", Fault::Numerics);
  }
}

}  // namespace kerf
