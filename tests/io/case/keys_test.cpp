// The table of keys against the library's defaults, the document and the schema of docs, every case of the folder of
// cases, and what bash offers.

#include "io/case/keys.hpp"
#include "io/case/key_facts.hpp"

#include "io/case/reader.hpp"
#include "io/keys.hpp"
#include "kerf/element.hpp"
#include "tests/io/case/case_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

namespace kerf::keys_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const fs::path docs = fs::path(KERF_CASES) / ".." / "docs";

json to_json(const Node& node) {
  switch (node.kind) {
    case Node::Kind::Boolean:
      return node.boolean;
    case Node::Kind::Integer:
    case Node::Kind::Float:
      return node.number;
    case Node::Kind::Array: {
      json out = json::array();
      for (const Node& item : node.items) out.push_back(to_json(item));
      return out;
    }
    case Node::Kind::Table: {
      json out = json::object();
      for (const Entry& entry : node.entries) out[entry.key] = to_json(entry.value);
      return out;
    }
    default:
      return node.text;
  }
}

/// What is wrong with a value, by the words of JSON Schema that the schema uses; empty: nothing.
std::string wrong(const json& value, const json& schema, const json& root, const std::string& path = "");

std::string wrong_object(const json& value, const json& schema, const json& root, const std::string& path) {
  for (const auto& [key, item] : value.items()) {
    const bool known = schema.contains("properties") && schema["properties"].contains(key);
    const json more = schema.value("additionalProperties", json(true));
    if (!known && more == json(false)) return path + ": unknown " + key;
    const std::string said = wrong(item, known ? schema["properties"][key] : more, root, path + "." + key);
    if (!said.empty()) return said;
  }
  for (const json& key : schema.value("required", json::array()))
    if (!value.contains(key)) return path + ": missing " + key.get<std::string>();
  const json dependent = schema.value("dependentRequired", json::object());
  for (const auto& [key, needed] : dependent.items())
    for (const json& other : needed)
      if (value.contains(key) && !value.contains(other)) return path + ": missing " + other.get<std::string>();
  return "";
}

std::string wrong_type(const json& value, const json& type) {
  const auto is = [&](const std::string& name) {
    return (name == "object" && value.is_object()) || (name == "array" && value.is_array()) ||
           (name == "string" && value.is_string()) || (name == "boolean" && value.is_boolean()) ||
           (name == "number" && value.is_number()) ||
           (name == "integer" && value.is_number() && std::floor(value.get<double>()) == value.get<double>());
  };
  const json names = type.is_array() ? type : json::array({type});
  return std::any_of(names.begin(), names.end(), is) ? "" : "not " + type.dump();
}

std::string wrong(const json& value, const json& schema, const json& root, const std::string& path) {
  if (schema.is_boolean()) return "";
  if (schema.contains("$ref")) {
    const json& other = root.at(json::json_pointer(schema["$ref"].get<std::string>().substr(1)));
    if (const std::string said = wrong(value, other, root, path); !said.empty()) return said;
  }
  for (const char* some : {"anyOf", "oneOf"})
    if (schema.contains(some)) {
      std::string first;
      int fits = 0;
      for (const json& one : schema[some]) {
        const std::string said = wrong(value, one, root, path);
        fits += said.empty() ? 1 : 0;
        first += said + " ";
      }
      if (fits == 0 || (some == std::string("oneOf") && fits > 1)) return path + ": " + some + ": " + first;
    }
  if (schema.contains("not") && wrong(value, schema["not"], root, path).empty()) return path + ": what must not be";
  if (schema.contains("type"))
    if (const std::string said = wrong_type(value, schema["type"]); !said.empty()) return path + ": " + said;
  if (schema.contains("enum") && std::count(schema["enum"].begin(), schema["enum"].end(), value) == 0)
    return path + ": not one of " + schema["enum"].dump();
  if (schema.contains("pattern") &&
      !std::regex_match(value.get<std::string>(), std::regex(schema["pattern"].get<std::string>())))
    return path + ": does not look like " + schema["pattern"].dump();
  if (value.is_number()) {
    const double x = value.get<double>(), inf = infinity;
    if (x < schema.value("minimum", -inf) || x > schema.value("maximum", inf) ||
        x <= schema.value("exclusiveMinimum", -inf) || x >= schema.value("exclusiveMaximum", inf))
      return path + ": out of range";
  }
  if (value.is_array()) {
    if (value.size() < schema.value("minItems", 0u) || value.size() > schema.value("maxItems", 1000000000u))
      return path + ": length";
    if (schema.contains("items"))
      for (const json& item : value)
        if (const std::string said = wrong(item, schema["items"], root, path + "[]"); !said.empty()) return said;
  }
  return value.is_object() ? wrong_object(value, schema, root, path) : "";
}

