// Data too narrow for the points of any rule, in every place where data enter: what is guaranteed contains the truth,
// which is known by statics or by reciprocity with a uniform stress, or nothing is guaranteed and a note says why.

#include "app/run.hpp"
#include "kerf/types.hpp"
#include "tests/support/folder.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

namespace kerf::spikes_test {
namespace {

constexpr double nu = 0.3;

/// exp(-s^2) or s exp(-s^2) of s = (coordinate - at)/width, with the integral 1 or 0.
std::string spike(const std::string& coordinate, double at, double width, bool even, double area) {
  const std::string s = fmt::format("(({} - {:.17g})/{:.17g})", coordinate, at, width);
  return fmt::format("{:.17g}*{}exp(-{}^2)", area / (width * std::sqrt(pi)), even ? "" : s + "*", s);
}

/// The plate [0, 2] x [0, 1] with rollers on the left and below; in the tables what acts on it.
std::string plate(const std::string& tables, const std::string& left = "0") {
  return fmt::format(R"([domain]
outline = [[0, 0], [2, 0], [2, 1], [0, 1]]
sides = ["below", "right", "above", "left"]
[material]
young = 1
poisson = {}
state = "plane stress"
[[boundary]]
on = "left"
displacement_x = "{}"
[[boundary]]
on = "below"
displacement_y = 0
{}
[mesh]
size = 0.3
[bounds]
reactions = "left"
displacements = "right"
[output]
vtk = false
png = false
html = false
peaks = false
)",
                     nu, left, tables);
}

struct Interval {
  double lower, upper;
  bool guaranteed;
};

class Spikes : public test::InFolder {
 protected:
  nlohmann::json result_of(const std::string& text) const {
    std::ofstream(folder / "a.toml") << text;
    run(read_case(folder / "a.toml", {}), Job::Solve, {.folder = folder / "out"});
    return nlohmann::json::parse(std::ifstream(folder / "out/result.json"));
  }
  static Interval interval(const nlohmann::json& b) {
    if (!b.contains("lower") || b["lower"].is_null()) return {nan, nan, false};
    return {b["lower"], b["upper"], b["guaranteed"]};
  }
  static Interval force(const nlohmann::json& r) {
    return interval(r["bounds"]["reactions"][0]["force_x"]);
  }
  static Interval displacement(const nlohmann::json& r) {
    return interval(r["bounds"]["displacements"][0]["u_x"]);
  }
  /// `within`: what the truth itself may be off by.
  void expect(const nlohmann::json& r, const Interval& b, double truth, const std::string& what, double within = 1e-9) {
    ++tried;
    if (!b.guaranteed) {
      ++withdrawn;
      EXPECT_NE(r.dump().find("note"), std::string::npos) << what;
      return;
    }
    EXPECT_LE(b.lower, truth + within) << what;
    EXPECT_GE(b.upper, truth - within) << what;
  }
  /// Every datum with spikes of this width, at places drawn at random.
  void walk(double width, std::mt19937& random) {
    std::uniform_real_distribution<double> in(0.1, 0.9);
    for (const bool even : {true, false}) {
      const auto name = [&](const char* datum) {
        return fmt::format("{} {} {:g}", datum, even ? "even" : "odd", width);
      };
      const double area = even ? 1 : 0;
      {
        const nlohmann::json r = result_of(plate(fmt::format("[[boundary]]\non = \"right\"\ntraction = [\"{}\", 0]",
                                                             spike("y", in(random), width, even, 1))));
        expect(r, force(r), -area, name("traction"));
      }
      {
        const nlohmann::json r = result_of(plate(
            fmt::format("[[boundary]]\non = \"right\"\npressure = \"{}\"", spike("y", in(random), width, even, 1))));
        expect(r, force(r), area, name("pressure"));
      }
      {
        const std::string across = spike("y", in(random), width, true, 1),
                          along = spike("x", 2 * in(random), width, even, 1);
        const nlohmann::json r = result_of(plate(fmt::format("[body]\nforce = [\"{}*{}\", 0]", along, across)));
        expect(r, force(r), -area, name("body force"));
      }
      {
        const std::string across = spike("y", in(random), width, true, 1),
                          along = spike("x", 2 * in(random), width, even, 1);
        std::string text = plate("");
        text.insert(text.find("[[boundary]]"), fmt::format("eigenstrain = [\"{}*{}\", 0, 0]\n", along, across));
        const nlohmann::json r = result_of(text);
        expect(r, displacement(r), area, name("eigenstrain"));
        expect(r, force(r), 0, name("reaction to eigenstrain"));
      }
      {
        const nlohmann::json r = result_of(plate("", spike("y", in(random), width, even, 1)));
        expect(r, displacement(r), area, name("prescribed displacement"));
        expect(r, force(r), 0, name("reaction to displacement"));
      }
      const double place = in(random);
      crack(even, width, 0.5 * place - 0.25, name("crack pressure"));
    }
  }
  /// In a body 32 times as long as the crack: K_I = int p sqrt((a + x)/(a - x)) dx/sqrt(pi a).
  void crack(bool even, double width, double at, const std::string& what) {
    constexpr double a = 0.5, box = 16;
    const std::string text = fmt::format(R"([domain]
outline = [[-{0}, -{0}], [{0}, -{0}], [{0}, {0}], [-{0}, {0}]]
sides = ["below", "right", "above", "left"]
[[crack]]
name = "c"
path = [[-{1}, 0], [{1}, 0]]
contact = "open"
pressure = "{2}"
[material]
young = 1000
poisson = 0.3
[mesh]
size = 4
crack_tip_size = 0.02
[bounds]
tips = true
[output]
vtk = false
png = false
html = false
peaks = false
)",
                                         box, a, spike("x", at, width, even, 1));
    const nlohmann::json r = result_of(text);
    const auto weight = [&](double x) { return std::sqrt((a + x) / (a - x)) / std::sqrt(pi * a); };
    // int s exp(-s^2) s ds = sqrt(pi)/2: what an odd spike has to first order in its width.
    const double slope = (weight(at + 1e-5) - weight(at - 1e-5)) / 2e-5, K = even ? weight(at) : 0.5 * width * slope;
    expect(r, interval(r["bounds"]["tips"][1]["K_I"]), K, what, 0.01 * weight(at) + width * width * 100);
  }

