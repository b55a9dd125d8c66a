#include "server/storage/session_import.h"

#include <algorithm>
#include <string>

#include "common/map/map_edit.h"
#include "common/wire/edit_packing.h"
#include "common/wire/envelope.h"
#include "server/ingest/agent_edit.h"
#include "server/storage/recovery.h"

namespace pangaea {
namespace {

Status Judge(std::span<const MapEdit> edits, SessionId session, Atlas& atlas) {
  for (const MapEdit& edit : edits) {
    if (!TouchesOnly(edit, session)) {
      return Fail(ErrorCode::kRefused, std::string(KindName(edit)) + ": concerns another session");
    }
    if (auto status = ApplyAgentEdit(edit, atlas); !status) return status;
  }
  return {};
}

}  // namespace

Status ImportSession(Store& store, const SessionAnnouncement& session, std::span<const MapEdit> edits,
                     std::int64_t now_unix_ns) {
  auto recovered = RecoverAtlas(store);
  if (!recovered) return tl::make_unexpected(recovered.error());
  const auto is_it = [&session](const SessionRecord& record) { return record.announcement.session == session.session; };
  if (std::ranges::any_of(recovered->sessions, is_it)) {
    return Fail(ErrorCode::kRefused, "the store has a session " + ToString(session.session) + " already");
  }
  if (auto status = Judge(edits, session.session, recovered->atlas); !status) return status;
  JournalBatch batch;
  for (const auto run : PackEdits(edits, kEnvelopeBytes)) {
    const std::uint64_t sequence = batch.entries.size() + 1;
    batch.entries.push_back({recovered->position + sequence, MakeEnvelope(session.session, sequence, 0, run)});
  }
  SessionRecord record{.announcement = session, .joined_unix_ns = now_unix_ns, .acknowledged = batch.entries.size()};
  record.announcement.closed = true;
  batch.sessions.push_back(std::move(record));
  return store.Append(batch);
}

}  // namespace pangaea
