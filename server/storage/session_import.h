#pragma once

#include <cstdint>
#include <span>

#include "common/base/result.h"
#include "common/map/edits/edits.h"
#include "common/wire/session_announcement.h"
#include "server/storage/store.h"

namespace pangaea {

// Makes a session that is complete a part of the store, as if its agent had sent it: the edits are judged against the
// atlas and journaled as envelopes in one transaction, all or nothing. The session is closed afterwards. A server that
// starts on the store later looks its keyframes up like any other's. kRefused for a session that the store knows; else
// what is wrong with an edit, or with the store.
Status ImportSession(Store& store, const SessionAnnouncement& session, std::span<const MapEdit> edits,
                     std::int64_t now_unix_ns);

}  // namespace pangaea
