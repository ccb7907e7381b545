#pragma once
// A little JSON, written; safe inside an element script.

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kerf {

/// In quotes; what could end the element, or the text, as \u escapes.
std::string json_text(std::string_view text);
/// null for what is not finite.
std::string json_number(double value);
std::string json_numbers(std::span<const double> values);

/// {"name": value, ...}; values arrive as JSON.
class JsonObject {
 public:
  JsonObject& add(std::string_view name, const std::string& value);
  JsonObject& text(std::string_view name, std::string_view value);
  JsonObject& number(std::string_view name, double value);
  std::string done() const;

 private:
  std::string inside_;
};

std::string json_list(std::span<const std::string> values);
std::string json_texts(std::span<const std::string> values);

}  // namespace kerf
