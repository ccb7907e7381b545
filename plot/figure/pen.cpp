// Drawing with cairo: sheets, colors, text, images, PNG. Letters are drawn without hinting, so that widths of texts are
// proportional to their size. A sheet is made only where 64 MiB of address space are left: fontconfig does not look at
// what malloc gives, and would end the program. A text is placed by its middle height, 0.365 of the font size above its
// base line, and a line of a block has 1.3 of it. PNGs are made in memory and written as a whole.

#include "plot/figure/pen.hpp"

#include "plot/figure/png.hpp"

#include "base/address_space.hpp"
#include "io/files.hpp"

#include <fmt/core.h>

#include <new>

namespace kerf {

void Destroy::operator()(cairo_surface_t* surface) const {
  cairo_surface_destroy(surface);
}
void Destroy::operator()(cairo_t* context) const {
  cairo_destroy(context);
}

Sheet sheet(int width, int height) {
  // Far more than fontconfig takes, which looks at nothing that malloc gives.
  constexpr std::size_t room = std::size_t{64} << 20;
  if (!has_address_space(room)) throw std::bad_alloc();
  Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height));
  Context context(cairo_create(surface.get()));
  cairo_font_options_t* options = cairo_font_options_create();
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(context.get(), options);
  cairo_font_options_destroy(options);
  cairo_set_line_cap(context.get(), CAIRO_LINE_CAP_ROUND);
  cairo_set_line_join(context.get(), CAIRO_LINE_JOIN_ROUND);
  return {std::move(surface), std::move(context)};
}

void color(cairo_t* pen, std::uint32_t rgb, double alpha) {
  cairo_set_source_rgba(pen, (rgb >> 16 & 255) / 255.0, (rgb >> 8 & 255) / 255.0, (rgb & 255) / 255.0, alpha);
}

void choose(cairo_t* pen, const Font& font) {
  cairo_select_font_face(pen, "DejaVu Sans", font.italic ? CAIRO_FONT_SLANT_ITALIC : CAIRO_FONT_SLANT_NORMAL,
                         font.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(pen, font.size);
}

double text_width(cairo_t* pen, const std::string& text, const Font& font) {
  choose(pen, font);
  cairo_text_extents_t extents;
  cairo_text_extents(pen, text.c_str(), &extents);
  return extents.x_advance;
}

void write(cairo_t* pen, const Vec2& at, const std::string& text, const Font& font, const Setting& how) {
  const double width = text_width(pen, text, font);
  cairo_save(pen);
  cairo_translate(pen, at.x(), at.y());
  if (how.upright) cairo_rotate(pen, -0.5 * pi);
  cairo_move_to(pen, -how.anchor * width, 0.365 * font.size);
  color(pen, how.rgb);
  cairo_show_text(pen, text.c_str());
  cairo_restore(pen);
}

void write_block(cairo_t* pen, const Vec2& at, const Lines& lines, const Setting& how) {
  const double pitch = 1.3 * lines.font.size;
  for (std::size_t i = 0; i < lines.text.size(); ++i) {
    const double off = (static_cast<double>(i) + 0.5) * pitch;
    write(pen, how.upright ? Vec2(at.x() + off, at.y()) : Vec2(at.x(), at.y() + off), lines.text[i], lines.font, how);
  }
}

void stroke(cairo_t* pen, double width, std::uint32_t rgb, double alpha) {
  cairo_set_line_width(pen, width);
  color(pen, rgb, alpha);
  cairo_stroke(pen);
}

void put(cairo_t* pen, Image& image, const Vec2& at) {
  const Surface source(cairo_image_surface_create_for_data(reinterpret_cast<unsigned char*>(image.pixels.data()),
                                                           CAIRO_FORMAT_ARGB32, image.width, image.height,
                                                           4 * image.width));
  cairo_set_source_surface(pen, source.get(), at.x(), at.y());
  cairo_paint(pen);
  color(pen, ink);  // lets go of the source before its pixels
}

Measure ruler() {
  const auto page = std::make_shared<const Sheet>(sheet(1, 1));
  return [page](const std::string& text, const Font& font) { return text_width(page->pen(), text, font); };
}

void save(const std::filesystem::path& path, const Sheet& page) {
  if (const cairo_status_t status = cairo_status(page.pen()); status != CAIRO_STATUS_SUCCESS)
    throw Error(Fault::Files, fmt::format("cannot draw '{}': {}", path.string(), cairo_status_to_string(status)));
  cairo_surface_t* const surface = page.surface.get();
  cairo_surface_flush(surface);
  write_file(path, png_of(cairo_image_surface_get_width(surface), cairo_image_surface_get_height(surface),
                          cairo_image_surface_get_data(surface), cairo_image_surface_get_stride(surface)));
}

}  // namespace kerf
