// The page of results against the words it must hold, without markup from names and with balanced tags; thinned meshes
// cover the same body.

#include "plot/page.hpp"

#include "io/text.hpp"
#include "plot/page/script.hpp"
#include "tests/support/sample.hpp"

namespace kerf::page_test {
namespace {

/// A square of two triangles with a map of it.
PageData square() {
  PageData data;
  data.arrays = {{"points", 2, {0, 0, 1, 0, 1, 1, 0, 1}},
                 {"triangles", 3, {}, {0, 1, 2, 0, 2, 3}},
                 {"u", 2, {0, 0, 0.001F, 0, 0.001F, 0.002F, 0, 0}},
                 {"von_mises", 1, {1, 2, 3, 4}},
                 {"map", 1, {-1, 0, 1, 2}},
                 {"near", 1, {}, {1, 1, 2, 0}}};
  data.case_text =
      "# The case of these results, as kerf 0.1.0 read it\n# kerf run a.toml --set a='<b>'\ntitle = \"a < b\"\n";
  return data;
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(Page, EverySectionOfAFullRun) {
  const std::string html = page(test::full_result(), {});
  for (const char* part : {"<h1>Plate with a partly closing crack</h1>",
                           "case cracked_plate",
                           "<h2>Mesh</h2>",
                           "<h2>State</h2>",
                           "<h2>Contact</h2>",
                           "<h2>Cracks</h2>",
                           "Crack c",
                           "K<sub>I</sub>",
                           "1.25",
                           "(−0.333333, 0)",
                           "closed",
                           "Topological derivative: hole",
                           "(0.5, 0.25)",
                           "<svg class=\"bars\"",
                           "opening along c",
                           "pressure along c",
                           "rigid motion fixed",
                           "kerf 0.1.0",
                           "<h2>Validation: hole</h2>",
                           "At (0.5, 0.8) the expansion holds",
                           "<td>out of range</td>",
                           "<td>changed</td>",
                           "<td>masked</td>",
                           "on 25 % of the area",
                           "123.5 MB"}) {
    EXPECT_TRUE(has(html, part)) << part;
  }
  EXPECT_FALSE(has(html, ">nan<"));
}

TEST(Page, AHistoryOfLoadsHasCurvesAndATable) {
  Result r{.case_name = "steps"};
  for (int i = 0; i < 2; ++i)
    r.steps.push_back({.name = i == 0 ? "up" : "<down>",
                       .values = {{"load", 2.0 - i}},
                       .strain_energy = 7.25 - i,
                       .work = 8.5 + i,
                       .dissipation = 0.125 * i,
                       .open_length = 0.75,
                       .tips = {{"c", {0, 0.5}, 1.5 + i, {}}}});
  const std::string html = page(r, {});
  for (const char* part :
       {"<h2>Steps</h2>", "id=\"history-step-energy\"", "id=\"history-step-length\"", "id=\"history-step-K_I\"",
        "<th scope=\"col\">load</th>", "&lt;down&gt;", "\"places\": [1,2]", "[7.25,6.25],[8.5,9.5],[0,0.125]",
        "\"values\": [[1.5,2.5]]", "strain energy"}) {
    EXPECT_TRUE(has(html, part)) << part;
  }
  EXPECT_FALSE(has(html, "<down>"));
  r.steps.pop_back();
  const std::string one = page(r, {});
  EXPECT_TRUE(has(one, "<h2>Steps</h2>"));
  EXPECT_FALSE(has(one, "history-step"));  // one value is no curve
}

TEST(Page, OnlyWhatRan) {
  Result r;
  r.case_name = "bare";
  const std::string html = page(r, {});
  for (const char* part :
       {"<h2>Mesh", "<h2>State", "<h2>Contact", "<h2>Cracks", "<h2>Steps", "Topological", "Validation"}) {
    EXPECT_FALSE(has(html, part)) << part;
  }
  EXPECT_TRUE(has(html, "<h1>bare</h1>"));
}

TEST(Page, NamesCannotBecomeMarkup) {
  Result r = test::full_result();
  const std::string bad = "<script>alert(\"1\")</script>&'";
  r.title = r.case_name = r.status = r.version = bad;
  r.reason = bad;
  r.state->element = bad;
  r.state->notes = {bad};
  r.contact->method = bad;
  r.cracks[0].name = bad;
  r.cracks[0].transitions[0].from = r.cracks[0].transitions[0].to = bad;
  r.functional = {bad, 1};
  r.map->perturbation = bad;
  r.validate->perturbation = r.validate->points[1].reason = r.validate->points[2].reason = bad;
  r.units = {bad, bad};
  const std::string html = page(r, square());
  const std::string own = html.substr(0, html.find(browser_script()));  // what the program says itself does not count
  EXPECT_FALSE(has(own, "<script>alert"));
  EXPECT_FALSE(has(own, "alert(\"1"));
  EXPECT_FALSE(has(own, "<b>'"));
  EXPECT_TRUE(has(own, "&lt;script&gt;alert(&quot;1&quot;)&lt;/script&gt;&amp;&#39;"));
}

TEST(Page, AnglesOfTheMap) {
  Result r = test::full_result();
  EXPECT_FALSE(has(page(r, {}), ">angle</th>"));
  r.map->oriented = true;
  EXPECT_TRUE(has(page(r, {}), "<td>45.0°</td>"));
}

TEST(Page, NothingIsOutside) {
  const std::string html = page(test::full_result(), square());
  for (const char* part : {"http:", "https:", "url(", "src=", "@import", "data:image/png"})
    EXPECT_FALSE(has(html, part)) << part;
  EXPECT_TRUE(has(html, "name=\"viewport\""));
  EXPECT_TRUE(has(html, "uPlot 1.6.32"));
  EXPECT_TRUE(has(html, "The MIT License"));
}

TEST(Page, ArraysAreInside) {
  const std::string html = page(test::full_result(), square());
  EXPECT_TRUE(has(html, "<figure class=\"view\" id=\"stress\">"));
  EXPECT_TRUE(has(html, "<figure class=\"view\" id=\"map\">"));
  const auto element = [](const char* name, const char* type, const std::string& bytes) {
    return std::string("data-array=\"") + name + "\" data-type=\"" + type + "\">" + base64(bytes) + "<";
  };
  EXPECT_TRUE(has(html, element("triangles", "u8", std::string("\0\1\2\0\2\3", 6))));
  const float values[] = {-1, 0, 1, 2};
  EXPECT_TRUE(has(html, element("map", "f32", {reinterpret_cast<const char*>(values), sizeof values})));
  EXPECT_TRUE(has(html, "data-array=\"crack.0\""));
  EXPECT_FALSE(has(page(test::full_result(), {}), "class=\"view\""));
}

TEST(Page, TheCaseAndItsCommandStandAtTheEnd) {
  const std::string html = page(test::full_result(), square());
  EXPECT_TRUE(has(html, "<code>kerf run a.toml --set a=&#39;&lt;b&gt;&#39;</code>"));
  EXPECT_TRUE(has(html, "title = &quot;a &lt; b&quot;\n"));
  EXPECT_GT(html.find("<h2>Case</h2>"), html.find("<h2>Time</h2>"));
}

TEST(Page, AFigureWithFewerTrianglesSaysSo) {
  EXPECT_TRUE(has(page(test::full_result(), square()), "The figures have 2 triangles, the mesh 1200"));
}

TEST(Page, TagsAreBalanced) {
  const std::string all = page(test::full_result(), square()), html = all.substr(0, all.find(browser_script()));
  for (const std::string tag :
       {"main", "header", "ul",  "li",  "details", "summary", "figure", "button", "table", "tr",
        "th",   "td",     "div", "svg", "p",       "h1",      "h2",     "h3",     "text",  "tspan"}) {
    const auto count = [&](const std::string& part) {
      std::size_t out = 0;
      for (std::size_t at = html.find(part); at != std::string::npos; at = html.find(part, at + 1)) ++out;
      return out;
    };
    EXPECT_EQ(count("<" + tag + ">") + count("<" + tag + " "), count("</" + tag + ">")) << tag;
  }
}

/// A square of n x n cells, two triangles each.
std::vector<NamedArray> fine_square(std::uint32_t n) {
  NamedArray points{"points", 2}, triangles{"triangles", 3}, map{"map"}, eta{"error_indicator"}, outline{"outline", 2};
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i) {
      points.numbers.insert(points.numbers.end(), {float(i) / float(n), float(j) / float(n)});
      map.numbers.push_back(float(i) + 2 * float(j));
    }
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i;
      triangles.indices.insert(triangles.indices.end(), {a, a + 1, a + n + 2, a, a + n + 2, a + n + 1});
      eta.numbers.insert(eta.numbers.end(), {float(a), float(a) + 0.5F});
    }
  for (std::uint32_t k = 0; k < n; ++k)
    for (const std::uint32_t from : {k, n * (n + 1) + k})
      outline.indices.insert(outline.indices.end(), {from, from + 1});
  for (std::uint32_t k = 0; k < n; ++k)
    for (const std::uint32_t side : {0U, n})
      outline.indices.insert(outline.indices.end(), {k * (n + 1) + side, (k + 1) * (n + 1) + side});
  return {points, triangles, map, eta, outline};
}

TEST(Thin, FewerTrianglesCoverTheSameBody) {
  std::vector<NamedArray> arrays = fine_square(40);
  thin(arrays, 5000);
  EXPECT_EQ(find_array(arrays, "triangles")->rows(), 3200u) << "nothing to do";
  thin(arrays, 900);
  const NamedArray &points = *find_array(arrays, "points"), &triangles = *find_array(arrays, "triangles"),
                   &map = *find_array(arrays, "map");
  EXPECT_LE(triangles.rows(), 900u);
  EXPECT_GT(triangles.rows(), 600u);
  EXPECT_EQ(map.rows(), points.rows());
  EXPECT_EQ(find_array(arrays, "error_indicator")->rows(), triangles.rows());
  double area = 0;
  for (std::size_t t = 0; t < triangles.rows(); ++t) {
    const auto x = [&](std::size_t k) {
      const std::uint32_t v = triangles.indices[3 * t + k];
      return Vec2(points.numbers[2 * v], points.numbers[2 * v + 1]);
    };
    const double own = 0.5 * cross(x(1) - x(0), x(2) - x(0));
    EXPECT_GT(own, 0) << t;
    area += own;
  }
  EXPECT_NEAR(area, 1, 1e-6);
  for (std::size_t v = 0; v < points.rows(); ++v)  // values go with their places
    EXPECT_NEAR(map.numbers[v], 40 * (points.numbers[2 * v] + 2 * points.numbers[2 * v + 1]), 1e-4);
  const NamedArray& outline = *find_array(arrays, "outline");
  EXPECT_EQ(outline.rows(), 160u);
  double length = 0;
  for (std::size_t e = 0; e < outline.rows(); ++e) {
    const std::uint32_t a = outline.indices[2 * e], b = outline.indices[2 * e + 1];
    length += std::hypot(points.numbers[2 * a] - points.numbers[2 * b],
                         points.numbers[2 * a + 1] - points.numbers[2 * b + 1]);
  }
  EXPECT_NEAR(length, 4, 1e-5);
}

}  // namespace
}  // namespace kerf::page_test
