#pragma once
// What Factor throws when rounding has made a definite matrix indefinite: another factor may still serve.

#include "kerf/types.hpp"

namespace kerf {

struct LostDefiniteness : Error {
  explicit LostDefiniteness(const std::string& what) : Error(Fault::Numerics, what) {}
};

}  // namespace kerf
