#pragma once

#include <span>

#include "common/map/atlas.h"
#include "common/map/forgetting.h"
#include "common/map/map_edit.h"

namespace pangaea {

// The only door through which an atlas changes; Apply, Forget, ShareFrames and DecodeAtlas alone can open it. Each
// operation keeps both sides of the relations it touches in step and expects what it names to be alive: validate first.
class AtlasEditor {
 public:
  const Atlas& atlas() const { return atlas_; }

  // Ids alive only. The references are valid until the next operation.
  Keyframe& WriteKeyframe(KeyframeId id);
  Landmark& WriteLandmark(LandmarkId id);
  MapInfo& WriteMap(MapId id);

  // Enters a keyframe that observes nothing and has no children into its parent's children and its map's count. One
  // without a parent makes its map.
  void InsertKeyframe(Keyframe keyframe);
  void InsertLandmark(LandmarkId id, const Eigen::Vector3d& point_in_map, KeyframeId reference, std::uint32_t keypoint);
  // One with all its observers, whose covisibility is left to whoever inserts.
  void InsertObserved(Landmark landmark);
  // Links the two and counts the landmark in the keyframe's covisibility with its other observers.
  void Observe(LandmarkId landmark, KeyframeId keyframe, std::uint32_t keypoint);
  // The reverse. The last observation takes the landmark with it; a reference that goes is replaced by the observer of
  // the lowest id.
  void Unobserve(LandmarkId landmark, KeyframeId keyframe);
  void UnobserveAll(KeyframeId keyframe);
  void RemoveLandmark(LandmarkId id);
  // Two of one map become one: the observers of `absorbed`, which forwards from now on, observe `kept` in its stead.
  // Those that observe both go on with the keypoint of `kept`.
  void Fuse(LandmarkId kept, LandmarkId absorbed);
  void ForwardLandmark(LandmarkId id, LandmarkId absorber);  // of one that is gone
  void ForgetLandmark(LandmarkId id);                        // of one that never was: from now on it is gone

  // Hangs a keyframe below another, or below none.
  void SetParent(KeyframeId id, KeyframeId parent);
  // Takes out a keyframe that observes nothing and has no children; it forwards to its parent, and its loop
  // edges with it. The last of a map takes the map with it and is gone.
  void RemoveKeyframe(KeyframeId id);
  void WriteFormerKeyframe(KeyframeId id, const CulledKeyframe* culled);  // nullptr: gone
  // Takes what it saw. Landmarks that nobody else observes leave no trace.
  void ForgetKeyframe(KeyframeId id);
  // Gives one that was forgotten its features back; it observes nothing yet.
  void RecallKeyframe(KeyframeId id, std::shared_ptr<const KeyframeData> data);
  // Gives back the memory of landmark ids that live no more, where they are many; they leave no trace then. Not those
  // that were in use lately. With them go those that forward to what left no trace.
  void DropFormerLandmarks();
  void InsertFrames(KeyframeId id, std::span<const FramePose> frames);  // later ones replace earlier of their stamp
  void ForwardMap(MapId absorbed, MapId survivor);                      // takes `absorbed` from the living
  std::vector<LoopEdge>& WriteLoopEdges();
  void SetVersion(std::uint64_t version) { atlas_.version_ = version; }

 private:
  explicit AtlasEditor(Atlas& atlas) : atlas_(atlas) {}
  friend Status Apply(const MapEdit& edit, Atlas& atlas);
  friend void Forget(Atlas& atlas, std::span<const ForgottenKeyframe> keyframes);
  friend void ShareFrames(Atlas& atlas, const Atlas& twin);
  friend class AtlasDecoder;
  friend struct BrokenAtlas;  // of the consistency check's test

  Atlas::Part& WritePart(SessionId session);
  Atlas::KeyframeSlot& WriteSlot(KeyframeId id);
  Atlas::LandmarkSlot& WriteSlot(LandmarkId id);
  void CountKeyframe(const Keyframe& keyframe, int change);
  void CountLandmark(LandmarkId id, MapId map, int change);
  void EraseLandmark(LandmarkId id, MapId map);
  Observation TakeObservation(LandmarkId landmark, KeyframeId keyframe);  // from the side of the landmark alone
  void RehangLoopEdges(KeyframeId id, const CulledKeyframe& culled);
  void DropForwardsToNothing();
  // Of each pair of one of these and one of the others; both ascend and have none in common.
  void ChangeCovisibility(std::span<const Observation> some, std::span<const Observation> others, int change);

  Atlas& atlas_;
};

}  // namespace pangaea
