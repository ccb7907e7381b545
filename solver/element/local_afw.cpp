#include "solver/element/mixed.hpp"

namespace kerf {

namespace {
constexpr Element first = afw(1), second = afw(2), third = afw(3);
constexpr std::array<Operations, 3> run{mixed_operations<first>(), mixed_operations<second>(),
                                        mixed_operations<third>()};
}  // namespace

const Operations* fourth_afw_operations();
const Operations* afw_operations(int degree);
const Operations* afw_operations(int degree) {
  return degree == 4 ? fourth_afw_operations() : &run.at(static_cast<std::size_t>(degree) - 1);
}

}  // namespace kerf
