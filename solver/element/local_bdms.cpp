// Instances of the mixed triangle for `bdms`, degrees 1 to 3 [Stenberg 1988].

#include "solver/element/mixed.hpp"

namespace kerf {

// g++ 13 and newer give templates over these constants external linkage, under the names that they have here: the names
// of two files must differ, or one element gets the code of the other.
namespace {
constexpr Element bdms_1 = bdms(1), bdms_2 = bdms(2), bdms_3 = bdms(3);
constexpr std::array<Operations, 3> bdms_run{mixed_operations<bdms_1>(), mixed_operations<bdms_2>(),
                                             mixed_operations<bdms_3>()};
}  // namespace

const Operations* fourth_bdms_operations();
const Operations* bdms_operations(int degree);
const Operations* bdms_operations(int degree) {
  return degree == 4 ? fourth_bdms_operations() : &bdms_run.at(static_cast<std::size_t>(degree) - 1);
}

}  // namespace kerf
