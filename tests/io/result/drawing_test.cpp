// Drawings of a design: the DXF read by another program (ezdxf), which must find the areas and lengths of the shape;
// the layers of the SVG.

#include "io/design.hpp"

#include "geometry/arc_chain.hpp"
#include "io/files.hpp"
#include "tests/io/case/case_files.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdio>

namespace kerf::drawing_test {

namespace {

Shape drawn() {
  Shape shape;
  shape.labels = {"l"};
  shape.outline = polygon("outline", {{0, 0}, {3, 0}, {3, 2}, {0, 2}}, 0);
  shape.outline.sides[1].arc = Arc{{3, 1}, Mat2::Identity(), -pi / 2, pi / 2};
  shape.holes.push_back(circle("round", {0.6, 1}, 0.3, 0));
  shape.holes.push_back(ellipse("egg", {1.6, 1}, {0.4, 0.2}, 0.5, 0));
  shape.cracks.push_back({"c", {{2.4, 0.6}, {2.8, 0.7}, {3.0, 1.0}}, std::nullopt});
  shape.cracks.push_back(arc_crack("bow", {3, 1}, 0.5, 1.2, 0.2));
  return shape;
}

/// What a program prints.
std::string output(const std::string& command) {
  std::string text;
  FILE* pipe = popen(command.c_str(), "r");
  char buffer[4096];
  for (std::size_t n; (n = fread(buffer, 1, sizeof buffer, pipe)) > 0;) text.append(buffer, n);
  return pclose(pipe) == 0 ? text : "failed: " + text;
}

}  // namespace

TEST(DesignDrawing, AnotherProgramReadsTheDxfAndFindsTheSameAreas) {
  if (output("/usr/bin/python3 -c 'import ezdxf' 2>&1").starts_with("failed")) GTEST_SKIP() << "no python3-ezdxf";
  const TemporaryFolder folder;
  const Shape shape = drawn();
  const std::vector<Loop> frozen{circle("pad", {0.2, 0.2}, 0.1, none)};
  const std::filesystem::path dxf = folder.write("design.dxf", design_dxf(shape, frozen));
  const std::filesystem::path script = folder.write("read.py", R"(
import ezdxf, math, sys
from ezdxf import recover
doc, auditor = recover.readfile(sys.argv[1])
doc2 = ezdxf.readfile(sys.argv[1])
print("errors", len(auditor.errors), doc2.dxfversion)
for e in doc2.modelspace():
    p = list(e.get_points("xyb")); n = len(p); area = 0; length = 0
    for i in range(n if e.closed else n - 1):
        (x0, y0, b), (x1, y1, _) = p[i], p[(i + 1) % n]; c = math.hypot(x1 - x0, y1 - y0); t = 4 * math.atan(b)
        area += (x0 * y1 - x1 * y0) / 2
        if b: r = c / 2 / math.sin(t / 2); area += r * r * (t - math.sin(t)) / 2; length += abs(r * t)
        else: length += c
    print(e.dxftype(), e.dxf.layer, "%.6f" % (abs(area) if e.closed else length))
)");
  const std::string expected = fmt::format(
      "errors 0 AC1015\nLWPOLYLINE outline {:.6f}\nLWPOLYLINE holes {:.6f}\nLWPOLYLINE holes {:.6f}\n"
      "LWPOLYLINE cracks {:.6f}\nLWPOLYLINE cracks {:.6f}\nLWPOLYLINE frozen {:.6f}\n",
      6 + pi / 2, pi * 0.09, pi * 0.08, std::hypot(0.4, 0.1) + std::hypot(0.2, 0.3), 0.5, pi * 0.01);
  const std::string found = output(fmt::format("/usr/bin/python3 {} {} 2>&1", script.string(), dxf.string()));
  // The ellipse is drawn within 1e-4 of the extent.
  std::istringstream a(expected), b(found);
  for (std::string x, y; a >> x;) {
    ASSERT_TRUE(b >> y) << found;
    char* end = nullptr;
    const double value = std::strtod(x.c_str(), &end);
    if (end == x.c_str() + x.size() && x.find('.') != std::string::npos)
      EXPECT_NEAR(std::strtod(y.c_str(), nullptr), value, 5e-4) << found;
    else
      EXPECT_EQ(x, y) << found;
  }
}

TEST(DesignDrawing, TheSvgHasALayerPerKind) {
  const std::string svg = design_svg(drawn(), {}, "A & B <c>\x01\xff");
  for (const char* part :
       {"<g id=\"outline\"", "<g id=\"holes\"", "<g id=\"cracks\"", "<title>A &amp; B &lt;c&gt; \xEF\xBF\xBD</title>",
        " A 1 1 0 0 1 3 2", " A 0.5 0.5 0 0 0 3.49003328892 1.0993346654"})
    EXPECT_NE(svg.find(part), std::string::npos) << svg;
}

}  // namespace kerf::drawing_test
