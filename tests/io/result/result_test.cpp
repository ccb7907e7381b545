#include "io/result.hpp"

#include "io/files.hpp"
#include "tests/support/sample.hpp"

#include <nlohmann/json.hpp>

namespace kerf {
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

TEST(ResultJson, AnyBytesInNamesAndAnUnwritablePath) {
  Result r;
  r.case_name = "a\"b\\\n\xff";
  EXPECT_EQ(written(r)["case"], "a\"b\\\n\xEF\xBF\xBD");
  const Folder folder;
  EXPECT_THROW(write_json(folder.path / "no" / "result.json", r), Error);
}

TEST(Csv, TableWithEmptyCellsAndFullDigits) {
  const Folder folder;
  const auto path = folder.path / "probe.csv";
  write_csv(path, {"x", "y", "a,b"}, {{0, -0.5, 1.0 / 3}, {std::nan(""), 1e-300, 1234567890123456.5}});
  EXPECT_EQ(read_file(path), "x,y,\"a,b\"\n0,-0.5,0.3333333333333333\n,1e-300,1234567890123456.5\n");
  EXPECT_THROW(write_csv(path, {"x"}, {{1, 2}}), std::invalid_argument);
}

TEST(Csv, CrackColumnsAndStatusWords) {
  const Folder folder;
  CrackResult crack;
  crack.rows = {{0, {-1, 0}, 0, 0.25, -2, 0.125, true}, {0.5, {-0.5, 0}, 0.1, 0, std::nan(""), 0, false}};
  write_crack_csv(folder.path / "crack_c.csv", crack);
  EXPECT_EQ(read_file(folder.path / "crack_c.csv"),
            "s,x,y,jump_n,jump_t,sigma_n,sigma_t,status\n0,-1,0,0,0.25,-2,0.125,closed\n0.5,-0.5,0,0.1,0,,0,open\n");
}

}  // namespace
}  // namespace kerf
