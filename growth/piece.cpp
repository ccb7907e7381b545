// Pieces of a path as chords whose directions go from that of the begin to that of the tip [theory: G.19, G.20].

#include "growth/piece.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf::growth {

namespace {

Vec2 along(double direction) {
  return {std::cos(direction), std::sin(direction)};
}

double direction_of(const Vec2& v) {
  return std::atan2(v.y(), v.x());
}

void check_piece(double turn, double length) {
  if (!(length > 0) || !std::isfinite(length))
    throw Error(Fault::Usage, fmt::format("a piece of a path has length {}; a positive one is wanted", length));
  if (!(std::abs(turn) <= pi))
    throw Error(Fault::Usage,
                fmt::format("a piece of a path turns by {} degrees; at most 180 are wanted", turn * 180 / pi));
}

}  // namespace

PathTip tip_of(std::span<const Vec2> path, bool smooth) {
  const std::size_t n = path.size();
  if (n < 2) throw Error(Fault::Usage, fmt::format("a path has {} points; two at least are wanted", n));
  const Vec2 last = path[n - 1] - path[n - 2];
  if (!(last.norm() > 0)) throw Error(Fault::Usage, "the last two points of a path are the same");
  const double direction = direction_of(last);
  if (!smooth || n < 3) return {path[n - 1], direction, 0};
  const Vec2 before = path[n - 2] - path[n - 3], chord = path[n - 1] - path[n - 3];
  if (!(before.norm() > 0)) throw Error(Fault::Usage, "two of the last three points of a path are the same");
  // Signed curvature of the circle through three points; the tangent is half its turn ahead of the last chord.
  const double curvature = 2 * cross(before, last) / (before.norm() * last.norm() * chord.norm());
  return {path[n - 1], direction + std::asin(std::clamp(curvature * last.norm() / 2, -1., 1.)), curvature};
}

GrowthPiece arc_piece(const PathTip& tip, double turn, double length) {
  check_piece(turn, length);
  return {tip.at, tip.direction, length, turn, 0};
}
GrowthPiece kinked_piece(const PathTip& tip, double angle, double turn, double length) {
  check_piece(angle, length);
  check_piece(turn, length);
  return {tip.at, tip.direction + angle, length, turn, 1. / 3};
}
GrowthPiece straight_piece(const PathTip& tip, double angle, double length) {
  check_piece(angle, length);
  return {tip.at, tip.direction, length, angle, 1};
}

std::vector<Vec2> chords(const GrowthPiece& piece, int n) {
  const bool straight = piece.turn == 0 || piece.early == 1;
  if (n < (straight ? 1 : 2))
    throw Error(Fault::Usage, fmt::format("a piece that bends is drawn by {} chords; two at least are wanted", n));
  std::vector<Vec2> points;
  Vec2 at = piece.from;
  for (int j = 0; j < n; ++j) {
    const double share = n == 1 ? 1 : piece.early + (1 - piece.early) * j / (n - 1);
    at += piece.length / n * along(piece.direction + share * piece.turn);
    points.push_back(at);
  }
  return points;
}

PathTip end_of(const GrowthPiece& piece, int n) {
  return {chords(piece, n).back(), piece.direction + piece.turn, (1 - piece.early) * piece.turn / piece.length};
}

}  // namespace kerf::growth
