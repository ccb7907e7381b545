#pragma once
// Ink on paper: what pictures and charts share. The only header that includes Cairo's.

#include "plot/figure/layout.hpp"
#include "plot/figure/raster.hpp"

#include <cairo.h>

#include <filesystem>
#include <memory>

namespace kerf {

inline constexpr std::uint32_t ink = 0x1c242c, gray = 0x5a6570, paper = 0xffffff, frame_gray = 0x8a949e,
                               interface_orange = 0xb5531c;

struct Destroy {
  void operator()(cairo_surface_t* surface) const;
  void operator()(cairo_t* context) const;
};
using Surface = std::unique_ptr<cairo_surface_t, Destroy>;
using Context = std::unique_ptr<cairo_t, Destroy>;

struct Sheet {
  Surface surface;
  Context context;
  cairo_t* pen() const {
    return context.get();
  }
};
Sheet sheet(int width, int height);

void color(cairo_t* pen, std::uint32_t rgb, double alpha = 1);
void stroke(cairo_t* pen, double width, std::uint32_t rgb, double alpha = 1);
void choose(cairo_t* pen, const Font& font);
double text_width(cairo_t* pen, const std::string& text, const Font& font);
Measure ruler();

/// How text is set: `anchor` 0, 1/2, 1: its left end, its middle or its right end is at the given point.
struct Setting {
  double anchor = 0;
  std::uint32_t rgb = ink;
  bool upright = false;  // read from the right
};

/// `at`: half way up the capitals.
void write(cairo_t* pen, const Vec2& at, const std::string& text, const Font& font, const Setting& how = {});

/// Lines below each other, the first at the top of the block at `y`; upright: beside each other from `at` to the right.
void write_block(cairo_t* pen, const Vec2& at, const Lines& lines, const Setting& how = {});

/// Puts pixels of ours at an integer place.
void put(cairo_t* pen, Image& image, const Vec2& at);

/// As a PNG. Throws Error(Files) naming the path.
void save(const std::filesystem::path& path, const Sheet& page);

}  // namespace kerf
