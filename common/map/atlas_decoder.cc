#include "common/map/atlas_decoder.h"

#include <algorithm>
#include <set>
#include <utility>

#include "common/map/edits/reference_scale.h"
#include "common/map/frame_pose.h"
#include "common/map/validation.h"

namespace pangaea {
namespace {

Status Corrupt(const std::string& what) { return Fail(ErrorCode::kCorrupt, "stored atlas: " + what); }

// Whether following the arrows from anywhere comes to an end.
template <typename AnyId>
bool EndsEverywhere(const std::map<AnyId, AnyId>& next) {
  std::set<AnyId> ending;
  for (const auto& [start, unused] : next) {
    std::set<AnyId> path;
    AnyId id = start;
    while (next.contains(id) && !ending.contains(id)) {
      if (!path.insert(id).second) return false;
      id = next.at(id);
    }
    ending.merge(path);
  }
  return true;
}

}  // namespace

Status AtlasDecoder::Run() {
  format_ = bytes_.Word<std::uint8_t>();
  if (bytes_.ok() && (format_ == 0 || format_ > kAtlasFormat)) {
    return Fail(ErrorCode::kUnsupported, "stored atlas: unknown format " + std::to_string(format_));
  }
  const std::uint64_t version = bytes_.Varint();
  using Part = Status (AtlasDecoder::*)();
  for (const Part read :
       {&AtlasDecoder::ReadKeyframes, &AtlasDecoder::ReadFormerKeyframes, &AtlasDecoder::ReadMaps,
        &AtlasDecoder::ReadLandmarks, &AtlasDecoder::ReadFormerLandmarks, &AtlasDecoder::ReadLoopEdges}) {
    if (auto status = (this->*read)(); !status) return status;
    if (!bytes_.ok()) return Corrupt("truncated or malformed");
  }
  if (bytes_.remaining() != 0) return Corrupt("followed by something else");
  editor_.SetVersion(version);
  return {};
}

Status AtlasDecoder::ReadKeyframes() {
  constexpr std::size_t kMinBytes = 4 + 7 * sizeof(double);
  ByParent by_parent;
  std::set<KeyframeId> seen;
  const std::size_t count = bytes_.Count(kMinBytes);
  for (std::size_t i = 0; i < count; ++i) {
    auto keyframe = ReadKeyframe();
    if (!keyframe) return tl::make_unexpected(keyframe.error());
    if (!seen.insert(keyframe->id).second) return Corrupt("keyframe " + ToString(keyframe->id) + " twice");
    by_parent[keyframe->parent].push_back(std::move(*keyframe));
  }
  if (auto status = InsertTrees(by_parent); !status) return status;
  return atlas_.keyframe_count() == count ? Status{} : Corrupt("a keyframe hangs below none that is rooted");
}

Result<Keyframe> AtlasDecoder::ReadKeyframe() {
  Keyframe keyframe;
  keyframe.id = reader_.ReadId<KeyframeTag>();
  keyframe.map = reader_.ReadId<MapTag>();
  keyframe.parent = reader_.ReadId<KeyframeTag>();
  keyframe.camera_from_map = reader_.ReadRigid();
  if (format_ >= 2) {
    keyframe.corrected_at = bytes_.Varint();
    keyframe.scale = ReadScale(reader_).value;
  }
  if (auto status = ReadFrames(keyframe); !status) return tl::make_unexpected(status.error());
  if (!bytes_.ok()) return Fail(ErrorCode::kCorrupt, "stored atlas: truncated or malformed keyframe");
  if (auto status = CheckNewId(keyframe.id); !status) return tl::make_unexpected(status.error());
  if (auto status = CheckNewId(keyframe.map); !status) return tl::make_unexpected(status.error());
  auto data = data_(keyframe.id);
  if (!data) return tl::make_unexpected(data.error());
  if (*data == nullptr || !keyframe.camera_from_map.AllFinite() || !IsTotalScale(keyframe.scale)) {
    return Fail(ErrorCode::kCorrupt, "stored atlas: keyframe " + ToString(keyframe.id) + " without data or pose");
  }
  if (auto status = CheckKeyframeData(**data); !status) return tl::make_unexpected(status.error());
  keyframe.landmarks.resize((*data)->features.keypoints.size());
  keyframe.data = std::move(*data);
  return keyframe;
}

Status AtlasDecoder::ReadFrames(Keyframe& keyframe) {
  const std::size_t count = bytes_.Count(1 + kMinFramePoseBytes);
  if (count == 0) return {};
  auto frames = std::make_shared<std::vector<FramePose>>();
  for (std::size_t i = 0; i < count; ++i) {
    const SessionId session = reader_.ReadId<KeyframeTag>().session;
    FramePose frame = ReadFramePose(reader_);
    frame.session = session;
    const bool later = frames->empty() || std::pair(frames->back().stamp_ns, frames->back().session) <
                                              std::pair(frame.stamp_ns, frame.session);
    if (!later || !frame.reference_from_frame.AllFinite()) return Corrupt("frames out of order or not finite");
    frames->push_back(frame);
  }
  keyframe.frames = std::move(frames);
  return {};
}

Status AtlasDecoder::InsertTrees(ByParent& by_parent) {
  std::vector<KeyframeId> parents = {KeyframeId{}};
  for (std::size_t next = 0; next < parents.size(); ++next) {
    const KeyframeId parent = parents[next];
    for (Keyframe& keyframe : by_parent[parent]) {
      const MapId expected = parent.valid() ? atlas_.FindKeyframe(parent)->map : keyframe.map;
      const bool second_root = !parent.valid() && atlas_.FindMap(keyframe.map) != nullptr;
      if (second_root || keyframe.map != expected) {
        return Corrupt("keyframe " + ToString(keyframe.id) + " is a second root or in another map than its parent");
      }
      parents.push_back(keyframe.id);
      editor_.InsertKeyframe(std::move(keyframe));
    }
  }
  return {};
}

Status AtlasDecoder::ReadFormerKeyframes() {
  std::map<KeyframeId, KeyframeId> forward;
  const std::size_t count = bytes_.Count(2);
  for (std::size_t i = 0; i < count; ++i) {
    const auto id = reader_.ReadId<KeyframeTag>();
    const auto parent = reader_.ReadId<KeyframeTag>();
    const Rigid3d parent_from_culled = parent.valid() ? reader_.ReadRigid() : Rigid3d();
    if (!bytes_.ok() || !CheckNewId(id) || atlas_.Knows(id) || !parent_from_culled.AllFinite()) {
      return Corrupt("a culled keyframe that cannot be: " + ToString(id));
    }
    const CulledKeyframe culled{parent, parent_from_culled};
    editor_.WriteFormerKeyframe(id, parent.valid() ? &culled : nullptr);
    if (parent.valid()) forward[id] = parent;
  }
  for (const auto& [id, parent] : forward) {
    if (!atlas_.Knows(parent)) return Corrupt("keyframe " + ToString(id) + " forwards to nothing");
  }
  return EndsEverywhere(forward) ? Status{} : Corrupt("culled keyframes forward in a circle");
}

Status AtlasDecoder::ReadMaps() {
  const std::size_t closed = bytes_.Count(2);
  for (std::size_t i = 0; i < closed; ++i) {
    const auto id = reader_.ReadId<MapTag>();
    if (atlas_.FindMap(id) == nullptr) return Corrupt("closed map " + ToString(id) + " is not there");
    editor_.WriteMap(id).closed = true;
  }
  std::map<MapId, MapId> forward;
  const std::size_t merged = bytes_.Count(4);
  for (std::size_t i = 0; i < merged; ++i) {
    const auto absorbed = reader_.ReadId<MapTag>();
    const auto survivor = reader_.ReadId<MapTag>();
    if (!bytes_.ok() || atlas_.FindMap(absorbed) != nullptr || !forward.emplace(absorbed, survivor).second) {
      return Corrupt("map " + ToString(absorbed) + " is alive and merged");
    }
    editor_.ForwardMap(absorbed, survivor);
  }
  return EndsEverywhere(forward) ? Status{} : Corrupt("merged maps forward in a circle");
}

Status AtlasDecoder::ReadLandmarks() {
  constexpr std::size_t kMinBytes = 4 + 3 * sizeof(double) + 1 + 3;
  const std::size_t count = bytes_.Count(kMinBytes);
  for (std::size_t i = 0; i < count; ++i) {
    if (auto status = ReadLandmark(); !status) return status;
  }
  covisibility_.ForEach([this](KeyframeId id, std::vector<Covisibility> covisible) {
    editor_.WriteKeyframe(id).covisible = std::move(covisible);
  });
  return {};
}

Status AtlasDecoder::ReadLandmark() {
  Landmark landmark;
  landmark.id = reader_.ReadId<LandmarkTag>();
  landmark.reference = reader_.ReadId<KeyframeTag>();
  landmark.point_in_map = reader_.ReadPoint();
  landmark.observations.resize(bytes_.Count(3));
  for (Observation& observation : landmark.observations) {
    observation.keyframe = reader_.ReadId<KeyframeTag>();
    observation.keypoint = reader_.ReadCounter();
  }
  if (!bytes_.ok()) return Corrupt("truncated or malformed landmark");
  return InsertLandmark(std::move(landmark));
}

Status AtlasDecoder::InsertLandmark(Landmark landmark) {
  const auto& observations = landmark.observations;
  const auto reference = std::find_if(observations.begin(), observations.end(),
                                      [&](const Observation& o) { return o.keyframe == landmark.reference; });
  const Keyframe* reference_keyframe = atlas_.FindKeyframe(landmark.reference);
  const bool possible = CheckNewId(landmark.id) && !atlas_.Knows(landmark.id) && landmark.point_in_map.allFinite();
  if (!possible || reference == observations.end() || reference_keyframe == nullptr) {
    return Corrupt("a landmark that cannot be: " + ToString(landmark.id));
  }
  const MapId map = reference_keyframe->map;
  KeyframeId last;
  for (const Observation& observation : observations) {
    const Keyframe* keyframe = atlas_.FindKeyframe(observation.keyframe);
    const bool sound = keyframe != nullptr && keyframe->map == map && last < observation.keyframe &&
                       CheckFreeKeypoint(*keyframe, observation.keypoint);
    if (!sound) return Corrupt("an observation that cannot be, of landmark " + ToString(landmark.id));
    last = observation.keyframe;
  }
  covisibility_.Add(observations);
  editor_.InsertObserved(std::move(landmark));
  return {};
}

Status AtlasDecoder::ReadFormerLandmarks() {
  std::map<LandmarkId, LandmarkId> forward;
  const std::size_t count = bytes_.Count(2);
  for (std::size_t i = 0; i < count; ++i) {
    const auto id = reader_.ReadId<LandmarkTag>();
    const auto absorber = reader_.ReadId<LandmarkTag>();
    if (!bytes_.ok() || !CheckNewId(id) || atlas_.Knows(id)) return Corrupt("a fused landmark that cannot be");
    editor_.ForgetLandmark(id);
    if (absorber.valid()) forward[id] = absorber;
  }
  if (!EndsEverywhere(forward)) return Corrupt("fused landmarks forward in a circle");
  for (const auto& [id, absorber] : forward) {
    if (!atlas_.Knows(absorber)) return Corrupt("landmark " + ToString(id) + " forwards to nothing");
    editor_.ForwardLandmark(id, absorber);
  }
  return {};
}

Status AtlasDecoder::ReadLoopEdges() {
  constexpr std::size_t kMinBytes = 4 + 8 * sizeof(double);
  const std::size_t count = bytes_.Count(kMinBytes);
  for (std::size_t i = 0; i < count; ++i) {
    const auto from = reader_.ReadId<KeyframeTag>();
    const auto to = reader_.ReadId<KeyframeTag>();
    const Similarity3d to_from_from = reader_.ReadSimilarity();
    const Keyframe* a = atlas_.FindKeyframe(from);
    const Keyframe* b = atlas_.FindKeyframe(to);
    const bool sound = a != nullptr && b != nullptr && a != b && a->map == b->map && to_from_from.AllFinite();
    if (!bytes_.ok() || !sound) return Corrupt("a loop edge that cannot be");
    editor_.WriteLoopEdges().push_back({from, to, to_from_from});
  }
  return {};
}

}  // namespace pangaea
