// Tables and fields of a run as files: state, cracks, bounds, design, map and probes. Each file is handed to the writer
// with copies of what it needs and is written while the run goes on. Angles at corners are means of axes, not of
// vectors:
//   angle = 1/2 arg sum over triangles of area exp(2 i angle),
// in [0, pi), since a crack at 0 and one at pi are the same. Rows of points outside the body have empty cells. Columns
// that a request does not ask for (bounds, second terms, angles) are not there. docs/results.md lists the files.

#include "app/write/files.hpp"
#include "io/design.hpp"
#include "io/files.hpp"
#include "solver/system.hpp"

#include <fmt/core.h>

#include <array>
#include <cmath>

namespace kerf {

namespace {

constexpr double degree = pi / 180;

/// 0: counts for the extrema; 1: masked; 2: near a singular point.
Eigen::RowVectorXd flags_of_points(std::span<const LeftOut> values) {
  Eigen::RowVectorXd row(static_cast<Eigen::Index>(values.size()));
  for (Eigen::Index i = 0; i < row.size(); ++i) row[i] = static_cast<double>(values[static_cast<std::size_t>(i)]);
  return row;
}

/// The angle at the corners: axes, not vectors, weighted by the areas of the triangles that meet there.
Eigen::VectorXd angle_at_corners(const Mesh& mesh, const PlotData& data, const Eigen::VectorXd& at_centroids) {
  const auto n = static_cast<Eigen::Index>(data.points.size());
  Eigen::Matrix2Xd sum = Eigen::Matrix2Xd::Zero(2, n);
  for (Index t = 0; t < static_cast<Index>(mesh.triangles.size()); ++t) {
    const double twice = 2 * at_centroids[t];
    if (!std::isfinite(twice)) continue;
    for (const Index corner : data.corners.of[static_cast<std::size_t>(t)])
      sum.col(corner) += area(mesh, t) * Vec2(std::cos(twice), std::sin(twice));
  }
  Eigen::VectorXd angle(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    angle[i] = 0.5 * std::atan2(sum(1, i), sum(0, i));
    if (angle[i] < 0) angle[i] += pi;
  }
  return angle;
}

/// With copies of what the data go on to be used for.
}  // namespace

void write_fields(const Journal& journal, const std::string& name, const Mesh& mesh, const PlotData& data,
                  std::vector<NamedField> fields) {
  if (!journal.whole) return;
  const std::size_t bytes = held(data.points, data.corners, fields);
  journal.later([path = journal.file(name), points = data.points, triangles = data.corners.of,
                 middle = middle_points(mesh, data.corners.of),
                 fields = std::move(fields)] { write_vtu(path, points, triangles, fields, middle); },
                bytes);
}

void write_text(const Journal& journal, const std::string& name, std::string text) {
  journal.later([path = journal.file(name), text = std::move(text)] { write_file(path, text); });
}

std::vector<NamedField> map_fields(const Mapped& mapped) {
  const FullMap& map = mapped.full;
  std::vector<NamedField> fields{{"topological_derivative", false, map.at_corners.transpose()},
                                 {"topological_derivative_at_centroid", true, map.at_centroids.transpose()},
                                 {"mask", false, flags_of_points(mapped.left_out_corner)},
                                 {"mask_at_centroid", true, flags_of_points(mapped.left_out_centroid)}};
  if (map.lower.size() > 0) {
    fields.push_back({"lower", false, map.lower.transpose()});
    fields.push_back({"upper", false, map.upper.transpose()});
  }
  if (map.c2.size() > 0) {
    fields.push_back({"c2", false, map.c2.transpose()});
    fields.push_back({"valid_radius", false, map.valid_radius.transpose()});
  }
  if (map.angle.size() > 0) fields.push_back({"angle_deg", true, map.angle.transpose() / degree});
  return fields;
}

namespace {

std::vector<MapPoint> at_corners(const Mesh& mesh, const PlotData& data, const FullMap& map) {
  const bool oriented = map.angle.size() > 0;
  const Eigen::VectorXd angle = oriented ? angle_at_corners(mesh, data, map.angle) : Eigen::VectorXd();
  std::vector<MapPoint> points;
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    MapPoint p{.at = data.points[i], .value = map.at_corners[k], .masked = map.masked_corner[i]};
    if (oriented) p.angle = angle[k];
    if (map.lower.size() > 0) p.lower = map.lower[k], p.upper = map.upper[k];
    if (map.c2.size() > 0) p.c2 = map.c2[k], p.valid_radius = map.valid_radius[k];
    points.push_back(p);
  }
  return points;
}

}  // namespace

