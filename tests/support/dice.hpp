#pragma once
// Random numbers that are the same on every machine.

#include <random>

namespace kerf::test {

class Dice {
 public:
  explicit Dice(unsigned seed) : bits_(seed) {}
  double between(double a, double b) {
    return a + (b - a) * (double(bits_()) / double(std::mt19937::max()));
  }

 private:
  std::mt19937 bits_;
};

}  // namespace kerf::test
