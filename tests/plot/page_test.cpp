#include "plot/page.hpp"
#include "io/files.hpp"
#include "io/text.hpp"
#include "tests/support/sample.hpp"

namespace kerf {
namespace {

using test::Folder;

std::string page(const Result& result,
                 const std::vector<std::pair<std::string, std::filesystem::path>>& pictures = {}) {
  const Folder folder;
  write_page(folder.path / "report.html", result, pictures);
  return read_file(folder.path / "report.html");
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(Page, EverySectionOfAFullRun) {
  const std::string html = page(test::full_result());
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
  EXPECT_FALSE(has(html, "nan"));
}

TEST(Page, OnlyWhatRan) {
  Result r;
  r.case_name = "bare";
  const std::string html = page(r);
  for (const char* part : {"<h2>Mesh", "<h2>State", "<h2>Contact", "<h2>Cracks", "Topological", "Validation"}) {
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
  const Folder folder;
  write_file(folder.path / "p.png", "png");
  const std::string html = page(r, {{bad, folder.path / "p.png"}});
  EXPECT_FALSE(has(html, "<script"));
  EXPECT_FALSE(has(html, "alert(\""));
  EXPECT_TRUE(has(html, "&lt;script&gt;alert(&quot;1&quot;)&lt;/script&gt;&amp;&#39;"));
}

TEST(Page, ThePictureOfTheValidationStandsInItsSection) {
  const Folder folder;
  write_file(folder.path / "mesh.png", "mesh");
  write_file(folder.path / "validate.png", "validate");
  const std::string html =
      page(test::full_result(), {{"Validation", folder.path / "validate.png"}, {"Mesh", folder.path / "mesh.png"}});
  const std::size_t mesh = html.find(base64("mesh")), section = html.find("<h2>Validation"),
                    figure = html.find(base64("validate"));
  EXPECT_LT(mesh, section);
  ASSERT_NE(figure, std::string::npos);
  EXPECT_GT(figure, section);
  EXPECT_LT(figure, html.find("<h2>Time"));
}

TEST(Page, AnglesOfTheMap) {
  Result r = test::full_result();
  EXPECT_FALSE(has(page(r), ">angle</th>"));
  r.map->oriented = true;
  EXPECT_TRUE(has(page(r), "<td>45.0°</td>"));
}

TEST(Page, PicturesAreInsideAndNothingIsOutside) {
  const Folder folder;
  const std::string bytes("\x89PNG\0\x01", 6);
  write_file(folder.path / "mesh.png", bytes);
  const std::string html = page(test::full_result(), {{"The mesh", folder.path / "mesh.png"}});
  EXPECT_TRUE(has(html, "src=\"data:image/png;base64," + base64(bytes) + "\""));
  EXPECT_TRUE(has(html, "<figcaption>The mesh</figcaption>"));
  EXPECT_FALSE(has(html, "http:"));
  EXPECT_FALSE(has(html, "https:"));
  EXPECT_FALSE(has(html, "url("));
  EXPECT_FALSE(has(html, "<link"));
  EXPECT_TRUE(has(html, "name=\"viewport\""));
  EXPECT_THROW(page(test::full_result(), {{"gone", folder.path / "gone.png"}}), Error);
}

TEST(Page, TagsAreBalanced) {
  const std::string html = page(test::full_result());
  for (const std::string tag :
       {"main", "table", "tr", "th", "td", "div", "svg", "p", "h1", "h2", "h3", "text", "tspan"}) {
    const auto count = [&](const std::string& part) {
      std::size_t out = 0;
      for (std::size_t at = html.find(part); at != std::string::npos; at = html.find(part, at + 1)) ++out;
      return out;
    };
    EXPECT_EQ(count("<" + tag + ">") + count("<" + tag + " "), count("</" + tag + ">")) << tag;
  }
}

}  // namespace
}  // namespace kerf
