// report.bin: arrays that a page is made from, the same when they are written and read again; or an Error.

#include "io/arrays.hpp"
#include "plot/page.hpp"
#include "tests/fuzz/parsers/promise.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace kerf;
  static const parsers::Folder folder;
  const auto path = folder.put("report.bin", parsers::text(data, size));
  parsers::promise([&] {
    PageData shown{read_arrays(path), "a case"};
    write_arrays(path, shown.arrays);
    parsers::require(read_arrays(path).size() == shown.arrays.size(), "arrays written are those read");
    Result result{.case_name = "a", .status = "ok"};
    page(result, shown);
  });
  return 0;
}
