// Preloaded: one allocation fails, or all from one on. KERF_FAIL_ALLOCATION=N: the N-th after main has begun, counted
// from 1; with a + behind it, all later ones, too. KERF_COUNT_ALLOCATIONS=FILE: their number goes there in the end.
// Nothing here may allocate.

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
}

namespace {

std::atomic<long> count{0};
long first = 0;
bool later_ones = false;
std::atomic<bool> started{false};
int (*real_main)(int, char**, char**) = nullptr;

bool fails() {
  if (!started.load(std::memory_order_relaxed)) return false;
  const long number = ++count;
  if (first == 0 || number < first || (number > first && !later_ones)) return false;
  errno = ENOMEM;
  return true;
}

int counted_main(int argc, char** argv, char** environment) {
  if (const char* text = std::getenv("KERF_FAIL_ALLOCATION")) {
    first = std::strtol(text, nullptr, 10);
    later_ones = std::strchr(text, '+') != nullptr;
  }
  started = true;
  return real_main(argc, argv, environment);
}

__attribute__((destructor)) void tell() {
  started = false;
  const char* path = std::getenv("KERF_COUNT_ALLOCATIONS");
  if (!path) return;
  char digits[32];
  const int length = std::snprintf(digits, sizeof digits, "%ld\n", count.load());
  const int file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  [[maybe_unused]] const auto written = write(file, digits, static_cast<std::size_t>(length));
  close(file);
}

}  // namespace

extern "C" {

int __libc_start_main(int (*main)(int, char**, char**), int argc, char** argv, void (*init)(), void (*fini)(),
                      void (*rtld_fini)(), void* stack_end) {
  real_main = main;
  using Start = int (*)(int (*)(int, char**, char**), int, char**, void (*)(), void (*)(), void (*)(), void*);
  const auto start = reinterpret_cast<Start>(dlsym(RTLD_NEXT, "__libc_start_main"));
  return start(counted_main, argc, argv, init, fini, rtld_fini, stack_end);
}

void* malloc(std::size_t size) {
  return fails() ? nullptr : __libc_malloc(size);
}
void* calloc(std::size_t items, std::size_t size) {
  return fails() ? nullptr : __libc_calloc(items, size);
}
void* realloc(void* old, std::size_t size) {
  return fails() ? nullptr : __libc_realloc(old, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  return fails() ? nullptr : __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return fails() ? nullptr : __libc_memalign(alignment, size);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  if (fails()) return ENOMEM;
  *out = __libc_memalign(alignment, size);
  return *out ? 0 : ENOMEM;
}

}  // extern "C"
