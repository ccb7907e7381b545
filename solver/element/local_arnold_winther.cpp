// Instances of the mixed triangle for the symmetric elements without unknowns at vertices, `arnold-winther` and
// `arnold-winther-nc` [Arnold, Winther 2002; Arnold, Winther 2003].

#include "solver/element/mixed.hpp"

namespace kerf {

namespace {
constexpr Operations cubic = mixed_operations<arnold_winther>(),
                     quadratic = mixed_operations<arnold_winther_nonconforming>();
}  // namespace

const Operations* arnold_winther_operations(Cut cut);
const Operations* arnold_winther_operations(Cut cut) {
  return cut == Cut::LinearDivergence ? &cubic : &quadratic;
}

}  // namespace kerf
