// PNG files by libpng, without filters and with little compression: pictures of kerf have flat areas and few colors, of
// which filters make more. That takes a fifth of the time of Cairo's own writer, whose files are as large.

#include "plot/figure/png.hpp"

#include "kerf/types.hpp"

#include <fmt/core.h>

#include <png.h>

#include <cstdint>
#include <cstring>
#include <new>
#include <vector>

namespace kerf {

std::string png_of(int width, int height, const unsigned char* pixels, int stride) {
  if (width <= 0 || height <= 0 || !pixels) throw Error(Fault::Files, "a picture without pixels cannot be written");
  const auto columns = static_cast<std::size_t>(width), rows = static_cast<std::size_t>(height);
  std::vector<unsigned char> packed(3 * columns * rows);
  unsigned char* out = packed.data();
  for (std::size_t j = 0; j < rows; ++j) {
    const unsigned char* in = pixels + j * static_cast<std::size_t>(stride);
    for (std::size_t i = 0; i < columns; ++i, in += 4, out += 3) {
      std::uint32_t pixel = 0;
      std::memcpy(&pixel, in, 4);
      out[0] = static_cast<unsigned char>(pixel >> 16);
      out[1] = static_cast<unsigned char>(pixel >> 8);
      out[2] = static_cast<unsigned char>(pixel);
    }
  }
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = PNG_FORMAT_RGB;
  image.flags = PNG_IMAGE_FLAG_FAST;  // no filters, level 3
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string bytes(size, '\0');
  if (!png_image_write_to_memory(&image, bytes.data(), &size, 0, packed.data(), 0, nullptr)) {
    const std::string why = image.message;
    png_image_free(&image);
    if (why.find("memory") != std::string::npos) throw std::bad_alloc();
    throw Error(Fault::Files, fmt::format("cannot write a picture as PNG: {}", why));
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace kerf
