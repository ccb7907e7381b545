// Texts and numbers for people: six digits without "-0", places, text of users without control characters and invalid
// UTF-8, text inside HTML, bytes as base64. sequence() accepts exactly the sequences of UTF-8: no overlong forms (0xC0,
// 0xC1 and three or four bytes for what fits fewer), no surrogates, nothing beyond U+10FFFF. What it refuses becomes
// U+FFFD byte by byte, so that the text after a broken sequence is kept.

#include "io/text.hpp"

#include <fmt/core.h>

#include <cmath>
#include <cstdint>

namespace kerf {

std::string with_blank(const std::string& unit) {
  return unit.empty() ? unit : " " + unit;
}

std::string six(double value) {
  if (!std::isfinite(value)) return "-";
  return fmt::format("{:.6g}", value == 0 ? 0.0 : value);  // no "-0"
}

std::string place(const Vec2& p) {
  return fmt::format("({}, {})", six(p.x()), six(p.y()));
}

double degrees(double radians) {
  return radians * 180 / pi;
}

namespace {

/// Bytes of the valid UTF-8 sequence that starts at `i`, or 0.
std::size_t sequence(std::string_view text, std::size_t i) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned first = byte(i);
  if (first < 0x80) return 1;
  const std::size_t count = first >= 0xF0 && first < 0xF5   ? 4
                            : first >= 0xE0 && first < 0xF0 ? 3
                            : first >= 0xC2                 ? 2
                                                            : 0;
  if (count == 0 || first >= 0xF5 || i + count > text.size()) return 0;
  std::uint32_t code = first & (0x7Fu >> count);
  for (std::size_t k = 1; k < count; ++k) {
    if ((byte(i + k) & 0xC0) != 0x80) return 0;
    code = code << 6 | (byte(i + k) & 0x3F);
  }
  const bool overlong = (count == 3 && code < 0x800) || (count == 4 && code < 0x10000);
  const bool surrogate = code >= 0xD800 && code < 0xE000;
  return overlong || surrogate || code > 0x10FFFF ? 0 : count;
}

}  // namespace

std::string clean_text(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t count = sequence(text, i);
    const auto first = static_cast<unsigned char>(text[i]);
    if (count == 0) {
      out += "\xEF\xBF\xBD";
    } else if (count == 1 && (first < 0x20 || first == 0x7F)) {
      out += ' ';
    } else {
      out += text.substr(i, count);
    }
    i += count == 0 ? 1 : count;
  }
  return out;
}

std::string escape_html(std::string_view text) {
  std::string out;
  for (const char c : clean_text(text)) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string base64(std::string_view bytes) {
  static constexpr char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      word = word << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    }
    for (std::size_t k = 0; k < 4; ++k) out += i + k <= bytes.size() ? letters[word >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

std::string html_head(std::string_view title, std::string_view policy, std::string_view style, std::string_view more) {
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n{}<title>{}</title>\n<style>{}</style>\n"
      "</head>\n<body>\n",
      policy, more, escape_html(title), style);
}

}  // namespace kerf
