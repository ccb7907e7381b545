// What --set and --over take, a line each, over a small document: the document changed, which reads as it is written;
// or an Error.

#include "io/document.hpp"
#include "tests/fuzz/parsers/promise.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace kerf;
  static const parsers::Folder folder;
  static const Node begin =
      read_document(folder.put("a.toml", "[mesh]\nsize = 0.1\n[[hole]]\nname = \"h\"\ncircle = { radius = 1 }\n"));
  Node document = begin;
  std::string_view rest = parsers::text(data, size);
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    parsers::promise([&] { override_value(document, line); });
  }
  std::string written;
  add_entries(document.entries, written);
  parsers::promise([&] { read_document(folder.put("b.toml", written)); });
  return 0;
}
