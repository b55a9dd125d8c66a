#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "common/map/atlas.h"
#include "common/map/forgetting.h"
#include "common/map/map_edit.h"

namespace pangaea {

// An agent that does at random what agents do: new keyframes every half second, landmarks, observations, moves,
// fusions, culling, lost maps. Everything it did since the last call of Take() is in `edits`.
class RandomHistory {
 public:
  // `keeps_roots`: the root of a map is neither moved nor removed, as local mapping does it.
  explicit RandomHistory(std::uint64_t seed, bool keeps_roots = false) : random_(seed), keeps_roots_(keeps_roots) {}

  const Atlas& atlas() const { return atlas_; }
  std::vector<MapEdit> Take() { return std::exchange(edits_, {}); }

  void Step() {
    const int choice = Below(100);
    if (choice < 12 || keyframes_.empty()) return NewKeyframe();
    if (choice < 35) return NewLandmark();
    if (choice < 60) return Observe();
    if (choice < 68) return Do(RemoveObservation{AnyLandmark(), AnyKeyframe()});
    if (choice < 76) return Move();
    if (choice < 84) return MovePoints();
    if (choice < 89) return Do(FuseLandmarks{AnyLandmark(), AnyLandmark()});
    if (choice < 93) return Frames();
    if (choice < 96) return Cull(AnyKeyframe());
    if (choice < 98) return Do(RemoveLandmark{AnyLandmark()});
    if (choice < 99) return Do(SetVergence{kSession, 0.002 * Uniform()});
    Do(CloseMap{{kSession, map_}});
    ++map_;
  }

  static constexpr SessionId kSession = 42;
  static constexpr int kKeypoints = 6;

  std::vector<ForgottenKeyframe> Forget(const std::vector<KeyframeId>& keyframes) {
    std::vector<ForgottenKeyframe> forgotten;
    for (const KeyframeId id : keyframes) forgotten.push_back({id, atlas_.FindKeyframe(id)->frames});
    pangaea::Forget(atlas_, forgotten);
    return forgotten;
  }
  KeyframeId newest() const { return {kSession, keyframe_counter_}; }

  // What the atlas refuses did not happen.
  void Do(MapEdit edit) {
    if (Apply(edit, atlas_)) edits_.push_back(std::move(edit));
  }

 private:
  int Below(int bound) { return static_cast<int>(random_() % static_cast<std::uint64_t>(bound)); }
  double Uniform() { return std::uniform_real_distribution<double>(-1.0, 1.0)(random_); }
  // Braces, unlike parentheses, draw in order.
  Eigen::Vector3d Vector(double size) { return size * Eigen::Vector3d{Uniform(), Uniform(), Uniform()}; }
  Rigid3d Motion(double size) { return Rigid3d{ExpSo3(Vector(size)), Vector(size)}; }
  // Mostly the newest, as in life.
  template <typename Tag>
  Id<Tag> Any(const std::vector<Id<Tag>>& ids) {
    if (ids.empty()) return {kSession, 1};
    const int range = Below(3) == 0 ? static_cast<int>(ids.size()) : std::min(8, static_cast<int>(ids.size()));
    return ids[ids.size() - 1 - static_cast<std::size_t>(Below(range))];
  }
  KeyframeId AnyKeyframe() { return Any(keyframes_); }
  LandmarkId AnyLandmark() { return Any(landmarks_); }

  void Cull(KeyframeId id) {
    const Keyframe* keyframe = atlas_.FindKeyframe(id);
    if (!keeps_roots_ || (keyframe != nullptr && keyframe->parent.valid())) Do(RemoveKeyframe{id});
  }
  void NewKeyframe() {
    auto data = std::make_shared<KeyframeData>();
    stamp_ns_ += 500'000'000;
    data->stamp_ns = stamp_ns_;
    data->camera = {640, 480, 400.0, 400.0, 320.0, 240.0, 0.1};
    data->features.keypoints.resize(kKeypoints);
    data->features.descriptors.resize(kKeypoints);
    const KeyframeId id{kSession, ++keyframe_counter_};
    const MapId map{kSession, map_};
    KeyframeId parent;
    if (atlas_.FindMap(map) != nullptr) {
      for (int attempt = 0; attempt < 50 && !parent.valid(); ++attempt) {
        const KeyframeId candidate = AnyKeyframe();
        const Keyframe* keyframe = atlas_.FindKeyframe(candidate);
        if (keyframe != nullptr && keyframe->map == map) parent = candidate;
      }
      if (!parent.valid()) return;
    }
    Do(AddKeyframe{id, map, parent, Motion(1.0), data});
    keyframes_.push_back(id);
  }
  void NewLandmark() {
    const LandmarkId id{kSession, ++landmark_counter_};
    landmarks_.push_back(id);
    Do(AddLandmark{id, AnyKeyframe(), static_cast<std::uint32_t>(Below(kKeypoints)),
                   Vector(2.0) + Eigen::Vector3d(0, 0, 5)});
  }
  void Observe() { Do(AddObservation{AnyLandmark(), AnyKeyframe(), static_cast<std::uint32_t>(Below(kKeypoints))}); }
  void Move() {
    MoveKeyframes edit;
    const double size = Below(2) == 0 ? 1e-4 : 0.05;
    for (int i = 0; i < 3; ++i) {
      const Keyframe* keyframe = atlas_.FindKeyframe(AnyKeyframe());
      if (keyframe == nullptr) continue;
      const Keyframe* parent = atlas_.FindKeyframe(keyframe->parent);
      if (parent == nullptr && keeps_roots_) continue;
      const Rigid3d camera_from_map = Motion(size) * keyframe->camera_from_map;
      edit.keyframes.push_back(
          {keyframe->id, parent == nullptr ? camera_from_map : camera_from_map * parent->camera_from_map.Inverse()});
    }
    Do(edit);
  }
  void MovePoints() {
    MoveLandmarks edit;
    for (int i = 0; i < 3; ++i) {
      const Landmark* landmark = atlas_.FindLandmark(AnyLandmark());
      if (landmark == nullptr) continue;
      const Rigid3d& camera_from_map = atlas_.FindKeyframe(landmark->reference)->camera_from_map;
      edit.landmarks.push_back({landmark->id, camera_from_map * (landmark->point_in_map + Vector(0.05))});
    }
    Do(edit);
  }
  void Frames() {
    AddFramePoses edit;
    for (int i = 1; i < 5; ++i) edit.frames.push_back({AnyKeyframe(), {stamp_ns_ + ++frame_ns_, Motion(0.5)}});
    Do(edit);
  }

  std::mt19937_64 random_;
  bool keeps_roots_;
  Atlas atlas_;
  std::vector<MapEdit> edits_;
  std::vector<KeyframeId> keyframes_;
  std::vector<LandmarkId> landmarks_;
  std::uint32_t keyframe_counter_ = 0;
  std::uint32_t landmark_counter_ = 0;
  std::uint32_t map_ = 1;
  std::int64_t stamp_ns_ = 1'000'000'000;
  std::int64_t frame_ns_ = 0;
};

}  // namespace pangaea
