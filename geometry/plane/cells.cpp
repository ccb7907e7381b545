// Segments filed in square cells by their boxes, with a counting sort.

#include "geometry/plane/cells.hpp"

namespace kerf {

Cells file(std::span<const std::array<Vec2, 2>> segments, double width, double margin, int most) {
  Cells cells;
  Vec2 high = Vec2::Constant(-infinity);
  cells.low = -high;
  for (const auto& [a, b] : segments) {
    cells.low = cells.low.cwiseMin(a).cwiseMin(b);
    high = high.cwiseMax(a).cwiseMax(b);
  }
  cells.width = std::max(width, (high - cells.low).maxCoeff() / most);
  cells.columns = int((high.x() - cells.low.x()) / cells.width) + 1;
  cells.rows = int((high.y() - cells.low.y()) / cells.width) + 1;
  cells.start.assign(std::size_t(cells.columns) * std::size_t(cells.rows) + 1, 0);
  const auto each = [&](const std::array<Vec2, 2>& s, auto&& visit) {
    const Vec2 l = s[0].cwiseMin(s[1]).array() - margin, h = s[0].cwiseMax(s[1]).array() + margin;
    for (int r = cells.row(l.y()); r <= cells.row(h.y()); ++r)
      for (int c = cells.column(l.x()); c <= cells.column(h.x()); ++c)
        visit(std::size_t(r) * std::size_t(cells.columns) + std::size_t(c));
  };
  for (const auto& s : segments) each(s, [&](std::size_t i) { ++cells.start[i + 1]; });
  for (std::size_t i = 0; i + 1 < cells.start.size(); ++i) cells.start[i + 1] += cells.start[i];
  cells.listed.resize(std::size_t(cells.start.back()));
  std::vector<Index> fill(cells.start.begin(), cells.start.end() - 1);
  for (std::size_t k = 0; k < segments.size(); ++k)
    each(segments[k], [&](std::size_t i) { cells.listed[std::size_t(fill[i]++)] = Index(k); });
  return cells;
}

}  // namespace kerf
