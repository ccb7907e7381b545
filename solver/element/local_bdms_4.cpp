// Degree 4 takes as long to compile as the other three together.

#include "solver/element/mixed.hpp"

namespace kerf {

namespace {
constexpr Element fourth = bdms(4);
constexpr Operations run = mixed_operations<fourth>();
}  // namespace

const Operations* fourth_bdms_operations();
const Operations* fourth_bdms_operations() {
  return &run;
}

}  // namespace kerf
