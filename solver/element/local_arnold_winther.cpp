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
