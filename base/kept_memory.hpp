#pragma once
// Memory of one design that becomes that of the next.

#include <cstddef>
#include <memory>
#include <utility>

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

/// Gives what was freed back to the system: the ordering leaves holes that no later block fits into.
void return_freed_memory();

/// Doubles without values, for the few largest blocks of a design: while memory is kept those that are gone serve again
/// where they are large enough. What lies between would otherwise be cut up by small blocks, and its pages made anew.
class KeptBlock {
 public:
  KeptBlock() = default;
  explicit KeptBlock(std::size_t size);
  KeptBlock(KeptBlock&& other) noexcept : size_(std::exchange(other.size_, 0)), values_(std::move(other.values_)) {}
  KeptBlock& operator=(KeptBlock&& other) noexcept {
    std::swap(size_, other.size_);
    std::swap(values_, other.values_);
    return *this;
  }
  ~KeptBlock();
  double* get() const {
    return values_.get();
  }
  explicit operator bool() const {
    return static_cast<bool>(values_);
  }

 private:
  std::size_t size_ = 0;
  std::unique_ptr<double[]> values_;
};

}  // namespace kerf
