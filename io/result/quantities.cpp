// The names and dimensions of the quantities that each kind of mean has, in the order in which they are computed.

#include "io/result.hpp"

namespace kerf {

namespace {

constexpr Dimension none{0, 0};
constexpr std::array over_disc{NamedQuantity{"s_xx", dimension::stress},
                               NamedQuantity{"s_yy", dimension::stress},
                               NamedQuantity{"s_xy", dimension::stress},
                               NamedQuantity{"e_xx", none},
                               NamedQuantity{"e_yy", none},
                               NamedQuantity{"e_xy", none}};
constexpr std::array along_line{NamedQuantity{"s_nn", dimension::stress}, NamedQuantity{"s_nt", dimension::stress},
                                NamedQuantity{"s_tt", dimension::stress}};
constexpr std::array of_displacement{NamedQuantity{"u_x", dimension::length}, NamedQuantity{"u_y", dimension::length}};
constexpr std::array of_reaction{NamedQuantity{"force_x", dimension::force},
                                 NamedQuantity{"force_y", dimension::force}};
constexpr std::array of_loads{NamedQuantity{"compliance", dimension::energy}};

}  // namespace

std::span<const NamedQuantity> quantities_of(BoundedMean::Of of) {
  switch (of) {
    case BoundedMean::Of::Disc:
      return over_disc;
    case BoundedMean::Of::Line:
      return along_line;
    case BoundedMean::Of::Displacement:
      return of_displacement;
    case BoundedMean::Of::Reaction:
      return of_reaction;
    case BoundedMean::Of::Loads:
      return of_loads;
  }
  return {};
}

}  // namespace kerf
