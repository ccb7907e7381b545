// Intervals of K, G, stresses, T, means and displacements in scenes that nobody chose: those of a coarse mesh meet
// those of a fine one of degree 3, both contain the exact value.

#include "tests/truth/random_scene.hpp"
#include "tests/truth/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kerf::bounds_test {
namespace {

class BoundsTruth : public Truth {};

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
}

/// A functional with an adjoint: the opening of the first crack that has faces; none: that of the energy.
std::string functional(const std::string& scene) {
  for (const char* name : {"c0", "c1"}) {
    const std::size_t at = scene.find(fmt::format("name = \"{}\"", name));
    if (at == std::string::npos) continue;
    const std::size_t law = scene.find("contact = ", at);
    if (scene.compare(law, 16, "contact = \"open\"") == 0)
      return fmt::format("[functional]\nkind = \"crack_opening\"\ncrack = \"{}\"\n", name);
  }
  return {};
}

/// Counts of what was compared.
struct Tally {
  unsigned guaranteed = 0, compared = 0;
};

void compare(const nlohmann::json& coarse, const nlohmann::json& fine, const std::string& what, Tally& tally) {
  if (!coarse["lower"].is_number() || !fine["lower"].is_number()) return;
  ++tally.compared;
  if (!coarse["guaranteed"].get<bool>() || !fine["guaranteed"].get<bool>()) return;
  ++tally.guaranteed;
  const double low = coarse["lower"], high = coarse["upper"], value = fine["value"];
  const double rounding = 1e-9 * std::max(std::abs(low), std::abs(high));
  EXPECT_LE(low, fine["upper"].get<double>() + rounding) << what;
  EXPECT_GE(high, fine["lower"].get<double>() - rounding) << what;
  // The middle of the fine interval is near the truth.
  const double half = 0.5 * (fine["upper"].get<double>() - fine["lower"].get<double>());
  EXPECT_LE(low, value + half + rounding) << what;
  EXPECT_GE(high, value - half - rounding) << what;
}

TEST_F(BoundsTruth, CoarseAndFineIntervalsMeet) {
  const unsigned first = number("KERF_FIRST", 1), count = number("KERF_SCENES", 6);
  Tally tally;
  for (unsigned seed = first; seed < first + count; ++seed) {
    std::string scene = random_scene(seed);
    replace_all(scene, "contact = \"unilateral\"", "contact = \"open\"");
    // By turns: each quantity costs solves of both meshes.
    scene += seed % 2 == 0 ? "[bounds]\npoints = [[0.0, 0.18], [0.05, -0.3], [-0.35, 0.1]]\n"
                           : "[bounds]\ndisplacements = \"s0\"\ncompliance = true\n"
                             "disc = [{ center = [0.0, 0.35], radius = 0.06 }]\n"
                             "line = [{ from = [-0.1, -0.33], to = [0.1, -0.36] }]\n";
    scene += "[map]\npoints = [[0.0, 0.18]]\n";
    if (seed % 4 == 2) scene += functional(scene);
    SCOPED_TRACE(fmt::format("seed {}\n{}", seed, scene));
    const std::vector<std::string> coarse_mesh{"mesh.size=0.1", "mesh.crack_tip_size=0.01"},
        fine_mesh{"mesh.size=0.06", "mesh.crack_tip_size=0.001", "solver.degree=3"};
    const nlohmann::json coarse = run_scene(scene, Job::Solve, coarse_mesh)["bounds"],
                         fine = run_scene(scene, Job::Solve, fine_mesh)["bounds"];
    ASSERT_EQ(coarse["tips"].size(), fine["tips"].size());
    for (std::size_t i = 0; i < coarse["tips"].size(); ++i)
      for (const char* of : {"K_I", "K_II", "G"})
        compare(coarse["tips"][i][of], fine["tips"][i][of], fmt::format("{} of tip {}", of, i), tally);
    for (std::size_t i = 0; i < coarse["points"].size(); ++i)
      for (const char* of : {"s_xx", "s_yy", "s_xy", "von_mises", "topological_derivative"})
        compare(coarse["points"][i][of], fine["points"][i][of], fmt::format("{} at point {}", of, i), tally);
    for (const auto& [list, quantities] : std::vector<std::pair<const char*, std::vector<const char*>>>{
             {"discs", {"s_xx", "s_yy", "s_xy", "e_xx", "e_yy", "e_xy"}},
             {"lines", {"s_nn", "s_nt", "s_tt"}},
             {"displacements", {"u_x", "u_y"}}})
      for (std::size_t i = 0; i < coarse[list].size(); ++i)
        for (const char* of : quantities)
          compare(coarse[list][i][of], fine[list][i][of], fmt::format("{} of {} {}", of, list, i), tally);
    if (coarse.contains("compliance")) compare(coarse["compliance"], fine["compliance"], "compliance", tally);
  }
  RecordProperty("compared", static_cast<int>(tally.compared));
  RecordProperty("guaranteed", static_cast<int>(tally.guaranteed));
  EXPECT_GT(tally.guaranteed, 4 * count);
}

}  // namespace
}  // namespace kerf::bounds_test
