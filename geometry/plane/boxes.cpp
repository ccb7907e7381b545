#include "geometry/boxes.hpp"

#include <numeric>

namespace kerf {

namespace {
constexpr Index most_in_leaf = 4;
}

BoxTree::BoxTree(std::span<const AxisBox> boxes) : number_(boxes.size()) {
  if (boxes.empty()) return;
  std::iota(number_.begin(), number_.end(), Index(0));
  boxes_.assign(boxes.begin(), boxes.end());
  nodes_.reserve(boxes.size());
  nodes_.push_back({{}, none, 0, Index(boxes.size())});
  for (std::size_t n = 0; n < nodes_.size(); ++n) grow(n);
  for (std::size_t k = 0; k < number_.size(); ++k) boxes_[k] = boxes[std::size_t(number_[k])];
}

void BoxTree::grow(std::size_t n) {
  const Index first = nodes_[n].first, count = nodes_[n].count;
  const auto begin = number_.begin() + first;
  const auto twice_center = [&](Index i) -> Vec2 { return boxes_[std::size_t(i)].low + boxes_[std::size_t(i)].high; };
  AxisBox centers;
  for (auto i = begin; i != begin + count; ++i) {
    nodes_[n].box.add(boxes_[std::size_t(*i)]);
    centers.add(twice_center(*i));
  }
  if (count <= most_in_leaf) return;
  const Vec2 size = centers.high - centers.low;
  const Eigen::Index axis = size.x() >= size.y() ? 0 : 1;
  const Index half = count / 2;
  std::nth_element(begin, begin + half, begin + count, [&](Index i, Index j) {
    const double a = twice_center(i)[axis], b = twice_center(j)[axis];
    return a < b || (a == b && i < j);
  });
  nodes_[n].child = Index(nodes_.size());
  nodes_.push_back({{}, none, first, half});
  nodes_.push_back({{}, none, first + half, count - half});
}

std::vector<Index> BoxTree::meeting(const AxisBox& box) const {
  std::vector<Index> found;
  each([&](const AxisBox& b) { return b.meets(box); }, [&](Index i) { found.push_back(i); });
  std::ranges::sort(found);
  return found;
}

}  // namespace kerf
