#pragma once
// One loop over independent items on several threads. What each item writes must not depend on who computes it.

#include "kerf/types.hpp"

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace kerf {

/// body(begin, end) on contiguous chunks that cover [0, count). Runs on the calling thread when threads <= 1 or the
/// loop is short. The first exception that a chunk throws is rethrown here.
void parallel_for(Index count, int threads, const std::function<void(Index begin, Index end)>& body);

/// body(i) for every i in [0, count), each on whichever thread is free next: for few items of uneven work.
void parallel_tasks(Index count, int threads, const std::function<void(Index)>& body);

/// Threads that stay for many short loops: starting one costs as much as some of these take, far more on a busy
/// machine.
class Team {
 public:
  /// The calling thread is one of them.
  explicit Team(int threads);
  ~Team();
  Team(const Team&) = delete;
  Team& operator=(const Team&) = delete;
  int size() const {
    return static_cast<int>(threads_.size()) + 1;
  }
  /// As parallel_tasks. Not from within a body.
  void run(Index count, const std::function<void(Index)>& body);

 private:
  void work(std::unique_lock<std::mutex>& lock);

  std::mutex mutex_;
  std::condition_variable begun_, ended_;
  const std::function<void(Index)>* body_ = nullptr;
  Index count_ = 0, next_ = 0, busy_ = 0;
  std::exception_ptr failure_;
  Index failed_ = 0;  // at this item, the first one of those that did
  bool over_ = false;
  std::vector<std::jthread> threads_;
};

}  // namespace kerf
