#pragma once
// Work on a stack on which no recursion of thousands fits.

#include <gtest/gtest.h>
#include <pthread.h>

#include <functional>

namespace kerf::test {

inline void on_small_stack(std::function<void()> work) {
#if defined(__SANITIZE_ADDRESS__)
  constexpr std::size_t bytes = 1 << 20;  // whose frames are larger
#else
  constexpr std::size_t bytes = 1 << 17;
#endif
  pthread_attr_t small;
  ASSERT_EQ(pthread_attr_init(&small), 0);
  ASSERT_EQ(pthread_attr_setstacksize(&small, bytes), 0);
  pthread_t thread;
  const auto run = [](void* what) -> void* {
    (*static_cast<std::function<void()>*>(what))();
    return nullptr;
  };
  ASSERT_EQ(pthread_create(&thread, &small, run, &work), 0);
  pthread_join(thread, nullptr);
  pthread_attr_destroy(&small);
}

}  // namespace kerf::test
