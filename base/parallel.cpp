// Loops on several threads whose results do not depend on their number: each item writes its own, and the failure that
// is told is that of the first item, not of the first thread.

#include "base/parallel.hpp"

#include <algorithm>
#include <exception>
#include <thread>
#include <utility>
#include <vector>

namespace kerf {

// Chunks depend on the number of threads: bodies must not sum over a chunk.
void parallel_for(Index count, int threads, const std::function<void(Index, Index)>& body) {
  constexpr Index worth_a_thread = 512;
  const Index workers = std::clamp<Index>(count / worth_a_thread, 1, std::max(threads, 1));
  if (workers <= 1) {
    if (count > 0) body(0, count);
    return;
  }
  std::vector<std::exception_ptr> failures(workers);
  const auto work = [&](Index w) {
    try {
      body(static_cast<Index>(std::int64_t{count} * w / workers),
           static_cast<Index>(std::int64_t{count} * (w + 1) / workers));
    } catch (...) {
      failures[w] = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> pool;
    for (Index w = 1; w < workers; ++w) pool.emplace_back(work, w);
    work(0);
  }
  for (const auto& failure : failures)
    if (failure) std::rethrow_exception(failure);
}

void parallel_tasks(Index count, int threads, const std::function<void(Index)>& body) {
  Team(static_cast<int>(std::clamp<Index>(count, 1, std::max(threads, 1)))).run(count, body);
}

// Threads wait between runs, and leave when the team goes.
Team::Team(int threads) {
  for (int w = 1; w < threads; ++w)
    threads_.emplace_back([this] {
      std::unique_lock lock(mutex_);
      while (true) {
        begun_.wait(lock, [this] { return over_ || next_ < count_; });
        if (over_) return;
        work(lock);
      }
    });
}

Team::~Team() {
  {
    const std::scoped_lock lock(mutex_);
    over_ = true;
  }
  begun_.notify_all();
}

void Team::run(Index count, const std::function<void(Index)>& body) {
  std::unique_lock lock(mutex_);
  body_ = &body;
  count_ = count;
  next_ = 0;
  failure_ = nullptr;
  if (count > 1) begun_.notify_all();
  work(lock);
  ended_.wait(lock, [this] { return busy_ == 0; });
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

// Every item runs, so that it does not depend on the threads which failure is told.
void Team::work(std::unique_lock<std::mutex>& lock) {
  ++busy_;
  while (next_ < count_) {
    const Index item = next_++;
    lock.unlock();
    std::exception_ptr failure;
    try {
      (*body_)(item);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    if (failure && (!failure_ || item < failed_)) {
      failure_ = failure;
      failed_ = item;
    }
  }
  if (--busy_ == 0) ended_.notify_one();
}

}  // namespace kerf
