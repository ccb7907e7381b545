// Limits that hold while a run goes on. That a run ends when it is asked to is tested elsewhere.

#include "app/command/watchdog.hpp"

#include "kerf/stop.hpp"
#include "tests/support/running.hpp"

#include <gtest/gtest.h>

#include <sys/prctl.h>
#include <unistd.h>

#include <csignal>
#include <vector>

namespace kerf::watchdog_test {
namespace {

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

TEST_F(WatchdogTest, CountsForecasts) {
  Watchdog dog({.memory_mb = {}, .seconds = 0.1});
  dog.allow_forecast();
  EXPECT_TRUE(test::eventually(stop_requested));
  EXPECT_TRUE(dog.why());
}

TEST_F(WatchdogTest, CountsChildren) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_EXIT(
      {
        const pid_t child = fork();
        if (child == 0) {
          prctl(PR_SET_PDEATHSIG, SIGKILL);
          std::vector<char> swollen(400 << 20, 1);
          pause();
        }
        const Watchdog dog({.memory_mb = 250, .seconds = {}});
        test::eventually([] { return false; });
      },
      testing::ExitedWithCode(4), "stopped: it took more memory than --max-memory 250MB");
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
