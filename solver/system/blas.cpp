// Asks for the address space that OpenBLAS will take before it is called: without it OpenBLAS asks for memory without
// end.

#include "solver/system/blas.hpp"

#include "base/address_space.hpp"

#include <dlfcn.h>

#include <mutex>
#include <new>
#include <vector>

namespace kerf {

namespace {

// OpenBLAS's own (driver/others/memory.c): a free buffer, or a new one where there is none.
struct Buffers {
  using Take = void* (*)(int);
  using Give = void (*)(void*);
  Take take = reinterpret_cast<Take>(dlsym(RTLD_DEFAULT, "blas_memory_alloc"));
  Give give = reinterpret_cast<Give>(dlsym(RTLD_DEFAULT, "blas_memory_free"));
  std::mutex mutex;
  int inside = 0, claimed = 0;
};

// Shared with a library that has one state for the whole process.
Buffers& buffers() {
  static Buffers all;
  return all;
}

// 128 MB on x86-64, twice as much elsewhere, and what other threads may take in between.
constexpr std::size_t wanted = std::size_t{160} << 20;

}  // namespace

BlasCall::BlasCall() {
  Buffers& all = buffers();
  const std::scoped_lock lock(all.mutex);
  if (all.take && all.give && all.inside + 1 > all.claimed) {
    // As many at once as there will be calls, so that there is one for each.
    std::vector<void*> taken;
    taken.reserve(static_cast<std::size_t>(all.inside) + 1);
    bool enough = true;
    while (enough && taken.size() < taken.capacity()) {
      enough = has_address_space(wanted);
      if (enough) taken.push_back(all.take(0));
    }
    for (void* buffer : taken) all.give(buffer);
    if (!enough) out_of_memory();
    all.claimed = all.inside + 1;
  }
  ++all.inside;
}

BlasCall::~BlasCall() {
  Buffers& all = buffers();
  const std::scoped_lock lock(all.mutex);
  --all.inside;
}

void out_of_memory() {
  throw std::bad_alloc();
}

}  // namespace kerf
