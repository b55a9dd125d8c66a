#include "common/map/digest.h"

#include <algorithm>
#include <cmath>

#include "common/base/bytes.h"
#include "common/base/hash.h"
#include "common/map/forgetting.h"

namespace pangaea {
namespace {

class DigestWriter {
 public:
  void Add(const Keyframe& keyframe) {
    AddId(keyframe.id);
    AddId(keyframe.map);
    AddPose(keyframe);
  }

  void Add(const Landmark& landmark) {
    AddPoint(landmark);
    bytes_.Word(static_cast<std::uint64_t>(landmark.observations.size()));
    for (const Observation& observation : landmark.observations) {
      AddId(observation.keyframe);
      bytes_.Word(observation.keypoint);
    }
  }

  // As far as both sides know it: the server may have merged the map into another, and others may observe the landmark.
  void AddOfSession(const Keyframe& keyframe, bool forgotten) {
    AddId(keyframe.id);
    AddPose(keyframe);
    if (forgotten) return;
    for (const LandmarkId landmark : keyframe.landmarks) AddId(landmark);
  }
  void AddOfSession(const Landmark& landmark) { AddPoint(landmark); }

  std::uint64_t Finish() const { return Hash64(bytes_.bytes()); }

 private:
  void AddPose(const Keyframe& keyframe) {
    const Rigid3d map_from_camera = keyframe.camera_from_map.Inverse();
    AddQuantized(map_from_camera.translation(), kDigestLength);
    // Two columns determine the third. Unlike the quaternion they do not jump at half a turn.
    const Eigen::Matrix3d rotation = map_from_camera.rotation().toRotationMatrix();
    AddQuantized(rotation.col(0), kDigestRotation);
    AddQuantized(rotation.col(1), kDigestRotation);
  }

  void AddPoint(const Landmark& landmark) {
    AddId(landmark.id);
    AddQuantized(landmark.point_in_map, kDigestLength);
  }
  template <typename Tag>
  void AddId(const Id<Tag>& id) {
    bytes_.Word(id.session);
    bytes_.Word(id.counter);
  }
  void AddQuantized(const Eigen::Vector3d& vector, double quantum) {
    for (const double value : {vector.x(), vector.y(), vector.z()}) {
      bytes_.Word(static_cast<std::int64_t>(std::llround(value / quantum)));
    }
  }

  ByteWriter bytes_;
};

}  // namespace

std::uint64_t Digest(const Atlas& atlas, std::optional<MapId> map) {
  DigestWriter digest;
  atlas.ForEachKeyframe([&](const Keyframe& keyframe) {
    if (!map || keyframe.map == *map) digest.Add(keyframe);
  });
  atlas.ForEachLandmark([&](const Landmark& landmark) {
    if (!map || atlas.MapOf(landmark) == *map) digest.Add(landmark);
  });
  return digest.Finish();
}

std::uint64_t DigestOfSession(const Atlas& atlas, SessionId session, const std::set<KeyframeId>& forgotten) {
  DigestWriter digest;
  atlas.ForEachKeyframe(session, [&](const Keyframe& keyframe) {
    digest.AddOfSession(keyframe, IsForgotten(keyframe) || forgotten.contains(keyframe.id));
  });
  // An agent that does not hold the keyframes of others that see it cannot know the landmark.
  const auto is_observer = [&](const Observation& observation) {
    return observation.keyframe.session == session && !forgotten.contains(observation.keyframe);
  };
  atlas.ForEachLandmark(session, [&](const Landmark& landmark) {
    if (std::ranges::any_of(landmark.observations, is_observer)) digest.AddOfSession(landmark);
  });
  return digest.Finish();
}

}  // namespace pangaea
