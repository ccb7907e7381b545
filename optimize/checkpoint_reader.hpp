#pragma once
// Checkpoints taken apart. A right checksum does not say who wrote them: every number is looked at before it counts,
// indexes or sizes anything.

#include "optimize/checkpoint.hpp"

#include <span>

namespace kerf {

/// Error(Files): the structure or a value is none that this program writes.
Error broken_checkpoint();

/// What has that name. Throw broken_checkpoint() where nothing has.
const Eigen::VectorXd& numbers_of(const Checkpoint& c, const std::string& name);
const std::string& text_of(const Checkpoint& c, const std::string& name);

/// More of anything is not counted.
inline constexpr int most_counted = 1'000'000'000;

/// Numbers one after the other. All throw broken_checkpoint() for what is not there or not allowed.
class NumberReader {
 public:
  /// `numbers` has to outlive it.
  explicit NumberReader(const Eigen::VectorXd& numbers) : left_(numbers.data(), std::size_t(numbers.size())) {}

  bool empty() const {
    return left_.empty();
  }
  double any();  // NaN, infinities, too
  double finite();
  /// A whole number.
  int count(int most = most_counted, int least = 0);
  bool flag();  // 0 or 1
  /// The next n numbers, all of them finite in the second case.
  Eigen::VectorXd take(Eigen::Index n);
  Eigen::VectorXd take_finite(Eigen::Index n);
  /// As many numbers as the next one says.
  Eigen::VectorXd take_counted();
  void end() const;  // nothing is left

 private:
  std::span<const double> left_;
};

/// One line more, whatever is in it.
void append_line(std::string& lines, std::string_view line);

/// What append_line() wrote, line by line.
class LineReader {
 public:
  /// `lines` has to outlive it.
  explicit LineReader(std::string_view lines) : left_(lines) {}
  bool empty() const {
    return left_.empty();
  }
  std::string line();
  void end() const;

 private:
  std::string_view left_;
};

}  // namespace kerf
