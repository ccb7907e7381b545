// Bounded reading of the numbers and lines of checkpoints.

#include "optimize/checkpoint_reader.hpp"

#include "kerf/types.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

Error broken_checkpoint() {
  return {Fault::Files, "the checkpoint does not hold what this program writes; start without --resume"};
}

const Eigen::VectorXd& numbers_of(const Checkpoint& c, const std::string& name) {
  const auto found = c.numbers.find(name);
  if (found == c.numbers.end()) throw broken_checkpoint();
  return found->second;
}

const std::string& text_of(const Checkpoint& c, const std::string& name) {
  const auto found = c.texts.find(name);
  if (found == c.texts.end()) throw broken_checkpoint();
  return found->second;
}

double NumberReader::any() {
  if (left_.empty()) throw broken_checkpoint();
  const double x = left_.front();
  left_ = left_.subspan(1);
  return x;
}

double NumberReader::finite() {
  const double x = any();
  if (!std::isfinite(x)) throw broken_checkpoint();
  return x;
}

// A whole number within bounds; NaN is none.
int NumberReader::count(int most, int least) {
  const double x = any();
  if (!(x >= least && x <= most && x == std::floor(x))) throw broken_checkpoint();
  return static_cast<int>(x);
}

bool NumberReader::flag() {
  return count(1) == 1;
}

Eigen::VectorXd NumberReader::take(Eigen::Index n) {
  if (n < 0 || static_cast<std::size_t>(n) > left_.size()) throw broken_checkpoint();
  const Eigen::VectorXd v = Eigen::Map<const Eigen::VectorXd>(left_.data(), n);
  left_ = left_.subspan(static_cast<std::size_t>(n));
  return v;
}

Eigen::VectorXd NumberReader::take_finite(Eigen::Index n) {
  Eigen::VectorXd v = take(n);
  if (!v.allFinite()) throw broken_checkpoint();
  return v;
}

Eigen::VectorXd NumberReader::take_counted() {
  return take(count());
}

void NumberReader::end() const {
  if (!left_.empty()) throw broken_checkpoint();
}

void append_line(std::string& lines, std::string_view line) {
  for (const char c : line) {
    if (c == '\\' || c == '\n') lines += '\\';
    lines += c == '\n' ? 'n' : c;
  }
  lines += '\n';
}

// A backslash keeps the next character; before n it is a line's end.
std::string LineReader::line() {
  const std::size_t end = left_.find('\n');
  if (end == std::string_view::npos) throw broken_checkpoint();
  std::string out;
  for (std::size_t i = 0; i < end; ++i) {
    const bool escaped = left_[i] == '\\' && i + 1 < end;
    if (escaped) ++i;
    out += escaped && left_[i] == 'n' ? '\n' : left_[i];
  }
  left_.remove_prefix(end + 1);
  return out;
}

void LineReader::end() const {
  if (!left_.empty()) throw broken_checkpoint();
}

}  // namespace kerf
