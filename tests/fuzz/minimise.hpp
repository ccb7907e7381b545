#pragma once
// The smallest input that breaks the same promise.

#include "tests/fuzz/contract.hpp"

#include <functional>

namespace kerf::fuzz {

/// Leaves out options, tables, keys, entries, lines and files, and makes values simple, as long as `fails` says that
/// the same promise is broken. Deterministic.
Input minimise(Input input, const std::function<bool(const Input&)>& fails);

}  // namespace kerf::fuzz