std::string wrong_case(const std::string& text) {
  const TemporaryFolder folder;
  static const json schema = json::parse(keys_as_schema());
  return wrong(to_json(read_document(folder.write("a.toml", text))), schema, schema);
}

TEST(Keys, ReadAsATable) {
  std::set<std::string_view> paths;
  for (const Key& key : all_keys()) {
    const std::string path(key.path);
    EXPECT_TRUE(paths.insert(key.path).second) << path << " has two rows";
    EXPECT_FALSE(key.text.empty()) << path;
    EXPECT_TRUE(key.text.ends_with('.')) << path;
    EXPECT_EQ(path.ends_with("[]"), has(key.type, KeyType::Tables)) << path;
    EXPECT_EQ(key.rules.words.empty(), !has(key.type, KeyType::Word)) << path;
    EXPECT_TRUE(key.rules.like.empty() || find_key(key.rules.like)) << path;
    EXPECT_EQ(in_words(key.rules.range).empty(), !key.rules.range.limited()) << path;
    if (const std::size_t dot = path.rfind('.'); dot != std::string::npos) {
      const Key* table = find_key(path.substr(0, dot));
      ASSERT_NE(table, nullptr) << path;
      EXPECT_TRUE(has(table->type, KeyType::Table) || has(table->type, KeyType::Tables) ||
                  has(table->type, KeyType::PointList))
          << path;
    }
  }
}

TEST(Keys, ElementsAreThoseThatThereAre) {
  std::set<std::string_view> names;
  for (const Element& e : elements) names.insert(e.name);
  for (const char* path : {"solver.element", "synthetic.element"}) {
    const KeyWords words = find_key(path)->rules.words;
    EXPECT_EQ(std::set<std::string_view>(words.begin(), words.end()), names);
  }
}

TEST(Keys, LieInTablesThatAreLikeOthers) {
  EXPECT_EQ(find_key("synthetic.hole[].circle.radius"), find_key("hole[].circle.radius"));
  EXPECT_EQ(find_key("functional.terms[].terms[].p"), find_key("functional.p"));
  EXPECT_EQ(find_key("optimize.bound[].at_most")->path, "optimize.bound[].at_most");
  EXPECT_EQ(find_key("hole[].ellipse.semi_axes[]"), find_key("hole[].ellipse.semi_axes"));
  EXPECT_EQ(find_key("mesh.sise"), nullptr);
  std::vector<std::string_view> names;
  for (const Key* key : keys_in("optimize.bound[]", "stress_power")) names.push_back(name(*key));
  EXPECT_EQ(names, (std::vector<std::string_view>{"kind", "p", "weight", "at_most", "name"}));
}

// The library's own defaults are what the table says.
TEST(Keys, DefaultsAreThoseOfTheLibrary) {
  const std::string jobs =
      "[mesh]\nadapt = { error = 1 }\n[functional]\nkind = 'compliance'\n"
      "[optimize]\nvolume = { at_most = 0.5 }\nstart = { random = 1, radius = 0.1 }\n";
  const Case c = read(square + "[[crack]]\nname = 'c'\npath = [[0.5, 0.5], [1, 0.5]]\n" + jobs);
  const OptimizeRequest& r = *c.optimize;
  const auto number = [](double x) { return fmt::format("{}", x); };
  const auto quoted = [](std::string_view word) { return fmt::format("\"{}\"", word); };
  const std::map<std::string, std::string> defaults = {
      {"mesh.min_angle", number(c.sizing.min_angle_deg)},
      {"mesh.adapt.max_triangles", number(c.adapt->max_triangles)},
      {"solver.element", quoted(c.element.name)},
      {"solver.degree", number(c.element.degree)},
      {"solver.contact", quoted(word(c.contact))},
      {"solver.backend", quoted(backend_words[static_cast<std::size_t>(c.backend)])},
      {"solver.precision", quoted(precision_words[static_cast<std::size_t>(c.precision)])},
      {"crack[].contact", quoted(word(c.scene.laws[0].kind))},
      {"crack[].friction", number(c.scene.laws[0].friction)},
      {"crack[].tresca", number(c.scene.laws[0].slip_bound)},
      {"bounds.tips", BoundsRequest{}.tips ? "true" : "false"},
      {"map.bounds", c.map_request.bounds ? "true" : "false"},
      {"map.second", c.map_request.second ? "true" : "false"},
      {"output.vtk", c.output.vtk ? "true" : "false"},
      {"output.png", c.output.png ? "true" : "false"},
      {"output.html", c.output.html ? "true" : "false"},
      {"optimize.method", quoted(word(r.method))},
      {"optimize.max_iterations", number(r.max_iterations)},
      {"optimize.nucleate.every", number(r.level_set.nucleate_every)},
      {"optimize.nucleate.fraction", number(r.level_set.nucleate_fraction)},
      {"optimize.move", quoted(move_words[static_cast<std::size_t>(r.level_set.move)])},
      {"optimize.inner_product", quoted(inner_product_words[static_cast<std::size_t>(r.level_set.product)])},
      {"optimize.start.seed", number(r.level_set.start->seed)},
      {"optimize.min_distance", number(r.min_distance)},
      {"load_case[].weight", number(LoadCase{}.weight)},
      {"synthetic.noise", number(Synthetic{}.noise)},
      {"synthetic.seed", number(Synthetic{}.seed)}};
  for (const auto& [path, value] : defaults) EXPECT_EQ(find_key(path)->otherwise, value) << path;
  EXPECT_EQ(std::stod(std::string(find_key("optimize.tolerance")->otherwise)), r.tolerance);
}

