// Values become bytes and come back, whatever they are made of; bytes that end too early are said, not read past.

#include "base/packer.hpp"

#include "kerf/types.hpp"

#include <gtest/gtest.h>

namespace kerf::packer_test {

struct Leaf {
  Vec2 at = Vec2::Zero();
  std::array<Mat2, 2> turns{Mat2::Zero(), Mat2::Zero()};
  std::string name;
  bool operator==(const Leaf&) const = default;
};

struct Tree {
  std::vector<Leaf> leaves;
  std::optional<Leaf> first, second;
  std::vector<std::vector<int>> numbers;
  Eigen::VectorXd values;
  double size = 0;
};

template <typename Visit, Like<Leaf> T>
static void fields(Visit& visit, T& leaf) {
  visit(leaf.at, leaf.turns, leaf.name);
}

template <typename Visit, Like<Tree> T>
static void fields(Visit& visit, T& tree) {
  visit(tree.leaves, tree.first, tree.second, tree.numbers, tree.values, tree.size);
}

namespace {

Tree example() {
  Tree tree;
  tree.leaves = {{{1, 2}, {Mat2::Identity(), 2 * Mat2::Identity()}, "a"}, {{-0.5, 1e300}, {}, std::string("\0b", 2)}};
  tree.second = tree.leaves[1];
  tree.numbers = {{1, 2, 3}, {}, {4}};
  tree.values = Eigen::VectorXd::LinSpaced(5, 0, 1);
  tree.size = -0.0;
  return tree;
}

std::string packed(const Tree& tree) {
  Packer to;
  to(tree);
  return std::move(to).take();
}

TEST(Packer, WhatIsPackedComesBack) {
  const Tree tree = example();
  const std::string bytes = packed(tree);
  Unpacker from(bytes);
  const auto read = from.get<Tree>();
  EXPECT_EQ(read.leaves, tree.leaves);
  EXPECT_EQ(read.first, tree.first);
  EXPECT_EQ(read.second, tree.second);
  EXPECT_EQ(read.numbers, tree.numbers);
  EXPECT_EQ(read.values, tree.values);
  EXPECT_EQ(packed(read), bytes);
}

TEST(Packer, BytesThatEndTooEarlyAreSaid) {
  const std::string bytes = packed(example());
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    Unpacker from(std::string_view(bytes).substr(0, n));
    EXPECT_THROW(from.get<Tree>(), std::logic_error) << n;
  }
}

// A count is looked at before memory is asked for.
TEST(Packer, CountsBeyondTheBytesAreSaid) {
  Packer to;
  to(std::size_t{1} << 60);
  const std::string bytes = std::move(to).take();
  EXPECT_THROW(Unpacker(bytes).all<double>(), std::logic_error);
  EXPECT_THROW(Unpacker(bytes).all<Leaf>(), std::logic_error);
  EXPECT_THROW(Unpacker(bytes).text(), std::logic_error);
}

}  // namespace
}  // namespace kerf::packer_test
