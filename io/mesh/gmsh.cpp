#include "io/mesh/gmsh.hpp"

#include "geometry/arc_chain.hpp"
#include "geometry/plane.hpp"
#include "io/files.hpp"
#include "io/mesh/gmsh_module.hpp"
#include "io/module.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace kerf {

namespace {

struct Module {
  KerfGmshMesher mesh = nullptr;
  KerfGmshStep step = nullptr;
  std::string reason = {};
};

const Module& loaded() {
  static const Module module = [] {
    const LoadedModule found = load_module("kerf_gmsh.so", KERF_GMSH_FOLDER, {"kerf_gmsh_mesh", "kerf_gmsh_step"});
    if (!found.handle) return Module{.reason = found.reason};
    return Module{reinterpret_cast<KerfGmshMesher>(dlsym(found.handle, "kerf_gmsh_mesh")),
                  reinterpret_cast<KerfGmshStep>(dlsym(found.handle, "kerf_gmsh_step"))};
  }();
  return module;
}

const Module& needed(const std::filesystem::path& path) {
  const Module& module = loaded();
  if (!module.mesh)
    throw Error(Fault::Files,
                fmt::format("{}: gmsh is needed for it, and kerf was built without it or does not find its module "
                            "kerf_gmsh.so ({}); ./dev gmsh builds it, or save a mesh (.msh) with gmsh",
                            path.string(), module.reason));
  return module;
}

/// A file of its own in the folder for temporary files, gone with the object.
class TemporaryMesh {
 public:
  TemporaryMesh() {
    name_ = (std::filesystem::temp_directory_path() / "kerf-XXXXXX.msh").string();
    const int file = mkstemps(name_.data(), 4);
    if (file < 0) throw Error(Fault::Files, fmt::format("cannot make a temporary file {}", name_));
    close(file);
  }
  TemporaryMesh(const TemporaryMesh&) = delete;
  TemporaryMesh& operator=(const TemporaryMesh&) = delete;
  ~TemporaryMesh() {
    std::error_code ignored;
    std::filesystem::remove(name_, ignored);
  }
  const std::string& name() const {
    return name_;
  }

 private:
  std::string name_;
};

/// What the points lie on, whatever gmsh calls it: a round ellipse is a circle.
void classify(RawCurve& curve) {
  const std::size_t n = curve.points.size();
  double size = 0, bulge = 0;
  for (const Vec2& x : curve.points) {
    size = std::max(size, (x - curve.points.front()).norm());
    bulge = std::max(bulge, distance(x, curve.points.front(), curve.points.back()));
  }
  constexpr double rounding = 1e-11;
  if (n < 4 || bulge <= rounding * size) return;
  curve.kind = RawCurve::Kind::Other;
  const Vec2 a = curve.points.front(), p = curve.points[n / 3] - a, q = curve.points[2 * n / 3] - a;
  const double twice = 2 * cross(p, q);
  const Vec2 center(q.y() * p.squaredNorm() - p.y() * q.squaredNorm(),
                    p.x() * q.squaredNorm() - q.x() * p.squaredNorm());
  if (twice == 0) return;
  curve.center = a + center / twice;
  curve.radius = center.norm() / std::abs(twice);
  if (std::all_of(curve.points.begin(), curve.points.end(), [&](const Vec2& x) {
        return std::abs((x - curve.center).norm() - curve.radius) <= rounding * curve.radius;
      }))
    curve.kind = RawCurve::Kind::Circle;
}

struct Told {
  std::map<std::int32_t, RawCurve> curves;
  std::string error;
};

void add_curve(void* target, const KerfGmshCurve* told) {
  RawCurve curve;
  for (std::int64_t k = 0; k < told->points; ++k) curve.points.emplace_back(told->xy[2 * k], told->xy[2 * k + 1]);
  classify(curve);
  static_cast<Told*>(target)->curves[told->tag] = std::move(curve);
}

void keep_error(void* target, const char* message) {
  static_cast<Told*>(target)->error = message;
}

}  // namespace

bool has_gmsh() {
  return loaded().mesh != nullptr;
}

RawMesh mesh_geometry(const BodySource& source) {
  const Module& module = needed(source.path);
  read_file(source.path);  // gmsh says nothing of a file that is not there
  const std::string path = source.path.string();
  const TemporaryMesh file;
  // Chords that are too long may cross.
  for (const int turn : {12, 48, 192}) {
    Told told;
    const KerfGmshRequest request{path.c_str(), file.name().c_str(), !source.keep_mesh, source.size, turn};
    if (module.mesh(&request, add_curve, keep_error, &told)) {
      RawMesh raw = parse_msh(path, read_file(file.name()));
      if (!source.keep_mesh) raw.curves = std::move(told.curves);
      return raw;
    }
    if (source.keep_mesh || turn == 192) throw Error(Fault::Geometry, fmt::format("{}: gmsh: {}", path, told.error));
  }
  return {};
}

namespace {

/// Arcs of more than a third of a turn in pieces.
std::vector<Side> short_arcs(const Loop& loop) {
  std::vector<Side> out;
  for (const Side& side : loop.sides) {
    const double whole = side.arc ? side.arc->to - side.arc->from : 0;
    const int count = std::max(1, int(std::ceil(std::abs(whole) / (2 * pi / 3) - 1e-9)));
    for (int k = 0; k < count; ++k) {
      Side part = side;
      if (side.arc) part.start = k == 0 ? side.start : at(*side.arc, side.arc->from + whole * k / count);
      out.push_back(part);
    }
  }
  return out;
}

}  // namespace

void write_step(const std::filesystem::path& path, const Shape& shape) {
  const Module& module = needed(path);
  const Shape drawn = circular(shape, 1e-4 * extent(shape), true);
  std::vector<Side> sides;
  std::vector<std::int64_t> ends;
  const auto add = [&](const Loop& loop) {
    for (const Side& side : short_arcs(loop)) sides.push_back(side);
    ends.push_back(std::int64_t(sides.size()));
  };
  add(drawn.outline);
  for (const Loop& hole : drawn.holes) add(hole);
  std::vector<double> start, center;
  const auto arc = std::make_unique<bool[]>(sides.size());
  for (std::size_t k = 0; k < sides.size(); ++k) {
    const Vec2 c = sides[k].arc ? sides[k].arc->center : Vec2(0, 0);
    start.insert(start.end(), {sides[k].start.x(), sides[k].start.y()});
    center.insert(center.end(), {c.x(), c.y()});
    arc[k] = sides[k].arc.has_value();
  }
  const KerfGmshFace face{std::int64_t(ends.size()), ends.data(), start.data(), arc.get(), center.data()};
  Told told;
  if (!module.step(path.c_str(), &face, keep_error, &told))
    throw Error(Fault::Files, fmt::format("cannot write '{}': gmsh: {}", path.string(), told.error));
}

}  // namespace kerf
