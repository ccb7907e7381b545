// What [output] leaves out of a state is not computed, and what remains is the same to the last bit.

#include "app/run.hpp"
#include "tests/support/folder.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

namespace kerf::asked_test {
namespace {

class Asked : public test::InFolder {
 protected:
  /// A plate with a crack that partly closes.
  nlohmann::json found(const std::string& output, const std::string& job = {}) const {
    std::ofstream(folder / "a.toml") << R"([domain]
outline = [[-1, -1], [1, -1], [1, 1], [-1, 1]]
sides = ["bottom", "right", "top", "left"]
[[crack]]
name = "c"
path = [[-0.5, 0], [0.5, 0]]
[material]
young = 1
poisson = 0.3
[[boundary]]
on = "top"
traction = ["0", "x + 0.3"]
[[boundary]]
on = "bottom"
displacement = [0, 0]
[mesh]
size = 0.2
[functional]
kind = "compliance"
)" << job << "[output]\nvtk = false\npng = false\nhtml = false\n"
                                     << output;
    run(read_case(folder / "a.toml", {}), job.empty() ? Job::Solve : Job::Map, {.folder = folder / "out"});
    return nlohmann::json::parse(std::ifstream(folder / "out/result.json"));
  }
};

TEST_F(Asked, AllThereIsUnlessLeftOut) {
  const nlohmann::json r = found("");
  EXPECT_TRUE(r["state"]["estimated_error"].is_number());
  EXPECT_EQ(r["state"]["energy_bounds"].size(), 2u);
  EXPECT_TRUE(r["state"].contains("max_von_mises") && r["state"].contains("max_displacement"));
  EXPECT_EQ(r["cracks"][0]["tips"].size(), 2u);
  double sum = 0;
  for (const auto& [phase, seconds] : r["time_s"].items())
    if (phase != "total") sum += seconds.get<double>();
  for (const char* phase : {"estimate", "energy_bounds", "tips", "recover"})
    EXPECT_GT(r["time_s"][phase].get<double>(), 0) << phase;
  EXPECT_LE(sum, r["time_s"]["total"].get<double>() * (1 + 1e-12));
}

TEST_F(Asked, EachIsLeftOutAlone) {
  const nlohmann::json all = found("");
  struct Switch {
    const char* key;
    nlohmann::json::json_pointer place;
    nlohmann::json instead;
  };
  using Pointer = nlohmann::json::json_pointer;
  for (const Switch& s : {Switch{"estimate", Pointer("/state/estimated_error"), nullptr},
                          Switch{"energy_bounds", Pointer("/state/energy_bounds"), nullptr},
                          Switch{"tips", Pointer("/cracks/0/tips"), nlohmann::json::array()}}) {
    nlohmann::json r = found(std::string(s.key) + " = false\n");
    EXPECT_EQ(r["status"], "ok");
    EXPECT_EQ(r.at(s.place), s.instead) << s.key;
    EXPECT_FALSE(r["time_s"].contains(s.key));
    r[s.place] = all.at(s.place);
    if (std::string(s.key) == "energy_bounds") r["state"]["energy_bounds_of"] = all["state"]["energy_bounds_of"];
    for (const char* section : {"state", "contact", "cracks"}) EXPECT_EQ(r[section], all[section]) << s.key;
  }
}

TEST_F(Asked, AMapNeedsNoneOfIt) {
  const std::string map = "[map]\nperturbation = \"hole\"\n";
  const nlohmann::json all = found("", map),
                       bare = found("estimate = false\nenergy_bounds = false\ntips = false\npeaks = false\n", map);
  EXPECT_EQ(bare["map"], all["map"]);
  EXPECT_EQ(bare["functional"], all["functional"]);
  EXPECT_EQ(bare["state"]["energy"], all["state"]["energy"]);
  EXPECT_EQ(bare["state"]["residual"], all["state"]["residual"]);
  EXPECT_FALSE(bare["state"].contains("max_von_mises"));
  EXPECT_EQ(bare["cracks"][0]["max_opening"], all["cracks"][0]["max_opening"]);
}

TEST_F(Asked, RefinementNeedsTheEstimate) {
  std::ofstream(folder / "b.toml") << R"([domain]
outline = [[0, 0], [1, 0], [1, 1], [0, 1]]
sides = ["bottom", "right", "top", "left"]
[material]
young = 1
poisson = 0.3
[[boundary]]
on = "bottom"
displacement = [0, 0]
[[boundary]]
on = "top"
traction = [0, 1]
[mesh]
adapt = { error = 0.1 }
[output]
estimate = false
)";
  try {
    read_case(folder / "b.toml", {});
    FAIL() << "was read";
  } catch (const Error& e) {
    EXPECT_EQ(e.fault, Fault::Usage);
    EXPECT_NE(std::string(e.what()).find("b.toml:16:"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("mesh.adapt"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace kerf::asked_test
