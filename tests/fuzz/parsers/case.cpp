// A case file, after it the mesh and the table that it may name (a.msh, a.csv; parts of the input): a case, which is
// the same when it is kept beside its results and read again; or an Error with its line.

#include "io/document.hpp"
#include "io/kept.hpp"
#include "tests/fuzz/parsers/promise.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace kerf;
  static const parsers::Folder folder;
  std::string_view rest = parsers::text(data, size);
  const auto path = folder.put("case.toml", parsers::next_part(rest));
  folder.put("a.msh", parsers::next_part(rest));
  folder.put("a.csv", parsers::next_part(rest));
  parsers::promise([&] {
    const Case c = read_case(path);
    const KeptCase kept = keep(c, {"a run"});
    if (!kept.files.empty()) return;
    const auto again = folder.put("kept.toml", kept.text);
    parsers::promise([&] {
      parsers::require(read_case(again).fingerprint == c.fingerprint,
                       "the case that is kept is the case that was read");
    });
  });
  return 0;
}
