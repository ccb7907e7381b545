#pragma once
// Where the integrals of a term look: at the points of one rule per triangle and edge, and of more where weights,
// targets and directions vary within it.

#include "base/quadrature.hpp"
#include "kerf/functional.hpp"
#include "kerf/model.hpp"
#include "topo/analysis.hpp"

#include <memory>
#include <optional>

namespace kerf {

struct Triangle;

/// Where domain integrals look as a rule: powers of stresses are no polynomials of low degree.
TriangleRule domain_rule(const Model& model);
/// Whether the density may be anything but 0 on a triangle.
bool wanted(const Term& term, const Triangle& t);

/// Rules in the coordinates of triangles and edges, cut where the enclosures of the data leave more than 1e-4 of their
/// integrals there, in some hundred pieces at most.
class RulesOfTerm {
 public:
  /// Both are kept by reference.
  RulesOfTerm(const Term& term, const Model& model);
  RulesOfTerm(const RulesOfTerm&) = delete;
  RulesOfTerm& operator=(const RulesOfTerm&) = delete;
  ~RulesOfTerm();
  /// Nothing where domain_rule serves.
  std::optional<TriangleRule> cut(Index triangle) const;
  /// From `pieces` equal ones on.
  EdgeRule along(Index edge, int pieces = 1) const;

 private:
  friend Missed missed(const Term&, const Model&);
  struct Data;
  const std::unique_ptr<const Data> data_;
};

}  // namespace kerf
