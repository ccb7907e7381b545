// Bodies in rows, each with a title and a caption: frame, body, supports, loads. All panels have one scale, pixels per
// length, times that of their row: the largest up to 205 with which the widest panel fits the page. A row that is too
// long goes on in the next line. A panel is at least 300 pixels wide, so that its texts can be read.

#include "plot/gallery.hpp"

#include "io/text.hpp"
#include "plot/figure/frame.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

constexpr double gallery_width = 2000, gallery_margin = 40, gallery_gap = 36,
                 length_scale = 205;  // pixels per length, at most
constexpr std::uint32_t own_body = 0x1f5a8a, other_body = 0x6b747d, void_gray = 0xf1f3f5, gallery_frame_line = 0xc3cad1,
                        support_green = 0x00785a, gallery_load_orange = 0xd55e00;
const Font row_font{28, true}, panel_font{22, true}, caption_font{20};

struct Extent {
  Vec2 low = Vec2::Constant(infinity), high = -low;
  void take(const std::vector<Polyline>& lines) {
    for (const Polyline& line : lines)
      for (const Vec2& p : line) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
      }
  }
  Vec2 size() const {
    return (high - low).cwiseMax(Vec2::Constant(1e-9));
  }
};

Extent extent(const GalleryPanel& panel) {
  Extent e;
  e.take(panel.frame);
  e.take(panel.body);
  if (!e.low.allFinite() || !e.high.allFinite()) e.low = Vec2::Zero(), e.high = Vec2::Ones();
  return e;
}

struct PlacedBody {
  const GalleryPanel* panel;
  Extent extent;
  double x, y, width, height;  // of the body
  double scale;                // pixels per length
};

void trace_on_panel(cairo_t* pen, const PlacedBody& at, const Polyline& line, bool closed) {
  for (std::size_t i = 0; i < line.size(); ++i) {
    const Vec2 p = at.scale * (line[i] - at.extent.low);
    const double x = at.x + p.x(), y = at.y + at.height - p.y();
    i == 0 ? cairo_move_to(pen, x, y) : cairo_line_to(pen, x, y);
  }
  if (closed) cairo_close_path(pen);
}

void draw_gallery_panel(cairo_t* pen, const PlacedBody& at, double title_width, const Measure& measure) {
  const GalleryPanel& panel = *at.panel;
  const auto paths = [&](const std::vector<Polyline>& lines, bool closed) {
    cairo_new_path(pen);
    for (const Polyline& line : lines) trace_on_panel(pen, at, line, closed);
  };
  cairo_set_fill_rule(pen, CAIRO_FILL_RULE_EVEN_ODD);
  paths(panel.frame, true);
  color(pen, void_gray);
  cairo_fill_preserve(pen);
  stroke(pen, 1.5, gallery_frame_line);
  paths(panel.body, true);
  color(pen, panel.accent ? own_body : other_body);
  cairo_fill(pen);
  cairo_set_line_cap(pen, CAIRO_LINE_CAP_BUTT);
  paths(panel.supports, false);
  stroke(pen, 7, support_green);
  paths(panel.loads, false);
  stroke(pen, 7, gallery_load_orange);
  const Lines title = wrap(panel.title, panel_font, {title_width, 13, 1}, measure);
  const Lines caption = wrap(panel.caption, caption_font, {title_width, 13, 1}, measure);
  write_block(pen, {at.x, at.y + at.height + 8}, title);
  write_block(pen, {at.x, at.y + at.height + 8 + 1.3 * panel_font.size}, caption, {0, gray});
}

}  // namespace

void draw(const std::filesystem::path& path, const Gallery& gallery) {
  const Measure measure = ruler();
  double widest = 0;
  for (const GalleryRow& row : gallery.rows)
    for (const GalleryPanel& panel : row.panels) widest = std::max(widest, row.scale * extent(panel).size().x());
  const double room = gallery_width - 2 * gallery_margin;
  const double scale = widest > 0 ? std::min(length_scale, room / widest) : length_scale;
  constexpr double least_width = 300;  // of a panel, so that its texts can be read

  const Heading head = heading(gallery.title, gallery.subtitle, room, 2, measure);
  const double texts = 8 + 1.3 * (panel_font.size + caption_font.size);
  double y = head.bottom(gallery_margin) + 14;
  std::vector<PlacedBody> placed;
  std::vector<std::pair<double, const GalleryRow*>> headings;
  for (const GalleryRow& row : gallery.rows) {
    y += 22;
    headings.emplace_back(y, &row);
    y += 1.3 * row_font.size + 10;
    double x = gallery_margin, line = 0;
    for (const GalleryPanel& panel : row.panels) {
      const Extent e = extent(panel);
      const Vec2 size = row.scale * scale * e.size();
      const double width = std::max(size.x(), least_width);
      if (x > gallery_margin && x + width > gallery_margin + room) {
        x = gallery_margin;
        y += line + texts + 18;
        line = 0;
      }
      placed.push_back({&panel, e, x, y, size.x(), size.y(), row.scale * scale});
      x += width + gallery_gap;
      line = std::max(line, size.y());
    }
    y += line + texts + 10;
  }

  const Sheet page =
      page_with(head, gallery_margin, static_cast<int>(gallery_width), static_cast<int>(y + gallery_margin));
  cairo_t* pen = page.pen();
  for (const auto& [at, row] : headings)
    write_block(pen, {gallery_margin, at}, wrap(row->title, row_font, {room, 18, 1}, measure));
  for (const PlacedBody& p : placed) draw_gallery_panel(pen, p, std::max(p.width, least_width), measure);
  save(path, page);
}

}  // namespace kerf