TEST(Keys, TextKeepsToAHundredColumns) {
  std::vector<std::string> texts = {keys_as_text()};
  for (const Key& key : all_keys()) texts.push_back(keys_as_text(key.path));
  for (const std::string& text : texts) {
    std::stringstream lines(text);
    for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100u) << line;
  }
}

TEST(Keys, TextFindsKeysByTheirNames) {
  EXPECT_TRUE(keys_as_text("hole.circle").starts_with("hole[].circle\n"));
  EXPECT_TRUE(keys_as_text("[[hole]]").starts_with("[[hole]]\n"));
  EXPECT_TRUE(keys_as_text("[mesh]").starts_with("[mesh]\n"));
  EXPECT_TRUE(keys_as_text("synthetic.crack[0].friction").starts_with("synthetic.crack[].friction\n"));
  EXPECT_TRUE(keys_as_text("min_angle").starts_with("mesh.min_angle\n"));
  EXPECT_NE(keys_as_text("functional.p").find("kind = \"stress_power\", \"stress_pnorm\""), std::string::npos);
  EXPECT_THROW(keys_as_text("nothing.like.it"), Error);
}

TEST(Keys, TheDocumentAndTheSchemaAreMadeFromThem) {
  std::string all;
  for (const auto& entry : fs::directory_iterator(docs / "case-files")) {
    const std::string page = read_text(entry.path());
    EXPECT_TRUE(with_key_tables(page) == page)
        << entry.path() << " is not what the table of keys says: kerf keys --write docs makes it anew";
    all += page;
  }
  EXPECT_TRUE(read_text(docs / "kerf.schema.json") == keys_as_schema())
      << "docs/kerf.schema.json is not what the table of keys says: kerf keys --write docs makes it anew";
  for (const Key& key : all_keys()) {
    const bool inside_entry = key.path.find("[].") != std::string_view::npos && key.path.starts_with("load_case");
    const std::string path(key.path.ends_with("[]") ? key.path.substr(0, key.path.size() - 2) : key.path);
    EXPECT_TRUE(inside_entry || all.find(fmt::format("## `{}`", path)) != std::string::npos ||
                all.find(fmt::format("## `[{}]`", path)) != std::string::npos ||
                all.find(fmt::format("## `[[{}]]`", path)) != std::string::npos)
        << key.path << " has no heading in docs/case-files";
  }
}

TEST(Keys, EveryNumberHasAUnit) {
  for (const Key& key : all_keys())
    EXPECT_TRUE(!is_numeric(key) || !unit_of(key).empty())
        << key.path << ": say its unit, or \"none\", in io/case/key_facts.cpp";
  EXPECT_EQ(unit_of(*find_key("mesh.size")), "length");
  EXPECT_EQ(unit_of(*find_key("grow.law.K_c")), "stress * sqrt(length)");
  EXPECT_EQ(unit_of(*find_key("material.poisson")), "none");
  EXPECT_EQ(refused_with(*find_key("load_case[]")), "without [optimize]");
}

TEST(Keys, TheSchemaAcceptsEveryCase) {
  for (const auto& entry : fs::directory_iterator(KERF_CASES))
    if (entry.path().extension() == ".toml") {
      EXPECT_EQ(wrong_case(read_text(entry.path())), "") << entry.path();
    }
}

