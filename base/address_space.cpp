// Whether memory can be reserved: by reserving and giving back an anonymous mapping.

#include "base/address_space.hpp"

#include <sys/mman.h>

namespace kerf {

bool has_address_space(std::size_t bytes) {
  void* const trial = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (trial == MAP_FAILED) return false;
  munmap(trial, bytes);
  return true;
}

}  // namespace kerf
