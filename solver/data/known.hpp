#pragma once
// Integrals of data with what they may be off by.

namespace kerf {

/// A number and what it may be off by.
struct Known {
  double value = 0, error = 0;
  bool sampled = false;  // of data that are known at points only: the error is what finer rules show
};
inline Known operator+(const Known& a, const Known& b) {
  return {a.value + b.value, a.error + b.error, a.sampled || b.sampled};
}

}  // namespace kerf
