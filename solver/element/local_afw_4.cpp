// Instance of the mixed triangle for `afw` of degree 4: it takes as long to compile as the other three together.

#include "solver/element/mixed.hpp"

namespace kerf {

namespace {
constexpr Element afw_4 = afw(4);
constexpr Operations afw_4_run = mixed_operations<afw_4>();
}  // namespace

const Operations* fourth_afw_operations();
const Operations* fourth_afw_operations() {
  return &afw_4_run;
}

}  // namespace kerf
