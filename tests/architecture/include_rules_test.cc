#include "tests/architecture/include_rules.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pangaea {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(IncludeRules, TheTreeKeepsTheTable) {
  const auto includes = ReadIncludes(PANGAEA_SOURCE_DIR);
  ASSERT_GT(includes.size(), 300U);  // the reader finds the tree
  EXPECT_THAT(ForbiddenIncludes(includes), IsEmpty());
}

TEST(IncludeRules, AnAgentMayNotIncludeTheServer) {
  EXPECT_THAT(ForbiddenIncludes({{"agent/main.cc", "server/runtime/server.h", 3}}),
              ElementsAre(HasSubstr("agent/main.cc:3: agent may not include server/runtime/server.h")));
}

TEST(IncludeRules, TheMapMayNotIncludeFeatures) {
  EXPECT_THAT(ForbiddenIncludes({{"common/map/atlas.h", "common/features/matching.h", 7}}),
              ElementsAre(HasSubstr("common/map may not include")));
}

TEST(IncludeRules, LowerFoldersMayNotIncludeUpperOnes) {
  EXPECT_THAT(ForbiddenIncludes({{"common/geometry/rigid3.h", "common/map/ids.h", 1},
                                 {"common/estimation/a.cc", "common/wire/envelope.h", 2}}),
              ElementsAre(HasSubstr("common/geometry"), HasSubstr("common/estimation")));
}

TEST(IncludeRules, CoreCodeHasNoThreadAndNoFile) {
  EXPECT_THAT(ForbiddenIncludes({{"agent/tracking/tracker.cc", "thread", 4},
                                 {"common/map/atlas.cc", "common/base/mutex.h", 5},
                                 {"server/ingest/session.cc", "fstream", 6},
                                 {"agent/runtime/agent_run.cc", "thread", 7}}),
              ElementsAre(HasSubstr("tracker.cc:4"), HasSubstr("atlas.cc:5"), HasSubstr("session.cc:6")));
}

TEST(IncludeRules, OnlyTheAdaptersSeeTheTypesOfTheirTransport) {
  EXPECT_THAT(ForbiddenIncludes({{"common/dds/topics.cc", "idl/session.h", 1},
                                 {"agent/runtime/agent_run.cc", "idl/session.h", 2},
                                 {"common/lcm/receiver.cc", "lcm/lcm-cpp.hpp", 3},
                                 {"cli/lcm_publish.cc", "pangaea_lcm/image_t.hpp", 4},
                                 {"common/wire/a.cc", "lcm/lcm-cpp.hpp", 5}}),
              ElementsAre(HasSubstr("agent_run.cc:2"), HasSubstr("lcm_publish.cc:4"), HasSubstr("a.cc:5")));
}

TEST(IncludeRules, TheCliSeesOfTheServerOnlyItsStorage) {
  EXPECT_THAT(ForbiddenIncludes({{"cli/evaluate.cc", "server/storage/store.h", 1},
                                 {"cli/evaluate.cc", "server/runtime/server.h", 2}}),
              ElementsAre(HasSubstr("cli/evaluate.cc:2")));
}

}  // namespace
}  // namespace pangaea
