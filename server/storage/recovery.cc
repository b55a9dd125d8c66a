#include "server/storage/recovery.h"

#include <algorithm>
#include <string>
#include <utility>

#include "common/map/atlas_codec.h"
#include "common/map/map_edit.h"
#include "server/ingest/agent_edit.h"
#include "server/storage/snapshot_reading.h"

namespace pangaea {
namespace {

Status LoadFromSnapshot(Store& store, RecoveredAtlas& recovered) {
  const auto snapshot = LoadSnapshot(store.database());
  if (!snapshot) return tl::make_unexpected(snapshot.error());
  if (!*snapshot) return {};
  const auto data = StoredKeyframeData(store.database());
  if (!data) return tl::make_unexpected(data.error());
  auto atlas = DecodeAtlas((*snapshot)->atlas, *data);
  if (!atlas) return tl::make_unexpected(atlas.error());
  recovered.atlas = std::move(*atlas);
  recovered.position = recovered.snapshot_position = (*snapshot)->position;
  recovered.atlas.ForEachKeyframe([&recovered](const Keyframe& keyframe) {
    recovered.correction = std::max(recovered.correction, keyframe.corrected_at);
  });
  return {};
}

Status Replay(const JournalEntry& entry, RecoveredAtlas& recovered) {
  const auto damaged = [&entry](const std::string& what) {
    return Fail(ErrorCode::kCorrupt,
                "the journal is damaged at position " + std::to_string(entry.position) + ": " + what);
  };
  if (entry.position != recovered.position + 1) return damaged("entries before it are missing");
  const auto edits = DecodeEdits(entry.envelope.edits);
  if (!edits) return damaged(edits.error().message);
  const auto apply = entry.envelope.session == 0 ? &Apply : &ApplyAgentEdit;
  for (const MapEdit& edit : *edits) {
    if (auto status = apply(edit, recovered.atlas); !status) return damaged(status.error().message);
  }
  recovered.position = entry.position;
  if (entry.envelope.session == 0) recovered.correction = entry.position;
  ++recovered.replayed;
  return {};
}

}  // namespace

Result<RecoveredAtlas> RecoverAtlas(Store& store) {
  // One read transaction: a server that goes on writing must not truncate the journal between our queries.
  ReadTransaction consistent(store.database());
  RecoveredAtlas recovered;
  if (auto status = LoadFromSnapshot(store, recovered); !status) return tl::make_unexpected(status.error());
  const auto replay = [&recovered](const JournalEntry& entry) { return Replay(entry, recovered); };
  if (auto status = store.ForEachEditsAfter(recovered.position, replay); !status) {
    return tl::make_unexpected(status.error());
  }
  auto sessions = store.Sessions();
  if (!sessions) return tl::make_unexpected(sessions.error());
  recovered.sessions = std::move(*sessions);
  auto rejections = store.Rejections();
  if (!rejections) return tl::make_unexpected(rejections.error());
  recovered.rejections = std::move(*rejections);
  auto separations = store.Separations();
  if (!separations) return tl::make_unexpected(separations.error());
  recovered.separations = std::move(*separations);
  return recovered;
}

}  // namespace pangaea
