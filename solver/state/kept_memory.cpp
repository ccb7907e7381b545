#include "solver/kept_memory.hpp"

#include "solver/factor.hpp"

#include <limits>
#include <mutex>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace kerf {

namespace {

std::mutex mutex;
int alive = 0;  // loops may run side by side

/// Blocks above the first are asked for and given back one by one; more free bytes than the second go back.
void set_limits([[maybe_unused]] int block, [[maybe_unused]] int free) {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, block);
  mallopt(M_TRIM_THRESHOLD, free);
#endif
}

}  // namespace

KeptMemory::KeptMemory() {
  constexpr int most = std::numeric_limits<int>::max();
  const std::scoped_lock lock(mutex);
  if (alive++ == 0) set_limits(most, most);
}

KeptMemory::~KeptMemory() {
  constexpr int block = 32 << 20;  // what glibc comes to by itself once such a block was freed
  const std::scoped_lock lock(mutex);
  if (--alive > 0) return;
  set_limits(block, 2 * block);
  return_freed_memory();
}

bool keeps_memory() {
  const std::scoped_lock lock(mutex);
  return alive > 0;
}

}  // namespace kerf
