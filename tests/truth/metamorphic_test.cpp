// The same body said in other words: mirrored, turned, in other units, its sides cut, its names and their order
// changed, with other elements, meshes and solvers. Energy, K and T change as they must. Bodies nobody tuned on.
// KERF_SCENES=1000 for many, KERF_FIRST=n to begin elsewhere.

#include "tests/fuzz/tree.hpp"
#include "tests/truth/random_scene.hpp"
#include "tests/truth/scene.hpp"

#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <cstdlib>
#include <functional>

namespace kerf::metamorphic_test {
namespace {

using fuzz::Value;

/// x' = length R x, loads by `load`; and what else is edited.
struct Change {
  std::string name;
  Mat2 turn = Mat2::Identity();
  double length = 1, load = 1;
  std::vector<std::string> overrides = {};
  std::function<void(Value&)> edit = {};
  bool same_mesh = false;  // then the energy is the same but for rounding
};

/// The expression with other words for x and y; exponents of numbers and names of functions stay.
std::string in_place_of(const std::string& text, const std::string& x, const std::string& y) {
  std::string out;
  const auto letter = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '.'; };
  for (std::size_t i = 0; i < text.size();) {
    std::size_t end = i;
    while (end < text.size() && letter(text[end])) ++end;
    const std::string word = text.substr(i, std::max<std::size_t>(end - i, 1));
    out += word == "x" ? x : word == "y" ? y : word;
    i += word.size();
  }
  return out;
}

void move_points(Value& v, const Change& c) {
  if (v.kind != Value::Kind::Array) return;
  if (v.items.size() == 2 && v.items[0].second.kind == Value::Kind::Token &&
      v.items[1].second.kind == Value::Kind::Token) {
    const Vec2 p = c.length * (c.turn * Vec2(std::stod(v.items[0].second.text), std::stod(v.items[1].second.text)));
    v = fuzz::pair(fmt::format("{:.17g}", p.x()), fmt::format("{:.17g}", p.y()));
    return;
  }
  for (auto& [none, item] : v.items) move_points(item, c);
}

/// A vector of formulas of the old place, of the new one.
void move_vector(Value& v, const Change& c, double factor) {
  const Mat2& r = c.turn;
  const std::string x = fmt::format("(({:.17g}*x + {:.17g}*y)/{:.17g})", r(0, 0), r(1, 0), c.length),
                    y = fmt::format("(({:.17g}*x + {:.17g}*y)/{:.17g})", r(0, 1), r(1, 1), c.length),
                    first = in_place_of(v.items[0].second.text, x, y),
                    second = in_place_of(v.items[1].second.text, x, y);
  for (int k = 0; k < 2; ++k)
    v.items[static_cast<std::size_t>(k)].second =
        fuzz::text(fmt::format("{:.17g}*({:.17g}*({}) + {:.17g}*({}))", factor, r(k, 0), first, r(k, 1), second));
}

std::string changed(const std::string& scene, const Change& c) {
  Value document = fuzz::read_toml(scene);
  const bool moves = c.turn != Mat2::Identity() || c.length != 1 || c.load != 1;
  if (moves)
    for (auto& [key, value] : document.items) {
      if (key == "domain") move_points(*fuzz::member(value, "outline"), c);
      for (auto& [none, table] : value.items)
        for (const char* form : {"path", "polygon"})
          if (Value* points = fuzz::member(table, form)) move_points(*points, c);
      if (key == "boundary")
        for (auto& [none, table] : value.items)
          if (Value* t = fuzz::member(table, "traction")) move_vector(*t, c, c.load);
      if (key == "body") move_vector(*fuzz::member(value, "force"), c, c.load / c.length);
    }
  if (c.edit) c.edit(document);
  return fuzz::write_toml(document);
}

/// Every side in two with its label.
void cut_sides(Value& document) {
  Value& domain = *fuzz::member(document, "domain");
  Value &outline = *fuzz::member(domain, "outline"), &sides = *fuzz::member(domain, "sides");
  Value more{.kind = Value::Kind::Array}, labels = more;
  const std::size_t n = outline.items.size();
  for (std::size_t k = 0; k < n; ++k) {
    const auto at = [&](std::size_t i, std::size_t j) {
      return std::stod(outline.items[i % n].second.items[j].second.text);
    };
    const double s = 0.3 + 0.1 * static_cast<double>(k % 5);
    more.items.push_back(outline.items[k]);
    more.items.emplace_back("", fuzz::pair(fmt::format("{:.17g}", (1 - s) * at(k, 0) + s * at(k + 1, 0)),
                                           fmt::format("{:.17g}", (1 - s) * at(k, 1) + s * at(k + 1, 1))));
    labels.items.push_back(sides.items[k]);
    labels.items.push_back(sides.items[k]);
  }
  outline = more, sides = labels;
}

/// Other names for everything, the lists from back to front, the outline from another corner.
void rename(Value& document) {
  for (const fuzz::Place& p : fuzz::places(document))
    if (Value& v = p.value(); v.kind == Value::Kind::Text &&
                              (p.path.ends_with("sides[]") || p.path.ends_with(".on") || p.path.ends_with(".name")))
      v.text = "z_" + v.text;
  for (auto& [key, value] : document.items)
    if (fuzz::is_table_list(value)) std::reverse(value.items.begin(), value.items.end());
  Value& domain = *fuzz::member(document, "domain");
  for (const char* list : {"outline", "sides"}) {
    auto& items = fuzz::member(domain, list)->items;
    std::rotate(items.begin(), items.begin() + 1, items.end());
  }
}

Mat2 rotation(double angle) {
  Mat2 r;
  r << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  return r;
}

std::vector<Change> changes() {
  Mat2 mirror;
  mirror << -1, 0, 0, 1;
  return {{.name = "mirrored", .turn = mirror},
          {.name = "turned", .turn = rotation(0.7)},
          {.name = "longer", .length = 1e6},
          {.name = "shorter and weaker", .length = 1e-7, .load = 1e-5},
          {.name = "stronger", .load = 1e4, .same_mesh = true},
          {.name = "cut sides", .edit = cut_sides},
          {.name = "renamed", .edit = rename},
          {.name = "active-set", .overrides = {"solver.contact=\"active-set\""}, .same_mesh = true},
          {.name = "uzawa", .overrides = {"solver.contact=\"uzawa\""}, .same_mesh = true},
          {.name = "umfpack",
           .overrides = {"solver.backend=\"umfpack\"", "solver.contact=\"active-set\""},
           .same_mesh = true},
          {.name = "degree 2", .overrides = {"solver.degree=2"}},
          {.name = "peers", .overrides = {"solver.element=\"peers\""}},
          {.name = "afw", .overrides = {"solver.element=\"afw\""}}};
}

class Metamorphic : public Truth {
 protected:
  nlohmann::json solve(const std::string& scene, const Change& c, double size, Job job = Job::Solve) {
    std::vector<std::string> overrides = c.overrides;
    overrides.push_back(fmt::format("mesh.size={:.17g}", size * c.length));
    overrides.push_back(fmt::format("mesh.crack_tip_size={:.17g}", 0.1 * size * c.length));
    return run_scene(changed(scene, c), job, overrides);
  }
};

struct Interval {
  double low = nan, high = nan;
  bool known() const {
    return std::isfinite(low) && std::isfinite(high);
  }
  double width() const {
    return high - low;
  }
};

/// Of the energy of the plain body.
Interval bounds_of(const nlohmann::json& r, const Change& c) {
  const nlohmann::json& b = r["state"]["energy_bounds"];
  if (!b.is_array() || !b[0].is_number() || !b[1].is_number()) return {};
  const double f = std::pow(c.load * c.length, 2);
  return {b[0].get<double>() / f, b[1].get<double>() / f};
}

TEST_F(Metamorphic, EnergiesChangeAsTheyMust) {
  const unsigned first = number("KERF_FIRST", 1), count = number("KERF_SCENES", 8);
  unsigned compared = 0;
  for (unsigned seed = first; seed < first + count; ++seed) {
    const std::string scene = random_scene(seed);
    const nlohmann::json plain = solve(scene, {}, 0.3), fine = solve(scene, {}, 0.15);
    const Interval all = bounds_of(plain, {}), refined = bounds_of(fine, {});
    const double energy = plain["state"]["energy"];
    for (const Change& c : changes()) {
      SCOPED_TRACE(fmt::format("seed {}, {}\n{}", seed, c.name, scene));
      const nlohmann::json r = solve(scene, c, 0.3);
      const double f = std::pow(c.load * c.length, 2), e = r["state"]["energy"].get<double>() / f;
      if (c.same_mesh) {
        // A force that jumps is known to 1e-7 in each triangle, in both runs; the energy is of its square.
        EXPECT_NEAR(e, energy, 4e-7 * std::abs(energy));
      }
      const Interval b = bounds_of(r, c);
      if (!b.known()) continue;
      for (const Interval& other : {all, refined}) {
        if (!other.known()) continue;
        const double rounding = 1e-7 * std::abs(energy);
        EXPECT_LE(b.low, other.high + rounding);
        EXPECT_LE(other.low, b.high + rounding);
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 15 * count);
  RecordProperty("intervals", static_cast<int>(compared));
}

TEST_F(Metamorphic, TipsAndMapsChangeAsTheyMust) {
  const unsigned first = number("KERF_FIRST", 5), count = number("KERF_SCENES", 4);
  unsigned tips = 0, points = 0;
  for (unsigned seed = first; seed < first + count; ++seed) {
    std::string scene = random_scene(seed) + "[map]\nperturbation = \"hole\"\nbounds = true\npoints = [[0.0, 0.18]]\n";
    const nlohmann::json plain = solve(scene, {}, 0.15, Job::Map);
    for (const Change& c : changes()) {
      SCOPED_TRACE(fmt::format("seed {}, {}\n{}", seed, c.name, scene));
      Change with_point = c;
      with_point.edit = [&](Value& document) {
        move_points(*fuzz::member(*fuzz::member(document, "map"), "points"), c);
        if (c.edit) c.edit(document);
      };
      const nlohmann::json r = solve(scene, with_point, 0.15, Job::Map);
      const double k = c.load * std::sqrt(c.length), t = c.load * c.load;
      for (const nlohmann::json& crack : plain.value("cracks", nlohmann::json::array()))
        for (const nlohmann::json& other : r["cracks"]) {
          if (other["name"] != crack["name"] && other["name"] != "z_" + crack["name"].get<std::string>()) continue;
          // Of K; a crack that transmits everything has none but noise: K^2 is a stiffness times an energy per length.
          double size = 0.03 * std::sqrt(100 * std::abs(plain["state"]["energy"].get<double>()));
          for (const nlohmann::json& tip : crack["tips"])
            size = std::max({size, std::abs(tip["K_I"].get<double>()), std::abs(tip["K_II"].get<double>())});
          for (std::size_t i = 0; i < crack["tips"].size(); ++i) {
            const nlohmann::json &a = crack["tips"][i], &b = other["tips"][i];
            const double sign = c.turn.determinant();
            // What each says of its own error counts, too: peers is of first order.
            const auto unsure = [&](const char* name) {
              double sum = 0.05 * size;
              if (a["spread"].is_object()) sum += a["spread"][name].get<double>();
              if (b["spread"].is_object()) sum += b["spread"][name].get<double>() / k;
              return sum;
            };
            EXPECT_NEAR(b["K_I"].get<double>() / k, a["K_I"].get<double>(), unsure("K_I"));
            EXPECT_NEAR(b["K_II"].get<double>() / k, sign * a["K_II"].get<double>(), unsure("K_II"));
            ++tips;
          }
        }
      const nlohmann::json &a = plain["map"]["points"][0], &b = r["map"]["points"][0];
      if (!a["lower"].is_number() || !b["lower"].is_number()) continue;
      EXPECT_LE(b["lower"].get<double>() / t, a["upper"].get<double>() + 1e-7 * std::abs(a["value"].get<double>()));
      EXPECT_LE(a["lower"].get<double>(), b["upper"].get<double>() / t + 1e-7 * std::abs(a["value"].get<double>()));
      ++points;
    }
  }
  RecordProperty("tips", static_cast<int>(tips));
  RecordProperty("points", static_cast<int>(points));
  EXPECT_GE(tips, 26U);  // two of a crack, under each change
  EXPECT_GT(points, 6 * count);
}

}  // namespace
}  // namespace kerf::metamorphic_test
