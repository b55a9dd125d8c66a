#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/map/atlas.h"
#include "common/map/map_edit.h"
#include "common/wire/envelope.h"
#include "common/wire/session_announcement.h"

namespace pangaea {

// What one keyframe of a flight has.
struct FlightShape {
  std::size_t keypoints = 40;
  std::uint32_t observed = 20;  // landmarks of older keyframes
  std::uint32_t created = 20;   // new ones
};

// What an agent would send of a flight along a corridor: envelope after envelope, each with one keyframe, its new
// landmarks and its observations of older ones. The same for the same session.
class Flight {
 public:
  explicit Flight(SessionId session, const FlightShape& shape = {}) : session_(session), shape_(shape) {}

  // Makes the next envelope and applies its edits to atlas().
  Envelope Next();
  // Edits of the caller's own, under the next number; not applied.
  Envelope NextWith(const std::vector<MapEdit>& edits);

  SessionAnnouncement Announcement(const std::string& site) const;
  SessionId session() const { return session_; }
  // As the server's should be.
  const Atlas& atlas() const { return atlas_; }

 private:
  std::vector<MapEdit> NextEdits();

  SessionId session_;
  FlightShape shape_;
  std::uint64_t sequence_ = 0;
  std::uint32_t keyframes_ = 0;
  std::uint32_t landmarks_ = 0;
  Atlas atlas_;
};

}  // namespace pangaea