void write_state_files(const Journal& journal, const Adapted& adapted, const PlotData& data,
                       const std::vector<CrackResult>& cracks) {
  if (journal.vtk && journal.whole)
    write_fields(journal, "state.vtu", adapted.model.mesh, data,
                 state_fields(adapted.model, adapted.state, data, adapted.indicator));
  for (const CrackResult& crack : cracks) {
    const std::string name = "crack_" + crack.name;
    journal.later([path = journal.file(name + ".csv"), crack] { write_crack_csv(path, crack); });
    if (!journal.vtk) continue;
    std::vector<std::vector<Vec2>> line(1);
    for (const CrackRow& row : crack.rows) line[0].push_back(row.at);
    journal.later([path = journal.file(name + ".vtp"), line = std::move(line), fields = crack_fields(crack)] {
      write_vtp(path, line, fields);
    });
  }
}

namespace {

/// Of the regions of the case, and of those that the design draws.
std::vector<Elastic> elastics_of(const Case& c, const OptimizeResult& r) {
  std::vector<Elastic> all = c.regions;
  Eigen::Index next = 0;
  if (!c.optimize || r.variables.size() == 0) return all;
  for (const Drawn& drawn : c.optimize->design.drawn) {
    next += drawn.lower.size();
    if (drawn.kind == Drawn::Kind::Inclusion) all.push_back({r.variables[next - 1], drawn.poisson});
  }
  return all;
}

}  // namespace

void write_bounds_files(const Journal& journal, const BoundsResult& bounds) {
  journal.later([path = journal.file("bounds.csv"), bounds] { write_bounds_csv(path, bounds); });
  if (!journal.vtk || bounds.points.empty()) return;
  struct Quantity {
    const char* name;
    Bounded BoundedPoint::*of;
  };
  const std::array<Quantity, 5> quantities{{{"s_xx", &BoundedPoint::s_xx},
                                            {"s_yy", &BoundedPoint::s_yy},
                                            {"s_xy", &BoundedPoint::s_xy},
                                            {"von_mises", &BoundedPoint::von_mises},
                                            {"topological_derivative", &BoundedPoint::derivative}}};
  const auto n = static_cast<Eigen::Index>(bounds.points.size());
  std::vector<std::vector<Vec2>> places;
  for (const BoundedPoint& p : bounds.points) places.push_back({p.at});
  std::vector<NamedField> fields;
  for (const Quantity& q : quantities) {
    Eigen::MatrixXd value(1, n), lower(1, n), upper(1, n), guaranteed(1, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Bounded& b = bounds.points[static_cast<std::size_t>(i)].*q.of;
      value(0, i) = b.value;
      lower(0, i) = b.lower;
      upper(0, i) = b.upper;
      guaranteed(0, i) = b.guaranteed ? 1 : 0;
    }
    const std::string name = q.name;
    fields.push_back({name, false, std::move(value)});
    fields.push_back({name + "_lower", false, std::move(lower)});
    fields.push_back({name + "_upper", false, std::move(upper)});
    fields.push_back({name + "_guaranteed", false, std::move(guaranteed)});
  }
  journal.later([path = journal.file("bounds.vtp"), places = std::move(places), fields = std::move(fields)] {
    write_vtp(path, places, fields);
  });
}

