// Instances of the mixed triangle for `peers` [Arnold, Brezzi, Douglas 1984] and `bdms-c`: elements whose rotations are
// continuous and live at the vertices.

#include "solver/element/mixed.hpp"

namespace kerf {

namespace {
constexpr Operations raviart_thomas = mixed_operations<peers>(), full = mixed_operations<bdms_continuous>();
}  // namespace

const Operations* continuous_rotation_operations(Cut cut);
const Operations* continuous_rotation_operations(Cut cut) {
  return cut == Cut::RaviartThomas ? &raviart_thomas : &full;
}

}  // namespace kerf
