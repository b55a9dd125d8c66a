#include "server/storage/undo.h"

#include <optional>
#include <sstream>
#include <utility>

#include "common/map/atlas_codec.h"
#include "common/map/map_edit.h"
#include "common/map/spanning_tree.h"
#include "server/ingest/server_proposal.h"
#include "server/storage/snapshot_reading.h"
#include "server/storage/snapshot_store.h"
#include "server/storage/undo_replay.h"

namespace pangaea {
namespace {

// Rebuilding, as far as it got.
struct Rebuilding {
  UndoReplay replay;
  std::uint64_t position = 0;
  std::vector<std::uint64_t> undone;  // positions of the edits that are left out
};

// Where the atlas stands on which the journal of this store begins.
struct Beginning {
  Atlas atlas;
  std::uint64_t position = 0;
};

Result<Beginning> LoadBeginning(Store& store, std::uint64_t before) {
  Beginning beginning;
  const auto snapshot = LoadSnapshot(store.database(), before - 1);
  if (!snapshot) return tl::make_unexpected(snapshot.error());
  if (!*snapshot) return beginning;
  const auto data = StoredKeyframeData(store.database());
  if (!data) return tl::make_unexpected(data.error());
  auto atlas = DecodeAtlas((*snapshot)->atlas, *data);
  if (!atlas) return tl::make_unexpected(atlas.error());
  return Beginning{std::move(*atlas), (*snapshot)->position};
}

Status TakeRow(const Statement& row, Rebuilding& rebuilding) {
  const std::uint64_t position = row.Word(0);
  if (position != rebuilding.position + 1) {
    return Fail(ErrorCode::kRefused,
                "it cannot be undone any more: the journal before position " + std::to_string(position) + " is gone");
  }
  rebuilding.position = position;
  const auto edits = DecodeEdits(row.Blob(2));
  if (!edits) return Fail(ErrorCode::kCorrupt, "the journal is damaged at position " + std::to_string(position));
  const std::string cause = row.Text(1);
  if (cause.empty()) {
    rebuilding.replay.TakeAgents(*edits);
  } else if (row.Number(3) == 0 && !rebuilding.replay.TakeServers(*edits, cause)) {
    rebuilding.undone.push_back(position);
  }
  return {};
}

Result<Rebuilding> Rebuild(Store& store, Beginning beginning, const std::string& cause) {
  Rebuilding rebuilding{UndoReplay(std::move(beginning.atlas), cause), beginning.position, {}};
  auto select = Statement::Prepare(store.database(), R"(
    SELECT position, '' AS cause, edits, 0 FROM envelopes WHERE position > ?1
    UNION ALL SELECT position, cause, edits, undone FROM server_edits WHERE position > ?1 ORDER BY position)");
  if (!select) return tl::make_unexpected(select.error());
  select->Bind(beginning.position);
  for (auto row = select->Step(); !row || *row; row = select->Step()) {
    if (!row) return tl::make_unexpected(row.error());
    if (auto status = TakeRow(*select, rebuilding); !status) return tl::make_unexpected(status.error());
  }
  return rebuilding;
}

// Poses as they are, said once more: agents learn from the correction's version that they are to be taken.
std::vector<MapEdit> SayAnew(const UndoReplay& replay, std::uint64_t position) {
  std::vector<std::pair<KeyframeId, Rigid3d>> poses;
  replay.atlas().ForEachKeyframe([&](const Keyframe& keyframe) {
    if (replay.touched().contains(keyframe.map)) poses.emplace_back(keyframe.id, keyframe.camera_from_map);
  });
  std::vector<MapEdit> edits{MoveKeyframesTo(replay.atlas(), poses)};
  StampCorrections(position, edits);
  return edits;
}

Status WriteDown(Store& store, const Rebuilding& rebuilding) {
  auto mark = Statement::Prepare(store.database(), "UPDATE server_edits SET undone = 1 WHERE position = ?1");
  if (!mark) return tl::make_unexpected(mark.error());
  for (const std::uint64_t position : rebuilding.undone) {
    if (auto status = mark->Bind(position).Run(); !status) return status;
  }
  auto separate = Statement::Prepare(store.database(), "INSERT INTO separations VALUES(?1, ?2, ?3, ?4, ?5)");
  if (!separate) return tl::make_unexpected(separate.error());
  for (const auto& [first, second] : rebuilding.replay.separated()) {
    separate->Bind(std::string_view("undo")).Bind(first.session).Bind(first.counter);
    if (auto status = separate->Bind(second.session).Bind(second.counter).Run(); !status) return status;
  }
  return {};
}

// Snapshots that hold what was undone.
Status RemoveSnapshotsSince(Database& database, std::uint64_t position) {
  for (const char* sql : {"DELETE FROM snapshots WHERE position >= ?1",
                          "DELETE FROM snapshot_chunks WHERE snapshot NOT IN (SELECT id FROM snapshots) AND ?1 = ?1"}) {
    auto remove = Statement::Prepare(database, sql);
    if (!remove) return tl::make_unexpected(remove.error());
    if (auto status = remove->Bind(position).Run(); !status) return status;
  }
  return {};
}

Result<std::uint64_t> FirstPosition(Store& store, const std::string& cause) {
  const auto causes = ListCauses(store);
  if (!causes) return tl::make_unexpected(causes.error());
  for (const JournaledCause& entry : *causes) {
    if (entry.cause != cause) continue;
    if (!entry.undone) return entry.position;
    return Fail(ErrorCode::kRefused, cause + " was undone already");
  }
  return Fail(ErrorCode::kNotFound, "the journal has no '" + cause + "'; list what it has with --list");
}

}  // namespace

Result<std::vector<JournaledCause>> ListCauses(Store& store) {
  const auto oldest = store.database().Number("SELECT coalesce(min(position), 0) FROM snapshots");
  if (!oldest) return tl::make_unexpected(oldest.error());
  const auto begins = store.database().Number(R"(SELECT min(position) FROM
    (SELECT position FROM envelopes UNION ALL SELECT position FROM server_edits))");
  if (!begins) return tl::make_unexpected(begins.error());
  auto select = Statement::Prepare(
      store.database(),
      "SELECT cause, min(position), count(*), min(undone) FROM server_edits GROUP BY cause ORDER BY 2");
  if (!select) return tl::make_unexpected(select.error());
  std::vector<JournaledCause> causes;
  for (auto row = select->Step(); !row || *row; row = select->Step()) {
    if (!row) return tl::make_unexpected(row.error());
    JournaledCause cause{select->Text(0), select->Word(1), select->Word(2), select->Number(3) != 0, false};
    cause.reachable = *begins == 1 || static_cast<std::uint64_t>(*oldest) < cause.position;
    causes.push_back(std::move(cause));
  }
  return causes;
}

std::string Describe(const std::string& cause, const UndoReport& report) {
  std::ostringstream text;
  text << cause << " is undone";
  for (std::size_t i = 0; i < report.also.size(); ++i) {
    text << (i == 0 ? "\ntaken back with it, as built on it: " : ", ") << report.also[i];
  }
  for (const auto& [first, second] : report.separations) {
    text << "\nmaps " << ToString(first) << " and " << ToString(second) << " will not be merged again";
  }
  if (report.misfits > 0) {
    text << "\n" << report.misfits << " edits of agents made no sense without it and were left out";
  }
  return std::move(text).str();
}

Result<UndoReport> UndoCause(Store& store, const std::string& cause, std::int64_t now_unix_ns) {
  const auto first = FirstPosition(store, cause);
  if (!first) return tl::make_unexpected(first.error());
  auto beginning = LoadBeginning(store, *first);
  if (!beginning) return tl::make_unexpected(beginning.error());
  auto rebuilding = Rebuild(store, std::move(*beginning), cause);
  if (!rebuilding) return tl::make_unexpected(rebuilding.error());

  const std::uint64_t position = rebuilding->position + 1;
  Atlas atlas = rebuilding->replay.atlas();
  const std::vector<MapEdit> edits = SayAnew(rebuilding->replay, position);
  for (const MapEdit& edit : edits) {
    if (auto status = Apply(edit, atlas); !status) return tl::make_unexpected(status.error());
  }
  auto snapshots = SnapshotStore::Open(store.path(), 0);
  if (!snapshots) return tl::make_unexpected(snapshots.error());
  if (auto status = snapshots->StorePayloads(atlas, {}); !status) return tl::make_unexpected(status.error());

  auto transaction = Transaction::Begin(store.database());
  if (!transaction) return tl::make_unexpected(transaction.error());
  const std::string undo = "undo of " + cause;
  Status status = store.AppendServerEdits({{position, undo, EncodeEdits(edits)}});
  if (status) status = WriteDown(store, *rebuilding);
  if (status) status = RemoveSnapshotsSince(store.database(), *first);
  if (status) status = InsertSnapshot(store.database(), atlas, position, false, now_unix_ns, {});
  if (status) status = transaction->Commit();
  if (!status) return tl::make_unexpected(status.error());
  const UndoReplay& replay = rebuilding->replay;
  return UndoReport{position, {replay.also().begin(), replay.also().end()}, replay.separated(), replay.misfits()};
}

}  // namespace pangaea
