#pragma once
// Random numbers from two numbers, the same on every machine: the distributions of the standard differ between
// libraries.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace kerf::fuzz {

/// splitmix64, begun from a seed and the number of the input.
class Dice {
 public:
  Dice(std::uint64_t seed, std::uint64_t number) : state_(seed * 0x9e3779b97f4a7c15u + 1) {
    state_ = bits() ^ (number * 0xd1342543de82ef95u);
    bits();
  }
  std::uint64_t bits() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  /// In [0, n); 0 when n is 0.
  std::size_t below(std::size_t n) {
    return n == 0 ? 0 : static_cast<std::size_t>(bits() % n);
  }
  double between(double a, double b) {
    return a + (b - a) * (static_cast<double>(bits() >> 11) * 0x1p-53);
  }
  bool chance(double share) {
    return between(0, 1) < share;
  }
  template <class T>
  const T& one_of(const std::vector<T>& all) {
    return all[below(all.size())];
  }

 private:
  std::uint64_t state_;
};

}  // namespace kerf::fuzz
