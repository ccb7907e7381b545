#include "io/case/measured.hpp"

#include "geometry/plane.hpp"
#include "io/case/table.hpp"
#include "io/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

namespace kerf {

namespace {

constexpr double reach = 0.01;  // of the extent

struct Measured {
  std::vector<Vec2> x, u;
  double furthest;
  std::string where;  // beginning of messages
};

Vec2 interpolate(const Measured& m, const Vec2& x) {
  double least = infinity;
  Vec2 u = Vec2::Zero();
  for (std::size_t i = 0; i + 1 < m.x.size(); ++i) {
    const Vec2 along = m.x[i + 1] - m.x[i];
    const double t = foot(x, m.x[i], m.x[i + 1]);
    const double distance = (x - m.x[i] - t * along).norm();
    if (distance < least) {
      least = distance;
      u = (1 - t) * m.u[i] + t * m.u[i + 1];
    }
  }
  if (!(least <= m.furthest))
    throw Error(Fault::Usage,
                fmt::format("{}: the data are {:.4g} from the boundary point ({:.6g}, {:.6g}); measure along the whole "
                            "label, no further from it than {:.4g} (1 % of the body's size)",
                            m.where, least, x.x(), x.y(), m.furthest));
  return u;
}

}  // namespace

BoundaryField read_measured(const std::filesystem::path& path, const Value& field, const Shape& shape, Index label) {
  const auto m = std::make_shared<Measured>();
  for (const std::vector<double>& row : read_table(path, field, {"x", "y", "u_x", "u_y"})) {
    m->x.emplace_back(row[0], row[1]);
    m->u.emplace_back(row[2], row[3]);
  }
  if (m->x.size() < 2)
    fail(field.node->position, fmt::format("{}: {} has one point; give at least 2, in order along the boundary",
                                           field.name, quote(text(field))));
  m->furthest = reach * extent(shape);
  m->where = fmt::format("{}: {} = {}", to_string(field.node->position), field.name, quote(text(field)));
  const auto check = [&](const Loop& loop) {
    const Polygon p = flatten(loop, 1e-4 * extent(shape), extent(shape) / 50);
    for (std::size_t i = 0; i < p.points.size(); ++i) {
      if (p.label[i] != label) continue;
      const Vec2 along = p.points[(i + 1) % p.points.size()] - p.points[i];
      constexpr int places = 20;  // straight sides are one piece
      for (int k = 0; k <= places; ++k) interpolate(*m, p.points[i] + along * k / places);
    }
  };
  check(shape.outline);
  for (const Loop& hole : shape.holes) check(hole);
  return [m](const Vec2& x, const Vec2&) { return interpolate(*m, x); };
}

}  // namespace kerf
