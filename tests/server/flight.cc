#include "tests/server/flight.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/map/small_world.h"

namespace pangaea {

std::vector<MapEdit> Flight::NextEdits() {
  const KeyframeId id{session_, ++keyframes_};
  const KeyframeId parent = keyframes_ == 1 ? KeyframeId{} : KeyframeId{session_, keyframes_ - 1};
  const Rigid3d camera_from_parent = MakePose(0.01, 0.1, 0.0, 0.3);
  std::vector<MapEdit> edits{
      AddKeyframe{id, {session_, 1}, parent, camera_from_parent, MakeData(shape_.keypoints, keyframes_ * 1000)}};
  // The newest landmarks are seen again at the first keypoints; the next ones make new landmarks.
  const std::uint32_t observed = std::min(shape_.observed, landmarks_);
  for (std::uint32_t i = 0; i < observed; ++i) edits.push_back(AddObservation{{session_, landmarks_ - i}, id, i});
  for (std::uint32_t i = observed; i < observed + shape_.created; ++i) {
    edits.push_back(AddLandmark{{session_, ++landmarks_}, id, i, {0.001 * i, 0.002 * i, 4.0}});
  }
  return edits;
}

Envelope Flight::Next() {
  const std::vector<MapEdit> edits = NextEdits();
  for (const MapEdit& edit : edits) {
    const Status applied = Apply(edit, atlas_);
    EXPECT_TRUE(applied) << applied.error().message;
  }
  return NextWith(edits);
}

Envelope Flight::NextWith(const std::vector<MapEdit>& edits) { return MakeEnvelope(session_, ++sequence_, 0, edits); }

SessionAnnouncement Flight::Announcement(const std::string& site) const {
  SessionAnnouncement announcement;
  announcement.session = session_;
  announcement.name = "agent-" + std::to_string(session_);
  announcement.site = site;
  announcement.ideal_camera = {752, 480, 400.0, 400.0, 376.0, 240.0, 0.11};
  announcement.body_from_camera = MakePose(0.5, 0.1, 0.2, 0.3);
  announcement.software_version = "0.1.0";
  announcement.wire_version = kWireVersion;
  return announcement;
}

}  // namespace pangaea
