#pragma once
// From the level set's polygons to few smooth curves, and these to an optimum of first order.

#include "geometry/carve.hpp"
#include "kerf/optimize.hpp"

#include <memory>
#include <optional>

namespace kerf {

struct DesignCurves;

struct CurvesRequest {
  double size = 0;        // of the mesh; 0: that of the problem
  double tolerance = 0;   // of the fit; 0: 0.2 of the size
  double min_radius = 0;  // of arcs of the design; 0: any
  double min_feature =
      0;               // least width of members, and of gaps without min_gap; 0: one size. What is thinner gets wider
  double min_gap = 0;  // where that leads to a shape of the area allowed
  int evaluations = 40;
  int further = 0;                   // evaluations in all, while more than the tolerance of the request is left to gain
  double residual = 1e-2;            // of the shape on a mesh of its own that is good enough
  std::vector<double> at_most = {};  // of the bounds, where those of the request leave room for what a finer mesh says
};

/// An evaluation: what a row of a history says, and all that a replay needs.
struct CurvesRow {
  double J = nan, area = nan;  // area of the curves
  double area_fraction = 0;    // of the frame
  std::vector<double> bounds;
  double violation = 0;  // largest relative one of a constraint
  double residual = nan, price = nan;
  double step = 0;  // largest move of the curves
  Index triangles = 0;
  int holes = 0, state_solves = 0;       // solves so far
  bool accepted = false, fresh = false;  // fresh: on a mesh made for it
  bool rebased = false;                  // on a mesh made where its step begins
  std::string note;
  std::string failure;                       // why there are no values; empty mostly
  Eigen::VectorXd knots, values, gradients;  // for a replay
};

/// How the steps ended.
enum class CurvesEnding { AtResidual, StandsStill, NoStep, Evaluations, Stopped, AsCarved };

struct FinishedCurves {
  Shape shape;                  // lines and arcs; labels as carved
  std::vector<Index> crack_of;  // as carved
  double J = nan, area = nan;
  std::vector<double> bounds;
  double residual = nan, price = nan;
  double residual_before = nan;  // of the curves as fitted
  double gain = nan;             // of J plus price of area, by moving them: what could still be had [theory: K.8]
  std::optional<FinerDesign> finer = {};  // on the mesh by which designs are judged, with the residual there
  int evaluations = 0, state_solves = 0;
  bool feasible = false;
  std::vector<CurvesRow> rows;
  std::vector<std::string> notes;
  CurvesEnding ended = CurvesEnding::AsCarved;
  std::string why;                                  // it ended
  std::shared_ptr<const DesignCurves> curves = {};  // those of the shape; none where it stays as carved
};

/// After each accepted evaluation that was made anew; false: stop.
struct CurvesIterate {
  const std::vector<CurvesRow>& rows;  // all so far, refused ones too; the last one is this
  const Shape& shape;
  const Model& model;
  const State& state;
};
using CurvesObserver = std::function<bool(const CurvesIterate&)>;

/// The sides labeled "design" as chains of arcs within the tolerance, of the same area; other sides as they are, except
/// that those next to a chain end where it does. Throws Error(Geometry) when no such shape can be meshed.
Shape fit_curves(const Problem& p, const OptimizeRequest& r, const Carved& carved, const CurvesRequest& how);

/// Fits and minimizes J + penalty * area under the bounds of the request over the knots of the chains [theory: K.3].
/// `known`: evaluations of an earlier run, which are not made again; it then goes on as if it had not been interrupted.
/// What cannot be moved comes back as it was, with a note. Throws Error(Geometry | Numerics) when the curves as fitted
/// cannot be meshed or solved, Error(Usage) for what the element or the scene cannot do.
FinishedCurves finish_curves(const Problem& p, const OptimizeRequest& r, const Carved& carved, const CurvesRequest& how,
                             const CurvesObserver& see, const std::vector<CurvesRow>& known = {});

/// The same from curves that are there already, instead of a fit.
FinishedCurves continue_curves(const Problem& p, const OptimizeRequest& r, const Carved& carved,
                               const DesignCurves& start, const CurvesRequest& how, const CurvesObserver& see,
                               const std::vector<CurvesRow>& known = {});

}  // namespace kerf
