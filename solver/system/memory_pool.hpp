#pragma once
// Work space that threads take and give back: as many pieces as there are threads at once.

#include <memory>
#include <mutex>
#include <vector>

namespace kerf {

/// A piece keeps what the last thread left in it, and its size: who takes it must not rely on its contents.
template <typename T>
class MemoryPool {
 public:
  /// One that was given back, or what `make` makes.
  template <typename Make>
  std::unique_ptr<T> take(const Make& make) {
    {
      const std::scoped_lock lock(mutex_);
      if (!free_.empty()) {
        std::unique_ptr<T> one = std::move(free_.back());
        free_.pop_back();
        return one;
      }
    }
    return make();
  }
  void give(std::unique_ptr<T> one) {
    const std::scoped_lock lock(mutex_);
    free_.push_back(std::move(one));
  }
  void clear() {
    const std::scoped_lock lock(mutex_);
    free_.clear();
  }

 private:
  std::vector<std::unique_ptr<T>> free_;
  std::mutex mutex_;
};

}  // namespace kerf
