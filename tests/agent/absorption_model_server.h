#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "common/map/map_edit.h"
#include "common/map/map_piece.h"
#include "common/map/spanning_tree.h"
#include "common/wire/agent_correction.h"
#include "common/wire/edit_ack.h"
#include "common/wire/envelope.h"
#include "common/wire/map_interest.h"
#include "server/downlink/session_downlink.h"
#include "server/ingest/agent_edit.h"

namespace pangaea {

// A server that edits maps on its own, at random: it moves, fuses, removes, merges maps of the agent's session with one
// another and with the map of another session, and tells the agent in corrections. It lists what it changed itself, no
// more.
class CorrectingServer {
 public:
  static constexpr SessionId kOther = 7;

  CorrectingServer(SessionId session, std::uint64_t seed)
      : session_(session), judge_(session, {.wanted = 0}), random_(seed) {
    MakeOthersMap();
  }

  void Take(const Envelope& envelope) {
    if (envelope.sequence != up_to + 1) return;
    ++up_to;
    if (position_ > 0) ++position_;
    const auto edits = DecodeEdits(envelope.edits);
    ASSERT_TRUE(edits);
    for (const MapEdit& edit : *edits) {
      ASSERT_TRUE(TouchesOnly(edit, session_)) << KindName(edit);
      const Status status = ApplyAgentEdit(edit, atlas);
      ASSERT_TRUE(status) << KindName(edit) << ": " << status.error().message;
      NoteInVain(edit);
    }
  }
  EditAck Ack() const { return {session_, up_to, 1, {}, version_, false}; }

  // Something of its own.
  void Work() {
    switch (Below(9)) {
      case 0:
      case 1:
        return Correct();
      case 2:
        return MovePoints();
      case 3:
        return FuseIntoOthers();
      case 4:
        return Observe();
      case 5:
        return Remove();
      case 6:
        return Cull();
      case 7:
        return FuseTwoOfAKeyframe();
      default:
        return Merge();
    }
  }

  // The state as it is, of all that it changed since the last correction, and what the agent asks back.
  AgentCorrection Tell(const MapInterest& interest = {}) {
    AgentCorrection correction{session_, 1, ++version_, up_to, {}};
    std::map<MapId, PieceSelection> selections;
    const auto selection_of = [&](MapId map) -> PieceSelection& {
      selections[map].map = map;
      return selections[map];
    };
    for (const LandmarkId id : landmarks_) {
      const Landmark* landmark = atlas.FindLandmark(atlas.Resolve(id));
      if (landmark == nullptr) continue;
      PieceSelection& selection = selection_of(atlas.MapOf(*landmark));
      selection.landmarks.push_back(landmark->id);
      // Not always those of others: the agent need not hold all of them.
      const bool others = !known_.contains(landmark->id) || Below(2) == 0;
      for (const Observation& observation : landmark->observations) {
        if (others || observation.keyframe.session == session_) selection.keyframes.push_back(observation.keyframe);
      }
      known_.insert(landmark->id);
    }
    for (const KeyframeId id : keyframes_) {
      if (const Keyframe* keyframe = atlas.FindKeyframe(id)) selection_of(keyframe->map).keyframes.push_back(id);
    }
    // What is gone may be of any map; which piece says so does not matter.
    if (selections.empty() && !atlas.Maps().empty()) (void)selection_of(atlas.Maps().front());
    for (auto& [map, selection] : selections) {
      for (const Keyframe* keyframe : Keyframes(session_)) selection.keyframes.push_back(keyframe->id);
      for (const KeyframeId id : interest.wanted) Recall(id, selection);
      selection.former_landmarks = {landmarks_.begin(), landmarks_.end()};
      selection.culled = {keyframes_.begin(), keyframes_.end()};
      for (const KeyframeId id : selection.keyframes) {
        if (id.session == session_) selection.held.insert(id);
      }
      for (const KeyframeId id : interest.wanted) selection.held.erase(id);
      correction.pieces.push_back(CutPiece(atlas, selection));
    }
    ForgetWhatChanged();
    return OverTheWire(std::move(correction));
  }

  // It will not tell what it did since the last correction.
  void ForgetWhatChanged() {
    keyframes_.clear();
    landmarks_.clear();
  }

  // What the real thing answers to a claim: nothing where it is true, else everything anew once that it tells of what
  // changed has not helped.
  std::optional<AgentCorrection> Judge(const MapInterest& interest) {
    judge_.Take(interest);
    constexpr std::uint64_t kVersionsAPosition = 1024;
    if (position_ == 0) position_ = version_ / kVersionsAPosition + 1;
    auto correction = judge_.Next({atlas, position_, 0, up_to});
    EXPECT_EQ(correction.has_value(), judge_.agreed_claim() != interest.claim.number);
    if (!correction) return std::nullopt;
    version_ = correction->version;
    // As if it did not find what changed.
    if (interest.wanted.empty() && !correction->complete) correction->pieces.clear();
    return OverTheWire(std::move(*correction));
  }

  Atlas atlas;
  std::uint64_t up_to = 0;

