#pragma once
// The functions of expressions, as Taylor arithmetic knows them; roots are powers.

#include "io/case/taylor.hpp"

#include <span>
#include <string_view>

namespace kerf {

/// Number of a function in the table, or -1.
int function_called(std::string_view name);
bool takes_arguments(int function, std::size_t count);

/// Functions that are not smooth are undecided where their argument may be at a break: abs, sign, min, max, rint,
/// atan2.
enum class Breaking { No, Abs, Sign, Min, Max, Rint, Angle };
Breaking breaking(int function);

/// Of a function that does not break.
Taylor evaluate(int function, std::span<const Taylor> arguments, const TaylorArithmetic& with);

}  // namespace kerf
