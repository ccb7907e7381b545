// Instance of the mixed triangle for `bdms` of degree 4: it takes as long to compile as the other three together.

#include "solver/element/mixed.hpp"

namespace kerf {

namespace {
constexpr Element bdms_4 = bdms(4);
constexpr Operations bdms_4_run = mixed_operations<bdms_4>();
}  // namespace

const Operations* fourth_bdms_operations();
const Operations* fourth_bdms_operations() {
  return &bdms_4_run;
}

}  // namespace kerf
