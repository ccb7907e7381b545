// Histories, collections, snapshots and their pictures.

#include "io/history.hpp"
#include "plot/charts.hpp"
#include "plot/page.hpp"

#include "io/files.hpp"
#include "kerf/mesher.hpp"
#include "plot/evolution.hpp"
#include "tests/optimize/damage.hpp"
#include "tests/support/sample.hpp"

#include <cairo.h>

#include <nlohmann/json.hpp>

namespace kerf::history_test {
namespace {

using test::Folder;

OptimizeRequest request() {
  OptimizeRequest r;
  r.volume_at_most = 0.4;
  r.bounds = {{"peak", {}, 3.5}, {"area, too", {}, 2}};
  const auto drawn = [](Drawn::Kind kind, const char* name, int count) {
    Drawn d{.kind = kind, .name = name};
    d.lower = d.upper = d.start = Eigen::VectorXd::Zero(count);
    return d;
  };
  r.design.drawn = {drawn(Drawn::Kind::Circle, "h", 3), drawn(Drawn::Kind::Ellipse, "e", 5),
                    drawn(Drawn::Kind::Crack, "c", 4), drawn(Drawn::Kind::Inclusion, "r", 4)};
  return r;
}

OptimizeResult result() {
  OptimizeResult r;
  r.method = OptimizeMethod::Mma;
  r.iterations = 2;
  r.state_solves = 5;
  r.objective = 70;
  r.volume_fraction = 0.4;
  r.optimality = 0.001;
  r.ending = Ending::Optimal;
  r.stopped = "optimal: KKT residual 0.001";
  r.notes = {"restarted <once>"};
  for (int k = 0; k < 3; ++k) {
    Iteration row{.number = k, .objective = 100.0 / (k + 1), .merit = 100.0 / (k + 1), .volume_fraction = 1 - 0.3 * k};
    row.bounds = {3.0 + k, 1};
    row.step = 0.1;
    row.optimality = std::nan("");
    row.holes = k;
    row.triangles = 1000 + k;
    row.state_solves = 1 + 2 * k;
    row.variables = Eigen::VectorXd::LinSpaced(16, 0, 15);
    r.history.push_back(row);
  }
  r.history[1].note = "the \"line\nsearch\", twice";
  r.variables = r.history.back().variables;
  return r;
}

TEST(History, ColumnsAndRowsAreThoseOfTheInterface) {
  const OptimizeNames names = optimize_names(request());
  EXPECT_EQ(names.variables,
            (std::vector<std::string>{"h.x", "h.y", "h.radius", "e.x", "e.y", "e.a", "e.b", "e.angle", "c.x1", "c.y1",
                                      "c.x2", "c.y2", "r.x", "r.y", "r.radius", "r.young"}));
  const Folder folder;
  const auto path = folder.path / "history.csv";
  OptimizeNames few;
  few.bounds = {"peak", "area, too"};
  few.variables = {"h.x"};
  write_history_csv(path, result().history, few);
  EXPECT_EQ(
      read_file(path),
      "iteration,objective,merit,volume_fraction,violation,step,optimality,holes,triangles,state_solves,accepted,peak,"
      "\"area, too\",h.x,note\n"
      "0,100,100,1,0,0.1,,0,1000,1,1,3,1,0,\n"
      "1,50,50,0.7,0,0.1,,1,1001,3,1,4,1,0,\"the \"\"line search\"\", twice\"\n"
      "2,33.333333333333336,33.333333333333336,0.4,0,0.1,,2,1002,5,1,5,1,0,\n");
  // A row that lacks values keeps its columns.
  EXPECT_EQ(history_line({.number = 3}, few), "3,0,0,0,0,0,0,0,0,0,1,,,,\n");
  EXPECT_EQ(history_line({.number = 3}, {}), "3,0,0,0,0,0,0,0,0,0,1,\n");
}

TEST(History, ACollectionIsXml) {
  const Folder folder;
  const auto path = folder.path / "optimize.pvd";
  write_collection(path, {{0, "design_0000.vtu"}, {7, "a&b.vtu"}});
  EXPECT_EQ(read_file(path),
            "<?xml version=\"1.0\"?>\n"
            "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
            "  <Collection>\n"
            "    <DataSet timestep=\"0\" group=\"\" part=\"0\" file=\"design_0000.vtu\"/>\n"
            "    <DataSet timestep=\"7\" group=\"\" part=\"0\" file=\"a&amp;b.vtu\"/>\n"
            "  </Collection>\n"
            "</VTKFile>\n");
}

TEST(History, GoesToJsonSummaryAndPage) {
  const Folder folder;
  Result r = test::full_result();
  r.optimize = result();
  r.optimize_names = optimize_names(request());
  r.identified = {{.name = "hole 'h'",
                   .truth = "hole 't'",
                   .found = Eigen::Vector3d(1, 2, 0.5),
                   .exact = Eigen::Vector3d(1, 2.25, 0.5),
                   .position_error = 0.25},
                  {.name = "hole 'e'", .truth = "", .found = Eigen::Vector3d(1, 2, 0.5)}};
  write_json(folder.path / "result.json", r);
  const auto json = nlohmann::json::parse(read_file(folder.path / "result.json"))["optimize"];
  EXPECT_EQ(json["method"], "mma");
  EXPECT_EQ(json["iterations"], 2);
  EXPECT_EQ(json["state_solves"], 5);
  EXPECT_EQ(json["objective"], 70);
  EXPECT_EQ(json["volume_fraction"], 0.4);
  EXPECT_EQ(json["feasible"], true);
  EXPECT_EQ(json["stopped"], "optimal: KKT residual 0.001");
  EXPECT_EQ(json["ending"], "optimal");
  EXPECT_EQ(json["converged"], true);
  EXPECT_EQ(json["start"]["objective"], 100);
  EXPECT_EQ(json["bounds"][1]["name"], "area, too");
  EXPECT_EQ(json["bounds"][0]["value"], 5);
  EXPECT_EQ(json["bounds"][0]["at_most"], 3.5);
  EXPECT_EQ(json["variables"].size(), 16u);
  EXPECT_EQ(json["variables"][2]["name"], "h.radius");
  EXPECT_EQ(json["variables"][2]["value"], 2);
  EXPECT_EQ(json["notes"][0], "restarted <once>");
  ASSERT_EQ(json["identified"].size(), 2u);
  EXPECT_EQ(json["identified"][0]["truth"], "hole 't'");
  EXPECT_EQ(json["identified"][0]["exact"][1], 2.25);
  EXPECT_EQ(json["identified"][0]["position_error"], 0.25);
  EXPECT_TRUE(json["identified"][1]["position_error"].is_null());

  const std::string words = summary(r);
  EXPECT_NE(words.find("optimize    mma ended after 2 iterations and 5 state solves: optimal: KKT residual 0.001\n"),
            std::string::npos)
      << words;
  EXPECT_NE(words.find("objective 70 from 100  volume fraction 0.4  optimality 0.001  2 holes"), std::string::npos);
  EXPECT_NE(words.find("peak 5  at most 3.5"), std::string::npos);
  EXPECT_NE(words.find("found       hole 'h': center (1, 2), radius 0.5"), std::string::npos) << words;

  draw(folder.path / "history.png", history_curves(*r.optimize, r.optimize_names, "A title"));
  const std::string html = page(r, {});
  EXPECT_NE(html.find("<h2>Optimization</h2>"), std::string::npos);
  EXPECT_NE(html.find("restarted &lt;once&gt;"), std::string::npos);
  EXPECT_LT(html.find("<h2>Optimization</h2>"), html.find("id=\"history-objective\""));
  EXPECT_LT(html.find("id=\"history-objective\""), html.find("<h2>Mesh</h2>"));

  r.optimize->ending = Ending::Infeasible;
  r.optimize->stopped = "infeasible: peak 5 > 3.5";
  r.status = "infeasible";
  r.reason = "the design violates a constraint: peak 5 > 3.5";
  const std::string said = summary(r);
  EXPECT_NE(said.find("infeasible: peak 5 > 3.5"), std::string::npos);
  EXPECT_EQ(said.find("infeasible"), said.rfind("infeasible")) << "said once";
}

TEST(Snapshots, ThereAreAFewAndTheFirstAndTheLastAreAmongThem) {
  Snapshots s;
  for (int k = 0; k <= 1000; ++k) {
    add(s, {k, 1.0 * k, 0.5, {}});
    ASSERT_LE(s.kept.size(), 32u);
    const std::vector<Snapshot> few = pick(s, 12);
    ASSERT_EQ(few.size(), static_cast<std::size_t>(std::min(k + 1, 12)));
    EXPECT_EQ(few.front().iteration, 0);
    EXPECT_EQ(few.back().iteration, k);
    for (std::size_t i = 1; i < few.size(); ++i) ASSERT_GT(few[i].iteration, few[i - 1].iteration) << k;
  }
  // Evenly: no step is more than twice as long as another, but for the last.
  const std::vector<Snapshot> few = pick(s, 12);
  for (std::size_t i = 1; i < few.size(); ++i) {
    EXPECT_GE(few[i].iteration - few[i - 1].iteration, 64);
    EXPECT_LE(few[i].iteration - few[i - 1].iteration, 128);
  }
  // A resumed run comes back to earlier iterations.
  const std::size_t count = s.kept.size();
  const int again = s.kept[5].iteration;
  add(s, {again, -1, 0, {}});
  EXPECT_EQ(s.last->iteration, 1000);
  EXPECT_EQ(s.kept.size(), count);
  EXPECT_EQ(s.kept[5].iteration, again);
  EXPECT_EQ(s.kept[5].objective, -1);
}

TEST(Snapshots, GoToACheckpointAndBack) {
  Snapshots s;
  for (int k = 0; k < 40; ++k)
    add(s, {k, 1.0 / (k + 1), 0.25, {{{{0, 0}, {1, 0.1 * k}, {0, 1}}, {{0.2, 0.2}}}, {{{0.5, 0.5}, {0.6, 0.7}}}}});
  const Checkpoint c = to_checkpoint(s, "abc");
  EXPECT_EQ(c.fingerprint, "abc");
  const Snapshots back = from_checkpoint(c);
  EXPECT_EQ(back.stride, s.stride);
  ASSERT_EQ(back.kept.size(), s.kept.size());
  ASSERT_TRUE(back.last);
  EXPECT_EQ(back.last->iteration, 39);
  for (std::size_t i = 0; i < s.kept.size(); ++i) {
    EXPECT_EQ(back.kept[i].iteration, s.kept[i].iteration);
    EXPECT_EQ(back.kept[i].objective, s.kept[i].objective);
    EXPECT_EQ(back.kept[i].contours.boundary, s.kept[i].contours.boundary);
    EXPECT_EQ(back.kept[i].contours.cracks, s.kept[i].contours.cracks);
  }
  EXPECT_FALSE(from_checkpoint(to_checkpoint({}, "abc")).last);
}

// Damages with a right checksum: refused as a file, or whole numbers of points and iterations that pictures can take.
TEST(Snapshots, ThatAreDamagedAreRefusedOrGood) {
  Snapshots s;
  for (int k = 0; k < 40; ++k)
    add(s, {k, 1.0 / (k + 1), 0.25, {{{{0, 0}, {1, 0.1 * k}, {0, 1}}, {{0.2, 0.2}}}, {{{0.5, 0.5}, {0.6, 0.7}}}}});
  const Checkpoint whole = to_checkpoint(s, "abc");
  int refused = 0;
  for (unsigned seed = 0; seed < 2000; ++seed) {
    const auto [c, said] = damage::damaged(whole, seed);
    SCOPED_TRACE(said);
    try {
      Snapshots back = from_checkpoint(c);
      for (int k = 0; k < 200; ++k) add(back, {k, 1, 0.25, {}});
      EXPECT_LE(back.kept.size(), 32u);
      for (const Snapshot& shot : back.kept)
        for (const auto& line : shot.contours.boundary)
          for (const Vec2& x : line) EXPECT_TRUE(x.allFinite());
    } catch (const Error& error) {
      EXPECT_EQ(error.fault, Fault::Files);
      ++refused;
    }
  }
  EXPECT_GT(refused, 700);
}

double signed_area(const std::vector<Vec2>& loop) {
  double twice = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) twice += cross(loop[i], loop[(i + 1) % loop.size()]);
  return twice / 2;
}

Mesh cracked_plate() {
  Shape s;
  s.labels = {"all", "hole:h"};
  s.outline = polygon("outline", {{0, 0}, {2, 0}, {2, 1}, {0, 1}}, 0);
  s.holes = {circle("h", {1.5, 0.5}, 0.2, 1)};
  s.cracks = {{"c", {{0.3, 0.3}, {0.7, 0.6}}, {}}};
  return triangulate(s, {.size = 0.1});
}

TEST(Contours, HaveTheBodyToTheirLeft) {
  const Mesh mesh = cracked_plate();
  const Contours c = contours(mesh);
  ASSERT_EQ(c.boundary.size(), 2u);
  double sum = 0, total = 0;
  for (const auto& loop : c.boundary) sum += signed_area(loop);
  for (Index t = 0; t < static_cast<Index>(mesh.triangles.size()); ++t) total += area(mesh, t);
  EXPECT_NEAR(sum, total, 1e-12);
  EXPECT_GT(std::max(signed_area(c.boundary[0]), signed_area(c.boundary[1])), 1.99);
  EXPECT_LT(std::min(signed_area(c.boundary[0]), signed_area(c.boundary[1])), -0.12);
  ASSERT_EQ(c.cracks.size(), 1u);
  EXPECT_NEAR((c.cracks[0].front() - Vec2(0.3, 0.3)).norm(), 0, 1e-12);
  EXPECT_NEAR((c.cracks[0].back() - Vec2(0.7, 0.6)).norm(), 0, 1e-12);
}

struct Pixels {
  int width = 0, height = 0;
  std::vector<std::uint32_t> rgb;
  explicit Pixels(const std::filesystem::path& path) {
    cairo_surface_t* surface = cairo_image_surface_create_from_png(path.c_str());
    width = cairo_image_surface_get_width(surface);
    height = cairo_image_surface_get_height(surface);
    const unsigned char* data = cairo_image_surface_get_data(surface);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        rgb.push_back(
            *reinterpret_cast<const std::uint32_t*>(data + y * cairo_image_surface_get_stride(surface) + 4 * x) &
            0xffffff);
    cairo_surface_destroy(surface);
  }
  double share(std::uint32_t color) const {
    return static_cast<double>(std::count(rgb.begin(), rgb.end(), color)) / static_cast<double>(rgb.size());
  }
};

TEST(Evolution, DrawsMaterialAndCracksOfEverySnapshot) {
  const Folder folder;
  const Contours c = contours(cracked_plate());
  double before = 1;
  for (const int count : {1, 2, 5, 12}) {
    Evolution e{"Title", "words", {}};
    for (int k = 0; k < count; ++k) e.snapshots.push_back({k, 1.5, 0.9, c});
    const auto path = folder.path / "evolution.png";
    draw(path, e);
    const Pixels p(path);
    EXPECT_GT(p.width, 800);
    EXPECT_LE(p.width, 1700);
    EXPECT_LE(p.height, 1700);
    EXPECT_GT(p.share(0x2f3d4c), 0.3) << count;  // material
    EXPECT_LT(p.share(0x2f3d4c), before);
    EXPECT_GT(p.share(0xe0232e), 1e-4) << count;  // crack
  }
  // Nothing to draw, points that are no numbers, a body without height: no trouble.
  draw(folder.path / "a.png", Evolution{});
  draw(folder.path / "b.png",
       Evolution{"", "", {{0, std::nan(""), std::nan(""), {{{{0, 0}, {std::nan(""), 1}}}, {}}}}});
  draw(folder.path / "c.png", Evolution{"", "", {{0, 1, 1, {{{{0, 0}, {1, 0}}}, {}}}}});
  EXPECT_THROW(draw(folder.path / "absent" / "a.png", Evolution{}), Error);
}

TEST(Curves, DrawEveryKindOfHistory) {
  const Folder folder;
  const auto path = folder.path / "history.png";
  OptimizeResult r = result();
  draw(path, history_curves(r, optimize_names(request()), "Title"));
  EXPECT_GT(Pixels(path).share(0x0072b2), 1e-4);
  EXPECT_TRUE(wants_logarithm({1, 31}));
  EXPECT_FALSE(wants_logarithm({1, 29}));
  EXPECT_FALSE(wants_logarithm({0, 1000}));
  // One row, none, gaps, a constant, huge and tiny values.
  r.history.resize(1);
  draw(path, history_curves(r, optimize_names(request()), "Title"));
  r.history.clear();
  draw(path, history_curves(r, {}, ""));
  for (const double value : {0.0, 1e-300, 1e300, std::nan(""), -1.0}) {
    for (int k = 0; k < 5; ++k)
      r.history.push_back({.number = k, .objective = k == 2 ? std::nan("") : value * (1 + k)});
    draw(path, history_curves(r, {}, "Title"));
    EXPECT_GT(Pixels(path).width, 1000);
    r.history.clear();
  }
}

TEST(Picture, DrawsDesignsWithSupportsAndLoads) {
  const Folder folder;
  const auto path = folder.path / "design.png";
  const Mesh mesh = cracked_plate();
  Picture p{.title = "Design"};
  p.points = mesh.points;
  p.triangles = mesh.triangles;
  p.solid = true;
  p.cracks = contours(mesh).cracks;
  p.supports = {{{0, 1}, {0, 0}}};
  p.rollers = {{{0.5, 0}, {1, 0}}};
  p.arrows = {{Vec2(2.3, 0.5), Vec2(2, 0.5)}};
  draw(path, p);
  const Pixels pixels(path);
  EXPECT_GT(pixels.share(0x2f3d4c), 0.3);
  for (const std::uint32_t color : {0xe0232eu, 0x0072b2u, 0xd55e00u}) EXPECT_GT(pixels.share(color), 2e-4) << color;
}

}  // namespace
}  // namespace kerf::history_test
