// A PNG made smaller, with fewer shades: for pictures in documents.

#include "plot/shrink.hpp"

#include "plot/figure/pen.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf {

namespace {

/// Smooth shades to steps of 8 of 255: half the bytes of a compressed picture, and no step that one sees.
void use_fewer_colors(cairo_surface_t* surface) {
  cairo_surface_flush(surface);
  unsigned char* const bytes = cairo_image_surface_get_data(surface);
  const int stride = cairo_image_surface_get_stride(surface), height = cairo_image_surface_get_height(surface);
  std::transform(bytes, bytes + static_cast<std::ptrdiff_t>(stride) * height, bytes,
                 [](unsigned char value) { return static_cast<unsigned char>(std::min(255, (value + 4) / 8 * 8)); });
  cairo_surface_mark_dirty(surface);
}

}  // namespace

void shrink(const std::filesystem::path& from, const std::filesystem::path& to, int width) {
  const Surface large(cairo_image_surface_create_from_png(from.c_str()));
  if (const cairo_status_t status = cairo_surface_status(large.get()); status != CAIRO_STATUS_SUCCESS)
    throw Error(Fault::Files, fmt::format("cannot read {}: {}", from.string(), cairo_status_to_string(status)));
  const double ratio = static_cast<double>(width) / cairo_image_surface_get_width(large.get());
  const Sheet page = sheet(width, static_cast<int>(std::ceil(ratio * cairo_image_surface_get_height(large.get()))));
  color(page.pen(), paper);
  cairo_paint(page.pen());
  cairo_scale(page.pen(), ratio, ratio);
  cairo_set_source_surface(page.pen(), large.get(), 0, 0);
  cairo_pattern_set_filter(cairo_get_source(page.pen()), CAIRO_FILTER_BEST);
  cairo_paint(page.pen());
  use_fewer_colors(page.surface.get());
  save(to, page);
}

}  // namespace kerf
