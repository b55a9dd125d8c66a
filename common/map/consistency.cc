#include "common/map/consistency.h"

#include <algorithm>
#include <map>

#include "common/map/spanning_tree.h"
#include "common/map/validation.h"

namespace pangaea {
namespace {

// So that an atlas that is wrong throughout does not fill the memory with complaints.
constexpr std::size_t kMaxFaults = 100;

class Checker {
 public:
  explicit Checker(const Atlas& atlas) : atlas_(atlas) {}

  std::vector<std::string> Run() {
    atlas_.ForEachKeyframe([&](const Keyframe& keyframe) { CheckKeyframe(keyframe); });
    atlas_.ForEachLandmark([&](const Landmark& landmark) { CheckLandmark(landmark); });
    if (faults_.empty()) CheckTrees();
    CheckCounts();
    CheckForwarding();
    for (const LoopEdge& edge : atlas_.loop_edges()) CheckLoopEdge(edge);
    return std::move(faults_);
  }

 private:
  template <typename AnyId>
  void Expect(bool holds, const char* kind, const AnyId& id, const char* fault) {
    if (!holds && faults_.size() < kMaxFaults) faults_.push_back(std::string(kind) + " " + ToString(id) + ": " + fault);
  }
  void Expect(bool holds, KeyframeId id, const char* fault) { Expect(holds, "keyframe", id, fault); }
  void Expect(bool holds, LandmarkId id, const char* fault) { Expect(holds, "landmark", id, fault); }
  void Expect(bool holds, MapId id, const char* fault) { Expect(holds, "map", id, fault); }

  void CheckKeyframe(const Keyframe& keyframe) {
    ++keyframes_of_map_[keyframe.map];
    Expect(atlas_.FindKeyframe(keyframe.id) == &keyframe, keyframe.id, "is not found under its id");
    Expect(atlas_.FindMap(keyframe.map) != nullptr, keyframe.id, "its map is not alive");
    Expect(keyframe.camera_from_map.AllFinite(), keyframe.id, "its pose is not finite");
    Expect(IsTotalScale(keyframe.scale), keyframe.id, "its scale is out of range");
    Expect(keyframe.data != nullptr, keyframe.id, "it has no data");
    if (keyframe.data == nullptr) return;
    Expect(keyframe.landmarks.size() == keyframe.data->features.keypoints.size(), keyframe.id,
           "landmarks and keypoints differ in number");
    CheckPlaceInTree(keyframe);
    CheckObserved(keyframe);
    CheckFrames(keyframe);
  }

  void CheckPlaceInTree(const Keyframe& keyframe) {
    Expect(std::is_sorted(keyframe.children.begin(), keyframe.children.end()), keyframe.id, "children are not sorted");
    for (const KeyframeId id : keyframe.children) {
      const Keyframe* child = atlas_.FindKeyframe(id);
      const bool mutual = child != nullptr && child->parent == keyframe.id && child->map == keyframe.map;
      Expect(mutual, keyframe.id, "a child is not alive, in another map or under another parent");
    }
    if (!keyframe.parent.valid()) {
      const MapInfo* map = atlas_.FindMap(keyframe.map);
      return Expect(map != nullptr && map->root == keyframe.id, keyframe.id, "has no parent and is no root");
    }
    const Keyframe* parent = atlas_.FindKeyframe(keyframe.parent);
    Expect(parent != nullptr && std::binary_search(parent->children.begin(), parent->children.end(), keyframe.id),
           keyframe.id, "its parent is not alive or does not know it");
  }

  // The keypoints' landmarks know them, and covisibility is what they give.
  void CheckObserved(const Keyframe& keyframe) {
    std::map<KeyframeId, std::uint32_t> weights;
    for (std::size_t keypoint = 0; keypoint < keyframe.landmarks.size(); ++keypoint) {
      if (!keyframe.landmarks[keypoint].valid()) continue;
      const Landmark* landmark = atlas_.FindLandmark(keyframe.landmarks[keypoint]);
      Expect(landmark != nullptr, keyframe.id, "observes a landmark that is not alive");
      if (landmark == nullptr) continue;
      const Observation expected{keyframe.id, static_cast<std::uint32_t>(keypoint)};
      const auto& all = landmark->observations;
      Expect(std::count(all.begin(), all.end(), expected) == 1, keyframe.id,
             "a landmark does not know its observation");
      for (const Observation& observation : all) ++weights[observation.keyframe];
    }
    weights.erase(keyframe.id);
    std::vector<Covisibility> covisible;
    for (const auto& [id, weight] : weights) covisible.push_back({id, weight});
    Expect(covisible == keyframe.covisible, keyframe.id, "covisibility differs from what its landmarks give");
  }

  void CheckFrames(const Keyframe& keyframe) {
    if (!keyframe.frames) return;
    const auto not_ascending = [](const FramePose& a, const FramePose& b) {
      return std::pair(a.stamp_ns, a.session) >= std::pair(b.stamp_ns, b.session);
    };
    const auto& frames = *keyframe.frames;
    Expect(std::adjacent_find(frames.begin(), frames.end(), not_ascending) == frames.end(), keyframe.id,
           "frames are not ascending by stamp");
    const bool finite = std::all_of(frames.begin(), frames.end(),
                                    [](const FramePose& f) { return f.reference_from_frame.AllFinite(); });
    Expect(finite, keyframe.id, "a frame's pose is not finite");
  }

