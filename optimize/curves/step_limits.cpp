// How far a step may take the curves: normal moves within a radius per chain, turns of knots and slides along rails,
// and how much of a violation may be asked for so that there is such a step [Conn, Gould, Toint 2000; theory: K.5].

#include "optimize/curves/step_limits.hpp"

#include <algorithm>
#include <cmath>

namespace kerf {

using Eigen::VectorXd;

namespace {

constexpr double sliding = 2;  // times the radius, of ends along the frame

}  // namespace

double furthest_move(const NormalMoves& moves, const VectorXd& step, const ChainLimits& most) {
  double worst = 0;
  const VectorXd move = moves.by * step;
  for (Eigen::Index i = 0; i < move.size(); ++i)
    worst = std::max(worst, std::abs(move[i]) / most.radius[std::size_t(moves.chain[std::size_t(i)])]);
  return worst;
}

// 1 is a step that uses all of what is allowed.
double overreach(const DesignCurves& d, const NormalMoves& moves, const VectorXd& step, const ChainLimits& most) {
  double worst = furthest_move(moves, step, most);
  for (std::size_t c = 0; c < d.holds.size(); ++c)
    for (const KnotHold& hold : d.holds[c]) {
      if (hold.angle != none) worst = std::max(worst, std::abs(step[hold.angle]) / most.turn[c]);
      if (hold.kind == KnotHold::Kind::Slides)
        worst = std::max(worst, std::abs(step[hold.offset]) / (sliding * most.radius[c]));
    }
  return worst;
}

void shorten_chains(const DesignCurves& d, const NormalMoves& moves, const ChainLimits& most, VectorXd& step) {
  std::vector<double> reach(d.chains.size(), 1);
  const VectorXd move = moves.by * step;
  for (Eigen::Index i = 0; i < move.size(); ++i) {
    const auto c = std::size_t(moves.chain[std::size_t(i)]);
    reach[c] = std::max(reach[c], std::abs(move[i]) / most.radius[c]);
  }
  VectorXd part = VectorXd::Ones(step.size());
  for (std::size_t c = 0; c < d.holds.size(); ++c)
    for (const KnotHold& hold : d.holds[c])
      for (const Index variable : {hold.offset, hold.angle})
        if (variable != none) part[variable] = std::min(part[variable], 1 / reach[c]);
  step = step.cwiseProduct(part);
}

LinearRows too_far(const DesignCurves& d, const NormalMoves& moves, const VectorXd& step, const ChainLimits& most) {
  constexpr double slack = 1 + 1e-3;
  // Of the three points of an arc the one that moves the furthest has a row.
  constexpr Eigen::Index per_arc = 3;
  LinearRows rows;
  const VectorXd move = moves.by * step;
  for (Eigen::Index i = 0; i < move.size(); i += per_arc) {
    Eigen::Index k = 0;
    const double radius = most.radius[std::size_t(moves.chain[std::size_t(i)])];
    if (!(move.segment(i, per_arc).cwiseAbs().maxCoeff(&k) > slack * radius)) continue;
    const double sign = move[i + k] > 0 ? 1 : -1;
    rows.add(sign * moves.by.row(i + k).transpose(), radius);
  }
  const auto limit = [&](Index variable, double largest) {
    if (variable == none || std::abs(step[variable]) <= slack * largest) return;
    VectorXd row = VectorXd::Zero(d.variables);
    row[variable] = step[variable] > 0 ? 1 : -1;
    rows.add(std::move(row), largest);
  };
  for (std::size_t c = 0; c < d.holds.size(); ++c)
    for (const KnotHold& hold : d.holds[c]) {
      limit(hold.angle, most.turn[c]);
      // Ends that graze the frame slide far where the curve hardly moves: the mesh has to follow.
      if (hold.kind == KnotHold::Kind::Slides) limit(hold.offset, sliding * most.radius[c]);
    }
  return rows;
}

void make_reachable(VectorXd& room, Eigen::Index front, const std::function<double(const VectorXd& last)>& reach) {
  constexpr double ample = 0.4;
  const auto shorten = [&](Eigen::Index first, Eigen::Index count, double share, Eigen::Index rows) {
    auto some = room.segment(first, count);
    if (count == 0 || !(some.minCoeff() < 0)) return;
    // A part of that step keeps to the violated rows shortened by it, and to those that have room.
    const double part = std::min(1.0, share / std::max(reach(room.tail(rows)), 1e-300));
    for (double& r : some)
      if (r < 0) r *= part;
  };
  // 2/5 of the radius for the geometry, then 4/5 for all.
  shorten(front, room.size() - front, ample, room.size() - front);
  shorten(0, front, 2 * ample, room.size());
}

}  // namespace kerf
