#pragma once
// Body force and eigenstrain of duals that are cut off, in the triangles that have any [theory: B.20, B.42].

#include "solver/bounds/dual.hpp"
#include "solver/bounds/polynomial_data.hpp"
#include "solver/element/local.hpp"

#include <memory>
#include <optional>

namespace kerf {

/// Of one dual; matrices have a column per triangle of the ring.
struct RingLoads {
  std::shared_ptr<const std::vector<Index>> triangles;  // increasing
  Forces f;
  StrainData strain;
  Eigen::MatrixXd interior;  // coefficients (s, u, r) that they cause where the edges rest
  Eigen::MatrixXd given;     // the loads on the edges that they condense to, with those of the couples
  bool open = false;         // not resolved somewhere
};

std::shared_ptr<const std::vector<Index>> ring_triangles(const Model& m, const CutOffRing& ring);
/// Of some of its fields.
std::vector<RingLoads> ring_loads(const Model& m, const CutOffRing& ring, std::span<const std::size_t> fields);

/// One of the duals that are found together.
struct LaneDual {
  const Model* model;  // of its scene without the loads in the ring
  std::vector<EdgeData> data;
  std::optional<RingLoads> ring = std::nullopt;
  Eigen::VectorXd F = {};  // all of its loads, per row of the system
};
/// The loads of a dual that is cut off. In a body that nothing holds, what quadrature leaves of their work on its
/// motions is taken by tractions on free edges, which count as errors of the data there. False: that is not small, or
/// there is no free edge.
bool assemble_ring(LaneDual& dual);

/// Which duals have loads in a triangle, and where.
class LaneRings {
 public:
  LaneRings(std::span<const LaneDual> duals, Index triangles);
  /// A bit per dual.
  unsigned mask(Index t) const {
    return mask_.empty() ? 0 : mask_[static_cast<std::size_t>(t)];
  }
  /// Its column in the loads of a dual.
  Index column(Index t, int lane) const {
    return column_[static_cast<std::size_t>(lane)][static_cast<std::size_t>(t)];
  }
  /// Per triangle; empty where the dual has no ring.
  std::span<const Index> columns(int lane) const {
    return mask_.empty() ? std::span<const Index>() : std::span<const Index>(column_[static_cast<std::size_t>(lane)]);
  }

 private:
  std::vector<unsigned char> mask_;
  std::array<std::vector<Index>, lanes> column_;
};

}  // namespace kerf
