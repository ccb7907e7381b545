#pragma once
// Numbers and names as text for people.

#include "kerf/types.hpp"

#include <string>
#include <string_view>

namespace kerf {

/// Six significant digits; "-" when not finite.
std::string six(double value);

/// " MPa"; nothing without a unit.
std::string with_blank(const std::string& unit);

/// "(1, 2)", six digits each.
std::string place(const Vec2& p);

/// Of an angle in radians.
double degrees(double radians);

/// Invalid UTF-8 becomes U+FFFD, control characters and line ends become spaces.
std::string clean_text(std::string_view text);

/// Cleaned, and & < > " ' as entities.
std::string escape_html(std::string_view text);

std::string base64(std::string_view bytes);

}  // namespace kerf
