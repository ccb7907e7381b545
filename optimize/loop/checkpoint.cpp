// Checkpoints as files: named vectors of doubles and texts, with a fingerprint of the case, the length of the body and
// a checksum. A file is replaced by writing another one beside it, flushing and renaming, so that after a kill at any
// moment it is the old or the new one. Reading refuses what is cut off, longer than it says, of another format, or has
// a wrong checksum (FNV-1a, whose every step is a bijection: no change of a single byte goes unseen), with the reason
// and the advice to start anew. What the numbers mean is checked by whoever reads them (checkpoint_reader.hpp).
// docs/security.md has what files from strangers may do.

#include "optimize/checkpoint.hpp"

#include "base/read_whole_file.hpp"
#include "kerf/types.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstring>

namespace kerf {

namespace {

// The file: magic, version (4 bytes), length of the body (8), body, checksum of all before it (8). The body: the
// fingerprint, the number of texts, each with its name, the number of vectors, each with its name. Texts and vectors
// begin with their length. Numbers are in the order of bytes of the machines that kerf runs on.
static_assert(std::endian::native == std::endian::little);
constexpr std::string_view magic = "KERFCKPT";
constexpr std::uint32_t version = 1;
constexpr std::size_t head = 8 + 4 + 8, tail = 8;

template <typename Number>
void append(std::string& out, Number value) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  out.append(bytes, sizeof value);
}

void append_text(std::string& out, std::string_view text) {
  append<std::uint64_t>(out, text.size());
  out.append(text);
}

// Maps are in the order of their names, so that the same checkpoint has the same bytes.
std::string encode(const Checkpoint& checkpoint) {
  std::string body;
  append_text(body, checkpoint.fingerprint);
  append<std::uint64_t>(body, checkpoint.texts.size());
  for (const auto& [name, text] : checkpoint.texts) {
    append_text(body, name);
    append_text(body, text);
  }
  append<std::uint64_t>(body, checkpoint.numbers.size());
  for (const auto& [name, values] : checkpoint.numbers) {
    append_text(body, name);
    append<std::uint64_t>(body, static_cast<std::uint64_t>(values.size()));
    body.append(reinterpret_cast<const char*>(values.data()), sizeof(double) * static_cast<std::size_t>(values.size()));
  }
  std::string out(magic);
  append(out, version);
  append<std::uint64_t>(out, body.size());
  out += body;
  append(out, checksum(out));
  return out;
}

/// Takes a file's bytes apart; what goes past their end is refused.
struct Decoder {
  std::string_view bytes;
  const std::filesystem::path& path;

  [[noreturn]] void refuse(const std::string& why) const {
    throw Error(Fault::Files, fmt::format("the checkpoint '{}' {}; start without --resume", path.string(), why));
  }
  std::string_view take(std::uint64_t count) {
    if (count > bytes.size()) refuse("is damaged (it says that it holds more than it does)");
    const std::string_view out = bytes.substr(0, count);
    bytes.remove_prefix(count);
    return out;
  }
  template <typename Number>
  Number number() {
    Number value;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  std::string text() {
    return std::string(take(number<std::uint64_t>()));
  }
  Eigen::VectorXd vector() {
    const auto count = number<std::uint64_t>();
    if (count > bytes.size() / sizeof(double)) refuse("is damaged (it says that it holds more than it does)");
    Eigen::VectorXd values(static_cast<Eigen::Index>(count));
    if (count > 0) std::memcpy(values.data(), take(count * sizeof(double)).data(), count * sizeof(double));
    return values;
  }
};

// The length is compared before the checksum: a file that is cut off is told apart from a damaged one.
Checkpoint decode(std::string_view file, const std::filesystem::path& path) {
  Decoder in{file, path};
  // A file shorter than the magic is judged by what there is of it.
  if (file.substr(0, magic.size()) != magic.substr(0, file.size())) in.refuse("is no checkpoint of kerf");
  if (file.size() < head + tail) in.refuse(fmt::format("is cut off after {} bytes", file.size()));
  in.take(magic.size());
  if (const auto found = in.number<std::uint32_t>(); found != version)
    in.refuse(fmt::format("has the format {}, this kerf reads format {}", found, version));
  const auto size = in.number<std::uint64_t>();
  if (const std::size_t there = file.size() - head - tail; size != there)
    in.refuse(size > there ? fmt::format("is cut off after {} bytes", file.size())
                           : "is damaged (it is longer than it says)");
  Decoder sum{file.substr(file.size() - tail), path};
  if (sum.number<std::uint64_t>() != checksum(file.substr(0, file.size() - tail)))
    in.refuse("is damaged (its checksum is wrong)");
  in.bytes.remove_suffix(tail);
  Checkpoint out;
  out.fingerprint = in.text();
  for (auto count = in.number<std::uint64_t>(); count > 0; --count) {
    std::string name = in.text();
    out.texts[std::move(name)] = in.text();
  }
  for (auto count = in.number<std::uint64_t>(); count > 0; --count) {
    std::string name = in.text();
    out.numbers[std::move(name)] = in.vector();
  }
  if (!in.bytes.empty()) in.refuse("is damaged (it is longer than it says)");
  return out;
}

}  // namespace

// FNV-1a of 64 bits.
std::uint64_t checksum(std::string_view bytes) {
  std::uint64_t sum = 14695981039346656037u;
  for (const char c : bytes) sum = (sum ^ static_cast<unsigned char>(c)) * 1099511628211u;
  return sum;
}

void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint, Flush flush) {
  const auto refuse = [&](int reason) {
    return Error(Fault::Files,
                 fmt::format("cannot write the checkpoint '{}': {}", path.string(), std::strerror(reason)));
  };
  if (const int problem = write_whole_file(path, encode(checkpoint), flush)) throw refuse(problem);
}

void keep(const CheckpointPlace& place, Checkpoint checkpoint) {
  checkpoint.fingerprint = place.fingerprint;
  // Where somebody else writes, the checkpoint goes along by value: the run goes on meanwhile.
  if (!place.write) return write_checkpoint(place.path, checkpoint);
  place.write([path = place.path, checkpoint = std::move(checkpoint)] { write_checkpoint(path, checkpoint); });
}

// No file is no error: there is nothing to resume.
std::optional<Checkpoint> read_checkpoint(const std::filesystem::path& path) {
  const WholeFile file = read_whole_file(path);
  if (file.refusal == WholeFile::Refusal::Missing) return std::nullopt;
  if (file.refusal != WholeFile::Refusal::None)
    throw Error(Fault::Files, fmt::format("cannot read the checkpoint '{}': {}", path.string(), in_words(file)));
  return decode(file.bytes, path);
}

}  // namespace kerf