 private:
  static AgentCorrection OverTheWire(AgentCorrection correction) {
    auto decoded = DecodePieces(EncodePieces(correction.pieces));
    EXPECT_TRUE(decoded);
    correction.pieces = std::move(*decoded);
    return correction;
  }
  void Recall(KeyframeId id, PieceSelection& selection) const {
    const Keyframe* keyframe = atlas.FindKeyframe(id);
    if (keyframe == nullptr || keyframe->map != selection.map) return;
    selection.keyframes.push_back(id);
    for (const LandmarkId landmark : keyframe->landmarks) {
      if (landmark.valid()) selection.landmarks.push_back(landmark);
    }
  }
  int Below(std::size_t bound) { return static_cast<int>(random_() % bound); }
  double Uniform() { return std::uniform_real_distribution<double>(-1.0, 1.0)(random_); }
  // Braces, unlike parentheses, draw in order.
  Eigen::Vector3d Vector(double size) { return size * Eigen::Vector3d{Uniform(), Uniform(), Uniform()}; }
  Rigid3d Motion(double size) { return Rigid3d{ExpSo3(Vector(size)), Vector(size)}; }

  std::vector<const Keyframe*> Keyframes(SessionId session) const {
    std::vector<const Keyframe*> all;
    atlas.ForEachKeyframe(session, [&](const Keyframe& keyframe) { all.push_back(&keyframe); });
    return all;
  }
  std::vector<const Landmark*> Landmarks(SessionId session) const {
    std::vector<const Landmark*> all;
    atlas.ForEachLandmark(session, [&](const Landmark& landmark) { all.push_back(&landmark); });
    return all;
  }
  template <typename T>
  T Any(const std::vector<T>& all) {
    return all.empty() ? T{} : all[static_cast<std::size_t>(Below(all.size()))];
  }

  // What the agent added and what the server had made impossible meanwhile.
  void NoteInVain(const MapEdit& edit) {
    if (const auto* added = std::get_if<AddLandmark>(&edit)) {
      if (atlas.FindLandmark(added->id) == nullptr) landmarks_.insert(added->id);
    }
    if (const auto* observed = std::get_if<AddObservation>(&edit)) {
      const Keyframe* keyframe = atlas.FindKeyframe(observed->keyframe);
      const LandmarkId landmark = atlas.Resolve(observed->landmark);
      if (landmark.valid() && (keyframe == nullptr || keyframe->landmarks[observed->keypoint] == landmark)) return;
      landmarks_.insert(observed->landmark);
      keyframes_.insert(observed->keyframe);
    }
  }

  bool Do(const MapEdit& edit) { return Apply(edit, atlas).has_value(); }
  void MakeOthersMap() {
    for (std::uint32_t k = 1; k <= 6; ++k) {
      auto data = std::make_shared<KeyframeData>();
      data->camera = {640, 480, 400.0, 400.0, 320.0, 240.0, 0.1};
      data->features.keypoints.resize(12);
      data->features.descriptors.resize(12);
      Do(AddKeyframe{{kOther, k}, {kOther, 1}, {kOther, k - 1}, Motion(0.5), data});
      for (std::uint32_t l = 0; l < 6; ++l) {
        Do(AddLandmark{{kOther, 6 * k + l}, {kOther, k}, l, Vector(1.0) + Eigen::Vector3d(0, 0, 5)});
      }
    }
  }

  // The session's keyframes of one map go elsewhere; the landmarks measured from them go along, or not quite.
  void Correct() {
    std::vector<std::pair<KeyframeId, Rigid3d>> poses;
    std::map<LandmarkId, Eigen::Vector3d> in_reference;
    const MapId map = Any(atlas.Maps());
    for (const Keyframe* keyframe : Keyframes(session_)) {
      if (keyframe->map != map) continue;
      poses.emplace_back(keyframe->id, Motion(0.2) * keyframe->camera_from_map);
      keyframes_.insert(keyframe->id);
      for (const LandmarkId id : keyframe->landmarks) {
        if (!id.valid()) continue;
        landmarks_.insert(id);
        if (atlas.FindLandmark(id)->reference != keyframe->id) continue;
        in_reference[id] = keyframe->camera_from_map * atlas.FindLandmark(id)->point_in_map;
      }
    }
    MoveKeyframes edit = MoveKeyframesTo(atlas, poses);
    edit.correction = version_ + 1;
    if (!Do(edit)) return;
    std::vector<std::pair<LandmarkId, Eigen::Vector3d>> points;
    for (const auto& [id, point] : in_reference) {
      const Keyframe& reference = *atlas.FindKeyframe(atlas.FindLandmark(id)->reference);
      const bool on_its_own = Below(4) == 0;
      points.emplace_back(id, reference.camera_from_map.Inverse() * (on_its_own ? 1.01 * point : point));
      landmarks_.insert(id);
    }
    Do(MoveLandmarksTo(atlas, points));
  }

