// Results and histories, read and written again to the same bytes; files that are none, damaged or not ours are refused
// by name.

#include "io/read_result.hpp"

#include "io/arrays.hpp"
#include "io/files.hpp"
#include "io/history.hpp"
#include "tests/support/sample.hpp"

#include <nlohmann/json.hpp>

#include <set>

namespace kerf::read_result_test {
namespace {

using test::Folder;

/// Every section that a result may have.
Result everything() {
  Result r = test::full_result();
  r.units = {"mm", "MPa"};
  r.functional_dimension = dimension::energy;
  r.status = "infeasible";
  r.reason = "the design violates a constraint";
  r.adapt = AdaptResult{{{100, 0.5}, {200, 0.125}}, "reached 0.2", "K_I at the end of crack \"c\""};
  const Bounded some{1, 0.5, 1.5, true, ""}, lost{std::nan(""), std::nan(""), std::nan(""), false, "why, \"so\""};
  r.bounds = BoundsResult{{{"c", true, {1, 2}, some, lost, some}, {"c", false, {3, 4}, lost, some, lost}},
                          {{{5, 6}, some, some, lost, some, lost}}};
  using enum BoundedMean::Of;
  r.bounds->means = {{Disc, {}, {1, 2}, {1, 2}, 0.5, {some, lost, some, some, some, lost}},
                     {Line, {}, {1, 2}, {3, 4}, 0, {some, lost, some}},
                     {.of = Displacement, .on = "to\"p", .quantities = {some, lost}},
                     {.of = Reaction, .on = "left", .quantities = {lost, some}},
                     {.of = Loads, .quantities = {some}}};
  r.seconds.bounds = 0.25;
  r.cracks[0].fluid_pressure = 1.5;
  r.cracks[0].has_gap = true;
  for (CrackRow& row : r.cracks[0].rows) row.fluid_pressure = 0.5 * row.s, row.gap = 1e-3 + row.s;
  StateResult& s = *r.state;
  s.degree = 2;
  s.work_error = 1e-12;
  s.of_polygon = true;
  s.von_mises = Peak{{{1, 2}, 3}, true, PlacedValue{{4, 5}, 6}};
  s.displacement = Peak{{{1, 0}, 0.5}};
  s.loads = {{"top", {1, 2}, 3}};
  s.reactions = {{"bottom", {-1, -2}, -3}};
  s.body = ResultantResult{"", {0, 1}, 2};
  s.balance = ResultantResult{};
  s.thickness = 5;
  r.functional->terms = {{"volume", 2, 3}};
  r.map->points[1].value = std::nan("");
  r.map->oriented = true;
  r.validate->points[2].verdict = Verdict::NothingSaid;
  r.validate->points[0].modes = {{"trace", 1.5}, {"deviator", -0.25}, {"displacement", 0.125}};
  r.solver = SolverResult{.parts = 4,
                          .solves = 3,
                          .iterations = 12,
                          .condition = 2.5,
                          .interface_unknowns = 100,
                          .primal_unknowns = 15,
                          .sent = 1000,
                          .first_mb = 200,
                          .others_mb = 100};
  OptimizeResult o;
  o.method = OptimizeMethod::Mma;
  o.iterations = 1;
  o.ending = Ending::Infeasible;
  o.stopped = "infeasible: peak";
  o.feasible = false;
  o.finer = {.size = 0.1,
             .element = bdms(2),
             .curved = true,
             .objective = 1,
             .volume_fraction = 0.5,
             .bounds = {2},
             .intervals = {{nan, 1.5, 2.5, false, "an estimate"}},
             .violation = 0.01};
  o.holes.least = -0.5;
  o.holes.at = {1, 1};
  o.holes.proof = Verdict::OutOfRange;
  o.nucleated = {{.iteration = 2, .at = {0.5, 0.25}, .radius = 0.1, .T = 3, .c2 = 4, .predicted = 0.1, .actual = 0.11},
                 {.iteration = 4, .at = {1, 0.25}, .note = "it became part of a larger hole"}};
  o.bumps.least = 0.25;
  o.starts = {{.from = Eigen::Vector2d(0.5, 0.25),
               .variables = Eigen::Vector2d(0.75, 0.25),
               .merit = 2,
               .violation = 0.5,
               .in_full = true,
               .state_solves = 7},
              {.from = Eigen::Vector2d(1, 1), .failure = "the holes overlap"}};
  o.notes = {"a note, with \"quotes\""};
  o.variables = Eigen::Vector2d(0.5, 1.0 / 3);
  for (int i = 0; i < 2; ++i)
    o.history.push_back({.number = i,
                         .objective = 10.0 / (3 + i),
                         .merit = 4,
                         .volume_fraction = 0.5,
                         .bounds = {1.0 + i},
                         .violation = 0.1,
                         .step = 0.2,
                         .optimality = std::nan(""),
                         .holes = i,
                         .triangles = 1000,
                         .state_solves = 2,
                         .accepted = i == 0,
                         .note = i ? "refused, \"too far\"" : "",
                         .variables = Eigen::Vector2d(0.5, 0.25)});
  r.optimize = std::move(o);
  r.optimize_names = {{"objective"}, {3.5}, 0.4, {"h.x", "h.y"}};
  LeastSquares fit;
  fit.variables = Eigen::Vector2d(1, 2);
  fit.covariance = Eigen::Matrix2d{{0.25, 0.125}, {0.125, 1}};
  fit.readings = 10;
  fit.start = 2, fit.end = 1, fit.noise = 0.5, fit.steps = 3, fit.state_solves = 4, fit.optimality = 1e-9;
  fit.stopped = "small";
  fit.ellipses = {{"hole 'h'", {1, 2}, {0.5, 0.25}, pi / 4}};
  r.fit = fit;
  r.counted = Count{.chosen = 1};
  r.counted->tried.resize(3);
  for (int i = 0; i < 3; ++i) {
    Counted& c = r.counted->tried[static_cast<std::size_t>(i)];
    c.count = i;
    c.criterion = 100.0 / (i + 1);
    c.fit.end = 3.0 - i;
    c.fit.variables = Eigen::VectorXd::Constant(3 * i, 0.5);
  }
  r.counted->tried[2].failure = "two holes overlap";
  r.identified = {{.name = "hole 'h'",
                   .truth = "hole 't'",
                   .found = Eigen::Vector3d(1, 2, 0.5),
                   .exact = Eigen::Vector3d(1, 2.25, 0.5),
                   .position_error = 0.25,
                   .size_error = 0.125}};
  return r;
}

/// A history of two steps, the second in two parts.
Result history() {
  Result r{.version = "1", .case_name = "steps"};
  for (int i = 0; i < 3; ++i)
    r.steps.push_back({.name = i == 0 ? "up" : "down",
                       .part = i == 2 ? 2 : 1,
                       .parts = i == 0 ? 1 : 2,
                       .values = {{"load", 1.0 - i}},
                       .energy = -1.0 - i,
                       .strain_energy = 1.0 + i,
                       .work = 2.0,
                       .dissipation = 0.5 * i,
                       .imbalance = i == 1 ? nan : 1e-3,
                       .open_length = 0.1,
                       .closed_length = 0.9,
                       .stick_length = 0.3,
                       .slip_length = 0.6,
                       .kkt = 1e-12,
                       .tips = {{"c", {0, 0.5}, 1.5, {}}}});
  return r;
}

void write(const std::filesystem::path& folder, const Result& r) {
  write_json(folder / "result.json", r);
  for (const CrackResult& c : r.cracks) write_crack_csv(folder / ("crack_" + c.name + ".csv"), c);
  if (r.optimize) write_history_csv(folder / "history.csv", r.optimize->history, r.optimize_names);
}

TEST(ReadResult, WhatIsReadIsWrittenToTheSameBytes) {
  for (const Result& r : {everything(), history(), test::full_result(), Result{.version = "1", .case_name = "bare"}}) {
    const Folder folder;
    write(folder.path, r);
    const std::filesystem::path again = folder.path / "again";
    std::filesystem::create_directory(again);
    const Result read = read_result(folder.path);
    write(again, read);
    EXPECT_EQ(read_file(again / "result.json"), read_file(folder.path / "result.json"));
    for (const char* name : {"crack_c.csv", "history.csv"})
      if (std::filesystem::exists(folder.path / name)) {
        EXPECT_EQ(read_file(again / name), read_file(folder.path / name)) << name;
      }
    EXPECT_EQ(read.map.has_value(), r.map.has_value());
  }
  const Folder folder;
  write(folder.path, everything());
  const Result read = read_result(folder.path);
  ASSERT_EQ(read.optimize->history.size(), 2u);
  EXPECT_EQ(read.optimize->history[1].note, "refused, \"too far\"");
  EXPECT_FALSE(read.optimize->history[1].accepted);
  EXPECT_EQ(read.optimize->history[1].bounds, std::vector<double>{2});
  EXPECT_EQ(read.cracks[0].rows.size(), 21u);
  EXPECT_TRUE(read.cracks[0].rows[0].closed);
  EXPECT_FALSE(read.cracks[0].rows[20].closed);
  EXPECT_TRUE(read.cracks[0].has_gap);
  EXPECT_EQ(read.cracks[0].rows[20].fluid_pressure, 1);
  EXPECT_EQ(read.cracks[0].rows[20].gap, 2.001);
  EXPECT_EQ(unit(read.units, per_area(*read.functional_dimension)), "MPa");
}

TEST(ReadResult, WhatIsLeftToGain) {
  Result r = everything();
  r.optimize->method = OptimizeMethod::LevelSet;
  r.optimize->ending = Ending::OptimalWithin;
  r.optimize->gain = {4e-4, {1e-4, {1, 2}, 0.05}, {}};
  const Folder folder;
  write(folder.path, r);
  const std::string json = read_file(folder.path / "result.json");
  EXPECT_NE(json.find("\"optimal within 0.05 %\""), std::string::npos) << json;
  EXPECT_NE(json.find("\"best_hole\""), std::string::npos);
  const std::filesystem::path again = folder.path / "again";
  std::filesystem::create_directory(again);
  const Result read = read_result(folder.path);
  EXPECT_EQ(read.optimize->ending, Ending::OptimalWithin);
  EXPECT_EQ(read.optimize->gain.hole.radius, 0.05);
  EXPECT_TRUE(std::isnan(read.optimize->gain.bump.gain));
  write(again, read);
  EXPECT_EQ(read_file(again / "result.json"), json);
}

TEST(ReadResult, ASolverInSinglePrecision) {
  Result r = everything();
  r.solver = SolverResult{.parts = 1, .solves = 3, .iterations = 5};
  const Folder folder;
  write(folder.path, r);
  const Result read = read_result(folder.path);
  ASSERT_TRUE(read.solver);
  EXPECT_EQ(read.solver->parts, 1);
  EXPECT_EQ(read.solver->iterations, 5);
}

TEST(ReadResult, StepsStandWhereTheyWere) {
  const Folder folder;
  write(folder.path, history());
  const Result read = read_result(folder.path);
  ASSERT_EQ(read.steps.size(), 3u);
  EXPECT_EQ(places_in_history(read.steps), (std::vector{1.0, 1.5, 2.0}));
  EXPECT_EQ(read.steps[2].values[0].first, "load");
  EXPECT_EQ(read.steps[2].values[0].second, -1);
  EXPECT_TRUE(std::isnan(read.steps[1].imbalance));
  EXPECT_EQ(read.steps[1].tips[0].K_I, 1.5);
  EXPECT_FALSE(read.steps[1].tips[0].K_II);
}

TEST(ReadResult, WhatIsNoResultIsNamed) {
  const Folder folder;
  EXPECT_THROW(read_result(folder.path), Error);
  for (const char* text :
       {"", "{", "[]", "{\"map\": {\"perturbation\": 3}}", "{\"state\": 5}", "{\"cracks\": [{\"tips\": [{}]}]}"}) {
    write_file(folder.path / "result.json", text);
    try {
      read_result(folder.path);
      FAIL() << text;
    } catch (const Error& e) {
      EXPECT_EQ(e.fault, Fault::Files);
      EXPECT_NE(std::string(e.what()).find("result.json is damaged"), std::string::npos) << e.what();
    }
  }
  write(folder.path, everything());
  write_file(folder.path / "crack_c.csv", "s,x\n1,2\n");
  EXPECT_THROW(read_result(folder.path), Error);
  write_file(folder.path / "crack_c.csv", "s,x,y,jump_n,jump_t,sigma_n,sigma_t,status\n1,2,three,4,5,6,7,open\n");
  EXPECT_THROW(read_result(folder.path), Error);
}

/// Every value of a whole result in turn is one that it should not be, every list and table is another one.
TEST(ReadResult, NumbersAndListsThatNoResultHas) {
  const Folder folder;
  write(folder.path, everything());
  const auto whole = nlohmann::ordered_json::parse(read_file(folder.path / "result.json"));
  const auto flat = whole.flatten();
  unsigned refused = 0;
  const auto look = [&](const nlohmann::ordered_json::json_pointer& at, const nlohmann::ordered_json& value) {
    auto damaged = whole;
    damaged[at] = value;
    write_file(folder.path / "result.json", damaged.dump());
    SCOPED_TRACE(at.to_string() + " = " + value.dump());
    try {
      read_result(folder.path);
    } catch (const Error& e) {
      EXPECT_EQ(e.fault, Fault::Files) << e.what();
      ++refused;
    } catch (const std::exception& e) {
      ADD_FAILURE() << e.what();
    }
  };
  const auto odd = nlohmann::ordered_json::parse("[1e300, \"a\", 2147483648, [[1]], null]");
  std::set<std::string> parents;
  std::size_t turn = 0;
  for (const auto& [path, value] : flat.items()) {
    const nlohmann::ordered_json::json_pointer at(path);
    look(at, odd[turn++ % odd.size()]);
    if (parents.insert(at.parent_pointer().to_string()).second)
      look(at.parent_pointer(), nlohmann::ordered_json::parse("[1, 2, 3]"));
  }
  EXPECT_GT(refused, flat.size() / 4);
}

// A matrix that is none, and counts beyond all that an int holds.
TEST(ReadResult, MatricesAndCountsAreWhatTheySay) {
  const Folder folder;
  const auto is_refused = [&](const char* text) {
    write_file(folder.path / "result.json", text);
    try {
      read_result(folder.path);
    } catch (const Error& e) {
      return e.fault == Fault::Files && std::string(e.what()).find("result.json is damaged") != std::string::npos;
    }
    return false;
  };
  const std::string fit =
      R"({"optimize": {"least_squares": {"variables": [{"value": 1}, {"value": 2}], "covariance": )";
  EXPECT_FALSE(is_refused((fit + "[[1, 0], [0, 1]]}}}").c_str()));
  for (const char* rows : {"[[1, 0], [0, 1, 7, 7, 7, 7, 7, 7]]", "[[1, 0], []]", "[[], [1, 0]]", "[[1], [2]]"})
    EXPECT_TRUE(is_refused((fit + rows + "}}}").c_str())) << rows;
  EXPECT_FALSE(is_refused(R"({"mesh": {"triangles": 2147483647}})"));
  for (const char* number : {"1e300", "-1e300", "2147483648", "0.5", "1e400"})
    EXPECT_TRUE(is_refused(("{\"mesh\": {\"triangles\": " + std::string(number) + "}}").c_str())) << number;
}

// A name becomes part of the path of a table.
TEST(ReadResult, NamesThatLeadOutOfTheFolderAreRefused) {
  const Folder folder;
  write(folder.path, everything());
  const std::string text = read_file(folder.path / "result.json"), name = "\"name\": \"c\"";
  const std::size_t at = text.find(name, text.find("\"cracks\""));
  ASSERT_NE(at, std::string::npos);
  for (const std::string other : {"x/../../secret", "../c", "/etc/passwd", "a b", "", "c\\u0000", "c\\n"}) {
    std::string damaged = text;
    damaged.replace(at, name.size(), "\"name\": \"" + other + "\"");
    write_file(folder.path / "result.json", damaged);
    try {
      read_result(folder.path);
      ADD_FAILURE() << other;
    } catch (const Error& e) {
      EXPECT_EQ(e.fault, Fault::Files);
      EXPECT_NE(std::string(e.what()).find("result.json is damaged"), std::string::npos) << e.what();
    }
  }
}

/// A history with more in its cells than it should have.
TEST(ReadResult, TablesThatSomebodyElseWrote) {
  const Folder folder;
  write(folder.path, everything());
  std::string table = read_file(folder.path / "history.csv");
  const auto refused = [&](const std::string& text) {
    write_file(folder.path / "history.csv", text);
    try {
      read_result(folder.path);
    } catch (const Error& e) {
      EXPECT_EQ(e.fault, Fault::Files);
      return std::string(e.what()).find("history.csv is damaged") != std::string::npos;
    }
    return false;
  };
  EXPECT_FALSE(refused(table));
  EXPECT_TRUE(refused("")) << "not even a head";
  EXPECT_TRUE(refused(table.substr(0, table.find(',')) + "\n"));
  std::string more = table;
  more.insert(more.find(",note"), ",extra");
  EXPECT_TRUE(refused(more)) << "a cell is missing in the rows";
  EXPECT_TRUE(refused(more.substr(0, more.find('\n') + 1))) << "a column more than bounds and variables";
  // A number of iterations that no int holds is none.
  const std::size_t row = table.find('\n') + 1;
  table.replace(row, table.find(',', row) - row, "1e300");
  EXPECT_FALSE(refused(table));
  EXPECT_EQ(read_result(folder.path).optimize->history[0].number, 0);
  std::filesystem::remove(folder.path / "history.csv");
  EXPECT_TRUE(read_result(folder.path).optimize->history.empty());
}

TEST(History, NamesComeFromTheRequestAndCollectionsListTheirFiles) {
  OptimizeRequest request;
  request.volume_at_most = 0.5;
  request.bounds = {{"peak", {}, 2}, {"K", {}, 3}};
  Drawn hole;
  hole.name = "h";
  hole.lower = hole.upper = hole.start = Eigen::Vector3d(1, 2, 0.5);
  request.design.drawn = {hole};
  const OptimizeNames names = optimize_names(request);
  EXPECT_EQ(names.volume_at_most, 0.5);
  EXPECT_EQ(names.bounds, (std::vector<std::string>{"peak", "K"}));
  EXPECT_EQ(names.at_most, (std::vector<double>{2, 3}));
  EXPECT_EQ(names.variables, (std::vector<std::string>{"h.x", "h.y", "h.radius"}));
  EXPECT_TRUE(history_header(names).ends_with(",accepted,peak,K,h.x,h.y,h.radius,note\n"));
  // What could not be evaluated keeps its columns.
  EXPECT_EQ(history_line({.number = 3, .bounds = {1.5}, .accepted = false, .note = "no \"mesh\"\nfor it"}, names),
            "3,0,0,0,0,0,0,0,0,0,0,1.5,,,,,\"no \"\"mesh\"\" for it\"\n");
  const Folder folder;
  write_collection(folder.path / "optimize.pvd", {{0, "a&b_0.vtu"}, {5, "a&b_5.vtu"}});
  EXPECT_EQ(read_file(folder.path / "optimize.pvd"),
            R"(<?xml version="1.0"?>
<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">
  <Collection>
    <DataSet timestep="0" group="" part="0" file="a&amp;b_0.vtu"/>
    <DataSet timestep="5" group="" part="0" file="a&amp;b_5.vtu"/>
  </Collection>
</VTKFile>
)");
}

TEST(Arrays, ThereAndBack) {
  const Folder folder;
  const auto path = folder.path / "a.bin";
  write_arrays(path,
               std::vector<NamedArray>{{"points", 2, {1, 2, 3, 4.5F}}, {"triangles", 3, {}, {0, 1, 70000}}, {"none"}});
  const std::vector<NamedArray> read = read_arrays(path);
  ASSERT_EQ(read.size(), 3u);
  EXPECT_EQ(read[0].numbers, (std::vector<float>{1, 2, 3, 4.5F}));
  EXPECT_EQ(read[1].indices, (std::vector<std::uint32_t>{0, 1, 70000}));
  EXPECT_EQ(read[1].width, 3u);
  EXPECT_EQ(find_array(read, "points")->rows(), 2u);
  EXPECT_EQ(find_array(read, "nothing"), nullptr);
  EXPECT_TRUE(read_file(path).starts_with("kerf arrays 1\npoints f32 2 2\ntriangles u32 3 1\nnone u32 1 0\n\n"));
}

TEST(Arrays, DamagedFilesAreRefused) {
  const Folder folder;
  const auto path = folder.path / "a.bin";
  for (const char* text :
       {"", "kerf arrays 2\n\n", "kerf arrays 1\n", "kerf arrays 1\na f32 1 4\n\n1234", "kerf arrays 1\na f64 1 0\n\n",
        "kerf arrays 1\na f32 0 0\n\n", "kerf arrays 1\na f32 1 99999999999999\n\n", "kerf arrays 1\n\nmore"}) {
    write_file(path, text);
    EXPECT_THROW(read_arrays(path), Error) << text;
  }
}

}  // namespace
}  // namespace kerf::read_result_test
