#pragma once
// Syntax trees evaluated node after node: however deep a tree is, it costs no stack.

#include "io/case/decided.hpp"

#include <vector>

namespace kerf {

/// Evaluates `node`, what it needs before it. `needs(k, wanted)` appends what k needs still, in the order of its
/// evaluation from the back, as far as it can tell by now; where it appends nothing `evaluate(k)` is called.
template <typename Known, typename Needs, typename Evaluate>
void evaluate_in_order(int node, Known&& known, Needs&& needs, Evaluate&& evaluate) {
  std::vector<int> open{node};
  while (!open.empty()) {
    const int k = open.back();
    const std::size_t before = open.size();
    if (!known(k)) {
      needs(k, open);
      if (open.size() > before) continue;
      evaluate(k);
    }
    open.pop_back();
  }
}

/// What a node of any kind needs: of a choice its condition and the branches that this leaves open, of && and || the
/// second where the first does not settle it. `range(k)`: of a node that is known.
template <typename Known, typename Range>
void append_needed(const SyntaxNode& n, Known&& known, Range&& range, std::vector<int>& wanted) {
  using Kind = SyntaxNode::Kind;
  const auto want = [&](std::size_t k) {
    if (!known(n.of[k])) wanted.push_back(n.of[k]);
  };
  switch (n.kind) {
    case Kind::Choice: {
      if (!known(n.of[0])) return want(0);
      const Truth condition = truth(range(n.of[0]));
      if (condition != Truth::Yes) want(2);
      if (condition != Truth::No) want(1);
      return;
    }
    case Kind::And:
    case Kind::Or:
      if (!known(n.of[0])) return want(0);
      if (truth(range(n.of[0])) != (n.kind == Kind::And ? Truth::No : Truth::Yes)) want(1);
      return;
    case Kind::Call:
      for (std::size_t k = n.of.size(); k-- > 0;) want(k);
      return;
    default:  // the last one first
      for (std::size_t k = 0; k < n.of.size(); ++k) want(k);
  }
}

}  // namespace kerf
