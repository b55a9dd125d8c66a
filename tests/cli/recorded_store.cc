#include "tests/cli/recorded_store.h"

#include <gtest/gtest.h>

#include "server/storage/store.h"
#include "tests/map/small_world.h"
#include "tests/sensor/recording.h"

namespace pangaea::testing {
namespace {

constexpr int kMiddle = kRecordedFrames / 2;

// As WriteEurocRecording has it; body and left camera are one there.
Rigid3d WorldFromCamera(int frame) { return Rigid3d(Eigen::Quaterniond(0.5, 0.5, 0.5, 0.5), {0.1 * frame, 2.0, 3.0}); }

Rigid3d TargetFromFrame(int target, int frame) { return WorldFromCamera(target).Inverse() * WorldFromCamera(frame); }

std::vector<MapEdit> EditsOf(const RecordedSession& session) {
  const SessionId owner = session.in_map_of == 0 ? session.id : session.in_map_of;
  const auto stamp = [&](int frame) { return RecordedStamp(frame) + session.delay_ns; };
  const KeyframeId first{session.id, 1};
  const KeyframeId middle{session.id, 2};
  const KeyframeId parent = owner == session.id ? KeyframeId{} : KeyframeId{owner, 1};
  std::vector<MapEdit> edits{
      AddKeyframe{first, {owner, 1}, parent, Rigid3d(), MakeData(6, stamp(0))},
      AddKeyframe{middle, {owner, 1}, first, TargetFromFrame(kMiddle, 0), MakeData(6, stamp(kMiddle))}};
  AddFramePoses frames;
  for (int i = 1; i < kRecordedFrames; ++i) {
    if (i == kMiddle) continue;
    const int reference = i < kMiddle ? 0 : kMiddle;
    frames.frames.push_back({i < kMiddle ? first : middle, {stamp(i), TargetFromFrame(reference, i)}});
  }
  edits.emplace_back(frames);
  for (std::uint32_t i = 0; i < 6; ++i) {
    edits.push_back(AddLandmark{{session.id, i + 1}, i < 3 ? first : middle, i, {0.3 * i - 1.0, 0.1 * i, 3.0}});
  }
  return edits;
}

SessionRecord RecordOf(const RecordedSession& session) {
  SessionRecord record;
  record.announcement.session = session.id;
  record.announcement.name = session.name;
  record.announcement.site = "hall";
  record.announcement.ideal_camera = {kRecordedWidth, kRecordedHeight, 60.0, 60.0, 31.0, 24.0, 0.11};
  record.joined_unix_ns = static_cast<std::int64_t>(session.id);
  record.acknowledged = session.joined_only ? 0 : 1;
  return record;
}

}  // namespace

void WriteStore(const std::filesystem::path& path, const std::vector<RecordedSession>& sessions) {
  auto store = Store::Open(path, "hall", {});
  ASSERT_TRUE(store) << store.error().message;
  JournalBatch batch;
  for (const RecordedSession& session : sessions) {
    batch.sessions.push_back(RecordOf(session));
    if (session.joined_only) continue;
    batch.entries.push_back({batch.entries.size() + 1, MakeEnvelope(session.id, 1, 0, EditsOf(session))});
  }
  const Status appended = store->Append(batch);
  ASSERT_TRUE(appended) << appended.error().message;
}

}  // namespace pangaea::testing
