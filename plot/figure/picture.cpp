// A picture of the body: field, outlines, cracks, borders of regions, supports and loads, marks with names, axes, color
// bar. Lines lie over the field in this order, and cracks have a white rim so that they show on dark colors. Held sides
// have short strokes where all components are held and rollers where one is free. A name stands at the first of 24
// places around its mark where it touches no line and no other name, then at the first where it touches lines alone,
// and is left out where there is none. layout.cpp says where everything stands; raster.cpp paints the field.

#include "plot/picture.hpp"

#include "io/text.hpp"
#include "plot/figure/color_bar.hpp"
#include "plot/figure/frame.hpp"

#include <fmt/core.h>

#include <cmath>
#include <optional>

namespace kerf {

namespace {

void trace(cairo_t* pen, const Layout& layout, const std::vector<Vec2>& line) {
  bool down = false;
  for (const Vec2& p : line) {
    const Vec2 at = layout.place(p);
    if (!at.allFinite()) {
      down = false;
    } else if (down) {
      cairo_line_to(pen, at.x(), at.y());
    } else {
      cairo_move_to(pen, at.x(), at.y());
      cairo_line_to(pen, at.x(), at.y());  // a single point becomes a dot
      down = true;
    }
  }
}

constexpr std::uint32_t crack_red = 0xe0232e, support_blue = 0x0072b2, load_orange = 0xd55e00;

/// A strong line; beyond it short strokes when all components are held, else rollers.
void draw_support(cairo_t* pen, const Layout& layout, const std::vector<Vec2>& line, bool full) {
  constexpr double length = 15, radius = 5.5;
  const double apart = full ? 15 : 26;
  double next = 0.5 * apart, done = 0;
  cairo_new_path(pen);
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Vec2 a = layout.place(line[i - 1]), b = layout.place(line[i]);
    const double piece = (b - a).norm();
    if (!(piece > 0) || !std::isfinite(piece)) continue;
    const Vec2 along = (b - a) / piece, out(-along.y(), along.x());  // y points downwards
    for (; next < done + piece; next += apart) {
      const Vec2 from = a + along * (next - done);
      if (full) {
        const Vec2 to = from + length * (out - 0.8 * along).normalized();
        cairo_move_to(pen, from.x(), from.y());
        cairo_line_to(pen, to.x(), to.y());
      } else {
        const Vec2 middle = from + (radius + 3) * out;
        cairo_new_sub_path(pen);
        cairo_arc(pen, middle.x(), middle.y(), radius, 0, 2 * pi);
      }
    }
    done += piece;
  }
  stroke(pen, 2.4, support_blue);
  trace(pen, layout, line);
  stroke(pen, full ? 6 : 4, support_blue);
}

void draw_arrow(cairo_t* pen, const Vec2& from, const Vec2& to) {
  const double length = (to - from).norm();
  if (!(length > 1) || !std::isfinite(length)) return;
  const Vec2 along = (to - from) / length, across(-along.y(), along.x());
  const double head = std::min(20.0, 0.5 * length);
  const Vec2 neck = to - head * along;
  const auto draw = [&](double extra, std::uint32_t rgb, double alpha) {
    cairo_new_path(pen);
    cairo_move_to(pen, from.x(), from.y());
    cairo_line_to(pen, neck.x(), neck.y());
    stroke(pen, 3.6 + extra, rgb, alpha);
    cairo_new_path(pen);
    for (const Vec2& p : {to, Vec2(neck + 0.42 * head * across), Vec2(neck - 0.42 * head * across)})
      cairo_line_to(pen, p.x(), p.y());
    cairo_close_path(pen);
    color(pen, rgb, alpha);
    cairo_fill_preserve(pen);
    stroke(pen, extra + 0.5, rgb, alpha);
  };
  draw(4, paper, 0.85);
  draw(0, load_orange, 1);
}

void draw_body(cairo_t* pen, const Layout& layout, const Picture& picture, const Limits& limits) {
  std::vector<Vec2> pixels;
  pixels.reserve(picture.points.size());
  for (const Vec2& p : picture.points) pixels.push_back(layout.place(p) - Vec2(layout.plot.x, layout.plot.y));
  Painting painting;
  painting.points = pixels;
  painting.triangles = picture.triangles;
  painting.values = &picture.values;
  painting.margin = &picture.margin;
  painting.limits = limits;
  painting.scale = picture.scale;
  if (picture.solid) {
    painting.plain = 0xff000000 | picture.color;
  } else if (picture.edges || picture.values.cols() == 0) {
    painting.edge_width = picture.values.cols() == 0 ? 1.4 : 1.0;
  }
  Image image = paint(static_cast<int>(layout.plot.width), static_cast<int>(layout.plot.height), painting);
  put(pen, image, {layout.plot.x, layout.plot.y});

  for (const auto& line : picture.interfaces) trace(pen, layout, line);
  stroke(pen, 2.6, interface_orange);
  for (const auto& line : picture.outlines) trace(pen, layout, line);
  stroke(pen, 2.2, ink);
  // A white rim, so that a crack shows on dark colors, too; all rims lie under all lines.
  for (const auto& line : picture.cracks) trace(pen, layout, line);
  stroke(pen, 6.5, paper, 0.85);
  for (const auto& line : picture.cracks) trace(pen, layout, line);
  stroke(pen, 3.6, picture.solid ? crack_red : 0x000000);
  for (const auto& line : picture.rollers) draw_support(pen, layout, line, false);
  for (const auto& line : picture.supports) draw_support(pen, layout, line, true);
  for (const auto& [from, to] : picture.arrows) draw_arrow(pen, layout.place(from), layout.place(to));
  for (const Trace& one : picture.traces) {
    constexpr double dash[] = {14, 9};
    cairo_set_dash(pen, dash, one.dashed ? 2 : 0, 0);
    cairo_new_path(pen);
    trace(pen, layout, one.line);
    stroke(pen, one.width, one.rgb);
  }
  cairo_set_dash(pen, nullptr, 0, 0);
}

bool apart(const Box& a, const Box& b) {
  return a.x + a.width <= b.x || b.x + b.width <= a.x || a.y + a.height <= b.y || b.y + b.height <= a.y;
}

/// Does the segment a-b meet the box? The piece of it left of, right of, ... the four sides is cut away.
bool meets(const Box& box, const Vec2& a, const Vec2& b) {
  double from = 0, to = 1;
  const auto cut = [&](double start, double step, double low, double high) {
    if (step == 0) return start >= low && start <= high;
    const double t0 = (low - start) / step, t1 = (high - start) / step;
    from = std::max(from, std::min(t0, t1));
    to = std::min(to, std::max(t0, t1));
    return from <= to;
  };
  return cut(a.x(), b.x() - a.x(), box.x, box.x + box.width) && cut(a.y(), b.y() - a.y(), box.y, box.y + box.height);
}

struct Mark {
  Vec2 at;
  Lines name;
  double width;  // of the name
  bool cross;
};

/// The first of several places around the mark where its name touches nothing; if lines are everywhere, where it
/// touches no other mark or name; if even that fails the name is left out. A name without a cross may stand on its
/// point, and else rather below, above or beside it than across a corner.
std::optional<Box> free_place(const Layout& layout, const Mark& mark, const std::vector<Box>& taken,
                              const std::vector<std::array<Vec2, 2>>& lines) {
  const double width = mark.width + 8, height = mark.name.height();
  const Box& plot = layout.plot;
  constexpr int around_cross[] = {0, 1, 2, 3, 4, 5, 6, 7}, around_point[] = {3, 7, 1, 5, 0, 2, 4, 6};
  for (const bool among_lines : {false, true}) {
    for (int place = mark.cross ? 0 : -1; place < 24; ++place) {
      const int side = place < 0 ? 0 : (mark.cross ? around_cross : around_point)[place % 8];
      const bool diagonal = side % 2 == 0;  // upper right first, then clockwise, then farther away
      const double angle = (side - 1) * pi / 4, away = (diagonal ? 10 : 13) + 24.0 * (place / 8);
      const Vec2 to(std::round(std::cos(angle) * 1.2), std::round(std::sin(angle) * 1.2));
      const Vec2 center =
          place < 0 ? mark.at : mark.at + Vec2(to.x() * (away + 0.5 * width), to.y() * (away + 0.5 * height));
      const Box box{center.x() - 0.5 * width, center.y() - 0.5 * height, width, height};
      bool free = box.x >= plot.x + 4 && box.x + width <= plot.x + plot.width - 4 && box.y >= plot.y + 4 &&
                  box.y + height <= plot.y + plot.height - 4;
      for (const Box& other : taken) free = free && apart(box, other);
      if (free && !among_lines) {
        for (const auto& [a, b] : lines) free = free && !meets(box, a, b);
      }
      if (free) return box;
    }
  }
  return std::nullopt;
}

void draw_marks(cairo_t* pen, const Layout& layout, const Picture& picture) {
  const double arm = 9;
  const Box& plot = layout.plot;
  std::vector<Mark> marks;
  std::vector<Box> taken;
  const auto add = [&](const std::vector<std::pair<Vec2, std::string>>& all, bool cross) {
    for (const auto& [p, name] : all) {
      const Vec2 at = layout.place(p);
      const Vec2 inside = at - Vec2(plot.x, plot.y);
      if (!(inside.minCoeff() >= 0 && inside.x() <= plot.width && inside.y() <= plot.height)) continue;
      const Measure measure = [&](const std::string& text, const Font& font) { return text_width(pen, text, font); };
      Mark mark{at, wrap(name, {22}, {plot.width - 20, 15, 4}, measure), 0, cross};
      for (const auto& line : mark.name.text) mark.width = std::max(mark.width, measure(line, mark.name.font));
      marks.push_back(std::move(mark));
      if (cross) taken.push_back({at.x() - arm, at.y() - arm, 2 * arm, 2 * arm});
    }
  };
  add(picture.marks, true);
  add(picture.names, false);
  if (marks.empty()) return;
  for (const auto& [width, rgb] : {std::pair(6.5, paper), std::pair(2.8, std::uint32_t(0xc2185b))}) {
    for (const Mark& mark : marks) {
      if (!mark.cross) continue;
      cairo_move_to(pen, mark.at.x() - arm, mark.at.y());
      cairo_line_to(pen, mark.at.x() + arm, mark.at.y());
      cairo_move_to(pen, mark.at.x(), mark.at.y() - arm);
      cairo_line_to(pen, mark.at.x(), mark.at.y() + arm);
    }
    stroke(pen, width, rgb);
  }
  std::vector<std::array<Vec2, 2>> lines;
  for (const auto* group : {&picture.cracks, &picture.outlines, &picture.interfaces}) {
    for (const auto& line : *group) {
      for (std::size_t i = 1; i < line.size(); ++i) lines.push_back({layout.place(line[i - 1]), layout.place(line[i])});
    }
  }
  for (const auto& [from, to] : picture.arrows) lines.push_back({layout.place(from), layout.place(to)});
  for (const Mark& mark : marks) {
    if (mark.name.text.empty()) continue;
    const auto box = free_place(layout, mark, taken, lines);
    if (!box) continue;
    taken.push_back(*box);
    choose(pen, mark.name.font);
    for (const bool rim : {true, false}) {
      for (std::size_t i = 0; i < mark.name.text.size(); ++i) {
        cairo_move_to(pen, box->x + 4, box->y + (1.3 * (static_cast<double>(i) + 0.5) + 0.365) * mark.name.font.size);
        cairo_text_path(pen, mark.name.text[i].c_str());
      }
      if (rim) {
        stroke(pen, 5, paper, 0.9);
      } else {
        color(pen, ink);
        cairo_fill(pen);
      }
    }
  }
}

void draw_axes(cairo_t* pen, const Layout& layout) {
  const Box& plot = layout.plot;
  const double bottom = plot.y + plot.height, outside = layout.tick_length + layout.tick_gap;
  cairo_set_line_cap(pen, CAIRO_LINE_CAP_BUTT);
  cairo_rectangle(pen, plot.x, plot.y, plot.width, plot.height);
  stroke(pen, 1.6, frame_gray);
  double labels_width = 0;
  for (std::size_t i = 0; i < layout.x.at.size(); ++i) {
    const double x = layout.place({layout.x.at[i], layout.low.y()}).x();
    write(pen, {x, bottom + outside + 0.5 * layout.tick.size}, layout.x.labels[i], layout.tick, {0.5});
    cairo_new_path(pen);
    cairo_move_to(pen, x, bottom);
    cairo_line_to(pen, x, bottom + layout.tick_length);
    stroke(pen, 1.6, frame_gray);
  }
  for (std::size_t i = 0; i < layout.y.at.size(); ++i) {
    const double y = layout.place({layout.low.x(), layout.y.at[i]}).y();
    write(pen, {plot.x - outside, y}, layout.y.labels[i], layout.tick, {1});
    labels_width = std::max(labels_width, text_width(pen, layout.y.labels[i], layout.tick));
    cairo_new_path(pen);
    cairo_move_to(pen, plot.x, y);
    cairo_line_to(pen, plot.x - layout.tick_length, y);
    stroke(pen, 1.6, frame_gray);
  }
  write_block(pen, {plot.x + 0.5 * plot.width, layout.x_label_y}, layout.x_label, {0.5});
  const double label_x = plot.x - outside - labels_width - 8 - layout.y_label.height();
  write_block(pen, {label_x, plot.y + 0.5 * plot.height}, layout.y_label, {0.5, ink, true});
}

void check(const Picture& picture) {
  const auto count = static_cast<Eigen::Index>(picture.triangles.size());
  if (picture.values.cols() != 0 && picture.values.cols() != count) {
    throw std::invalid_argument(fmt::format("picture '{}' has values for {} triangles; {} would be right",
                                            picture.title, picture.values.cols(), count));
  }
  for (const auto& triangle : picture.triangles) {
    for (const Index p : triangle) {
      if (p < 0 || static_cast<std::size_t>(p) >= picture.points.size()) {
        throw std::invalid_argument(
            fmt::format("a triangle of picture '{}' names point {} of {}", picture.title, p, picture.points.size()));
      }
    }
  }
}

}  // namespace

std::size_t held(const Picture& p) {
  return p.points.size() * sizeof(Vec2) + p.triangles.size() * sizeof p.triangles[0] +
         sizeof(double) * static_cast<std::size_t>(p.values.size() + p.margin.size());
}

void draw(const std::filesystem::path& path, const Picture& picture) {
  check(picture);
  const Limits scale = limits(picture);
  const Layout layout = lay_out(picture, scale, ruler());

  const Sheet page = sheet(layout.width, layout.height);
  cairo_t* pen = page.pen();
  color(pen, paper);
  cairo_paint(pen);
  write_heading(pen, {layout.title_x, layout.margin}, {layout.title, layout.subtitle});
  cairo_save(pen);
  cairo_rectangle(pen, layout.plot.x, layout.plot.y, layout.plot.width, layout.plot.height);
  cairo_clip(pen);
  cairo_new_path(pen);
  draw_body(pen, layout, picture, scale);
  draw_marks(pen, layout, picture);
  cairo_restore(pen);
  draw_axes(pen, layout);
  if (layout.has_bar) draw_color_bar(pen, layout, picture.scale, scale);

  save(path, page);
}

}  // namespace kerf
