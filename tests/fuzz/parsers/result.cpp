// result.json with history.csv and crack_c.csv beside it (parts of the input): a result that a page and a row of a
// sweep are made from; or an Error.

#include "io/read_result.hpp"
#include "io/result_table.hpp"
#include "plot/page.hpp"
#include "tests/fuzz/parsers/promise.hpp"

#include <cstring>
#include <iterator>
#include <nlohmann/json.hpp>
#include <random>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace {

using Json = nlohmann::ordered_json;

/// Somewhere in it.
Json& some_node(Json& from, std::mt19937& bits) {
  Json* at = &from;
  while (at->is_structured() && !at->empty() && bits() % 8 != 0)
    at = &*std::next(at->begin(), static_cast<std::ptrdiff_t>(bits() % at->size()));
  return *at;
}

/// One node becomes another one, or that of another place, or loses or repeats one of its own.
void change(Json& all, std::mt19937& bits) {
  static const Json odd = Json::parse(
      R"([null, true, 0, -1, 0.5, 2147483647, 2147483648, 1e300, -1e-300, "", "c", "K_I", [], {}, [1, 2], [[1, 2]]])");
  Json& node = some_node(all, bits);
  switch (bits() % 4) {
    case 0:
      node = odd[bits() % odd.size()];
      break;
    case 1: {
      const Json other = some_node(all, bits);
      node = other;
      break;
    }
    case 2:
      if (node.is_structured() && !node.empty())
        node.erase(std::next(node.begin(), static_cast<std::ptrdiff_t>(bits() % node.size())));
      break;
    default:
      if (node.is_array() && !node.empty()) {
        const Json item = node[bits() % node.size()];
        node.push_back(item);
      }
  }
}

}  // namespace

/// Half of the changes leave JSON.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  std::mt19937 bits(seed);
  std::string_view rest = kerf::parsers::text(data, size);
  Json all = Json::parse(kerf::parsers::next_part(rest), nullptr, false);
  if (bits() % 2 == 0 || !all.is_object()) return LLVMFuzzerMutate(data, size, most);
  for (std::size_t k = 1 + bits() % 3; k > 0; --k) change(all, bits);
  const std::string out = all.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n%%\n" + std::string(rest);
  if (out.size() > most) return LLVMFuzzerMutate(data, size, most);
  std::memcpy(data, out.data(), out.size());
  return out.size();
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace kerf;
  static const parsers::Folder folder;
  std::string_view rest = parsers::text(data, size);
  for (const char* name : {"result.json", "history.csv", "crack_c.csv"}) folder.put(name, parsers::next_part(rest));
  parsers::promise([&] { page(read_result(folder.path), {}); });
  parsers::promise([&] { leaves_of_result(folder.path / "result.json"); });
  return 0;
}
