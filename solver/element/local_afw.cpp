#include "solver/element/mixed.hpp"

namespace kerf {

namespace {
constexpr Element first = afw(1), second = afw(2), third = afw(3);
constexpr std::array<Operations, 3> run{mixed_operations<first>(), mixed_operations<second>(),
                                        mixed_operations<third>()};
}  // namespace

const Operations* afw_operations(int degree);
const Operations* afw_operations(int degree) {
  return &run.at(static_cast<std::size_t>(degree) - 1);
}

}  // namespace kerf