void write_design_files(const Journal& journal, const Case& c, const OptimizeResult& r) {
  const std::vector<Elastic> regions = elastics_of(c, r);
  std::span<const Loop> frozen;
  if (c.optimize) frozen = c.optimize->level_set.frozen;
  const DesignFile design{r.shape,
                          r.scene.laws,
                          regions,
                          {fmt::format("The design that kerf optimize found for \"{}\": {}.", c.title, r.stopped),
                           fmt::format("J = {:.12g}, volume fraction {:.8g}.", r.objective, r.volume_fraction)}};
  write_text(journal, "design.toml", design_case(c, design, journal.options.folder));
  write_text(journal, "design.svg", design_svg(r.shape, frozen, c.title));
  write_text(journal, "design.dxf", design_dxf(r.shape, frozen));
}

void write_map_files(const Journal& journal, const MapTask& task, const Mapped& map, const Mesh& mesh,
                     const PlotData& data) {
  if (journal.vtk && is_everywhere(map.full)) write_fields(journal, "map.vtu", mesh, data, map_fields(map));
  const bool bounds = task.request.bounds, second = task.request.second, oriented = map.full.angle.size() > 0;
  std::vector<std::string> columns = {"x", "y", "topological_derivative"};
  if (bounds) columns.insert(columns.end(), {"lower", "upper"});
  if (second) columns.insert(columns.end(), {"c2", "valid_radius"});
  if (oriented) columns.push_back("angle_deg");
  columns.push_back("masked");
  std::vector<std::vector<double>> rows;
  const bool everywhere = map.result.points.empty();
  for (const MapPoint& p : everywhere ? at_corners(mesh, data, map.full) : map.result.points) {
    std::vector<double> row = {p.at.x(), p.at.y(), p.value};
    if (bounds) row.insert(row.end(), {p.lower.value_or(nan), p.upper.value_or(nan)});
    if (second) row.insert(row.end(), {p.c2.value_or(nan), p.valid_radius.value_or(nan)});
    if (oriented) row.push_back(std::isfinite(p.value) ? p.angle / degree : nan);
    row.push_back(everywhere ? static_cast<double>(map.left_out_corner[rows.size()]) : p.masked ? 1 : 0);
    rows.push_back(std::move(row));
  }
  journal.later([path = journal.file("map.csv"), columns = std::move(columns), rows = std::move(rows)] {
    write_csv(path, columns, rows);
  });
}

namespace {

/// Lower and upper of the stresses, and whether all of them are guaranteed; null: no state to bound.
void append_bounds(std::vector<double>& row, const BoundedStress* b) {
  const Bounded none{nan, nan, nan};
  bool all = b != nullptr;
  for (const Bounded* of : {b ? &b->s_xx : &none, b ? &b->s_yy : &none, b ? &b->s_xy : &none}) {
    row.insert(row.end(), {of->lower, of->upper});
    all = all && of->guaranteed;
  }
  row.push_back(all ? 1 : 0);
}

}  // namespace

std::array<double, 8> probe_row(const Model& model, const State& state, Index triangle, const Vec2& x) {
  if (triangle == none) return {x.x(), x.y(), nan, nan, nan, nan, nan, nan};  // empty cells
  const Vec2 u = recovered_displacement(model, state, triangle, x).col(0);
  const Eigen::Vector4d s =
      stress_at(model.inner->kernel, kerf::triangle(model, triangle), state.interior.col(triangle), x);
  return {x.x(), x.y(), u.x(), u.y(), s[0], s[3], 0.5 * (s[1] + s[2]), nan};
}

void write_probe_file(const Journal& journal, const Probe& probe, std::vector<std::vector<double>> rows,
                      const std::vector<BoundedStress>& bounded) {
  std::vector<std::string> columns{"x", "y", "u_x", "u_y", "s_xx", "s_yy", "s_xy", "topological_derivative"};
  if (probe.bounds) {
    for (const char* name :
         {"s_xx_lower", "s_xx_upper", "s_yy_lower", "s_yy_upper", "s_xy_lower", "s_xy_upper", "guaranteed"})
      columns.emplace_back(name);
    for (std::size_t i = 0; i < rows.size(); ++i) append_bounds(rows[i], i < bounded.size() ? &bounded[i] : nullptr);
  }
  journal.later([path = journal.file("probe_" + probe.name + ".csv"), columns = std::move(columns),
                 rows = std::move(rows)] { write_csv(path, columns, rows); });
}

}  // namespace kerf
