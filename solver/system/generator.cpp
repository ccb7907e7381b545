#include "solver/system/generator.hpp"

#include <dlfcn.h>

#include <array>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <mutex>

namespace {

/// Draws the numbers that the C library's generator does after the same seed.
struct Generator {
  random_data data{};
  std::array<char, 128> state{};
  unsigned draws = 0;
  Generator() {
    initstate_r(1, state.data(), state.size(), &data);
  }
};

Generator& generator() {
  thread_local Generator one;
  return one;
}

/// How many calls of METIS are open on this thread, less 1.
int* open_calls() {
  thread_local int* const here = static_cast<int*>(dlsym(RTLD_DEFAULT, "gk_cur_jbufs"));
  return here;
}

std::mutex trapping;
int traps = 0;  // of all threads
struct sigaction untrapped = {};

/// METIS raises it where it gets no memory, and is left by a jump to where it was called on the same thread.
extern "C" void on_abort(int signal) {
  using Jump = void (*)(int);
  static const auto jump = reinterpret_cast<Jump>(dlsym(RTLD_DEFAULT, "gk_sigthrow"));
  if (const int* calls = open_calls(); jump && calls && *calls >= 0) jump(signal);
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

}  // namespace

// METIS's own traps take SIGTERM for themselves while it orders: a request to stop would be lost, or jump to where
// another thread never was. These leave it alone.
extern "C" int gk_sigtrap() noexcept {
  constexpr int most = 128;
  int* const calls = open_calls();
  if (!calls || *calls + 1 >= most) return 0;
  ++*calls;
  const std::scoped_lock lock(trapping);
  if (traps++ > 0) return 1;
  struct sigaction action = {};
  action.sa_handler = on_abort;
  action.sa_flags = SA_NODEFER;  // the jump leaves no handler
  sigaction(SIGABRT, &action, &untrapped);
  return 1;
}

extern "C" int gk_siguntrap() noexcept {
  int* const calls = open_calls();
  if (!calls || *calls < 0) return 0;
  --*calls;
  const std::scoped_lock lock(trapping);
  if (--traps == 0) sigaction(SIGABRT, &untrapped, nullptr);
  return 1;
}

extern "C" int rand() noexcept {
  std::int32_t number = 0;
  random_r(&generator().data, &number);
  ++generator().draws;
  return number;
}

extern "C" void srand(unsigned seed) noexcept {
  srandom_r(seed, &generator().data);
}

namespace kerf {

bool has_generator_per_thread() {
  static const bool has = [] {
    using Draw = int (*)();
    const auto found = reinterpret_cast<Draw>(dlsym(RTLD_DEFAULT, "rand"));  // what libraries find
    const unsigned before = generator().draws;
    if (found) found();
    return generator().draws != before;
  }();
  return has;
}

}  // namespace kerf
