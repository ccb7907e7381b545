// Comma-separated tables of readings and points: finite numbers, as many in every row; or an Error.

#include "io/case/table.hpp"
#include "tests/fuzz/parsers/promise.hpp"

#include <cmath>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace kerf;
  static const parsers::Folder folder;
  const auto path = folder.put("points.csv", parsers::text(data, size));
  const Node node{.position = {nullptr, 1, 1}};
  const Value field{&node, "file in [[probe]]", "probe.file"};
  parsers::promise([&] {
    for (const std::vector<double>& row : read_table(path, field, {"x", "y", "u_x"})) {
      parsers::require(row.size() == 3, "a row has what was asked for");
      for (const double x : row) parsers::require(std::isfinite(x), "numbers are finite");
    }
  });
  return 0;
}
