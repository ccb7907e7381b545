#pragma once
// The pictures of a run.

#include "app/run/map.hpp"
#include "inspect/interior.hpp"
#include "kerf/edge_cracks.hpp"
#include "plot/picture.hpp"

namespace kerf {

Picture mesh_picture(const std::string& title, const Mesh& mesh);
Picture stress_picture(const std::string& title, const Model& model, const PlotData& data);
Picture map_picture(const std::string& title, const MapTask& task, const Model& model, const PlotData& data,
                    const Mapped& mapped);

/// The boundary in colors of K of an edge crack, the body in those of a crack inside, gray where they are masked, and
/// the worst places.
Picture edge_crack_picture(const std::string& title, const Mesh& mesh, const inspect::EdgeCrackMap& map,
                           const std::vector<inspect::InteriorCrack>& interior, const Units& units);

/// The body in one color with its supports, and the loads of the scene and of the further load cases as arrows.
/// `size`: extent of the body.
Picture design_picture(const std::string& title, const Mesh& mesh, const Scene& scene,
                       std::span<const LoadCase> further, double size);

/// What a label, a crack or a region is called, and, where loads act, what they sum to.
struct Named {
  Index label = none;  // of the boundary
  std::string text;
};
/// The body as it was read, before anything is solved: labels, cracks, regions, supports, loads with their resultants.
Picture check_picture(const std::string& title, const Mesh& mesh, const Scene& scene, const Shape& shape,
                      std::span<const Named> labels);

/// (T - price of area) / price over a level set's design, and where it is least.
Picture optimality_picture(const std::string& title, const HoleMargin& holes);

inline constexpr std::uint32_t found_color = 0x0072b2, true_color = 0x009e73;
/// An inverse problem: what was found over what is true, where that is known, and where it began.
struct Found {
  const Shape& frame;
  Shape found, start;
  std::optional<Shape> truth = {};
  std::vector<UncertaintyEllipse> ellipses = {};
};
Picture found_picture(const std::string& title, const Found& found);

}  // namespace kerf
