// Replaces what METIS takes from the process: its random numbers and its signal traps. METIS draws from one generator
// of the C library, so that graphs that are ordered side by side take each other's numbers, and the order would differ
// from run to run; and it traps SIGTERM while it orders. The functions at the end of this file have the names of
// METIS's own and are found before them: a generator per thread, which draws the numbers of the C library's after the
// same seed, and traps that catch SIGABRT (no memory) alone, jumping to where METIS was called on the same thread.
// Where a program finds METIS's own functions instead, solver/system/symbolic.cpp notices by seeds_of_metis() and
// orders one graph at a time. Used for the order of elimination, docs/theory/elements.md, section The factor.

#include "solver/system/generator.hpp"

#include <dlfcn.h>

#include <array>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <mutex>

// There may be two METIS in a process: libmetis, and the one that CHOLMOD has inside from SuiteSparse 7 on, with names
// and whole numbers of its own. Both find the functions at the end of this file before their own.

namespace {

/// Draws the numbers that the C library's generator does after the same seed: libmetis takes them, too.
/// State of 128 bytes, seed 1: the defaults of random() in the C library.
struct Generator {
  random_data data{};
  std::array<char, 128> state{};
  unsigned seeds = 0;
  Generator() {
    initstate_r(1, state.data(), state.size(), &data);
  }
  void seed(std::int64_t with) {
    srandom_r(static_cast<unsigned>(with), &data);
    ++seeds;
  }
  std::int32_t draw() {
    std::int32_t number = 0;
    random_r(&data, &number);
    return number;
  }
};

Generator& generator() {
  thread_local Generator one;
  return one;
}

/// One METIS of the process, on this thread.
struct Metis {
  int* calls;         // open ones, less 1; null where the process lacks it
  void (*jump)(int);  // to where the innermost was called
};
enum Which : std::size_t { in_libmetis, in_cholmod };

template <class T>
T find(const char* name) {
  return reinterpret_cast<T>(dlsym(RTLD_DEFAULT, name));
}

const Metis& metis(Which which) {
  thread_local const std::array<Metis, 2> both{
      Metis{find<int*>("gk_cur_jbufs"), find<void (*)(int)>("gk_sigthrow")},
      Metis{find<int*>("SuiteSparse_metis_gk_cur_jbufs"), find<void (*)(int)>("SuiteSparse_metis_gk_sigthrow")}};
  return both[which];
}

std::mutex trapping;
int traps = 0;  // of all threads
struct sigaction untrapped = {};

/// METIS raises it where it gets no memory, and is left by a jump to where it was called on the same thread.
extern "C" void on_abort(int signal) {
  for (const Which which : {in_libmetis, in_cholmod})
    if (const auto [calls, jump] = metis(which); calls && jump && *calls >= 0) jump(signal);
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

// METIS's own traps take SIGTERM for themselves while it orders: a request to stop would be lost, or jump to where
// another thread never was. These leave it alone.
int trap(Which which) {
  constexpr int most = 128;
  int* const calls = metis(which).calls;
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

int untrap(Which which) {
  int* const calls = metis(which).calls;
  if (!calls || *calls < 0) return 0;
  --*calls;
  const std::scoped_lock lock(trapping);
  if (--traps == 0) sigaction(SIGABRT, &untrapped, nullptr);
  return 1;
}

}  // namespace

// CMakeLists.txt exports these from programs, python/CMakeLists.txt from the module.
extern "C" {
int gk_sigtrap() noexcept {
  return trap(in_libmetis);
}
int gk_siguntrap() noexcept {
  return untrap(in_libmetis);
}
void libmetis__isrand(std::int32_t seed) noexcept {
  generator().seed(seed);
}
std::int32_t libmetis__irand() noexcept {
  return generator().draw();
}
int SuiteSparse_metis_gk_sigtrap() noexcept {
  return trap(in_cholmod);
}
int SuiteSparse_metis_gk_siguntrap() noexcept {
  return untrap(in_cholmod);
}
void SuiteSparse_metis_libmetis__isrand(std::int64_t seed) noexcept {
  generator().seed(seed);
}
std::int64_t SuiteSparse_metis_libmetis__irand() noexcept {
  return generator().draw();
}
}

namespace kerf {

unsigned seeds_of_metis() {
  return generator().seeds;
}

}  // namespace kerf