  void CheckLandmark(const Landmark& landmark) {
    ++landmarks_of_map_[atlas_.MapOf(landmark)];
    Expect(atlas_.FindLandmark(landmark.id) == &landmark, landmark.id, "is not found under its id");
    Expect(landmark.point_in_map.allFinite(), landmark.id, "its position is not finite");
    Expect(!landmark.observations.empty(), landmark.id, "has no observation");
    bool reference_observes = false;
    KeyframeId last;
    for (const Observation& observation : landmark.observations) {
      Expect(last < observation.keyframe, landmark.id, "observations are not ascending by keyframe");
      last = observation.keyframe;
      reference_observes = reference_observes || observation.keyframe == landmark.reference;
      const Keyframe* keyframe = atlas_.FindKeyframe(observation.keyframe);
      const bool mutual = keyframe != nullptr && observation.keypoint < keyframe->landmarks.size() &&
                          keyframe->landmarks[observation.keypoint] == landmark.id;
      Expect(mutual, landmark.id, "an observer is not alive or does not know it");
      Expect(keyframe == nullptr || keyframe->map == atlas_.MapOf(landmark), landmark.id, "observed from two maps");
    }
    Expect(reference_observes, landmark.id, "its reference is no observer");
  }

  // Parents and children agree, so a keyframe that its map's root does not reach hangs in a cycle.
  void CheckTrees() {
    for (const MapId map : atlas_.Maps()) {
      const Keyframe* root = atlas_.FindKeyframe(atlas_.FindMap(map)->root);
      const bool rooted = root != nullptr && root->map == map && !root->parent.valid();
      Expect(rooted, map, "its root is not alive, in another map or has a parent");
      if (rooted) Expect(ParentsFirst(atlas_, map).size() == keyframes_of_map_[map], map, "its tree is not connected");
    }
  }

  void CheckCounts() {
    std::size_t keyframes = 0;
    std::size_t landmarks = 0;
    for (const MapId id : atlas_.Maps()) {
      const MapInfo& map = *atlas_.FindMap(id);
      Expect(map.id == id && map.keyframes > 0, id, "is empty or not itself");
      Expect(map.keyframes == keyframes_of_map_[id], id, "wrong number of keyframes");
      Expect(map.landmarks == landmarks_of_map_[id], id, "wrong number of landmarks");
      keyframes += map.keyframes;
      landmarks += map.landmarks;
    }
    Expect(keyframes == atlas_.keyframe_count() && landmarks == atlas_.landmark_count(), MapId{},
           "counts of maps and atlas differ");
    for (const SessionId session : atlas_.Sessions()) {
      keyframes -= atlas_.keyframe_count(session);
      landmarks -= atlas_.landmark_count(session);
      CheckSessionCounts(session);
    }
    Expect(keyframes == 0 && landmarks == 0, MapId{}, "counts of maps and sessions differ");
  }

  void CheckSessionCounts(SessionId session) {
    std::size_t keyframes = 0;
    std::size_t landmarks = 0;
    atlas_.ForEachKeyframe(session, [&](const Keyframe&) { ++keyframes; });
    atlas_.ForEachLandmark(session, [&](const Landmark&) { ++landmarks; });
    const bool right = keyframes == atlas_.keyframe_count(session) && landmarks == atlas_.landmark_count(session);
    Expect(right, "session", session, "wrong number of keyframes or landmarks");
  }

  // Each way leads on to something known. That no way leads in a circle follows where all of them end alive or gone.
  void CheckForwarding() {
    atlas_.ForEachFormerKeyframe([&](KeyframeId id, const CulledKeyframe* culled) {
      if (culled == nullptr) return;
      Expect(atlas_.Knows(culled->parent), id, "forwards to nothing");
      Expect(culled->parent_from_culled.AllFinite(), id, "forwards by a motion that is not finite");
    });
    atlas_.ForEachFormerLandmark([&](LandmarkId id, LandmarkId absorber) {
      Expect(!absorber.valid() || atlas_.Knows(absorber), id, "forwards to nothing");
    });
    for (const auto& [absorbed, survivor] : atlas_.merged_maps()) {
      Expect(atlas_.FindMap(absorbed) == nullptr, absorbed, "is alive and merged");
    }
  }

  void CheckLoopEdge(const LoopEdge& edge) {
    const Keyframe* from = atlas_.FindKeyframe(edge.from);
    const Keyframe* to = atlas_.FindKeyframe(edge.to);
    const bool sound = from != nullptr && to != nullptr && from != to && from->map == to->map;
    Expect(sound, edge.from, "a loop edge does not join two living keyframes of one map");
    Expect(edge.to_from_from.AllFinite(), edge.from, "a loop edge is not finite");
  }

  const Atlas& atlas_;
  std::map<MapId, std::size_t> keyframes_of_map_;
  std::map<MapId, std::size_t> landmarks_of_map_;
  std::vector<std::string> faults_;
};

}  // namespace

std::vector<std::string> CheckConsistency(const Atlas& atlas) { return Checker(atlas).Run(); }

}  // namespace pangaea
