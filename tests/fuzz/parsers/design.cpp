// design.toml, named by optimize.start.design: a body that its case begins with; or an Error.

#include "kerf/case_file.hpp"
#include "tests/fuzz/parsers/promise.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace kerf;
  static const parsers::Folder folder;
  static const auto path = folder.put("case.toml", R"(
[domain]
outline = [[0, 0], [2, 0], [2, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 1
poisson = 0.3
[mesh]
size = 0.2
[[boundary]]
on = "left"
displacement = [0, 0]
[[boundary]]
on = "right"
traction = [0, -1]
[functional]
kind = "compliance"
[optimize]
volume = { at_most = 0.7 }
start = { design = "design.toml" }
)");
  folder.put("design.toml", parsers::text(data, size));
  parsers::promise([&] { read_case(path); });
  return 0;
}
