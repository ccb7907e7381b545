// Instances of the mixed triangle for `afw`, degrees 1 to 3 [Arnold, Falk, Winther 2007].

#include "solver/element/mixed.hpp"

namespace kerf {

// g++ 13 and newer give templates over these constants external linkage, under the names that they have here: the names
// of two files must differ, or one element gets the code of the other.
namespace {
constexpr Element afw_1 = afw(1), afw_2 = afw(2), afw_3 = afw(3);
constexpr std::array<Operations, 3> afw_run{mixed_operations<afw_1>(), mixed_operations<afw_2>(),
                                            mixed_operations<afw_3>()};
}  // namespace

const Operations* fourth_afw_operations();
const Operations* afw_operations(int degree);
const Operations* afw_operations(int degree) {
  return degree == 4 ? fourth_afw_operations() : &afw_run.at(static_cast<std::size_t>(degree) - 1);
}

}  // namespace kerf
