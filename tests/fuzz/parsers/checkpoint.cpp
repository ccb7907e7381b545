// checkpoint.bin and checkpoint.strip behind a checksum that is right: a state of a level set that fits its own sizes
// and is written as it was read, evaluations of curves, drawings; or an Error.

#include "optimize/checkpoint_reader.hpp"
#include "optimize/level_set/finishing.hpp"
#include "optimize/level_set/progress.hpp"
#include "optimize/loop/history_text.hpp"
#include "plot/evolution.hpp"
#include "tests/fuzz/parsers/promise.hpp"
#include "tests/optimize/damage.hpp"

#include <cstring>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace {

using namespace kerf;

constexpr std::size_t head = 8 + 4 + 8;

template <typename Number>
void append(std::string& out, Number value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// The body as a file, as optimize/loop/checkpoint.cpp writes it.
std::string file_of(std::string_view body) {
  std::string file = "KERFCKPT";
  append(file, std::uint32_t{1});
  append(file, std::uint64_t{body.size()});
  file += body;
  append(file, checksum(file));
  return file;
}

const parsers::Folder& folder() {
  static const parsers::Folder one;
  return one;
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

/// Half of the changes are those of a number, a vector or a text.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  if (seed % 2 == 0) return LLVMFuzzerMutate(data, size, most);
  try {
    const auto path = folder().put("mutated.bin", file_of(parsers::text(data, size)));
    const std::optional<Checkpoint> c = read_checkpoint(path);
    if (!c || c->numbers.empty()) return LLVMFuzzerMutate(data, size, most);
    write_checkpoint(path, damage::damaged(*c, seed).first, Flush::Buffers);
    const std::string file = bytes_of(path);
    const std::size_t body = file.size() - head - 8;
    if (body > most) return LLVMFuzzerMutate(data, size, most);
    std::memcpy(data, file.data() + head, body);
    return body;
  } catch (const Error&) {
    return LLVMFuzzerMutate(data, size, most);
  }
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto path = folder().put("checkpoint.bin", file_of(parsers::text(data, size)));
  parsers::promise([&] {
    const Checkpoint c = *read_checkpoint(path);
    parsers::promise([&] {
      const DescentState s = unpacked(c);
      check_state(s, {.vertices = s.phi.size(), .bounds = s.weight.size()});
      const Checkpoint again = packed(s);
      for (const auto& [name, numbers] : again.numbers)
        parsers::require(numbers.size() == numbers_of(c, name).size(), "a state is written as it was read");
      unpacked(again);
    });
    parsers::promise([&] {
      Checkpoint again;
      write_curves(again, read_curves(c));
      read_curves(again);
    });
    parsers::promise([&] { from_checkpoint(to_checkpoint(from_checkpoint(c), c.fingerprint)); });
    parsers::promise([&] { pick(from_checkpoint(c), 12); });
  });
  return 0;
}
