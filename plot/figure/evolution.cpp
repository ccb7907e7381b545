// Designs of an optimization side by side: the body dark on what it filled in the beginning. All drawings have one
// scale. The number of columns, 1 to 6, is the one that makes drawings largest on a page of at most 1600 x 1450 pixels,
// area times the square of the share of places that are filled: one place left empty in the last row counts against a
// number. Below 760 pixels of height per drawing.

#include "plot/evolution.hpp"

#include "plot/figure/frame.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr std::uint32_t material = 0x2f3d4c, evolution_crack_red = 0xe0232e, frame_fill = 0xeff2f5,
                        frame_line = 0xc9d1d8;
constexpr double evolution_margin = 34, evolution_gap = 30, widest_evolution = 1600;
constexpr double caption_size = 24, words_size = 21;
const Font caption{caption_size, true}, words{words_size};
constexpr double heading_height = 1.3 * caption_size + 1.3 * words_size + 10;  // of a drawing

struct View {
  Vec2 low, high;
};

View view_of(const std::vector<Snapshot>& snapshots) {
  View v{Vec2::Constant(infinity), Vec2::Constant(-infinity)};
  for (const Snapshot& s : snapshots)
    for (const auto& loop : s.contours.boundary)
      for (const Vec2& p : loop)
        if (p.allFinite()) v = {v.low.cwiseMin(p), v.high.cwiseMax(p)};
  if (!v.low.allFinite()) v = {Vec2::Zero(), Vec2::Ones()};
  const double size = std::max((v.high - v.low).maxCoeff(), 1e-300);
  v.high = v.high.cwiseMax(v.low + Vec2::Constant(1e-3 * size));
  return v;
}

struct Grid {
  std::size_t columns = 1;
  double width = 0, height = 0;  // of a drawing
};

/// As large as they can be on a page not much higher than wide.
Grid arrange(std::size_t count, double aspect, double heading) {
  Grid best;
  double largest = 0;
  for (std::size_t columns = 1; columns <= std::min<std::size_t>(count, 6); ++columns) {
    const double rows = std::ceil(static_cast<double>(count) / static_cast<double>(columns));
    const double room = widest_evolution - 2 * evolution_margin - evolution_gap * static_cast<double>(columns - 1);
    double width = room / static_cast<double>(columns), height = width / aspect;
    const double most = (1450 - evolution_margin - rows * (heading + evolution_gap)) / rows;
    if (height > most) {
      height = most;
      width = height * aspect;
    }
    if (height > 760) height = 760, width = height * aspect;
    // An empty place in the last row counts against it.
    const double full = static_cast<double>(count) / (rows * static_cast<double>(columns));
    if (width * height * full * full > largest) {
      largest = width * height * full * full;
      best = {columns, width, height};
    }
  }
  return best;
}

/// A drawing: its upper left corner, and how lengths of the body become pixels.
struct Cell {
  double x, y;  // of its heading
  Vec2 corner;  // lower left, of the body
  Vec2 low;     // the point there
  double scale;
};

void trace_in_cell(cairo_t* pen, const Cell& cell, const std::vector<std::vector<Vec2>>& lines, bool close) {
  cairo_new_path(pen);
  for (const auto& points : lines) {
    cairo_new_sub_path(pen);
    for (const Vec2& p : points) {
      const Vec2 at(cell.corner.x() + (p.x() - cell.low.x()) * cell.scale,
                    cell.corner.y() - (p.y() - cell.low.y()) * cell.scale);
      if (at.allFinite()) cairo_line_to(pen, at.x(), at.y());
    }
    if (close) cairo_close_path(pen);
  }
}

/// `start`: what the body filled in the beginning.
void draw_contours(cairo_t* pen, const Cell& cell, const Contours& body, const Contours& start) {
  cairo_set_line_join(pen, CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_cap(pen, CAIRO_LINE_CAP_ROUND);
  trace_in_cell(pen, cell, start.boundary, true);
  cairo_set_fill_rule(pen, CAIRO_FILL_RULE_EVEN_ODD);
  color(pen, frame_fill);
  cairo_fill_preserve(pen);
  stroke(pen, 1.2, frame_line);
  trace_in_cell(pen, cell, body.boundary, true);
  color(pen, material);
  cairo_fill_preserve(pen);
  stroke(pen, 1.2, material);
  trace_in_cell(pen, cell, body.cracks, false);
  stroke(pen, 4.5, paper, 0.9);
  trace_in_cell(pen, cell, body.cracks, false);
  stroke(pen, 2.4, evolution_crack_red);
}

void write_caption(cairo_t* pen, const Cell& cell, const Snapshot& s, double width, const Measure& measure) {
  write(pen, {cell.x, cell.y + 0.65 * caption.size}, s.iteration == 0 ? "start" : fmt::format("{}", s.iteration),
        caption);
  const std::string text = fmt::format("J = {}, volume {:.3f}", pretty(s.objective, 5), s.volume_fraction);
  write_block(pen, {cell.x, cell.y + 1.3 * caption.size}, wrap(text, words, {width, 13, 1}, measure), {0, gray});
}

}  // namespace

void draw(const std::filesystem::path& path, const Evolution& evolution) {
  const Measure measure = ruler();
  const std::vector<Snapshot>& all = evolution.snapshots;
  const View view = view_of(all);
  const Vec2 size = view.high - view.low;
  const double aspect = std::clamp(size.x() / size.y(), 0.1, 10.0);
  const std::size_t count = std::max<std::size_t>(all.size(), 1);
  const Grid grid = arrange(count, aspect, heading_height);
  const std::size_t rows = (count + grid.columns - 1) / grid.columns;
  const double used = static_cast<double>(grid.columns) * (grid.width + evolution_gap) - evolution_gap;
  const double page_width = std::max(900.0, used + 2 * evolution_margin);
  const Heading head = heading(evolution.title, evolution.subtitle, page_width - 2 * evolution_margin, 3, measure);
  const double top = head.bottom(evolution_margin) + 22, pitch = heading_height + grid.height + evolution_gap;
  const double page_height = top + static_cast<double>(rows) * pitch - evolution_gap + evolution_margin;
  const Sheet page = page_with(head, evolution_margin, static_cast<int>(std::ceil(page_width)),
                               static_cast<int>(std::ceil(page_height)));
  const double scale = std::min(grid.width / size.x(), grid.height / size.y()), left = 0.5 * (page_width - used);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double x = left + static_cast<double>(i % grid.columns) * (grid.width + evolution_gap);
    const double y = top + static_cast<double>(i / grid.columns) * pitch;
    const Vec2 corner(x + 0.5 * (grid.width - scale * size.x()),
                      y + heading_height + 0.5 * (grid.height + scale * size.y()));
    const Cell cell{x, y, corner, view.low, scale};
    write_caption(page.pen(), cell, all[i], grid.width, measure);
    draw_contours(page.pen(), cell, all[i].contours, all.front().contours);
  }
  save(path, page);
}

}  // namespace kerf