  void MovePoints() {
    std::vector<std::pair<LandmarkId, Eigen::Vector3d>> points;
    for (const Landmark* landmark : Landmarks(session_)) {
      const Keyframe& reference = *atlas.FindKeyframe(landmark->reference);
      // What it has not settled is the agent's to move.
      if (reference.corrected_at == 0 || Below(3) != 0) continue;
      points.emplace_back(landmark->id, landmark->point_in_map + Vector(0.02));
      landmarks_.insert(landmark->id);
    }
    Do(MoveLandmarksTo(atlas, points));
  }

  void FuseIntoOthers() {
    const Landmark* own = Any(Landmarks(session_));
    const Landmark* other = Any(Landmarks(kOther));
    if (own == nullptr || other == nullptr) return;
    const std::vector<Observation> observers = own->observations;
    const LandmarkId own_id = own->id;
    const LandmarkId other_id = other->id;
    if (!Do(FuseLandmarks{other_id, own_id})) return;
    landmarks_.insert(own_id);
    landmarks_.insert(other_id);
    for (const Observation& observation : observers) keyframes_.insert(observation.keyframe);
  }

  // Of two that one keyframe sees, the one that stays may have lost its sighting there before: then it gets the
  // other's.
  void FuseTwoOfAKeyframe() {
    const Keyframe* keyframe = Any(Keyframes(session_));
    if (keyframe == nullptr) return;
    const KeyframeId id = keyframe->id;
    std::vector<LandmarkId> seen;
    for (const LandmarkId landmark : keyframe->landmarks) {
      if (landmark.valid()) seen.push_back(landmark);
    }
    if (seen.size() < 2) return;
    std::shuffle(seen.begin(), seen.end(), random_);
    if (atlas.FindLandmark(seen[0])->observations.size() > 1 && Below(2) == 0) Do(RemoveObservation{seen[0], id});
    for (const LandmarkId landmark : {seen[0], seen[1]}) {
      landmarks_.insert(landmark);
      for (const Observation& observation : atlas.FindLandmark(landmark)->observations) {
        if (observation.keyframe.session == session_) keyframes_.insert(observation.keyframe);
      }
    }
    keyframes_.insert(id);
    Do(FuseLandmarks{seen[0], seen[1]});
  }

  void Observe() {
    const Keyframe* keyframe = Any(Keyframes(session_));
    const Landmark* landmark = Any(Landmarks(Below(2) == 0 ? kOther : session_));
    if (keyframe == nullptr || landmark == nullptr) return;
    const LandmarkId id = landmark->id;
    const KeyframeId seen_from = keyframe->id;
    if (!Do(AddObservation{id, seen_from, static_cast<std::uint32_t>(Below(keyframe->landmarks.size()))})) return;
    landmarks_.insert(id);
    keyframes_.insert(seen_from);
  }

  void Remove() {
    const Landmark* landmark = Any(Landmarks(Below(3) == 0 ? kOther : session_));
    if (landmark == nullptr) return;
    const LandmarkId id = landmark->id;
    const Observation seen = landmark->observations[static_cast<std::size_t>(Below(landmark->observations.size()))];
    for (const Observation& observation : landmark->observations) {
      if (observation.keyframe.session == session_) keyframes_.insert(observation.keyframe);
    }
    landmarks_.insert(id);
    Do(id.session == session_ && Below(2) == 0 ? MapEdit(RemoveLandmark{id})
                                               : MapEdit(RemoveObservation{id, seen.keyframe}));
  }

  void Cull() {
    const Keyframe* keyframe = Any(Keyframes(session_));
    if (keyframe == nullptr || atlas.FindMap(keyframe->map)->keyframes == 1) return;
    const KeyframeId id = keyframe->id;
    const std::vector<LandmarkId> seen = keyframe->landmarks;
    if (!Do(RemoveKeyframe{id})) return;
    keyframes_.insert(id);
    for (const LandmarkId landmark : seen) {
      if (landmark.valid()) landmarks_.insert(landmark);
    }
  }

  void Merge() {
    std::vector<MapId> maps = atlas.Maps();
    if (maps.size() < 2) return;
    std::shuffle(maps.begin(), maps.end(), random_);
    const auto root = [&](MapId map) { return atlas.FindMap(map)->root; };
    for (const KeyframeId id : ParentsFirst(atlas, maps[1])) {
      keyframes_.insert(id);
      for (const LandmarkId landmark : atlas.FindKeyframe(id)->landmarks) {
        if (landmark.valid()) landmarks_.insert(landmark);
      }
    }
    // Also those that stay: the other map may be new to the agent.
    for (const KeyframeId id : ParentsFirst(atlas, maps[0])) keyframes_.insert(id);
    Do(MergeMaps{maps[0], maps[1], Similarity3d(Motion(1.0)), root(maps[1]), root(maps[0])});
  }

  SessionId session_;
  SessionDownlink judge_;
  std::uint64_t position_ = 0;  // once it judges
  std::mt19937_64 random_;
  std::uint64_t version_ = 0;
  std::set<LandmarkId> known_;  // that it has told of
  // What it changed since the last correction.
  std::set<KeyframeId> keyframes_;
  std::set<LandmarkId> landmarks_;
};

}  // namespace pangaea
