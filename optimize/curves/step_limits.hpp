#pragma once
// How far a step may take the curves, and what it asks for beyond that.

#include "optimize/curves/boundary.hpp"

#include <functional>

namespace kerf {

/// Per chain: the largest normal move, and the largest turn of a knot.
struct ChainLimits {
  std::vector<double> radius, turn;
};

/// The largest normal move of a step, in the radii of its chains.
double furthest_move(const NormalMoves& moves, const Eigen::VectorXd& step, const ChainLimits& most);

/// The same, or a turn or a slide where that is larger.
double overreach(const DesignCurves& d, const NormalMoves& moves, const Eigen::VectorXd& step, const ChainLimits& most);

/// Shortens what a step does to each chain that it moves, turns or slides too far, and leaves the others.
void shorten_chains(const DesignCurves& d, const NormalMoves& moves, const ChainLimits& most, Eigen::VectorXd& step);

/// Rows for what a step moves or turns by more than allowed, those that it moves the furthest within each arc.
LinearRows too_far(const DesignCurves& d, const NormalMoves& moves, const Eigen::VectorXd& step,
                   const ChainLimits& most);

/// What is violated is made up for as far as the shortest step that would goes within the radius: first the geometry
/// (rows from `front` on), then with it the rest [theory: K.5]. `reach`: of the step that keeps to these last rows, in
/// radii.
void make_reachable(Eigen::VectorXd& room, Eigen::Index front,
                    const std::function<double(const Eigen::VectorXd& last)>& reach);

}  // namespace kerf
