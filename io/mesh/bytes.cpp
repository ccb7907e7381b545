// The bytes of a mesh file, read forwards: words of text and numbers of memory. A number must use its whole word and
// fit its type. count() bounds what a section announces by the bytes that are left, since each thing has a least size,
// so that a damaged count costs no memory. Every error has its place: file and line in text, section and byte in
// memory, where a line has no meaning. After a section in memory the end mark is text again. Numbers are taken in the
// order of bytes of the machine; read_msh.cpp refuses files of the other order.

#include "io/mesh/bytes.hpp"

#include "io/words.hpp"
#include "kerf/types.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

namespace kerf {

namespace {

bool blank(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

}  // namespace

void MeshBytes::fail(const std::string& what) const {
  if (binary_) throw Error(Fault::Geometry, fmt::format("{}: {}, byte {}: {}", name_, section_, at_, what));
  const auto line = 1 + std::count(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(at_), '\n');
  throw Error(Fault::Geometry, fmt::format("{}:{}: {}", name_, line, what));
}

bool MeshBytes::skip_blanks() {
  while (at_ < bytes_.size() && blank(bytes_[at_])) ++at_;
  return at_ < bytes_.size();
}

std::string_view MeshBytes::word() {
  if (!skip_blanks()) fail(fmt::format("the file ends inside {}; it is cut off", section_));
  const std::size_t begin = at_;
  while (at_ < bytes_.size() && !blank(bytes_[at_])) ++at_;
  return bytes_.substr(begin, at_ - begin);
}

std::string_view MeshBytes::rest_of_line() {
  const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
  const std::string_view line = bytes_.substr(at_, end - at_);
  at_ = std::min(end + 1, bytes_.size());
  return line.ends_with('\r') ? line.substr(0, line.size() - 1) : line;
}

std::string MeshBytes::quoted() {
  if (!skip_blanks()) fail(fmt::format("the file ends inside {}; it is cut off", section_));
  const std::string_view line = rest_of_line();
  if (bytes_[at_ - 1] == '\n') --at_;  // what is wrong with the name is wrong in its line
  const std::size_t end = line.rfind('"');
  if (line.front() != '"' || end == 0) fail(fmt::format("{}: a name in quotation marks is missing", section_));
  return std::string(line.substr(1, end - 1));
}

template <typename Number>
Number MeshBytes::memory() {
  Number value;
  if (bytes_.size() - at_ < sizeof value) {
    at_ = bytes_.size();
    fail("the file ends here; it is cut off");
  }
  std::memcpy(&value, bytes_.data() + at_, sizeof value);
  at_ += sizeof value;
  return value;
}

template <typename Number>
Number MeshBytes::text() {
  const std::string_view found = word();
  const char* begin = found.data() + (found.starts_with('+') ? 1 : 0);
  Number value{};
  const auto [end, error] = std::from_chars(begin, found.data() + found.size(), value);
  if (error != std::errc() || end != found.data() + found.size())
    fail(
        fmt::format("{} is no {}, or too large", quote(found), std::is_integral_v<Number> ? "whole number" : "number"));
  return value;
}

std::int32_t MeshBytes::whole32() {
  return binary_ ? memory<std::int32_t>() : text<std::int32_t>();
}

std::int64_t MeshBytes::whole64() {
  return binary_ ? memory<std::int64_t>() : text<std::int64_t>();
}

double MeshBytes::real() {
  const double value = binary_ ? memory<double>() : text<double>();
  if (!std::isfinite(value)) fail("a number is not finite");
  return value;
}

std::int64_t MeshBytes::text_whole() {
  return text<std::int64_t>();
}

std::int64_t MeshBytes::count(std::int64_t n, std::string_view of, std::int64_t text_bytes,
                              std::int64_t memory_bytes) const {
  const std::int64_t each = binary_ ? memory_bytes : text_bytes, left = static_cast<std::int64_t>(bytes_.size() - at_);
  if (n < 0 || n > left / each + 1)
    fail(fmt::format("{} announces {} {}, which the rest of the file cannot hold; it is cut off or damaged", section_,
                     n, of));
  return n;
}

void MeshBytes::leave() {
  binary_ = false;
  const std::string end = "$End" + section_.substr(1);
  if (const std::string_view found = word(); found != end)
    fail(fmt::format("{} stands where {} ends; the counts at its beginning are wrong, or it is damaged", quote(found),
                     section_));
}

void MeshBytes::skip_section() {
  binary_ = false;
  const std::string end = "\n$End" + section_.substr(1);
  const std::size_t found = bytes_.find(end, at_ > 0 ? at_ - 1 : 0);
  if (found == std::string_view::npos) fail(fmt::format("{} has no end; the file is cut off", section_));
  at_ = found + end.size();
}

}  // namespace kerf
