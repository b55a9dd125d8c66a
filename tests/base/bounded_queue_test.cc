#include "common/base/bounded_queue.h"

#include <gtest/gtest.h>

#include <memory>
#include <thread>

namespace pangaea {
namespace {

TEST(BoundedQueue, ItemsComeOutInTheOrderTheyWentIn) {
  BoundedQueue<int> queue(3);
  ASSERT_TRUE(queue.TryPush(1));
  ASSERT_TRUE(queue.Push(2));
  EXPECT_EQ(queue.Pop(), 1);
  EXPECT_EQ(queue.TryPop(), 2);
  EXPECT_EQ(queue.TryPop(), std::nullopt);
}

TEST(BoundedQueue, AFullQueueRefusesOrGivesUpItsOldest) {
  BoundedQueue<int> queue(2);
  EXPECT_EQ(queue.PushNewest(1), 0u);
  EXPECT_EQ(queue.PushNewest(2), 0u);
  EXPECT_FALSE(queue.TryPush(3));
  EXPECT_EQ(queue.PushNewest(3), 1u);
  EXPECT_EQ(queue.size(), 2u);
  EXPECT_EQ(queue.Pop(), 2);
  EXPECT_EQ(queue.Pop(), 3);
}

TEST(BoundedQueue, AClosedQueueGivesWhatItHoldsAndTakesNothing) {
  BoundedQueue<std::unique_ptr<int>> queue(2);
  ASSERT_TRUE(queue.Push(std::make_unique<int>(1)));
  queue.Close();
  EXPECT_FALSE(queue.Push(std::make_unique<int>(2)));
  EXPECT_FALSE(queue.TryPush(std::make_unique<int>(2)));
  EXPECT_EQ(**queue.Pop(), 1);
  EXPECT_EQ(queue.Pop(), std::nullopt);
}

TEST(BoundedQueue, APushWaitsForRoomAndAPopForItems) {
  BoundedQueue<int> queue(1);
  constexpr int kItems = 1000;
  std::thread producer([&] {
    for (int i = 0; i < kItems; ++i) EXPECT_TRUE(queue.Push(i));
    queue.Close();
  });
  int expected = 0;
  while (const auto item = queue.Pop()) EXPECT_EQ(*item, expected++);
  producer.join();
  EXPECT_EQ(expected, kItems);
}

TEST(BoundedQueue, ClosingWakesAPushThatWaits) {
  BoundedQueue<int> queue(1);
  ASSERT_TRUE(queue.Push(1));
  std::thread producer([&] { EXPECT_FALSE(queue.Push(2)); });
  queue.Close();
  producer.join();
  EXPECT_EQ(queue.size(), 1u);
}

}  // namespace
}  // namespace pangaea
