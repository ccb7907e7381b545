#pragma once
// The bytes of a mesh file, read forwards: words of text and numbers of memory, each error with its place.

#include <cstdint>
#include <string>
#include <string_view>

namespace kerf {

class MeshBytes {
 public:
  MeshBytes(std::string name, std::string_view bytes) : name_(std::move(name)), bytes_(bytes) {}

  /// Throws Error(Geometry): "file:line: what", in a binary section "file: section, byte n: what".
  [[noreturn]] void fail(const std::string& what) const;

  /// What messages call the section that is read.
  void enter(std::string section) {
    section_ = std::move(section);
  }

  /// From here on numbers are memory, or text again.
  void set_binary(bool binary) {
    binary_ = binary;
  }
  bool binary() const {
    return binary_;
  }

  /// Past blanks; false at the end of the file.
  bool skip_blanks();
  std::string_view word();
  std::string_view rest_of_line();
  /// A name in quotation marks.
  std::string quoted();

  /// Whole numbers of 4 and 8 bytes, and real ones; in text any that fits.
  std::int32_t whole32();
  std::int64_t whole64();
  double real();
  /// Text, whatever set_binary says.
  std::int64_t text_whole();

  /// How many things follow. Fails unless the rest of the file can hold so many, of so many bytes at least in text and
  /// in memory.
  std::int64_t count(std::int64_t n, std::string_view of, std::int64_t text_bytes, std::int64_t memory_bytes) const;

  /// The line "$End<section>".
  void leave();
  /// Past a section that means nothing here.
  void skip_section();

 private:
  template <typename Number>
  Number memory();
  template <typename Number>
  Number text();

  std::string name_, section_;
  std::string_view bytes_;
  std::size_t at_ = 0;
  bool binary_ = false;
};

}  // namespace kerf
