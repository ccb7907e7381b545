#include "solver/element/mixed.hpp"

namespace kerf {

namespace {
constexpr Element first = bdms(1), second = bdms(2), third = bdms(3);
constexpr std::array<Operations, 3> run{mixed_operations<first>(), mixed_operations<second>(),
                                        mixed_operations<third>()};
}  // namespace

const Operations* fourth_bdms_operations();
const Operations* bdms_operations(int degree);
const Operations* bdms_operations(int degree) {
  return degree == 4 ? fourth_bdms_operations() : &run.at(static_cast<std::size_t>(degree) - 1);
}

}  // namespace kerf
