// Limits that hold while a run goes on. That a run ends when it is asked to is tested elsewhere.

#include "app/watchdog.hpp"

#include "kerf/stop.hpp"
#include "tests/support/running.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <optional>

namespace kerf::watchdog_test {
namespace {

using std::chrono::milliseconds;

class WatchdogTest : public testing::Test {
 protected:
  void TearDown() override {
    forget_stop();
  }
};

TEST_F(WatchdogTest, AsksWhatTakesTooLongToStopAndSaysWhy) {
  const Watchdog dog({.memory_mb = {}, .seconds = 0.1});
  EXPECT_TRUE(test::eventually(stop_requested));
  EXPECT_EQ(dog.why(), "stopped: it took longer than --max-seconds 0.1");
}

// Another one, which looks as often, says when the time is over.
TEST_F(WatchdogTest, LooksAwayWhilePaused) {
  std::optional<Watchdog> paused;
  std::chrono::steady_clock::time_point begin;
  do {  // until the pause comes before its time is over
    paused.reset();
    forget_stop();
    begin = std::chrono::steady_clock::now();
    paused.emplace(Allowed{.memory_mb = {}, .seconds = 0.2});
    paused->pause();
  } while (std::chrono::steady_clock::now() - begin > milliseconds(100));
  {
    const Watchdog awake({.memory_mb = {}, .seconds = 0.5});
    EXPECT_TRUE(test::eventually(stop_requested));
    EXPECT_TRUE(awake.why());
    EXPECT_FALSE(paused->why());
  }
  forget_stop();
  paused->resume();
  EXPECT_TRUE(test::eventually(stop_requested));
  EXPECT_TRUE(paused->why());
}

TEST_F(WatchdogTest, LeavesAloneWhatHasNoLimitOrKeepsIt) {
  const Watchdog none({}), wide({.memory_mb = 1e6, .seconds = 1e6}), narrow({.memory_mb = {}, .seconds = 0.2});
  EXPECT_TRUE(test::eventually(stop_requested));
  EXPECT_TRUE(narrow.why());
  EXPECT_FALSE(none.why() || wide.why());
}

TEST_F(WatchdogTest, EndsWhatSwells) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_EXIT(
      {
        const Watchdog dog({.memory_mb = 1, .seconds = {}});
        test::eventually([] { return false; });
      },
      testing::ExitedWithCode(4), "stopped: it took more memory than --max-memory 1MB");
}

}  // namespace
}  // namespace kerf::watchdog_test
