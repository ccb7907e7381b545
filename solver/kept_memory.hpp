#pragma once
// Memory of one design that becomes that of the next.

namespace kerf {

/// While one lives the C library keeps what is freed, large blocks too, instead of giving the pages back and asking for
/// new ones: for loops whose every turn needs about as much as the one before. What is free in the end is given back.
class KeptMemory {
 public:
  KeptMemory();
  ~KeptMemory();
  KeptMemory(const KeptMemory&) = delete;
  KeptMemory& operator=(const KeptMemory&) = delete;
};

/// Whether one lives.
bool keeps_memory();

}  // namespace kerf