  int tried = 0, withdrawn = 0;
};

TEST_F(Spikes, NothingFalseIsGuaranteed) {
  std::mt19937 random(20261128);
  for (const double width : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) walk(width, random);
  RecordProperty("tried", tried);
  RecordProperty("withdrawn", withdrawn);
  EXPECT_LE(withdrawn, tried / 4);  // prescribed displacements that jump have no bounds
}

TEST_F(Spikes, ANarrowPressureInACrackIsSeenByItsBounds) {
  crack(true, 1e-3, -0.1, "crack pressure");
  EXPECT_EQ(withdrawn, 0);
}

// Under unit tension u = (x, -nu y) and the von Mises stress is 1.
TEST_F(Spikes, FunctionalsSeeTheirWeightsOrSaySo) {
  std::mt19937 random(20261129);
  std::uniform_real_distribution<double> in(0.1, 0.9);
  int silent = 0;
  for (const double width : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
    const double x = 2 * in(random), y = in(random), u_y = nu * nu * (y * y + 0.5 * width * width),
                 u_x = x * x + 0.5 * width * width;
    const std::string across = spike("y", y, width, true, 1), point = across + "*" + spike("x", x, width, true, 1);
    const auto see = [&](const std::string& functional, const std::string& weight, double truth) {
      const nlohmann::json r =
          result_of(plate(fmt::format("[[boundary]]\non = \"right\"\ntraction = [1, 0]\n[functional]\n{}\nweight = "
                                      "\"{}\"\n",
                                      functional, weight)));
      const double off = std::abs(r["functional"]["value"].get<double>() / truth - 1);
      constexpr double much = 0.01;
      const bool noted = r.dump().find("varies too quickly") != std::string::npos;
      EXPECT_TRUE(off < much || noted) << functional << " " << width << " " << r["functional"];
      if (!noted) ++silent;
    };
    see("kind = \"displacement\"\non = \"right\"\ndirection = [1, 0]", across, 2);
    see("kind = \"boundary_tracking\"\non = \"right\"\ntarget = [0, 0]", across, 0.5 * (4 + u_y));
    see("kind = \"displacement_tracking\"\ntarget = [0, 0]", point, 0.5 * (u_x + u_y));
    see("kind = \"displacement_tracking\"\ntarget = [0, 0]", across, 0.5 * (8 / 3.0 + 2 * u_y));
    see("kind = \"stress_power\"\np = 2", point, 1);
    see("kind = \"stress_pnorm\"\np = 3", point, 1);
  }
  EXPECT_GE(silent, 10);  // along edges all is seen
}

TEST_F(Spikes, ForcesInASmallDiscAreSeenByStatics) {
  const nlohmann::json r =
      result_of(plate("[body]\nforce = [\"(x - 1.55)^2 + (y - 0.45)^2 < 0.0009 ? -2000 : 1000*(y - 0.5)\", 0]"));
  const Interval b = force(r);
  EXPECT_TRUE(b.guaranteed);
  const double inside = 2000 + 1000 * (0.45 - 0.5);  // the linear force is replaced there
  EXPECT_LE(b.lower, inside * pi * 0.0009);
  EXPECT_GE(b.upper, inside * pi * 0.0009);
}

// Both angles turn over where y = 0, and what is made of them does not.
TEST_F(Spikes, ABranchCutOfAContinuousTractionCostsNoBounds) {
  std::string text = plate("[[boundary]]\non = \"right\"\ntraction = [\"re/(re^2 + im^2)\", 0]\n");
  text += R"toml([define]
t1 = "0.5*atan2(y - 0.5, 1 - x)"
t2 = "0.5*atan2(y - 0.5, 1.5 - x)"
re = "cos(t1)*cos(t2) - sin(t1)*sin(t2)"
im = "cos(t1)*sin(t2) + sin(t1)*cos(t2)"
)toml";
  const nlohmann::json r = result_of(text);
  // cos of the mean angle, of which each goes from pi/2 down to the cut and comes back.
  double truth = 0;
  constexpr int n = 20000;
  for (int i = 0; i < n; ++i) {
    const double y = (i + 0.5) / n - 0.5;
    truth += std::cos(0.5 * (std::atan2(y, -1) + std::atan2(y, -0.5))) / n;
  }
  const Interval b = force(r);
  EXPECT_TRUE(b.guaranteed) << r.dump();
  EXPECT_LE(b.lower, -truth + 1e-6);
  EXPECT_GE(b.upper, -truth - 1e-6);
}

}  // namespace
}  // namespace kerf::spikes_test
