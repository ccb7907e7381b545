#pragma once
// The readers of TOML and of expressions, for data files that are no cases.

#include "io/case/expression.hpp"
#include "io/case/reader.hpp"
