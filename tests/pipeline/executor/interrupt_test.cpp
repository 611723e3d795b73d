#include "pipeline/executor/interrupt.h"

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "pipeline/executor/log.h"
#include "pipeline/executor/prompt_stop.h"

namespace voxweld {
namespace {

TEST(Interrupt, FlagThrowsOnlyAfterARequest) {
  InterruptFlag flag;
  EXPECT_NO_THROW(flag.check());
  flag.request();
  EXPECT_TRUE(flag.requested());
  EXPECT_THROW(flag.check(), Interrupted);
}

TEST(Interrupt, SignalsSetTheFlagWithinTheScopeOnly) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const auto before = std::signal(signal, SIG_IGN);
    InterruptFlag flag;
    {
      const InterruptScope scope(flag);
      EXPECT_FALSE(flag.requested());
      std::raise(signal);
      EXPECT_TRUE(flag.requested());
    }
    InterruptFlag untouched;
    std::raise(signal);  // ignored again, as before the scope
    EXPECT_FALSE(untouched.requested());
    std::signal(signal, before);
  }
}

TEST(Interrupt, RepeatedTerminationChangesNothing) {
  InterruptFlag flag;
  const InterruptScope scope(flag);
  std::raise(SIGTERM);
  std::raise(SIGTERM);
  EXPECT_TRUE(flag.requested());
}

void press_twice() {
  InterruptFlag flag;
  const InterruptScope scope(flag);
  std::raise(SIGINT);
  std::raise(SIGINT);
  std::exit(0);
}

TEST(InterruptDeathTest, ASecondCtrlCExitsAtOnce) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(press_twice(), testing::ExitedWithCode(130), "Ctrl-C again stops at once");
}

// As in a library's call that asks nobody.
void work_on_after_a_stop() {
  set_up_logging(LogLevel::info, Console::standard_error());
  InterruptFlag flag;
  const PromptStop prompt(flag, 0.05);
  flag.request();
  std::this_thread::sleep_for(std::chrono::seconds(20));
  std::exit(0);
}

TEST(InterruptDeathTest, AStopEndsWorkThatAsksNobody) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EXIT(work_on_after_a_stop(), testing::ExitedWithCode(1), "interrupted; what is finished");
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10));
}

TEST(Interrupt, WorkThatEndsInTimeIsNotStopped) {
  InterruptFlag flag, never;
  { const PromptStop prompt(never, 0); }
  const PromptStop prompt(flag, 60);
  flag.request();
}

}  // namespace
}  // namespace voxweld
