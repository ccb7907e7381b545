#include "solver/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>
#include <vector>

namespace kerf {

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
  const Index workers = std::clamp<Index>(count, 1, std::max(threads, 1));
  std::vector<std::exception_ptr> failures(static_cast<std::size_t>(std::max(count, 0)));
  std::atomic<Index> next{0};
  const auto work = [&] {
    for (Index i = next++; i < count; i = next++) {
      try {
        body(i);
      } catch (...) {
        failures[static_cast<std::size_t>(i)] = std::current_exception();
      }
    }
  };
  {
    std::vector<std::jthread> pool;
    for (Index w = 1; w < workers; ++w) pool.emplace_back(work);
    work();
  }
  for (const auto& failure : failures)
    if (failure) std::rethrow_exception(failure);
}

}  // namespace kerf
