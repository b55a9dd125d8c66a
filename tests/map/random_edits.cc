#include "tests/map/random_edits.h"

#include "tests/map/small_world.h"

namespace pangaea {
namespace {

// Few, so that landmarks are often seen from the same keyframe and keypoints are often taken.
constexpr std::uint32_t kKeypoints = 12;

}  // namespace

SessionId RandomEdits::AnySession() { return Below(2) == 0 ? kAnna : kBert; }

KeyframeId RandomEdits::AnyKeyframe() {
  if (keyframes_.empty() || Below(50) == 0) return {AnySession(), 1000 + Below(1000)};
  return keyframes_[Below(static_cast<std::uint32_t>(keyframes_.size()))];
}

LandmarkId RandomEdits::AnyLandmark() {
  if (landmarks_.empty() || Below(50) == 0) return {AnySession(), 1000 + Below(1000)};
  return landmarks_[Below(static_cast<std::uint32_t>(landmarks_.size()))];
}

MapId RandomEdits::AnyMap() {
  if (maps_.empty() || Below(50) == 0) return {AnySession(), 1000 + Below(1000)};
  return maps_[Below(static_cast<std::uint32_t>(maps_.size()))];
}

Rigid3d RandomEdits::AnyPose() {
  Vector6d twist;
  for (double& value : twist) value = Uniform(-1.0, 1.0);
  return Rigid3d::Exp(twist);
}

Eigen::Vector3d RandomEdits::AnyPoint() {
  const double depth = Below(30) == 0 ? -1.0 : Uniform(0.5, 20.0);
  return {Uniform(-5.0, 5.0), Uniform(-5.0, 5.0), depth};
}

AddKeyframe RandomEdits::MakeKeyframe(const Atlas& atlas) {
  AddKeyframe edit;
  edit.id = {AnySession(), static_cast<std::uint32_t>(keyframes_.size()) + 1};
  keyframes_.push_back(edit.id);
  edit.camera_from_parent = AnyPose();
  auto data = std::make_shared<KeyframeData>(*MakeData(kKeypoints, stamp_ns_ += 10));
  if (Below(2) == 0) data->arrival = {AnyKeyframe(), AnyPose(), 1.0, stamp_ns_ - 20};
  edit.data = std::move(data);
  edit.parent_scale = AnyScale();
  if (keyframes_.size() < 2 || Below(10) == 0) {
    edit.map = {edit.id.session, static_cast<std::uint32_t>(maps_.size()) + 1};
    maps_.push_back(edit.map);
    return edit;
  }
  edit.parent = AnyKeyframe();
  const Keyframe* parent = atlas.FindKeyframe(atlas.Resolve(edit.parent));
  edit.map = parent == nullptr ? AnyMap() : parent->map;
  return edit;
}

AddFramePoses RandomEdits::MakeFrames() {
  AddFramePoses edit;
  for (std::uint32_t i = Below(4); i > 0; --i) {
    const Rigid3d pose = AnyPose();
    edit.frames.push_back(
        {AnyKeyframe(), {stamp_ns_ += 1, Below(2) == 0 ? pose : QuantizeFramePose(pose)}, AnyScale()});
  }
  return edit;
}

MoveKeyframes RandomEdits::MakeMove() {
  MoveKeyframes edit;
  if (Below(3) == 0) edit.correction = ++corrections_;
  for (std::uint32_t i = Below(5); i > 0; --i) {
    MovedKeyframe moved{AnyKeyframe(), AnyPose(), Below(2) == 0 ? AnyKeyframe() : KeyframeId{}, AnyScale()};
    if (edit.correction != 0 && Below(2) == 0) moved.scale = Uniform(0.5, 2.0);
    edit.keyframes.push_back(moved);
  }
  return edit;
}

ReferenceScale RandomEdits::AnyScale() { return {Below(2) == 0 ? 0.0 : Uniform(0.5, 2.0)}; }

MergeMaps RandomEdits::MakeMerge(const Atlas& atlas) {
  const Keyframe* survivor = atlas.FindKeyframe(atlas.Resolve(AnyKeyframe()));
  const Keyframe* absorbed = atlas.FindKeyframe(atlas.Resolve(AnyKeyframe()));
  if (survivor == nullptr || absorbed == nullptr) return {AnyMap(), AnyMap(), {}, AnyKeyframe(), AnyKeyframe()};
  const Rigid3d pose = AnyPose();
  const Similarity3d motion(Uniform(0.5, 2.0), pose.rotation(), pose.translation());
  return {survivor->map, absorbed->map, motion, absorbed->id, survivor->id, Below(2) == 0 ? ++corrections_ : 0};
}

void RandomEdits::Adopt(const Atlas& atlas) {
  atlas.ForEachKeyframe([&](const Keyframe& keyframe) { keyframes_.push_back(keyframe.id); });
  atlas.ForEachLandmark([&](const Landmark& landmark) { landmarks_.push_back(landmark.id); });
  const std::vector<MapId> maps = atlas.Maps();
  maps_.insert(maps_.end(), maps.begin(), maps.end());
}

MapEdit RandomEdits::Next(const Atlas& atlas) {
  const std::uint32_t draw = Below(100);
  if (keyframes_.empty() || draw < 15) return MakeKeyframe(atlas);
  if (draw < 35) {
    landmarks_.push_back({AnySession(), static_cast<std::uint32_t>(landmarks_.size()) + 1});
    return AddLandmark{landmarks_.back(), AnyKeyframe(), Below(kKeypoints), AnyPoint(), AnyScale()};
  }
  if (draw < 65) return AddObservation{AnyLandmark(), AnyKeyframe(), Below(kKeypoints)};
  if (draw < 70) return RemoveObservation{AnyLandmark(), AnyKeyframe()};
  if (draw < 75) return MakeFrames();
  if (draw < 80) return MakeMove();
  if (draw < 84)
    return MoveLandmarks{{{AnyLandmark(), AnyPoint(), AnyKeyframe(), AnyScale()}, {AnyLandmark(), AnyPoint()}}};
  if (draw < 90) return FuseLandmarks{AnyLandmark(), AnyLandmark()};
  if (draw < 93) return RemoveKeyframe{AnyKeyframe()};
  if (draw < 95) return RemoveLandmark{AnyLandmark()};
  if (draw < 97) return AddLoopEdge{AnyKeyframe(), AnyKeyframe(), Similarity3d(AnyPose())};
  if (draw < 99) return MakeMerge(atlas);
  const std::uint32_t rare = Below(4);
  if (rare == 0) return CloseMap{AnyMap()};
  if (rare == 1) return SetVergence{AnySession(), Uniform(-0.15, 0.15)};
  return RemoveLandmark{AnyLandmark()};
}

}  // namespace pangaea
