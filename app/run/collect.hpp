#pragma once
// From a model and its solution to the numbers and fields of a result.

#include "io/result.hpp"
#include "kerf/adaptive.hpp"
#include "kerf/bounds.hpp"
#include "kerf/fracture.hpp"
#include "kerf/map.hpp"
#include "kerf/recover.hpp"
#include "kerf/vtk.hpp"
#include "solver/effort.hpp"

#include <array>
#include <span>

namespace kerf {

/// Everything that plots need, computed once.
struct PlotData {
  Corners corners;
  std::vector<Vec2> points;  // of the corners
  CornerValues values;
  Eigen::VectorXd von_mises;  // at corners
};

/// Corners and points alone: where a map is drawn.
PlotData plot_corners(const Model& model);
PlotData plot_data(const Model& model, const Field& state, bool plane_strain);

SolverResult solver_result(const SolverEffort& effort);
void add_energy_bounds(const EnergyBounds& bounds, StateResult& state);
ContactResultSummary contact_result(const State& state, ContactMethod method, const std::vector<CrackResult>& cracks);
/// Which ends of a crack are tips, and how many points its profile has per edge.
struct CrackEnds {
  std::array<bool, 2> tips;
  std::size_t per_edge;
};
/// Without tips. `slip`: per point what it has slid, with friction; else empty. A crack that is closed but for at most
/// half the edge at a tip is closed there, too: the discrete pressure is false on that edge [theory: F.8].
CrackResult crack_result(const std::string& name, const CrackLaw& law, const std::vector<CrackPoint>& of,
                         const std::vector<double>& slip, const CrackEnds& ends);
TipResult tip_result(const TipIntensity& tip);
/// Behind the cracks of the shape those in planes of symmetry (Case::planes), with the labels of their faces for names;
/// `tips`: with K, G and T at the tips.
void add_half_cracks(const Model& model, const State& state, const Shape& shape, std::span<const Index> planes,
                     bool tips, std::vector<CrackResult>& results);

/// What contact on cracks is measured by.
struct ContactMeasures {
  double stress;  // mean in the body
  const std::vector<std::vector<CrackPoint>>& profiles;
};
/// Whether faces of one of them touch and part in turn so often that measures tell how much that is.
bool turn_often(const std::vector<CrackResult>& cracks);
/// Cracks whose faces touch and part in turn by less than the mesh errs by, as under loads that neither open nor close
/// them. `body`: that the cracks are in, its mesh divided or not.
std::vector<std::string> notes_on_contact(const std::vector<CrackResult>& cracks, const Model& body,
                                          const ContactMeasures& of);

/// What the extrema of a map leave out, per corner or triangle.
enum class LeftOut : unsigned char { No, Masked, Singular };
FunctionalResult functional_result(const Functional& j, const Analysis& analysis);
/// What is mapped: `points`: where it is asked for; none: everywhere.
struct MapTask {
  const Functional& functional;
  const MapRequest& request;
  const std::vector<Vec2>& points;
};
/// Empty where the map is made at listed points only.
bool is_everywhere(const FullMap& map);
std::vector<NamedField> state_fields(const Model& model, const State& state, const PlotData& data,
                                     const Indicator& indicator);
/// Of an iterate of an optimization.
std::vector<NamedField> design_fields(const Model& model, const PlotData& data);
/// Bytes that they take.
std::size_t held(const std::vector<Vec2>& points, const Corners& corners, const std::vector<NamedField>& fields);
std::vector<NamedField> crack_fields(const CrackResult& crack);

}  // namespace kerf
