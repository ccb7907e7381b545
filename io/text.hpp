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

/// A page of HTML up to <body>: `policy` is its Content-Security-Policy, `more` what its head has besides; all but the
/// title, which is cleaned, is HTML as it is.
std::string html_head(std::string_view title, std::string_view policy, std::string_view style,
                      std::string_view more = {});

std::string base64(std::string_view bytes);

}  // namespace kerf
