#include "common/base/stop_signals.h"

#include <gtest/gtest.h>

#include <csignal>
#include <thread>

namespace pangaea {
namespace {

using Clock = std::chrono::steady_clock;

TEST(StopSignals, WhatIsDueIsNotWaitedFor) {
  StopSignals signals;
  EXPECT_FALSE(signals.WaitUntil(Clock::now() - std::chrono::hours(1)));
}

TEST(StopSignals, ASignalEndsTheWaitingForGood) {
  StopSignals signals;
  std::raise(SIGTERM);
  EXPECT_TRUE(signals.WaitUntil(Clock::now() + std::chrono::hours(1)));
  EXPECT_TRUE(signals.WaitUntil(Clock::now() + std::chrono::hours(1)));
}

TEST(StopSignals, EachSignalEndsOneWaitWhateverThreadGetsIt) {
  StopSignals signals;
  std::thread([] { std::raise(SIGINT); }).join();
  signals.Wait();
  std::thread poster([&signals] { signals.Post(); });
  signals.Wait();
  poster.join();
  EXPECT_FALSE(signals.WaitUntil(Clock::now()));
}

}  // namespace
}  // namespace pangaea
