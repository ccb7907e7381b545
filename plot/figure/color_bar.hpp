#pragma once
// What the colors of a picture mean.

#include "plot/figure/pen.hpp"

namespace kerf {

/// Where the layout has it: upright beside the plot, or lying below it; pointed where values lie beyond its end.
void draw_color_bar(cairo_t* pen, const Layout& layout, Scale scale, const Limits& limits);

}  // namespace kerf
