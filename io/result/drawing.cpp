// Drawings of a design for other programs: SVG and DXF, with layers outline, holes, cracks and frozen. Every curve is
// written as lines and circular arcs (circular(), 1e-4 of the extent). An arc from corner k to the next is given by its
// bulge b = tan(turn / 4), positive counter-clockwise, the form of DXF; SVG takes
//   radius = |chord| / (2 sin(turn / 2)),  large arc where |turn| > pi,  sweep by the sign of b.
// A full circle becomes two halves, since b has no value at a full turn. y points up in DXF and down in SVG, which a
// transform of the whole picture mends. DXF is version AC1015 with the tables, blocks and handles that readers of that
// version insist on; lengths have no unit there.

#include "geometry/arc_chain.hpp"
#include "geometry/plane.hpp"
#include "io/design.hpp"
#include "io/text.hpp"

#include <fmt/format.h>

#include <cmath>

namespace kerf {

namespace {

/// A path of straight lines and circular arcs: corner k, and the tangent of a quarter of the turn to the next one,
/// positive when counter-clockwise.
struct Path {
  std::vector<Vec2> points;
  std::vector<double> bulge;
  bool closed = true;
};

double bulge_of(const std::optional<Arc>& arc, double part = 1) {
  return arc ? (determinant(*arc) < 0 ? -1 : 1) * std::tan(part * (arc->to - arc->from) / 4) : 0;
}

Path path_of(const Loop& loop) {
  Path path;
  if (loop.sides.size() == 1 && loop.sides.front().arc) {
    const Arc& arc = *loop.sides.front().arc;
    path.points = {loop.sides.front().start, at(arc, (arc.from + arc.to) / 2)};
    path.bulge.assign(2, bulge_of(arc, 0.5));
    return path;
  }
  for (const Side& side : loop.sides) {
    path.points.push_back(side.start);
    path.bulge.push_back(bulge_of(side.arc));
  }
  return path;
}

Path path_of(const Crack& crack) {
  Path path{crack.points, std::vector<double>(crack.points.size(), 0), false};
  if (!crack.arc) return path;
  const Arc& arc = *crack.arc;
  const int n = 1 + int(std::abs(arc.to - arc.from) / pi);
  path.points = points_on(arc, n);
  path.bulge.assign(path.points.size(), bulge_of(arc, 1.0 / n));
  return path;
}

struct Layer {
  std::string_view name;
  int color;  // of AutoCAD
  std::string_view stroke;
  std::vector<Path> paths;
};

std::vector<Layer> layers_of(const Shape& given, std::span<const Loop> frozen) {
  const double tolerance = 1e-4 * extent(given);
  const Shape shape = circular(given, tolerance, true);
  std::vector<Layer> layers{{"outline", 7, "black", {}},
                            {"holes", 5, "#0040c0", {}},
                            {"cracks", 1, "#c00000", {}},
                            {"frozen", 8, "#808080", {}}};
  layers[0].paths.push_back(path_of(shape.outline));
  for (const Loop& hole : shape.holes) layers[1].paths.push_back(path_of(hole));
  for (const Crack& crack : shape.cracks) layers[2].paths.push_back(path_of(crack));
  Shape masks;
  masks.holes.assign(frozen.begin(), frozen.end());
  for (const Loop& loop : circular(masks, tolerance, true).holes) layers[3].paths.push_back(path_of(loop));
  return layers;
}

std::string svg_path(const Path& path) {
  const std::size_t n = path.points.size();
  std::string d = fmt::format("M {:.12g} {:.12g}", path.points[0].x(), path.points[0].y());
  for (std::size_t i = 0; i + (path.closed ? 0 : 1) < n; ++i) {
    const Vec2 &a = path.points[i], &b = path.points[(i + 1) % n];
    const double bulge = path.bulge[i];
    if (bulge == 0) {
      d += fmt::format(" L {:.12g} {:.12g}", b.x(), b.y());
      continue;
    }
    const double quarter = std::atan(std::abs(bulge)), radius = (b - a).norm() / (2 * std::sin(2 * quarter));
    d += fmt::format(" A {:.12g} {:.12g} 0 {} {} {:.12g} {:.12g}", radius, radius, 4 * quarter > pi + 1e-9 ? 1 : 0,
                     bulge > 0 ? 1 : 0, b.x(), b.y());
  }
  return d + (path.closed ? " Z" : "");
}

/// Group code and value of DXF.
class Dxf {
 public:
  Dxf& add(int code, std::string_view value) {
    out_ += fmt::format("{:3}\n{}\n", code, value);
    return *this;
  }
  Dxf& add(int code, double value) {
    return add(code, fmt::format("{:.17g}", value));
  }
  Dxf& number(int code, int value) {
    return add(code, fmt::format("{}", value));
  }
  /// A handle of its own.
  std::string handle(int code = 5) {
    const std::string text = fmt::format("{:X}", next_++);
    add(code, text);
    return text;
  }
  std::string take() {
    return std::move(out_);
  }

