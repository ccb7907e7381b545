#pragma once
// Values as bytes and back: what one process tells another, what is kept between runs of one program.
//
// Packer and Unpacker visit values in the same order, by the same list of members: for a type of one's own
//   template <typename Visit, Like<Own> T>
//   void fields(Visit& visit, T& own) { visit(own.first, own.second); }
// in its namespace says what is packed, and how it is read again.

#include <Eigen/Core>

#include <array>
#include <concepts>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace kerf {

/// Of, or const Of.
template <typename T, typename Of>
concept Like = std::same_as<std::remove_const_t<T>, Of>;

template <typename T>
concept FixedMatrix = std::is_base_of_v<Eigen::MatrixBase<T>, T> && T::SizeAtCompileTime != Eigen::Dynamic;

/// Bytes of plain values, fixed matrices, texts, vectors and arrays of them, and types with `fields`.
class Packer {
 public:
  template <typename... T>
  void operator()(const T&... values) {
    (put(values), ...);
  }
  template <typename T>
  void put(const T& value) {
    if constexpr (std::is_trivially_copyable_v<T>)
      bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    else if constexpr (FixedMatrix<T>)
      bytes_.append(reinterpret_cast<const char*>(value.data()), sizeof(double) * T::SizeAtCompileTime);
    else
      fields(*this, value);
  }
  template <typename T>
  void put(const std::vector<T>& values) {
    put(values.size());
    if constexpr (std::is_trivially_copyable_v<T>)
      bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    else
      for (const T& value : values) put(value);
  }
  template <typename T, std::size_t N>
  void put(const std::array<T, N>& values) {
    for (const T& value : values) put(value);
  }
  void put(const std::string& bytes) {
    put(bytes.size());
    bytes_ += bytes;
  }
  template <typename T>
  void put(const std::optional<T>& value) {
    put(value.has_value());
    if (value) put(*value);
  }
  void put(const Eigen::VectorXd& values) {
    put(std::vector<double>(values.begin(), values.end()));
  }
  void put(const Eigen::MatrixXd& values) {  // its entries alone: the reader knows how many
    for (Eigen::Index i = 0; i < values.size(); ++i) put(values.data()[i]);
  }
  std::string take() && {
    return std::move(bytes_);
  }

 private:
  std::string bytes_;
};

/// Throws std::logic_error where the bytes end before the values.
class Unpacker {
 public:
  explicit Unpacker(std::string_view bytes) : bytes_(bytes) {}
  template <typename... T>
  void operator()(T&... values) {
    (read(values), ...);
  }
  template <typename T>
  void read(T& value) {
    if constexpr (std::is_trivially_copyable_v<T>)
      copy(&value, sizeof value);
    else if constexpr (FixedMatrix<T>)
      copy(value.data(), sizeof(double) * T::SizeAtCompileTime);
    else
      fields(*this, value);
  }
  template <typename T>
  void read(std::vector<T>& values) {
    const auto count = get<std::size_t>();
    if (count > bytes_.size()) throw std::logic_error("a packed part is too short");
    values.resize(count);
    if constexpr (std::is_trivially_copyable_v<T>)
      copy(values.data(), count * sizeof(T));
    else
      for (T& value : values) read(value);
  }
  template <typename T, std::size_t N>
  void read(std::array<T, N>& values) {
    for (T& value : values) read(value);
  }
  template <typename T>
  void read(std::optional<T>& value) {
    if (get<bool>())
      read(value.emplace());
    else
      value.reset();
  }
  void read(Eigen::VectorXd& values) {
    const auto all = get<std::vector<double>>();
    values = Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
  }
  void read(std::string& bytes) {
    const auto count = get<std::size_t>();
    if (count > bytes_.size()) throw std::logic_error("a packed part is too short");
    bytes.assign(bytes_.substr(0, count));
    bytes_.remove_prefix(count);
  }
  /// One value.
  template <typename T>
  T get() {
    T value;
    read(value);
    return value;
  }
  template <typename T>
  std::vector<T> all() {
    return get<std::vector<T>>();
  }
  std::string text() {
    return get<std::string>();
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
