// The table of keys as a JSON Schema (draft 2020-12), for editors. A row becomes the schema of its types (anyOf where
// there are several), with range, words, default and text; a table becomes an object that allows its own keys only,
// with `required`, `oneOf` for keys that exclude each other, and `dependentRequired` for keys that go with one other.
// Tables that are like another one refer to it by $ref, so that each is written once. Which keys go with a kind of
// functional or with a method is not expressed: the reader alone checks that.

#include "io/case/keys.hpp"
#include "io/keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace kerf {

namespace {

using enum KeyType;
using Json = nlohmann::ordered_json;

Json with_range(Json number, const KeyRange& range) {
  if (range.least != KeyRange{}.least) number[range.above ? "exclusiveMinimum" : "minimum"] = range.least;
  if (range.most != KeyRange{}.most) number[range.below ? "exclusiveMaximum" : "maximum"] = range.most;
  return number;
}

Json list_of(const Json& item) {
  return {{"type", "array"}, {"items", item}};
}

Json pair_of(const Json& item) {
  return {{"type", "array"}, {"items", item}, {"minItems", 2}, {"maxItems", 2}};
}

/// "#/properties/hole/items/properties/circle" of "hole[].circle".
std::string reference(std::string_view path) {
  std::string out = "#";
  while (!path.empty()) {
    const std::size_t end = std::min(path.find('.'), path.size());
    std::string_view part = path.substr(0, end);
    const bool entries = part.ends_with("[]");
    if (entries) part.remove_suffix(2);
    out += fmt::format("/properties/{}{}", part, entries ? "/items" : "");
    path.remove_prefix(std::min(end + 1, path.size()));
  }
  return out;
}

Json schema_of(const Key& key);

/// What the table of a path holds. Keys that it has because it is like another one refer to that one.
Json object_of(std::string_view path) {
  Json object = {{"type", "object"}, {"properties", Json::object()}, {"additionalProperties", false}};
  Json required = Json::array(), one_of = Json::array(), dependent = Json::object();
  for (const Key* key : keys_in(path)) {
    const std::string called(name(*key));
    const bool own = key->path.starts_with(path) && (path.empty() || key->path.size() > path.size());
    std::string_view there = key->path;
    if (there.ends_with("[]")) there.remove_suffix(2);
    object["properties"][called] = own ? schema_of(*key) : Json{{"$ref", reference(there)}};
    if (key->rules.one_of) one_of.push_back({{"required", {called}}});
    if (!key->rules.required) continue;
    const std::string_view with = key->rules.with;
    if (with.empty())
      required.push_back(called);
    else if (find_key(fmt::format("{}.{}", path, with)))
      dependent[std::string(with)].push_back(called);
  }
  if (!required.empty()) object["required"] = required;
  if (!dependent.empty()) object["dependentRequired"] = dependent;
  if (const Key* table = find_key(path); !one_of.empty() && table && table->rules.bare)
    one_of.push_back({{"not", {{"anyOf", one_of}}}});
  if (!one_of.empty()) object["oneOf"] = one_of;
  return object;
}

/// Of one of the types that a key may have.
Json alternative(const Key& key, KeyType type) {
  const Json number = with_range({{"type", "number"}}, key.rules.range), text = {{"type", "string"}};
  const Json formula = {{"type", {"number", "string"}}}, box = {{"anyOf", {number, pair_of(number)}}};
  switch (type) {
    case Table:
      return key.rules.like.empty() ? object_of(key.path) : Json{{"$ref", reference(key.rules.like)}};
    case Tables:
      return list_of(object_of(key.path));
    case Boolean:
      return {{"type", "boolean"}};
    case Whole:
      return with_range({{"type", "integer"}}, key.rules.range);
    case Number:
      return number;
    case Text:
      return text;
    case Name:
      return {{"type", "string"}, {"pattern", "^[A-Za-z0-9_.-]{1,100}$"}};
    case Word:
      return {{"enum", std::vector<std::string>(key.rules.words.begin(), key.rules.words.end())}};
    case Names:
      return list_of(text);
    case Pair:
      return pair_of(number);
    case PointList: {
      const std::string entry = std::string(key.path) + "[]";
      const Json point = pair_of(number);
      return list_of(keys_in(entry).empty() ? point : Json{{"anyOf", {point, object_of(entry)}}});
    }
    case Numbers:
      return list_of(number);
    case Formula:
      return formula;
    case Vector:
      return pair_of(formula);
    case Box:
      return box;
    case BoxPair:
      return pair_of(box);
    case BoxPairs:
      return list_of(pair_of(box));
    case Formulas:
      return {{"type", "object"}, {"additionalProperties", formula}};
    case Tensor:
      return {{"type", "array"}, {"items", formula}, {"minItems", 3}, {"maxItems", 4}};
  }
  return {};
}

Json schema_of(const Key& key) {
  Json any = Json::array();
  for (unsigned bit = 1; bit <= static_cast<unsigned>(Tensor); bit <<= 1)
    if (const auto type = static_cast<KeyType>(bit); has(key.type, type)) any.push_back(alternative(key, type));
  Json out = any.size() == 1 ? any[0] : Json{{"anyOf", any}};
  out["description"] = key.text;
  if (const Json value = Json::parse(key.otherwise, nullptr, false); !value.is_discarded()) out["default"] = value;
  return out;
}

}  // namespace

std::string keys_as_schema() {
  Json schema = {{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "A case file of kerf"}};
  schema.update(object_of(""));
  return schema.dump(2) + "\n";
}

}  // namespace kerf
