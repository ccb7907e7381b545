// Limits that hold while a run goes on. That a run ends when it is asked to is tested elsewhere.

#include "app/watchdog.hpp"

#include "kerf/stop.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace kerf::watchdog_test {
namespace {

using std::chrono::milliseconds;

class WatchdogTest : public testing::Test {
 protected:
  void TearDown() override {
    forget_stop();
  }
  /// As long as it may take on a busy machine.
  static bool stops_soon() {
    for (int k = 0; k < 400 && !stop_requested(); ++k) std::this_thread::sleep_for(milliseconds(25));
    return stop_requested();
  }
};

TEST_F(WatchdogTest, AsksWhatTakesTooLongToStopAndSaysWhy) {
  const Watchdog dog({.memory_mb = {}, .seconds = 0.1});
  EXPECT_TRUE(stops_soon());
  EXPECT_EQ(dog.why(), "stopped: it took longer than --max-seconds 0.1");
}

TEST_F(WatchdogTest, LooksAwayWhilePaused) {
  Watchdog dog({.memory_mb = {}, .seconds = 0.2});
  dog.pause();
  std::this_thread::sleep_for(milliseconds(600));
  EXPECT_FALSE(stop_requested());
  dog.resume();
  EXPECT_TRUE(stops_soon());
}

TEST_F(WatchdogTest, LeavesAloneWhatHasNoLimitOrKeepsIt) {
  const Watchdog none({}), wide({.memory_mb = 1e6, .seconds = 1e6});
  std::this_thread::sleep_for(milliseconds(200));
  EXPECT_FALSE(stop_requested());
  EXPECT_FALSE(none.why() || wide.why());
}

TEST_F(WatchdogTest, EndsWhatSwells) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_EXIT(
      {
        const Watchdog dog({.memory_mb = 1, .seconds = {}});
        std::this_thread::sleep_for(std::chrono::seconds(20));
      },
      testing::ExitedWithCode(4), "stopped: it took more memory than --max-memory 1MB");
}

}  // namespace
}  // namespace kerf::watchdog_test
