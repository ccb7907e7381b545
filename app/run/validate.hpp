#pragma once
// The expansion against computations with changes of finite size.

#include "app/run/solve.hpp"

namespace kerf {

/// With its file and its picture; what is changed is drawn by the tables of a case file. Throws what validate throws.
ValidationResult validate_expansion(const Case& c, const Body& body, Journal& journal);

}  // namespace kerf
