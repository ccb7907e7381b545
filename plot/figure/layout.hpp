#pragma once
// Where everything in a picture goes, in pixels. Text is measured through a function, so nothing here draws.

#include "plot/figure/colors.hpp"
#include "plot/figure/ticks.hpp"

namespace kerf {

struct Font {
  double size = 24;
  bool bold = false, italic = false;
};
using Measure = std::function<double(const std::string& text, const Font& font)>;  // width

struct Lines {
  std::vector<std::string> text;
  Font font;
  double height() const {
    return 1.3 * font.size * static_cast<double>(text.size());
  }
};

/// What a text may take.
struct TextRoom {
  double width, smallest;  // of the lines, of the letters
  std::size_t most;        // lines
};
/// The fewest lines, then the largest letters; a text that does not fit `most` lines of the smallest letters is cut
/// and ends in an ellipsis.
Lines wrap(const std::string& text, Font font, const TextRoom& room, const Measure& measure);

/// "x (note)"; either alone where the other is empty.
std::string with_note(const std::string& label, const std::string& note);

struct Box {
  double x = 0, y = 0, width = 0, height = 0;  // upper left corner
};

struct Layout {
  int width = 0, height = 0;
  Box plot;
  Vec2 low = Vec2::Zero();  // the point at the lower left corner of the plot
  double scale = 1;         // pixels per length
  Ticks x, y;
  Font tick{24}, extreme{20, false, true};
  Lines title, subtitle, x_label, y_label;
  double title_x = 0, x_label_y = 0;
  bool has_bar = false, beside = true;  // the color bar stands beside the plot, or lies below it
  Box bar;                              // without its pointed ends
  Ticks values;
  Lines value_label;
  double point = 28;     // length of a pointed end
  double label_gap = 0;  // from the bar to its label
  double margin = 34, tick_length = 9, tick_gap = 9;

  Vec2 place(const Vec2& p) const {
    return {plot.x + (p.x() - low.x()) * scale, plot.y + plot.height - (p.y() - low.y()) * scale};
  }
};

/// "max 12.3": what lies beyond a pointed end of the color bar.
std::string extreme_text(const char* word, double value);

/// About 1600 pixels wide, less for tall bodies. Widths are in proportion to the body's; only a body more than fifteen
/// times as long as wide gets white space instead.
Layout lay_out(const Picture& picture, const Limits& limits, const Measure& measure);

}  // namespace kerf
