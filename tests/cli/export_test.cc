#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/evaluation/trajectory_file.h"
#include "tests/cli/command_run.h"
#include "tests/cli/recorded_store.h"
#include "tests/sensor/recording.h"
#include "tests/sensor/temporary_folder.h"

namespace pangaea {
namespace {

using ::testing::HasSubstr;
using testing::RunPangaea;

class Export : public ::testing::Test {
 protected:
  Export() { testing::WriteStore(store(), {{.id = 1, .name = "flight"}, {.id = 2, .name = "../flight"}}); }
  std::string Path(const std::string& name) const { return (folder_.path() / name).string(); }
  std::string store() const { return Path("atlas.db"); }

  testing::TemporaryFolder folder_;
};

TEST_F(Export, EverySessionBecomesAFileOfAllItsFrames) {
  const auto run = RunPangaea({"export", "--format", "tum", "--store", store(), "--out", Path("new/folder")});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const auto poses = ReadTrajectory(Path("new/folder/flight.tum"));
  ASSERT_TRUE(poses) << poses.error().message;
  ASSERT_EQ(poses->size(), static_cast<std::size_t>(testing::kRecordedFrames));
  EXPECT_EQ(poses->back().stamp_ns, testing::RecordedStamp(testing::kRecordedFrames - 1));
  EXPECT_NEAR(poses->back().world_from_body.translation().norm(), 0.7, 1e-6);
}

TEST_F(Export, ASessionsNameCannotLeaveTheFolder) {
  EXPECT_EQ(RunPangaea({"export", "--store", store(), "--out", Path("out")}).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(Path("out/_.._flight.tum")));
}

TEST_F(Export, OneSessionMayBecomeOneFile) {
  const auto run = RunPangaea({"export", "--store", store(), "--session", "flight", "--out", Path("mine.tum")});
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(ReadTrajectory(Path("mine.tum")));
  const auto both = RunPangaea({"export", "--store", store(), "--out", Path("both.tum")});
  EXPECT_EQ(both.exit_code, 2);
  EXPECT_THAT(both.err, HasSubstr("--session"));
}

TEST_F(Export, UnknownSessionsFormatsAndStoresAreNamed) {
  auto run = RunPangaea({"export", "--store", store(), "--session", "nobody", "--out", Path("out")});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("there are: flight"));
  EXPECT_EQ(RunPangaea({"export", "--format", "dwg", "--store", store(), "--out", Path("out")}).exit_code, 2);
  run = RunPangaea({"export", "--store", Path("none.db"), "--out", Path("out")});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("none.db"));
}

}  // namespace
}  // namespace pangaea