 private:
  std::string out_;
  int next_ = 0x10;
};

void begin_table(Dxf& f, std::string_view name, int entries) {
  f.add(0, "TABLE").add(2, name);
  f.handle();
  f.add(330, "0").add(100, "AcDbSymbolTable").number(70, entries);
}

void begin_entry(Dxf& f, std::string_view kind, std::string_view type, std::string_view name) {
  f.add(0, kind);
  f.handle(kind == "DIMSTYLE" ? 105 : 5);
  f.add(100, "AcDbSymbolTableRecord").add(100, type).add(2, name);
}

void end_table(Dxf& f) {
  f.add(0, "ENDTAB");
}

/// Those that readers of AC1015 expect; returns the handles of the two blocks.
std::array<std::string, 2> add_tables(Dxf& f, const std::vector<Layer>& layers) {
  f.add(0, "SECTION").add(2, "TABLES");
  begin_table(f, "VPORT", 0);
  end_table(f);
  begin_table(f, "LTYPE", 3);
  for (const std::string_view name : {"ByBlock", "ByLayer", "Continuous"}) {
    begin_entry(f, "LTYPE", "AcDbLinetypeTableRecord", name);
    f.number(70, 0).add(3, "").number(72, 65).number(73, 0).add(40, 0.0);
  }
  end_table(f);
  begin_table(f, "LAYER", int(layers.size()) + 1);
  begin_entry(f, "LAYER", "AcDbLayerTableRecord", "0");
  f.number(70, 0).number(62, 7).add(6, "Continuous");
  for (const Layer& layer : layers) {
    begin_entry(f, "LAYER", "AcDbLayerTableRecord", layer.name);
    f.number(70, 0).number(62, layer.color).add(6, "Continuous");
  }
  end_table(f);
  begin_table(f, "STYLE", 1);
  begin_entry(f, "STYLE", "AcDbTextStyleTableRecord", "Standard");
  f.number(70, 0).add(40, 0.0).add(41, 1.0).add(50, 0.0).number(71, 0).add(42, 2.5).add(3, "txt").add(4, "");
  end_table(f);
  for (const std::string_view name : {"VIEW", "UCS"}) {
    begin_table(f, name, 0);
    end_table(f);
  }
  begin_table(f, "APPID", 1);
  begin_entry(f, "APPID", "AcDbRegAppTableRecord", "ACAD");
  f.number(70, 0);
  end_table(f);
  begin_table(f, "DIMSTYLE", 1);
  f.add(100, "AcDbDimStyleTable");
  begin_entry(f, "DIMSTYLE", "AcDbDimStyleTableRecord", "Standard");
  f.number(70, 0);
  end_table(f);
  begin_table(f, "BLOCK_RECORD", 2);
  std::array<std::string, 2> owners;
  for (const std::size_t k : {0u, 1u}) {
    f.add(0, "BLOCK_RECORD");
    owners[k] = f.handle();
    f.add(100, "AcDbSymbolTableRecord").add(100, "AcDbBlockTableRecord");
    f.add(2, k == 0 ? "*Model_Space" : "*Paper_Space");
  }
  end_table(f);
  f.add(0, "ENDSEC");
  return owners;
}

void add_blocks(Dxf& f, const std::array<std::string, 2>& owners) {
  f.add(0, "SECTION").add(2, "BLOCKS");
  for (const std::size_t k : {0u, 1u}) {
    const std::string_view name = k == 0 ? "*Model_Space" : "*Paper_Space";
    f.add(0, "BLOCK");
    f.handle();
    f.add(330, owners[k]).add(100, "AcDbEntity").add(8, "0").add(100, "AcDbBlockBegin").add(2, name).number(70, 0);
    f.add(10, 0.0).add(20, 0.0).add(30, 0.0).add(3, name).add(1, "");
    f.add(0, "ENDBLK");
    f.handle();
    f.add(330, owners[k]).add(100, "AcDbEntity").add(8, "0").add(100, "AcDbBlockEnd");
  }
  f.add(0, "ENDSEC");
}

void add_path(Dxf& f, const Path& path, std::string_view layer, const std::string& owner) {
  f.add(0, "LWPOLYLINE");
  f.handle();
  f.add(330, owner).add(100, "AcDbEntity").add(8, layer).add(100, "AcDbPolyline");
  f.number(90, int(path.points.size())).number(70, path.closed ? 1 : 0);
  for (std::size_t i = 0; i < path.points.size(); ++i) {
    f.add(10, path.points[i].x()).add(20, path.points[i].y());
    if (path.bulge[i] != 0 && (path.closed || i + 1 < path.points.size())) f.add(42, path.bulge[i]);
  }
}

}  // namespace

std::string design_svg(const Shape& shape, std::span<const Loop> frozen, const std::string& title) {
  const std::vector<Layer> layers = layers_of(shape, frozen);
  Vec2 low = Vec2::Constant(infinity), high = -low;
  for (const Vec2& x : flatten(shape.outline, 1e-3 * extent(shape), infinity).points)
    low = low.cwiseMin(x), high = high.cwiseMax(x);
  const double margin = 0.02 * (high - low).maxCoeff();
  const Vec2 size = high - low + Vec2::Constant(2 * margin);
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"{:.9g} {:.9g} {:.9g} {:.9g}\" width=\"{:.0f}\">\n"
      "<title>{}</title>\n<g transform=\"scale(1,-1)\" stroke-width=\"{:.3g}\" stroke-linejoin=\"round\">\n",
      low.x() - margin, -high.y() - margin, size.x(), size.y(), 1000.0, escape_html(title), 0.1 * margin);
  // The body with its holes cut out, then lines.
  std::string body = svg_path(layers[0].paths.front());
  for (const Path& hole : layers[1].paths) body.append(" ").append(svg_path(hole));
  out += fmt::format("<path id=\"body\" d=\"{}\" fill=\"#d0d8e0\" fill-rule=\"evenodd\" stroke=\"none\"/>\n", body);
  for (const Layer& layer : layers) {
    out += fmt::format("<g id=\"{}\" fill=\"none\" stroke=\"{}\">\n", layer.name, layer.stroke);
    for (const Path& path : layer.paths) out += fmt::format("<path d=\"{}\"/>\n", svg_path(path));
    out += "</g>\n";
  }
  return out + "</g>\n</svg>\n";
}

std::string design_dxf(const Shape& shape, std::span<const Loop> frozen) {
  const std::vector<Layer> layers = layers_of(shape, frozen);
  Dxf f;
  f.add(0, "SECTION").add(2, "HEADER");
  f.add(9, "$ACADVER").add(1, "AC1015").add(9, "$HANDSEED").add(5, "FFFFF").add(9, "$INSUNITS").number(70, 0);
  f.add(0, "ENDSEC");
  const std::array<std::string, 2> owners = add_tables(f, layers);
  add_blocks(f, owners);
  f.add(0, "SECTION").add(2, "ENTITIES");
  for (const Layer& layer : layers)
    for (const Path& path : layer.paths) add_path(f, path, layer.name, owners[0]);
  f.add(0, "ENDSEC").add(0, "SECTION").add(2, "OBJECTS").add(0, "DICTIONARY").add(5, "C").add(330, "0");
  f.add(100, "AcDbDictionary").number(281, 1).add(3, "ACAD_GROUP").add(350, "D");
  f.add(0, "DICTIONARY").add(5, "D").add(330, "C").add(100, "AcDbDictionary").number(281, 1);
  return f.add(0, "ENDSEC").add(0, "EOF").take();
}

}  // namespace kerf
