#include "common/base/median.h"

#include <gtest/gtest.h>

namespace pangaea {
namespace {

TEST(Median, IsTheMiddleOneAndOfAnEvenNumberTheUpperOfTheTwo) {
  EXPECT_EQ(Median({5.0, -1.0, 3.0}), 3.0);
  EXPECT_EQ(Median({4.0, 1.0, 3.0, 2.0}), 3.0);
  EXPECT_EQ(Median({7.0}), 7.0);
}

TEST(Median, OfNothingIsWhatIsAskedFor) {
  EXPECT_EQ(Median({}), 0.0);
  EXPECT_EQ(Median({}, 1.0), 1.0);
}

}  // namespace
}  // namespace pangaea
