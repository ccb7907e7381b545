// Objects and lists of JSON, written in their order, safe inside an HTML element.

#include "plot/page/json.hpp"

#include "io/text.hpp"

#include <fmt/format.h>

#include <cmath>

namespace kerf {

std::string json_text(std::string_view text) {
  std::string out = "\"";
  for (const char c : clean_text(text)) {
    if (c == '"' || c == '\\')
      out += {'\\', c};
    else if (c == '<' || c == '>' || c == '&')
      out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    else
      out += c;
  }
  return out + '"';
}

std::string json_number(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : std::string("null");
}

std::string json_numbers(std::span<const double> values) {
  std::string out = "[";
  for (const double value : values) {
    if (out.size() > 1) out += ',';
    out += json_number(value);
  }
  return out + ']';
}

JsonObject& JsonObject::add(std::string_view name, const std::string& value) {
  if (!inside_.empty()) inside_ += ",\n";
  inside_ += json_text(name) + ": " + value;
  return *this;
}

JsonObject& JsonObject::text(std::string_view name, std::string_view value) {
  return add(name, json_text(value));
}

JsonObject& JsonObject::number(std::string_view name, double value) {
  return add(name, json_number(value));
}

std::string JsonObject::done() const {
  return "{" + inside_ + "}";
}

std::string json_list(std::span<const std::string> values) {
  std::string out = "[";
  for (const std::string& value : values) {
    if (out.size() > 1) out += ',';
    out += value;
  }
  return out + ']';
}

std::string json_texts(std::span<const std::string> values) {
  std::vector<std::string> out;
  for (const std::string& value : values) out.push_back(json_text(value));
  return json_list(out);
}

}  // namespace kerf
