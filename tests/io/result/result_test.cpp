// result.json against the keys of its interface in their order, and against the bits of the numbers given; what is not
// finite is null.

#include "io/result.hpp"
#include "io/read_result.hpp"

#include "io/files.hpp"
#include "tests/support/sample.hpp"

#include <nlohmann/json.hpp>

namespace kerf::result_test {
namespace {

using Json = nlohmann::ordered_json;
using test::Folder;

std::vector<std::string> keys(const Json& object) {
  std::vector<std::string> out;
  for (const auto& [key, value] : object.items()) out.push_back(key);
  return out;
}

Json written(const Result& result) {
  const Folder folder;
  write_json(folder.path / "result.json", result);
  EXPECT_FALSE(std::filesystem::exists(folder.path / "result.json.part"));
  return Json::parse(read_file(folder.path / "result.json"));
}

using Keys = std::vector<std::string>;

TEST(ResultJson, EverySectionWithItsKeysInTheOrderOfTheInterface) {
  const Json j = written(test::full_result());
  EXPECT_EQ(keys(j), (Keys{"schema", "version", "case", "status", "mesh", "state", "contact", "cracks", "functional",
                           "map", "validate", "time_s", "peak_memory_mb", "title"}));
  EXPECT_EQ(keys(j["mesh"]), (Keys{"triangles", "vertices", "h_min", "h_max", "min_angle_deg", "mean_quality"}));
  EXPECT_EQ(keys(j["state"]),
            (Keys{"element", "unknowns", "condensed_unknowns", "residual", "energy", "compliance", "area",
                  "estimated_error", "energy_bounds", "degree", "work_error", "energy_bounds_of", "notes"}));
  EXPECT_EQ(keys(j["contact"]),
            (Keys{"method", "iterations", "linear_solves", "kkt", "open_length", "closed_length", "biactive_length"}));
  ASSERT_EQ(j["cracks"].size(), 1u);
  EXPECT_EQ(keys(j["cracks"][0]),
            (Keys{"name", "length", "max_opening", "max_pressure", "transitions", "tips", "pressure_peak"}));
  EXPECT_EQ(keys(j["cracks"][0]["transitions"][0]), (Keys{"at", "from", "to"}));
  EXPECT_EQ(keys(j["cracks"][0]["tips"][0]), (Keys{"at", "K_I", "K_II", "G", "T", "spread"}));
  EXPECT_EQ(keys(j["functional"]), (Keys{"kind", "value"}));
  EXPECT_EQ(keys(j["map"]), (Keys{"perturbation", "min", "max", "points", "excluded_radius", "radius", "masked_share",
                                  "biactive_length"}));
  EXPECT_EQ(keys(j["map"]["min"]), (Keys{"at", "value"}));
  EXPECT_EQ(keys(j["map"]["points"][0]),
            (Keys{"at", "value", "lower", "upper", "c2", "valid_radius", "masked", "angle_deg"}));
  ASSERT_EQ(j["validate"].size(), 3u);
  EXPECT_EQ(keys(j["validate"][0]),
            (Keys{"at",           "perturbation", "coefficient", "order", "verdict",     "rows",         "reason",
                  "intercept",    "plateau",      "c2",          "c3",    "c4",          "c2_predicted", "c2_on_mesh",
                  "order_second", "logarithm",    "on_mesh",     "bar",   "independent", "modes"}));
  EXPECT_EQ(keys(j["validate"][0]["rows"][0]),
            (Keys{"radius", "J", "difference", "predicted", "remainder", "order", "same_contact", "predicted_second",
                  "remainder_second", "order_second"}));
  EXPECT_EQ(keys(j["time_s"]),
            (Keys{"mesh", "assemble", "factor", "solve", "contact", "map", "validate", "optimize", "output", "total"}));
}

TEST(ResultJson, ValuesReadBackToTheSameBits) {
  Result r = test::full_result();
  r.state->energy = -0.1 - 1e-17 / 3;
  const Json j = written(r);
  EXPECT_EQ(j["schema"], 1);
  EXPECT_EQ(j["version"], "0.1.0");
  EXPECT_EQ(j["case"], "cracked_plate");
  EXPECT_EQ(j["status"], "ok");
  EXPECT_EQ(j["mesh"]["triangles"], 1200);
  EXPECT_EQ(j["mesh"]["min_angle_deg"], 26.3);
  EXPECT_EQ(j["state"]["residual"].get<double>(), r.state->residual);
  EXPECT_EQ(j["state"]["energy"].get<double>(), r.state->energy);
  EXPECT_EQ(j["state"]["energy_bounds"], Json::parse("[-0.11, -0.09]"));
  EXPECT_EQ(j["state"]["notes"][0], "rigid motion fixed: translation in x");
  EXPECT_EQ(j["contact"]["linear_solves"], 3);
  EXPECT_EQ(j["cracks"][0]["transitions"][0]["at"][0].get<double>(), -1.0 / 3);
  EXPECT_EQ(j["cracks"][0]["transitions"][0]["from"], "closed");
  EXPECT_EQ(j["cracks"][0]["pressure_peak"], Json::parse(R"({"at": [-1.0, 0.0], "value": 0.5, "singular": true,
                            "regular": {"at": [-0.5, 0.0], "value": 0.375}})"));
  EXPECT_TRUE(j["cracks"][0]["tips"][0]["K_I"].is_null());
  EXPECT_TRUE(j["cracks"][0]["tips"][0]["T"].is_null());
  EXPECT_TRUE(j["cracks"][0]["tips"][0]["spread"].is_null());
  EXPECT_EQ(j["cracks"][0]["tips"][1]["K_II"], -0.5);
  EXPECT_EQ(j["cracks"][0]["tips"][1]["T"], -0.75);
  EXPECT_EQ(j["cracks"][0]["tips"][1]["spread"], Json::parse(R"({"K_I": 0.001, "K_II": 0.002, "T": 0.003})"));
  EXPECT_EQ(j["map"]["max"]["at"], Json::parse("[-0.5, 0.75]"));
  EXPECT_EQ(j["map"]["points"][0]["upper"], 0.15);
  EXPECT_TRUE(j["map"]["points"][1]["value"].is_null());
  EXPECT_TRUE(j["map"]["points"][1]["lower"].is_null());
  EXPECT_EQ(j["time_s"]["total"], 0.28);
  EXPECT_EQ(j["peak_memory_mb"], 123.5);
}

TEST(ResultJson, MapAndValidation) {
  Result r = test::full_result();
  Json j = written(r);
  EXPECT_EQ(j["map"]["radius"], 0.0125);
  EXPECT_EQ(j["map"]["masked_share"], 0.25);
  EXPECT_EQ(j["map"]["biactive_length"], 0.01);
  EXPECT_EQ(j["map"]["points"][0]["masked"], true);
  EXPECT_TRUE(j["map"]["points"][0]["angle_deg"].is_null()) << "a hole has none";
  EXPECT_EQ(j["validate"][0]["verdict"], "holds");
  EXPECT_EQ(j["validate"][1]["verdict"], "fails");
  EXPECT_EQ(j["validate"][2]["verdict"], "out of range");
  EXPECT_EQ(j["validate"][0]["c2"], 5.6);
  EXPECT_EQ(j["validate"][0]["c2_predicted"], 5.59);
  EXPECT_EQ(j["validate"][0]["logarithm"], "known");
  EXPECT_EQ(j["validate"][2]["logarithm"], "fitted");
  EXPECT_EQ(j["validate"][0]["rows"][0]["remainder_second"], 1e-5);
  EXPECT_EQ(j["validate"][0]["rows"][1]["radius"], 0.1);
  EXPECT_EQ(j["validate"][0]["rows"][1]["order"], 4);
  EXPECT_TRUE(j["validate"][0]["rows"][2]["order"].is_null());
  EXPECT_EQ(j["validate"][1]["rows"][0]["same_contact"], false);
  EXPECT_TRUE(j["validate"][2]["coefficient"].is_null());
  EXPECT_TRUE(j["validate"][2]["rows"].empty());
  EXPECT_EQ(j["validate"][2]["reason"], "the point lies outside the body");
  r.map->oriented = true;
  j = written(r);
  EXPECT_DOUBLE_EQ(j["map"]["points"][0]["angle_deg"].get<double>(), 45);
  EXPECT_TRUE(j["map"]["points"][1]["angle_deg"].is_null());
}

TEST(ResultJson, TermsOfASum) {
  Result r;
  r.functional = {"energy", -0.5};
  EXPECT_EQ(written(r)["functional"].dump(), R"({"kind":"energy","value":-0.5})");
  r.functional = {"sum", 3, {{"compliance", 0.5, 4}, {"volume", -100, std::nan("")}}};
  EXPECT_EQ(written(r)["functional"].dump(),
            R"({"kind":"sum","value":3.0,"terms":[{"kind":"compliance","factor":0.5,"value":4.0},)"
            R"({"kind":"volume","factor":-100.0,"value":null}]})");
}

TEST(ResultJson, SectionsOfJobsThatDidNotRunAreAbsent) {
  Result r;
  r.version = "0.1.0";
  r.case_name = "c";
  r.triangles = 2;
  EXPECT_EQ(keys(written(r)), (Keys{"schema", "version", "case", "status", "mesh", "time_s", "peak_memory_mb"}));
  r.state = StateResult{};
  r.map = MapResult{};
  r.reason = "the residual is too large";
  r.status = "not converged";
  const Json j = written(r);
  EXPECT_EQ(keys(j), (Keys{"schema", "version", "case", "status", "mesh", "state", "map", "time_s", "peak_memory_mb",
                           "reason"}));
  EXPECT_TRUE(j["state"]["estimated_error"].is_null());
  EXPECT_TRUE(j["state"]["energy_bounds"].is_null());
  EXPECT_FALSE(j["state"].contains("notes"));
  EXPECT_TRUE(j["map"]["points"].is_array());
  EXPECT_TRUE(j["map"]["points"].empty());
  EXPECT_EQ(j["reason"], "the residual is too large");
}

TEST(ResultJson, NotFiniteIsNull) {
  Result r = test::full_result();

  r.state->energy = nan;
  r.state->estimated_error = infinity;
  r.state->energy_bounds = {-infinity, 1};
  r.contact->kkt = -infinity;
  r.cracks[0].tips[1].at = {nan, 0};
  r.cracks[0].tips[1].G = nan;
  r.seconds.total = nan;
  r.peak_memory_mb = infinity;
  const Json j = written(r);
  EXPECT_TRUE(j["state"]["energy"].is_null());
  EXPECT_TRUE(j["state"]["estimated_error"].is_null());
  EXPECT_TRUE(j["state"]["energy_bounds"][0].is_null());
  EXPECT_EQ(j["state"]["energy_bounds"][1], 1);
  EXPECT_TRUE(j["contact"]["kkt"].is_null());
  EXPECT_TRUE(j["cracks"][0]["tips"][1]["at"][0].is_null());
  EXPECT_TRUE(j["cracks"][0]["tips"][1]["G"].is_null());
  EXPECT_TRUE(j["time_s"]["total"].is_null());
  EXPECT_TRUE(j["peak_memory_mb"].is_null());
}

TEST(ResultJson, PartsOfTheStateThatAreNotKnown) {
  Result r = test::full_result();
  r.units = {"mm", "MPa"};
  r.state->von_mises = Peak{{{1, 2}, 3}, true, std::nullopt};
  r.optimize.emplace();
  r.optimize->holes.least = 0.5;
  Json j = written(r);
  EXPECT_TRUE(j["state"]["max_von_mises"]["regular"].is_null());
  EXPECT_EQ(j["units"]["force_per_thickness"], "N/mm");
  EXPECT_FALSE(j["units"].contains("force_of_plate")) << "it has no thickness";
  EXPECT_FALSE(j["state"].contains("plate"));
  EXPECT_FALSE(j["optimize"]["hole_margin"].contains("proof"));
  r.state->thickness = 5;
  j = written(r);
  EXPECT_EQ(j["units"]["force_of_plate"], "N");
  EXPECT_EQ(j["state"]["plate"], Json::parse(R"({"thickness": 5.0, "energy": -0.5, "compliance": 1.0})"))
      << "without a balance there are no resultants";
}

TEST(ResultJson, AnyBytesInNamesAndAnUnwritablePath) {
  Result r;
  r.case_name = "a\"b\\\n\xff";
  EXPECT_EQ(written(r)["case"], "a\"b\\\n\xEF\xBF\xBD");
  const Folder folder;
  EXPECT_THROW(write_json(folder.path / "no" / "result.json", r), Error);
}

/// A design and what was tried on the way to it.
Result searched() {
  Result r = test::full_result();
  OptimizeResult o;
  o.method = OptimizeMethod::Mma;
  o.starts = {{.from = Eigen::Vector2d(0.5, 1),
               .variables = Eigen::Vector2d(0.75, nan),
               .merit = 2,
               .violation = 0.25,
               .in_full = true,
               .state_solves = 7},
              {.from = Eigen::Vector2d(3, 4), .failure = "the hole leaves the body"}};
  r.optimize = o;
  Count count;
  for (const int n : {0, 1, 2}) {
    Counted one{.count = n, .of = {n}, .variables = 3 * n, .criterion = 10.0 - n, .aicc = 9.5 - n};
    one.fit.readings = 20, one.fit.noise = 0.25;
    one.fit.end = 1.0 / (n + 1);
    one.fit.variables = Eigen::VectorXd::Constant(n, 0.5);
    count.tried.push_back(one);
  }
  count.tried[2].criterion = nan;
  count.tried[2].failure = "no room";
  count.chosen = 1;
  count.things = {"hole 'h'"};
  r.counted = count;
  r.solver = SolverResult{4, 2, 31, 1e3, 96, 20, 800, 90, 70};
  return r;
}

TEST(ResultJson, WhatASearchTried) {
  const Json j = written(searched());
  EXPECT_EQ(j["optimize"]["starts"],
            Json::parse(R"([{"from": [0.5, 1.0], "reached": [0.75, null], "merit": 2.0, "violation": 0.25,
                             "state_solves": 7, "in_full": true},
                            {"from": [3.0, 4.0], "reached": [], "merit": null, "violation": null, "state_solves": 0,
                             "in_full": false, "failure": "the hole leaves the body"}])"));
  const Json& defects = j["optimize"]["defects"];
  EXPECT_EQ(defects["count"], 1);
  ASSERT_EQ(defects["tried"].size(), 3u);
  EXPECT_EQ(defects["chosen"], 1);
  EXPECT_EQ(defects["things"], Json::parse(R"(["hole 'h'"])"));
  EXPECT_EQ(defects["tried"][1],
            Json::parse(R"({"count": 1, "of": [1], "unknowns": 3, "criterion": 9.0, "aicc": 8.5, "readings": 20,
                            "noise": 0.25, "estimated": false, "squares": 0.5, "variables": [0.5]})"));
  EXPECT_TRUE(defects["tried"][2]["criterion"].is_null());
  EXPECT_EQ(defects["tried"][2]["failure"], "no room");
  EXPECT_EQ(j["state"]["solver"],
            Json::parse(R"({"backend": "petsc", "parts": 4, "solves": 2, "iterations": 31, "condition": 1000.0,
                            "interface_unknowns": 96, "primal_unknowns": 20, "bytes_per_iteration": 800.0,
                            "peak_memory_mb": [90.0, 70.0]})"));
}

// What readings fix and what they leave open, there and back.
TEST(ResultJson, AFitSaysWhatItsReadingsFix) {
  Result r = test::full_result();
  r.optimize.emplace();
  r.optimize->ending = Ending::Undetermined;
  r.optimize_names.variables = {"h.x", "h.radius"};
  r.optimize->variables = Eigen::Vector2d(0.5, 0.25);
  LeastSquares fit;
  fit.variables = r.optimize->variables;
  fit.covariance = Eigen::Matrix2d{{1e-4, 0}, {0, 4e-4}};
  fit.readings = 4, fit.noise = 0.5, fit.end = 2, fit.finer = 2.5, fit.mesh = 0.25;
  fit.expected = {1, 6}, fit.most = 14;
  fit.combinations = {{Eigen::Vector2d(0.6, 0.8), 0.01, true}, {Eigen::Vector2d(0.8, -0.6)}};
  fit.verdict = FitVerdict::Undetermined;
  r.fit = fit;
  const Folder folder;
  write_json(folder.path / "result.json", r);
  const Json j = written(r)["optimize"];
  EXPECT_EQ(j["ending"], "not enough readings");
  EXPECT_EQ(j["converged"], false);
  EXPECT_EQ(j["least_squares"]["verdict"], "not enough readings");
  EXPECT_EQ(j["least_squares"]["rank"], 1);
  EXPECT_EQ(j["least_squares"]["unknowns"], 2);
  EXPECT_EQ(
      j["least_squares"]["chi_square"],
      Json::parse(R"({"per_reading": 2.0, "expected": [0.25, 1.5], "at_most": 3.5, "finer": 2.5, "mesh": 0.25})"));
  EXPECT_EQ(j["least_squares"]["combinations"],
            Json::parse(R"([{"weights": [0.6, 0.8], "deviation": 0.01, "fixed": true},
                            {"weights": [0.8, -0.6], "deviation": null, "fixed": false}])"));
  EXPECT_TRUE(j["least_squares"]["variables"][0]["deviation"].is_null());
  const Result back = read_result(folder.path);
  EXPECT_EQ(in_words(*back.fit, back.optimize_names.variables), in_words(fit, r.optimize_names.variables));
  EXPECT_EQ(back.optimize->ending, Ending::Undetermined);
}

TEST(ResultJson, TheFinerDesignSaysWhatItsBoundsAreJudgedBy) {
  Result r = test::full_result();
  r.optimize.emplace();
  r.optimize->finer = {.size = 0.1,
                       .element = bdms(2),
                       .bounds = {2, 3, 4},
                       .intervals = {{2, 1.5, 2.5, true, ""}, {nan, nan, nan, false, "no bound: cracks slide"}},
                       .residual = 0.01,
                       .failure = "it cannot be meshed"};
  r.optimize_names.bounds = {"peak", "K", "area"};
  const Json finer = written(r)["optimize"]["finer"];
  EXPECT_EQ(finer["bounds"], Json::parse(R"([{"name": "peak", "value": 2.0, "lower": 1.5, "upper": 2.5,
                                               "guaranteed": true},
                                              {"name": "K", "value": 3.0, "note": "no bound: cracks slide"},
                                              {"name": "area", "value": 4.0}])"));
  EXPECT_EQ(finer["residual"], 0.01);
  EXPECT_EQ(finer["failure"], "it cannot be meshed");
  EXPECT_EQ(finer["degree"], 2);
}

}  // namespace
}  // namespace kerf::result_test
