#pragma once
// What one process tells another, as bytes.

#include <Eigen/Core>

#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace kerf {

/// Bytes of plain values, of vectors of them and of texts, in the order in which they are written and read.
class Packer {
 public:
  template <typename T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  template <typename T>
  void put(const std::vector<T>& values) {
    put(values.size());
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  }
  void put(const std::string& bytes) {
    put(bytes.size());
    bytes_ += bytes;
  }
  void put(const Eigen::MatrixXd& values) {
    for (Eigen::Index i = 0; i < values.size(); ++i) put(values.data()[i]);
  }
  std::string take() && {
    return std::move(bytes_);
  }

 private:
  std::string bytes_;
};

class Unpacker {
 public:
  explicit Unpacker(std::string_view bytes) : bytes_(bytes) {}
  template <typename T>
  T get() {
    T value;
    copy(&value, sizeof value);
    return value;
  }
  template <typename T>
  std::vector<T> all() {
    std::vector<T> values(get<std::size_t>());
    copy(values.data(), values.size() * sizeof(T));
    return values;
  }
  std::string text() {
    std::string bytes(get<std::size_t>(), '\0');
    copy(bytes.data(), bytes.size());
    return bytes;
  }
  template <typename Fixed>
  Fixed matrix() {
    Fixed values;
    for (Eigen::Index i = 0; i < values.size(); ++i) values.data()[i] = get<double>();
    return values;
  }

 private:
  void copy(void* to, std::size_t count) {
    if (bytes_.size() < count) throw std::logic_error("a packed part is too short");
    if (count > 0) std::memcpy(to, bytes_.data(), count);
    bytes_.remove_prefix(count);
  }
  std::string_view bytes_;
};

}  // namespace kerf
