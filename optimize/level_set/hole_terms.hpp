#pragma once
// What a hole of a finite radius changes: two terms of the expansion [theory: Q.1, L.14].

#include "kerf/second_order.hpp"
#include "optimize/loop/evaluate.hpp"

namespace kerf {

/// J changes by pi r^2 (T + c2 r^2).
struct HoleTerms {
  double T = nan, c2 = nan;  // c2: NaN where it is not known
  std::string note = {};     // why not
  bool resolved = true;      // false: c2 could be known, but the mesh is too coarse there

  /// By T alone where c2 is not known.
  double change(double radius) const;
};

/// The radius up to `most` at which pi r^2 (price - T - c2 r^2) is largest; 0 where no hole pays.
double best_radius(const HoleTerms& of, double price, double most);

/// The terms of sums of functionals of one design, which must outlive it.
class HoleExpansion {
 public:
  /// What the objective is the sum of, and what bounds add to it.
  HoleExpansion(std::vector<WeightedAnalysis> objective, std::vector<WeightedAnalysis> bounds);

  /// T of the whole sum at the centroids of the mesh.
  const Eigen::VectorXd& derivative() const {
    return sum_;
  }
  /// Of the whole sum. Of bounds whose c2 is not known only T counts.
  HoleTerms merit(const Vec2& x);
  HoleTerms objective(const Vec2& x);

 private:
  struct Part {
    WeightedAnalysis of;
    Eigen::VectorXd T;  // at centroids
    std::unique_ptr<SecondOrders> second;
    bool bound;
  };
  void add(WeightedAnalysis of, bool bound);
  HoleTerms terms(const Vec2& x, bool bounds);

  std::vector<std::unique_ptr<Part>> parts_;
  Eigen::VectorXd sum_;
  Locator locator_;
};

}  // namespace kerf