TEST(Keys, TheSchemaRefusesWhatTheReaderRefuses) {
  EXPECT_EQ(wrong_case(square), "");
  EXPECT_EQ(wrong_case(square + "youg = 1"), ".material: unknown youg");
  EXPECT_EQ(wrong_case(square + "[mesh]\nsize = 0"), ".mesh.size: out of range");
  EXPECT_EQ(wrong_case(square + "[mesh]\nadapt = { max_triangles = 5 }"), ".mesh.adapt: missing error");
  EXPECT_NE(wrong_case(square + "[solver]\nelement = 'bmds'"), "");
  EXPECT_NE(wrong_case(square + "[[hole]]\nname = 'h'"), "");
  EXPECT_NE(wrong_case(square + "[[probe]]\nname = 'p'\nfrom = [0, 0]\nto = [1, 1]"), "");
  EXPECT_NE(wrong_case(square + "[functional]\nkind = 'sum'\nterms = [{ kind = 'volume', fcator = 2 }]"), "");
  EXPECT_NE(wrong_case(square + "[[synthetic.hole]]\nname = 'h'\ncircle = { center = [0, 0], radius = -1 }"), "");
}

TEST(Keys, RangesSayWhatTheyHold) {
  const auto said = [](const KeyRange& range) { return in_words(range); };
  EXPECT_EQ(said({.least = 0, .above = true}), "positive");
  EXPECT_EQ(said({.least = 0}), "not negative");
  EXPECT_EQ(said({0, 1, true, true}), "between 0 and 1, both excluded");
  EXPECT_EQ(said({0, 1}), "between 0 and 1");
  EXPECT_EQ(said({0, 1, true}), "positive, at most 1");
  EXPECT_EQ(said({-1, 0.5, true}), "above -1 and at most 0.5");
  EXPECT_EQ(said({}), "");
  const KeyRange open{0, 1, true, true}, closed{0, 1};
  for (const double end : {0.0, 1.0}) {
    EXPECT_FALSE(open.holds(end));
    EXPECT_TRUE(closed.holds(end));
  }
  EXPECT_TRUE(open.holds(0.5));
  for (const double outside : {-0.5, 1.5, nan}) EXPECT_FALSE(open.holds(outside) || closed.holds(outside)) << outside;
}

/// What bash offers for the last of these words.
std::vector<std::string> offered(const TemporaryFolder& folder, const std::string& words) {
  const std::string script = fmt::format(
      "cd '{}' && . ./kerf.bash && compopt() {{ :; }} && COMP_WORDS=({}) && COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)) && "
      "_kerf && printf '%s\\n' \"${{COMPREPLY[@]}}\" >offered.txt",
      folder.path.string(), words);
  EXPECT_EQ(std::system(("bash -c '" + std::regex_replace(script, std::regex("'"), "'\\''") + "'").c_str()), 0)
      << words;
  std::istringstream lines(read_text(folder.path / "offered.txt"));
  std::vector<std::string> all;
  for (std::string line; std::getline(lines, line);) all.push_back(line);
  return all;
}

TEST(Keys, BashCompletesThem) {
  const TemporaryFolder folder;
  folder.write("kerf.bash", keys_as_completion({{"solve", {"--set", "--output"}}, {"keys", {"--schema"}}}));
  folder.write("plate.toml", "");
  folder.write("notes.txt", "");
  std::filesystem::create_directory(folder.path / "out");
  using Words = std::vector<std::string>;
  EXPECT_EQ(offered(folder, "kerf so"), Words{"solve"});
  EXPECT_EQ(offered(folder, "kerf ''"), (Words{"solve", "keys", "--help", "--version"}));
  EXPECT_EQ(offered(folder, "kerf solve --s"), Words{"--set"});
  EXPECT_EQ(offered(folder, "kerf keys --"), Words{"--schema"});
  EXPECT_EQ(offered(folder, "kerf solve ''"), (Words{"plate.toml", "out"}));
  EXPECT_EQ(offered(folder, "kerf solve a.toml --output ''"), Words{"out"});
  EXPECT_EQ(offered(folder, "kerf solve a.toml --set mesh.adapt.e"), Words{"mesh.adapt.error="});
  EXPECT_EQ(offered(folder, "kerf keys hole[0].circle."), (Words{"hole[0].circle.center", "hole[0].circle.radius"}));
  // A sum in a sum is none: the keys end there.
  EXPECT_EQ(offered(folder, "kerf keys functional.terms[0].f"), Words{"functional.terms[0].factor"});
  EXPECT_EQ(offered(folder, "kerf keys functional.terms[0].t"),
            (Words{"functional.terms[0].tip", "functional.terms[0].target"}));
}

}  // namespace
}  // namespace kerf::keys_test
