#pragma once
// Boxes in a tree, to be found by what they meet: the one index of what is drawn. A question costs about the logarithm
// of their number and what it finds, however uneven their sizes and places are.

#include "kerf/types.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <span>
#include <utility>
#include <vector>

namespace kerf {

/// Sides parallel to the axes, closed; nothing at first.
struct AxisBox {
  Vec2 low = Vec2::Constant(infinity), high = Vec2::Constant(-infinity);

  void add(const Vec2& x) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  void add(const AxisBox& b) {
    low = low.cwiseMin(b.low);
    high = high.cwiseMax(b.high);
  }
  AxisBox grown(double by) const {
    return {low.array() - by, high.array() + by};
  }
  bool meets(const AxisBox& b) const {
    return low.x() <= b.high.x() && b.low.x() <= high.x() && low.y() <= b.high.y() && b.low.y() <= high.y();
  }
  bool has(const Vec2& x) const {
    return low.x() <= x.x() && x.x() <= high.x() && low.y() <= x.y() && x.y() <= high.y();
  }
  double squared_distance(const Vec2& x) const {
    return (low - x).cwiseMax(x - high).cwiseMax(0).squaredNorm();
  }
  /// The largest m . x in it.
  double farthest(const Vec2& m) const {
    return m.x() * (m.x() > 0 ? high : low).x() + m.y() * (m.y() > 0 ? high : low).y();
  }
};

inline AxisBox box_around(const Vec2& a, const Vec2& b) {
  return {a.cwiseMin(b), a.cwiseMax(b)};
}

/// Boxes numbered in the order in which they were given. A node of the tree is the box around those below it, halved
/// where its longer side has the median of their centers.
class BoxTree {
 public:
  BoxTree() = default;
  explicit BoxTree(std::span<const AxisBox> boxes);

  /// visit(i) for the boxes that may(box) holds for, in no particular order. It must hold for every box around one that
  /// it holds for.
  template <class May, class Visit>
  void each(May&& may, Visit&& visit) const {
    std::array<Index, most_open> open;
    std::size_t count = 0;
    if (!nodes_.empty()) open[count++] = 0;
    while (count > 0) {
      const Node& node = nodes_[std::size_t(open[--count])];
      if (!may(node.box)) continue;
      if (node.child != none) {
        open[count++] = node.child + 1;
        open[count++] = node.child;
        continue;
      }
      for (Index k = node.first; k < node.first + node.count; ++k)
        if (may(boxes_[std::size_t(k)])) visit(number_[std::size_t(k)]);
    }
  }

  /// The same among those within `reach` of x, leaf after leaf by their distances: visit may lower `reach`.
  template <class May, class Visit>
  void each_near(const Vec2& x, const double& reach, May&& may, Visit&& visit) const {
    constexpr double rounding = 1 + 1e-12;
    const auto within = [&](double squared_distance) { return squared_distance <= reach * reach * rounding; };
    using Open = std::pair<double, Index>;  // squared distance, node
    std::vector<Open> open;                 // a heap, the nearest one in front
    const auto add = [&](Index n) {
      const AxisBox& box = nodes_[std::size_t(n)].box;
      const double d = box.squared_distance(x);
      if (!within(d) || !may(box)) return;
      open.emplace_back(d, n);
      std::ranges::push_heap(open, std::greater<>());
    };
    if (!nodes_.empty()) add(0);
    while (!open.empty() && within(open.front().first)) {
      const Node& node = nodes_[std::size_t(open.front().second)];
      std::ranges::pop_heap(open, std::greater<>());
      open.pop_back();
      if (node.child != none) {
        add(node.child);
        add(node.child + 1);
        continue;
      }
      for (Index k = node.first; k < node.first + node.count; ++k) {
        const AxisBox& box = boxes_[std::size_t(k)];
        if (within(box.squared_distance(x)) && may(box)) visit(number_[std::size_t(k)]);
      }
    }
  }

  /// The numbers of the boxes that meet this one, rising.
  std::vector<Index> meeting(const AxisBox& box) const;

 private:
  static constexpr std::size_t most_open = 64;  // a tree of 2^32 boxes is 30 nodes deep
  struct Node {
    AxisBox box;
    Index child = none;  // the first of two, or none for a leaf
    Index first = 0, count = 0;
  };
  void grow(std::size_t node);

  std::vector<Node> nodes_;
  std::vector<AxisBox> boxes_;  // leaf after leaf
  std::vector<Index> number_;
};

}  // namespace kerf
