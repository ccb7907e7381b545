#pragma once
// The expansion against computations with changes of finite size.

#include "app/solve.hpp"

namespace kerf {

/// With its file and its picture. Throws what validate throws.
ValidationResult validate_expansion(const Body& body, const Functional& j, ValidationRequest request, Journal& journal);

}  // namespace kerf
