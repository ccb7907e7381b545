#pragma once
// Damages of checkpoints whose checksum is right afterwards, from a number each.

#include "optimize/checkpoint.hpp"

#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <random>
#include <string>
#include <utility>

namespace kerf::damage {

/// One number, the length or order of one vector, or one text is another; which, in words.
inline std::pair<Checkpoint, std::string> damaged(Checkpoint c, unsigned seed) {
  std::mt19937 bits(seed);
  const auto pick = [&](std::size_t n) { return n == 0 ? std::size_t{0} : bits() % n; };
  if (pick(8) == 0 && !c.texts.empty()) {
    auto& [name, text] = *std::next(c.texts.begin(), std::ptrdiff_t(pick(c.texts.size())));
    const std::size_t how = pick(5);
    std::string said = "text " + name + ", way " + std::to_string(how);
    if (how == 0) text.clear();
    if (how == 1) text.resize(pick(text.size()));
    if (how == 2) text += text + "x\ny";
    if (how == 3) text = std::string(10, '\n') + text;
    if (how == 4) c.texts.erase(c.texts.find(std::string(name)));
    return {std::move(c), said};
  }
  const auto at = std::next(c.numbers.begin(), std::ptrdiff_t(pick(c.numbers.size())));
  Eigen::VectorXd& v = at->second;
  const auto n = std::size_t(v.size());
  std::string said = at->first + " of " + std::to_string(n);
  if (pick(5) == 0 || n == 0) {
    const std::size_t how = pick(6);
    said += ", length, way " + std::to_string(how);
    if (how == 0) v.resize(0);
    if (how == 1) v.conservativeResize(Eigen::Index(pick(n)));
    if (how == 2) {
      const Eigen::VectorXd was = v;
      v.resize(2 * was.size());
      v << was, was;
    }
    if (how == 3) v = Eigen::VectorXd(v.reverse());
    if (how == 4) v = Eigen::VectorXd(std::next(c.numbers.begin(), std::ptrdiff_t(pick(c.numbers.size())))->second);
    if (how == 5) c.numbers.erase(at);
    return {std::move(c), said};
  }
  constexpr double inf = std::numeric_limits<double>::infinity();
  const std::size_t i = pick(n);
  const double x = v[Eigen::Index(i)];
  const std::array to = {std::nan(""), inf,   -inf,   -1.0,   0.0,     0.5,    x + 1,    x - 1, -x,  2 * x, 1e9, 1e10,
                         2147483647.0, 1e300, -1e300, 0x1p62, -0x1p62, 5e-324, x + 0.25, 3.0,   1.0, 1e-200};
  const double y = to[pick(to.size())];
  v[Eigen::Index(i)] = y;
  return {std::move(c), said + ", number " + std::to_string(i) + ": " + std::to_string(x) + " to " + std::to_string(y)};
}

}  // namespace kerf::damage
