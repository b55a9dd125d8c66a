#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "common/base/result.h"
#include "common/wire/session_announcement.h"

namespace pangaea {

// The camera rig of a session (ideal camera and body_from_camera) as the octets of the column sessions.rig.
std::vector<std::byte> EncodeRig(const SessionAnnouncement& announcement);
// kCorrupt for octets of another length.
Status DecodeRig(std::span<const std::byte> bytes, SessionAnnouncement& announcement);

}  // namespace pangaea
