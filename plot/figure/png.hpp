#pragma once
// Pixels as the bytes of a PNG file.

#include <string>

namespace kerf {

/// `pixels`: rows of 32-bit words 0x??RRGGBB in the order of the machine, `stride` bytes apart; a picture without
/// transparency. Throws Error(Files) for one without pixels, std::bad_alloc where there is no memory.
std::string png_of(int width, int height, const unsigned char* pixels, int stride);

}  // namespace kerf
