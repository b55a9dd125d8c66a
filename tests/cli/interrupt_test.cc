#include "cli/interrupt.h"

#include <gtest/gtest.h>

#include <csignal>

namespace pangaea {
namespace {

using Clock = std::chrono::steady_clock;

TEST(Interrupt, WhatIsDueIsNotWaitedFor) {
  Interrupt interrupt;
  EXPECT_FALSE(interrupt.WaitUntil(Clock::now() - std::chrono::hours(1)));
}

TEST(Interrupt, ASignalEndsTheWaitingForGood) {
  Interrupt interrupt;
  std::raise(SIGTERM);
  EXPECT_TRUE(interrupt.WaitUntil(Clock::now() + std::chrono::hours(1)));
  EXPECT_TRUE(interrupt.WaitUntil(Clock::now() + std::chrono::hours(1)));
}

}  // namespace
}  // namespace pangaea
