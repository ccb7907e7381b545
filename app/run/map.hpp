#pragma once
// The value of a functional, and the map of its topological derivative.

#include "app/run/collect.hpp"
#include "app/run/solve.hpp"

namespace kerf {

struct SingularZones;  // app/run/peaks.hpp

/// What a reader of the value should know.
std::vector<std::string> notes_on(const Functional& j, const Analysis& analysis, const Shape& shape,
                                  const std::vector<CrackResult>& cracks);

/// Whether a misfit is larger than on a mesh of twice the size, in words: measured displacements that jump, or are
/// scattered, have an energy that every finer mesh sees more of. J: on the mesh of the body; empty for other
/// functionals.
std::string note_on_growth(const Functional& j, const Body& body, ContactMethod contact, const Analysis& analysis);

struct Mapped {
  FullMap full;
  MapResult result;
  std::vector<LeftOut> left_out_corner, left_out_centroid;
};
/// Without its result. `zones`: what the extrema leave out besides the mask.
Mapped make_map(const MapTask& task, Analysis& analysis, const PlotData& data, const SingularZones& zones);

/// What a reader of this map should know.
std::vector<std::string> limits_of_map(const MapTask& task, const Analysis& analysis, const MapResult& map);

/// Whether a body is so nearly incompressible that its map may need limits: those of bodies held all around.
bool may_answer_by_pressure(const Scene& scene);

/// The error bars that the task asks for; what stands in their place, where there are none.
std::vector<std::string> bound_map(const MapTask& task, const Analysis& analysis, const Body& body, Mapped& map);

/// The files and the picture of a map.
void write_map(const MapTask& task, const Mapped& map, const Model& model, const PlotData& data, Journal& journal);

}  // namespace kerf
