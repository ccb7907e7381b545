// Keeps freed memory within the process while a loop over designs runs: limits of glibc's malloc, and a list of the
// largest blocks (factors) for the next design.

#include "base/kept_memory.hpp"

#include <limits>
#include <mutex>
#include <vector>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace kerf {

namespace {

std::mutex mutex;
int alive = 0;  // loops may run side by side

struct Spare {
  std::size_t size;
  std::unique_ptr<double[]> values;
};
std::vector<Spare> spares;              // blocks that a design has given back; while one lives
constexpr std::size_t most = 4;         // of them: the present design, the next, the best
constexpr std::size_t worth = 1 << 16;  // doubles: smaller ones the C library keeps as well

/// Blocks above the first are asked for and given back one by one; more free bytes than the second go back.
void set_limits([[maybe_unused]] int block, [[maybe_unused]] int free) {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, block);
  mallopt(M_TRIM_THRESHOLD, free);
#endif
}

}  // namespace

KeptMemory::KeptMemory() {
  constexpr int all = std::numeric_limits<int>::max();
  const std::scoped_lock lock(mutex);
  if (alive++ == 0) set_limits(all, all);
}

KeptMemory::~KeptMemory() {
  constexpr int block = 32 << 20;  // what glibc comes to by itself once such a block was freed
  const std::scoped_lock lock(mutex);
  if (--alive > 0) return;
  spares.clear();
  set_limits(block, 2 * block);
  return_freed_memory();
}

bool keeps_memory() {
  const std::scoped_lock lock(mutex);
  return alive > 0;
}

void return_freed_memory() {
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__)  // whose memory is none of the C library's
  malloc_trim(0);
#endif
}

KeptBlock::KeptBlock(std::size_t size) {
  const std::scoped_lock lock(mutex);
  auto best = spares.end();
  for (auto at = spares.begin(); at != spares.end(); ++at)
    if (at->size >= size && at->size <= 2 * size && (best == spares.end() || at->size < best->size)) best = at;
  if (best != spares.end()) {
    size_ = best->size;
    values_ = std::move(best->values);
    spares.erase(best);
    return;
  }
  size_ = alive > 0 ? size + size / 16 : size;  // designs differ a little
  values_.reset(new double[size_]);
}

KeptBlock::~KeptBlock() {
  if (!values_ || size_ < worth) return;
  const std::scoped_lock lock(mutex);
  if (alive == 0) return;
  if (spares.size() == most) spares.erase(spares.begin());
  spares.push_back({size_, std::move(values_)});
}

}  // namespace kerf
