// Checkpoints whose checksum is right and whose structure or values are not: each is refused as a file, or gone on
// from, and never ends the program.

#include "tests/optimize/damage.hpp"
#include "kerf/optimize.hpp"
#include "optimize/level_set/descent.hpp"
#include "optimize/level_set/finishing.hpp"
#include "optimize/level_set/starts.hpp"
#include "tests/optimize/designs.hpp"
#include "tests/support/folder.hpp"

#include <gtest/gtest.h>

namespace kerf::damage_test {
namespace {

using namespace scenes;

/// Clamped at the bottom, pulled at the top.
Problem plate(double size) {
  Problem p;
  p.frame = rectangle({-1, -1}, {1, 1});
  p.scene = pulled(plane_strain(1, 0.3), [](const Vec2& x) { return Vec2(0, 1 + 0.3 * x.x()); });
  p.scene.laws.clear();
  p.sizing.size = size;
  p.objective = {"compliance", {compliance()}};
  return p;
}
FunctionalBound loose() {
  return {"energy", {"compliance", {compliance()}}, 1e3};
}
OptimizeRequest level_set(int iterations) {
  OptimizeRequest r{.max_iterations = iterations};
  r.volume_at_most = 0.9;
  r.bounds = {loose()};
  r.level_set.nucleate_every = 2;
  r.level_set.start = StartHoles{.columns = 1, .rows = 1, .radius = 0.3};
  r.starts = 1;
  return r;
}
OptimizeRequest drawn_hole(OptimizeMethod method) {
  OptimizeRequest r{.method = method, .max_iterations = 4, .starts = 2};
  r.volume_at_most = 0.97;
  r.bounds = {loose()};
  r.design.drawn = {drawn(Drawn::Kind::Circle, "h", Eigen::Vector3d(0.1, 0.1, 0.3), 0.2)};
  return r;
}

constexpr unsigned damages = 200;

/// Goes on from each of the damages.
void expect_refused_or_good(const Checkpoint& whole, const std::function<void(const CheckpointPlace&)>& resume) {
  const test::Folder folder;
  const CheckpointPlace place{folder.path / "checkpoint.bin", whole.fingerprint, true};
  unsigned refused = 0;
  for (unsigned seed = 0; seed < damages; ++seed) {
    const auto [c, said] = damage::damaged(whole, seed);
    SCOPED_TRACE(std::to_string(seed) + ": " + said);
    write_checkpoint(place.path, c);
    try {
      resume(place);
    } catch (const Error& error) {
      ++refused;
      const std::string_view text = error.what();
      EXPECT_TRUE(error.fault == Fault::Files || text.find("belongs to another case or method") != text.npos) << text;
      EXPECT_NE(text.find("; start without --resume"), text.npos) << text;
    } catch (const std::exception& other) {
      ADD_FAILURE() << other.what();
    }
  }
  EXPECT_GT(refused, damages / 10);
}

/// The checkpoint of a run that stops after so many rows of curves, or else of any.
Checkpoint written_after(const Problem& p, const OptimizeRequest& r, int rows, bool of_curves) {
  const test::Folder folder;
  const CheckpointPlace place{folder.path / "checkpoint.bin", "case"};
  int left = rows;
  optimize_level_set(
      p, r, [&](const Iterate& i) { return (of_curves && !i.row.note.starts_with("curves")) || --left > 0; }, place);
  return *read_checkpoint(place.path);
}
void try_level_set(const Problem& p, const OptimizeRequest& r, const Checkpoint& whole) {
  expect_refused_or_good(whole, [&](const CheckpointPlace& place) {
    int left = 2;
    optimize_level_set(
        p, r, [&](const Iterate&) { return --left > 0; }, place);
  });
}

TEST(DamagedCheckpoint, OfALevelSet) {
  const Problem p = plate(0.35);
  const OptimizeRequest r = level_set(6);
  Checkpoint whole = written_after(p, r, 3, false);
  // Two holes, as if they had been nucleated.
  whole.texts["nucleated"] = "a note\n\n";
  whole.numbers["nucleated"] = Eigen::VectorXd::Ones(16);
  try_level_set(p, r, whole);
}

TEST(DamagedCheckpoint, OfCurves) {
  const Problem p = plate(0.35);
  const OptimizeRequest r = level_set(30);
  Checkpoint whole = written_after(p, r, 3, true);
  ASSERT_GT(whole.numbers.at("curves").size(), 0);
  try_level_set(p, r, whole);
}

TEST(DamagedCheckpoint, OfAFixedPoint) {
  const Problem p = plate(0.35);
  OptimizeRequest r = level_set(6);
  r.level_set.move = LevelSetRequest::Move::FixedPoint;
  try_level_set(p, r, written_after(p, r, 3, false));
}

TEST(DamagedCheckpoint, OfAWeakPhase) {
  const Problem p = plate(0.35);
  OptimizeRequest r = level_set(6);
  r.bounds.clear();
  r.level_set.move = LevelSetRequest::Move::FixedPoint;
  r.level_set.ersatz = 1e-3;
  try_level_set(p, r, written_after(p, r, 3, false));
}

TEST(DamagedCheckpoint, OfADesignDrawn) {
  const Problem p = plate(0.5);
  const OptimizeRequest r = drawn_hole(OptimizeMethod::Mma);
  const test::Folder folder;
  const CheckpointPlace place{folder.path / "checkpoint.bin", "case"};
  optimize_parameters(p, r, {}, place);
  expect_refused_or_good(*read_checkpoint(place.path),
                         [&](const CheckpointPlace& at) { optimize_parameters(p, r, {}, at); });
}

/// What is told of a state without going on from it: sizes and values that the next step can count on.
TEST(DamagedState, IsRefusedOrWhole) {
  const Problem p = plate(0.5);
  const OptimizeRequest r = level_set(3);
  const Ground g = make_ground(p, r);
  DescentState s = Descent(g, {.iterations = 3}, given_start(g).phi).progress();
  s.nucleated = {{.note = "a note"}, {}};
  s.track = {3, 2, 1};
  Checkpoint whole = packed(s);
  const Eigen::VectorXd some = Eigen::VectorXd::LinSpaced(6, -1, 1);
  write_curves(whole, {{.bounds = {1}, .note = "a note", .knots = some, .values = some, .gradients = some}, {}});
  EXPECT_NO_THROW(check_state(unpacked(whole), sizes_of_state(g)));
  constexpr unsigned many = 5000;
  unsigned refused = 0;
  for (unsigned seed = 0; seed < many; ++seed) {
    const auto [c, said] = damage::damaged(whole, seed);
    SCOPED_TRACE(std::to_string(seed) + ": " + said);
    try {
      const DescentState back = unpacked(c);
      check_state(back, sizes_of_state(g));
      read_curves(c);
      EXPECT_EQ(back.phi.size(), s.phi.size());
      EXPECT_TRUE(back.phi.allFinite() && std::isfinite(back.price) && back.radius > 0);
      EXPECT_FALSE(back.rows.empty());
    } catch (const Error& error) {
      EXPECT_EQ(error.fault, Fault::Files) << error.what();
      ++refused;
    }
  }
  EXPECT_GT(refused, many / 4);
}

}  // namespace
}  // namespace kerf::damage_test
