// The tables of tests/data, read: csv and json of exact fields, elements.json. And the meshes they were made on:
// squares of n x n cells, turned by an angle, inner vertices moved by a generator that is the same everywhere.

#include "tests/support/exact.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

namespace kerf::exact {
namespace {

std::ifstream opened(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error("cannot read " + file.string());
  return in;
}

nlohmann::json read_json(const std::filesystem::path& file) {
  return nlohmann::json::parse(opened(file));
}

/// The numbers among the members of an object.
std::map<std::string, double> numbers(const nlohmann::json& object) {
  std::map<std::string, double> values;
  for (const auto& [key, value] : object.items())
    if (value.is_number()) values[key] = value.get<double>();
  return values;
}

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> words;
  std::istringstream in(line);
  for (std::string word; std::getline(in, word, ',');) words.push_back(word);
  return words;
}

std::vector<Row> read_rows(const std::filesystem::path& file) {
  std::ifstream in = opened(file);
  std::string line;
  std::getline(in, line);
  const std::vector<std::string> names = cells(line);
  std::vector<Row> rows;
  while (std::getline(in, line)) {
    const std::vector<std::string> words = cells(line);
    if (words.size() != names.size()) throw std::runtime_error(file.string() + ": a row with another number of cells");
    std::map<std::string, std::string> cell;
    for (std::size_t i = 0; i < names.size(); ++i) cell[names[i]] = words[i];
    const auto number = [&cell](const std::string& name) {
      return cell.count(name) ? std::strtod(cell[name].c_str(), nullptr) : 0.0;
    };
    Mat2 stress;
    stress << number("sxx"), number("sxy"), number("sxy"), number("syy");
    rows.push_back({.kind = cell["kind"],
                    .x = {number("x"), number("y")},
                    .side = int(number("side")),
                    .u = {number("ux"), number("uy")},
                    .stress = stress,
                    .rot = number("rot"),
                    .hole = number("T_hole"),
                    .poisson = number("nu"),
                    .body = {number("fx"), number("fy")}});
  }
  return rows;
}

}  // namespace

Table read_table(const std::filesystem::path& folder, const std::string& id) {
  const nlohmann::json json = read_json(folder / (id + ".json"));
  Table table{.rows = read_rows(folder / (id + ".csv")), .scalars = numbers(json.at("scalars"))};
  for (const auto& r : json.value("faces", nlohmann::json::array()))
    table.faces.push_back(
        {r.at(0), Vec2(r.at(1).get<double>(), r.at(2).get<double>()), r.at(3), r.at(4), r.at(5), r.at(6)});
  for (const auto& r : json.at("scalars").value("per_nu", nlohmann::json::array())) table.per_nu.push_back(numbers(r));
  if (json.contains("energy")) {
    table.energy = json.at("energy").at("U");
    table.work = json.at("energy").at("work_per_side");
  }
  return table;
}

std::vector<ElementRow> read_elements(const std::filesystem::path& file, const std::string& section) {
  const nlohmann::json json = read_json(file);
  const auto legendre = [](const nlohmann::json& row, const char* key) {
    return row.value(key, std::vector<std::vector<double>>());
  };
  std::vector<ElementRow> rows;
  for (const auto& r : json.at(section))
    rows.push_back({.element = r.at("element"),
                    .bc = r.value("bc", "D"),
                    .crack_case = r.value("case", ""),
                    .poisson = r.value("nu", 0.3),
                    .n = r.at("n"),
                    .value = numbers(r),
                    .jump_n_legendre = legendre(r, "jump_n_legendre"),
                    .sigma_nn_legendre = legendre(r, "sigma_nn_legendre")});
  return rows;
}

// ---------------------------------------------------------------- meshes

namespace {

/// Knuth's MMIX generator: the same meshes everywhere.
struct Random {
  std::uint64_t state;
  double operator()() {  // in [-1, 1)
    state = state * 6364136223846793005u + 1442695040888963407u;
    return double(state >> 11) * 0x1p-52 - 1;
  }
};

/// n x n cells over [low, low + extent]^2, each split from lower left to upper right; path: vertices of the crack.
Mesh grid(int n, double low, double extent, const std::vector<Index>& path, double angle, double jiggle,
          unsigned seed) {
  const auto vertex = [n](int i, int j) { return Index(j * (n + 1) + i); };
  Random random{seed};
  std::vector<Vec2> points;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      Vec2 x(low + extent * i / n, low + extent * j / n);
      const bool fixed = i == 0 || j == 0 || i == n || j == n || std::ranges::count(path, vertex(i, j)) > 0;
      const Vec2 move(random(), random());
      if (!fixed) x += jiggle * extent / n * move;
      points.push_back(
          {x.x() * std::cos(angle) - x.y() * std::sin(angle), x.x() * std::sin(angle) + x.y() * std::cos(angle)});
    }
  std::vector<std::array<Index, 3>> triangles;
  std::vector<Marked> marked;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const Index v = vertex(i, j);
      triangles.push_back({v, v + 1, v + n + 2});
      triangles.push_back({v, v + n + 2, v + n + 1});
    }
  for (int i = 0; i < n; ++i) {
    marked.push_back({vertex(i, 0), vertex(i + 1, 0), 0});
    marked.push_back({vertex(n, i), vertex(n, i + 1), 1});
    marked.push_back({vertex(i, n), vertex(i + 1, n), 2});
    marked.push_back({vertex(0, i), vertex(0, i + 1), 3});
  }
  for (std::size_t k = 0; k + 1 < path.size(); ++k) marked.push_back({path[k], path[k + 1], none, 0});
  return connect(std::move(points), std::move(triangles), marked);
}

}  // namespace

Mesh unit_square_mesh(int n, double jiggle, unsigned seed) {
  return grid(n, 0, 1, {}, 0, jiggle, seed);
}

Mesh crack_mesh(int n, double angle, double jiggle, unsigned seed) {
  if (n <= 0 || n % 4 != 0) throw std::invalid_argument("crack_mesh wants a multiple of 4");
  std::vector<Index> path;
  for (int i = n / 4; i <= 3 * n / 4; ++i) path.push_back(Index(n / 2 * (n + 1) + i));
  return grid(n, -2, 4, path, angle, jiggle, seed);
}

}  // namespace kerf::exact
